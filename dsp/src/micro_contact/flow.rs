//! Exact maps of the two linear regimes, free and pressed, over a sample and its binary fractions.
//!
//! The state is y = (d, p, v_s, v_f): gap d = x_s − x_m (negative when pressed), pad stretch p =
//! x_s − x_f, velocities of skin and finger. Over one sample the profile is a polynomial x_m(τ) =
//! x₀ + c₁τ + c₂τ² + c₃τ³ + c₄τ⁴, τ from 0 to 1, and the normal force F and an optional push f on
//! the skin are constant. In the augmented vector (y, c₁, c₂, c₃, F, f, c₄) both regimes are dz/dτ
//! = G z, so that z(τ) = e^{Gτ} z. Heights enter only as differences: a contact 4 mm up (or a
//! metre) is as exact as one at zero.
//!
//! E(τ) = e^{Gτ} − 1 is summed by Taylor at a step short enough and doubled by E(2τ) = 2E + E²: the
//! unit is never squared, which keeps the undamped flow conservative to 1e-16 a sample.

use super::Probe;
use super::quad::F64x4;

/// Rows and columns of the augmented vector.
const N: usize = 10;
/// Deepest level: a sample is cut into at most 2⁶ = 64 ticks.
pub(super) const MAX_LEVEL: usize = 6;

type Matrix = [[f64; N]; N];

/// y⁺ = Σ columns · (d, p, v_s, v_f, c₁, c₂, c₃, F, c₄).
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(super) struct Map {
    pub columns: [[f64; 4]; 9],
}

impl Map {
    /// Applies the map. The profile and force terms are summed first: they are known early.
    #[inline(always)]
    pub fn apply<Q: F64x4>(&self, y: Q, c: [f64; 4], force_n: f64) -> Q {
        let [_, _, _, _, _, _, _, force, fourth] = &self.columns;
        let inputs = y.load(fourth).times_plus(y.splat(c[3]), self.cubic(y, [c[0], c[1], c[2]]));
        self.apply_with(y, y.load(force).times_plus(y.splat(force_n), inputs))
    }

    /// Flow for a profile whose c₄ is zero.
    #[inline(always)]
    pub fn apply_cubic<Q: F64x4>(&self, y: Q, c: [f64; 3], force_n: f64) -> Q {
        let inputs = self.cubic(y, c);
        self.apply_with(y, y.load(&self.columns[7]).times_plus(y.splat(force_n), inputs))
    }

    #[inline(always)]
    fn cubic<Q: F64x4>(&self, y: Q, c: [f64; 3]) -> Q {
        let [_, _, _, _, slope, bend, twist, ..] = &self.columns;
        let inputs = y.load(slope).mul(y.splat(c[0]));
        let inputs = y.load(bend).times_plus(y.splat(c[1]), inputs);
        y.load(twist).times_plus(y.splat(c[2]), inputs)
    }

    /// Flow for a straight profile: it rises by `rise_m` within the sample.
    #[inline(always)]
    pub fn apply_straight<Q: F64x4>(&self, y: Q, rise_m: f64, force_n: f64) -> Q {
        let inputs = y.load(&self.columns[4]).mul(y.splat(rise_m));
        self.apply_with(y, y.load(&self.columns[7]).times_plus(y.splat(force_n), inputs))
    }

    #[inline(always)]
    fn apply_with<Q: F64x4>(&self, y: Q, inputs: Q) -> Q {
        let [gap, stretch, pad, finger, ..] = &self.columns;
        let positions = y.load(gap).times_plus(y.spread::<0>(), inputs);
        let positions = y.load(stretch).times_plus(y.spread::<1>(), positions);
        let velocities = y.load(pad).mul(y.spread::<2>());
        let velocities = y.load(finger).times_plus(y.spread::<3>(), velocities);
        positions.add(velocities)
    }
}

/// The maps of one regime, level 0 = the whole sample, level k = 2⁻ᵏ of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Regime {
    pub maps: [Map; MAX_LEVEL + 1],
    /// Response of y to a push of 1 N on the skin, held over the whole sample.
    pub push: [f64; 4],
}

