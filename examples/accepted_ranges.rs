//! Ten thousand random scenes at the ends of the accepted ranges: how many are refused, and how far the hardest
//! contact force lies above what physics explains.
//!
//! ```sh
//! cargo run --release --example accepted_ranges -- 10000
//! ```

#[path = "../tests/common/random_ends.rs"]
mod random_ends;

use random_ends::{Outcome, outcome};

fn main() {
    let count = std::env::args().nth(1).and_then(|count| count.parse().ok()).unwrap_or(10_000);
    let (mut refused, mut broken, mut above, mut worst) = (0u64, 0u64, 0u64, (0.0, 0));
    for seed in 1..=count {
        match outcome(seed) {
            Outcome::Rendered(force) => {
                above += u64::from(force > 1.0);
                if force > 1.0 {
                    println!("scene {seed}: {force:.3} times what is allowed");
                }
                if force > worst.0 {
                    worst = (force, seed);
                }
            }
            Outcome::Refused(_) => refused += 1,
            Outcome::NotFinite => {
                println!("scene {seed} is not finite");
                broken += 1;
            }
        }
    }
    println!("{count} scenes: {refused} refused, {broken} not finite, {above} above what is allowed");
    println!("hardest: {:.3} times what is allowed, scene {}", worst.0, worst.1);
}
