//! Force: the force with which a surface answers a tool, beside carrying it and rubbing on
//! it.
//!
//! ```text
//! F_xy = a_xy + F_c (p − ∇h) − μ F_c v / |v|        F_z = a_z + F_c        |F| ≤ cap
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | F_c | the contact force, N |
//! | ∇h | [`SurfaceBlock::gradient`](crate::height_field::SurfaceBlock::gradient): relief pushes a tool down its slope |
//! | a | `force_n`: a force law that does not depend on F_c |
//! | p | `push_per_n`: one in proportion to F_c. A source whose texture has a law of its own puts its slope here, so that the
//! same relief does not push twice |
//! | cap | `cap_n`: what the device behind the surface gives at most |
//!
//! Most surfaces leave it empty: their slope is all they push with. It is made only where somebody
//! looks at slopes.

use crate::block::MAX_BLOCK;

/// Force of a surface at each sample of a block.
#[derive(Debug, Clone)]
pub struct ForceOutput {
    is_empty: bool,
    force_n: [[f64; 3]; MAX_BLOCK],
    push_per_n: [[f64; 2]; MAX_BLOCK],
    cap_n: [f64; MAX_BLOCK],
}

/// Force of a surface at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceAt {
    /// Along u, v and out of the surface, N.
    pub force_n: [f64; 3],
    /// Along u and v, N per newton of contact force.
    pub push_per_n: [f64; 2],
    /// The whole force is no larger, N.
    pub cap_n: f64,
}

impl ForceAt {
    /// A surface that pushes with its slope alone.
    pub const NONE: Self = Self { force_n: [0.0; 3], push_per_n: [0.0; 2], cap_n: f64::INFINITY };
}

impl Default for ForceOutput {
    fn default() -> Self {
        let ForceAt { force_n, push_per_n, cap_n } = ForceAt::NONE;
        Self {
            is_empty: true,
            force_n: [force_n; MAX_BLOCK],
            push_per_n: [push_per_n; MAX_BLOCK],
            cap_n: [cap_n; MAX_BLOCK],
        }
    }
}

impl ForceOutput {
    /// No answer at any sample.
    pub fn clear(&mut self) {
        if !self.is_empty {
            *self = Self::default();
        }
    }

    /// Tests whether no sample has one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.is_empty
    }

    /// The answer at a sample.
    #[must_use]
    pub fn at(&self, i: usize) -> ForceAt {
        ForceAt { force_n: self.force_n[i], push_per_n: self.push_per_n[i], cap_n: self.cap_n[i] }
    }

    /// Adds an answer with a weight; the lowest cap of those that have a weight counts.
    pub fn add(&mut self, i: usize, part: &ForceAt, weight: f64) {
        if weight == 0.0 {
            return;
        }
        self.is_empty = false;
        for (sum, part) in self.force_n[i].iter_mut().zip(part.force_n) {
            *sum += weight * part;
        }
        for (sum, part) in self.push_per_n[i].iter_mut().zip(part.push_per_n) {
            *sum += weight * part;
        }
        self.cap_n[i] = self.cap_n[i].min(part.cap_n);
    }

    /// Becomes `own` · itself + `share` · another one, at one sample.
    pub fn mix(&mut self, i: usize, own: f64, other: &Self, share: f64) {
        if self.is_empty && other.is_empty {
            return;
        }
        let mine = self.at(i);
        self.set(i, ForceAt::NONE);
        self.add(i, &mine, own);
        self.add(i, &other.at(i), share);
    }

    /// Multiplies the forces at a sample; the cap stays.
    pub(crate) fn scale(&mut self, i: usize, factor: f64) {
        if !self.is_empty {
            self.force_n[i] = self.force_n[i].map(|f| f * factor);
            self.push_per_n[i] = self.push_per_n[i].map(|p| p * factor);
        }
    }

    /// Replaces the answer at a sample.
    pub fn set(&mut self, i: usize, answer: ForceAt) {
        self.is_empty = false;
        (self.force_n[i], self.push_per_n[i], self.cap_n[i]) =
            (answer.force_n, answer.push_per_n, answer.cap_n);
    }
}

/// A force no larger than a cap, in its own direction.
#[must_use]
pub fn capped(force_n: [f64; 3], cap_n: f64) -> [f64; 3] {
    let size_n = force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
    if size_n > cap_n { force_n.map(|f| f * (cap_n / size_n)) } else { force_n }
}
