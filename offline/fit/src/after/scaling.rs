//! Scaling: a body larger, smaller, or of another material.
//!
//! ```text
//! frequency ∝ 1/size          d(ω) = α + β ω²          d′ = d · law′(ω′) / law(ω)
//! ```
//! The damping law (Rayleigh: mass and stiffness proportional) is fitted to the modes by iterated
//! re-weighting on log-ratios, so that a few odd modes do not bend it (Ren, Yeh & Lin 2013 fit the
//! same two parameters as a material's signature). A mode keeps its own ratio to the law, so that
//! bodies keep their character when their material is exchanged.

use asperity_dsp::diffuse::DiffuseBand;
use asperity_dsp::mode::Mode;
use std::f64::consts::PI;

/// Rounds of re-weighting.
const ROUNDS: usize = 30;

/// Damping of a material by frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampingLaw {
    /// α, 1/s.
    pub alpha_per_s: f64,
    /// β, s.
    pub beta_s: f64,
}

impl DampingLaw {
    /// The law of these modes; `None` without modes. Both parameters are at or above 0, not both 0.
    #[must_use]
    pub fn of(modes: &[Mode]) -> Option<Self> {
        let points: Vec<(f64, f64)> = modes
            .iter()
            .map(|m| ((2.0 * PI * m.frequency_hz).powi(2), m.decay_per_s))
            .filter(|(w, d)| *w > 0.0 && *d > 0.0 && w.is_finite() && d.is_finite())
            .collect();
        if points.is_empty() {
            return None;
        }
        let mean = points.iter().map(|p| p.1).sum::<f64>() / points.len() as f64;
        let mut law = Self { alpha_per_s: mean, beta_s: 0.0 };
        for _ in 0..ROUNDS {
            law = law.reweighted(&points);
        }
        Some(law)
    }

    /// Weighted least squares of relative deviations, weights falling with the last law's
    /// deviations.
    fn reweighted(self, points: &[(f64, f64)]) -> Self {
        let (mut s11, mut s12, mut s22, mut b1, mut b2) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &(w, d) in points {
            let predicted = self.alpha_per_s + self.beta_s * w;
            let off = (d / predicted).ln();
            // Relative errors of the law, and a weight that drops deviations beyond a quarter.
            let weight = 1.0 / (predicted * predicted * (1.0 + (off / 0.25).powi(2)).powi(2));
            s11 += weight;
            s12 += weight * w;
            s22 += weight * w * w;
            b1 += weight * d;
            b2 += weight * w * d;
        }
        let determinant = s11 * s22 - s12 * s12;
        let (alpha, beta) = if determinant > 1e-9 * s11 * s22 {
            ((s22 * b1 - s12 * b2) / determinant, (s11 * b2 - s12 * b1) / determinant)
        } else {
            (b1 / s11, 0.0)
        };
        // On the edge of what is allowed the other parameter is fitted alone.
        match (alpha >= 0.0, beta >= 0.0) {
            (true, true) => Self { alpha_per_s: alpha, beta_s: beta },
            (false, _) => Self { alpha_per_s: 0.0, beta_s: b2 / s22 },
            _ => Self { alpha_per_s: b1 / s11, beta_s: 0.0 },
        }
    }

    /// d at a frequency, 1/s.
    #[must_use]
    pub fn decay_per_s(&self, frequency_hz: f64) -> f64 {
        self.alpha_per_s + self.beta_s * (2.0 * PI * frequency_hz).powi(2)
    }
}

/// The modes of the same body `size` times as large: lower by `size`, damped as the law has it
/// there.
#[must_use]
pub fn scale_size(modes: &[Mode], size: f64) -> Vec<Mode> {
    let law = DampingLaw::of(modes);
    moved(modes, size, |old_hz, new_hz| {
        law.map_or(1.0, |law| law.decay_per_s(new_hz) / law.decay_per_s(old_hz).max(1e-12))
    })
}

/// The modes with their own material's damping exchanged for `law`.
#[must_use]
pub fn transfer_damping(modes: &[Mode], law: &DampingLaw) -> Vec<Mode> {
    let own = DampingLaw::of(modes);
    moved(modes, 1.0, |hz, _| own.map_or(1.0, |own| law.decay_per_s(hz) / own.decay_per_s(hz).max(1e-12)))
}

