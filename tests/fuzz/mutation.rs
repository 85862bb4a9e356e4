//! Seeded mutations of valid files, for fuzzing on stable.

use asperity_dsp::rng::Rng;
use std::time::{Duration, Instant};

/// Duration of each target.
const BUDGET: Duration = Duration::from_secs(3);

/// Numbers that break things.
const TOKENS: [&str; 24] = [
    "0",
    "-0",
    "1e308",
    "-1e308",
    "1e-320",
    "1e999",
    "NaN",
    "null",
    "true",
    "[]",
    "{}",
    "\"\"",
    "18446744073709551615",
    "-1",
    "0.5",
    "4294967296",
    "9007199254740993",
    "1e-12",
    "1e7",
    ",",
    "\n",
    "\"steel\"",
    "[1,2]",
    "\u{0}",
];

/// One of many ways to spoil a file.
fn mutated(seed: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut data = seed.to_vec();
    for _ in 0..1 + rng.next_u32() % 4 {
        let len = data.len().max(1);
        let at = rng.next_u32() as usize % len;
        let to = (at + rng.next_u32() as usize % 16).min(data.len());
        match rng.next_u32() % 7 {
            0 => data.truncate(at),
            1 if !data.is_empty() => data[at] ^= 1 << (rng.next_u32() % 8),
            2 if !data.is_empty() => data[at] = rng.next_u32() as u8,
            3 => drop(data.drain(at.min(to)..to)),
            4 => {
                let part = data[at.min(to)..to].to_vec();
                data.splice(at.min(data.len())..at.min(data.len()), part);
            }
            _ => replace_a_number(&mut data, rng),
        }
    }
    data
}

/// Text: a number somewhere becomes a token.
fn replace_a_number(data: &mut Vec<u8>, rng: &mut Rng) {
    let digit = |b: &u8| b.is_ascii_digit() || b"+-.e".contains(b);
    let starts: Vec<usize> =
        (1..data.len()).filter(|&i| data[i].is_ascii_digit() && !digit(&data[i - 1])).collect();
    if starts.is_empty() {
        return;
    }
    let start = starts[rng.next_u32() as usize % starts.len()];
    let end = start + data[start..].iter().take_while(|b| digit(b)).count();
    let token = TOKENS[rng.next_u32() as usize % TOKENS.len()];
    data.splice(start..end, token.bytes());
}

/// Hands `target` the seeds and then mutations of them until the time is up; returns how many.
pub fn drive(seeds: &[Vec<u8>], target: impl Fn(&[u8])) -> usize {
    let mut rng = Rng::new(0xA5);
    let began = Instant::now();
    for seed in seeds {
        target(seed);
    }
    let mut runs = 0;
    while began.elapsed() < BUDGET {
        let seed = &seeds[runs % seeds.len()];
        target(&mutated(seed, &mut rng));
        runs += 1;
    }
    runs
}
