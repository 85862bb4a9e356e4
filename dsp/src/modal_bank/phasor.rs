//! Modes as phasors in `f64`: what is measured, where the bank is what is heard.
//!
//! ```text
//! z ← λ z + Σ gᵢ uᵢ        out += Im(c z) + h · Σ gᵢ uᵢ        λ = e^((−d + iω) step),  c = a e^(iφ)
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | λ, c; h, the direct term | one lane of [`PhasorGroup`] |
//! | z | one lane of [`PhasorState`] |
//!
//! The sum of the same terms as [`ModalBank`](super::ModalBank)'s, at ten times its price: struck
//! here and read there it is the same to 1e-7 of the peak as struck there and read here, where the
//! bank's states round to 2e-6. A retuned mode goes on at its amplitude and phase because z is
//! both.

use super::LANES;
use super::design::{GroupOptions, Pole};
use super::job::Input;
use crate::DesignError;
use crate::mode::Mode;
use core::array::from_fn;

type Row = [f64; LANES];

/// Coefficients of up to 16 modes; unused lanes are silent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhasorGroup {
    lambda: [Row; 2],
    gain: [Row; 2],
    direct: Row,
}

/// State of 16 modes between samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhasorState([Row; 2]);

impl PhasorGroup {
    /// Designs up to 16 modes; those at or above the Nyquist frequency are silent.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(modes: &[Mode], sample_rate_hz: f64, options: &GroupOptions) -> Result<Self, DesignError> {
        let mut group = Self { lambda: [[0.0; LANES]; 2], gain: [[0.0; LANES]; 2], direct: [0.0; LANES] };
        for (lane, mode) in modes.iter().enumerate().take(LANES) {
            let Some(pole) = Pole::new(mode, sample_rate_hz, options)? else { continue };
            let radius = libm::exp(-pole.decay);
            let polar = |size: f64, angle: f64| [size * libm::cos(angle), size * libm::sin(angle)];
            let (lambda, gain) = (polar(radius, pole.theta), polar(pole.amplitude, pole.phase_rad));
            for part in 0..2 {
                (group.lambda[part][lane], group.gain[part][lane]) = (lambda[part], gain[part]);
            }
            group.direct[lane] = pole.direct_correction + pole.passed;
        }
        Ok(group)
    }

    /// Adds the response to the inputs to `out`; the gains of an input for these modes are those at
    /// `index`, 1 where it has none.
    pub fn run(&self, index: usize, state: &mut PhasorState, inputs: &[Input<'_>], out: &mut [f64]) {
        let [re, im] = &mut state.0;
        for (n, out) in out.iter_mut().enumerate() {
            let mut x = [0.0; LANES];
            for input in inputs {
                let u = f64::from(input.impulses[n]);
                match input.gains.get(index) {
                    Some(gains) => x.iter_mut().zip(gains.0).for_each(|(x, gain)| *x += f64::from(gain) * u),
                    None => x.iter_mut().for_each(|x| *x += u),
                }
            }
            let [lambda_re, lambda_im] = &self.lambda;
            let turned: [Row; 2] = [
                from_fn(|l| lambda_re[l] * re[l] - lambda_im[l] * im[l] + x[l]),
                from_fn(|l| lambda_re[l] * im[l] + lambda_im[l] * re[l]),
            ];
            (*re, *im) = (turned[0], turned[1]);
            let each: Row =
                from_fn(|l| self.gain[1][l] * re[l] + self.gain[0][l] * im[l] + self.direct[l] * x[l]);
            *out += each.iter().sum::<f64>();
        }
    }

    /// Puts the modes to rest where none is louder than `amplitude`; whether they are.
    pub fn settle(&self, state: &mut PhasorState, amplitude: f64) -> bool {
        let square = |rows: &[Row; 2], l: usize| rows[0][l] * rows[0][l] + rows[1][l] * rows[1][l];
        let quiet = (0..LANES).all(|l| square(&self.gain, l) * square(&state.0, l) <= amplitude * amplitude);
        if quiet {
            *state = PhasorState::default();
        }
        quiet
    }
}

impl PhasorState {
    /// Tests whether nothing rings.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.0.as_flattened().iter().all(|x| *x == 0.0)
    }
}
