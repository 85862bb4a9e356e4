//! The tests of haptic files in one program, but for the one that asks the formats' own decoders.

mod ahap_rules;
mod arrives;
mod formats;
mod reduction;
