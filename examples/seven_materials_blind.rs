//! Recognition of the seven materials, on strokes and pieces that nothing was chosen by.
//!
//! ```sh
//! cargo run --release --example seven_materials_blind
//! ```
//!
//! The judge is the one of the test `seven_materials`, unchanged. Eight sets of seeds, written down
//! before the first run; in each the judge learns 20 strokes a material on one piece of it, and is
//! asked about 40 other strokes on the same piece and 40 on a piece it has never met.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/materials.rs"]
mod materials;

use asperity::surface::solid_materials::SolidMaterial;
use asperity_dsp::rng::Rng;

const SEEDS: [u64; 8] = [70_001, 70_002, 70_003, 70_004, 70_005, 70_006, 70_007, 70_008];
const KNOWN: usize = 20;
const ASKED: usize = 40;

fn main() {
    let mut totals = [[[0; 7]; 7]; 2];
    for seed in SEEDS {
        let mut rng = Rng::new(seed);
        let pieces = [seed + 500, seed + 900];
        let centroids = materials::centroids(KNOWN, pieces[0], &mut rng);
        let scores = [0, 1].map(|k| {
            let confusions = materials::confusions(&centroids, ASKED, pieces[k], &mut rng);
            for (total, row) in totals[k].iter_mut().zip(&confusions) {
                for (sum, count) in total.iter_mut().zip(row) {
                    *sum += count;
                }
            }
            materials::score(&confusions)
        });
        println!("seed {seed}: {:.3} on the same piece, {:.3} on another", scores[0], scores[1]);
    }
    for (total, name) in totals.iter().zip(["the same piece", "another piece"]) {
        let strokes = total.iter().flatten().sum::<usize>();
        println!("{name}: {:.4} of {strokes} strokes", materials::score(total));
        for (row, material) in total.iter().zip(SolidMaterial::SEVEN) {
            println!("{:>12} {row:4?}", material.name());
        }
    }
}
