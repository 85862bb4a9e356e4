//! Unwrapping: developable surfaces come out flat, curved ones at the least of functionals that are
//! written down here once more, and what has no rim is refused.

use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::unwrap::{Method, PHI, Unwrapped, unwrap};
use std::collections::BTreeSet;

type Vec3 = [f64; 3];

/// A square of n × n cells, u and v from −1 to 1, put into space.
fn sheet(n: usize, place: impl Fn(f64, f64) -> Vec3) -> SurfaceMesh {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let points = (0..(n + 1) * (n + 1)).map(|k| place(at(k % (n + 1)), at(k / (n + 1)))).collect();
    let mut triangles = Vec::new();
    for (x, y) in (0..n).flat_map(|y| (0..n).map(move |x| (x, y))) {
        let corner = |dx: usize, dy: usize| ((y + dy) * (n + 1) + x + dx) as u32;
        triangles.push([corner(0, 0), corner(1, 0), corner(1, 1)]);
        triangles.push([corner(0, 0), corner(1, 1), corner(0, 1)]);
    }
    SurfaceMesh { points, triangles }
}

fn cylinder(u: f64, v: f64) -> Vec3 {
    [0.05 * (1.2 * u).sin(), 0.06 * v, 0.05 * (1.2 * u).cos()]
}

fn saddle(u: f64, v: f64) -> Vec3 {
    [0.1 * u, 0.1 * v, 0.04 * (u * u - v * v)]
}

/// Half of a sphere of 5 cm: the square's rings become circles.
fn half_sphere(u: f64, v: f64) -> Vec3 {
    let (ring, angle) = (u.abs().max(v.abs()), v.atan2(u));
    let tilt = 0.5 * std::f64::consts::PI * ring;
    [0.05 * tilt.sin() * angle.cos(), 0.05 * tilt.sin() * angle.sin(), 0.05 * tilt.cos()]
}

fn edges(mesh: &SurfaceMesh) -> BTreeSet<[usize; 2]> {
    let each = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    each.map(|[a, b]| [a.min(b) as usize, a.max(b) as usize]).collect()
}

fn energy(mesh: &SurfaceMesh, uv: &[[f64; 2]], phi: f64) -> f64 {
    let mut sum = 0.0;
    for [a, b] in edges(mesh) {
        let flat: f64 = (0..2).map(|k| (uv[a][k] - uv[b][k]).powi(2)).sum();
        let real: f64 = (0..3).map(|k| (mesh.points[a][k] - mesh.points[b][k]).powi(2)).sum();
        sum += phi * (flat - real).powi(2) / real;
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| i as usize);
        let side = |to: usize| -> Vec3 { [0, 1, 2].map(|k| mesh.points[to][k] - mesh.points[a][k]) };
        let ([p, q, r], [x, y, z]) = (side(b), side(c));
        let real = ((q * z - r * y).powi(2) + (r * x - p * z).powi(2) + (p * y - q * x).powi(2)).sqrt();
        let flat =
            (uv[b][0] - uv[a][0]) * (uv[c][1] - uv[a][1]) - (uv[b][1] - uv[a][1]) * (uv[c][0] - uv[a][0]);
        sum += (1.0 - phi) * (flat - real).powi(2) / real;
    }
    sum
}

fn roughness(mesh: &SurfaceMesh, uv: &[[f64; 2]]) -> f64 {
    let mut sums = vec![[0.0; 2]; uv.len()];
    for [a, b] in edges(mesh) {
        for k in 0..2 {
            sums[a][k] += uv[b][k] - uv[a][k];
            sums[b][k] += uv[a][k] - uv[b][k];
        }
    }
    sums.iter().flatten().map(|sum| sum * sum).sum()
}

/// Checks that no small move of single vertices, or of all, comes lower than by a millionth.
fn is_least(made: &Unwrapped, free: impl Fn(usize) -> bool, value: impl Fn(&[[f64; 2]]) -> f64) {
    let least = value(&made.uv);
    assert!((made.energy - least).abs() < 1e-9 * least + 1e-15, "{} told, {least} found", made.energy);
    let mut rng = asperity_dsp::rng::Rng::new(4);
    for trial in 0..60 {
        let mut moved = made.uv.clone();
        for (i, uv) in moved.iter_mut().enumerate().filter(|(i, _)| free(*i)) {
            let step = if trial % 3 == 0 || i % 59 == trial % 59 { 2e-5 } else { 0.0 };
            uv.iter_mut().for_each(|x| *x += step * (rng.uniform() - 0.5));
        }
        assert!(value(&moved) > least * (1.0 - 1e-6), "{} comes lower: {}", made.method, value(&moved));
    }
}

#[test]
fn a_sheet_that_can_be_laid_flat_is_laid_flat() {
    let mesh = sheet(24, cylinder);
    let made = unwrap(&mesh, Method::Energy(PHI)).unwrap();
    let area: f64 = mesh.area_m2();
    assert!(made.energy < 1e-9 * area && made.flipped == 0, "{made:?}");
    let spread = made.area_distortion;
    assert!((spread.scale - 1.0).abs() < 1e-4 && spread.deviation < 1e-3, "{spread:?}");
    let size = [0, 1].map(|axis| made.uv.iter().fold(0.0_f64, |most, uv| most.max(uv[axis])));
    assert!(size[0].hypot(size[1]) > 0.1, "metres: {size:?}");
}

