//! Matte lies above shiny, felt as displacement and as acceleration, plain and as skin weighs it,
//! at every speed of a hand.

use crate::common;

use asperity::offline::Options;
use asperity::{ActuatorSettings, Config, ContactBlock, Quantity, Tap};
use asperity_evidence::observer::constants::touch_threshold_m;
use asperity_evidence::spectrum;
use common::{SIDE_M, plate, render, render_tapped, si_config, stroke};

/// Power from 10 Hz to 1 kHz, each bin weighed.
fn power(roughness: f64, speed_m_s: f64, output: Quantity, weight: &dyn Fn(f64) -> f64) -> f64 {
    let actuators = vec![ActuatorSettings { full_scale: 1.0, output, ..ActuatorSettings::default() }];
    let mut sum = 0.0;
    for seed in 1..=4 {
        let config = Config { actuators: actuators.clone(), seed, ..Config::default() };
        let log = stroke(SIDE_M, speed_m_s, 0.6, 1.2);
        let take = render(config, plate(roughness), &log, &Options { tail_s: 0.0, ..Options::default() });
        let length = 16_384;
        let power = spectrum::power_spectrum(&take.haptic[0][8820..], length);
        let bin_hz = take.sample_rate_hz / length as f64;
        let at = |bin: usize| bin as f64 * bin_hz;
        let inside = (0..power.len()).filter(|bin| (10.0..=1000.0).contains(&at(*bin)));
        sum += inside.map(|bin| power[bin] * weight(at(bin))).sum::<f64>();
    }
    sum
}

#[test]
fn a_matte_plate_is_felt_3_db_above_a_shiny_one() {
    let mut least = f64::INFINITY;
    for speed_m_s in [0.03, 0.05, 0.1, 0.2, 0.3, 0.5] {
        let above_db = |output, weight: &dyn Fn(f64) -> f64| {
            10.0 * (power(0.9, speed_m_s, output, weight) / power(0.1, speed_m_s, output, weight)).log10()
        };
        let moved = above_db(Quantity::Displacement, &|_| 1.0);
        let shaken = above_db(Quantity::Acceleration, &|_| 1.0);
        let felt = above_db(Quantity::Displacement, &|f| touch_threshold_m(f).powi(-2));
        println!(
            "{speed_m_s} m/s: displacement {moved:.1} dB, acceleration {shaken:.1} dB, over threshold {felt:.1} dB"
        );
        least = least.min(moved).min(shaken).min(felt);
    }
    assert!(least >= 3.0, "{least} dB");
}

/// What passes under the finger, µm.
struct Heights(Vec<f32>);

impl Tap for Heights {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.0.extend(block.contact_samples.iter().map(|row| (1e6 * row.height_m) as f32));
    }
}

/// The law of the document, with the shipped growth and outer scale in it: power ∝ f^−α, α = 2.5 −
/// 1.5 R.
#[test]
fn what_passes_a_finger_falls_by_3_db_alpha_an_octave() {
    const SPEED_M_S: f64 = 0.1;
    const STROKES: u64 = 48;
    // 500 to 50 µm at that speed, in third octaves: 200 to 2000 Hz.
    const BANDS: usize = 11;
    for roughness in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let mut power = [0.0; BANDS];
        for seed in 1..=STROKES {
            let config = Config { seed, ..si_config() };
            let log = stroke(SIDE_M, SPEED_M_S, 0.6, 1.2);
            let mut heights = Heights(Vec::new());
            let options = Options { tail_s: 0.0, ..Options::default() };
            render_tapped(config, plate(roughness), &log, &options, &mut heights);
            let bands =
                spectrum::third_octaves_from_db(&heights.0[4410..], 44_100.0, 8192, 200.0, BANDS as u32);
            power.iter_mut().zip(bands).for_each(|(sum, db)| *sum += 10f64.powf(db / 10.0) / STROKES as f64);
        }
        let db = power.map(|power| 10.0 * power.log10());
        let middle = 0.5 * (BANDS - 1) as f64;
        let at = |band: usize| (band as f64 - middle) / 3.0;
        let slope = (0..BANDS).map(|band| at(band) * db[band]).sum::<f64>()
            / (0..BANDS).map(|band| at(band).powi(2)).sum::<f64>();
        // A third octave is the wider the higher it lies: 3.01 dB an octave less steep than its
        // density.
        let alpha = 2.5 - 1.5 * roughness;
        let off = slope - 3.0103 * (1.0 - alpha);
        println!("R {roughness}: {slope:.2} dB an octave, {off:+.3} off the law of α {alpha:.2}");
        assert!(off.abs() <= 0.1, "R {roughness}: {off} dB an octave");
    }
}
