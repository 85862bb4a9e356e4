//! Meshes as people have them: each becomes the right body or is refused with the reason.

use crate::common;

use asperity_shape::eigenmodes::Wanted;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::volume_mesh::VolumeMesh;
use asperity_shape::{Elastic, Making, Mesh, ShapeError, SolvedBody, make};

const MATERIAL: Elastic = Elastic { young_pa: 70e9, poisson: 0.24, density_kg_m3: 2400.0 };

fn made(mesh: Mesh, thickness_m: Option<f64>) -> Result<SolvedBody, ShapeError> {
    let wanted = Wanted { up_to_hz: None, most: 4 };
    make(mesh, &Making { material: MATERIAL, size_m: None, thickness_m, wanted }, &mut |_| ())
}

fn clean() -> SurfaceMesh {
    common::box_surface([0.12, 0.08, 0.05])
}

fn flipped(mut mesh: SurfaceMesh, which: impl Fn(usize) -> bool) -> SurfaceMesh {
    for (t, triangle) in mesh.triangles.iter_mut().enumerate() {
        if which(t) {
            triangle.swap(1, 2);
        }
    }
    mesh
}

fn joined(mut a: SurfaceMesh, b: &SurfaceMesh, by: [f64; 3]) -> SurfaceMesh {
    let n = a.points.len() as u32;
    a.points.extend(b.points.iter().map(|p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]]));
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|i| i + n)));
    a
}

#[test]
fn inverted_mixed_doubled_leaky_and_loose_meshes_are_the_clean_body_and_say_what_was_mended() {
    let expected = made(Mesh::Surface(clean()), None).unwrap();
    let mut leaky = clean();
    leaky.triangles.pop();
    let mut loose = SurfaceMesh::default();
    for triangle in clean().triangles {
        let n = loose.points.len() as u32;
        loose.points.extend(clean().corners(triangle));
        loose.triangles.push([n, n + 1, n + 2]);
    }
    let doubled = joined(clean(), &flipped(clean(), |_| true), [0.0; 3]);
    for (mesh, told) in [
        (flipped(clean(), |_| true), "inside out"),
        (flipped(clean(), |t| t % 3 == 0), "inside out"),
        (doubled, "doubled"),
        (leaky, "closed"),
        (loose, ""),
    ] {
        let solved = made(Mesh::Surface(mesh), None).unwrap();
        for (hz, e) in solved.frequency_hz.iter().zip(&expected.frequency_hz) {
            assert!((hz / e - 1.0).abs() < 5e-3, "{told}: {hz} {e}");
        }
        assert!(solved.told.iter().any(|line| line.contains(told)) || told.is_empty(), "{:?}", solved.told);
    }
}

#[test]
fn bodies_that_cross_are_one_and_a_cavity_stays_one() {
    let crossed = joined(clean(), &common::box_surface([0.05, 0.05, 0.1]), [0.03, 0.015, -0.02]);
    let solved = made(Mesh::Surface(crossed), None).unwrap();
    assert!((solved.volume_m3 / 6.05e-4 - 1.0).abs() < 0.01, "{}", solved.volume_m3);
    let hollow = joined(clean(), &flipped(common::box_surface([0.09, 0.05, 0.02]), |_| true), [0.015; 3]);
    let solved = made(Mesh::Surface(hollow), None).unwrap();
    assert!((solved.volume_m3 / 3.9e-4 - 1.0).abs() < 0.01, "{}", solved.volume_m3);
}

#[test]
fn a_sheet_with_a_thickness_is_the_plate() {
    let sheet = SurfaceMesh {
        points: vec![[0.0; 3], [0.1, 0.0, 0.0], [0.1, 0.08, 0.0], [0.0, 0.08, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let solved = made(Mesh::Surface(sheet.clone()), Some(0.006)).unwrap();
    let plate = made(Mesh::Volume(common::block([0.1, 0.08, 0.006], [30, 24, 2])), None).unwrap();
    for (hz, e) in solved.frequency_hz.iter().zip(&plate.frequency_hz) {
        assert!((hz / e - 1.0).abs() < 7e-3, "{hz} {e}");
    }
    assert!(made(Mesh::Surface(sheet), None).unwrap_err().to_string().contains("--thickness"));
}

#[test]
fn what_is_no_body_is_refused_with_the_reason() {
    let refused = |mesh: Mesh| made(mesh, None).map(|body| body.frequency_hz).unwrap_err().to_string();
    let mut nan = clean();
    nan.points[3][1] = f64::NAN;
    let mut large = clean();
    large.points.iter_mut().flatten().for_each(|x| *x *= 1e7);
    let paper = common::box_surface([0.2, 0.15, 5e-5]);
    let flat = flipped(common::box_surface([0.2, 0.15, 0.0]), |_| false);
    for (mesh, reason) in [
        (nan, "not a number"),
        (large, "metres"),
        (paper, "too thin"),
        (flat, "--thickness"),
        (SurfaceMesh::default(), "no triangle"),
        (joined(clean(), &clean(), [0.5, 0.0, 0.0]), "2 separate parts"),
    ] {
        let message = refused(Mesh::Surface(mesh));
        assert!(message.contains(reason) && !message.contains('\n'), "{message}");
    }
    let block = common::block([0.1; 3], [2; 3]);
    let mut two = block.clone();
    two.points.extend(block.points.iter().map(|p| [p[0] + 0.1, p[1] + 0.1, p[2]]));
    two.tets.extend(block.tets.iter().map(|t| t.map(|i| i + block.points.len() as u32)));
    // They share an edge, which carries no moment.
    assert!(refused(Mesh::Volume(two)).contains("2 separate parts"));
    let mut overlapping = block.clone();
    overlapping.points.push([0.049; 3]);
    let [a, b, c, _] = block.tets[0];
    overlapping.tets.push([a, b, c, overlapping.points.len() as u32 - 1]);
    assert!(refused(Mesh::Volume(overlapping)).contains("overlap"));
    assert!(refused(Mesh::Volume(VolumeMesh::default())).contains("no tetrahedron"));
}

#[test]
fn another_size_and_stiffness_need_no_new_solve() {
    let mesh = common::block([0.1, 0.06, 0.03], [5, 3, 2]);
    let body = made(Mesh::Volume(mesh.clone()), None).unwrap();
    let lead = Elastic { young_pa: 16e9, density_kg_m3: 11_340.0, ..MATERIAL };
    let rescaled = body.rescaled(2.5, &MATERIAL, &lead);
    let wanted = Wanted { up_to_hz: None, most: 4 };
    let making = Making { material: lead, size_m: Some(0.25), thickness_m: None, wanted };
    let solved = make(Mesh::Volume(mesh), &making, &mut |_| ()).unwrap();
    for (m, (a, b)) in rescaled.frequency_hz.iter().zip(&solved.frequency_hz).enumerate() {
        assert!(
            (a / b - 1.0).abs() < 1e-9
                && (rescaled.field.gains[m] / solved.field.gains[m] - 1.0).abs() < 1e-6
        );
    }
    assert!((rescaled.mass_kg / solved.mass_kg - 1.0).abs() < 1e-9);
}
