//! From a strike to partials: the whole way, by the kind of recording.

pub mod analysis;
pub mod contact;
pub(crate) mod one_mode;
pub mod ranking;
pub(crate) mod rumble;
pub mod sum_of_modes;
pub mod tail_to_attack;
pub(crate) mod ways;
