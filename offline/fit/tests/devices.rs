//! Profiles of made actuators: the equation of motion is integrated under an analytic sweep, with
//! noise, clipping and a lag; the numbers have to come back, or the sweep is refused with the
//! reason.

use asperity_dsp::actuator::{DeviceProfile, Equaliser, EqualiserState, Quantity};
use asperity_dsp::rng::Rng;
use asperity_fit::device::{Measured, Sweep, measure};
use std::f64::consts::TAU;

/// A made actuator and how it was recorded.
#[derive(Debug, Clone, Copy)]
struct Made {
    resonance_hz: f64,
    quality: f64,
    felt_m: f64,
    rate_hz: f64,
    seconds: f64,
    is_linear: bool,
    /// Noise over the largest acceleration.
    noise: f64,
    clip: Option<f64>,
    noise_before_clip: bool,
}

impl Made {
    fn drive(&self, t: f64) -> f64 {
        let (from_hz, to_hz): (f64, f64) = (20.0, 800.0_f64.min(0.4 * self.rate_hz));
        let fade = (t / 0.02).min((self.seconds - t) / 0.02).clamp(0.0, 1.0);
        let phase = if self.is_linear {
            from_hz * t + 0.5 * (to_hz - from_hz) * t * t / self.seconds
        } else {
            let octaves = (to_hz / from_hz).ln();
            from_hz * self.seconds / octaves * ((octaves * t / self.seconds).exp() - 1.0)
        };
        0.8 * fade * (TAU * phase).sin()
    }

    /// Fourth-order integration of x″ = ω₀² (D₀/Q u − x) − ω₀/Q x′.
    fn sweep(&self, seed: u64) -> Sweep {
        let w0 = TAU * self.resonance_hz;
        let force = |t: f64, x: f64, v: f64| {
            w0 * w0 * (self.felt_m / self.quality * self.drive(t) - x) - w0 / self.quality * v
        };
        let steps = (60_000.0 / self.rate_hz).ceil() as usize;
        let h = 1.0 / self.rate_hz / steps as f64;
        let (mut x, mut v) = (0.0, 0.0);
        let count = (self.seconds * self.rate_hz) as usize;
        let (mut drive, mut felt) = (Vec::new(), Vec::new());
        for n in 0..count {
            for i in 0..steps {
                let t = n as f64 / self.rate_hz + i as f64 * h;
                if i == 0 {
                    drive.push(self.drive(t));
                    felt.push(force(t, x, v));
                }
                let (a1, v1) = (force(t, x, v), v);
                let (a2, v2) = (force(t + 0.5 * h, x + 0.5 * h * v1, v + 0.5 * h * a1), v + 0.5 * h * a1);
                let (a3, v3) = (force(t + 0.5 * h, x + 0.5 * h * v2, v + 0.5 * h * a2), v + 0.5 * h * a2);
                let (a4, v4) = (force(t + h, x + h * v3, v + h * a3), v + h * a3);
                x += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
                v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            }
        }
        let peak = felt.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
        let mut rng = Rng::new(seed);
        let level = self.clip.map_or(f64::INFINITY, |share| share * peak);
        let recorded = felt.iter().map(|a| {
            let noise = self.noise * peak * rng.normal();
            let offset = 0.02 * peak;
            if self.noise_before_clip {
                (a + noise).clamp(-level, level) + offset
            } else {
                a.clamp(-level, level) + noise + offset
            }
        });
        // As a file of 32-bit float holds it.
        let acceleration_m_s2 = recorded.map(|a| f64::from(a as f32)).collect();
        Sweep { rate_hz: self.rate_hz, drive, acceleration_m_s2 }
    }

    /// Felt motion over drive at a frequency.
    fn response(&self, hz: f64) -> f64 {
        let r = hz / self.resonance_hz;
        self.felt_m / self.quality / (1.0 - r * r).hypot(r / self.quality)
    }
}

/// Gain of the equaliser at a frequency.
fn inverse(profile: &DeviceProfile, hz: f64) -> f64 {
    let rate_hz = 16_000.0;
    let design = Equaliser::new(profile, Quantity::Displacement, rate_hz).unwrap();
    let mut state = EqualiserState::default();
    let count = (2.0 * rate_hz) as usize;
    let (mut re, mut im) = (0.0, 0.0);
    for n in 0..count {
        let phase = TAU * hz * n as f64 / rate_hz;
        let y = state.tick(&design, phase.sin());
        if n >= count / 2 {
            re += y * phase.cos();
            im += y * phase.sin();
        }
    }
    re.hypot(im) / (count as f64 / 4.0)
}

