//! The heights in a trace of every source of a scene file are those of the source's own definition,
//! to a nanometre: point evaluation in the library, a spline solved here, and Python.

use crate::support;

use asperity_surface::brownian::BrownianDesign;
use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock, Touch};
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use asperity_surface::sand::{SandDesign, SandSource};
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::{SolidCut, SolidNoise, SolidNoiseParameters};
use std::process::Command;
use support::Scene;
use support::oracle::{
    EXTENT_M, PeriodicSpline, RATE_HZ, Row, SEED, STRAIGHT_M_S, bow, faded, pgm, picture, straight, trace,
    values,
};

/// What the heights of a trace may differ by, m.
const NEAR_M: f64 = 1e-9;

fn traced(source: &str) -> (Scene, Vec<Row>) {
    let scene = Scene::new();
    scene.write("stroke.jsonl", bow());
    picture(32, 24).save(scene.path("map.png")).unwrap();
    scene.write("cell.pgm", pgm(&picture(16, 20)));
    let rows = trace(&scene, source);
    assert!(rows.len() >= 13_230, "a row a sample of 0.3 s, and the fade: {}", rows.len());
    (scene, rows)
}

/// Compares every row with a height that depends on the place and the sample.
fn assert_heights(name: &str, rows: &[Row], oracle: impl Fn(&Row) -> f64) {
    let worst = rows.iter().map(|row| (row.height_m - oracle(row)).abs()).fold(0.0, f64::max);
    let rms = (rows.iter().map(|row| row.height_m.powi(2)).sum::<f64>() / rows.len() as f64).sqrt();
    println!("{name}: within {worst:.1e} m of the oracle, rms {rms:.1e} m");
    assert!(worst <= NEAR_M && rms > 1e-6, "{name}: {worst} m, rms {rms} m");
}

/// Height of solid noise by its definition, octave by octave.
fn solid(parameters: SolidNoiseParameters, seed: u64) -> impl Fn([f64; 2]) -> f64 {
    let noise = SolidNoise::new(parameters, seed).unwrap();
    move |at| parameters.amplitude_m * noise.definition(&parameters, SolidCut::SLANTED.at(at))
}

fn material(material: SolidMaterial) -> impl Fn([f64; 2]) -> f64 {
    solid(material.parameters(), SEED)
}

/// Height of the map made by [`picture`] that repeats with the surface.
fn map(relief_m: f64) -> impl Fn([f64; 2]) -> f64 {
    let spline = PeriodicSpline::new(32, 24, &values(&picture(32, 24)));
    move |at| relief_m * spline.at([at[0] / EXTENT_M[0], at[1] / EXTENT_M[1]])
}

/// Runs the independent script on the trace; none when there is no Python outside CI.
fn python(scene: &Scene, arguments: &[&str]) -> Option<serde_json::Value> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/independent/trace_oracle.py");
    let [width, height] = EXTENT_M.map(|extent| extent.to_string());
    let mut all = vec![script, "out.trace.csv", &width, &height];
    all.extend(arguments);
    match Command::new("python3").args(all).current_dir(scene.folder.path()).output() {
        Ok(output) => {
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            Some(serde_json::from_slice(&output.stdout).unwrap())
        }
        Err(error) => {
            asperity_evidence::corpus::skip(&format!("no python3 ({error})"));
            None
        }
    }
}

fn assert_python(name: &str, scene: &Scene, arguments: &[&str]) {
    let Some(report) = python(scene, arguments) else { return };
    println!("{name}, in Python: {report}");
    let number = |key: &str| report[key].as_f64().unwrap();
    assert!(number("rows") > 1000.0 && number("worst_m") <= NEAR_M && number("rms_m") > 1e-6, "{report}");
}

#[test]
fn each_of_the_seven_materials() {
    for preset in SolidMaterial::SEVEN {
        let name = preset.name();
        let (scene, rows) = traced(&format!("solid = \"{name}\""));
        let oracle = material(preset);
        assert_heights(name, &rows, |row| oracle(row.position_m));
        assert_python(name, &scene, &["solid", name, &SEED.to_string()]);
    }
}

#[test]
fn solid_noise_with_its_own_parameters() {
    let (_, rows) = traced(
        "solid = { preset = \"granite\", seed = 99, octaves = 5, frequency = 3.0, lacunarity = 1.9, \
         persistence = 0.7, magnitude = 2.5, amplitude_m = 3e-5, texture_factor_per_m = 80.0 }",
    );
    let mut parameters = SolidMaterial::Granite.parameters();
    (parameters.amplitude_m, parameters.texture_factor_per_m) = (3e-5, 80.0);
    let module = &mut parameters.modules[0];
    (module.octaves, module.frequency, module.lacunarity) = (5, 3.0, 1.9);
    (module.persistence, module.magnitude) = (0.7, 2.5);
    let oracle = solid(parameters, 99);
    assert_heights("five octaves", &rows, |row| oracle(row.position_m));
}