/// The bands of a body of these `modes`, `size` times as large and of another material's `law`, if
/// any: amplitudes stay, decays follow the modes' law.
pub fn rescale_bands(bands: &mut [DiffuseBand], modes: &[Mode], size: f64, law: Option<&DampingLaw>) {
    let own = DampingLaw::of(modes);
    let at = |law: Option<&DampingLaw>, hz: f64| law.map_or(1.0, |law| law.decay_per_s(hz).max(1e-12));
    for band in bands {
        let own_per_s = at(own.as_ref(), band.centre_hz);
        band.centre_hz /= size;
        band.width_hz /= size;
        let ratio = at(law.filter(|_| own.is_some()).or(own.as_ref()), band.centre_hz) / own_per_s;
        for part in &mut band.parts {
            part.decay_per_s *= ratio;
            part.energy /= ratio;
        }
    }
}

fn moved(modes: &[Mode], size: f64, factor: impl Fn(f64, f64) -> f64) -> Vec<Mode> {
    modes
        .iter()
        .map(|mode| {
            let frequency_hz = mode.frequency_hz / size;
            Mode {
                frequency_hz,
                decay_per_s: mode.decay_per_s * factor(mode.frequency_hz, frequency_hz),
                ..*mode
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::diffuse::DiffusePart;

    fn body(law: DampingLaw) -> Vec<Mode> {
        (1..40)
            .map(|k| {
                let frequency_hz = 200.0 * f64::from(k);
                let odd = if k % 10 == 3 { 6.0 } else { 1.0 };
                Mode {
                    frequency_hz,
                    decay_per_s: odd * law.decay_per_s(frequency_hz),
                    amplitude: 1.0,
                    phase_rad: 0.0,
                }
            })
            .collect()
    }

    const CERAMIC: DampingLaw = DampingLaw { alpha_per_s: 6.0, beta_s: 1e-7 };

    #[test]
    fn the_law_of_modes_is_found_despite_odd_modes() {
        let law = DampingLaw::of(&body(CERAMIC)).unwrap();
        assert!((law.alpha_per_s / 6.0 - 1.0).abs() < 0.03, "{law:?}");
        assert!((law.beta_s / 1e-7 - 1.0).abs() < 0.03, "{law:?}");
    }

    #[test]
    fn twice_the_size_is_an_octave_lower_and_damped_by_law() {
        let modes = body(CERAMIC);
        let large = scale_size(&modes, 2.0);
        for (mode, large) in modes.iter().zip(&large).filter(|(m, _)| m.frequency_hz % 2000.0 != 600.0) {
            assert!((large.frequency_hz - 0.5 * mode.frequency_hz).abs() < 1e-9);
            assert!((large.decay_per_s / CERAMIC.decay_per_s(large.frequency_hz) - 1.0).abs() < 0.05);
        }
    }

    #[test]
    fn another_material_gives_its_law_to_every_mode() {
        let wood = DampingLaw { alpha_per_s: 60.0, beta_s: 2e-6 };
        let wooden = transfer_damping(&body(CERAMIC), &wood);
        let law = DampingLaw::of(&wooden).unwrap();
        assert!((law.alpha_per_s / 60.0 - 1.0).abs() < 0.06 && (law.beta_s / 2e-6 - 1.0).abs() < 0.06);
        assert!(DampingLaw::of(&[]).is_none());
    }

    #[test]
    fn bands_ring_as_long_as_the_other_material_lets_them() {
        let wood = DampingLaw { alpha_per_s: 60.0, beta_s: 2e-6 };
        let part = DiffusePart { energy: 1e-3, decay_per_s: 3.0 * CERAMIC.decay_per_s(2000.0) };
        let mut bands = [DiffuseBand { centre_hz: 2000.0, width_hz: 300.0, parts: [part; 2] }];
        rescale_bands(&mut bands, &body(CERAMIC), 0.5, Some(&wood));
        let [DiffuseBand { centre_hz, width_hz, parts: [moved, _] }] = bands;
        assert_eq!((centre_hz, width_hz), (4000.0, 600.0));
        let ratio = moved.decay_per_s / (3.0 * wood.decay_per_s(4000.0));
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        // Amplitudes, √(4 d E), stay.
        let squares = [part, moved].map(|part| part.energy * part.decay_per_s);
        assert!((squares[1] / squares[0] - 1.0).abs() < 1e-12, "{squares:?}");
    }
}
