//! Scenes and strokes that several tests share.
#![allow(dead_code)]

pub mod exploration;
pub mod game;
pub mod plates;
pub mod strokes;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine, Names};
use asperity::offline::{self, Options, Render};
use asperity::{
    ActuatorSettings, ClockMode, Config, Excitation, Extent, ModalModel, Mode, Surface, Tap, Wrap,
};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::collections::HashMap;

/// Side of the test surfaces, m.
pub const SIDE_M: f64 = 0.14;

/// A live engine in raw units, without limiters.
pub fn raw_live(sample_rate_hz: f64) -> Config {
    Config { sample_rate_hz, clock: ClockMode::LIVE, ..Config::default() }
}

/// A grating along u: height = amplitude · sin(2π u / wavelength), 16 texels or more a period.
pub fn grating(wavelength_m: f64, amplitude_m: f64) -> Surface {
    let periods = (SIDE_M / wavelength_m).round().max(1.0);
    let width = (periods * 16.0) as usize;
    let width_m = periods * wavelength_m;
    let values = (0..width)
        .map(|i| {
            let u = (i as f64 + 0.5) / width as f64;
            amplitude_m * (2.0 * std::f64::consts::PI * periods * u).sin()
        })
        .collect::<Vec<_>>()
        .repeat(4);
    let raster = Raster { width, height: 4, values };
    let map =
        HeightMap::new(&raster, Extent { width_m, height_m: SIDE_M, relief_m: 1.0 }, Wrap::Repeat).unwrap();
    Surface::new(map, width_m, SIDE_M).unwrap().micro_relief_m(0.0)
}

/// A flat plate with the paper's micro-noise of roughness `r`.
pub fn plate(r: f64) -> Surface {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    Surface::new(HeightMap::flat(extent, r).unwrap(), SIDE_M, SIDE_M).unwrap()
}

/// A small bright body.
pub fn bar() -> ModalModel {
    let mode =
        |frequency_hz, decay_per_s, amplitude| Mode { frequency_hz, decay_per_s, amplitude, phase_rad: 0.0 };
    let modes = vec![
        mode(412.0, 9.0, 0.3),
        mode(1133.0, 14.0, 0.25),
        mode(2219.0, 22.0, 0.2),
        mode(3671.0, 31.0, 0.15),
        mode(5480.0, 45.0, 0.1),
    ];
    ModalModel::new(modes, 0.01).unwrap()
}

/// A straight stroke along u at constant speed, reported at 60 Hz, on surface "s".
pub fn stroke(surface_width_m: f64, speed_m_s: f64, normal_force_n: f64, seconds: f64) -> ContactLog {
    stroke_of(1, surface_width_m, speed_m_s, normal_force_n, seconds)
}

/// [`stroke`] of a contact with another name.
pub fn stroke_of(
    contact: u64,
    width_m: f64,
    speed_m_s: f64,
    normal_force_n: f64,
    seconds: f64,
) -> ContactLog {
    let sample = |t: f64| ContactSample {
        uv: [0.1 + speed_m_s * t / width_m, 0.525],
        velocity_m_s: Some([speed_m_s, 0.0]),
        normal_force_n,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let steps = (seconds * 60.0) as usize;
    let mut lines = vec![LogLine { t: 0.0, event: LogEvent::begin(contact, "s", 0, sample(0.0)) }];
    for step in 1..steps {
        let t = step as f64 / 60.0;
        lines.push(LogLine { t, event: LogEvent::moved(contact, sample(t)) });
    }
    lines.push(LogLine { t: seconds, event: LogEvent::End { contact } });
    ContactLog { lines }
}

/// Config whose haptic channel is in metres, with the default high-pass.
pub fn si_config() -> Config {
    Config {
        actuators: vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }],
        ..Config::default()
    }
}

/// Renders a log over one surface on the bar.
pub fn render(config: Config, surface: Surface, log: &ContactLog, options: &Options) -> Render {
    render_tapped(config, surface, log, options, &mut asperity::NoTap)
}

/// [`render`] with a tap.
pub fn render_tapped(
    config: Config,
    surface: Surface,
    log: &ContactLog,
    options: &Options,
    tap: &mut dyn Tap,
) -> Render {
    let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(surface.body(body).excitation(Excitation::BOTH)).unwrap();
    let names = Names {
        surfaces: HashMap::from([("s".to_owned(), surface)]),
        bodies: HashMap::from([("b".to_owned(), body)]),
        ..Default::default()
    };
    offline::render_tapped(scene, renderer, log, &names, options, tap).unwrap()
}

/// Root mean square.
pub fn rms(x: &[f32]) -> f64 {
    (x.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// Largest absolute value.
pub fn peak(x: &[f32]) -> f64 {
    x.iter().fold(0.0, |peak, x| peak.max(f64::from(x.abs())))
}

/// Amplitude of the sinusoid of `frequency_hz` in `x` (Hann-windowed).
pub fn tone_amplitude(x: &[f32], frequency_hz: f64, rate_hz: f64) -> f64 {
    let n = x.len() as f64;
    let (mut re, mut im) = (0.0, 0.0);
    for (i, x) in x.iter().enumerate() {
        let window = 1.0 - (2.0 * std::f64::consts::PI * i as f64 / n).cos();
        let phase = 2.0 * std::f64::consts::PI * frequency_hz * i as f64 / rate_hz;
        re += f64::from(*x) * window * phase.cos();
        im += f64::from(*x) * window * phase.sin();
    }
    2.0 * (re * re + im * im).sqrt() / n
}
