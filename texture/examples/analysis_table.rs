//! Prints the measured tables of the offline analysis; `dimension`, `lattice` or `groups` prints one.
//! `cargo run --release -p asperity-texture --features offline --example analysis_table`

#[path = "../tests/support/exact_brownian.rs"]
mod exact_brownian;

use asperity_texture::fractal_dimension as fd;
use exact_brownian::{ExactBrownian, quantise};
use std::time::Instant;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let asked = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    if asked("dimension") {
        dimension();
    }
}

fn dimension() {
    const PAIRS: u64 = 5;
    for levels in [256_u32, 65_536] {
        println!(
            "\nD, exact Brownian surfaces 256², {levels} levels, {} each: mean estimate (mean |error|)",
            2 * PAIRS
        );
        println!(
            "   D     recommended      box              information      correlation      probability      local64 rms  conditions"
        );
        let mut total = [0.0; 5];
        let mut time = [0.0; 3];
        for tenth in 1..=9 {
            let d = 2.0 + 0.1 * f64::from(tenth);
            let generator = ExactBrownian::new(256, 3.0 - d);
            let (mut mean, mut error, mut local) = ([0.0; 5], [0.0; 5], 0.0);
            let mut broken = 0;
            for seed in 0..PAIRS {
                for surface in generator.pair(77 * tenth as u64 + 10_000 * seed) {
                    let map = quantise(&surface, levels);
                    let n = 2.0 * PAIRS as f64;
                    let start = Instant::now();
                    let recommended = fd::transects(&map).unwrap().dimension;
                    time[0] += start.elapsed().as_secs_f64();
                    let start = Instant::now();
                    let cubes = fd::cube_dimensions(&map).unwrap();
                    time[1] += start.elapsed().as_secs_f64();
                    let start = Instant::now();
                    let probability = fd::probability_dimension(&map).unwrap();
                    time[2] += start.elapsed().as_secs_f64();
                    let found =
                        [recommended, cubes.box_counting, cubes.information, cubes.correlation, probability];
                    for i in 0..5 {
                        mean[i] += found[i] / n;
                        error[i] += (found[i] - d).abs() / n;
                    }
                    let places = fd::local_map(&map, 64, 64).unwrap().dimension;
                    local += places.values.iter().map(|v| (v - d) * (v - d)).sum::<f64>()
                        / (places.values.len() as f64 * n);
                    for condition in fd::fractal_dimension(&map).unwrap().conditions {
                        broken += 1;
                        println!("    D {d:.1}: {condition}");
                    }
                }
            }
            print!("  {d:.1}");
            for i in 0..5 {
                total[i] += error[i] / 9.0;
                print!("    {:.3} ({:.3})", mean[i], error[i]);
            }
            println!("    {:.3}        {broken}", local.sqrt());
        }
        println!(
            "  MAE  {:.4}  {:.3}  {:.3}  {:.3}  {:.4}",
            total[0], total[1], total[2], total[3], total[4]
        );
        let n = 18.0 * PAIRS as f64 / 1e3;
        println!(
            "  ms: recommended {:.2}, three cube dimensions {:.2}, probability {:.2}",
            time[0] / n,
            time[1] / n,
            time[2] / n
        );
    }
}
