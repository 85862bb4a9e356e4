//! Modes that are left out because nobody would hear them, and those that cannot be.

use super::made::{PLAIN, body, mode};
use asperity_dsp::modal_bank::{Culling, ModeGroup, audible, design_group, sort_by_decay};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;

#[test]
fn culling_keeps_what_is_heard() {
    let modes = [
        mode(1_000.0, 5.0, 1.0, 0.0),
        // 60 dB below, in the next critical band and shorter: masked.
        mode(1_040.0, 8.0, 1e-3, 0.0),
        // As quiet and as near, but it outlasts the loud one: kept.
        mode(1_045.0, 1.0, 1e-3, 0.0),
        // As quiet, three octaves up: kept.
        mode(8_000.0, 50.0, 1e-3, 0.0),
        // Below the level threshold.
        mode(300.0, 1.0, 1e-5, 0.0),
        // Above Nyquist.
        mode(30_000.0, 1.0, 1.0, 0.0),
    ];
    let mut keep = [true; 6];
    assert_eq!(audible(&modes, 44_100.0, &Culling::default(), &mut keep), 3);
    assert_eq!(keep, [true, false, true, true, false, false]);
    let everything = Culling { level_db: f64::INFINITY, masking: false, ..Culling::default() };
    assert_eq!(audible(&modes, 96_000.0, &everything, &mut keep), 6);
}

/// Masking as the equations say, every mode against every other.
fn exactly_audible(modes: &[Mode]) -> Vec<bool> {
    let bark = |f: f64| 26.81 * f / (1960.0 + f) - 0.53;
    let loudest = modes.iter().fold(0.0_f64, |a, m| a.max(m.amplitude.abs()));
    let level = |m: &Mode| 80.0 + 20.0 * (m.amplitude.abs() / loudest).log10();
    let masks = |other: &Mode, mode: &Mode| {
        let (l, dz) = (level(other), bark(mode.frequency_hz) - bark(other.frequency_hz));
        let slope = if !(-3.0..8.0).contains(&dz) {
            f64::NEG_INFINITY
        } else if dz < -1.0 {
            17.0 * dz - 0.4 * l + 11.0
        } else if dz < 0.0 {
            (0.4 * l + 6.0) * dz
        } else if dz < 1.0 {
            -17.0 * dz
        } else {
            -17.0 - (dz - 1.0) * (17.0 - 0.15 * l)
        };
        let below = l - 6.025 - 0.275 * bark(other.frequency_hz) + slope;
        other.decay_per_s <= mode.decay_per_s && level(mode) < below
    };
    modes.iter().map(|m| level(m) >= 0.0 && !modes.iter().any(|other| masks(other, m))).collect()
}

#[test]
fn masking_in_bands_loses_nothing_audible() {
    let mut rng = Rng::new(31);
    for (count, equal_decays) in [(20, false), (400, false), (400, true), (4000, false)] {
        let mut modes = body(count, &mut rng);
        for m in &mut modes {
            m.amplitude = 10f64.powf(-4.0 * rng.uniform());
            if equal_decays {
                m.decay_per_s = 8.0;
            }
        }
        sort_by_decay(&mut modes);
        let mut keep = vec![false; count];
        let start = std::time::Instant::now();
        let kept = audible(&modes, 44_100.0, &Culling::default(), &mut keep);
        let took = start.elapsed();
        let exact = exactly_audible(&modes);
        println!("{count} modes: {kept} kept, exactly {:?}", exact.iter().filter(|k| **k).count());
        assert!(
            keep.iter().zip(&exact).all(|(keep, exact)| *keep || !exact),
            "{count}: something audible went"
        );
        let superfluous = keep.iter().zip(&exact).filter(|(keep, exact)| **keep && !**exact).count();
        assert!(superfluous * 50 <= count, "{count} modes: {superfluous} masked ones stay");
        assert!(took.as_millis() < 2_000, "{took:?}");
    }
}

#[test]
fn impossible_modes_are_refused_by_name() {
    let field = |m: Mode| design_group(&[m], 44_100.0, &PLAIN).unwrap_err().field;
    assert_eq!(field(mode(0.0, 1.0, 1.0, 0.0)), "frequency_hz");
    assert_eq!(field(mode(f64::NAN, 1.0, 1.0, 0.0)), "frequency_hz");
    assert_eq!(field(mode(100.0, -1.0, 1.0, 0.0)), "decay_per_s");
    assert_eq!(field(mode(100.0, 1.0, f64::INFINITY, 0.0)), "amplitude");
    assert_eq!(field(mode(100.0, 1.0, 1.0, f64::NAN)), "phase_rad");
    assert_eq!(design_group(&[], 0.0, &PLAIN), Ok(ModeGroup::SILENT));
    assert_eq!(design_group(&[mode(100.0, 1.0, 1.0, 0.0); 17], 44_100.0, &PLAIN).unwrap_err().field, "modes");
    assert_eq!(
        design_group(&[mode(100.0, 1.0, 1.0, 0.0)], -1.0, &PLAIN).unwrap_err().field,
        "sample_rate_hz"
    );
}
