//! Exact maps of the two linear regimes, free and pressed, over a sample and its binary fractions.
//!
//! The state is y = (d, p, v_s, v_f): gap d = x_s − x_m (negative when pressed), pad stretch
//! p = x_s − x_f, velocities of skin and finger. Over one sample the profile is a cubic
//! x_m(τ) = x₀ + c₁τ + c₂τ² + c₃τ³, τ from 0 to 1, and the normal force F and an optional push f on
//! the skin are constant. In the augmented vector (y, c₁, c₂, c₃, F, f) both regimes are
//! dz/dτ = G z, so that z(τ) = e^{Gτ} z. Heights enter only as differences: a contact 4 mm up (or a
//! metre) is as exact as one at zero.
//!
//! E(τ) = e^{Gτ} − 1 is summed by Taylor at a step short enough and doubled by E(2τ) = 2E + E²: the
//! unit is never squared, which keeps the undamped flow conservative to 1e-16 a sample.

use super::Probe;

/// Rows and columns of the augmented vector.
const N: usize = 9;
/// Deepest level: a sample is cut into at most 2⁶ = 64 ticks.
pub(super) const MAX_LEVEL: usize = 6;

type Matrix = [[f64; N]; N];

/// y⁺ = Σ columns · (d, p, v_s, v_f, c₁, c₂, c₃, F).
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(super) struct Map {
    pub columns: [[f64; 4]; 8],
}

impl Map {
    /// Applies the map. The profile and force terms are summed first: they are known early.
    #[inline(always)]
    pub fn apply(&self, y: [f64; 4], c: [f64; 3], force_n: f64) -> [f64; 4] {
        let m = &self.columns;
        let mut next = [0.0; 4];
        for (i, next) in next.iter_mut().enumerate() {
            let inputs = (m[4][i] * c[0] + m[5][i] * c[1]) + (m[6][i] * c[2] + m[7][i] * force_n);
            *next = ((m[0][i] * y[0] + inputs) + m[1][i] * y[1]) + (m[2][i] * y[2] + m[3][i] * y[3]);
        }
        next
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
        let mut maps = [Map { columns: [[0.0; 4]; 8] }; MAX_LEVEL + 1];
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
    // The cubic re-expanded at the running point: c₁' = 2c₂, c₂' = 3c₃.
    g[4][5] = 2.0;
    g[5][6] = 3.0;
    g
}

/// Largest row sum.
fn norm(m: &Matrix) -> f64 {
    m.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max)
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = [[0.0; N]; N];
    for (row, out) in a.iter().zip(c.iter_mut()) {
        for (x, other) in row.iter().zip(b.iter()) {
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
        Self { si: [1.0, 1.0, v, v, 1.0, 1.0, 1.0, force, push] }
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
        let mut columns = [[0.0; 4]; 8];
        for (j, column) in columns.iter_mut().enumerate() {
            *column = self.column(excess, j);
        }
        Map { columns }
    }
}
