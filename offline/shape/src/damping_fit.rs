//! Damping of a material from the modes of a recording: (α, η, β) ≥ 0 of d = (α + ηω + βω²)/2.
//!
//! The sum of |ln(d_law / d_recorded)| is least: a mode that a fit has invented or cut short counts
//! little more than its neighbours, and a factor of two too long weighs as much as one too short.
//!
//! Learned from are resonances, not terms: a fit spends several modes on one resonance (an attack,
//! a room, a beat), and the short ones among them say nothing of the material. The strongest within
//! three half-widths stands for them, and what lies 40 dB below the strongest of all is left out.
//!
//! What such a law can do is little: decays of neighbouring modes of one real body differ by
//! factors, because supports, air and the shape of a mode take part. It gets the middle right, not
//! each mode.

use asperity_dsp::damping::Damping;
use asperity_dsp::mode::Mode;
use std::f64::consts::TAU;

/// Modes nearer than this many half-widths d / 2π (the wider one's) are one resonance.
const WIDTHS: f64 = 3.0;

/// Energy below the strongest mode at which a mode is no longer learned from, dB.
const FAINT_DB: f64 = 40.0;

/// Energy of a mode that rings freely: ∫ (A e^(−d t))² / 2 dt = A² / 4d.
fn energy(mode: &Mode) -> f64 {
    mode.amplitude * mode.amplitude / (4.0 * mode.decay_per_s)
}

/// The strongest mode of each resonance of a recording, the strongest resonance first.
///
/// Modes without damping, frequency or amplitude are left out; see the head of this file for what
/// counts as one resonance.
#[must_use]
pub fn resonances(modes: &[Mode]) -> Vec<Mode> {
    let mut damped: Vec<&Mode> =
        modes.iter().filter(|m| m.decay_per_s > 0.0 && m.frequency_hz > 0.0 && m.amplitude != 0.0).collect();
    damped.sort_by(|a, b| energy(b).total_cmp(&energy(a)));
    let faintest = damped.first().map_or(0.0, |m| energy(m) * 10f64.powf(-0.1 * FAINT_DB));
    let mut found: Vec<Mode> = Vec::new();
    for mode in damped.into_iter().take_while(|m| energy(m) >= faintest) {
        let one = |other: &Mode| {
            let half_width_hz = other.decay_per_s.max(mode.decay_per_s) / TAU;
            (other.frequency_hz - mode.frequency_hz).abs() <= WIDTHS * half_width_hz
        };
        if !found.iter().any(one) {
            found.push(*mode);
        }
    }
    found
}

/// Sum of |ln(d_law / d)| over the modes.
fn misfit(law: [f64; 3], modes: &[(f64, f64)]) -> f64 {
    let of = |(omega, d): &(f64, f64)| {
        let model = 0.5 * (law[0] + omega * (law[1] + omega * law[2]));
        if model > 0.0 { (model / d).ln().abs() } else { 50.0 }
    };
    modes.iter().map(of).sum()
}

/// The law nearest to some modes; none where no mode is damped.
#[must_use]
pub fn fit(modes: &[Mode]) -> Option<Damping> {
    let damped: Vec<(f64, f64)> =
        resonances(modes).iter().map(|m| (TAU * m.frequency_hz, m.decay_per_s)).collect();
    if damped.is_empty() {
        return None;
    }
    // What each term would be alone.
    let alone: [f64; 3] = std::array::from_fn(|term| {
        let mut ratios: Vec<f64> =
            damped.iter().map(|(omega, d)| 2.0 * d / omega.powi(term as i32)).collect();
        ratios.sort_by(f64::total_cmp);
        ratios[ratios.len() / 2]
    });
    let shares = [1.0, 0.3, 0.03, 0.0];
    let starts = (0..64).map(|i| [shares[i / 16], shares[i / 4 % 4], shares[i % 4]]);
    let best = starts
        .filter(|share| share.contains(&1.0))
        .map(|share| descend(std::array::from_fn(|i| share[i] * alone[i]), alone, &damped))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let [alpha_per_s, eta, beta_s] = best.1;
    Some(Damping { alpha_per_s, eta, beta_s })
}

/// Changes one term after the other by smaller and smaller factors as long as the misfit falls.
fn descend(mut law: [f64; 3], alone: [f64; 3], modes: &[(f64, f64)]) -> (f64, [f64; 3]) {
    let mut least = misfit(law, modes);
    for factor in [4.0, 2.0, 1.4, 1.15, 1.05, 1.02] {
        for _ in 0..20 {
            let before = least;
            for term in 0..3 {
                for value in [law[term] * factor, law[term] / factor, 0.0, 0.1 * alone[term]] {
                    let mut other = law;
                    other[term] = value;
                    let misfit = misfit(other, modes);
                    if misfit < least {
                        (least, law) = (misfit, other);
                    }
                }
            }
            if least >= before {
                break;
            }
        }
    }
    (least, law)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_is_recovered_although_a_fifth_of_the_modes_is_wrong() {
        let truth = Damping { alpha_per_s: 4.0, eta: 8e-4, beta_s: 2e-9 };
        let modes: Vec<Mode> = (1..=40)
            .map(|i| {
                let frequency_hz = 350.0 * f64::from(i);
                let wrong = if i % 5 == 0 { 6.0 } else { 1.0 + 0.1 * f64::from(i % 3 - 1) };
                let decay_per_s = wrong * truth.decay_per_s(frequency_hz);
                Mode { frequency_hz, decay_per_s, amplitude: 1.0, phase_rad: 0.0 }
            })
            .collect();
        let law = fit(&modes).unwrap();
        for hz in [400.0, 2000.0, 12_000.0] {
            let ratio = law.decay_per_s(hz) / truth.decay_per_s(hz);
            assert!((ratio - 1.0).abs() < 0.1, "{law:?} {hz} {ratio}");
        }
        assert!(fit(&[]).is_none());
    }

    #[test]
    fn short_terms_beside_a_resonance_and_faint_ones_teach_nothing() {
        let mode = |frequency_hz, decay_per_s, amplitude| Mode {
            frequency_hz,
            decay_per_s,
            amplitude,
            phase_rad: 0.0,
        };
        let clean: Vec<Mode> =
            (1..=9).map(|i| 500.0 * f64::from(i)).map(|hz| mode(hz, 4e-3 * hz, 1.0)).collect();
        let mut crowded = clean.clone();
        for m in &clean {
            // An attack of 2 ms on the same resonance, twice, and noise.
            crowded.push(mode(m.frequency_hz + 3.0, 500.0, 1.5));
            crowded.push(mode(m.frequency_hz - 40.0, 900.0, 0.8));
            crowded.push(mode(m.frequency_hz + 230.0, 300.0, 0.01));
        }
        assert_eq!(resonances(&crowded).len(), 9);
        let (of_clean, of_crowded) = (fit(&clean).unwrap(), fit(&crowded).unwrap());
        assert_eq!(of_clean, of_crowded);
    }
}