#[test]
fn curved_sheets_reach_the_least_energy_without_flips() {
    for (name, mesh) in [("saddle", sheet(20, saddle)), ("half sphere", sheet(16, half_sphere))] {
        let made = unwrap(&mesh, Method::Energy(PHI)).unwrap();
        println!("{name}: {:?}", (made.energy, made.flipped, made.area_distortion));
        assert_eq!((made.flipped, made.phi, made.method), (0, Some(PHI), "energy"), "{name}");
        is_least(&made, |_| true, |uv| energy(&mesh, uv, PHI));
        let n = (mesh.points.len() as f64).sqrt() as usize;
        let inside = |i: usize| !i.is_multiple_of(n) && i % n != n - 1 && i / n != 0 && i / n != n - 1;
        let made = unwrap(&mesh, Method::Smooth).unwrap();
        println!("{name}: {:?}", (made.energy, made.flipped, made.area_distortion));
        assert_eq!((made.phi, made.method), (None, "smooth"), "{name}");
        is_least(&made, inside, |uv| roughness(&mesh, uv));
        // The rim lies on a circle as long as it.
        let middle = [0, 1].map(|k| 0.5 * made.uv.iter().fold(0.0_f64, |most, uv| most.max(uv[k])));
        let radius = |i: usize| (made.uv[i][0] - middle[0]).hypot(made.uv[i][1] - middle[1]);
        let rim: Vec<f64> = (0..n * n).filter(|i| !inside(*i)).map(radius).collect();
        assert!(rim.iter().all(|r| (r / rim[0] - 1.0).abs() < 0.01), "{name}");
    }
}

#[test]
fn the_teeth_of_a_flat_comb_are_not_left_squeezed() {
    const CELLS: usize = 40;
    let whole = sheet(CELLS, |u, v| [0.1 * u, 0.1 * v, 0.0]);
    let teeth = |cell: usize| cell / CELLS < 6 || cell % CELLS % 8 < 5;
    let kept = whole.triangles.iter().enumerate().filter(|(i, _)| teeth(i / 2)).map(|(_, t)| *t);
    let mut mesh = SurfaceMesh { points: Vec::new(), triangles: kept.collect() };
    let used: BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
    let number = |old: &u32| used.range(..old).count() as u32;
    mesh.triangles.iter_mut().for_each(|t| *t = t.each_ref().map(number));
    mesh.points = used.iter().map(|old| whole.points[*old as usize]).collect();
    let made = unwrap(&mesh, Method::Energy(PHI)).unwrap();
    println!("{:?}", (made.energy, made.flipped, made.area_distortion));
    assert!(made.energy < 1e-2 * mesh.area_m2() && made.flipped == 0, "{} m²", made.energy);
}

#[test]
fn lengths_alone_turn_triangles_over_where_areas_do_not() {
    let bump = |u: f64, v: f64| [0.1 * u, 0.1 * v, 0.12 * (-(u * u + v * v) / 0.08).exp()];
    let mesh = sheet(20, bump);
    let flipped = |phi| unwrap(&mesh, Method::Energy(phi)).unwrap().flipped;
    let (mixed, lengths) = (flipped(PHI), flipped(1.0));
    println!("{mixed} with areas, {lengths} without");
    assert!(mixed <= lengths);
}

#[test]
fn what_has_no_rim_or_two_is_refused_with_its_reason() {
    let n = 8;
    let ring = |k: usize| {
        let (i, j) = (k % n, k / n);
        let turn = std::f64::consts::TAU * i as f64 / n as f64;
        [turn.cos(), turn.sin(), j as f64]
    };
    let mut tube = SurfaceMesh { points: (0..2 * n).map(ring).collect(), triangles: Vec::new() };
    for i in 0..n {
        let [a, b, c, d] = [i, (i + 1) % n, n + (i + 1) % n, n + i].map(|i| i as u32);
        tube.triangles.extend([[a, b, c], [a, c, d]]);
    }
    let mut closed = SurfaceMesh {
        points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    };
    let why = |mesh: &SurfaceMesh| unwrap(mesh, Method::Smooth).unwrap_err().to_string();
    assert!(why(&tube).contains("is a tube") && why(&tube).contains("cut it open"), "{}", why(&tube));
    assert!(why(&closed).contains("is closed"), "{}", why(&closed));
    closed.triangles.pop();
    assert_eq!(unwrap(&closed, Method::Energy(PHI)).unwrap().flipped, 0);
    closed.points.extend([[5.0; 3], [6.0, 5.0, 5.0], [5.0, 6.0, 5.0]]);
    closed.triangles.push([4, 5, 6]);
    assert!(why(&closed).contains("2 pieces"), "{}", why(&closed));
    closed.triangles.push([0, 1, 4]);
    closed.triangles.push([0, 1, 5]);
    assert!(why(&closed).contains("meet at the edge"), "{}", why(&closed));
}
