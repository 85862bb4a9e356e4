//! What a tool and a finger feel and hear, beside published measurements of real materials.
//!
//! The figures are of the Penn Haptic Texture Toolkit (Culbertson, Lopez Delgado, Kuchenbecker
//! 2014), of one half of its 100 materials: a steel-tipped tool stroked by hand, acceleration, 1
//! kHz. Nothing here was tuned on these surfaces one by one; medians are held, as one surface
//! scatters by 3 dB.

use crate::common;

use asperity::{Quantity, Surface};
use asperity_evidence::abrasive::{FRICTION_DB, MEASURED_M_S2, SIDE_M as ABRASIVE_M, abrasive};
use common::plate;
use common::strokes::{
    brownian, exponents, map, power, relief, rms_and_centroid, take, take_over, third_octaves_db,
};

const SPEEDS_M_S: [f64; 3] = [0.04, 0.12, 0.24];
const FORCES_N: [f64; 3] = [0.3, 1.5, 5.0];
/// The cell at which levels and spectra are told: 120 mm/s, 1.5 N.
const REFERENCE: (usize, usize) = (1, 1);
/// Median level of the third octaves from 20 to 400 Hz, dB re their sum.
const SHAPE_DB: [f64; 14] =
    [-15.5, -14.1, -13.4, -12.3, -11.4, -10.8, -10.1, -10.0, -9.5, -9.5, -10.0, -12.6, -16.2, -22.9];

/// What one surface gave.
#[derive(Debug, Clone, Copy)]
struct Row {
    speed_exponent: f64,
    force_exponent: f64,
    centroid_hz: f64,
    centroid_speed_exponent: f64,
    level: f64,
    shape_error_db: f64,
}

fn row(probe: &str, make: &dyn Fn() -> Surface) -> Row {
    let spectra: Vec<Vec<_>> = SPEEDS_M_S
        .iter()
        .map(|speed| {
            let at = |force: &f64| {
                let take = take(probe, make(), *speed, *force, Quantity::Acceleration);
                power(&take.haptic[0], take.sample_rate_hz)
            };
            FORCES_N.iter().map(at).collect()
        })
        .collect();
    let of = |pick: &dyn Fn((f64, f64)) -> f64| -> Vec<Vec<f64>> {
        let cells = |row: &Vec<_>| row.iter().map(|s| pick(rms_and_centroid(s, 10.0, 500.0))).collect();
        spectra.iter().map(cells).collect()
    };
    let (levels, centroids) = (of(&|(rms, _)| rms), of(&|(_, centroid)| centroid));
    let (speed_exponent, force_exponent) = exponents(&levels, &SPEEDS_M_S, &FORCES_N);
    let (centroid_speed_exponent, _) = exponents(&centroids, &SPEEDS_M_S, &FORCES_N);
    let (i, j) = REFERENCE;
    let thirds = third_octaves_db(&spectra[i][j], 20.0, 14);
    let relative = |x: &[f64]| -> Vec<f64> {
        let sum = 10.0 * x.iter().map(|x| 10f64.powf(x / 10.0)).sum::<f64>().log10();
        x.iter().map(|x| x - sum).collect()
    };
    let apart = relative(&thirds).iter().zip(relative(&SHAPE_DB)).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    Row {
        speed_exponent,
        force_exponent,
        centroid_hz: centroids[i][j],
        centroid_speed_exponent,
        level: levels[i][j],
        shape_error_db: (apart / SHAPE_DB.len() as f64).sqrt(),
    }
}

fn median(rows: &[Row], of: impl Fn(&Row) -> f64) -> f64 {
    let mut values: Vec<f64> = rows.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn a_stylus_is_shaken_as_measured_tools_are() {
    let mut surfaces: Vec<(String, Box<dyn Fn() -> Surface>)> = Vec::new();
    for r in [0.1, 0.3, 0.5, 0.7, 0.9] {
        surfaces.push((format!("R {r}"), Box::new(move || plate(r))));
    }
    for hurst in [0.3, 0.5, 0.7, 0.9] {
        for rms_m in [2e-5, 1e-4] {
            let (name, raster) = (format!("H {hurst}, {:.0} µm", rms_m * 1e6), brownian(hurst));
            surfaces.push((name, Box::new(move || relief(&raster, rms_m))));
        }
    }
    for name in [
        "Ground048_1K-PNG_Displacement.png",
        "Rock003_1K-PNG_Displacement.png",
        "Metal056B_1K-JPG_Displacement.jpg",
    ] {
        if map(name, 1e-3).is_some() {
            surfaces.push((name[..9].to_owned(), Box::new(move || map(name, 1e-3).unwrap())));
        }
    }
    let mut rows = Vec::new();
    for (name, make) in &surfaces {
        let row = row("stylus", make);
        println!(
            "{name:>14}: v^{:.2} F^{:.2} centroid {:.0} Hz v^{:.2}, {:.2} m/s², shape {:.1} dB",
            row.speed_exponent,
            row.force_exponent,
            row.centroid_hz,
            row.centroid_speed_exponent,
            row.level,
            row.shape_error_db
        );
        rows.push(row);
    }
    let speed = median(&rows, |row| row.speed_exponent);
    let force = median(&rows, |row| row.force_exponent);
    let centroid = median(&rows, |row| row.centroid_hz);
    let rise = median(&rows, |row| row.centroid_speed_exponent);
    let level = median(&rows, |row| row.level);
    let shape = median(&rows, |row| row.shape_error_db);
    println!(
        "median: v^{speed:.2} F^{force:.2} centroid {centroid:.0} Hz v^{rise:.2}, {level:.2} m/s², shape {shape:.1} dB"
    );
    assert!((0.75..1.15).contains(&speed) && (0.05..0.35).contains(&force), "v^{speed} F^{force}");
    assert!(rows.iter().all(|row| (0.2..1.5).contains(&row.speed_exponent)));
    let inside = rows.iter().filter(|row| (70.0..190.0).contains(&row.centroid_hz)).count();
    assert!(5 * inside >= 4 * rows.len(), "{inside} of {} centroids", rows.len());
    assert!(
        (0.1..0.4).contains(&rise) && (0.5..2.0).contains(&level) && shape < 3.5,
        "v^{rise}, {level} m/s², {shape} dB"
    );
}

#[test]
fn coarser_abrasives_shake_a_stylus_more() {
    // FEPA P60, then grit 100, 220 and 320 of the measurement, which gives the last three.
    let grains_m = [269e-6, 141e-6, 66e-6, 36e-6];
    let levels = grains_m.map(|grain_m| {
        let cell = (SPEEDS_M_S[REFERENCE.0], FORCES_N[REFERENCE.1]);
        let take = take_over(ABRASIVE_M, "stylus", abrasive(grain_m).unwrap(), cell, Quantity::Acceleration);
        let (level, centroid_hz) =
            rms_and_centroid(&power(&take.haptic[0], take.sample_rate_hz), 10.0, 500.0);
        println!("grains of {:.0} µm: {level:.2} m/s², {centroid_hz:.0} Hz", grain_m * 1e6);
        level
    });
    assert!(levels.windows(2).all(|pair| pair[0] > pair[1]), "{levels:?}");
    for (level, measured_m_s2) in levels[1..].iter().zip(MEASURED_M_S2) {
        let off_db = 20.0 * (level / measured_m_s2).log10() + FRICTION_DB;
        println!("{off_db:+.1} dB of {measured_m_s2} m/s²");
        assert!((-9.0..8.0).contains(&off_db), "{off_db} dB of {measured_m_s2} m/s²");
    }
}
