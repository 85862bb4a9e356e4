//! Blocks of 64 samples of whole scenes; the period of one is 1.45 ms.

mod scenes;

use asperity::Config;
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use scenes::{Plan, Running};
use std::cell::RefCell;

const FRAMES: usize = 64;

fn headroom(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("headroom");
    group.throughput(Throughput::Elements(FRAMES as u64));
    for (name, contacts, modes) in [
        ("one contact, no modes", 1, 0),
        ("one contact, 100 modes", 1, 100),
        ("ten fingers on ten bodies of 100 modes", 10, 100),
        ("64 contacts, 16 modes each", 64, 16),
        ("one contact, 4096 modes", 1, 4096),
    ] {
        let plan = Plan { contacts, modes, speed_m_s: 0.1 };
        let running = RefCell::new(Running::new(Config::default(), plan, FRAMES));
        group.bench_function(name, |bencher| {
            bencher.iter_batched(
                || running.borrow_mut().step(),
                |()| running.borrow_mut().block(),
                BatchSize::PerIteration,
            );
        });
    }
    let plan = Plan { contacts: 10, modes: 100, speed_m_s: 0.1 };
    let mut running = Running::new(Config::default(), plan, FRAMES);
    for _ in 0..400 {
        running.step();
        running.block();
    }
    running.lift();
    for _ in 0..6000 {
        running.block();
    }
    group.bench_function("ten fingers lifted, ten bodies rung out", |bencher| {
        bencher.iter(|| running.block())
    });
    group.finish();
}

criterion_group!(benches, headroom);
criterion_main!(benches);
