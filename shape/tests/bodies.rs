//! Bodies made of their surfaces against closed forms, independent calculations and meshes of their own.

mod common;

use asperity_shape::eigenmodes::Wanted;
use asperity_shape::{Elastic, Making, Mesh, SolvedBody, make};

const STEEL: Elastic = Elastic { young_pa: 200e9, poisson: 0.29, density_kg_m3: 7850.0 };

fn body(mesh: Mesh, modes: usize) -> SolvedBody {
    let wanted = Wanted { up_to_hz: None, most: modes };
    make(mesh, &Making { material: STEEL, size_m: None, thickness_m: None, wanted }, &mut |_| ()).unwrap()
}

fn worst(body: &SolvedBody, expected_hz: &[f64]) -> f64 {
    assert!(body.frequency_hz.len() >= expected_hz.len());
    body.frequency_hz.iter().zip(expected_hz).map(|(hz, e)| (hz / e - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn a_square_plate_with_one_element_through_its_wall_rings_as_rayleigh_ritz_says() {
    // tests/oracles/rayleigh_ritz.py 0.2 0.2 0.003 200e9 0.29 7850 14 10
    const RITZ_HZ: [f64; 10] =
        [245.25, 357.84, 439.75, 632.56, 632.56, 1108.30, 1108.30, 1154.77, 1257.60, 1396.56];
    let error = worst(&body(Mesh::Volume(common::block([0.2, 0.2, 0.003], [28, 28, 1])), 10), &RITZ_HZ);
    assert!(error < 7e-3, "{error}");
}

#[test]
fn a_box_of_twelve_triangles_keeps_its_edges_and_its_pitches() {
    // tests/oracles/rayleigh_ritz.py 0.12 0.08 0.05 200e9 0.29 7850 12 20
    const RITZ_HZ: [f64; 20] = [
        10_597.6, 12_481.6, 15_387.3, 20_272.1, 20_408.0, 20_464.5, 22_962.9, 23_094.0, 26_351.7, 26_833.3,
        27_268.4, 27_584.5, 30_691.6, 30_753.9, 31_719.3, 31_821.6, 32_077.7, 32_126.5, 32_784.5, 33_205.9,
    ];
    let solved = body(Mesh::Surface(common::box_surface([0.12, 0.08, 0.05])), 20);
    assert!(worst(&solved, &RITZ_HZ) < 5e-3, "{:?}", solved.frequency_hz);
    assert!((solved.volume_m3 / 4.8e-4 - 1.0).abs() < 1e-3 && solved.told.is_empty());
}

#[test]
fn a_ball_has_all_its_modes_that_coincide_where_lamb_has_them() {
    // Roots of the frequency equations of torsional and spheroidal vibration (Lamb 1882; Eringen & Suhubi, Elastodynamics
    // II), by scipy's brentq: l = 2, 2, 1, 3 with 2 l + 1 modes each.
    let lamb_hz: Vec<f64> = [(25_018.26, 5), (26_457.40, 5), (35_104.69, 3), (38_657.72, 7)]
        .into_iter()
        .flat_map(|(hz, modes)| vec![hz; modes])
        .collect();
    let solved = body(Mesh::Surface(common::surface_of(&common::ball(0.05, 16))), 20);
    assert!(worst(&solved, &lamb_hz) < 8e-3, "{:?}", solved.frequency_hz);
}

#[test]
fn half_a_hollow_ball_rings_as_its_own_fine_mesh_does() {
    // A steel bowl of mean radius 50 mm and wall 4 mm, by this crate's elements on `common::bowl` (`BOWL_HZ`).
    let solved = body(Mesh::Surface(common::surface_of(&common::bowl(0.05, 0.004, [72, 24, 1]))), 20);
    assert!(worst(&solved, &BOWL_HZ) < 1e-2, "{:?}", solved.frequency_hz);
}

/// With cells [72, 24, 1]: 61,569 unknowns.
const BOWL_HZ: [f64; 20] = [
    1531.0, 1531.0, 3956.0, 3956.0, 7103.0, 7103.0, 10_860.0, 10_860.0, 14_330.0, 14_376.0, 14_376.0,
    15_197.0, 15_197.0, 15_680.0, 15_680.0, 16_124.0, 17_411.0, 17_411.0, 17_544.0, 17_544.0,
];
