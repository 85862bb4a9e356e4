//! Search: what may be modes in what is left.
//!
//! | file | from → to |
//! |---|---|
//! | [`limits`] | options and a segment → bounds of every parameter |
//! | [`sub_band`] | segment → decimated bands, levels from long to short |
//! | [`model_order`] | band → does it hold modes, how many |
//! | [`esprit`] | band → poles |
//! | [`candidates`] | residual → what may be modes |
//! | [`sum_of_modes`] | segment → may it be a sum of modes in noise |

pub(crate) mod candidates;
pub(crate) mod esprit;
pub(crate) mod limits;
pub(crate) mod model_order;
pub(crate) mod sub_band;
pub(crate) mod sum_of_modes;
