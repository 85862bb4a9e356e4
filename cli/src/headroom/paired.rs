//! Rows that compare two things: in turn, a block's time of the one and of the other, so that both
//! see the same machine; the median of the pairs.

use super::{BLOCK_FRAMES, GROWTH_S, SAMPLE_RATE_HZ};
use crate::bench_scene::{Bench, Load};
use crate::error::CliError;
use crate::measure::Timing;
use asperity::{Config, Isa};
use asperity_dsp::simd::Level;
use serde::Serialize;
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

/// Frames rendered at a time, of either: so few that little else comes between them.
const TURN_FRAMES: usize = BLOCK_FRAMES;
/// Frames of blocks one after the other, between which a helper stays awake: as when a file is
/// rendered.
const ROW_FRAMES: usize = 64 * BLOCK_FRAMES;
/// Frames of the shortest blocks that sound cards ask for.
const SHORT_FRAMES: usize = 16;
/// Contacts that are many.
const MANY: usize = 64;

/// One thing beside another.
#[derive(Debug, Serialize)]
pub(super) struct PairRow {
    /// Two things that are compared.
    what: &'static str,
    /// Work of either.
    scene: &'static str,
    instruction_set: &'static str,
    /// A sample of the first, and of the second; where contacts are counted, a sample and contact.
    ns_first: f64,
    ns_second: f64,
    /// The median of second over first.
    times_the_first: f64,
}

/// Result of the paired rows.
#[derive(Debug, Serialize)]
pub(super) struct Paired {
    rows: Vec<PairRow>,
    /// Factor by which two threads that only count do more work in a time than one.
    two_busy_loops: f64,
}

const MANY_CONTACTS: &str = "64 contacts beside 1, each";
const SHORT_BLOCKS: &str = "blocks of 16 frames beside 64";
const TWO_THREADS: &str = "2 threads beside 1";
/// Each block finds the helper asleep, as in live play.
const TWO_THREADS_ASLEEP: &str = "2 threads, helper asleep";

/// A scene, as it is rendered.
#[derive(Clone, Copy)]
struct Way {
    load: Load,
    isa: Option<Isa>,
    threads: usize,
    frames: usize,
    /// Frames of a turn.
    turn_frames: usize,
    /// Divisor of its cost.
    shares: usize,
}

impl Way {
    fn bench(self) -> Result<Bench, CliError> {
        let Self { load, isa: kernel, threads, .. } = self;
        let config = Config { sample_rate_hz: SAMPLE_RATE_HZ, kernel, threads, ..Config::default() };
        Bench::new(load, config)
    }

    /// Ns a sample of the next frames.
    fn turn(self, bench: &mut Bench) -> f64 {
        let (mut haptic, mut audio) = ([0.0f32; BLOCK_FRAMES], [0.0f32; BLOCK_FRAMES]);
        let (haptic, audio) = (&mut haptic[..self.frames], &mut audio[..self.frames]);
        // Reports come in between.
        let parts = self.turn_frames / TURN_FRAMES;
        let time_s: f64 = (0..parts).map(|_| bench.blocks(TURN_FRAMES / self.frames, haptic, audio)).sum();
        time_s * 1e9 / (self.turn_frames * self.shares) as f64
    }
}

pub(super) fn rows() -> Result<Paired, CliError> {
    let load = |contacts, bodies, modes_per_body| Load { contacts, bodies, modes_per_body, lift: false };
    let (frames, turn_frames) = (BLOCK_FRAMES, TURN_FRAMES);
    let way = |load, isa| Way { load, isa, threads: 1, frames, turn_frames, shares: 1 };
    let mut rows = Vec::new();
    let native = Level::detect().isa();
    let mut sets = vec![Isa::Avx2, native];
    sets.dedup();
    for isa in sets.into_iter().filter(|isa| Level::find(*isa).is_some()) {
        let many = Way { shares: MANY, ..way(load(MANY, MANY, 0), Some(isa)) };
        rows.push(pair(MANY_CONTACTS, "silent plates", isa, [way(load(1, 1, 0), Some(isa)), many])?);
    }
    for (scene, load) in
        [("one finger, silent plate", load(1, 1, 0)), ("ten fingers on ten bodies", load(10, 10, 100))]
    {
        let long = way(load, None);
        rows.push(pair(SHORT_BLOCKS, scene, native, [long, Way { frames: SHORT_FRAMES, ..long }])?);
    }
    for (scene, load) in
        [("ten fingers on ten bodies", load(10, 10, 100)), ("ten bodies of 1000 modes", load(10, 10, 1000))]
    {
        for (what, turn_frames) in [(TWO_THREADS, ROW_FRAMES), (TWO_THREADS_ASLEEP, TURN_FRAMES)] {
            let one = Way { turn_frames, ..way(load, None) };
            rows.push(pair(what, scene, native, [one, Way { threads: 2, ..one }])?);
        }
    }
    Ok(Paired { rows, two_busy_loops: two_busy_loops() })
}

/// One way beside another.
fn pair(
    what: &'static str,
    scene: &'static str,
    isa: Isa,
    [first, second]: [Way; 2],
) -> Result<PairRow, CliError> {
    let (mut one, mut other) = (first.bench()?, second.bench()?);
    let turns = (GROWTH_S * SAMPLE_RATE_HZ) as usize / first.turn_frames;
    let pairs: Vec<[f64; 2]> =
        (0..turns).map(|_| [first.turn(&mut one), second.turn(&mut other)]).skip(turns / 8).collect();
    let median = |of: fn(&[f64; 2]) -> f64| Timing::of(pairs.iter().map(of).collect()).median;
    Ok(PairRow {
        what,
        scene,
        instruction_set: isa.name(),
        ns_first: median(|pair| pair[0]),
        ns_second: median(|pair| pair[1]),
        times_the_first: median(|pair| pair[1] / pair[0]),
    })
}

/// Bound of any engine on this machine at this time.
fn two_busy_loops() -> f64 {
    let busy = || {
        let began = Instant::now();
        (0..4_000_000u64).fold(1, |sum, i| black_box(sum ^ i.wrapping_mul(sum)));
        began.elapsed().as_secs_f64()
    };
    let factors = (0..15).map(|_| {
        let alone_s = busy();
        let together_s = std::thread::scope(|scope| {
            let other = scope.spawn(busy);
            let own_s = busy();
            other.join().map_or(own_s, |other_s| own_s.max(other_s))
        });
        2.0 * alone_s / together_s
    });
    Timing::of(factors.collect()).median
}

impl Paired {
    pub(super) fn table(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "\n{:<32}{:<28}{:>10}{:>10}{:>10}{:>7}",
            "in turn", "scene", "set", "ns first", "second", "×"
        );
        for row in &self.rows {
            let PairRow { what, scene, instruction_set, ns_first, ns_second, times_the_first } = row;
            let _ = writeln!(
                text,
                "{what:<32}{scene:<28}{instruction_set:>10}{ns_first:>10.1}{ns_second:>10.1}{times_the_first:>7.2}"
            );
        }
        let _ = writeln!(text, "two busy loops at once do {:.2} times the work of one", self.two_busy_loops);
    }
}
