//! A free exploration of a surface, and what an observer knows of it.
#![allow(dead_code)]

use super::render;
use asperity::offline::Options;
use asperity::{Config, Surface};
use asperity_evidence::observer::Percept;
use asperity_evidence::plates::Exploration;

/// What is felt, and what is heard, of a surface. `pascals`: of a full-scale sample. With the place
/// of the hand where the task gives it.
pub fn percepts(config: Config, surface: Surface, seed: u64, pascals: f64, placed: bool) -> [Percept; 2] {
    let exploration = Exploration::new(seed);
    let options = Options { tail_s: 0.0, ..Options::default() };
    let take = render(Config { seed, ..config }, surface, &exploration.log(), &options);
    exploration.percepts(&take, pascals, placed).first
}