impl Regime {
    /// Builds every level; `contact_stiffness_n_m` = 0 gives the free regime.
    pub fn new(probe: &Probe, contact_stiffness_n_m: f64, step_s: f64) -> Self {
        let units = Units::new(probe, step_s);
        let generator = generator(probe, contact_stiffness_n_m, step_s);
        let mut doublings = MAX_LEVEL;
        while norm(&generator) > 0.25 * libm::exp2(doublings as f64) {
            doublings += 1;
        }
        let mut excess = taylor(&generator, libm::exp2(-(doublings as f64)));
        let mut maps = [Map { columns: [[0.0; 4]; 9] }; MAX_LEVEL + 1];
        for level in (0..=doublings).rev() {
            if level <= MAX_LEVEL {
                maps[level] = units.map(&excess);
            }
            if level > 0 {
                excess = doubled(&excess);
            }
        }
        Self { maps, push: units.column(&excess, 8) }
    }
}

impl Regime {
    /// The mean of two regimes, weighed.
    ///
    /// `rest_m_n` is where (d, p) rests under 1 N. The mean of two maps rests elsewhere by a few
    /// picometres; its force column is made to fit, so that a pressed finger stays where it is.
    pub fn interpolate(&mut self, a: &Self, b: &Self, share: f64, rest_m_n: [f64; 2]) {
        for (own, (a, b)) in self.maps.iter_mut().zip(a.maps.iter().zip(&b.maps)) {
            for (own, (a, b)) in own.columns.iter_mut().zip(a.columns.iter().zip(&b.columns)) {
                for (own, (a, b)) in own.iter_mut().zip(a.iter().zip(b)) {
                    *own = a + share * (b - a);
                }
            }
            let [gap, stretch, .., force, _] = &mut own.columns;
            for (row, force) in force.iter_mut().enumerate() {
                let rest = if row < 2 { rest_m_n[row] } else { 0.0 };
                *force = rest - gap[row] * rest_m_n[0] - stretch[row] * rest_m_n[1];
            }
        }
        for (own, (a, b)) in self.push.iter_mut().zip(a.push.iter().zip(&b.push)) {
            *own = a + share * (b - a);
        }
    }
}

/// The flow's generator a sample, in displacements a sample and accelerations a sample².
fn generator(probe: &Probe, contact_stiffness_n_m: f64, step_s: f64) -> Matrix {
    let Probe { pad_mass_kg, finger_mass_kg, .. } = *probe;
    let (ks, bs) = (probe.pad_stiffness_n_m * step_s * step_s, probe.pad_damping_n_s_m * step_s);
    let mut g = [[0.0; N]; N];
    g[0][2] = 1.0;
    g[0][4] = -1.0;
    g[1][2] = 1.0;
    g[1][3] = -1.0;
    g[2][0] = -contact_stiffness_n_m * step_s * step_s / pad_mass_kg;
    g[2][1] = -ks / pad_mass_kg;
    g[2][2] = -bs / pad_mass_kg;
    g[2][3] = bs / pad_mass_kg;
    g[2][8] = 1.0;
    g[3][1] = ks / finger_mass_kg;
    g[3][2] = bs / finger_mass_kg;
    g[3][3] = -bs / finger_mass_kg;
    g[3][7] = -1.0;
    // The polynomial re-expanded at the running point: c₁' = 2c₂, c₂' = 3c₃, c₃' = 4c₄.
    g[4][5] = 2.0;
    g[5][6] = 3.0;
    g[6][9] = 4.0;
    g
}

/// Largest row sum.
fn norm(m: &Matrix) -> f64 {
    m.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max)
}

/// Half of a flow's matrix is zero: what drives it does not answer to it.
fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = [[0.0; N]; N];
    for (row, out) in a.iter().zip(c.iter_mut()) {
        for (x, other) in row.iter().zip(b.iter()).filter(|(x, _)| **x != 0.0) {
            for (sum, y) in out.iter_mut().zip(other.iter()) {
                *sum += x * y;
            }
        }
    }
    c
}

/// e^{G·tau} − 1 for ‖G·tau‖ ≤ 1/4: fourteen terms leave 1e-21.
fn taylor(generator: &Matrix, tau: f64) -> Matrix {
    let scaled = generator.map(|row| row.map(|x| x * tau));
    let mut term = scaled;
    let mut sum = scaled;
    for k in 2..=14 {
        term = product(&term, &scaled).map(|row| row.map(|x| x / f64::from(k)));
        add(&mut sum, &term);
    }
    sum
}

/// E(2τ) = 2E + E².
fn doubled(excess: &Matrix) -> Matrix {
    let mut sum = product(excess, excess);
    add(&mut sum, excess);
    add(&mut sum, excess);
    sum
}

