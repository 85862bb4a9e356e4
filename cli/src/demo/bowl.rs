//! A body from its shape: a bowl turned from a profile, written as a mesh, solved by `asperity
//! modes` and struck.

use super::demo_scene::DemoScene;
use super::strokes::{log, resting, strike};
use crate::arguments::plain;
use crate::error::CliError;
use crate::modes;
use asperity::files::contact_log::{LogLine, Striker};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;
use std::path::Path;

/// The mesh.
const MESH: &str = "bowl.obj";
/// The body solved from it.
pub const MODES: &str = "bowl.modes.json";
/// The picture of its shapes.
pub const PICTURE: &str = "bowl.shapes.svg";
/// Material.
const MATERIAL: &str = "ceramic";
/// Modes solved for.
const MODES_WANTED: usize = 12;

/// Outer radius, m.
const RADIUS_M: f64 = 0.07;
/// Wall, m.
const WALL_M: f64 = 0.006;
/// Height of the wall above the equator, rad.
const RIM_RAD: f64 = -0.1;
/// Corners from the bottom to the rim, and around.
const RINGS: usize = 9;
const AROUND: usize = 32;

/// The scene.
pub fn scene() -> DemoScene {
    DemoScene {
        name: "bowl",
        title: "A bowl from its shape",
        notice: "Nobody recorded this bowl: `asperity modes bowl.obj --material ceramic` solved the mesh for its modes (bowl.shapes.svg). \
                 A wooden stick falls on the rim, half way down and on the bottom: every place sounds different. Then on the rim at two places \
                 an eighth of a turn apart: each of two modes of one pitch has its nodes where the other swings. Then a finger lies on the rim \
                 and the bowl is struck once more.",
        toml: toml(),
        log: log(lines()),
        assets: vec![(MESH.to_owned(), obj().into_bytes())],
    }
}

/// Solves the mesh in `folder`.
///
/// # Errors
/// When a file cannot be written.
pub fn solve(folder: &Path) -> Result<modes::Report, CliError> {
    let options = modes::Options {
        material: Some(MATERIAL.to_owned()),
        max_modes: Some(MODES_WANTED),
        shapes_glb: true,
        plot: Some(folder.join(PICTURE)),
        ..plain(&folder.join(MESH), &folder.join(MODES))?
    };
    modes::make(&options, &mut |_| ())
}

/// A point of a sphere about the middle of the bowl, which stands on the floor.
fn on_sphere(radius_m: f64, height_rad: f64, around_rad: f64) -> [f64; 3] {
    let (across, up) = (radius_m * height_rad.cos(), radius_m * height_rad.sin());
    [across * around_rad.cos(), across * around_rad.sin(), RADIUS_M + up]
}

/// The bowl: a spherical shell with a flat rim, closed, its faces outwards.
fn obj() -> String {
    let height = |ring: usize| -FRAC_PI_2 + (FRAC_PI_2 + RIM_RAD) * (ring + 1) as f64 / RINGS as f64;
    let outside = (0..RINGS).map(|ring| (RADIUS_M, height(ring)));
    let inside = (0..RINGS).rev().map(|ring| (RADIUS_M - WALL_M, height(ring)));
    let rings: Vec<(f64, f64)> = outside.chain(inside).collect();
    let mut text = "# A bowl of 14 cm with a wall of 6 mm, in metres.\n".to_owned();
    let mut corner = |p: [f64; 3]| {
        let _ = writeln!(text, "v {:.5} {:.5} {:.5}", p[0], p[1], p[2]);
    };
    corner([0.0, 0.0, 0.0]);
    for &(radius_m, height_rad) in &rings {
        (0..AROUND).for_each(|i| corner(on_sphere(radius_m, height_rad, TAU * i as f64 / AROUND as f64)));
    }
    corner([0.0, 0.0, WALL_M]);
    // Corners count from 1; the first is the pole outside, the last the one inside.
    let at = |ring: usize, i: usize| 2 + ring * AROUND + i % AROUND;
    let last = 2 + rings.len() * AROUND;
    for i in 0..AROUND {
        let _ = writeln!(text, "f 1 {} {}", at(0, i + 1), at(0, i));
        for ring in 0..rings.len() - 1 {
            let [a, b, c, d] = [at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)];
            let _ = writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}");
        }
        let _ = writeln!(text, "f {last} {} {}", at(rings.len() - 1, i), at(rings.len() - 1, i + 1));
    }
    text
}

fn toml() -> String {
    format!(
        "# A body from its shape: `asperity modes {MESH} --material {MATERIAL} --max-modes {MODES_WANTED} --shapes-glb -o {MODES} --plot {PICTURE}`\n\
         contacts = \"bowl.jsonl\"\n\
         tail_s = 0.8\n\n\
         [[body]]\n\
         name = \"bowl\"\n\
         modes = \"{MODES}\"\n\
         material = \"{MATERIAL}\"\n\n\
         [[surface]]                # where a finger lies on it\n\
         name = \"rim\"\n\
         body = \"bowl\"\n\
         width_m = 0.02\n\
         height_m = 0.02\n\
         micro_relief_m = 0.0\n\
         [surface.frame]            # across the wall outside, just below the rim\n\
         origin_m = [{x:.5}, -0.01, {z:.5}]\n\
         u_axis = [0.0, 1.0, 0.0]\n\
         v_axis = [0.0, 0.0, 1.0]\n\n\
         [[actuator]]\n\
         full_scale = 0.001\n\n\
         [audio]\n\
         gain = {GAIN}\n",
        x = RADIUS_M * RIM_RAD.cos(),
        z = RADIUS_M - 0.02,
    )
}

/// Level of the sound.
const GAIN: f64 = 2.0;

/// Everything that happens, in order.
fn lines() -> Vec<LogLine> {
    let outside = |height_rad: f64, around_rad: f64| on_sphere(RADIUS_M, height_rad, around_rad);
    let rim = RIM_RAD - 0.05;
    let places = [
        (0.15, outside(rim, 0.0)),
        (0.75, outside(-0.8, 0.0)),
        (1.35, outside(-FRAC_PI_2, 0.0)),
        (2.05, outside(rim, 1.0)),
        (2.65, outside(rim, 1.0 + TAU / 8.0)),
        (3.7, outside(rim, FRAC_PI_2)),
    ];
    let mut lines: Vec<LogLine> = places.into_iter().map(|(t, at_m)| stick(t, at_m)).collect();
    lines.extend(resting(1, "rim", [0.5, 0.8], 1.5, [3.5, 4.2]));
    lines.sort_by(|a, b| a.t.total_cmp(&b.t));
    lines
}

/// A wooden stick falls on a place.
fn stick(t: f64, at_m: [f64; 3]) -> LogLine {
    let at_m = at_m.map(|x| (x * 1e5).round() / 1e5);
    strike(t, ("bowl", Some(at_m)), 0.8, Striker::Preset("wood".to_owned()), (0.01, 0.006))
}
