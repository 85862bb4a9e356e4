//! What a second thread is worth. A file of its own, because a test that runs beside it would take
//! the second processor away.

mod common;
#[path = "common/many_bodies.rs"]
mod many_bodies;

use many_bodies::Strokes;
use std::time::Instant;

/// Least share of the best possible gain that sharing one engine's work has to reach; 0.93 on two
/// cores that nobody else uses.
const LEAST_SHARE: f64 = 0.7;

/// How often that is looked for.
const TRIES: usize = 5;

/// What two engines at once have to reach for there to be two processors.
const TWO_PROCESSORS: f64 = 1.5;

/// Seconds of 200 blocks of 64 frames.
fn run_s(strokes: &mut Strokes) -> f64 {
    let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
    let began = Instant::now();
    for _ in 0..200 {
        strokes.block(&mut haptic, &mut audio);
    }
    began.elapsed().as_secs_f64()
}

/// Medians of fifteen turns: how many times as fast two threads are as one, and what two engines at
/// once do.
fn gain_and_possible() -> (f64, f64) {
    let (mut one, mut other) = (Strokes::new(10, 1000, 1), Strokes::new(10, 1000, 1));
    let mut shared = Strokes::new(10, 1000, 2);
    let (mut possible, mut gains) = (Vec::new(), Vec::new());
    for _ in 0..15 {
        let alone_s = run_s(&mut one);
        let began = Instant::now();
        std::thread::scope(|scope| {
            scope.spawn(|| run_s(&mut one));
            run_s(&mut other);
        });
        possible.push(2.0 * alone_s / began.elapsed().as_secs_f64());
        gains.push(alone_s / run_s(&mut shared));
    }
    gains.sort_by(f64::total_cmp);
    possible.sort_by(f64::total_cmp);
    (gains[7], possible[7])
}

#[test]
fn two_threads_on_one_engine_nearly_reach_two_engines() {
    // Whoever else wants the second processor hurts threads that wait for each other more than two
    // that do not, for seconds at a time: the best of several tries is the engine's.
    let mut best: Option<(f64, f64)> = None;
    for _ in 0..TRIES {
        let (gain, possible) = gain_and_possible();
        println!(
            "ten bodies of 1000 modes, two threads: {gain:.2} times as fast; two engines at once: {possible:.2}"
        );
        if possible < TWO_PROCESSORS {
            continue;
        }
        if best.is_none_or(|(most, of)| gain / possible > most / of) {
            best = Some((gain, possible));
        }
        if gain >= LEAST_SHARE * possible {
            break;
        }
    }
    let Some((gain, possible)) = best else {
        println!("skipped: this machine has no two processors to give now");
        return;
    };
    assert!(
        gain >= LEAST_SHARE * possible,
        "{gain:.2} where two engines do {possible:.2} times the work of one"
    );
}
