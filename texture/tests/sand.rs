//! Sand: volume, angle of repose, cone, tools, speed.

use asperity_dsp::rng::Rng;
use asperity_texture::raster::Raster;
use asperity_texture::sand::erosion::Erosion;
use asperity_texture::sand::simulation::Pose;
use asperity_texture::sand::tool::Press;
use asperity_texture::sand::{SandDesign, SandGrid, SandLaw, SandSimulation, Tool};
use std::time::Instant;

const TALUS_DEG: f64 = 30.0;

fn design(cells: usize, width_m: f64) -> SandDesign {
    SandDesign { width_m, height_m: width_m, cells, ..SandDesign::default() }
}

fn pose(position_m: [f64; 2], velocity_m_s: [f64; 2], normal_force_n: f64) -> Pose {
    Pose { contact: 0, position_m, velocity_m_s, normal_force_n }
}

/// Writes a wavy line; returns what every frame took.
fn write(sand: &mut SandSimulation, frames: u32, force_n: f64) -> Vec<f64> {
    (0..frames)
        .map(|n| {
            let t = f64::from(n) / 60.0;
            let at = [0.3 + 0.15 * (1.1 * t).sin(), 0.3 + 0.1 * (2.3 * t).cos()];
            let velocity = [0.165 * (1.1 * t).cos(), -0.23 * (2.3 * t).sin()];
            sand.tell(pose(at, velocity, force_n));
            let start = Instant::now();
            sand.frame();
            start.elapsed().as_secs_f64()
        })
        .collect()
}

#[test]
fn writing_for_a_minute_loses_not_one_unit_of_volume_and_settles_below_the_talus_angle() {
    let mut sand = SandSimulation::new(&design(300, 0.6)).unwrap();
    write(&mut sand, 3600, 3.0);
    assert!(sand.grid().max_slope_deg() > 5.0, "something was written");
    assert_eq!(sand.figures().drift_units, 0);
    sand.settle();
    let figures = sand.figures();
    println!("{figures:?}");
    assert_eq!(figures.drift_units, 0);
    assert_eq!(figures.volume_before_m3, figures.volume_after_m3);
    assert!(figures.max_slope_deg <= TALUS_DEG + 0.5, "{}", figures.max_slope_deg);
    assert!(sand.is_at_rest());
}

#[test]
fn a_random_field_settles_below_the_talus_angle_with_its_volume_at_every_angle_and_size() {
    for (columns, rows, talus) in [(64, 64, 30.0), (33, 97, 25.0), (5, 4, 40.0), (31, 32, 34.0)] {
        let mut grid = SandGrid::flat(columns, rows, 1e-3, 0.05).unwrap();
        let mut rng = Rng::new(columns as u64);
        grid.fill(|_, _| 0.05 + 0.01 * rng.normal());
        let (before, mut erosion) = (grid.volume_units(), Erosion::new(&grid, talus).unwrap());
        erosion.activate_all();
        erosion.settle(&mut grid);
        assert_eq!(grid.volume_units(), before);
        assert!(grid.max_slope_deg() <= talus + 0.5, "{columns}: {}", grid.max_slope_deg());
    }
}

#[test]
fn a_column_collapses_to_the_cone_of_its_volume_within_3_percent() {
    let (n, cell) = (161, 1e-3);
    let mut grid = SandGrid::flat(n, n, cell, 0.05).unwrap();
    let middle = n / 2;
    grid.fill(|x, y| {
        let (dx, dy) = (x as f64 - middle as f64, y as f64 - middle as f64);
        if dx.hypot(dy) <= 10.0 { 0.35 } else { 0.01 }
    });
    let volume: f64 = (0..n * n).map(|i| (grid.height_m(i % n, i / n) - 0.01) * cell * cell).sum();
    let mut erosion = Erosion::new(&grid, TALUS_DEG).unwrap();
    erosion.activate_all();
    erosion.settle(&mut grid);
    let tan = TALUS_DEG.to_radians().tan();
    let peak = (3.0 * volume * tan * tan / std::f64::consts::PI).cbrt();
    let radius = peak / tan;
    let measured_peak = grid.height_m(middle, middle) - 0.01;
    // Where the flank, continued, meets the ground: along an axis and along a diagonal.
    let base = |dx: usize, dy: usize, step: f64| {
        let at = |k: usize| grid.height_m(middle + k * dx, middle + k * dy) - 0.01;
        let points: Vec<(f64, f64)> = (0..70)
            .map(|k| (k as f64 * step * cell, at(k)))
            .filter(|p| p.1 > 0.2 * peak && p.1 < 0.8 * peak)
            .collect();
        let m = points.len() as f64;
        let (mx, my) =
            (points.iter().map(|p| p.0).sum::<f64>() / m, points.iter().map(|p| p.1).sum::<f64>() / m);
        let slope = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>()
            / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>();
        mx - my / slope
    };
    let (axis, diagonal) = (base(1, 0, 1.0), base(1, 1, std::f64::consts::SQRT_2));
    println!(
        "peak {:.4}, axis {:.4}, diagonal {:.4} of the cone",
        measured_peak / peak,
        axis / radius,
        diagonal / radius
    );
    assert!((measured_peak / peak - 1.0).abs() < 0.03);
    assert!((axis / radius - 1.0).abs() < 0.03 && (diagonal / radius - 1.0).abs() < 0.03);
}

