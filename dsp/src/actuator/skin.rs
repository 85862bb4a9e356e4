//! Skin of a finger: what an accelerometer on a fingertip has of the ground that its skin slides
//! over.
//!
//! ```text
//! ridge    ẏ = ω_r (x − y)                 ω_r = 2π 0.443 v / w     (a mean over the width w, at −3 dB)
//! tissue   m z̈ = k (y − z) + b (ẏ − ż)     k = 0.30 kN/m F^0.2,  b = 1.78 N·s/m F^0.2
//! ```
//!
//! | symbol | here | source |
//! |---|---|---|
//! | x | acceleration of the skin that touches, a point | the contact model |
//! | w | [`crate::micro_contact::Probe::ridge_m`], the part of a ridge that touches | 0.1 mm of the 0.5 mm from ridge to ridge (Scheibert, Leurent, Prevost, Debrégeas 2009), **chosen**: a mean over 0.46 mm falls by 20 dB to 1 kHz, where measured fingers rise |
//! | v, F | speed and force of the stroke | |
//! | k | stiffness of the pulp at light touch | **chosen**: on 1.48 kN/m, that of a fingertip in shear, 4 g ring at 97 Hz with Q 1.4; on 0.30 at 44 Hz with Q 0.6 no hump is left |
//! | b | damping of a fingertip | measured law in shear, **secondary** |
//! | F^0.2 | growth of both | **chosen**: F^0.35 in shear shakes a finger as F^0.3 |
//! | m | [`TISSUE_MASS_KG`] | **assumed**: less than half of a pulp of 10 g |
//!
//! A point follows every asperity; a ridge lies on many and moves by their mean, and the tissue
//! behind it follows only what is slow. Without them a fabric shakes a fingertip as v^0.1–0.6 with
//! third octaves that rise by 55–67 dB from 25 Hz to 1 kHz; measured fingers give v^0.7–0.9 and
//! 6–22 dB (`tests/finger_on_fabric.rs` holds ours). Slower than [`SLIDING_M_S`] a finger does not
//! slide but land and lift, and the mean along the path ends.

use core::f64::consts::PI;

/// Mass of the tissue that moves with a fingertip's skin below 100 Hz, kg.
pub const TISSUE_MASS_KG: f64 = 4e-3;
/// Stiffness of a fingertip at 1 N, N/m.
const STIFFNESS_N_M: f64 = 300.0;
/// Damping of a fingertip at 1 N, N·s/m.
const DAMPING_N_S_M: f64 = 1.78;
/// Both grow with the force to this power.
const FORCE_EXPONENT: f64 = 0.2;
/// Forces between which that holds, N.
const FORCE_N: (f64, f64) = (0.01, 100.0);
/// Frequency times width over speed at which a mean over that width is at −3 dB.
const HALF_POWER: f64 = 0.443;
/// Slowest slide, m/s.
pub const SLIDING_M_S: f64 = 0.02;
/// Cutoff of the ridge's low-pass at rest, Hz.
const AT_REST_HZ: f64 = 1000.0;

/// Coefficients at one speed and force (trapezoidal, so that they may change from sample to
/// sample).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skin {
    /// Gain of the ridge's integrator over 1 + itself.
    ridge: f64,
    /// tan(ω₀ / 2 rate) and twice the damping ratio.
    tissue: f64,
    damping: f64,
}

/// Memory of one contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SkinState {
    ridge: f64,
    tissue: [f64; 2],
}

impl Skin {
    /// Under a stroke of a speed, m/s, and a force, N; `ridge_m` is above 0.
    #[must_use]
    pub fn new(ridge_m: f64, speed_m_s: f64, normal_force_n: f64, sample_rate_hz: f64) -> Self {
        let tan = |frequency_hz: f64| libm::tan(PI * (frequency_hz / sample_rate_hz).min(0.45));
        let standing = (1.0 - speed_m_s / SLIDING_M_S).max(0.0);
        let ridge = tan(HALF_POWER * speed_m_s / ridge_m + AT_REST_HZ * standing * standing);
        let growth = libm::pow(normal_force_n.clamp(FORCE_N.0, FORCE_N.1), FORCE_EXPONENT);
        let (stiffness_n_m, damping_n_s_m) = (STIFFNESS_N_M * growth, DAMPING_N_S_M * growth);
        let rate_per_s = libm::sqrt(stiffness_n_m / TISSUE_MASS_KG);
        Self {
            ridge: ridge / (1.0 + ridge),
            tissue: tan(rate_per_s / (2.0 * PI)),
            damping: damping_n_s_m / (TISSUE_MASS_KG * rate_per_s),
        }
    }
}

