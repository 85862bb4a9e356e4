//! What a tool and a finger feel and hear, beside published measurements of real materials.
//!
//! The figures are of the Penn Haptic Texture Toolkit (Culbertson, Lopez Delgado, Kuchenbecker 2014), of one half of its 100 materials: a
//! steel-tipped tool stroked by hand, acceleration, 1 kHz. Nothing here was tuned on these surfaces one by one; medians are held, as one
//! surface scatters by 3 dB.

mod common;

use asperity::offline::{Options, Render};
use asperity::{ActuatorSettings, Config, Quantity, Surface, Wrap, probe_by_name};
use asperity_measure::corpus::corpus;
use asperity_measure::exact_brownian::ExactBrownian;
use asperity_measure::spectrum;
use asperity_texture::height_map::{Extent, HeightMap};
use asperity_texture::image_io::{self, Channel};
use asperity_texture::raster::Raster;
use common::{SIDE_M, plate, render, stroke};

const SPEEDS_M_S: [f64; 5] = [0.04, 0.08, 0.12, 0.16, 0.24];
const FORCES_N: [f64; 4] = [0.3, 1.0, 1.5, 5.0];
/// The cell at which levels and spectra are told: 120 mm/s, 1.5 N.
const REFERENCE: (usize, usize) = (2, 2);
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

fn map(name: &str, relief_m: f64) -> Option<Surface> {
    let file = corpus(&format!("textures/{name}"))?;
    let raster = image_io::load_channel(file, Channel::Luma).unwrap().debanded(Wrap::Repeat);
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m };
    Some(Surface::new(HeightMap::new(&raster, extent, Wrap::Repeat).unwrap(), SIDE_M, SIDE_M).unwrap())
}

fn take(probe: &str, surface: Surface, speed_m_s: f64, force_n: f64, output: Quantity) -> Render {
    let actuators = vec![ActuatorSettings { full_scale: 1.0, output, ..ActuatorSettings::default() }];
    let config = Config { probe: probe_by_name(probe).unwrap(), actuators, ..Config::default() };
    let log = stroke(SIDE_M, speed_m_s, force_n, 1.0);
    render(config, surface, &log, &Options { tail_s: 0.0, ..Options::default() })
}

/// Power spectrum after the first 0.2 s: from Hz to power a bin.
fn power(x: &[f32], rate_hz: f64) -> (Vec<f64>, f64) {
    const LENGTH: usize = 8192;
    let from = (0.2 * rate_hz) as usize;
    (spectrum::power_spectrum(&x[from..], LENGTH), rate_hz / LENGTH as f64)
}

/// Rms and centroid between two frequencies.
fn rms_and_centroid((power, bin_hz): &(Vec<f64>, f64), from_hz: f64, to_hz: f64) -> (f64, f64) {
    let inside = || power.iter().enumerate().map(|(i, p)| (i as f64 * bin_hz, p));
    let inside = || inside().filter(|(f, _)| (from_hz..=to_hz).contains(f));
    let sum: f64 = inside().map(|(_, p)| p).sum();
    (sum.sqrt(), inside().map(|(f, p)| f * p).sum::<f64>() / sum)
}

fn third_octaves_db((power, bin_hz): &(Vec<f64>, f64), from_hz: f64, count: i32) -> Vec<f64> {
    (0..count)
        .map(|band| {
            let centre_hz = from_hz * 2f64.powf(f64::from(band) / 3.0);
            let edges = [-1.0, 1.0].map(|side: f64| centre_hz * 2f64.powf(side / 6.0));
            let inside = |i: &usize| (edges[0]..edges[1]).contains(&(*i as f64 * bin_hz));
            10.0 * (0..power.len()).filter(inside).map(|i| power[i]).sum::<f64>().max(1e-30).log10()
        })
        .collect()
}

/// Exponents a, b of y ∝ v^a F^b over a whole grid, by least squares.
fn exponents(y: &[Vec<f64>], speeds: &[f64], forces: &[f64]) -> (f64, f64) {
    let mean = |x: &[f64]| x.iter().map(|x| x.ln()).sum::<f64>() / x.len() as f64;
    let (v0, f0) = (mean(speeds), mean(forces));
    let (mut vy, mut vv, mut fy, mut ff) = (0.0, 0.0, 0.0, 0.0);
    for (row, v) in y.iter().zip(speeds) {
        for (y, f) in row.iter().zip(forces) {
            let (v, f, y) = (v.ln() - v0, f.ln() - f0, y.ln());
            (vy, vv, fy, ff) = (vy + v * y, vv + v * v, fy + f * y, ff + f * f);
        }
    }
    (vy / vv, fy / ff)
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

/// Heights of a Brownian surface of 1 m rms.
fn brownian(hurst: f64) -> Raster {
    const SIDE: usize = 512;
    let [values, _] = ExactBrownian::new(SIDE, hurst).pair(7);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let rms = (values.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
    Raster { width: SIDE, height: SIDE, values: values.iter().map(|h| (h - mean) / rms).collect() }
}

fn relief(raster: &Raster, relief_m: f64) -> Surface {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m };
    Surface::new(HeightMap::new(raster, extent, Wrap::Mirror).unwrap(), SIDE_M, SIDE_M).unwrap()
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
}
