//! Prints what the kernels of one contact cost: every integrator on a smooth and on a rough
//! profile, the micro-relief on every instruction set, and a Hertz impact.
//!
//! `cargo run --release -p asperity-dsp --example kernel_speed`
//!
//! Each figure is the best and, behind it, the median of many segments well below a millisecond,
//! which other work on the machine disturbs less than a mean. The modal bank has `modal_speed`.

#[path = "../tests/profiles/mod.rs"]
mod profiles;

use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::hertz::{Elastic, HertzContact, HertzPulse};
use asperity_dsp::micro_contact::{ContactSample, Integrator, MicroContact, Probe};
use asperity_dsp::simd::Level;
use profiles::{Force, Profile, Shape};
use std::hint::black_box;
use std::time::Instant;

const RATE_HZ: f64 = 44_100.0;
const BLOCK: usize = 64;

/// Times `work`, which does `items` of something, and prints the ns of one.
fn show(name: &str, items: usize, mut work: impl FnMut()) {
    work();
    let mut times: Vec<f64> = (0..400)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_nanos() as f64 / items as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("  {name:<44} {:7.2} ({:7.2})", times[0], times[times.len() / 2]);
}

/// About 4000 heights of a profile, whole blocks.
fn heights(shape: Shape) -> Vec<f64> {
    let mut heights = Profile { name: "speed", shape, force: Force::Constant(0.5) }.heights_m(RATE_HZ);
    heights.truncate(4096);
    heights
}

fn contacts() {
    println!("contact alone, ns a sample and contact: best (median)");
    // The rough one touches about 4400 times a second.
    let profiles = [("smooth", Shape::Sine(5e-5, 100.0)), ("rough", Shape::Fractal(1.0, 1e-5, 0.2, 0.0))];
    for (name, shape) in profiles {
        let heights = heights(shape);
        let forces = vec![0.5; heights.len()];
        for integrator in Integrator::ALL {
            let design = MicroContact::new(&Probe::default(), integrator, RATE_HZ).expect("valid");
            let mut state = design.at_rest(0.0, 0.5);
            let mut out = [ContactSample::default(); BLOCK];
            show(&format!("{}, {name}", integrator.name()), heights.len(), || {
                for (height, force) in heights.chunks_exact(BLOCK).zip(forces.chunks_exact(BLOCK)) {
                    design.run(&mut state, height, force, &mut out);
                    black_box(&out);
                }
            });
        }
    }
}

fn noise() {
    println!("micro-relief, 12 octaves alive, ns a sample: best (median)");
    let step = 0.09 / RATE_HZ;
    let position_m: Vec<[f64; 2]> =
        (0..4096).map(|n| [0.02 + 0.8 * step * f64::from(n), 0.07 + 0.6 * step * f64::from(n)]).collect();
    let (footprint_m, roughness) = (vec![step; position_m.len()], vec![0.5; BLOCK]);
    let mut height = vec![0.0; position_m.len()];
    for level in Level::available() {
        let noise = FractalNoise::new(1).on(level);
        show(&format!("{:?}", level.isa()), height.len(), || {
            let blocks = position_m.chunks(BLOCK).zip(footprint_m.chunks(BLOCK));
            for ((position_m, footprint_m), out) in blocks.zip(height.chunks_mut(BLOCK)) {
                noise.add(
                    &NoisePath { position_m, footprint_m },
                    &roughness,
                    &OctaveWeights::pinned(2e-6, black_box(f64::INFINITY)),
                    out,
                );
            }
        });
    }
}

fn impacts() {
    println!("Hertz impact, ns: best (median)");
    let mut ring = vec![0.0; 1024];
    let mut at = 0_u64;
    for samples in [0.05, 0.5, 1.5, 3.0, 4.0, 6.0, 9.0, 20.0, 40.0] {
        show(&format!("{samples} samples long"), 200, || {
            for _ in 0..200 {
                at += 7;
                let pulse = HertzPulse::elastic(1e-6, black_box(samples / RATE_HZ));
                pulse.deposit(&mut ring, at, (at % 16) as f64 / 16.0, RATE_HZ);
            }
        });
    }
    let steel = Elastic { young_pa: 200e9, poisson: 0.3 };
    let contact = HertzContact::new(&steel, &steel, 0.001, 3.3e-5).expect("valid");
    show("steel ball of 1 mm at 0.02 m/s, from the speed", 200, || {
        for _ in 0..200 {
            at += 7;
            contact.pulse(black_box(0.02)).deposit(&mut ring, at, (at % 16) as f64 / 16.0, RATE_HZ);
        }
    });
}

fn main() {
    contacts();
    noise();
    impacts();
}
