//! The source of contacts, touch and sound.

use super::{Columns, Found, columns};
use crate::spectrum::power_spectrum;
use asperity::files::FileError;
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine, Names};
use asperity::offline::{self, Options};
use asperity::{Body, Config, ContactBlock, Engine, Extent, Material, Stock, Surface, Tap, Wrap};
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::collections::HashMap;

/// Distance of two points of a profile, m.
const STEP_M: f64 = 1e-5;
const POINTS: usize = 1 << 17;
/// Wavelengths between which the slope is fitted, m.
const FITTED_M: [f64; 2] = [1e-4, 8e-3];

/// Profiles of α 1 and 2, with the slope that their spectra have.
pub fn profiles() -> Result<Found, String> {
    let alphas = [1.0, 2.0];
    let (mut measured, mut shown) = (Vec::new(), Vec::new());
    for alpha in alphas {
        let noise = FractalNoise::new(4);
        let position_m: Vec<[f64; 2]> = (0..POINTS).map(|n| [n as f64 * STEP_M, 0.3]).collect();
        let path = NoisePath { position_m: &position_m, footprint_m: &vec![STEP_M; POINTS] };
        let (roughness, mut height_m) = (vec![(2.5 - alpha) / 1.5; POINTS], vec![0.0; POINTS]);
        noise.add(&path, &roughness, &OctaveWeights::pinned(1e-6, 0.05), &mut height_m);
        measured.push(slope(&height_m));
        let largest = height_m.iter().fold(0.0_f64, |most, height| most.max(height.abs()));
        shown.push(height_m.iter().take(2000).step_by(4).map(|height| height / largest).collect());
    }
    let sentence = format!(
        "The spectra fall as 1/f^{:.2} and 1/f^{:.2}; the noise belongs to places, so that the profile is the same at every speed.",
        measured[0], measured[1]
    );
    let [first, second] = [shown.remove(0), shown.remove(0)];
    let ours = columns([("alpha", measured), ("profile_alpha_1", first), ("profile_alpha_2", second)]);
    Ok((columns([("alpha", alphas.to_vec())]), ours, sentence))
}

/// Exponent of a profile's power spectrum, by octaves.
fn slope(height_m: &[f64]) -> f64 {
    const LENGTH: usize = 1 << 14;
    let mean = height_m.iter().sum::<f64>() / height_m.len() as f64;
    let samples: Vec<f32> = height_m.iter().map(|height| (height - mean) as f32).collect();
    let power = power_spectrum(&samples, LENGTH);
    let bin = |wavelength_m: f64| LENGTH as f64 * STEP_M / wavelength_m;
    let (mut low, mut points) = (bin(FITTED_M[1]), Vec::new());
    while 2.0 * low < bin(FITTED_M[0]) {
        let band = &power[low as usize..2 * low as usize];
        points.push((points.len() as f64, (band.iter().sum::<f64>() / band.len() as f64).log2()));
        low *= 2.0;
    }
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let over: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    -over / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// A plate of tiles: their pitch, the width of the joints between them, their depth, m.
const TILES_M: [f64; 3] = [0.02, 0.002, 5e-4];
const SIDE_M: f64 = 0.14;
/// Time from the begin of the stroke that is shown, s, and rows a second.
const SHOWN_S: [f64; 2] = [0.3, 0.8];
const ROWS_A_SECOND: f64 = 4410.0;

/// Rows of a contact: height, pad, impulse.
#[derive(Default)]
struct State(Vec<[f64; 3]>);

impl Tap for State {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        let rows = block.contact_samples.iter().zip(block.impulse_n_s);
        self.0.extend(rows.map(|(row, impulse_n_s)| [row.height_m, row.pad_m, *impulse_n_s]));
    }
}

/// Profile, pad and impulses of a finger that slides over tiles.
pub fn state() -> Result<Found, String> {
    let (rows, rate_hz) = slide().map_err(|error| error.to_string())?;
    let every = (rate_hz / ROWS_A_SECOND).round().max(1.0) as usize;
    let [from, to] = SHOWN_S.map(|s| ((s * rate_hz) as usize).min(rows.len()));
    let shown = rows[from..to].chunks(every);
    let [mut height_m, mut pad_m, mut impulse_n_s] = [Vec::new(), Vec::new(), Vec::new()];
    for chunk in shown {
        height_m.push(chunk[0][0]);
        pad_m.push(chunk[0][1]);
        impulse_n_s.push(chunk.iter().map(|row| row[2]).sum());
    }
    let strongest = rows[from..to].iter().map(|row| row[2]).fold(0.0, f64::max);
    let loud = impulse_n_s.iter().zip(&height_m).filter(|(impulse, _)| **impulse > 0.2 * strongest);
    let (mut all, mut in_joints) = (0usize, 0usize);
    for (_, height) in loud {
        all += 1;
        in_joints += usize::from(*height < -0.02 * TILES_M[2]);
    }
    let sentence = format!(
        "Profile, pad and impulses are columns. Of {all} instants that strike the body with more than a fifth of the hardest blow, \
         {in_joints} lie in the joints of the tiles, which are a tenth of the way."
    );
    let time_s = (0..height_m.len()).map(|n| n as f64 * every as f64 / rate_hz).collect();
    let ours = columns([
        ("time_s", time_s),
        ("surface_m", height_m),
        ("pad_m", pad_m),
        ("impulse_n_s", impulse_n_s),
    ]);
    Ok((Columns::new(), ours, sentence))
}

fn slide() -> Result<(Vec<[f64; 3]>, f64), FileError> {
    const TEXELS: usize = 1024;
    const SPEED_M_S: f64 = 0.1;
    let [pitch_m, joint_m, depth_m] = TILES_M;
    let raster = Raster::from_fn(TEXELS, 4, |x, _| {
        let at = (x as f64 + 0.5) * SIDE_M / TEXELS as f64;
        let across = (at.rem_euclid(pitch_m) - 0.5 * pitch_m) / (0.5 * joint_m);
        if across.abs() < 1.0 { -0.5 * depth_m * (1.0 + (std::f64::consts::PI * across).cos()) } else { 0.0 }
    });
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = HeightMap::new(&raster, extent, Wrap::Repeat).map_err(FileError::from_error)?;
    let Engine { mut scene, renderer, .. } = Config::default().build().map_err(FileError::from_error)?;
    let body = Body::stock(Stock::Plate, Material::CERAMIC, SIDE_M).map_err(FileError::from_error)?;
    let body = scene.add_body(body).map_err(FileError::from_error)?;
    let surface = Surface::new(map, SIDE_M, SIDE_M).map_err(FileError::from_error)?.body(body);
    let id = scene.add_surface(surface).map_err(FileError::from_error)?;
    let names = Names { surfaces: HashMap::from([("s".to_owned(), id)]), ..Names::default() };
    let line = |step: usize| {
        let t = step as f64 / 60.0;
        let sample = ContactSample {
            uv: [0.1 + SPEED_M_S * t / SIDE_M, 0.5],
            velocity_m_s: Some([SPEED_M_S, 0.0]),
            normal_force_n: 0.6,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = if step == 0 { LogEvent::begin(1, "s", 0, sample) } else { LogEvent::moved(1, sample) };
        LogLine { t, event }
    };
    let log = ContactLog { lines: (0..54).map(line).collect() };
    let rate_hz = renderer.sample_rate_hz();
    let mut state = State::default();
    offline::render_tapped(
        scene,
        renderer,
        &log,
        &names,
        &Options { tail_s: 0.0, ..Options::default() },
        &mut state,
    )
    .map_err(FileError::from_error)?;
    Ok((state.0, rate_hz))
}
