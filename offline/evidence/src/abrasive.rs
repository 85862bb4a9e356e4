//! Coated abrasives: grains of a nominal size, beside what a tool was measured to do on them.
//!
//! Flat above twice the size of a grain, self-affine below (H 0.8); the rms is 0.27 of the size, as
//! profilometers find on coated abrasives.
//!
//! Source: the Penn Haptic Texture Toolkit (Culbertson, Lopez Delgado and Kuchenbecker 2014), a
//! steel-tipped tool at 120 mm/s and 1.5 N.

use asperity::files::FileError;
use asperity::{Extent, Surface, Wrap};
use asperity_dsp::rng::Rng;
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex;
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;

/// Side of an abrasive, m.
pub const SIDE_M: f64 = 0.04;
/// Papers of grit 100, 220 and 320 (141, 66 and 36 µm), m/s².
pub const MEASURED_M_S2: [f64; 3] = [6.5, 2.4, 1.5];
/// Share of friction in what a three-axis sensor measures on such ground, dB: 3 to 5.
pub const FRICTION_DB: f64 = 4.0;
/// Texels a side.
const SIDE: usize = 1024;

/// An abrasive of this grain.
///
/// # Errors
/// When the engine refuses the surface.
pub fn abrasive(grain_m: f64) -> Result<Surface, FileError> {
    let mut rng = Rng::new(3);
    let mut spectrum = vec![Complex::new(0.0, 0.0); SIDE * SIDE];
    let turns = |i: usize| if i < SIDE / 2 { i as f64 } else { i as f64 - SIDE as f64 };
    for (index, bin) in spectrum.iter_mut().enumerate() {
        let k = turns(index % SIDE).hypot(turns(index / SIDE)) / SIDE_M * 2.0 * grain_m;
        *bin = Complex::new(rng.normal(), rng.normal()) * k.max(1.0).powf(-1.8);
    }
    spectrum[0] = Complex::new(0.0, 0.0);
    let plan = FftPlanner::new().plan_fft_inverse(SIDE);
    for _ in 0..2 {
        plan.process(&mut spectrum);
        spectrum = (0..SIDE * SIDE).map(|i| spectrum[i % SIDE * SIDE + i / SIDE]).collect();
    }
    let values: Vec<f64> = spectrum.iter().map(|bin| bin.re).collect();
    let rms = (values.iter().map(|h| h * h).sum::<f64>() / values.len() as f64).sqrt();
    let values = values.iter().map(|h| 0.27 * grain_m * h / rms).collect();
    let raster = Raster { width: SIDE, height: SIDE, values };
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = HeightMap::new(&raster, extent, Wrap::Repeat).map_err(FileError::from_error)?;
    Surface::new(map, SIDE_M, SIDE_M).map_err(FileError::from_error)
}
