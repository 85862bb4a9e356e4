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
//! both. Products and sums round apart, in one order: the bits are those of every processor.

use super::LANES;
use super::design::{GRID_SAMPLES, GroupOptions, Pole};
use super::job::Input;
use crate::DesignError;
use crate::mode::Mode;
use crate::simd::{Level, at_level};
use core::array::from_fn;

type Row = [f64; LANES];

/// Lanes that go together: with their coefficients, as many as there are registers for.
const WIDE: usize = 8;
/// Samples at a time.
const CHUNK: usize = GRID_SAMPLES as usize;

/// Coefficients of up to 16 modes; unused lanes are silent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhasorGroup {
    lambda: [Row; 2],
    gain: [Row; 2],
    direct: Row,
    /// Lanes up to the last mode.
    used: usize,
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
        let (none, used) = ([[0.0; LANES]; 2], modes.len().min(LANES));
        let mut group = Self { lambda: none, gain: none, direct: [0.0; LANES], used };
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
    pub fn run(
        &self,
        level: Level,
        index: usize,
        state: &mut PhasorState,
        inputs: &[Input<'_>],
        out: &mut [f64],
    ) {
        for (at, out) in (0..).step_by(CHUNK).zip(out.chunks_mut(CHUNK)) {
            at_level!(level.at_most_256_bits(), s => self.run_chunk(index, state, (inputs, at), out));
        }
    }

    #[inline(always)]
    fn run_chunk(
        &self,
        index: usize,
        state: &mut PhasorState,
        (inputs, at): (&[Input<'_>], usize),
        out: &mut [f64],
    ) {
        for from in (0..self.used).step_by(WIDE) {
            let part = |row: &Row| -> [f64; WIDE] { from_fn(|l| row[from + l]) };
            let mut driven = [[0.0; WIDE]; CHUNK];
            for input in inputs {
                let gains = input.gains.get(index);
                let gains: [f64; WIDE] = from_fn(|l| gains.map_or(1.0, |gains| f64::from(gains.0[from + l])));
                for (x, impulse) in driven[..out.len()].iter_mut().zip(&input.impulses[at..]) {
                    *x = from_fn(|l| x[l] + gains[l] * f64::from(*impulse));
                }
            }
            let ([lambda_re, lambda_im], [gain_re, gain_im]) = (self.lambda.each_ref(), self.gain.each_ref());
            let [lambda_re, lambda_im] = [lambda_re, lambda_im].map(part);
            let [gain_re, gain_im, direct] = [gain_re, gain_im, &self.direct].map(part);
            let [mut re, mut im] = state.0.each_ref().map(part);
            for (x, out) in driven.iter().zip(out.iter_mut()) {
                let turned: [f64; WIDE] = from_fn(|l| lambda_re[l] * re[l] - lambda_im[l] * im[l] + x[l]);
                im = from_fn(|l| lambda_re[l] * im[l] + lambda_im[l] * re[l]);
                re = turned;
                let each: [f64; WIDE] =
                    from_fn(|l| gain_im[l] * re[l] + gain_re[l] * im[l] + direct[l] * x[l]);
                let four: [f64; WIDE / 2] = from_fn(|l| each[l] + each[l + WIDE / 2]);
                *out += (four[0] + four[2]) + (four[1] + four[3]);
            }
            state.0[0][from..from + WIDE].copy_from_slice(&re);
            state.0[1][from..from + WIDE].copy_from_slice(&im);
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
