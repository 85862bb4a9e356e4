//! The spline between four texels.

use super::place::{AxisPlaces, ROOM};
use super::vector::{Lanes, Rows, Vector};

/// Values and slopes of a block, each on its own so that lanes fill vectors.
#[derive(Debug, Clone)]
pub struct Samples {
    /// Values of the map.
    pub value: [f64; ROOM],
    /// Slopes along u, per metre.
    pub slope_u: [f64; ROOM],
    /// Slopes along v, per metre.
    pub slope_v: [f64; ROOM],
}

impl Samples {
    /// Nothing yet.
    pub const EMPTY: Self = Self { value: [0.0; ROOM], slope_u: [0.0; ROOM], slope_v: [0.0; ROOM] };

    /// Cell of one value everywhere, level where slopes are read.
    pub fn fill<const SLOPES: bool>(&mut self, value: f64) {
        self.value.fill(value);
        if SLOPES {
            self.slope_u.fill(0.0);
            self.slope_v.fill(0.0);
        }
    }
}

/// The spline between four texels as a polynomial, Σ aᵢⱼ xⁱ yʲ with x, y the fractions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// aᵢⱼ by i, then j.
    pub(super) powers: [[f64; 4]; 4],
}

/// Four rows of B-spline coefficients c₀ … c₃ → the powers 0 … 3 of the fraction from c₁ to c₂, in
/// every column.
#[inline(always)]
fn to_powers<V: Rows>(v: V, c: [V::Lanes; 4]) -> [V::Lanes; 4] {
    let (half, sixth) = (v.splat(0.5), v.splat(1.0 / 6.0));
    let outer = c[0] + c[2];
    [
        (v.splat(4.0) * c[1] + outer) * sixth,
        half * (c[2] - c[0]),
        half * outer - c[1],
        (c[3] - c[0] + v.splat(3.0) * (c[1] - c[2])) * sixth,
    ]
}

impl Cell {
    /// The cell amid four rows of four coefficients.
    #[inline(always)]
    pub(super) fn new<V: Rows>(v: V, coefficients: [&[f32; 4]; 4]) -> Self {
        let [a, b, c, d] = coefficients;
        let along_v = v.transpose(to_powers(v, [v.widen(a), v.widen(b), v.widen(c), v.widen(d)]));
        let mut powers = [[0.0; 4]; 4];
        for (to, row) in powers.iter_mut().zip(to_powers(v, along_v)) {
            v.store(row, to);
        }
        Self { powers }
    }

    /// Values, and slopes if `SLOPES`, at the places `start..end`, N side by side. What is written
    /// beyond `end`, up to whole vectors, means nothing.
    #[inline(always)]
    pub(super) fn block<const N: usize, V: Vector<N>, const SLOPES: bool>(
        &self,
        v: V,
        [x, y]: [&AxisPlaces; 2],
        (start, end): (usize, usize),
        out: &mut Samples,
    ) {
        // By power of y: a polynomial in x, and its derivative.
        let p = &self.powers;
        let (mut heights, mut slopes) = ([[v.splat(0.0); 4]; 4], [[v.splat(0.0); 3]; 4]);
        for j in 0..4 {
            heights[j] = [v.splat(p[0][j]), v.splat(p[1][j]), v.splat(p[2][j]), v.splat(p[3][j])];
            slopes[j] = [heights[j][1], v.splat(2.0 * p[2][j]), v.splat(3.0 * p[3][j])];
        }
        let (two, three) = (v.splat(2.0), v.splat(3.0));
        for n in (start..end).step_by(N) {
            let (t, u) = (v.load(x.fraction(n)), v.load(y.fraction(n)));
            let mut level = [v.splat(0.0); 4];
            for j in 0..4 {
                level[j] = cubic(heights[j], t);
            }
            put(v, cubic(level, u), &mut out.value, n);
            if SLOPES {
                let mut rise = [v.splat(0.0); 4];
                for j in 0..4 {
                    rise[j] = quadratic(slopes[j], t);
                }
                let along_u = cubic(rise, u);
                let along_v = quadratic([level[1], two * level[2], three * level[3]], u);
                put(v, along_u * v.load(x.slope(n)), &mut out.slope_u, n);
                put(v, along_v * v.load(y.slope(n)), &mut out.slope_v, n);
            }
        }
    }
}

/// a₀ + a₁ t + a₂ t² + a₃ t³.
#[inline(always)]
fn cubic<L: Lanes>(a: [L; 4], t: L) -> L {
    quadratic([a[1], a[2], a[3]], t) * t + a[0]
}

/// a₀ + a₁ t + a₂ t².
#[inline(always)]
fn quadratic<L: Lanes>(a: [L; 3], t: L) -> L {
    (a[2] * t + a[1]) * t + a[0]
}

/// Writes N places from `n` on; a block has room for whole vectors.
#[inline(always)]
fn put<const N: usize, V: Vector<N>>(v: V, lanes: V::Lanes, values: &mut [f64; ROOM], n: usize) {
    if let Some(to) = values.get_mut(n..).and_then(<[f64]>::first_chunk_mut) {
        v.store(lanes, to);
    }
}
