//! Bodies that answer back: a bar and a plate struck at places, held and let go, bowed.
//!
//! Their modes are closed forms with shapes on a sheet: Euler–Bernoulli's free bar, and Kirchhoff's
//! plate with edges that rest on supports.

use super::demo_scene::DemoScene;
use super::strokes::{Finger, log, resting, strike};
use asperity::files::contact_log::{LogLine, Striker};
use asperity::{ModalModel, Mode, ModeShapes, ShapeUnit};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Length, width and thickness of the steel bar, m.
const BAR_M: [f64; 3] = [0.4, 0.03, 0.008];
/// Length, width and thickness of the steel plate, m.
const PLATE_M: [f64; 3] = [0.3, 0.24, 0.002];
const STEEL_PA: f64 = 200e9;
const STEEL_POISSON: f64 = 0.29;
const STEEL_KG_M3: f64 = 7850.0;
/// Bending modes of the bar.
const BAR_MODES: usize = 8;
/// Half waves along and across the plate, at most.
const PLATE_ORDERS: [usize; 2] = [6, 4];
/// Place of the bar's second line of nodes over its length: a strike there leaves the lowest mode
/// out.
const NODE: f64 = 0.2242;

/// The scene.
pub fn scene() -> DemoScene {
    let asset = |name: &str, model: ModalModel| (name.to_owned(), model.to_json().into_bytes());
    DemoScene {
        name: "answering",
        title: "A bar and a plate that answer back",
        notice: "A steel bar is struck at its end, on a node of its lowest mode and in the middle: each place sounds different. \
                 Then it is struck under a finger, which shortens it, and free, and touched and let go while it rings. Then a bow is drawn \
                 over its end and back: it sticks and slips, and sings on a pitch that is in no report. The same on a plate.",
        toml: toml(),
        log: log(lines()),
        assets: vec![asset("answering.bar.modes.json", bar()), asset("answering.plate.modes.json", plate())],
    }
}

/// A sheet in the plane z = 0 that swings across it.
struct Sheet {
    size_m: [f64; 2],
    cells: [usize; 2],
    mass_kg: f64,
}

