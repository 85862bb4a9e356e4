//! Recognition of the seven materials by heights and by forces, on strokes and pieces that
//! nothing was chosen by.
//!
//! The judge is the one of the test `seven_materials`, unchanged. Eight sets of seeds, written down
//! before the first run; in each the judge learns 40 strokes a material on one piece of it and is
//! asked about 40 others on the same piece, and in another round on a piece it has never met.

#[path = "../tests/common/materials.rs"]
mod materials;

use asperity_surface::solid_materials::SolidMaterial;
use materials::{Question, force, height_rate, identified, seven, stroke};

const SEEDS: [u64; 8] = [80_001, 80_002, 80_003, 80_004, 80_005, 80_006, 80_007, 80_008];

fn main() {
    for (name, by_force) in [("heights", false), ("forces", true)] {
        for (where_asked, apart) in [("the same piece", 0), ("another piece", 400)] {
            let mut total = vec![vec![0; 7]; 7];
            let mut scores = Vec::new();
            for seed in SEEDS {
                let (known_piece, asked_piece) = (seed + 500, seed + 500 + apart);
                let question = Question { strokes: 40, strokes_seed: seed + apart, known_piece, asked_piece };
                let (score, confusions) = if by_force {
                    identified(question, &seven(), |m, rng| force(m, &stroke(rng)))
                } else {
                    identified(question, &seven(), |m, rng| height_rate(m, &stroke(rng)))
                };
                scores.push(score);
                for (total, row) in total.iter_mut().zip(&confusions) {
                    for (sum, count) in total.iter_mut().zip(row) {
                        *sum += count;
                    }
                }
            }
            let mean = scores.iter().sum::<f64>() / scores.len() as f64;
            println!("{name}, {where_asked}: {mean:.4}; by seeds {scores:.3?}");
            for (row, material) in total.iter().zip(SolidMaterial::SEVEN) {
                println!("{:>12} {row:4?}", material.name());
            }
        }
    }
}
