use super::design::noise_pole;
use super::*;
use crate::rng::Rng;
use std::vec::Vec;

const RATE_HZ: f64 = 44_100.0;

fn band(centre_hz: f64, width_hz: f64, energies: [f64; 2], decays: [f64; 2]) -> DiffuseBand {
    let part = |i: usize| DiffusePart { energy: energies[i], decay_per_s: decays[i] };
    DiffuseBand { centre_hz, width_hz, parts: [part(0), part(1)] }
}

/// Sixteen bands of one part each.
fn bands() -> Vec<DiffuseBand> {
    let at = |i: i32| 100.0 * 1.35_f64.powi(i);
    (0..16).map(|i| band(at(i), 0.3 * at(i), [1.0, 0.0], [20.0 + 5.0 * f64::from(i), 0.0])).collect()
}

/// Answer to strikes, (sample, impulse), cut into blocks.
fn answer(
    bands: &[DiffuseBand],
    (level, seed): (Level, u64),
    strikes: &[(usize, f32)],
    cuts: impl Iterator<Item = usize>,
) -> Vec<f32> {
    let group = DiffuseGroup::new(bands, 0.015, seed, RATE_HZ).unwrap();
    let mut bank = DiffuseBank::new(level, [group], [DiffuseState::REST]);
    let mut input = std::vec![0.0; 66_150];
    strikes.iter().for_each(|(at, impulse)| input[*at] = *impulse);
    let mut out = std::vec![0.0; input.len()];
    let mut at = 0;
    for n in cuts {
        let end = (at + n).min(out.len());
        bank.render(DiffuseInput { all: &input[at..end], rising: &[] }, &mut out[at..end]);
        at = end;
    }
    assert_eq!(at, out.len());
    if strikes.iter().all(|(at, _)| *at < 1000) {
        assert!(bank.is_at_rest() && bank.energy() == 0.0);
    }
    out
}

fn energy(samples: &[f32]) -> f64 {
    samples.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / RATE_HZ
}

#[test]
fn a_band_has_the_energy_and_the_decay_of_its_table() {
    let one = [band(3000.0, 400.0, [2.0, 0.0], [20.0, 0.0])];
    let two = [band(3000.0, 400.0, [2.0, 1.0], [20.0, 90.0])];
    // Amplitudes add, so the energy has a mixed term: 2 a₁ a₂ / (2 (d₁ + d₂)).
    let mixed = libm::sqrt(160.0 * 360.0) / 110.0;
    for (bands, expected) in [(&one, 2.0), (&two, 3.0 + mixed)] {
        let runs = (0..200).map(|seed| {
            let y = answer(bands, (Level::detect(), seed), &[(0, 1.0)], [66_150].into_iter());
            (energy(&y), energy(&y[4410..]))
        });
        let (sum, late) = runs.fold((0.0, 0.0), |a, b| (a.0 + b.0 / 200.0, a.1 + b.1 / 200.0));
        assert!((sum / expected - 1.0).abs() < 0.06, "{sum} instead of {expected}");
        if expected == 2.0 {
            // After 0.1 s e^(−2 · 20 · 0.1) of it is left.
            assert!((late / sum / libm::exp(-4.0) - 1.0).abs() < 0.12, "{}", late / sum);
        }
    }
}

#[test]
fn twice_the_momentum_is_twice_the_sound() {
    let bands = bands();
    let once = answer(&bands, (Level::detect(), 3), &[(100, 1e-3)], [66_150].into_iter());
    let twice = answer(&bands, (Level::detect(), 3), &[(100, 2e-3)], [66_150].into_iter());
    // Resonators of the softer one fall asleep first, far below the peak.
    let peak = twice.iter().fold(0.0_f32, |most, y| most.max(y.abs()));
    let off = once.iter().zip(&twice).map(|(a, b)| (2.0 * a - b).abs()).fold(0.0, f32::max);
    assert!(peak > 1e-4 && off <= 1e-3 * peak, "{off} of {peak}");
    assert!(once[100..4000].iter().zip(&twice[100..]).all(|(a, b)| 2.0 * a == *b));
    assert!(once[..=100].iter().all(|y| *y == 0.0));
    let later = answer(&bands, (Level::detect(), 3), &[(37_123, 1e-3)], [66_150].into_iter());
    assert_eq!(once[100..20_000], later[37_123..57_023]);
    let other = answer(&bands, (Level::detect(), 4), &[(100, 1e-3)], [66_150].into_iter());
    assert_ne!(once, other);
}

#[test]
fn any_split_into_blocks_and_every_instruction_set_give_the_same_bits() {
    let strikes = [(70, 0.3), (1000, 0.1), (1003, -0.2), (30_000, 1.0)];
    let mut rng = Rng::new(9);
    let whole = answer(&bands(), (Level::PORTABLE, 5), &strikes, [66_150].into_iter());
    for level in Level::available() {
        let mut left = 66_150;
        let cuts = core::iter::from_fn(|| {
            let n = (1 + rng.next_u32() as usize % 300).min(left);
            left -= n;
            (n > 0).then_some(n)
        });
        let cut = answer(&bands(), (level, 5), &strikes, cuts);
        assert!(whole == cut, "{level:?}");
    }
}

#[test]
fn what_rises_is_silent_at_the_strike_and_whole_after_its_rise() {
    let bands = [band(3000.0, 800.0, [1.0, 0.0], [5.0, 0.0])];
    let levels = |rising: bool| {
        let mut sums = [0.0; 2];
        for seed in 0..100 {
            let group = DiffuseGroup::new(&bands, 0.01, seed, RATE_HZ).unwrap();
            let mut bank = DiffuseBank::new(Level::detect(), [group], [DiffuseState::REST]);
            let (mut input, mut out) = ([0.0; 4410], [0.0; 4410]);
            input[0] = 1.0;
            let rising = if rising { &input[..] } else { &[] };
            bank.render(DiffuseInput { all: &input, rising }, &mut out);
            sums[0] += energy(&out[..44]);
            sums[1] += energy(&out[2205..]);
        }
        sums
    };
    let ([early, late], [risen_early, risen_late]) = (levels(false), levels(true));
    assert!(risen_early < 0.01 * early, "{risen_early} {early}");
    assert!((risen_late / late - 1.0).abs() < 0.02, "{risen_late} {late}");
}

/// Poles and 3 dB points from scipy 1.17 (`freqz` of two one-poles, the mean of |H|² over |H(0)|²).
#[test]
fn the_noise_has_the_width_that_scipy_finds() {
    for (width, pole) in [(0.02, 0.923_194_7), (0.1, 0.676_684_96), (0.3, 0.346_314_76)] {
        assert!((noise_pole(width) - pole).abs() < 1e-7);
    }
}

#[test]
fn numbers_that_no_band_has_are_refused_by_name() {
    for (field, bad) in [
        ("centre_hz", band(22_050.0, 100.0, [1.0; 2], [1.0; 2])),
        ("width_hz", band(1000.0, f64::NAN, [1.0; 2], [1.0; 2])),
        ("energy", band(1000.0, 100.0, [-1.0; 2], [1.0; 2])),
        ("decay_per_s", band(1000.0, 100.0, [1.0; 2], [f64::INFINITY; 2])),
    ] {
        assert_eq!(DiffuseGroup::new(&[bad], 0.01, 1, RATE_HZ).unwrap_err().field, field);
    }
}
