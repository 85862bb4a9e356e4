//! What is heard of a stroke grows with speed and with force, over the grid on which tools are
//! measured, but for a decibel of chance.

use crate::common;

use asperity::{Quantity, Surface};
use common::strokes::{brownian, exponents, map, relief, take};
use common::{plate, rms};

const SPEEDS_M_S: [f64; 3] = [0.04, 0.12, 0.24];
const FORCES_N: [f64; 3] = [0.3, 1.5, 5.0];

#[test]
fn strokes_are_heard_more_the_faster_and_the_harder_they_are() {
    let mut surfaces: Vec<(String, Box<dyn Fn() -> Surface>)> = Vec::new();
    for r in [0.3, 0.5, 0.9] {
        surfaces.push((format!("R {r}"), Box::new(move || plate(r))));
    }
    for hurst in [0.4, 0.8] {
        let raster = brownian(hurst);
        surfaces.push((format!("H {hurst}"), Box::new(move || relief(&raster, 1e-4))));
    }
    for name in ["Ground048_1K-PNG_Displacement.png", "Rock003_1K-PNG_Displacement.png"] {
        if map(name, 1e-3).is_some() {
            surfaces.push((name[..9].to_owned(), Box::new(move || map(name, 1e-3).unwrap())));
        }
    }
    let (mut steps, mut falls) = (0, Vec::new());
    for probe in ["fingertip", "stylus"] {
        for (name, make) in &surfaces {
            let level = |speed: &f64, force: &f64| {
                rms(&take(probe, make(), *speed, *force, Quantity::Displacement).audio[0][8820..])
            };
            let levels: Vec<Vec<f64>> = SPEEDS_M_S
                .iter()
                .map(|speed| FORCES_N.iter().map(|force| level(speed, force)).collect())
                .collect();
            let (v, f) = exponents(&levels, &SPEEDS_M_S, &FORCES_N);
            let db: Vec<Vec<f64>> = levels
                .iter()
                .map(|row| row.iter().map(|x| (200.0 * x.log10()).round() / 10.0).collect())
                .collect();
            println!("{probe:>10} {name:>10}: v^{v:.2} F^{f:.2} {db:?} dB");
            let by_force =
                levels.iter().flat_map(|row| row.windows(2)).map(|step| (step[0], step[1], "force"));
            let by_speed = levels
                .windows(2)
                .flat_map(|rows| rows[0].iter().zip(&rows[1]))
                .map(|(slower, faster)| (*slower, *faster, "speed"));
            for (softer, louder, what) in by_force.chain(by_speed) {
                steps += 1;
                // Seeds alone scatter by 0.2 to 0.9 dB.
                if louder < 0.89 * softer {
                    let by_db = 20.0 * (louder / softer).log10();
                    falls.push(format!("{probe}, {name}: {what}, {by_db:.1} dB"));
                }
            }
        }
    }
    println!("{} of {steps} steps fall: {falls:#?}", falls.len());
    assert!(falls.is_empty());
}
