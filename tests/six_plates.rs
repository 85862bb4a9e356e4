//! The six plates of the Hasti study (§IV-B): every one is felt and heard over the whole range of
//! ordinary strokes, matte above shiny, and no two have the same spectrum.

mod common;

use asperity::offline::{Options, Render};
use asperity::{Extent, Surface, Wrap};
use asperity_measure::spectrum;
use asperity_texture::height_map::HeightMap;
use asperity_texture::raster::Raster;
use common::{SIDE_M, plate, render, rms, si_config, stroke};
use std::f64::consts::PI;

const PLATES: [&str; 6] = ["matte", "shiny", "ridge", "bumps", "sine", "sawtooth"];

fn relief_m(name: &str, x: f64, y: f64) -> f64 {
    let pitch = 0.007;
    match name {
        "ridge" => 0.004 * (-((x - 0.5 * SIDE_M) / 0.004).powi(2)).exp(),
        "bumps" => {
            let (u, v) = ((x / pitch).fract() - 0.5, (y / pitch).fract() - 0.5);
            let r = u.hypot(v) / 0.45;
            if r < 1.0 { 0.0005 * (1.0 + (PI * r).cos()) } else { 0.0 }
        }
        "sine" => 0.0005 * (1.0 - (2.0 * PI * x / pitch).cos()),
        "sawtooth" => 0.001 * (x / pitch).fract(),
        _ => 0.0,
    }
}

fn surface(name: &str) -> Surface {
    match name {
        "matte" => return plate(0.9),
        "shiny" => return plate(0.1),
        _ => {}
    }
    let side = 512;
    let texel = SIDE_M / side as f64;
    let raster = Raster::from_fn(side, side, |x, y| {
        relief_m(name, (x as f64 + 0.5) * texel, (y as f64 + 0.5) * texel)
    });
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = HeightMap::new(&raster, extent, Wrap::Repeat).unwrap().with_roughness(0.35).unwrap();
    Surface::new(map, SIDE_M, SIDE_M).unwrap()
}

fn stroked(name: &str, speed_m_s: f64, force_n: f64) -> Render {
    let seconds = 0.12 / speed_m_s;
    let log = stroke(SIDE_M, speed_m_s, force_n, seconds);
    render(si_config(), surface(name), &log, &Options { tail_s: 0.1, ..Options::default() })
}

fn db(x: f64) -> f64 {
    20.0 * x.max(1e-30).log10()
}

#[test]
fn every_plate_is_felt_and_heard_at_every_speed_and_force() {
    println!(
        "{:>9} {:>5} {:>4}  {:>9} {:>9} {:>7} {:>5}",
        "plate", "m/s", "N", "felt µm", "heard dB", "onsets", "crest"
    );
    for name in PLATES {
        for speed_m_s in [0.05, 0.1, 0.3] {
            for force_n in [0.3, 0.7, 2.0] {
                let take = stroked(name, speed_m_s, force_n);
                let (felt, heard) = (rms(&take.haptic[0]), rms(&take.audio[0]));
                let crest = common::peak(&take.audio[0]) / heard;
                println!(
                    "{name:>9} {speed_m_s:>5} {force_n:>4}  {:>9.4} {:>9.1} {:>7} {crest:>5.1}",
                    felt * 1e6,
                    db(heard),
                    take.stats.micro_collisions
                );
                // The detection threshold of a fingertip is about 0.1 µm near 250 Hz.
                assert!(felt > 1e-8, "{name} at {speed_m_s} m/s, {force_n} N is not felt: {felt} m");
                assert!(heard > 1e-6, "{name} at {speed_m_s} m/s, {force_n} N is silent: {heard}");
            }
        }
    }
}

#[test]
fn matte_is_felt_and_heard_above_shiny() {
    for speed_m_s in [0.05, 0.1, 0.3] {
        let (matte, shiny) = (stroked("matte", speed_m_s, 0.7), stroked("shiny", speed_m_s, 0.7));
        let above = |m: &[f32], s: &[f32]| {
            let rate = matte.sample_rate_hz;
            let (m, s) = (spectrum::third_octaves_db(m, rate), spectrum::third_octaves_db(s, rate));
            // 200 Hz and up: where the skin is most sensitive and the ear begins.
            m[9..].iter().zip(&s[9..]).map(|(m, s)| m - s).sum::<f64>() / 18.0
        };
        let (felt, heard) =
            (above(&matte.haptic[0], &shiny.haptic[0]), above(&matte.audio[0], &shiny.audio[0]));
        println!("{speed_m_s} m/s: felt {felt:.1} dB, heard {heard:.1} dB");
        assert!(felt > 3.0 && heard > 3.0, "{speed_m_s} m/s: felt {felt} dB, heard {heard} dB");
    }
}

#[test]
fn no_two_plates_have_the_same_spectrum() {
    for speed_m_s in [0.05, 0.15, 0.3] {
        let takes = PLATES.map(|name| stroked(name, speed_m_s, 0.7));
        let spectra = takes.map(|take| spectrum::third_octaves_db(&take.haptic[0], take.sample_rate_hz));
        for (i, a) in spectra.iter().enumerate() {
            for (j, b) in spectra.iter().enumerate().skip(i + 1) {
                let widest = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(widest >= 3.0, "{} and {} at {speed_m_s} m/s: {widest} dB", PLATES[i], PLATES[j]);
            }
        }
    }
}
