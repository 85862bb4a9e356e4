//! Surface and rig told apart by several speeds.

use super::made::{Made, filtered, make, options};
use asperity_dsp::rng::Rng;
use asperity_fft::num_complex::Complex;
use asperity_stroke::{Track, fit};

#[test]
fn three_speeds_tell_the_rig_from_the_ground() {
    let (mut errors, mut tilts) = (Vec::new(), Vec::new());
    for seed in 0..5 {
        let mut rng = Rng::new(30 + seed);
        // A smooth colour of 4 dB: three slow waves over log f.
        let waves: Vec<[f64; 3]> =
            (0..3).map(|k| [rng.normal() * 3.0, rng.uniform() * 6.3, 0.35 + 0.3 * k as f64]).collect();
        let colour =
            |hz: f64| waves.iter().map(|[a, p, w]| a * (p + w * hz.max(1.0).log2()).sin()).sum::<f64>();
        let ground = Made { alpha: 1.5 + 1.7 * rng.uniform(), ..Made::default() };
        let strokes: Vec<_> = [0.04, 0.1, 0.25]
            .iter()
            .enumerate()
            .map(|(i, speed)| {
                let mut stroke =
                    make(&Made { speed_m_s: *speed, seed: 1000 + 10 * seed + i as u64, ..ground.clone() });
                filtered(&mut stroke.axes[0], |hz| Complex::new(10f64.powf(0.05 * colour(hz)), 0.0));
                stroke.speed_m_s = Track::Constant(*speed);
                stroke
            })
            .collect();
        let found = fit(&strokes, None, &options()).unwrap();
        let inside: Vec<_> =
            found.colour.iter().filter(|c| (20.0..1000.0).contains(&c.frequency_hz)).collect();
        let difference: Vec<(f64, f64)> =
            inside.iter().map(|c| (c.frequency_hz.log2(), c.gain_db - colour(c.frequency_hz))).collect();
        let count = difference.len() as f64;
        let (x, y) = (
            difference.iter().map(|d| d.0).sum::<f64>() / count,
            difference.iter().map(|d| d.1).sum::<f64>() / count,
        );
        let tilt = difference.iter().map(|d| (d.0 - x) * (d.1 - y)).sum::<f64>()
            / difference.iter().map(|d| (d.0 - x).powi(2)).sum::<f64>();
        tilts.push(tilt);
        errors.extend(difference.iter().map(|d| d.1 - y - tilt * (d.0 - x)));
    }
    let rms = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64).sqrt();
    assert!(rms(&errors) <= 0.4, "colour off by {} dB beside its tilt", rms(&errors));
    assert!(rms(&tilts) <= 0.15, "tilt off by {} dB an octave", rms(&tilts));
}
