//! A finger, or several, that stroke for as many samples as you say: `cargo run --release --example
//! soak 1000000000 [contacts] [modes]`.
//!
//! A billion samples are six hours of touch. Prints the peaks of every tenth; they must stay level,
//! and the engine must fall silent at the end.

#[path = "../benches/scenes/mod.rs"]
mod scenes;

use asperity::Config;
use scenes::{Plan, Running};
use std::time::Instant;

fn main() {
    let samples: f64 = std::env::args().nth(1).and_then(|arg| arg.parse().ok()).unwrap_or(1e8);
    let frames = 441;
    let count = |nth, default| std::env::args().nth(nth).and_then(|arg| arg.parse().ok()).unwrap_or(default);
    let plan = Plan { contacts: count(2, 1), modes: count(3, 16), speed_m_s: 0.1 };
    let mut running = Running::new(Config::default(), plan, frames);
    let began = Instant::now();
    for tenth in 1..=10 {
        let mut peak = 0.0f32;
        for _ in 0..(samples / 10.0) as usize / frames {
            running.step();
            running.block();
            for x in running.audio() {
                assert!(x.is_finite(), "sample {} is no number", running.renderer.position());
                peak = peak.max(x.abs());
            }
        }
        let (at, stats) = (running.renderer.position(), running.scene.stats());
        println!(
            "{tenth:2}/10  sample {at}  {:.0} s  audio peak {peak:.3e}  micro-collisions {}  quarantined {}",
            began.elapsed().as_secs_f64(),
            stats.micro_collisions,
            stats.quarantined
        );
    }
    running.lift();
    for _ in 0..5000 {
        running.block();
    }
    assert!(running.audio().iter().all(|x| *x == 0.0), "the engine still sounds");
    println!("silent at the end");
}