#[test]
fn a_tool_held_still_changes_nothing_once_the_sand_has_settled() {
    let mut sand = SandSimulation::new(&design(200, 0.1)).unwrap();
    for _ in 0..120 {
        sand.tell(pose([0.05, 0.05], [0.0; 2], 2.0));
        sand.frame();
    }
    let settled = sand.grid().clone();
    assert!(settled.max_slope_deg() > 1.0);
    for _ in 0..60 {
        sand.tell(pose([0.05, 0.05], [0.0; 2], 2.0));
        sand.frame();
    }
    assert_eq!(&settled, sand.grid());
}

#[test]
fn a_dragged_sphere_leaves_a_groove_of_its_depth_with_sand_on_the_rim_and_a_heap_ahead() {
    let mut sand = SandSimulation::new(&design(400, 0.1)).unwrap();
    let force = 3.0;
    for n in 0..90 {
        sand.tell(pose([0.02 + 0.04 * f64::from(n) / 60.0, 0.05], [0.04, 0.0], force));
        sand.frame();
    }
    let level = 0.05;
    let depth = SandLaw::default().depth_m(force);
    let at = |x: f64, y: f64| sand.grid().height_at_m([x, y]) - level;
    // Behind the tool the walls have slid in: less deep than the tool, but a groove.
    let groove = (0..40).map(|k| at(0.05 + 1e-3 * 0.1 * f64::from(k), 0.05)).sum::<f64>() / 40.0;
    assert!(groove < -0.3 * depth && groove > -1.2 * depth, "{groove} against {depth}");
    let rim = (0..100).map(|k| at(0.05, 0.05 + 1e-4 * f64::from(k))).fold(f64::MIN, f64::max);
    assert!(rim > 0.1 * depth, "rim {rim}");
    let ahead = (0..100).map(|k| at(0.08 + 1e-4 * f64::from(k), 0.05)).fold(f64::MIN, f64::max);
    let beside = (0..100).map(|k| at(0.0795, 0.05 + 1e-4 * f64::from(k))).fold(f64::MIN, f64::max);
    println!("groove {groove:.5}, rim {rim:.5}, ahead {ahead:.5}, beside {beside:.5}, depth {depth:.5}");
    assert!(ahead > rim, "pushed ahead: {ahead} over {rim}");
    // Symmetric about the stroke.
    for k in 1..60 {
        let y = 2e-4 * f64::from(k);
        let (left, right) = (at(0.05, 0.05 - y), at(0.05, 0.05 + y));
        assert!((left - right).abs() < 0.15 * depth, "{y}: {left} {right}");
    }
}

