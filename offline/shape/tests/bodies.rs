//! Bodies made of their surfaces against closed forms, independent calculations and meshes of their
//! own.

use crate::common;

use asperity_shape::eigenmodes::Wanted;
use asperity_shape::{Elastic, Making, Mesh, SolvedBody, make};

const STEEL: Elastic = Elastic { young_pa: 200e9, poisson: 0.29, density_kg_m3: 7850.0 };

fn body(mesh: Mesh, modes: usize) -> SolvedBody {
    let wanted = Wanted { up_to_hz: None, most: modes };
    make(
        mesh,
        &Making { material: STEEL, size_m: None, unit_m: None, thickness_m: None, wanted },
        &mut |_| (),
    )
    .unwrap()
}

fn worst(body: &SolvedBody, expected_hz: &[f64]) -> f64 {
    assert!(body.frequency_hz.len() >= expected_hz.len());
    body.frequency_hz.iter().zip(expected_hz).map(|(hz, e)| (hz / e - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn a_thin_square_plate_rings_as_rayleigh_ritz_says() {
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
    assert!((solved.volume_m3 / 4.8e-4 - 1.0).abs() < 1e-3 && solved.remarks.is_empty());
}

#[test]
fn a_ball_has_all_its_modes_that_coincide_where_lamb_has_them() {
    // Roots of the frequency equations of torsional and spheroidal vibration (Lamb 1882; Eringen &
    // Suhubi, Elastodynamics II), by scipy's brentq: l = 2, 2, 1, 3 with 2 l + 1 modes each.
    let lamb_hz: Vec<f64> = [(25_018.26, 5), (26_457.40, 5), (35_104.69, 3), (38_657.72, 7)]
        .into_iter()
        .flat_map(|(hz, modes)| vec![hz; modes])
        .collect();
    let solved = body(Mesh::Surface(common::surface_of(&common::ball(0.05, 16))), 20);
    assert!(worst(&solved, &lamb_hz) < 8e-3, "{:?}", solved.frequency_hz);
}

#[test]
fn half_a_hollow_ball_rings_as_its_own_fine_mesh_does() {
    // A steel bowl of mean radius 50 mm and wall 4 mm, by this crate's elements on `common::bowl`
    // (`BOWL_HZ`).
    let solved = body(Mesh::Surface(common::surface_of(&common::bowl(0.05, 0.004, [72, 24, 1]))), 20);
    assert!(worst(&solved, &BOWL_HZ) < 1e-2, "{:?}", solved.frequency_hz);
}

/// With cells [72, 24, 1]: 61,569 unknowns.
const BOWL_HZ: [f64; 20] = [
    1531.0, 1531.0, 3956.0, 3956.0, 7103.0, 7103.0, 10_860.0, 10_860.0, 14_330.0, 14_376.0, 14_376.0,
    15_197.0, 15_197.0, 15_680.0, 15_680.0, 16_124.0, 17_411.0, 17_411.0, 17_544.0, 17_544.0,
];

#[test]
fn props_of_a_game_ring_stuffed_as_their_volume_meshes_do() {
    // A horn: 20 cm long, bent through a third of a turn, thick at one end, oval across.
    let horn = |cells: [usize; 3]| {
        common::mapped(cells, |[along, across, up]| {
            // A round section from a square one, so that no edge runs along it.
            let across_up = [across, up];
            let (most, length) = (across.abs().max(up.abs()), across.hypot(up));
            let round = if length == 0.0 { 0.0 } else { most / length };
            let thick_m = 0.016 - 0.008 * along;
            let [y, z] = [across_up[0] * round * thick_m, 0.8 * across_up[1] * round * thick_m];
            let (s, c) = (1.05 * along).sin_cos();
            let bend_m = 0.095;
            [(bend_m + y) * s, (bend_m + y) * c, z]
        })
    };
    // A cup whose floor is thicker than its wall.
    let cup = |cells: [usize; 3]| {
        common::lathe(cells, |along, across| {
            let floor = (along / 0.4).min(1.0);
            let rise = ((along - 0.4) / 0.6).max(0.0);
            let inside = [0.031 * floor + 0.004 * rise, 0.009 + 0.075 * rise];
            let outside = [0.038 * floor + 0.003 * rise, 0.084 * rise];
            (outside[0] + across * (inside[0] - outside[0]), outside[1] + across * (inside[1] - outside[1]))
        })
    };
    for (name, mesh) in [("horn", horn([40, 8, 8])), ("cup", cup([40, 24, 3]))] {
        let surface = common::surface_of(&mesh);
        let (filled, stuffed) = (body(Mesh::Volume(mesh), 12), body(Mesh::Surface(surface), 12));
        let error = worst(&stuffed, &filled.frequency_hz);
        println!(
            "{name}: {:.1} to {:.1} Hz, {error:.4}; {} unknowns filled, {} stuffed, {:?} {:.4}",
            filled.frequency_hz[0],
            filled.frequency_hz[11],
            filled.degrees_of_freedom,
            stuffed.degrees_of_freedom,
            stuffed.remarks,
            stuffed.volume_m3 / filled.volume_m3
        );
        assert!(error < 1e-2, "{name}: {:?} {:?}", filled.frequency_hz, stuffed.frequency_hz);
    }
}
