//! The judge of the seven materials: strokes, what is felt of them, the nearest centroid.
//!
//! Third-octave spectra of the haptic channel from 6 Hz (what skin feels; below that it is
//! position) to 1 kHz. Nothing below 0.1 µm counts: a finger does not notice it. The paper's
//! materials are solid noise alone, so the micro-relief is off.
#![allow(dead_code)]

use crate::common::{render, si_config};
use asperity::Surface;
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::Options;
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::SolidNoise;
use asperity_dsp::rng::Rng;
use asperity_evidence::spectrum;

const SIDE_M: f64 = 0.1;

/// 1.5 s anywhere, in any direction, at 70–130 mm/s and 0.4–1 N.
fn random_stroke(rng: &mut Rng) -> ContactLog {
    let speed_m_s = 0.07 + 0.06 * rng.uniform();
    let normal_force_n = 0.4 + 0.6 * rng.uniform();
    let angle = std::f64::consts::TAU * rng.uniform();
    let (start, velocity) =
        ([rng.uniform(), rng.uniform()], [speed_m_s * angle.cos(), speed_m_s * angle.sin()]);
    let sample = |t: f64| ContactSample {
        uv: [start[0] + velocity[0] * t / SIDE_M, start[1] + velocity[1] * t / SIDE_M],
        velocity_m_s: Some(velocity),
        normal_force_n,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let begin = LogEvent::begin(1, "s", 0, sample(0.0));
    let mut lines = vec![LogLine { t: 0.0, event: begin }];
    for step in 1..90 {
        let t = f64::from(step) / 60.0;
        lines.push(LogLine { t, event: LogEvent::moved(1, sample(t)) });
    }
    lines.push(LogLine { t: 1.5, event: LogEvent::End { contact: 1 } });
    ContactLog { lines }
}

/// What is felt of one stroke over a piece of the material.
pub fn features(material: SolidMaterial, piece: u64, rng: &mut Rng) -> Vec<f64> {
    let source = SolidNoise::new(material.parameters(), piece).unwrap();
    let surface = Surface::new(source, SIDE_M, SIDE_M).unwrap().wraps(false).micro_relief_m(0.0);
    let take =
        render(si_config(), surface, &random_stroke(rng), &Options { tail_s: 0.0, ..Options::default() });
    let spectrum = spectrum::third_octaves_from_db(&take.haptic[0], take.sample_rate_hz, 32_768, 6.0, 23);
    spectrum.iter().map(|db| db.max(-140.0)).collect()
}

/// Mean of several strokes over a piece of each material.
pub fn centroids(strokes: usize, piece: u64, rng: &mut Rng) -> [Vec<f64>; 7] {
    SolidMaterial::SEVEN.map(|material| {
        let felt: Vec<_> = (0..strokes).map(|_| features(material, piece, rng)).collect();
        (0..felt[0].len()).map(|i| felt.iter().map(|s| s[i]).sum::<f64>() / strokes as f64).collect()
    })
}

/// How often each material (row) was taken for each (column), in strokes over a piece.
pub fn confusions(centroids: &[Vec<f64>; 7], strokes: usize, piece: u64, rng: &mut Rng) -> [[usize; 7]; 7] {
    SolidMaterial::SEVEN.map(|material| {
        let mut row = [0; 7];
        for _ in 0..strokes {
            let felt = features(material, piece, rng);
            let nearest = (0..7)
                .min_by(|&a, &b| distance(&felt, &centroids[a]).total_cmp(&distance(&felt, &centroids[b])));
            row[nearest.unwrap()] += 1;
        }
        row
    })
}

/// Share of strokes named rightly.
pub fn score(confusions: &[[usize; 7]; 7]) -> f64 {
    let right: usize = (0..7).map(|m| confusions[m][m]).sum();
    right as f64 / confusions.iter().flatten().sum::<usize>() as f64
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}
