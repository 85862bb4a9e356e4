//! The thesis' four force renderings of Brownian relief through the scene file and `--force`: the
//! rougher the relief, the larger the force, at any sample rate.

use crate::support;

use std::fs;
use support::Scene;
use support::oracle::{scene_of, straight};

/// The forces of `out.force.csv`, one row a millisecond, from its third column on.
fn forces(scene: &Scene, source: &str, rate: &str) -> Vec<[f64; 3]> {
    scene.write("scene.toml", scene_of(source));
    scene.report(&["--force", "--rate", rate]);
    let text = fs::read_to_string(scene.path("out.force.csv")).unwrap();
    // Half a second; the finger lands at rest at its beginning.
    text.lines()
        .skip(101)
        .take(500)
        .map(|line| {
            let cells: Vec<f64> = line.split(',').skip(2).map(|cell| cell.parse().unwrap()).collect();
            [cells[0], cells[1], cells[2]]
        })
        .collect()
}

/// Rms of what a rendering adds to contact and friction, N.
fn added_rms_n(with: &[[f64; 3]], without: &[[f64; 3]]) -> f64 {
    assert_eq!((with.len(), without.len()), (500, 500));
    let square = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>();
    (with.iter().zip(without).map(square).sum::<f64>() / 500.0).sqrt()
}

#[test]
fn each_of_four_forces_falls_strictly_as_h_grows() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", straight());
    let mut last = [[f64::INFINITY; 4]; 2];
    for hurst in ["0.1", "0.3", "0.5", "0.7", "0.9"] {
        let mut now = [[0.0; 4]; 2];
        for (rms_n, rate) in now.iter_mut().zip(["44100", "192000"]) {
            for (k, graph) in [", cells = 256", ", cells = 256, graph = true"].into_iter().enumerate() {
                let source =
                    |force: &str| format!("brownian = {{ hurst = {hurst}, rms_m = 2e-5{graph}{force} }}");
                let without = forces(&scene, &source(""), rate);
                for (j, force) in ["orthogonal", "lateral"].into_iter().enumerate() {
                    let with = forces(&scene, &source(&format!(", force = \"{force}\"")), rate);
                    rms_n[2 * k + j] = added_rms_n(&with, &without);
                }
            }
        }
        println!("H = {hurst}: surface and graph, orthogonal and lateral: {now:.4?} N");
        for (now, last) in now.iter().zip(&last) {
            assert!(now.iter().zip(last).all(|(now, last)| now < last && *now > 1e-3), "{now:?} {last:?}");
        }
        for (slow, fast) in now[0].iter().zip(&now[1]) {
            assert!((slow / fast - 1.0).abs() < 0.05, "{slow} N at 44.1 kHz, {fast} N at 192 kHz");
        }
        last = now;
    }
}
