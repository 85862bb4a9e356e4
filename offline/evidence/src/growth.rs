//! Growth of a haptic channel with speed and force, over a flat plate with the default
//! micro-relief; its level on any surface.

use asperity::files::FileError;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine, Names};
use asperity::offline::{self, Options};
use asperity::{ActuatorSettings, Config, Engine, Quantity, Surface, probe_by_name};
use std::collections::HashMap;

/// Speeds, m/s, and forces, N, of the strokes.
const SPEEDS_M_S: [f64; 3] = [0.04, 0.12, 0.24];
/// See [`SPEEDS_M_S`].
const FORCES_N: [f64; 3] = [0.3, 1.5, 5.0];
/// Side of the plate, m.
const SIDE_M: f64 = 0.14;

/// Exponents of a level over speed and force, and the level at 120 mm/s and 1.5 N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// Level ∝ v to this power.
    pub speed_exponent: f64,
    /// Level ∝ F to this power.
    pub force_exponent: f64,
    /// Root mean square, in the quantity's unit.
    pub level: f64,
}

/// Growth of what a probe feels of a plate of this roughness.
///
/// # Errors
/// When the engine refuses the probe or the plate.
pub fn growth(probe: &str, quantity: Quantity, roughness: f64) -> Result<Growth, FileError> {
    let mut levels = [[0.0; 3]; 3];
    for (row, speed_m_s) in levels.iter_mut().zip(SPEEDS_M_S) {
        for (level, force_n) in row.iter_mut().zip(FORCES_N) {
            let plate = Surface::flat(SIDE_M, SIDE_M).map_err(FileError::from_error)?;
            let plate = plate.roughness(asperity::Roughness::Constant(roughness));
            *level = rms(probe, quantity, (plate, SIDE_M), speed_m_s, force_n)?;
        }
    }
    let slope = |x: [f64; 3], of: &dyn Fn(usize) -> f64| {
        let x = x.map(f64::ln);
        let mean = x.iter().sum::<f64>() / 3.0;
        let (xy, xx) =
            (0..3).fold((0.0, 0.0), |(xy, xx), i| (xy + (x[i] - mean) * of(i), xx + (x[i] - mean).powi(2)));
        xy / xx
    };
    let by_speed = |i: usize| levels[i].iter().map(|x: &f64| x.ln()).sum::<f64>() / 3.0;
    let by_force = |i: usize| levels.iter().map(|row| row[i].ln()).sum::<f64>() / 3.0;
    Ok(Growth {
        speed_exponent: slope(SPEEDS_M_S, &by_speed),
        force_exponent: slope(FORCES_N, &by_force),
        level: levels[1][1],
    })
}

/// Root mean square of a channel in a stroke of a second along a surface of this side, m, after its
/// first 0.2 s.
///
/// # Errors
/// When the engine refuses the probe or the surface.
pub fn rms(
    probe: &str,
    output: Quantity,
    (surface, side_m): (Surface, f64),
    speed_m_s: f64,
    force_n: f64,
) -> Result<f64, FileError> {
    let probe = probe_by_name(probe).ok_or_else(|| FileError::new("probe", "is unknown", "name a preset"))?;
    let actuators = vec![ActuatorSettings { full_scale: 1.0, output, ..ActuatorSettings::default() }];
    let config = Config { probe, actuators, ..Config::default() };
    let Engine { mut scene, renderer, .. } = config.build().map_err(FileError::from_error)?;
    let id = scene.add_surface(surface).map_err(FileError::from_error)?;
    let names = Names { surfaces: HashMap::from([("s".to_owned(), id)]), ..Names::default() };
    let sample = |t: f64| {
        let uv = [0.1 + speed_m_s * t / side_m, 0.525];
        (t, ContactSample::new(uv, force_n).sliding([speed_m_s, 0.0]))
    };
    let samples = (0..60).map(|step| sample(f64::from(step) / 60.0));
    let lines = LogLine::contact(1, ("s", LogHand::felt_by(0)), samples, 1.0);
    let options = Options { tail_s: 0.0, ..Options::default() };
    let render = offline::render(scene, renderer, &ContactLog { lines }, &names, &options);
    let render = render.map_err(FileError::from_error)?;
    let felt = &render.haptic[0][(0.2 * render.sample_rate_hz) as usize..];
    Ok((felt.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / felt.len().max(1) as f64).sqrt())
}