impl Sheet {
    /// The modes of a sheet: frequency, Hz, decay, 1/s, and shape with a mean square of 1.
    fn model(
        &self,
        source: &str,
        modes: &[(f64, f64)],
        shape: impl Fn(usize, [f64; 2]) -> f64,
    ) -> ModalModel {
        let [columns, rows] = self.cells;
        let at = |i: usize, j: usize| {
            [self.size_m[0] * i as f64 / columns as f64, self.size_m[1] * j as f64 / rows as f64]
        };
        let places: Vec<[f64; 2]> =
            (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| at(i, j)).collect();
        let index = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
        let quads = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        let triangles = quads.flat_map(|(i, j)| {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        let phi = |m: usize, p: [f64; 2]| shape(m, p) / self.mass_kg.sqrt();
        // Where no mode of the plate has a node line.
        let struck = columns / 7 + 2 * (columns + 1);
        let mode = |(m, (frequency_hz, decay_per_s)): (usize, &(f64, f64))| Mode {
            frequency_hz: *frequency_hz,
            decay_per_s: *decay_per_s,
            amplitude: phi(m, places[struck]),
            phase_rad: FRAC_PI_2,
        };
        let round = |x: f64| ((x * 1e5).round() / 1e5) as f32;
        let shapes = ModeShapes {
            points_m: places.iter().map(|[x, y]| [*x, *y, 0.0]).collect(),
            triangles: triangles.collect(),
            gains: vec![1.0; modes.len()],
            phi_per_sqrt_kg: (0..modes.len())
                .map(|m| places.iter().map(|p| [0.0, 0.0, round(phi(m, *p))]).collect())
                .collect(),
            struck_point: struck,
        };
        let model = ModalModel {
            source: source.to_owned(),
            modes: modes.iter().enumerate().map(mode).collect(),
            ..ModalModel::silent()
        };
        // One motion a mode and point, all finite: it fits.
        model.clone().with_shapes(shapes, ShapeUnit::Relative).unwrap_or(model)
    }
}

/// A free bar: f ∝ (βL)², cos βL cosh βL = 1.
fn bar() -> ModalModel {
    let [length_m, width_m, thickness_m] = BAR_M;
    let speed = (STEEL_PA / STEEL_KG_M3).sqrt() * thickness_m / 12.0_f64.sqrt();
    let wave = |m: usize| match m {
        0 => 4.730_040_745,
        1 => 7.853_204_624,
        _ => (2 * m + 3) as f64 * FRAC_PI_2,
    };
    let modes: Vec<(f64, f64)> = (0..BAR_MODES)
        .map(|m| {
            let hz = (wave(m) / length_m).powi(2) * speed / TAU;
            (hz, 1.2 + 3e-7 * hz * hz)
        })
        .collect();
    let shape = |m: usize, p: [f64; 2]| {
        // With the growing part from the nearer end, so that nothing cancels.
        let (b, odd) = (wave(m), m % 2 == 1);
        let near = (p[0] / length_m).min(1.0 - p[0] / length_m);
        let sign = if odd && p[0] > 0.5 * length_m { -1.0 } else { 1.0 };
        let s = (b.cosh() - b.cos()) / (b.sinh() - b.sin());
        let x = b * near;
        sign * (0.5 * (1.0 - s) * x.exp() + 0.5 * (1.0 + s) * (-x).exp() + x.cos() - s * x.sin())
    };
    let mass_kg = STEEL_KG_M3 * length_m * width_m * thickness_m;
    Sheet { size_m: [length_m, width_m], cells: [64, 2], mass_kg }.model(
        "free steel bar, closed form",
        &modes,
        shape,
    )
}

/// A plate on supports: half waves along and across.
fn plate() -> ModalModel {
    let [length_m, width_m, thickness_m] = PLATE_M;
    let stiff = STEEL_PA / (12.0 * STEEL_KG_M3 * (1.0 - STEEL_POISSON * STEEL_POISSON));
    let [along, across] = PLATE_ORDERS;
    let orders = |m: usize| [(m % along + 1) as f64, (m / along + 1) as f64];
    let modes: Vec<(f64, f64)> = (0..along * across)
        .map(|m| {
            let [a, b] = orders(m);
            let hz =
                FRAC_PI_2 * ((a / length_m).powi(2) + (b / width_m).powi(2)) * thickness_m * stiff.sqrt();
            (hz, 2.5 + 1e-3 * hz)
        })
        .collect();
    let shape = |m: usize, [x, y]: [f64; 2]| {
        let [a, b] = orders(m);
        2.0 * (a * PI * x / length_m).sin() * (b * PI * y / width_m).sin()
    };
    let mass_kg = STEEL_KG_M3 * length_m * width_m * thickness_m;
    Sheet { size_m: [length_m, width_m], cells: [24, 16], mass_kg }.model(
        "steel plate on supports, closed form",
        &modes,
        shape,
    )
}

fn toml() -> String {
    let mut text = "# Bodies with shapes: struck anywhere, held, and bowed.\ncontacts = \"answering.jsonl\"\ntail_s = 1.5\n\n".to_owned();
    let hole = PLATE_M.map(|side| side / 3.0);
    // A bow stands across the bar's end, and runs through a hole of the plate: u is its hair, out
    // of the sheet.
    for (body, size_m, bow_m) in [("bar", BAR_M, [0.0; 2]), ("plate", PLATE_M, [hole[0], hole[1]])] {
        let [width_m, height_m, _] = size_m;
        let [x, y] = bow_m;
        text += &format!(
            "[[body]]\nname = \"{body}\"\nmodes = \"answering.{body}.modes.json\"\nmaterial = \"steel\"\n\n\
             [[surface]]                # a finger lies on it\nname = \"{body}-top\"\nbody = \"{body}\"\n\
             width_m = {width_m}\nheight_m = {height_m}\nmicro_relief_m = 0.0\n\
             [surface.frame]\norigin_m = [0.0, 0.0, 0.0]\nu_axis = [1.0, 0.0, 0.0]\nv_axis = [0.0, 1.0, 0.0]\n\n\
             [[surface]]                # and a bow is drawn over it\nname = \"{body}-bow\"\nbody = \"{body}\"\n\
             width_m = {BOW_M}\nheight_m = 0.03\nmicro_relief_m = 0.0\n\
             excitation = [\"friction\"]\nmu_static = 0.8\nmu_kinetic = 0.3\nslip_speed_m_s = 0.05\n\
             [surface.frame]\norigin_m = [{x}, {y}, 0.0]\nu_axis = [0.0, 0.0, 1.0]\nv_axis = [0.0, 1.0, 0.0]\n\n"
        );
    }
    text + "[[actuator]]\nfull_scale = 0.001\n\n[audio]\ngain = 2.5\n"
}

/// Length of the bow's hair, m.
const BOW_M: f64 = 0.4;

/// Everything that happens, in order.
fn lines() -> Vec<LogLine> {
    let mut lines = Vec::new();
    let mut t = 0.15;
    for (number, (body, size_m, places, finger)) in [
        ("bar", BAR_M, [[0.005, 0.5], [NODE, 0.5], [0.5, 0.5]], [0.5, 0.5]),
        ("plate", PLATE_M, [[0.13, 0.17], [0.5, 0.4], [0.5, 0.5]], [0.3, 0.3]),
    ]
    .into_iter()
    .enumerate()
    {
        for place in places {
            lines.push(mallet(t, body, size_m, place));
            t += 0.6;
        }
        let contact = 10 * number as u64;
        let top = format!("{body}-top");
        // Struck under a finger, and free.
        lines.extend(resting(contact + 1, &top, finger, 2.0, [t, t + 0.7]));
        lines.push(mallet(t + 0.15, body, size_m, places[0]));
        lines.push(mallet(t + 0.9, body, size_m, places[0]));
        t += 1.7;
        // Touched while it rings, and let go.
        lines.push(mallet(t, body, size_m, places[0]));
        lines.extend(resting(contact + 2, &top, finger, 2.0, [t + 0.4, t + 0.55]));
        t += 1.2;
        let bow = format!("{body}-bow");
        let bow = Finger {
            contact: contact + 3,
            surface: &bow,
            extent_m: [BOW_M, 0.03],
            start_s: t,
            normal_force_n: if number == 0 { 2.5 } else { 4.0 },
            from_m: [0.05, 0.015],
            // Slow enough: faster than this friction no longer falls steeply enough to feed the
            // lowest mode.
            strokes: vec![([0.3, 0.015], 0.12), ([0.05, 0.015], 0.09)],
        };
        lines.extend(bow.lines());
        t = lines.last().map_or(t, |line| line.t) + 1.3;
    }
    lines.sort_by(|a, b| a.t.total_cmp(&b.t));
    lines
}

/// A wooden mallet falls on a place, in shares of the sides.
fn mallet(t: f64, body: &str, size_m: [f64; 3], [x, y]: [f64; 2]) -> LogLine {
    let at_m = [x * size_m[0], y * size_m[1], 0.0];
    strike(t, (body, Some(at_m)), 0.8, Striker::Preset("wood".to_owned()), (0.012, 0.01))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_mass_normalised_and_the_bars_node_is_one() {
        for model in [bar(), plate()] {
            let shapes = model.shapes.as_ref().unwrap();
            assert_eq!(shapes.phi_per_sqrt_kg.len(), model.modes.len());
        }
        let bar = bar();
        let shapes = bar.shapes.unwrap();
        let lowest = &shapes.phi_per_sqrt_kg[0];
        let at = |x: f64| {
            let column = (64.0 * x) as usize;
            let part = (64.0 * x) as f32 - column as f32;
            lowest[column][2] * (1.0 - part) + lowest[column + 1][2] * part
        };
        let end = lowest[0][2];
        let mass_kg = STEEL_KG_M3 * BAR_M[0] * BAR_M[1] * BAR_M[2];
        assert!((f64::from(end) - 2.0 / mass_kg.sqrt()).abs() < 1e-3, "{end}");
        assert!((at(NODE) / end).abs() < 0.01, "{}", at(NODE) / end);
    }
}
