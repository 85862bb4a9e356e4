//! What a ball feels of a soft map against the closed form, and how much of moving sand has to be
//! drawn.

use crate::picture::{Curve, svg};
use asperity::surface::footprint::{footprint_radius_m, sample_under};
use asperity::surface::height_field::{PathBlock, SurfaceBlock};
use asperity::surface::height_map::{Extent, HeightMap};
use asperity::surface::raster::Raster;
use asperity::surface::sand::simulation::Pose;
use asperity::surface::sand::{SandDesign, SandSimulation};
use asperity::surface::wrap::Wrap;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

/// Side of the map, m, and its texels.
const SIDE_M: f64 = 0.02;
const TEXELS: usize = 1024;
/// Radius of the ball, m.
const BALL_M: f64 = 1e-3;

/// Writes footprint.svg and drawn.svg.
pub fn draw(folder: &Path) -> Result<(), Box<dyn Error>> {
    let curve = |name: &str, colour, points| Curve { name: name.into(), colour, points };
    let mut felt = Vec::new();
    let mut worst = 0.0_f64;
    for (depth_m, colours) in
        [(2e-5, ["#1b6ca8", "#8fb8d6"]), (1e-4, ["#d1495b", "#eba9b2"]), (4e-4, ["#3a7d44", "#9fcaa6"])]
    {
        let radius_m = footprint_radius_m(BALL_M, depth_m);
        let (mut found, mut law) = (Vec::new(), Vec::new());
        for count in (2..120).step_by(2) {
            let wavelength_mm = 1e3 * SIDE_M / f64::from(count);
            let (felt, wanted) =
                (share_felt(count, radius_m)?, closed_form(TAU * radius_m / (1e-3 * wavelength_mm)));
            worst = worst.max((felt - wanted).abs());
            found.push([f64::from(count) / (1e3 * SIDE_M), felt]);
            law.push([f64::from(count) / (1e3 * SIDE_M), wanted]);
        }
        felt.push(curve(&format!("{:.0} µm deep", 1e6 * depth_m), colours[0], found));
        felt.push(curve("closed form", colours[1], law));
    }
    let title = "a ball of 1 mm on a soft map: share of a wave that it feels, against waves a millimetre";
    std::fs::write(folder.join("footprint.svg"), svg(title, &[("felt of felt by a point", "/mm", felt)]))?;
    println!("\nsoft map: off the closed form by at most {:.2} % of the wave", 1e2 * worst);
    let (tiles, missing) = tiles_drawn();
    println!(
        "moving sand: at most {} of 256 tiles a frame, {missing} cells ever wrong",
        tiles.iter().fold(0.0, |m, t| f64::max(m, t[1]))
    );
    let title = "a finger writes for 5 s and leaves: tiles of 32 × 32 cells that a game draws, of 256";
    std::fs::write(
        folder.join("drawn.svg"),
        svg(title, &[("tiles a frame", "s", vec![curve("drawn", "#1b6ca8", tiles)])]),
    )?;
    Ok(())
}

/// 8 J₂(κ)/κ², J₂ by its integral.
fn closed_form(kappa: f64) -> f64 {
    let steps = 2000;
    let angle = |step: u32| std::f64::consts::PI * (f64::from(step) + 0.5) / f64::from(steps);
    let sum: f64 = (0..steps).map(|step| (2.0 * angle(step) - kappa * angle(step).sin()).cos()).sum();
    8.0 * sum / f64::from(steps) / (kappa * kappa)
}

/// How much of `count` waves along u a ball feels whose footprint is `radius_m` wide, on a crest.
fn share_felt(count: u32, radius_m: f64) -> Result<f64, Box<dyn Error>> {
    let wave = |x: usize, _| (TAU * f64::from(count) * (x as f64 + 0.5) / TEXELS as f64).cos();
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let mut map = HeightMap::new(&Raster::from_fn(TEXELS, 8, wave), extent, Wrap::Repeat)?;
    let path = PathBlock {
        position_m: &[[0.0, 0.003]],
        velocity_m_s: &[[0.1, 0.0]],
        footprint_m: &[2e-6],
        normal_force_n: &[],
        first_sample: 0,
        contact: 0,
        slopes: false,
        ..PathBlock::default()
    };
    let mut out = SurfaceBlock::default();
    sample_under(&mut map, &path, &[radius_m], &mut out);
    Ok(out.height_m[0])
}

/// Tiles that a game draws in each frame, and cells that it ever drew other than they are.
fn tiles_drawn() -> (Vec<[f64; 2]>, usize) {
    let design = SandDesign::default();
    let Ok(mut sand) = SandSimulation::new(&design) else { return (Vec::new(), 0) };
    let mut reader = sand.moving_picture().reader();
    let (mut tiles, mut missing) = (Vec::new(), 0);
    for frame in 0..480 {
        let t = f64::from(frame) / 60.0;
        if t < 5.0 {
            let position_m = [0.125 + 0.07 * (3.1 * t).sin(), 0.125 + 0.06 * (4.3 * t).cos()];
            let velocity_m_s = [0.217 * (3.1 * t).cos(), -0.258 * (4.3 * t).sin()];
            sand.set_pose(Pose { contact: 0, position_m, velocity_m_s, normal_force_n: 3.0, landed: false });
        }
        sand.frame();
        let grid = sand.grid();
        let shown = reader.changed(|tile| {
            let [width, _] = tile.size;
            let wrong = |(i, height_m): (usize, &f32)| {
                *height_m != grid.height_m(tile.at[0] + i % width, tile.at[1] + i / width) as f32
            };
            missing += tile.height_m.iter().enumerate().filter(|cell| wrong(*cell)).count();
        });
        // The first frame shows everything.
        if frame > 0 {
            tiles.push([t, shown as f64]);
        }
    }
    (tiles, missing)
}
