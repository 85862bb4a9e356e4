//! Ten thousand random scenes at the ends of the accepted ranges: how many are refused, and how far
//! the hardest contact force lies above what physics explains.
//!
//! ```sh
//! cargo run --release --example accepted_ranges -- 10000      # scenes 1 to 10000
//! cargo run --release --example accepted_ranges -- 10000 10001
//! ```

#[path = "../tests/common/random_ends.rs"]
mod random_ends;

use random_ends::{Force, Outcome, outcome};

fn main() {
    let argument = |n| std::env::args().nth(n).and_then(|number| number.parse().ok());
    let (count, first) = (argument(1).unwrap_or(10_000), argument(2).unwrap_or(1));
    let (mut refused, mut broken, mut forces) = (0u64, 0u64, vec![]);
    for seed in first..first + count {
        match outcome(seed) {
            Outcome::Rendered(force) => {
                if force.above > 1.0 {
                    println!("scene {seed}: {force:.3?}");
                }
                forces.push((seed, force));
            }
            Outcome::Refused(_) => refused += 1,
            Outcome::NotFinite => {
                println!("scene {seed} is not finite");
                broken += 1;
            }
        }
    }
    println!("{count} scenes: {refused} refused, {broken} not finite, {} rendered", forces.len());
    let fingertips: Vec<_> = forces.iter().copied().filter(|(_, force)| force.fingertip).collect();
    let untold = forces.iter().filter(|(_, force)| force.above > 1.0 && force.blows == 0).count();
    println!("above what is allowed and not counted as a blow: {untold}");
    tell("every probe", &forces, |force| force.above);
    tell("the fingertip", &fingertips, |force| force.above);
    tell("every probe, landings added", &forces, |force| force.above_landing);
}

fn tell(of: &str, forces: &[(u64, Force)], above: impl Fn(&Force) -> f64) {
    let count = forces.iter().filter(|(_, force)| above(force) > 1.0).count();
    let hardest = forces.iter().max_by(|(_, a), (_, b)| above(a).total_cmp(&above(b)));
    let Some((seed, force)) = hardest else { return };
    println!("{of}: {count} above what is allowed; hardest {:.3} times, scene {seed}", above(force));
}
