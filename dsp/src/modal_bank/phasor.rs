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
use super::design::{GroupOptions, Pole};
use super::job::Input;
use crate::DesignError;
use crate::mode::Mode;
use crate::simd::{Level, Set, at_level};
use core::array::from_fn;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

type Row = [f64; LANES];

/// Lanes that go together: with their coefficients, as many as there are registers for.
const WIDE: usize = 8;
/// Samples at a time: a stretch is mostly shorter than a cell of the grid, and what is not heard of
/// a chunk has to be emptied too.
const CHUNK: usize = 16;

/// Output of a sample in parts, which are added up once for all groups ([`total`]).
pub type LaneSums = [f64; WIDE];

/// The sum of the parts of an output.
#[must_use]
pub fn total(parts: &LaneSums) -> f64 {
    let four: [f64; 4] = from_fn(|l| parts[l] + parts[l + 4]);
    (four[0] + four[2]) + (four[1] + four[3])
}

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
        out: &mut [LaneSums],
    ) {
        for (at, out) in (0..).step_by(CHUNK).zip(out.chunks_mut(CHUNK)) {
            at_level!(level.at_most_256_bits(), s => self.run_chunk(s, index, state, (inputs, at), out));
        }
    }

    #[inline(always)]
    fn run_chunk<S: Set>(
        &self,
        s: S,
        index: usize,
        state: &mut PhasorState,
        (inputs, at): (&[Input<'_>], usize),
        out: &mut [LaneSums],
    ) {
        let [all_re, all_im] = &mut state.0;
        for from in (0..self.used).step_by(WIDE) {
            let part = |row: &Row| f64x8::from_slice(s, &row[from..from + WIDE]);
            let mut driven = [f64x8::splat(s, 0.0); CHUNK];
            for input in inputs {
                let gains = input.gains.get(index);
                let gains: [f64; WIDE] = from_fn(|l| gains.map_or(1.0, |gains| f64::from(gains.0[from + l])));
                let gains = f64x8::from_slice(s, &gains);
                for (x, impulse) in driven[..out.len()].iter_mut().zip(&input.impulses[at..]) {
                    *x += gains * f64x8::splat(s, f64::from(*impulse));
                }
            }
            let (lambda_re, lambda_im) = (part(&self.lambda[0]), part(&self.lambda[1]));
            let (gain_re, gain_im, direct) = (part(&self.gain[0]), part(&self.gain[1]), part(&self.direct));
            let (mut re, mut im) = (part(all_re), part(all_im));
            for (x, out) in driven.iter().zip(out.iter_mut()) {
                let turned = lambda_re * re - lambda_im * im + *x;
                im = lambda_re * im + lambda_im * re;
                re = turned;
                let heard = gain_im * re + gain_re * im + direct * *x;
                (f64x8::from_slice(s, out) + heard).store_slice(out);
            }
            re.store_slice(&mut all_re[from..from + WIDE]);
            im.store_slice(&mut all_im[from..from + WIDE]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::modal_bank::LaneGains;
    use crate::rng::Rng;
    use std::{vec, vec::Vec};

    /// Outputs of eleven modes that two inputs drive, in blocks of such a length.
    fn outputs(level: Level, block: usize) -> Vec<f64> {
        let mut rng = Rng::new(5);
        let mode = |rng: &mut Rng| Mode {
            frequency_hz: 100.0 + 9000.0 * rng.uniform(),
            decay_per_s: 5.0 + 50.0 * rng.uniform(),
            amplitude: rng.normal(),
            phase_rad: 0.0,
        };
        let modes: Vec<Mode> = (0..11).map(|_| mode(&mut rng)).collect();
        let impulses: [Vec<f32>; 2] = [0, 1].map(|_| (0..256).map(|_| rng.normal() as f32).collect());
        let gains = [LaneGains(from_fn(|_| rng.normal() as f32))];
        let options = GroupOptions { derivative: 2, ..GroupOptions::IMPULSE_RING };
        let group = PhasorGroup::new(&modes, 16e3, &options).unwrap();
        let (mut state, mut all) = (PhasorState::default(), Vec::new());
        for at in (0..256).step_by(block) {
            let mut out = vec![LaneSums::default(); block];
            let inputs = [
                Input { impulses: &impulses[0][at..], gains: &gains },
                Input { impulses: &impulses[1][at..], gains: &[] },
            ];
            group.run(level, 0, &mut state, &inputs, &mut out);
            all.extend(out.iter().map(total));
        }
        all
    }

    #[test]
    fn a_struck_group_sounds_as_its_modes_decaying_sines() {
        let modes: [Mode; LANES] = from_fn(|l| Mode {
            frequency_hz: 100.0 + 433.0 * l as f64,
            decay_per_s: 5.0 + l as f64,
            amplitude: 1.0 - 0.3 * l as f64,
            phase_rad: 0.2 * l as f64,
        });
        let group = PhasorGroup::new(&modes, 16e3, &GroupOptions::default()).unwrap();
        let (mut impulses, mut out) = ([0.0; 40], [LaneSums::default(); 40]);
        impulses[0] = 1.0;
        let inputs = [Input { impulses: &impulses, gains: &[] }];
        group.run(Level::detect(), 0, &mut PhasorState::default(), &inputs, &mut out);
        for (n, parts) in out.iter().enumerate() {
            let t = n as f64 / 16e3;
            let sine = |mode: &Mode| {
                let angle = core::f64::consts::TAU * mode.frequency_hz * t + mode.phase_rad;
                mode.amplitude * libm::exp(-mode.decay_per_s * t) * libm::sin(angle)
            };
            let wanted: f64 = modes.iter().map(sine).sum();
            assert!((total(parts) - wanted).abs() < 1e-9, "{n}: {} and not {wanted}", total(parts));
        }
    }

    #[test]
    fn every_processor_and_any_cut_has_the_same_bits() {
        let whole = outputs(Level::PORTABLE, 256);
        assert!(whole.iter().all(|x| x.is_finite()) && whole.iter().any(|x| x.abs() > 1.0));
        for level in Level::available() {
            for block in [1, 32, 128] {
                assert_eq!(outputs(level, block), whole, "{level:?}, blocks of {block}");
            }
        }
    }
}
