//! Prints how many mode-samples a nanosecond the bank renders, force in every sample, beside the
//! loop a C programmer writes (`benches/peers/fast_math.c`, `gcc -O3 -march=native -ffast-math`),
//! in one run.
//!
//! `cargo run --release -p asperity-dsp --example modal_speed [ROUNDS [MODES …]]`
//!
//! Rounds of all contenders alternate; each figure is the best and, behind it, the median of many
//! segments of about 1 ms, so that other work on the machine hurts neither side alone.

use asperity_dsp::modal_bank::{
    GroupOptions, GroupState, Input, Inputs, ModalBank, ModeGroup, design_groups, lane_gains,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::{Isa, Level};
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

const BLOCK: usize = 64;

fn bank(modes: usize) -> Vec<ModeGroup> {
    let all: Vec<Mode> = (0..modes)
        .map(|i| Mode {
            frequency_hz: 100.0 + 15_000.0 * i as f64 / modes as f64,
            decay_per_s: 20.0,
            amplitude: 1.0 / modes as f64,
            phase_rad: 0.0,
        })
        .collect();
    design_groups(&all, 44_100.0, &GroupOptions::IMPULSE_RING).collect::<Result<_, _>>().unwrap()
}

/// Mode-samples per nanosecond of one segment; `inputs` = 0 is the shared input.
fn segment(kernel: Level, modes: usize, inputs: usize, rng: &mut Rng) -> f64 {
    let groups = bank(modes);
    let gains: Vec<_> = lane_gains(vec![0.5; modes]).collect();
    let states = vec![GroupState::REST; groups.len()];
    let mut bank = ModalBank::new(kernel, groups, states);
    let force: Vec<f32> = (0..BLOCK).map(|_| rng.uniform() as f32 - 0.5).collect();
    let several = vec![Input { impulses: &force, gains: &gains }; inputs];
    let mut out = vec![0.0_f32; BLOCK];
    let blocks = 1 + 8_000_000 / (modes * BLOCK);
    let start = Instant::now();
    for b in 0..blocks {
        let at = (b * BLOCK) as u64;
        let inputs = if inputs == 0 { Inputs::One(&force) } else { Inputs::Placed(&several) };
        bank.render(at, inputs, &mut out);
    }
    let ns = start.elapsed().as_nanos() as f64;
    assert!(out.iter().all(|x| x.is_finite()));
    (blocks * BLOCK * modes) as f64 / ns
}

fn c_peer() -> Option<PathBuf> {
    // Neither compilers nor folders in a sandbox.
    if cfg!(target_family = "wasm") {
        return None;
    }
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("benches/peers/fast_math.c");
    let binary = std::env::temp_dir().join(format!("asperity_fast_math_{}", std::process::id()));
    let built = Command::new("gcc")
        .args(["-O3", "-march=native", "-ffast-math", "-o"])
        .args([&binary, &source])
        .arg("-lm")
        .status();
    built.is_ok_and(|s| s.success()).then_some(binary)
}

fn c_segment(peer: &PathBuf, modes: usize, phase: bool) -> Option<Vec<f64>> {
    let arguments = [modes.to_string(), "8".into(), "phase".into()];
    let run = Command::new(peer).args(&arguments[..if phase { 3 } else { 2 }]).output().ok()?;
    String::from_utf8(run.stdout).ok()?.split_whitespace().map(|x| x.parse().ok()).collect()
}

fn best_and_median(mut rates: Vec<f64>) -> String {
    rates.sort_by(f64::total_cmp);
    match rates.last() {
        Some(best) => format!("{best:6.2} ({:5.2})", rates[rates.len() / 2]),
        None => "     –        ".into(),
    }
}

fn main() {
    let rounds: usize = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(12);
    let kernels: Vec<Level> = Isa::ALL.into_iter().filter_map(Level::find).collect();
    let peer = c_peer();
    if peer.is_none() {
        println!("no gcc here: the C column stays empty");
    }
    println!("G mode-samples/s: best (median) of {rounds} rounds");
    print!("{:>6}", "modes");
    for kernel in &kernels {
        print!("  {:>14}  {:>14}", format!("{:?}", kernel.isa()), "2 gained inputs");
    }
    println!("  {:>14}  {:>14}", "C -ffast-math", "C with phase");
    let mut sizes: Vec<usize> = std::env::args().skip(2).filter_map(|a| a.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = vec![16, 32, 64, 100, 256, 1024, 4096];
    }
    let mut rng = Rng::new(1);
    for modes in sizes {
        let mut columns = vec![Vec::new(); 2 * kernels.len() + 2];
        for _ in 0..rounds {
            for (k, kernel) in kernels.iter().enumerate() {
                for (j, inputs) in [0, 2].into_iter().enumerate() {
                    for _ in 0..4 {
                        columns[2 * k + j].push(segment(*kernel, modes, inputs, &mut rng));
                    }
                }
            }
            for (j, phase) in [false, true].into_iter().enumerate() {
                if let Some(rates) = peer.as_ref().and_then(|p| c_segment(p, modes, phase)) {
                    columns[2 * kernels.len() + j].extend(rates);
                }
            }
        }
        print!("{modes:>6}");
        for column in columns {
            print!("  {:>14}", best_and_median(column));
        }
        println!();
    }
    if let Some(peer) = peer {
        let _ = std::fs::remove_file(peer);
    }
}
