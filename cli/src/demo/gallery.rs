//! Scenes of surfaces that are not maps: solid noise, Brownian relief, a lattice, sand.

use super::demo_scene::DemoScene;
use super::strokes::{Finger, log};
use asperity::files::contact_log::LogLine;
use asperity_plot::pixels;

/// Side of the gallery's surfaces, m.
const SIDE_M: f64 = 0.12;
/// The presets of the solid-noise paper, in the order they are stroked, and how rough each is where
/// its noise ends (R, assumed): without a finish granite, rough glass and pebbles are smooth below
/// their own waves, and a finger is heard on them only as it lands.
const MATERIALS: [(&str, f64); 7] = [
    ("sandpaper", 0.6),
    ("granite", 0.4),
    ("rough-glass", 0.4),
    ("wood", 0.5),
    ("sand", 0.5),
    ("gravel", 0.5),
    ("pebbles", 0.3),
];

/// The scenes, in the order of the index.
pub fn scenes() -> Vec<DemoScene> {
    vec![materials(), lattice_and_brownian(), sand()]
}

/// A finger that crosses a surface and comes back, beginning at `start_s`.
fn there_and_back(contact: u64, surface: &'static str, start_s: f64, speeds_m_s: [f64; 2]) -> Vec<LogLine> {
    let finger = Finger {
        contact,
        surface,
        extent_m: [SIDE_M; 2],
        start_s,
        normal_force_n: 0.7,
        from_m: [0.02, 0.05],
        strokes: vec![([0.1, 0.06], speeds_m_s[0]), ([0.02, 0.07], speeds_m_s[1])],
    };
    finger.lines()
}

fn plate_body() -> &'static str {
    "[[body]]\nname = \"plate\"\nmodes = \"plate.modes.json\"\nmaterial = \"pla\"\n\n"
}

fn materials() -> DemoScene {
    let mut lines = Vec::new();
    let mut toml = format!(
        "# Seven materials of solid noise, stroked one after the other.\ncontacts = \"materials.jsonl\"\ntail_s = 0.4\n\n{}",
        plate_body()
    );
    let mut start_s = 0.15;
    for (index, (name, finish)) in MATERIALS.into_iter().enumerate() {
        toml += &format!(
            "[[surface]]\nname = \"{name}\"\nbody = \"plate\"\nsolid = \"{name}\"\nroughness = {finish}\n\
             width_m = {SIDE_M}\nheight_m = {SIDE_M}\n\n"
        );
        lines.extend(there_and_back(index as u64 + 1, name, start_s, [0.15, 0.15]));
        start_s = lines.last().map_or(start_s, |line| line.t) + 0.15;
    }
    toml += "[[actuator]]\nfull_scale = 0.001\n\n[audio]\ngain = 5.0\n";
    DemoScene {
        name: "materials",
        title: "Seven materials of solid noise",
        notice: "Sandpaper, granite, rough glass, wood, sand, gravel and pebbles, one stroke across and back each. \
                 Sandpaper rasps loudest, worn pebbles are softest and roll slowly by under the finger, wood has grain on rings.",
        toml,
        log: log(lines),
        assets: Vec::new(),
    }
}

fn lattice_and_brownian() -> DemoScene {
    // A round button in a cell of 64 × 64: the engine repeats it along two oblique translations.
    let side = 64u32;
    let cell: Vec<u16> = (0..side * side)
        .map(|index| {
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side) - 0.5;
            let radius = at(index % side).hypot(at(index / side)) / 0.42;
            let height = if radius < 1.0 { 0.5 + 0.5 * (std::f64::consts::PI * radius).cos() } else { 0.0 };
            (height * 65_535.0) as u16
        })
        .collect();
    let mut lines = there_and_back(1, "lattice", 0.15, [0.1, 0.2]);
    let start_s = lines.last().map_or(0.0, |line| line.t) + 0.2;
    lines.extend(there_and_back(2, "brownian", start_s, [0.1, 0.2]));
    DemoScene {
        name: "lattice-brownian",
        title: "A lattice, then a Brownian surface",
        notice: "First buttons of 0.4 mm on a hexagonal lattice of 6 mm, made of one cell that repeats without end; \
                 then exact fractional Brownian relief, rough at every scale (Hurst index 0.4).",
        toml: format!(
            "# One cell repeated along two translations; a fractal.\ncontacts = \"lattice-brownian.jsonl\"\ntail_s = 0.4\n\n{}\
             [[surface]]\nname = \"lattice\"\nbody = \"plate\"\n\
             lattice = {{ cell = \"lattice-brownian.cell.png\", t1_m = [0.006, 0.0], t2_m = [0.003, 0.005196] }}\n\
             roughness = 0.3\nwidth_m = {SIDE_M}\nheight_m = {SIDE_M}\nrelief_m = 0.0004\n\n\
             [[surface]]\nname = \"brownian\"\nbody = \"plate\"\nbrownian = {{ hurst = 0.4, rms_m = 2e-4 }}\n\
             roughness = 0.6\nwidth_m = {SIDE_M}\nheight_m = {SIDE_M}\n\n\
             [[actuator]]\nfull_scale = 0.001\n\n[audio]\ngain = 10.0\n",
            plate_body()
        ),
        log: log(lines),
        assets: vec![(
            "lattice-brownian.cell.png".to_owned(),
            pixels::png16(side as usize, side as usize, &cell),
        )],
    }
}

/// A finger draws a zigzag; the sand keeps it.
fn sand() -> DemoScene {
    const BOX_M: f64 = 0.2;
    let finger = Finger {
        contact: 1,
        surface: "box",
        extent_m: [BOX_M; 2],
        start_s: 0.15,
        normal_force_n: 3.0,
        from_m: [0.03, 0.05],
        strokes: vec![([0.17, 0.04], 0.15), ([0.04, 0.11], 0.2), ([0.17, 0.1], 0.15), ([0.04, 0.17], 0.25)],
    };
    DemoScene {
        name: "sand",
        title: "Writing in sand",
        notice: "A fingertip draws a zigzag into a box of dry sand at 3 N: the hiss is grains hitting grains, as many \
                 as the finger displaces. The picture, and sand.box.sand.png, show the furrow and its rims after the \
                 sand has come to rest; no grain is lost.",
        toml: format!(
            "# A box of sand, 20 cm wide.\ncontacts = \"sand.jsonl\"\ntail_s = 0.4\n\n{}\
             [[surface]]\nname = \"box\"\nbody = \"plate\"\n\
             sand = {{ cells = 256, depth_m = 0.03, talus_deg = 32.0, stiffness_n = 1000.0, exponent_per_m = 1.0, \
             drag_s_per_m = 20.0, tool_radius_m = 0.006 }}\n\
             roughness = 0.8\nwidth_m = {BOX_M}\nheight_m = {BOX_M}\n\n\
             [[actuator]]\nfull_scale = 0.001\n\n[audio]\ngain = 3.0\n",
            plate_body()
        ),
        log: log(finger.lines()),
        assets: Vec::new(),
    }
}
