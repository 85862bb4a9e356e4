//! Meshes as people have them: each becomes the right body or is refused with the reason.

use crate::common;

use asperity_shape::eigenmodes::Wanted;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::volume_mesh::VolumeMesh;
use asperity_shape::{Elastic, Making, Mesh, ShapeError, SolvedBody, make};

const MATERIAL: Elastic = Elastic { young_pa: 70e9, poisson: 0.24, density_kg_m3: 2400.0 };

fn made(mesh: Mesh, thickness_m: Option<f64>) -> Result<SolvedBody, ShapeError> {
    let wanted = Wanted { up_to_hz: None, most: 4 };
    make(mesh, &Making { material: MATERIAL, size_m: None, unit_m: None, thickness_m, wanted }, &mut |_| ())
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
fn damaged_meshes_are_the_clean_body_and_name_their_repairs() {
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
    for (mesh, remarks) in [
        (flipped(clean(), |_| true), "inside out"),
        (flipped(clean(), |t| t % 3 == 0), "inside out"),
        (doubled, "doubled"),
        (leaky, "closed"),
        (loose, ""),
    ] {
        let solved = made(Mesh::Surface(mesh), None).unwrap();
        for (hz, e) in solved.frequency_hz.iter().zip(&expected.frequency_hz) {
            assert!((hz / e - 1.0).abs() < 5e-3, "{remarks}: {hz} {e}");
        }
        assert!(
            solved.remarks.iter().any(|line| line.contains(remarks)) || remarks.is_empty(),
            "{:?}",
            solved.remarks
        );
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
    let mut far = clean();
    far.points[0][0] = -3e38;
    let paper = common::box_surface([0.2, 0.15, 5e-5]);
    let flat = flipped(common::box_surface([0.2, 0.15, 0.0]), |_| false);
    // An engine of 66 parts was refused for its walls alone.
    let sheets = joined(paper.clone(), &paper, [0.0, 0.0, 0.05]);
    for (mesh, reason) in [
        (nan, "not a number"),
        (large, "metres"),
        (far, "longest side, 3.0e38 m"),
        (paper, "too thin"),
        (sheets, "2 separate pieces"),
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
    let message = refused(Mesh::Volume(VolumeMesh::default()));
    assert!(message.contains("no tetrahedron"), "{message}");
}

/// Deals the triangles out in another order, each begun at another corner.
fn shuffled(mesh: &SurfaceMesh, step: usize) -> SurfaceMesh {
    let n = mesh.triangles.len();
    assert!((0..n).map(|t| t * step % n).collect::<std::collections::HashSet<_>>().len() == n, "{n}, {step}");
    let triangles = (0..n).map(|t| {
        let [a, b, c] = mesh.triangles[(t * step + 3) % n];
        if t % 2 == 0 { [b, c, a] } else { [c, a, b] }
    });
    SurfaceMesh { points: mesh.points.clone(), triangles: triangles.collect() }
}

/// A box whose top edges have middle points that only the sides use, each sealed by a triangle of
/// no area.
fn needled() -> SurfaceMesh {
    let mut mesh = clean();
    for [a, b] in [[4, 5], [5, 7], [7, 6], [6, 4]] {
        let middle = mesh.points.len() as u32;
        let ends = [a, b].map(|i: u32| mesh.points[i as usize]);
        mesh.points.push(std::array::from_fn(|c| 0.5 * (ends[0][c] + ends[1][c])));
        // The triangle of the side is cut at the middle; the needle joins it with the top.
        let side = |t: &[u32; 3]| {
            t.contains(&a) && t.contains(&b) && t.iter().any(|&i| mesh.points[i as usize][2] == 0.0)
        };
        let t = mesh.triangles.iter().position(side).unwrap();
        let [x, y, z] = mesh.triangles[t];
        let turns = [[x, y, z], [y, z, x], [z, x, y]];
        let [from, to, apex] = *turns.iter().find(|[_, _, apex]| *apex != a && *apex != b).unwrap();
        mesh.triangles[t] = [from, middle, apex];
        mesh.triangles.extend([[middle, to, apex], [from, to, middle]]);
    }
    mesh
}

#[test]
fn a_box_sealed_by_needles_is_the_box_in_any_order() {
    let expected = made(Mesh::Surface(clean()), None).unwrap();
    let mesh = needled();
    assert_eq!(mesh.triangles.len(), 20);
    let first = made(Mesh::Surface(mesh.clone()), None).unwrap();
    for (hz, e) in first.frequency_hz.iter().zip(&expected.frequency_hz) {
        assert!((hz / e - 1.0).abs() < 5e-3, "{hz} {e}");
    }
    for step in [3, 7, 11] {
        let again = made(Mesh::Surface(shuffled(&mesh, step)), None).unwrap();
        assert_eq!(again.frequency_hz, first.frequency_hz);
    }
}

#[test]
fn points_that_no_face_uses_and_far_specks_are_no_size() {
    let expected = made(Mesh::Surface(clean()), None).unwrap();
    let mut stray = clean();
    stray.points.insert(0, [5.0; 3]);
    stray.triangles.iter_mut().flatten().for_each(|i| *i += 1);
    let mut speck = clean();
    let first = speck.points.len() as u32;
    speck.points.extend([[5.0, 5.0, 5.0], [5.001, 5.0, 5.0], [5.0, 5.001, 5.0]]);
    speck.triangles.push([first, first + 1, first + 2]);
    for mesh in [stray, speck] {
        let solved = made(Mesh::Surface(mesh), None).unwrap();
        assert!((solved.volume_m3 / expected.volume_m3 - 1.0).abs() < 1e-9, "{}", solved.volume_m3);
        assert!((solved.frequency_hz[0] / expected.frequency_hz[0] - 1.0).abs() < 1e-3);
    }
}

#[test]
fn a_body_far_from_the_origin_is_the_body_and_stays_there() {
    let expected = made(Mesh::Surface(clean()), None).unwrap();
    let far = joined(SurfaceMesh::default(), &clean(), [5.4e6, -2e6, 3e5]);
    let solved = made(Mesh::Surface(far), None).unwrap();
    assert!((solved.frequency_hz[0] / expected.frequency_hz[0] - 1.0).abs() < 5e-3);
    assert!((solved.field.points[0][0] - 5.4e6).abs() < 0.13);
}

#[test]
fn cracks_and_corners_on_edges_are_closed_and_edges_stay_sharp() {
    let expected =
        made(Mesh::Surface(common::surface_of(&common::block([0.12, 0.08, 0.05], [4, 3, 2]))), None).unwrap();
    for width in [1e-7, 1e-6, 1e-5, 1e-4, 5e-4] {
        // Every triangle has corners of its own, each a little off.
        let whole = common::surface_of(&common::block([0.12, 0.08, 0.05], [4, 3, 2]));
        let (mut loose, mut dice) = (SurfaceMesh::default(), 1_u32);
        for &triangle in &whole.triangles {
            let first = loose.points.len() as u32;
            loose.points.extend(whole.corners(triangle).map(|p| {
                p.map(|x| {
                    dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    x + 0.12 * width * (f64::from(dice >> 8) / f64::from(1 << 24) - 0.5)
                })
            }));
            loose.triangles.push([first, first + 1, first + 2]);
        }
        let solved = made(Mesh::Surface(loose), None).unwrap();
        for (hz, e) in solved.frequency_hz.iter().zip(&expected.frequency_hz) {
            assert!((hz / e - 1.0).abs() < 5e-3, "{width}: {hz} {e}");
        }
    }
    // The middle of an edge that one side alone has.
    let mut t_junction = needled();
    t_junction.triangles.retain(|t| {
        let p = t.map(|i| clean().points.get(i as usize).copied());
        p.iter().flatten().count() != 2 || !t.iter().all(|&i| needled().points[i as usize][2] > 0.0)
    });
    assert_eq!(t_junction.triangles.len(), 16);
    let solved = made(Mesh::Surface(t_junction), None).unwrap();
    let expected = made(Mesh::Surface(clean()), None).unwrap();
    assert!((solved.frequency_hz[0] / expected.frequency_hz[0] - 1.0).abs() < 5e-3);
}

#[test]
fn holes_that_share_a_corner_are_closed_each_for_itself() {
    let expected = made(Mesh::Surface(common::surface_of(&common::ball(0.05, 6))), None).unwrap();
    let mut mesh = common::surface_of(&common::ball(0.05, 6));
    let corner = mesh.triangles[0][0];
    let fan: Vec<usize> =
        (0..mesh.triangles.len()).filter(|&t| mesh.triangles[t].contains(&corner)).collect();
    let (first, second) = (fan[0], fan[fan.len() / 2]);
    let mut t = 0;
    mesh.triangles.retain(|_| {
        t += 1;
        t - 1 != first && t - 1 != second
    });
    // Steps that share no factor with the number of triangles, 430.
    for step in [1, 7, 11] {
        let solved = made(Mesh::Surface(shuffled(&mesh, step)), None).unwrap();
        assert!((solved.frequency_hz[0] / expected.frequency_hz[0] - 1.0).abs() < 5e-3);
        assert!((solved.volume_m3 / expected.volume_m3 - 1.0).abs() < 5e-3);
    }
}

#[test]
fn a_coarse_ball_of_curved_elements_has_the_balls_volume_and_pitch() {
    // Ten-node tetrahedra whose middle nodes lie on the ball, as a Gmsh file.
    let radius_m = 0.05;
    let coarse = common::ball(radius_m, 4);
    let mut nodes = coarse.points.clone();
    let mut elements = String::new();
    // Gmsh's order of the middle nodes.
    const GMSH: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];
    let on_ball = |p: [f64; 3]| (p.iter().map(|x| x * x).sum::<f64>().sqrt() / radius_m - 1.0).abs() < 1e-9;
    for (e, t) in coarse.tets.iter().enumerate() {
        elements.push_str(&format!("{} 11 2 0 1", e + 1));
        t.iter().for_each(|i| elements.push_str(&format!(" {}", i + 1)));
        for [a, b] in GMSH {
            let (a, b) = (coarse.points[t[a] as usize], coarse.points[t[b] as usize]);
            let mut middle: [f64; 3] = std::array::from_fn(|c| 0.5 * (a[c] + b[c]));
            if on_ball(a) && on_ball(b) {
                let long = middle.iter().map(|x| x * x).sum::<f64>().sqrt();
                middle.iter_mut().for_each(|x| *x *= radius_m / long);
            }
            let number = nodes.iter().position(|n| *n == middle).unwrap_or_else(|| {
                nodes.push(middle);
                nodes.len() - 1
            });
            elements.push_str(&format!(" {}", number + 1));
        }
        elements.push('\n');
    }
    let listed: String =
        nodes.iter().enumerate().map(|(i, p)| format!("{} {} {} {}\n", i + 1, p[0], p[1], p[2])).collect();
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{listed}$EndNodes\n$Elements\n{}\n{elements}$EndElements\n",
        nodes.len(),
        coarse.tets.len()
    );
    let mesh = asperity_shape::parse(std::path::Path::new("ball.msh"), text.as_bytes()).unwrap();
    let solved = made(mesh, None).unwrap();
    let ball_m3 = 4.0 / 3.0 * std::f64::consts::PI * radius_m.powi(3);
    let straight = coarse.volume_m3() / ball_m3;
    assert!(straight < 0.95, "{straight}");
    assert!(
        (solved.volume_m3 / ball_m3 - 1.0).abs() < 0.25 * (1.0 - straight),
        "{straight} {}",
        solved.volume_m3 / ball_m3
    );
}

#[test]
fn a_concave_sheet_is_one_plate_from_any_first_corner() {
    let corners = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.1, 0.1], [0.1, 0.2], [0.0, 0.2]];
    let points: String = corners.iter().map(|[x, y]| format!("v {x} {y} 0\n")).collect();
    for first in 0..6 {
        let face: String = (0..6).map(|i| format!(" {}", (first + i) % 6 + 1)).collect();
        let text = format!("{points}f{face}\n");
        let mesh = asperity_shape::parse(std::path::Path::new("l.obj"), text.as_bytes()).unwrap();
        let solved = made(mesh, Some(0.004)).unwrap();
        assert!((solved.volume_m3 / 1.2e-4 - 1.0).abs() < 5e-3, "{first}: {}", solved.volume_m3);
    }
}

