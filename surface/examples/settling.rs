//! Prints how long a random field of sand takes to settle, against the document's pass over the
//! whole grid repeated until nothing moves: the same fields, whole-number heights, criterion and
//! optimisation.
//!
//! Arguments: edges in cells (256 and 1000 unless given).

#[path = "../tests/common/naive_sand.rs"]
mod naive_sand;

use asperity_dsp::DesignError;
use asperity_dsp::simd::Level;
use asperity_surface::sand::SandGrid;
use asperity_surface::sand::erosion::{Erosion, SETTLED_DEG};
use naive_sand::{NaiveSand, Share, random_fields};
use std::time::Instant;

const TALUS_DEG: f64 = 30.0;
const CELL_M: f64 = 1e-3;

/// Runs some work a few times; the least milliseconds, and the last result.
fn fastest<T>(runs: usize, first: T, mut work: impl FnMut() -> (Instant, T)) -> (f64, T) {
    let (mut least, mut last) = (f64::INFINITY, first);
    for _ in 0..runs {
        let (clock, result) = work();
        least = least.min(clock.elapsed().as_secs_f64() * 1e3);
        last = result;
    }
    (least, last)
}

fn naive(start: &[f64], n: usize, share: Share) -> (f64, (usize, Vec<f64>)) {
    fastest(1, (0, Vec::new()), || {
        let mut sand = NaiveSand::new(start, n, CELL_M, TALUS_DEG, SETTLED_DEG);
        let clock = Instant::now();
        let passes = sand.settle(share);
        (clock, (passes, sand.heights_m()))
    })
}

fn ours(flat: &SandGrid, start: &[f64], portable: bool) -> Result<(f64, (usize, SandGrid)), DesignError> {
    let n = flat.columns();
    let erosion = Erosion::new(flat, TALUS_DEG)?;
    let erosion = if portable { erosion.on(Level::PORTABLE) } else { erosion };
    Ok(fastest(3, (0, flat.clone()), || {
        let (mut grid, mut erosion) = (flat.clone(), erosion.clone());
        grid.fill(|x, y| start[y * n + x]);
        erosion.activate_all();
        let clock = Instant::now();
        let passes = erosion.settle(&mut grid);
        (clock, (passes, grid))
    }))
}

fn rms_mm(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt() * 1e3
}

fn main() -> Result<(), DesignError> {
    let given: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    println!(
        "{:>5} {:>4} {:13} | {:>16} | {:>16} | {:>14} | {:>5} {:>5} {:>8} | {:>6} {:>8} {:>8}",
        "cells",
        "seed",
        "field",
        "c = 1/2: ms",
        "c levels: ms",
        "ours: ms",
        "times",
        "times",
        "portable",
        "slope",
        "differs",
        "reversed"
    );
    for n in if given.is_empty() { vec![256, 1000] } else { given } {
        let flat = SandGrid::flat(n, n, CELL_M, 0.05)?;
        for seed in [5, 6, 7] {
            for (name, start) in random_fields(n, seed) {
                let (half_ms, (half_passes, document)) = naive(&start, n, Share::Half);
                let (level_ms, (level_passes, _)) = naive(&start, n, Share::Level);
                let (ms, (passes, grid)) = ours(&flat, &start, false)?;
                let (portable_ms, _) = ours(&flat, &start, true)?;
                // How far the document's own result depends on the corner that its passes begin at.
                let reversed: Vec<f64> = start.iter().rev().copied().collect();
                let (_, (_, mut reversed)) = naive(&reversed, n, Share::Half);
                reversed.reverse();
                let heights: Vec<f64> = (0..n * n).map(|i| grid.height_m(i % n, i / n)).collect();
                println!(
                    "{n:5} {seed:4} {name:13} | {half_ms:9.1} / {half_passes:4} | {level_ms:9.1} / {level_passes:4} | {ms:7.2} / {passes:4} | {:5.1} {:5.1} {:8.1} | {:5.2}° {:5.3} mm {:5.3} mm",
                    half_ms / ms,
                    level_ms / ms,
                    half_ms.min(level_ms) / portable_ms,
                    grid.max_slope_deg(),
                    rms_mm(&heights, &document),
                    rms_mm(&reversed, &document),
                );
            }
        }
    }
    Ok(())
}