fn add(sum: &mut Matrix, term: &Matrix) {
    for (row, t) in sum.iter_mut().zip(term.iter()) {
        for (x, t) in row.iter_mut().zip(t.iter()) {
            *x += t;
        }
    }
}

/// From displacements a sample to SI units.
struct Units {
    /// SI value of one scaled unit of each component.
    si: [f64; N],
}

impl Units {
    fn new(probe: &Probe, step_s: f64) -> Self {
        let (v, square) = (1.0 / step_s, step_s * step_s);
        let force = probe.finger_mass_kg / square;
        let push = probe.pad_mass_kg / square;
        Self { si: [1.0, 1.0, v, v, 1.0, 1.0, 1.0, force, push, 1.0] }
    }

    /// One column of 1 + E, SI.
    fn column(&self, excess: &Matrix, j: usize) -> [f64; 4] {
        let mut column = [0.0; 4];
        for (i, out) in column.iter_mut().enumerate() {
            let unit = if i == j { 1.0 } else { 0.0 };
            *out = unit + excess[i][j] * self.si[i] / self.si[j];
        }
        column
    }

    fn map(&self, excess: &Matrix) -> Map {
        let mut columns = [[0.0; 4]; 9];
        for (j, column) in columns.iter_mut().enumerate() {
            // The push has no column in a map.
            *column = self.column(excess, if j == 8 { 9 } else { j });
        }
        Map { columns }
    }
}

#[cfg(test)]
mod tests {
    use super::super::exact_event::at_end;
    use super::super::quad::{F64x4, Unfused};
    use super::*;
    use crate::simd::BASE;
    use fearless_simd::{SimdBase, f64x4};

    const STEP_S: f64 = 1.0 / 44_100.0;

    fn apply(map: &Map, y: [f64; 4], c: [f64; 4], force_n: f64) -> [f64; 4] {
        let zero: f64x4<_> = SimdBase::splat(BASE, 0.0);
        map.apply(Unfused(zero).load(&y), c, force_n).array()
    }

    #[test]
    fn a_free_unloaded_pad_flies_straight() {
        let free = Regime::new(&Probe::default(), 0.0, STEP_S);
        let next = apply(&free.maps[0], [1e-3, 0.0, 0.2, 0.2], [0.0; 4], 0.0);
        assert_eq!((next[1], next[2], next[3]), (0.0, 0.2, 0.2));
        assert!((next[0] - 1e-3 - 0.2 * STEP_S).abs() < 1e-18);
    }

    #[test]
    fn a_pressed_skin_without_damper_turns_as_a_harmonic_oscillator() {
        let probe = Probe { pad_stiffness_n_m: 1e-3, pad_damping_n_s_m: 0.0, ..Probe::default() };
        let pressed = Regime::new(&probe, 5e4, STEP_S);
        let omega = libm::sqrt(5e4 / probe.pad_mass_kg);
        let next = apply(&pressed.maps[0], [-1e-5, 0.0, 0.1, 0.0], [0.0; 4], 0.0);
        let (sin, cos) = (libm::sin(omega * STEP_S), libm::cos(omega * STEP_S));
        assert!((next[0] - (-1e-5 * cos + 0.1 / omega * sin)).abs() < 5e-14, "{next:?}");
        assert!((next[2] - (1e-5 * omega * sin + 0.1 * cos)).abs() < 1e-9, "{next:?}");
    }

    #[test]
    fn two_half_steps_make_a_whole_one_at_every_level() {
        for stiffness in [0.0, 5e4, 1e8] {
            let regime = Regime::new(&Probe::default(), stiffness, STEP_S);
            for level in 1..=MAX_LEVEL {
                let (y, c) = ([1e-5, -2e-5, 0.03, -0.04], [3e-6, -2e-6, 1e-6, -4e-6]);
                // A level-k map takes its polynomial over a whole sample and covers the first 2⁻ᵏ
                // of it.
                let t = libm::exp2(-(level as f64));
                let half = apply(&regime.maps[level], y, c, 0.5);
                let later = at_end(c, t);
                let twice = apply(&regime.maps[level], half, later, 0.5);
                let once = apply(&regime.maps[level - 1], y, c, 0.5);
                for (a, b) in twice.iter().zip(&once) {
                    assert!((a - b).abs() <= 1e-12 * (1.0 + b.abs()), "level {level}: {twice:?} {once:?}");
                }
            }
        }
    }
}