#[test]
fn a_map_repeated_and_mirrored() {
    let (_, rows) = traced("displacement = \"map.png\"\nrelief_m = 4e-4");
    let oracle = map(4e-4);
    assert_heights("map", &rows, |row| oracle(row.position_m));

    // A mirrored map repeats with twice the period. The stroke passes the edge.
    let (scene, _) = traced("solid = \"sand\"");
    scene.write("stroke.jsonl", bow().replace("\"uv\":[0.", "\"uv\":[-0."));
    let rows = trace(&scene, "displacement = \"map.png\"\nrelief_m = 4e-4\nwrap = \"mirror\"");
    let (grey, mirrored) =
        (values(&picture(32, 24)), |i: usize, n: usize| if i < n { i } else { 2 * n - 1 - i });
    let both: Vec<f64> =
        (0..64 * 48).map(|i| grey[mirrored(i / 64, 24) * 32 + mirrored(i % 64, 32)]).collect();
    let spline = PeriodicSpline::new(64, 48, &both);
    assert_heights("mirrored map", &rows, |row| {
        4e-4 * spline.at([row.position_m[0] / (2.0 * EXTENT_M[0]), row.position_m[1] / (2.0 * EXTENT_M[1])])
    });
}

#[test]
fn a_brownian_surface_and_a_brownian_graph() {
    let (_, rows) = traced("brownian = { hurst = 0.6, rms_m = 1e-4, cells = 256 }");
    let mut design = BrownianDesign::new(0.6, 1e-4, SEED);
    design.size = 256;
    let spline = PeriodicSpline::new(256, 256, &design.surface().unwrap().values);
    // A square of the longer edge.
    assert_heights("Brownian surface", &rows, |row| spline.at(row.position_m.map(|p| p / EXTENT_M[0])));

    let scene = Scene::new();
    scene.write("stroke.jsonl", straight());
    let rows = trace(&scene, "brownian = { hurst = 0.8, rms_m = 1e-4, cells = 1024, graph = true }");
    design = BrownianDesign { hurst: 0.8, size: 1024, ..design };
    let spline = PeriodicSpline::new(1024, 1, &design.path().unwrap());
    // By the distance travelled, one step before the first sample; lifted, the finger slows down.
    let rows = &rows[..RATE_HZ as usize];
    let step_m = STRAIGHT_M_S[0].hypot(STRAIGHT_M_S[1]) / RATE_HZ;
    assert_heights("Brownian graph", rows, |row| {
        spline.at([(row.sample + 1) as f64 * step_m / EXTENT_M[0], 0.5])
    });
}

#[test]
fn a_lattice() {
    let source =
        "relief_m = 3e-4\nlattice = { cell = \"cell.pgm\", t1_m = [0.005, 0.001], t2_m = [-0.002, 0.004] }";
    let (scene, rows) = traced(source);
    let cell = Raster { width: 16, height: 20, values: values(&picture(16, 20)) };
    let lattice = Lattice::new(&cell.map(|grey| 3e-4 * grey), [0.005, 0.001], [-0.002, 0.004]).unwrap();
    assert_heights("lattice", &rows, |row| lattice.at(row.position_m).0);
    let translations = ["0.005", "0.001", "-0.002", "0.004"];
    assert_python("lattice", &scene, &[&["lattice", "cell.pgm", "3e-4"][..], &translations].concat());
}

#[test]
fn a_sum_a_scale_a_mask_and_a_crossfade() {
    let (gravel, wood, flat) = (material(SolidMaterial::Gravel), material(SolidMaterial::Wood), map(4e-4));
    let map_table = "displacement = \"map.png\", relief_m = 4e-4";
    let (_, rows) =
        traced(&format!("sum = [{{ solid = \"gravel\" }}, {{ {map_table} }}, {{ solid = \"wood\" }}]"));
    assert_heights("sum", &rows, |row| gravel(row.position_m) + flat(row.position_m) + wood(row.position_m));

    let (_, rows) = traced("scale = -2.5\nsolid = \"gravel\"");
    assert_heights("scale", &rows, |row| -2.5 * gravel(row.position_m));

    let (_, rows) = traced(&format!(
        "mask = {{ image = \"map.png\", inside = {{ solid = \"gravel\" }}, outside = {{ {map_table} }} }}"
    ));
    let weight = map(1.0);
    let share = |row: &Row| weight(row.position_m);
    assert_heights("mask", &rows, |row| {
        let w = share(row).clamp(0.0, 1.0);
        w * gravel(row.position_m) + (1.0 - w) * flat(row.position_m)
    });
    let spread = rows.iter().map(share).fold([1.0_f64, 0.0_f64], |[l, h], w| [l.min(w), h.max(w)]);
    assert!(spread[1] - spread[0] > 0.2, "the stroke crosses the mask: {spread:?}");

    let (_, rows) = traced(
        "crossfade = { from = { solid = \"gravel\" }, to = { solid = \"wood\", scale = 0.5 }, at_s = 0.12 }",
    );
    assert_heights("crossfade", &rows, |row| {
        let w = faded(row.sample, 0.12);
        (1.0 - w) * gravel(row.position_m) + w * 0.5 * wood(row.position_m)
    });
}

