//! The source of sand.

use super::{Columns, Found, columns};
use asperity_surface::sand::simulation::{FRAMES_PER_S, Pose};
use asperity_surface::sand::{SandDesign, SandSimulation};

const SIDE_M: f64 = 0.25;
/// Speed of a stroke, m/s.
const SPEED_M_S: f64 = 0.1;
/// Cells a side.
const CELLS: usize = 256;

fn bed() -> Result<SandSimulation, String> {
    SandSimulation::new(&SandDesign { cells: CELLS, ..SandDesign::default() })
        .map_err(|error| error.to_string())
}

/// A stroke between two places, under a force at each end, N; the sand comes to rest after it.
fn stroke(sand: &mut SandSimulation, [from, to]: [[f64; 2]; 2], force_n: [f64; 2]) {
    let way = [to[0] - from[0], to[1] - from[1]];
    let steps = (way[0].hypot(way[1]) / SPEED_M_S * FRAMES_PER_S).ceil() as usize;
    for step in 0..=steps {
        let t = step as f64 / steps.max(1) as f64;
        sand.set_pose(Pose {
            contact: 0,
            position_m: [0, 1].map(|i| from[i] + t * way[i]),
            velocity_m_s: way.map(|w| w * FRAMES_PER_S / steps.max(1) as f64),
            normal_force_n: force_n[0] + t * (force_n[1] - force_n[0]),
            landed: step == 0,
        });
        sand.frame();
    }
    sand.settle();
}

/// Groove of a stroke whose force falls: sand removed along it.
pub fn falling_force() -> Result<Found, String> {
    let mut sand = bed()?;
    let ends = [[0.05, 0.125], [0.2, 0.125]];
    stroke(&mut sand, ends, [8.0, 0.5]);
    let (grid, depth_m) = (sand.grid(), SandDesign::default().depth_m);
    let cell_m = grid.cell_m();
    let (mut along_m, mut removed_m2, mut depths_m) = (Vec::new(), Vec::new(), Vec::new());
    for column in (ends[0][0] / cell_m) as usize..=(ends[1][0] / cell_m) as usize {
        let below = |row: usize| (depth_m - grid.height_m(column, row)).max(0.0);
        along_m.push(column as f64 * cell_m - ends[0][0]);
        removed_m2.push((0..grid.rows()).map(|row| below(row) * cell_m).sum());
        depths_m.push((0..grid.rows()).map(below).fold(0.0, f64::max));
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let fifth = depths_m.len() / 5;
    let last = depths_m.len() - fifth;
    let sentence = format!(
        "The stroke begins at 8 N and ends at 0.5 N: the first fifth of its groove is {:.1} mm deep, the last {:.1} mm, and {:.1} \
         times as much sand is missing, as the picture shows it.",
        1e3 * mean(&depths_m[..fifth]),
        1e3 * mean(&depths_m[last..]),
        mean(&removed_m2[..fifth]) / mean(&removed_m2[last..]).max(1e-12)
    );
    let ours = columns([("along_m", along_m), ("removed_m2", removed_m2), ("depth_m", depths_m)]);
    Ok((Columns::new(), ours, sentence))
}

/// Four pictures of a word that is written: after each letter, heights of every fourth cell.
pub fn writing() -> Result<Found, String> {
    // Strokes of A, S, P and R in a box of 1 by 2, y downwards.
    const LETTERS: [&[[f64; 4]]; 4] = [
        &[[0.0, 2.0, 0.5, 0.0], [0.5, 0.0, 1.0, 2.0], [0.25, 1.2, 0.75, 1.2]],
        &[[1.0, 0.0, 0.0, 0.4], [0.0, 0.4, 1.0, 1.5], [1.0, 1.5, 0.0, 2.0]],
        &[[0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.5], [1.0, 0.5, 0.0, 1.0]],
        &[[0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.5], [1.0, 0.5, 0.0, 1.0], [0.2, 1.0, 1.0, 2.0]],
    ];
    let mut sand = bed()?;
    let mut ours = Columns::new();
    let (mut slopes_deg, mut drifts) = (Vec::new(), Vec::new());
    for (n, letter) in LETTERS.into_iter().enumerate() {
        let place = |x: f64, y: f64| [0.03 + 0.05 * n as f64 + 0.035 * x, 0.09 + 0.035 * y];
        for [x0, y0, x1, y1] in letter {
            stroke(&mut sand, [place(*x0, *y0), place(*x1, *y1)], [3.0, 3.0]);
        }
        let figures = sand.figures();
        slopes_deg.push(figures.max_slope_deg);
        drifts.push(figures.volume_after_m3 / figures.volume_before_m3);
        let grid = sand.grid();
        let rows = (0..grid.rows()).step_by(4);
        let heights = rows.flat_map(|row| (0..grid.columns()).step_by(4).map(move |x| grid.height_m(x, row)));
        ours.insert(format!("image_{}_m", n + 1), heights.collect());
    }
    let steepest = slopes_deg.iter().copied().fold(0.0, f64::max);
    let sentence = format!(
        "A letter is added from picture to picture over {:.0} cm; no slope is steeper than {steepest:.1}° where sand slides at 30°, \
         and the sand is all there: {:.9} of it.",
        1e2 * SIDE_M,
        drifts[3]
    );
    let printed = columns([("volume_ratio", vec![1.0; 4])]);
    ours.extend(columns([("volume_ratio", drifts), ("max_slope_deg", slopes_deg)]));
    Ok((printed, ours, sentence))
}
