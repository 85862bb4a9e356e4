//! Time a sample of the micro-contact: every integrator on a smooth and on a rough profile.
//! Throughput is in samples.
#![allow(missing_docs)]

#[path = "../tests/profiles/mod.rs"]
mod profiles;

use asperity_dsp::micro_contact::{ContactSample, Integrator, MicroContact, Probe};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use profiles::{Force, Profile, Shape};
use std::hint::black_box;

const RATE_HZ: f64 = 44_100.0;
const BLOCK: usize = 64;

/// Heights and forces, whole blocks.
type Inputs = (Vec<f64>, Vec<f64>);

fn inputs(shape: Shape, force: f64) -> Inputs {
    let profile = Profile { name: "bench", shape, force: Force::Constant(force) };
    let mut heights = profile.heights_m(RATE_HZ);
    heights.truncate(heights.len() / BLOCK * BLOCK);
    let forces = vec![force; heights.len()];
    (heights, forces)
}

fn profiles() -> [(&'static str, Inputs); 4] {
    [
        ("smooth", inputs(Shape::Sine(5e-5, 100.0), 0.5)),
        // About 4500 touches a second.
        ("rough", inputs(Shape::Fractal(1.0, 1e-5, 0.2, 0.0), 0.5)),
        ("resting", inputs(Shape::Sine(0.0, 100.0), 0.5)),
        ("unloaded", inputs(Shape::Sine(0.0, 100.0), 0.0)),
    ]
}

fn single(c: &mut Criterion) {
    let mut group = c.benchmark_group("micro_contact");
    for (name, (heights, forces)) in &profiles() {
        group.throughput(Throughput::Elements(heights.len() as u64));
        for integrator in Integrator::ALL {
            let design = MicroContact::new(&Probe::default(), integrator, RATE_HZ).unwrap();
            let mut state = design.at_rest(0.0, forces[0]);
            let mut out = [ContactSample::default(); BLOCK];
            group.bench_function(format!("{}/{name}", integrator.name()), |b| {
                b.iter(|| {
                    for (height, force) in heights.chunks_exact(BLOCK).zip(forces.chunks_exact(BLOCK)) {
                        design.run(&mut state, height, force, &mut out);
                        black_box(&out);
                    }
                });
            });
        }
    }
    group.finish();
}

fn building(c: &mut Criterion) {
    for integrator in [Integrator::ExactEvent, Integrator::EnergyConserving] {
        c.bench_function(&format!("micro_contact_design/{}", integrator.name()), |b| {
            b.iter(|| MicroContact::new(black_box(&Probe::default()), integrator, RATE_HZ));
        });
    }
}

criterion_group!(benches, single, building);
criterion_main!(benches);
