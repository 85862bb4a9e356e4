//! Whatever is accepted is rendered without a blow-up: random scenes at the ends of the ranges. The example
//! `accepted_ranges` does the same for ten thousand.

#[path = "common/random_ends.rs"]
mod random_ends;

use random_ends::{Outcome, outcome};

#[test]
fn random_scenes_at_the_ends_of_what_is_accepted_give_finite_forces_that_physics_explains() {
    let mut refused = 0;
    for seed in 1..=300 {
        match outcome(seed) {
            Outcome::Rendered(worst) => assert!(worst <= 1.0, "scene {seed}: {worst} times what is allowed"),
            Outcome::Refused(message) => {
                refused += 1;
                assert!(message.contains("relief_m"), "scene {seed}: refused without the field: {message}");
            }
            Outcome::NotFinite => panic!("scene {seed} is not finite"),
        }
    }
    assert!(refused < 200, "{refused} of 300 refused: nothing was tested");
}
