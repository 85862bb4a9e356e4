//! Output sums of a turn: sums over the modes become samples.

use super::LANES;
use super::design::TURN;
use crate::simd::Set;
use core::array::from_fn;
use fearless_simd::f32x8;
use fearless_simd::prelude::*;

/// One number for each lane. Aligned, because a vector across two cache lines costs two.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Row(pub [f32; LANES]);

/// Sums that all modes send to a turn, lane by lane: of the products with the coefficients at
/// [`super::design::OUT`].
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct TurnSums(pub [Row; SUMS]);

/// Rows of them.
pub(super) const SUMS: usize = 5;

/// The outputs of a turn, from the products with v − w, v, v − 2w, v + w and w.
#[inline(always)]
pub(super) fn outputs([last, one, minus, two, first]: [f32; SUMS]) -> [f32; TURN] {
    let (even, odd) = (one + minus, one - minus);
    [last + two + even, 2.0 * two + odd, 4.0 * two + even, 8.0 * two + odd + first]
}

/// The sum over all lanes of the outputs of a turn, each in the order of [`sum_row`]: eight lanes
/// at a time, then neighbours.
///
/// Products with powers of two are exact, so that it does not matter whether they are rounded
/// before the sum.
#[inline(always)]
pub(super) fn samples<T: Set>(token: T, turn: &TurnSums) -> [f32; TURN] {
    let half = |row: &Row, from: usize| f32x8::from_slice(token, &row.0[from..from + LANES / 2]);
    let [last, one, minus, two, first] = from_fn(|i| half(&turn.0[i], 0) + half(&turn.0[i], LANES / 2));
    let (even, odd) = (one + minus, one - minus);
    let times = |factor: f32, plus| {
        let factor = f32x8::splat(token, factor);
        if T::FUSED { two.mul_add(factor, plus) } else { two * factor + plus }
    };
    let a = token.add_neighbours(last + two + even, times(2.0, odd));
    let b = token.add_neighbours(times(4.0, even), times(8.0, odd) + first);
    let (low, high) = token.add_neighbours(a, b).split();
    (low + high).to_array()
}

/// The one order of summation: halves onto each other, then neighbours, then neighbours, then
/// halves.
#[inline(always)]
pub(super) fn sum_row(row: &Row) -> f32 {
    sum_halves(from_fn(|l| row.0[l] + row.0[l + 8]))
}

#[inline(always)]
fn sum_halves(half: [f32; LANES / 2]) -> f32 {
    let low = (half[0] + half[1]) + (half[2] + half[3]);
    let high = (half[4] + half[5]) + (half[6] + half[7]);
    low + high
}

#[cfg(test)]
mod tests {
    use super::super::design::out_of;
    use super::*;
    use crate::rng::Rng;
    use crate::simd::{Level, at_level};

    #[test]
    fn five_products_are_the_filter_of_two_taps() {
        let mut rng = Rng::new(5);
        for _ in 0..1000 {
            let h: [f64; 5] = from_fn(|_| rng.normal());
            let [v, w] = [rng.normal(), rng.normal()];
            let by = out_of(h);
            let products = [(v - w) * by[0], v * by[1], (v - 2.0 * w) * by[2], (v + w) * by[3], w * by[4]];
            for (n, y) in outputs(products.map(|x| x as f32)).into_iter().enumerate() {
                let exact = h[n] * (v - w) + h[n + 1] * w;
                assert!(
                    (f64::from(y) - exact).abs() < 1e-5 * (1.0 + exact.abs() + w.abs()),
                    "{n}: {y} {exact}"
                );
            }
        }
    }

    #[test]
    fn the_lanes_of_a_turn_add_up_to_its_samples() {
        let mut rng = Rng::new(6);
        let turn = TurnSums(from_fn(|_| Row(from_fn(|_| rng.normal() as f32))));
        let by_row = outputs(from_fn(|i| sum_row(&turn.0[i])));
        for (of_lanes, of_rows) in at_level!(Level::PORTABLE, s => samples(s, &turn)).into_iter().zip(by_row)
        {
            assert!((of_lanes - of_rows).abs() < 1e-4, "{of_lanes} {of_rows}");
        }
    }
}
