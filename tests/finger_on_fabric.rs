//! What a fingertip is shaken by on fabric-like ground, beside measured fingers.
//!
//! Measured: bare fingers on four fabrics, acceleration; v^0.70–0.90, third octaves that rise by
//! 6–22 dB from 25 Hz to 1 kHz (one person, uncalibrated); skin vibration grows with force. The map
//! and two Brownian grounds were looked at when the skin was made; the weaves were not.

use crate::common;

use asperity::{Quantity, Surface};
use asperity_surface::raster::Raster;
use common::strokes::{brownian, exponents, map, power, relief, rms_and_centroid, take, third_octaves_db};
use std::f64::consts::TAU;

const SPEEDS_M_S: [f64; 3] = [0.05, 0.1, 0.2];
const FORCES_N: [f64; 3] = [0.3, 1.0, 3.0];

/// Plain weave: threads of `pitch_m` over and under each other, 1 m high, on 0.14 m.
fn weave(pitch_m: f64) -> Raster {
    const SIDE: usize = 1024;
    let turns = (0.14 / (2.0 * pitch_m)).round();
    let phase = move |x: usize| TAU * turns * (x as f64 + 0.5) / SIDE as f64;
    Raster::from_fn(SIDE, SIDE, |x, y| {
        let (warp, weft) = (phase(x).sin() * phase(y).cos().abs(), phase(y).sin() * phase(x).cos().abs());
        0.5 * warp.max(weft)
    })
}

#[test]
fn a_fingertip_is_shaken_by_fabric_as_measured_fingers_are() {
    let mut ground: Vec<(String, Box<dyn Fn() -> Surface>)> = Vec::new();
    for pitch_m in [0.6e-3, 1.2e-3] {
        let raster = weave(pitch_m);
        let name = format!("weave of {:.1} mm", pitch_m * 1e3);
        ground.push((name, Box::new(move || relief(&raster, 0.2e-3))));
    }
    for hurst in [0.4, 0.6, 0.8] {
        let raster = brownian(hurst);
        ground.push((format!("felt, H {hurst}"), Box::new(move || relief(&raster, 6e-5))));
    }
    let fabric = "Fabric061_1K-PNG_Displacement.png";
    if map(fabric, 3e-4).is_some() {
        for relief_m in [1.5e-4, 3e-4] {
            let name = format!("map, {:.2} mm", relief_m * 1e3);
            ground.push((name, Box::new(move || map(fabric, relief_m).unwrap())));
        }
    }
    let mut rows: Vec<[f64; 3]> = Vec::new();
    for (name, make) in &ground {
        let spectra = SPEEDS_M_S.map(|speed_m_s| {
            FORCES_N.map(|force_n| {
                let take = take("fingertip", make(), speed_m_s, force_n, Quantity::Acceleration);
                power(&take.haptic[0], take.sample_rate_hz)
            })
        });
        let at = |pick: fn((f64, f64)) -> f64| -> Vec<Vec<f64>> {
            let cell = |spectrum| pick(rms_and_centroid(spectrum, 10.0, 1000.0));
            spectra.iter().map(|row| row.iter().map(cell).collect()).collect()
        };
        let (levels, centroids) = (at(|(rms, _)| rms), at(|(_, centroid)| centroid));
        let (speed, force) = exponents(&levels, &SPEEDS_M_S, &FORCES_N);
        let (centroid_speed, _) = exponents(&centroids, &SPEEDS_M_S, &FORCES_N);
        let thirds = third_octaves_db(&spectra[1][1], 25.0, 17);
        let rise = thirds[16] - thirds[0];
        println!(
            "{name:>15}: v^{speed:.2} F^{force:.2}, {:.0} Hz v^{centroid_speed:.2}, {:.2} m/s², rises {rise:.0} dB",
            centroids[1][1], levels[1][1]
        );
        rows.push([speed, force, rise]);
    }
    let median = |of: usize| {
        let mut values: Vec<f64> = rows.iter().map(|row| row[of]).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let [speed, force, rise] = [0, 1, 2].map(median);
    println!("median: v^{speed:.2} F^{force:.2}, rises {rise:.0} dB");
    assert!((0.6..=1.1).contains(&speed) && force > 0.05, "v^{speed} F^{force}");
    assert!((5.0..=25.0).contains(&rise), "{rise} dB");
    assert!(rows.iter().all(|row| row[1] > 0.0), "a force exponent below 0");
}