impl SkinState {
    /// One sample of what the skin's point does → what the fingertip does, in the same unit.
    #[inline]
    pub fn tick(&mut self, skin: &Skin, x: f64) -> f64 {
        let step = skin.ridge * (x - self.ridge);
        let mean = self.ridge + step;
        self.ridge = mean + step;
        let [band, low] = &mut self.tissue;
        let Skin { tissue: g, damping, .. } = *skin;
        let high = (mean - (damping + g) * *band - *low) / (1.0 + g * (damping + g));
        let rate = g * high + *band;
        *band = g * high + rate;
        let place = g * rate + *low;
        *low = g * rate + place;
        place + damping * rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    const RATE_HZ: f64 = 44_100.0;

    /// Amplitude of what comes out of a sine of 1.
    fn gain(skin: &Skin, frequency_hz: f64) -> f64 {
        let mut state = SkinState::default();
        let (mut re, mut im) = (0.0, 0.0);
        for n in 0..88_200 {
            let turn = 2.0 * PI * frequency_hz * f64::from(n) / RATE_HZ;
            let y = state.tick(skin, libm::sin(turn));
            if n >= 44_100 {
                (re, im) = (re + y * libm::sin(turn), im + y * libm::cos(turn));
            }
        }
        libm::hypot(re, im) / 22_050.0
    }

    #[test]
    fn a_sine_is_felt_as_ridge_and_tissue_in_closed_form() {
        let (ridge_m, speed_m_s, force_n) = (0.1e-3, 0.1, 2.0);
        let skin = Skin::new(ridge_m, speed_m_s, force_n, RATE_HZ);
        let growth = libm::pow(force_n, 0.2);
        for frequency_hz in [20.0, 60.0, 97.0, 250.0, 1000.0] {
            let w = 2.0 * PI * frequency_hz;
            let corner_hz = 0.443 * speed_m_s / ridge_m;
            let ridge = 1.0 / libm::hypot(1.0, frequency_hz / corner_hz);
            let (k, b) = (300.0 * growth, 1.78 * growth);
            let tissue = libm::hypot(k, b * w) / libm::hypot(k - TISSUE_MASS_KG * w * w, b * w);
            let error = gain(&skin, frequency_hz) / (ridge * tissue) - 1.0;
            assert!(error.abs() < 0.01, "{frequency_hz} Hz: {error}");
        }
    }

    #[test]
    fn nothing_grows_at_any_speed_and_rest_returns_to_rest() {
        let mut rng = Rng::new(5);
        let mut state = SkinState::default();
        let mut most = 0.0f64;
        for _ in 0..4000 {
            let skin = Skin::new(0.46e-3, rng.uniform(), 10.0 * rng.uniform(), RATE_HZ);
            for _ in 0..64 {
                most = most.max(state.tick(&skin, 2.0 * rng.uniform() - 1.0).abs());
            }
        }
        assert!(most < 4.0, "{most}");
        let skin = Skin::new(0.46e-3, 0.1, 1.0, RATE_HZ);
        (0..44_100).for_each(|_| most = state.tick(&skin, 0.0).abs());
        assert!(most < 1e-12, "{most}");
    }

    #[test]
    fn it_is_what_bilinear_filters_written_apart_give() {
        // numpy: difference equations of bilinear([1], [1/wr, 1]) and bilinear([b, k], [m, b, k]),
        // corners pre-warped, impulse at 0; with the constants before they gave scipy's figures.
        let skin = Skin::new(0.1e-3, 0.1, 1.0, RATE_HZ);
        let mut state = SkinState::default();
        let mut response = [0.0; 6];
        response
            .iter_mut()
            .enumerate()
            .for_each(|(n, y)| *y = state.tick(&skin, f64::from(u8::from(n == 0))));
        let numpy = [
            1.539192961926e-04,
            6.052923342340e-04,
            1.180069538509e-03,
            1.715825889657e-03,
            2.214964919255e-03,
            2.679743043166e-03,
        ];
        for (ours, theirs) in response.iter().zip(numpy) {
            assert!((ours - theirs).abs() < 1e-9, "{response:?}");
        }
    }
}
