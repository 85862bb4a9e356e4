//! Rubbing of a voice on its body.

use asperity_texture::height_field::MAX_BLOCK;

/// Rubbing of one contact during a stretch.
pub(crate) struct RubBlock {
    /// True where it rubs.
    pub(crate) rubs: bool,
    /// The line along which it does: a unit vector of u and v.
    pub(crate) along: [f64; 2],
    pub(crate) sweep_m_s: [f64; MAX_BLOCK],
    pub(crate) normal_force_n: [f64; MAX_BLOCK],
}

impl RubBlock {
    /// Nothing.
    pub(crate) const STILL: Self = Self {
        rubs: false,
        along: [1.0, 0.0],
        sweep_m_s: [0.0; MAX_BLOCK],
        normal_force_n: [0.0; MAX_BLOCK],
    };
}