#[test]
fn one_part_of_a_file_is_named_or_the_largest() {
    let file = |name: &str, by: f64, first: u32| {
        let mesh = joined(
            SurfaceMesh::default(),
            &common::box_surface([0.1 + by, 0.08, 0.05]),
            [3.0 * by, 0.0, 0.0],
        );
        let points: String = mesh.points.iter().map(|p| format!("v {} {} {}\n", p[0], p[1], p[2])).collect();
        let faces: String = mesh
            .triangles
            .iter()
            .map(|t| format!("f {} {} {}\n", t[0] + first, t[1] + first, t[2] + first))
            .collect();
        format!("o {name}\n{points}{faces}")
    };
    let text = file("small", 0.0, 1) + &file("large", 0.1, 9);
    let path = std::env::temp_dir().join(format!("asperity-parts-{}.obj", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let load = |part: Option<&str>| asperity_shape::load_part(&path, part);
    let message = made(load(None).unwrap(), None).unwrap_err().to_string();
    assert!(message.contains("--part"), "{message}");
    for (part, volume_m3) in [("small", 4e-4), ("large", 8e-4), ("largest", 8e-4)] {
        let solved = made(load(Some(part)).unwrap(), None).unwrap();
        assert!((solved.volume_m3 / volume_m3 - 1.0).abs() < 5e-3, "{part}");
    }
    let message = load(Some("medium")).unwrap_err().to_string();
    assert!(message.contains("small, large or largest"), "{message}");
    std::fs::remove_file(&path).unwrap();
}

/// A cube with square channels of a third of it through all three directions, and so on in the
/// cubes that are left (Menger's sponge), of `3^depth` cells a side.
fn sponge(depth: u32) -> SurfaceMesh {
    let cells = 3_u32.pow(depth);
    let solid = |cell: [u32; 3]| {
        cell.iter().all(|&c| c < cells)
            && (0..depth).all(|level| cell.iter().filter(|&&c| c / 3_u32.pow(level) % 3 == 1).count() < 2)
    };
    let mut numbers = std::collections::HashMap::new();
    let mut mesh = SurfaceMesh::default();
    let mut point = |mesh: &mut SurfaceMesh, at: [u32; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            mesh.points.push(at.map(|c| 0.1 * f64::from(c) / f64::from(cells)));
            mesh.points.len() as u32 - 1
        })
    };
    for i in 0..cells.pow(3) {
        let cell = [i % cells, i / cells % cells, i / cells / cells];
        for (axis, back) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
            let mut beside = cell;
            beside[axis] = if back { cell[axis].wrapping_sub(1) } else { cell[axis] + 1 };
            if !solid(cell) || solid(beside) {
                continue;
            }
            let corners: [u32; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                let mut at = cell;
                at[axis] += u32::from(!back);
                at[(axis + 1) % 3] += a;
                at[(axis + 2) % 3] += b;
                point(&mut mesh, at)
            });
            let [a, b, c, d] = if back { [3, 2, 1, 0].map(|k| corners[k]) } else { corners };
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Took 74 s of one processor to be refused for a surface that was not clean enough.
#[test]
fn a_sponge_of_too_many_corners_is_refused_for_its_walls() {
    let ceramic = made(Mesh::Surface(sponge(1)), None).unwrap();
    assert!((ceramic.volume_m3 / (1e-3 * 20.0 / 27.0) - 1.0).abs() < 1e-3, "{}", ceramic.volume_m3);
    let error = made(Mesh::Surface(sponge(3)), None).unwrap_err();
    assert!(error.what.contains("(3.704 mm on a body of 100 mm) are too thin"), "{error}");
}

/// Two factors of such a block take minutes, and one is held by two gigabytes.
#[test]
fn a_solid_that_would_take_minutes_is_refused_for_its_work() {
    let error = made(Mesh::Volume(common::block([0.1; 3], [17; 3])), None).unwrap_err();
    assert!(error.what.contains("too fine for a body as thick as it is"), "{error}");
}
