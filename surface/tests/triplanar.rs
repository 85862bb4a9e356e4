//! Bodies without uv: blends of three planes, and a path without jumps.

use asperity_dsp::rng::Rng;
use asperity_surface::triplanar::{TriplanarPath, planes};

const SIZE_M: [f64; 2] = [0.1, 0.08];

/// A round body: position, velocity and normal of a point that runs over it in a tilted spiral.
fn round(t: f64) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let place = |t: f64| {
        let (a, b) = (7.0 * t, 1.3 * t);
        [0.2 * a.cos() * b.cos(), 0.2 * a.cos() * b.sin(), 0.2 * a.sin()]
    };
    let (before, here, after) = (place(t - 1e-5), place(t), place(t + 1e-5));
    (here, [0, 1, 2].map(|k| (after[k] - before[k]) / 2e-5), here)
}

#[test]
fn a_path_over_every_side_of_a_body_never_jumps() {
    let mut path = TriplanarPath::new(SIZE_M).unwrap();
    let (mut last, mut seen) = (None, [false; 3]);
    let step = 1e-3;
    for i in 0..4000 {
        let (position, velocity, normal) = round(f64::from(i) * step);
        let here = path.at(position, velocity, normal);
        seen[path.plane().unwrap()] = true;
        if let Some(before) = last {
            let before: [f64; 2] = before;
            let moved = (0..2).map(|k| ((here.uv[k] - before[k]) * SIZE_M[k]).powi(2)).sum::<f64>().sqrt();
            let speed = velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
            // A plane sees a path shortened, and no more than a step of it.
            assert!(moved <= 1.02 * speed * step + 1e-6, "{i}: {moved} m in a step of {} m", speed * step);
        }
        last = Some(here.uv);
    }
    assert_eq!(seen, [true; 3]);
}

#[test]
fn the_velocity_is_that_of_the_uv() {
    let mut path = TriplanarPath::new(SIZE_M).unwrap();
    let step = 1e-5;
    for i in 0..200_000 {
        let (position, velocity, normal) = round(f64::from(i) * step);
        let plane = path.plane();
        let before = path.clone().at(position, velocity, normal);
        path.at(position, velocity, normal);
        let (position, velocity, normal) = round(f64::from(i + 1) * step);
        let after = path.clone().at(position, velocity, normal);
        if i % 997 == 0 && plane == path.plane() {
            for (k, size_m) in SIZE_M.into_iter().enumerate() {
                let measured = (after.uv[k] - before.uv[k]) * size_m / step;
                assert!((measured - before.velocity_m_s[k]).abs() < 1e-2, "{i}: {measured} {before:?}");
            }
        }
    }
}

#[test]
fn a_trembling_normal_at_the_diagonal_keeps_its_plane() {
    let mut path = TriplanarPath::new(SIZE_M).unwrap();
    let mut rng = Rng::new(3);
    let mut changes = 0;
    path.at([0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]);
    for _ in 0..1000 {
        let before = path.plane();
        let tremble = [1.0 + 0.05 * rng.normal().clamp(-1.5, 1.5), 1.0, 0.0];
        path.at([0.1, 0.2, 0.3], [0.0; 3], tremble);
        changes += u32::from(path.plane() != before);
    }
    assert_eq!(changes, 0);
    path.at([0.1, 0.2, 0.3], [0.0; 3], [1.0, 1.3, 0.0]);
    assert_eq!(path.plane(), Some(1));
}

#[test]
fn blends_add_up_and_fade_without_a_step() {
    let mut rng = Rng::new(8);
    let weights = |normal: [f64; 3]| planes([0.0; 3], normal, SIZE_M).map(|plane| plane.weight);
    for _ in 0..2000 {
        let normal = [rng.normal(), rng.normal(), rng.normal()];
        let here = weights(normal);
        assert!(
            (here.iter().sum::<f64>() - 1.0).abs() < 1e-12 && here.iter().all(|w| (0.0..=1.0).contains(w))
        );
        let turned = weights([-normal[0], normal[1] + 1e-6, -normal[2]]);
        assert!((0..3).all(|k| (here[k] - turned[k]).abs() < 1e-4), "{normal:?}: {here:?} {turned:?}");
    }
    let corner = weights([2.0, -2.0, 2.0]);
    assert!(corner.iter().all(|w| (w - 1.0 / 3.0).abs() < 1e-12));
    assert_eq!(weights([0.0; 3]), [1.0 / 3.0; 3]);
}

#[test]
fn bad_normals_leave_the_plane_and_bad_sizes_are_refused() {
    let mut path = TriplanarPath::new(SIZE_M).unwrap();
    path.at([0.0; 3], [0.0; 3], [0.0, 1.0, 0.0]);
    path.at([0.0; 3], [0.0; 3], [f64::NAN, f64::NAN, f64::NAN]);
    path.at([0.0; 3], [0.0; 3], [0.0; 3]);
    assert_eq!(path.plane(), Some(1));
    assert_eq!(TriplanarPath::new([0.1, 0.0]).unwrap_err().field, "height_m");
    assert_eq!(TriplanarPath::new([f64::NAN, 0.1]).unwrap_err().field, "width_m");
}
