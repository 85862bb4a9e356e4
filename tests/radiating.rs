//! Bodies as loud as their shapes radiate, in pascals at 1 m, through the engine.

use asperity::{
    Body, Config, ContactEvent, Engine, Impact, Material, ModalModel, Mode, ModeShapes, ShapeUnit,
};
use asperity_dsp::radiation::{EquivalentSphere, Surface, click_pa};

/// A box of 60 × 40 × 20 mm, each side a grid of 8 × 8 cells, points of its own.
fn cuboid() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (size, cells) = ([0.06, 0.04, 0.02], 8_u32);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [-0.5, 0.5] {
            let first = points.len() as u32;
            for (i, j) in (0..=cells).flat_map(|i| (0..=cells).map(move |j| (i, j))) {
                let mut p = [0.0; 3];
                p[axis] = side * size[axis];
                p[u] = (f64::from(i) / f64::from(cells) - 0.5) * size[u];
                p[v] = (f64::from(j) / f64::from(cells) - 0.5) * size[v];
                points.push(p);
            }
            let at = |i: u32, j: u32| first + i * (cells + 1) + j;
            for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend(if side > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
    }
    (points, triangles)
}

/// A block of which three modes are told: it breathes, bends, and bends twice.
fn block() -> ModalModel {
    let (points_m, triangles) = cuboid();
    let shape = |m: usize, p: &[f64; 3]| match m {
        0 => p.map(|x| (60.0 * x) as f32),
        1 => [0.0, 0.0, (3.0 * (100.0 * p[0]).cos()) as f32],
        _ => [0.0, 0.0, (3.0 * (150.0 * p[0]).sin()) as f32],
    };
    let shapes = ModeShapes {
        gains: vec![0.5, 2.0, 1.0],
        phi_per_sqrt_kg: (0..3).map(|m| points_m.iter().map(|p| shape(m, p)).collect()).collect(),
        struck_point: 440,
        points_m,
        triangles,
    };
    let mode = |m: usize| Mode {
        frequency_hz: [3_000.0, 5_000.0, 9_000.0][m],
        decay_per_s: 30.0,
        amplitude: shapes.gains[m] * f64::from(shapes.phi_per_sqrt_kg[m][440][2]),
        phase_rad: std::f64::consts::FRAC_PI_2,
    };
    let modes = (0..3).map(mode).collect();
    ModalModel::new(modes, 1.0).unwrap().with_shapes(shapes, ShapeUnit::Relative).unwrap()
}

#[test]
fn each_mode_is_as_loud_as_its_shape_radiates() {
    let (plain, loud) = (block(), block().radiating(&Material::STEEL).unwrap());
    assert_eq!(loud.unit, ShapeUnit::PascalsAtOneMetre);
    let shapes = plain.shapes.as_ref().unwrap();
    let surface = Surface { points_m: &shapes.points_m, triangles: &shapes.triangles };
    let sphere = EquivalentSphere::of(&surface).unwrap();
    for m in 0..3 {
        let phi = &shapes.phi_per_sqrt_kg[m];
        let multipoles = sphere.multipoles(&surface, |i| phi[i].map(f64::from));
        let hz = plain.modes[m].frequency_hz;
        let gain = sphere.pressure_pa_s_m(&multipoles, hz);
        let found = loud.shapes.as_ref().unwrap().gains[m];
        assert!((found / gain - 1.0).abs() < 1e-12, "{found} {gain}");
        let struck = loud.modes[m].amplitude / plain.modes[m].amplitude * shapes.gains[m];
        assert!((struck / gain - 1.0).abs() < 1e-12);
        let loss = loud.modes[m].decay_per_s - plain.modes[m].decay_per_s;
        assert!((loss / sphere.loss_per_s(&multipoles, hz) - 1.0).abs() < 1e-9 && loss > 0.0);
    }
    assert_eq!(loud.clone().radiating(&Material::STEEL).unwrap(), loud);
    // And it survives the way through a file.
    assert_eq!(ModalModel::parse(&loud.to_json()).unwrap(), loud);
}

