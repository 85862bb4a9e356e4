//! The seven solid-noise materials are told apart by what the finger feels: nearest centroid over
//! third-octave spectra of the haptic channel, on strokes that were not used for the centroids. The
//! paper's materials are solid noise alone, so the micro-relief is off.

mod common;
#[path = "common/spectrum.rs"]
mod spectrum;

use asperity::Surface;
use asperity::contact_log::{ContactLog, LogEvent, LogLine, LogSample};
use asperity::offline::Options;
use asperity::texture::solid_materials::SolidMaterial;
use asperity::texture::solid_noise::SolidNoise;
use asperity_dsp::rng::Rng;
use common::{render, si_config};

const SIDE_M: f64 = 0.1;
const STROKES: usize = 10;

/// 1.5 s anywhere, in any direction, at 70–130 mm/s and 0.4–1 N.
fn random_stroke(rng: &mut Rng) -> ContactLog {
    let speed_m_s = 0.07 + 0.06 * rng.uniform();
    let normal_force_n = 0.4 + 0.6 * rng.uniform();
    let angle = std::f64::consts::TAU * rng.uniform();
    let (start, velocity) =
        ([rng.uniform(), rng.uniform()], [speed_m_s * angle.cos(), speed_m_s * angle.sin()]);
    let sample = |t: f64| LogSample {
        uv: [start[0] + velocity[0] * t / SIDE_M, start[1] + velocity[1] * t / SIDE_M],
        velocity_m_s: Some(velocity),
        normal_force_n,
        closing_m_s: 0.0,
    };
    let begin = LogEvent::Begin { contact: 1, surface: "s".into(), actuator: 0, sample: sample(0.0) };
    let mut lines = vec![LogLine { t: 0.0, event: begin }];
    for step in 1..90 {
        let t = f64::from(step) / 60.0;
        lines.push(LogLine { t, event: LogEvent::Move { contact: 1, sample: sample(t) } });
    }
    lines.push(LogLine { t: 1.5, event: LogEvent::End { contact: 1 } });
    ContactLog { lines }
}

fn features(material: SolidMaterial, rng: &mut Rng) -> Vec<f64> {
    let source = SolidNoise::new(material.parameters(), 1, 44_100.0).unwrap();
    let surface = Surface::new(source, SIDE_M, SIDE_M).unwrap().wraps(false).micro_relief_m(0.0);
    let take =
        render(si_config(), surface, &random_stroke(rng), &Options { tail_s: 0.0, ..Options::default() });
    // 6 Hz – 1 kHz: what skin feels; below that it is position. Nothing below 0.1 µm counts: a finger does
    // not notice it.
    let spectrum = spectrum::third_octaves_from_db(&take.haptic[0], take.sample_rate_hz, 32_768, 6.0, 23);
    spectrum.iter().map(|db| db.max(-140.0)).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

#[test]
fn held_out_strokes_are_named_by_their_nearest_centroid() {
    let mut rng = Rng::new(11);
    let centroids = SolidMaterial::SEVEN.map(|material| {
        let strokes: Vec<_> = (0..STROKES).map(|_| features(material, &mut rng)).collect();
        (0..strokes[0].len())
            .map(|i| strokes.iter().map(|s| s[i]).sum::<f64>() / STROKES as f64)
            .collect::<Vec<_>>()
    });
    for (c, m) in centroids.iter().zip(SolidMaterial::SEVEN) {
        println!("{:>12} {:?}", m.name(), c.iter().map(|x| *x as i32).collect::<Vec<_>>());
    }
    let mut right = 0;
    for (index, material) in SolidMaterial::SEVEN.into_iter().enumerate() {
        let mut row = [0; 7];
        for _ in 0..STROKES {
            let stroke = features(material, &mut rng);
            let nearest = (0..7)
                .min_by(|&a, &b| {
                    distance(&stroke, &centroids[a]).total_cmp(&distance(&stroke, &centroids[b]))
                })
                .unwrap();
            row[nearest] += 1;
        }
        println!("{:>12} {row:?}", material.name());
        right += row[index];
    }
    let share = right as f64 / (7 * STROKES) as f64;
    assert!(share >= 0.95, "{share}");
}
