//! The six plates of the Hasti study, as the demo has them, and a flat one of their plastic.
#![allow(dead_code)]

use asperity::{Excitation, Surface};

/// A plate of the study.
pub fn surface(plate: &str) -> Surface {
    asperity_evidence::plates::plate(plate).unwrap().excitation(Excitation::BOTH)
}
