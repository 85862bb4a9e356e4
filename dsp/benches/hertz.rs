//! Cost of one impact: pulse from the speed, and its deposit into the ring. Bar: 50 ns up to 9
//! samples of contact.

use asperity_dsp::hertz::{Elastic, HertzContact, HertzPulse};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn hertz(c: &mut Criterion) {
    let mut ring = vec![0.0; 1024];
    let mut group = c.benchmark_group("hertz impact");
    for samples in [0.5, 1.5, 4.0, 9.0, 40.0] {
        let mut at = 0_u64;
        group.bench_function(format!("{samples} samples"), |b| {
            b.iter(|| {
                at += 7;
                let offset = (at % 16) as f64 / 16.0;
                let pulse = HertzPulse::elastic(1e-6, black_box(samples / 44_100.0));
                pulse.deposit(&mut ring, at, offset, 44_100.0);
            });
        });
    }
    let steel = Elastic { young_pa: 200e9, poisson: 0.3 };
    let contact = HertzContact::new(&steel, &steel, 0.001, 1.5e-4).unwrap();
    let mut at = 0_u64;
    group.bench_function("steel, from the speed", |b| {
        b.iter(|| {
            at += 7;
            contact.pulse(black_box(0.02)).deposit(&mut ring, at, 0.3, 44_100.0);
        });
    });
    group.finish();
}

criterion_group!(benches, hertz);
criterion_main!(benches);
