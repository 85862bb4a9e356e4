//! Random scenes at the ends of what is accepted: finite, and no harder than physics explains.
//!
//! `examples/accepted_ranges.rs` does ten thousand of them.

use crate::random_ends;

use random_ends::{Outcome, outcome};

#[test]
fn scenes_at_the_ends_of_the_ranges_stay_finite() {
    let (mut fingertips, mut others) = (0, 0);
    for seed in 1..=300 {
        match outcome(seed) {
            Outcome::Rendered(force) if force.fingertip => {
                fingertips += 1;
                assert!(force.above <= 1.0, "scene {seed}: {force:?}");
            }
            Outcome::Rendered(force) => {
                others += 1;
                assert!(force.above_landing <= 1.0, "scene {seed}: {force:?}");
            }
            Outcome::Refused(message) => assert!(!message.is_empty(), "scene {seed}"),
            Outcome::NotFinite => panic!("scene {seed} is not finite"),
        }
    }
    assert!(fingertips > 80 && others > 80, "{fingertips} and {others} scenes were rendered");
}