#[test]
fn any_tool_prints_its_own_lower_surface() {
    let (n, cell) = (200, 5e-4);
    // A bar, 4 mm × 20 mm, flat below.
    let map = Raster::from_fn(41, 41, |x, y| {
        if x.abs_diff(20) <= 4 && y.abs_diff(20) <= 19 { 0.0 } else { f64::INFINITY }
    });
    let tool = Tool::LowerMap { map, texel_m: cell };
    tool.check().unwrap();
    let mut grid = SandGrid::flat(n, n, cell, 0.05).unwrap();
    let before = grid.volume_units();
    let mut press = Press::new(&tool, &grid);
    let middle = [(100.5) * cell, (100.5) * cell];
    let displaced = press.apply(&mut grid, &tool, middle, 0.048, [0.0; 2]);
    assert_eq!(grid.volume_units(), before);
    let lowered = (0..n * n).filter(|i| (grid.height_m(i % n, i / n) - 0.048).abs() < 1e-8).count();
    assert_eq!(lowered, 9 * 39);
    let wanted = 9.0 * 39.0 * 0.002;
    assert!((displaced.units as f64 / 1_073_741_824.0 - wanted).abs() < 1e-6);
    // Nothing was laid further away than the rim is wide.
    assert!((grid.height_m(100, 40) - 0.05).abs() < 1e-9 && grid.height_m(100, 79) > 0.0505);
    // A sphere through its map prints as the sphere.
    let radius_m = 0.004;
    let map = Raster::from_fn(33, 33, |x, y| {
        let square = ((x as f64 - 16.0).powi(2) + (y as f64 - 16.0).powi(2)) * 0.25e-6;
        if square > radius_m * radius_m {
            f64::INFINITY
        } else {
            radius_m - (radius_m * radius_m - square).sqrt()
        }
    });
    let sphere_map = Tool::LowerMap { map, texel_m: 5e-4 };
    let print = |tool: &Tool| {
        let mut grid = SandGrid::flat(n, n, 5e-4, 0.05).unwrap();
        Press::new(tool, &grid).apply(&mut grid, tool, middle, 0.0485, [1.0, 0.0]);
        grid
    };
    let (a, b) = (print(&sphere_map), print(&Tool::Sphere { radius_m }));
    for i in 0..n * n {
        assert!((a.height_m(i % n, i / n) - b.height_m(i % n, i / n)).abs() < 1e-8);
    }
}

#[test]
fn the_same_strokes_give_the_same_sand_and_the_edge_keeps_its_sand_too() {
    let run = || {
        let mut sand = SandSimulation::new(&design(150, 0.1)).unwrap();
        for n in 0..200 {
            let t = f64::from(n) / 200.0;
            // Along the border and out of the box.
            sand.tell(pose([-0.01 + 0.12 * t, 0.001 + 0.002 * t], [0.036, 0.0], 4.0));
            sand.frame();
        }
        sand.settle();
        sand
    };
    let (a, b) = (run(), run());
    assert_eq!(a.grid(), b.grid());
    assert_eq!(a.figures().drift_units, 0);
    assert!(a.figures().max_slope_deg <= TALUS_DEG + 0.5);
}

/// The pass as the document describes it, over every cell of the grid, until nothing moves.
fn settle_naively(heights: &mut [i64], n: usize, limit: [i64; 2], tolerance: i64) -> usize {
    for pass in 1.. {
        let mut moved = false;
        for y in 0..n as isize {
            for x in 0..n as isize {
                let h = heights[(y * n as isize + x) as usize];
                let (mut most, mut sum) = (0, 0);
                let mut excess = [(0, 0_usize); 8];
                let mut k = 0;
                for dy in -1..=1 {
                    for dx in -1..=1 {
                        let (u, v) = (x + dx, y + dy);
                        if (dx, dy) != (0, 0) && u >= 0 && v >= 0 && u < n as isize && v < n as isize {
                            let at = (v * n as isize + u) as usize;
                            let e = h - heights[at] - limit[usize::from(dx != 0 && dy != 0)];
                            if e > 0 {
                                excess[k] = (e, at);
                                k += 1;
                                most = most.max(e);
                                sum += e;
                            }
                        }
                    }
                }
                if most > tolerance {
                    for &(e, at) in &excess[..k] {
                        let part = (most as i128 * e as i128 / (2 * sum as i128)) as i64;
                        heights[at] += part;
                        heights[(y * n as isize + x) as usize] -= part;
                    }
                    moved = true;
                }
            }
        }
        if !moved {
            return pass;
        }
    }
    0
}

