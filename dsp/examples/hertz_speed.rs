//! Prints the nanoseconds of one impact (pulse from the speed, and its deposit), best and median of many short
//! segments, which other work on the machine disturbs less than a mean.
//!
//! `cargo run --release -p asperity-dsp --example hertz_speed`

use asperity_dsp::hertz::{Elastic, HertzContact, HertzPulse};
use std::hint::black_box;
use std::time::Instant;

fn best_and_median(mut impact: impl FnMut(u64)) -> (f64, f64) {
    let mut times: Vec<f64> = (0..2_000)
        .map(|segment| {
            let start = Instant::now();
            for i in 0..200 {
                impact(segment * 1_400 + i * 7);
            }
            start.elapsed().as_nanos() as f64 / 200.0
        })
        .collect();
    times.sort_by(f64::total_cmp);
    (times[0], times[times.len() / 2])
}

fn main() {
    let mut ring = vec![0.0; 1024];
    for samples in [0.05, 0.5, 1.5, 3.0, 4.0, 6.0, 9.0, 20.0, 40.0] {
        let (best, median) = best_and_median(|at| {
            let pulse = HertzPulse { impulse_n_s: 1e-6, contact_time_s: black_box(samples / 44_100.0) };
            pulse.deposit(&mut ring, at, (at % 16) as f64 / 16.0, 44_100.0);
        });
        println!("{samples:>5} samples: {best:5.1} ns ({median:5.1})");
    }
    let steel = Elastic { young_pa: 200e9, poisson: 0.3 };
    let contact = HertzContact::new(&steel, &steel, 0.001, 3.3e-5).unwrap();
    let (best, median) = best_and_median(|at| {
        contact.pulse(black_box(0.02)).deposit(&mut ring, at, (at % 16) as f64 / 16.0, 44_100.0);
    });
    println!("steel ball of 1 mm at 0.02 m/s, from the speed: {best:5.1} ns ({median:5.1})");
}
