//! After a fit: bodies of another size or material, several strikes of one body, tables of modes.
//!
//! | file | from → to |
//! |---|---|
//! | [`places`] | several strikes and the body's shapes → where they were made, and how well that explains them |
//! | [`scaling`] | modes → modes of another size or material |
//! | [`strikes`] | fits of several strikes → one body with amplitudes per strike |
//! | [`table`] | modes ↔ CSV, and other programs' tables |

pub mod places;
pub mod scaling;
pub mod strikes;
pub mod table;
