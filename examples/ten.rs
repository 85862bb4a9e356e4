#[path = "../benches/scenes/mod.rs"]
mod scenes;
use asperity::Config;
use scenes::{Plan, Running};
fn cpu() -> f64 {
    let t = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    t.split_whitespace().next().unwrap().parse::<f64>().unwrap()
}
fn main() {
    let a: Vec<usize> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let (contacts, modes, frames, blocks) = (a[0], a[1], a[2], a[3]);
    let mut running = Running::new(Config::default(), Plan { contacts, modes, speed_m_s: 0.1 }, frames);
    for _ in 0..300 {
        running.step();
        running.block();
    }
    let begin = cpu();
    let began = std::time::Instant::now();
    for _ in 0..blocks {
        running.step();
        running.block();
    }
    let (c, w) = (cpu() - begin, began.elapsed().as_nanos() as f64);
    let n = (blocks * frames) as f64;
    println!("{:.1} {:.1}", c / n, w / n);
}