#[test]
fn what_has_no_shapes_is_refused_with_the_reason() {
    let mode = Mode { frequency_hz: 300.0, decay_per_s: 4.0, amplitude: 1.0, phase_rad: 0.0 };
    let model = ModalModel::new(vec![mode], 1.0).unwrap();
    let error = model.radiating(&Material::STEEL).unwrap_err().to_string();
    assert!(error.contains("no shapes"), "{error}");
}

fn struck(model: ModalModel, block: usize) -> Vec<f32> {
    let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
    let body = engine.scene.add_body(Body::new(model).material(Material::STEEL)).unwrap();
    engine.scene.report(0.01, ContactEvent::Impact(Impact::on(body).at_m([0.0, 0.0, 0.01]))).unwrap();
    let mut sound = vec![0.0; 4_410];
    let mut felt = vec![0.0; 4_410];
    for (felt, sound) in felt.chunks_mut(block).zip(sound.chunks_mut(block)) {
        engine.renderer.render(&mut [felt], &mut [sound]);
    }
    sound
}

#[test]
fn a_blow_clicks_as_its_closed_form_in_any_split() {
    let loud = block().radiating(&Material::STEEL).unwrap();
    let silent = ModalModel { click: None, ..loud.clone() };
    let (with, without) = (struck(loud.clone(), 512), struck(silent, 512));
    let click: Vec<f32> = with.iter().zip(&without).map(|(a, b)| a - b).collect();
    let peak = click.iter().fold(0.0_f32, |peak, y| peak.max(y.abs()));
    let first = click.iter().position(|y| *y != 0.0).unwrap();
    let last = click.iter().rposition(|y| *y != 0.0).unwrap();
    // 4 g of steel at 1 m/s: some tens of microseconds, so what a sample hears is the mean of a
    // part of it. Sound lags by the impulse ring's two samples.
    assert!(first.abs_diff(443) <= 1 && last - first <= 6, "{first} to {last}");
    let body = loud.click.unwrap();
    assert!((body.volume_m3 / (0.06 * 0.04 * 0.02) - 1.0).abs() < 1e-9);
    let exact = click_pa(body.volume_m3, 0.008 / body.mass_kg, 40e-6);
    assert!(f64::from(peak) > 0.05 * exact && f64::from(peak) < exact, "{peak} of {exact} Pa");
    for block in [1, 17, 64] {
        assert!(struck(loud.clone(), block) == with, "blocks of {block}");
    }
    let louder = struck(loud.with_gain(4.0).unwrap(), 512);
    assert!(louder.iter().zip(&with).all(|(a, b)| (a - 4.0 * b).abs() <= 1e-4 * a.abs().max(1e-6)));
}

#[test]
fn the_key_of_a_body_is_stable_and_changes_nothing_when_absent() {
    let folder = std::env::temp_dir().join(format!("asperity-radiating-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("block.modes.json"), block().to_json()).unwrap();
    let log = "{\"t\":0.01,\"event\":\"impact\",\"body\":\"block\",\"speed_m_s\":1.0,\"mass_kg\":0.004,\"radius_m\":0.005,\"striker\":\"steel\",\"at_m\":[0,0,0.01]}\n";
    std::fs::write(folder.join("block.jsonl"), log).unwrap();
    let sound = |key: &str| {
        let text = format!(
            "contacts = \"block.jsonl\"\n[[body]]\nname = \"block\"\nmodes = \"block.modes.json\"\nmaterial = \"steel\"\n{key}\n[audio]\ngain = 1.0\n"
        );
        let path = folder.join("block.toml");
        std::fs::write(&path, text).unwrap();
        Engine::open(&path).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(sound(""), Ok(()));
    assert_eq!(sound("radiation = true"), Ok(()));
    assert!(sound("radiation = 1").unwrap_err().contains("radiation"));
    std::fs::write(folder.join("block.modes.json"), r#"{"format":"asperity.modes","version":1,"modes":[]}"#)
        .unwrap();
    let error = sound("radiation = true").unwrap_err();
    assert!(error.contains("no shapes") && error.contains("block"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}
