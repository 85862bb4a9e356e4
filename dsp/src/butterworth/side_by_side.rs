//! Filters side by side: two of each of four contacts. Alone a filter waits for itself most of the time.

use super::{Butterworth, State};
use crate::simd::{Level, at_level};
use core::f64::consts::SQRT_2;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

/// How many contacts go side by side.
pub const LANES: usize = 4;

/// What each of the two filters of each contact is given, and gives.
pub type Signals = [[f64; LANES]; 2];

/// The filters of up to [`LANES`] contacts, and where they stand.
#[derive(Debug, Clone, Copy, Default)]
pub struct SideBySide {
    of: [Four; 2],
}

/// One filter of each contact, number by number.
#[derive(Debug, Clone, Copy, Default)]
struct Four {
    a1: [f64; LANES],
    a2: [f64; LANES],
    a3: [f64; LANES],
    band_to_band: [f64; LANES],
    cross: [f64; LANES],
    input_to_low: [f64; LANES],
    band: [f64; LANES],
    low: [f64; LANES],
}

/// The same in vectors.
#[derive(Clone, Copy)]
struct Lanes<S: Simd> {
    a1: f64x4<S>,
    a2: f64x4<S>,
    a3: f64x4<S>,
    band_to_band: f64x4<S>,
    cross: f64x4<S>,
    input_to_low: f64x4<S>,
    band: f64x4<S>,
    low: f64x4<S>,
}

impl SideBySide {
    /// Nobody's filters: they give nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A contact takes a lane (below [`LANES`]) with its two filters.
    pub fn enter(&mut self, lane: usize, filters: [&Butterworth; 2], states: [State; 2]) {
        for ((four, filter), state) in self.of.iter_mut().zip(filters).zip(states) {
            let Four { a1, a2, a3, band_to_band, cross, input_to_low, band, low } = four;
            let numbers = [
                (a1, filter.a1),
                (a2, filter.a2),
                (a3, filter.a3),
                (band_to_band, filter.band_to_band),
                (cross, filter.cross),
                (input_to_low, filter.input_to_low),
                (band, state.band),
                (low, state.low),
            ];
            for (lanes, number) in numbers {
                if let Some(own) = lanes.get_mut(lane) {
                    *own = number;
                }
            }
        }
    }

    /// Where a lane's filters stand.
    #[must_use]
    pub fn states(&self, lane: usize) -> [State; 2] {
        self.of.map(|Four { band, low, .. }| {
            let own = |lanes: [f64; LANES]| lanes.get(lane).copied().unwrap_or(0.0);
            State { band: own(band), low: own(low) }
        })
    }

    /// Puts the high-pass responses in the place of signals; the bits of every lane are those of [`State::tick`].
    pub fn high_pass(&mut self, level: Level, signals: &mut [Signals]) {
        // Four numbers fill no wider vector.
        at_level!(level.at_most_256_bits(), s => {
            let [mut a, mut b] = [self.of[0].load(s), self.of[1].load(s)];
            for [first, second] in signals {
                a.high_pass(first);
                b.high_pass(second);
            }
            self.of[0].store(&a);
            self.of[1].store(&b);
        });
    }
}

impl Four {
    #[inline(always)]
    fn load<S: Simd>(&self, s: S) -> Lanes<S> {
        Lanes {
            a1: f64x4::load_array_ref(s, &self.a1),
            a2: f64x4::load_array_ref(s, &self.a2),
            a3: f64x4::load_array_ref(s, &self.a3),
            band_to_band: f64x4::load_array_ref(s, &self.band_to_band),
            cross: f64x4::load_array_ref(s, &self.cross),
            input_to_low: f64x4::load_array_ref(s, &self.input_to_low),
            band: f64x4::load_array_ref(s, &self.band),
            low: f64x4::load_array_ref(s, &self.low),
        }
    }

    #[inline(always)]
    fn store<S: Simd>(&mut self, lanes: &Lanes<S>) {
        (self.band, self.low) = (lanes.band.to_array(), lanes.low.to_array());
    }
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn high_pass(&mut self, signal: &mut [f64; LANES]) {
        let s = self.low.token();
        let input = f64x4::load_array_ref(s, signal);
        let v3 = input - self.low;
        let band = self.a1 * self.band + self.a2 * v3;
        let low = (self.low + self.a2 * self.band) + self.a3 * v3;
        let before = self.band;
        self.band = self.band_to_band * before + self.cross * v3;
        self.low = (self.low + self.cross * before) + self.input_to_low * v3;
        *signal = (input - f64x4::splat(s, SQRT_2) * band - low).to_array();
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::rng::Rng;
    use std::{vec, vec::Vec};

    #[test]
    fn high_passes_of_four_contacts_give_the_bits_of_each_alone_wherever_blocks_are_cut() {
        let mut rng = Rng::new(12);
        for level in Level::available() {
            let filters: [[Butterworth; 2]; LANES] = core::array::from_fn(|_| {
                [1.0, 50.0].map(|least_hz| {
                    Butterworth::new(least_hz * (1.0 + 20.0 * rng.uniform()), 44_100.0).unwrap()
                })
            });
            let mut alone = [[State::default(); 2]; LANES];
            let mut left = 3000;
            let mut beside = alone;
            while left > 0 {
                let n = (1 + (90.0 * rng.uniform()) as usize).min(left);
                let mut signals = vec![[[0.0; LANES]; 2]; n];
                for signal in signals.as_flattened_mut().as_flattened_mut() {
                    *signal = rng.normal();
                }
                let expected: Vec<Signals> = signals
                    .iter()
                    .map(|signal| {
                        let mut out = *signal;
                        for (lane, states) in alone.iter_mut().enumerate() {
                            for which in 0..2 {
                                let input = signal[which][lane];
                                out[which][lane] = states[which].tick(&filters[lane][which], input).high;
                            }
                        }
                        out
                    })
                    .collect();
                let mut together = SideBySide::new();
                for (lane, [a, b]) in filters.iter().enumerate() {
                    together.enter(lane, [a, b], beside[lane]);
                }
                together.high_pass(level, &mut signals);
                for (lane, states) in beside.iter_mut().enumerate() {
                    *states = together.states(lane);
                }
                assert_eq!((signals, beside), (expected, alone), "{level:?}");
                left -= n;
            }
        }
    }
}