/// Plays a straight stroke of the trace into sand made by the library, touch by touch.
fn sand_again(design: &SandDesign, rows: &[Row]) -> Vec<f64> {
    let velocity_m_s = STRAIGHT_M_S;
    let mut sand = SandSource::synchronous(design, SEED).unwrap();
    let mut out = SurfaceBlock::default();
    let mut heights = Vec::new();
    for (k, block) in rows.chunks(MAX_BLOCK).enumerate() {
        let first = (k * MAX_BLOCK).max(1);
        let before = rows[first - 1];
        // The bed is told the path's own velocity, by which it looks ahead of the finger.
        let of_path = [0, 1].map(|a| (rows[first].position_m[a] - before.position_m[a]) * RATE_HZ);
        sand.touch(&Touch {
            contact: 0,
            sample: block[0].sample,
            position_m: before.position_m,
            velocity_m_s: of_path,
            normal_force_n: before.normal_force_n,
            ..Touch::default()
        });
        let position_m: Vec<_> = block.iter().map(|row| row.position_m).collect();
        let normal_force_n: Vec<_> = block.iter().map(|row| row.normal_force_n).collect();
        let step = velocity_m_s[0].hypot(velocity_m_s[1]) / RATE_HZ;
        let path = PathBlock {
            position_m: &position_m,
            velocity_m_s: &vec![velocity_m_s; block.len()],
            footprint_m: &vec![step; block.len()],
            normal_force_n: &normal_force_n,
            first_sample: block[0].sample,
            contact: 0,
            slopes: true,
            ..PathBlock::default()
        };
        sand.sample(&path, &mut out);
        // The sand lies lower by as much as the finger presses it in.
        let pressed = block.iter().enumerate().map(|(i, row)| out.compliance_m_n[i] * row.normal_force_n);
        heights.extend(pressed.enumerate().map(|(i, pressed)| out.height_m[i] - pressed));
    }
    heights
}

#[test]
fn sand_that_gives_way() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", straight());
    let rows = trace(&scene, "sand = { cells = 200, depth_m = 0.02 }");
    let design = SandDesign {
        width_m: EXTENT_M[0],
        height_m: EXTENT_M[1],
        cells: 200,
        depth_m: 0.02,
        ..SandDesign::default()
    };
    let again = sand_again(&design, &rows);
    let worst = rows.iter().zip(&again).map(|(row, again)| (row.height_m - again).abs()).fold(0.0, f64::max);
    println!("sand: within {worst:.1e} m of the oracle");
    assert!(worst <= NEAR_M, "{worst}");
    // Pressed in by 2 N, and a relief on top.
    let mean = rows.iter().map(|row| row.height_m).sum::<f64>() / rows.len() as f64;
    assert!((-2.5e-3..-1.5e-3).contains(&mean), "{mean}");
}

#[test]
fn after_a_hitch_the_traced_finger_neither_jumps_nor_races() {
    for hitch_s in [0.04, 0.1, 0.2] {
        for velocity in [true, false] {
            let scene = Scene::new();
            let hangs = |line: &&str| {
                let t: f64 = line["{\"t\":".len()..].split(',').next().unwrap().parse().unwrap();
                t < 0.4 || t >= 0.4 + hitch_s
            };
            let log: Vec<_> = straight().lines().filter(hangs).map(str::to_owned).collect();
            let reported = "\"velocity_m_s\":[0.06, 0.01],";
            let log = log.join("\n").replace(reported, if velocity { reported } else { "" });
            assert_eq!(log.contains("velocity_m_s"), velocity);
            scene.write("stroke.jsonl", log + "\n");
            let rows = trace(&scene, "roughness = 0.7");
            let own_m_s = STRAIGHT_M_S[0].hypot(STRAIGHT_M_S[1]);
            let fastest = rows.windows(2).map(|pair| {
                assert_eq!(pair[1].sample, pair[0].sample + 1, "two fingers at once");
                let way = [0, 1].map(|axis| pair[1].position_m[axis] - pair[0].position_m[axis]);
                way[0].hypot(way[1]) * RATE_HZ / own_m_s
            });
            let fastest = fastest.fold(0.0, f64::max);
            println!("{hitch_s} s without reports, velocity reported {velocity}: {fastest:.2} times as fast");
            assert!(fastest <= 1.5, "{hitch_s} s: {fastest} times as fast");
        }
    }
}
