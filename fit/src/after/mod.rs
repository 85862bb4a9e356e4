//! After a fit: bodies of another size or material, several strikes of one body, tables of modes.
//!
//! | file | from → to |
//! |---|---|
//! | [`masking`] | modes → the order in which nobody would miss them |
//! | [`scaling`] | modes → modes of another size or material |
//! | [`strikes`] | fits of several strikes → one body with amplitudes per strike |
//! | [`table`] | modes ↔ CSV, and other programs' tables |

pub mod masking;
pub mod scaling;
pub mod strikes;
pub mod table;