fn twenty() -> Vec<Made> {
    let mut rng = Rng::new(62);
    (0..20)
        .map(|n| Made {
            resonance_hz: 60.0 * 5f64.powf(rng.uniform()),
            quality: 30f64.powf(f64::from(n) / 19.0),
            felt_m: 1e-5 * 10f64.powf(rng.uniform()),
            rate_hz: [2000.0, 8000.0, 44_100.0][n as usize % 3],
            seconds: 4.0 + 6.0 * rng.uniform(),
            is_linear: n % 2 == 0,
            noise: [0.0, 0.003, 0.01, 0.03][n as usize % 4],
            clip: (n % 3 == 1).then(|| 0.3 + 0.5 * rng.uniform()),
            noise_before_clip: n % 4 < 2,
        })
        .collect()
}

fn assert_right(made: &Made, measured: &Measured) {
    let Measured { profile, error, .. } = measured;
    let tolerated = if made.quality > 10.0 { 0.003 } else { 0.01 };
    assert!((profile.resonance_hz / made.resonance_hz - 1.0).abs() < tolerated, "{made:?}\n{profile:?}");
    assert!((profile.quality / made.quality - 1.0).abs() < 0.05, "{made:?}\n{profile:?}");
    assert!((profile.felt_at_resonance_m / made.felt_m - 1.0).abs() < 0.05, "{made:?}\n{profile:?}");
    assert!(error.resonance_hz > 0.0 && error.quality < 0.02 * profile.quality, "{error:?}");
    let [low, high] = profile.band_hz;
    assert!(high / low >= 1.3, "{made:?}\n{profile:?}");
    let at = |hz: f64| inverse(profile, hz) * made.response(hz) / made.felt_m;
    for n in 0..=24 {
        let hz = low * (high / low).powf(f64::from(n) / 24.0);
        let db = 20.0 * at(hz).log10();
        assert!(db.abs() < 1.0, "{hz} Hz: {db} dB, {made:?}\n{profile:?}");
    }
}

#[test]
fn twenty_made_actuators_come_back_from_their_sweeps() {
    for (seed, made) in twenty().into_iter().enumerate() {
        let measured = measure(&made.sweep(seed as u64));
        assert_right(&made, &measured.unwrap_or_else(|refused| panic!("{made:?}: {refused}")));
    }
}

#[test]
fn a_sweep_that_is_short_noisy_or_clipped_is_right_or_refused() {
    let mut rng = Rng::new(63);
    let mut refused = 0;
    for seed in 0..24 {
        let made = Made {
            resonance_hz: 60.0 * 5f64.powf(rng.uniform()),
            quality: 30f64.powf(rng.uniform()),
            felt_m: 2e-5,
            rate_hz: 4000.0,
            seconds: 0.3 + 1.5 * rng.uniform(),
            is_linear: seed % 2 == 0,
            noise: 0.01 * 100f64.powf(rng.uniform()),
            clip: (seed % 3 == 0).then(|| 0.05 + 0.3 * rng.uniform()),
            noise_before_clip: seed % 4 < 2,
        };
        match measure(&made.sweep(seed)) {
            Ok(measured) => assert_right(&made, &measured),
            Err(_) => refused += 1,
        }
    }
    assert!((1..24).contains(&refused), "{refused} of 24 refused");
}

#[test]
fn what_is_no_sweep_of_one_resonance_is_refused_with_the_reason() {
    let made = Made { noise: 0.001, clip: None, rate_hz: 4000.0, seconds: 3.0, ..twenty()[12] };
    let good = made.sweep(1);
    let with = |change: &dyn Fn(&mut Sweep)| {
        let mut sweep = good.clone();
        change(&mut sweep);
        measure(&sweep).unwrap_err().to_string()
    };
    let mut rng = Rng::new(2);
    let noise: Vec<f64> = good.drive.iter().map(|_| rng.normal()).collect();
    // A second resonance beside the first.
    let second = Made { resonance_hz: 1.3 * made.resonance_hz, ..made }.sweep(1);
    for (message, needle) in [
        (with(&|sweep| sweep.acceleration_m_s2.clone_from(&noise)), ""),
        (with(&|sweep| sweep.drive.iter_mut().for_each(|u| *u *= 2.0)), "its drive reaches 1.6"),
        (with(&|sweep| sweep.drive.fill(0.0)), "its drive is silent"),
        (with(&|sweep| sweep.acceleration_m_s2.fill(1.0)), "its acceleration is silent"),
        (with(&|sweep| sweep.acceleration_m_s2[7] = f64::NAN), "no numbers"),
        (with(&|sweep| sweep.drive.truncate(500)), "no number"),
        (
            with(&|sweep| {
                let sum = sweep.acceleration_m_s2.iter_mut().zip(&second.acceleration_m_s2);
                sum.for_each(|(a, b)| *a += b);
            }),
            "",
        ),
        // A stop: what is felt of it is no longer the drive's.
        (with(&|sweep| sweep.acceleration_m_s2.iter_mut().for_each(|a| *a += 0.02 * *a * a.abs())), ""),
    ] {
        assert!(message.contains(needle) && message.contains("; "), "{message}");
        println!("{message}");
    }
    let above = Made { resonance_hz: 15.0, ..made };
    println!("{}", measure(&above.sweep(3)).unwrap_err());
}
