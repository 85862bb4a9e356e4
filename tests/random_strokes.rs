//! Random strokes: finite, and no pad ever faster than ground and force can make it.
//!
//! Ten thousand of 20 ms in CI; `ASPERITY_STROKES=1000000` runs as many as one likes.

use crate::common;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::Options;
use asperity::{Config, ContactBlock, Extent, Probe, Surface, Tap, Wrap};
use asperity_dsp::rng::Rng;
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use common::{SIDE_M, render_tapped};
use std::f64::consts::TAU;

const STROKE_S: f64 = 0.02;
/// From the end of one stroke to the beginning of the next: longer than a fade.
const PAUSE_S: f64 = 0.03;
/// Strokes over one surface.
const A_SURFACE: usize = 200;

/// Fastest pad over what explains it: twice the ground's own speed, as of a light elastic mass, and
/// the fall from the leash.
#[derive(Default)]
struct Fastest {
    ratio: f64,
    broken: bool,
    last: Option<(asperity::ContactId, f64, f64)>,
    ground_m_s: f64,
    pad_m_s: f64,
    force_n: f64,
}

impl Fastest {
    fn settle(&mut self) {
        let probe = Probe::default();
        let fall_m_s = (2.0 * self.force_n / probe.finger_mass_kg * probe.leash_m).sqrt();
        self.ratio = self.ratio.max(self.pad_m_s / (2.0 * self.ground_m_s + fall_m_s + 1e-3));
        (self.ground_m_s, self.pad_m_s, self.force_n) = (0.0, 0.0, 0.0);
    }
}

impl Tap for Fastest {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        for (i, row) in block.contact_samples.iter().enumerate() {
            let numbers =
                [row.pad_m, row.pad_velocity_m_s, row.finger_m, row.contact_force_n, block.impulse_n_s[i]];
            self.broken |= !numbers.iter().all(|x| x.is_finite());
            match self.last {
                Some((contact, height_m, _)) if contact == block.contact => {
                    self.ground_m_s = self.ground_m_s.max((row.height_m - height_m).abs() * 44_100.0);
                    self.pad_m_s = self.pad_m_s.max(row.pad_velocity_m_s.abs());
                    self.force_n = self.force_n.max(row.normal_force_n);
                }
                _ => self.settle(),
            }
            self.last = Some((block.contact, row.height_m, row.pad_m));
        }
    }
}

fn surface(rng: &mut Rng) -> Surface {
    let (pitch_m, relief_m) = (0.5e-3 * 20f64.powf(rng.uniform()), 5e-5 * 40f64.powf(rng.uniform()));
    let turns = (SIDE_M / pitch_m).round();
    let (sharp, across) = (rng.uniform() < 0.5, rng.uniform() < 0.5);
    let raster = Raster::from_fn(512, 512, |x, y| {
        let [u, v] = [x, y].map(|i| turns * (i as f64 + 0.5) / 512.0);
        let wave = |t: f64| if sharp { t.fract() } else { 0.5 + 0.5 * (TAU * t).sin() };
        relief_m * wave(u) * if across { wave(v) } else { 1.0 }
    });
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = HeightMap::new(&raster, extent, Wrap::Repeat).unwrap().with_roughness(rng.uniform()).unwrap();
    Surface::new(map, SIDE_M, SIDE_M).unwrap()
}

fn strokes(rng: &mut Rng) -> ContactLog {
    let mut lines = Vec::new();
    for n in 0..A_SURFACE {
        let start_s = (STROKE_S + PAUSE_S) * n as f64;
        let (from, turn) = ([rng.uniform(), rng.uniform()], TAU * rng.uniform());
        let speed_m_s = 0.01 * 50f64.powf(rng.uniform());
        let normal_force_n = 0.05 * 100f64.powf(rng.uniform());
        let velocity_m_s = [speed_m_s * turn.cos(), speed_m_s * turn.sin()];
        let sample = |t: f64| ContactSample {
            uv: [0, 1].map(|axis| from[axis] + velocity_m_s[axis] * t / SIDE_M),
            velocity_m_s: Some(velocity_m_s),
            normal_force_n,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let contact = n as u64;
        lines.push(LogLine { t: start_s, event: LogEvent::begin(contact, "s", 0, sample(0.0)) });
        lines.push(LogLine { t: start_s + 0.01, event: LogEvent::moved(contact, sample(0.01)) });
        lines.push(LogLine { t: start_s + STROKE_S, event: LogEvent::End { contact } });
    }
    ContactLog { lines }
}

#[test]
fn ten_thousand_random_strokes_are_finite() {
    let wanted = std::env::var("ASPERITY_STROKES").ok().and_then(|text| text.parse().ok()).unwrap_or(10_000);
    let mut fastest = Fastest::default();
    for seed in 0..(wanted as usize).div_ceil(A_SURFACE) {
        let mut rng = Rng::new(seed as u64 + 1);
        let (surface, log) = (surface(&mut rng), strokes(&mut rng));
        let config = Config { seed: seed as u64, ..Config::default() };
        let take = render_tapped(
            config,
            surface,
            &log,
            &Options { tail_s: 0.0, ..Options::default() },
            &mut fastest,
        );
        fastest.settle();
        fastest.last = None;
        let out = take.haptic.iter().chain(&take.audio).flatten();
        assert!(!fastest.broken && out.clone().all(|x| x.is_finite()), "surface {seed}");
        assert_eq!(take.stats.quarantined, 0, "surface {seed}");
    }
    println!("{wanted} strokes: fastest pad {:.2} of what ground and force explain", fastest.ratio);
    assert!(fastest.ratio <= 1.0, "{}", fastest.ratio);
}