#[test]
fn settling_a_random_field_is_five_times_faster_than_the_naive_pass() {
    let (n, cell) = (400, 1e-3);
    let mut rng = Rng::new(5);
    let start: Vec<f64> = (0..n * n).map(|_| 0.05 + 0.004 * rng.normal()).collect();
    let limit = TALUS_DEG.to_radians().tan() * cell * 1_073_741_824.0;
    let above = (TALUS_DEG + 0.25).to_radians().tan() * cell * 1_073_741_824.0 - limit;
    let mut naive: Vec<i64> = start.iter().map(|h| (h * 1_073_741_824.0) as i64).collect();
    let clock = Instant::now();
    let passes = settle_naively(&mut naive, n, [limit as i64, (limit * 2.0_f64.sqrt()) as i64], above as i64);
    let slow = clock.elapsed().as_secs_f64();
    let mut fast = f64::INFINITY;
    let mut ours = 0;
    for _ in 0..3 {
        let mut grid = SandGrid::flat(n, n, cell, 0.05).unwrap();
        grid.fill(|x, y| start[y * n + x]);
        let mut erosion = Erosion::new(&grid, TALUS_DEG).unwrap();
        erosion.activate_all();
        let clock = Instant::now();
        ours = erosion.settle(&mut grid);
        fast = fast.min(clock.elapsed().as_secs_f64());
        assert!(grid.max_slope_deg() <= TALUS_DEG + 0.5);
    }
    println!(
        "naive {:.1} ms in {passes} passes, ours {:.1} ms in {ours}: {:.1} times",
        slow * 1e3,
        fast * 1e3,
        slow / fast
    );
    assert!(slow / fast >= 5.0, "{}", slow / fast);
}

#[test]
fn a_frame_of_a_million_cells_takes_at_most_2_ms_while_dragging() {
    let mut sand = SandSimulation::new(&design(1000, 1.0)).unwrap();
    let mut times = write(&mut sand, 600, 5.0);
    times.sort_by(f64::total_cmp);
    println!("median {:.3} ms, 99 % {:.3} ms", times[300] * 1e3, times[594] * 1e3);
    assert!(times[300] <= 2e-3, "{}", times[300]);
    // The same cells on a finer bed, where a fingertip covers many more of them.
    let mut sand = SandSimulation::new(&design(1000, 0.6)).unwrap();
    let mut times = write(&mut sand, 600, 5.0);
    times.sort_by(f64::total_cmp);
    println!("0.6 mm cells: median {:.3} ms, 99 % {:.3} ms", times[300] * 1e3, times[594] * 1e3);
    assert!(times[300] <= 2e-3, "{}", times[300]);
}

#[test]
fn wet_sand_stands_steeper_and_gives_way_less() {
    let made = |wetness| {
        let law = SandLaw { wetness, ..SandLaw::default() };
        let mut sand = SandSimulation::new(&SandDesign { law, ..design(200, 0.1) }).unwrap();
        sand.shape(|x, y| if x.abs_diff(100) < 10 && y.abs_diff(100) < 10 { 0.15 } else { 0.02 });
        sand.settle();
        sand.figures().max_slope_deg
    };
    let (dry, wet) = (made(0.0), made(1.0));
    assert!(dry <= 30.5 && wet > 45.0 && wet <= 50.5, "{dry} {wet}");
}

#[test]
fn the_picture_shows_every_height_to_half_a_grey_step() {
    let mut sand = SandSimulation::new(&design(100, 0.1)).unwrap();
    write(&mut sand, 30, 3.0);
    sand.shape(|x, y| 0.02 + 1e-4 * x as f64 + 3e-5 * y as f64);
    let picture = sand.picture();
    for (x, y) in [(0, 0), (99, 99), (17, 80)] {
        let height =
            picture.lowest_m + (picture.raster.at(x, y) * 65_535.0).round() * picture.metres_per_grey;
        assert!((height - sand.grid().height_m(x, y)).abs() <= 0.5 * picture.metres_per_grey + 1e-12);
    }
}

#[test]
fn impossible_beds_are_refused_by_name() {
    let field = |d: SandDesign| SandSimulation::new(&d).unwrap_err().field;
    let good = design(100, 0.1);
    assert_eq!(field(SandDesign { width_m: f64::NAN, ..good.clone() }), "width_m");
    assert_eq!(field(SandDesign { cells: 0, ..good.clone() }), "columns");
    assert_eq!(field(SandDesign { depth_m: 0.0, ..good.clone() }), "depth_m");
    assert_eq!(field(SandDesign { talus_deg: 90.0, ..good.clone() }), "talus_deg");
    assert_eq!(field(SandDesign { tool: Tool::Sphere { radius_m: 0.0 }, ..good.clone() }), "tool_radius_m");
    let law = SandLaw { stiffness_n: -1.0, ..SandLaw::default() };
    assert_eq!(field(SandDesign { law, ..good }), "stiffness_n");
}
