//! Audio that stood still for a while, as when a headset reconnects: no bang of all that happened
//! meanwhile.

use crate::common;

use asperity::files::contact_log::{LogEvent, Names};
use asperity::live::channel_map::{ChannelMap, Interleaver};
use asperity::live::null_sink::NullSink;
use asperity::offline::{self, Options};
use asperity::{Config, ContactEvent, ContactSample, Engine, Impact, Material, Scene, SilenceReason};
use asperity_dsp::rng::Rng;
use common::game::{Game, block};
use common::{SIDE_M, peak};
use std::time::{Duration, Instant};

const RATE_HZ: f64 = 48_000.0;
/// Samples in a tick of 60 Hz.
const TICK: usize = 800;

/// What the game does around the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Does {
    Nothing,
    Reset,
    FadeAll,
    Pause,
    Mute,
}

struct Strikes {
    game: Game,
    strikes_every: u32,
    strokes: bool,
}

impl Strikes {
    /// Strikes so many times a second, 0 for never; and strokes, or does not.
    fn new(strikes_a_second: u32, strokes: bool) -> Self {
        let strikes_every = 60u32.checked_div(strikes_a_second).unwrap_or(u32::MAX);
        Self { game: Game::new(common::raw_live(RATE_HZ)), strikes_every, strokes }
    }

    /// A tick of the game, as it reports it.
    fn report(&mut self) {
        let game = &mut self.game;
        if self.strokes {
            let uv = [0.1 + 0.05 * game.now_s() / SIDE_M, 0.5];
            game.touch(1, ContactSample::new(uv, 0.6).sliding([0.05, 0.0]), game.tick == 0);
        }
        if game.tick.is_multiple_of(self.strikes_every) && self.strikes_every < u32::MAX {
            game.report(ContactEvent::Impact(Impact::on(game.block).striker(Material::STEEL, 0.01, 0.005)));
        }
        game.tick += 1;
    }

    /// So many ticks that are rendered, and how they sound.
    fn play(&mut self, ticks: usize) -> Vec<f32> {
        let mut heard = vec![0.0; ticks * TICK];
        for audio in heard.chunks_exact_mut(TICK) {
            self.report();
            self.game.renderer.render(&mut [&mut [0.0; TICK]], &mut [audio]);
        }
        heard
    }

    /// So many seconds that nobody renders, while the game does `does` around them.
    fn stand(&mut self, seconds: u32, does: Does) {
        match does {
            Does::Pause => self.game.scene.pause().unwrap(),
            Does::Mute => self.game.scene.set_muted(true).unwrap(),
            _ => {}
        }
        (0..60 * seconds).for_each(|_| self.report());
        match does {
            Does::Nothing => {}
            Does::Reset => self.game.scene.reset().unwrap(),
            Does::FadeAll => self.game.scene.fade_all().unwrap(),
            Does::Pause => self.game.scene.resume().unwrap(),
            Does::Mute => self.game.scene.set_muted(false).unwrap(),
        }
    }
}

fn db(now: f64, usual: f64) -> f64 {
    20.0 * (now / usual).log10()
}

#[test]
fn audio_that_comes_back_after_a_gap_does_not_bang() {
    let mut bangs = Vec::new();
    for (strikes_a_second, strokes) in [(5, false), (20, false), (20, true), (0, true)] {
        for seconds in [1, 3, 10, 60] {
            for does in [Does::Nothing, Does::Reset, Does::FadeAll, Does::Pause, Does::Mute] {
                let what = format!("{strikes_a_second}/s, strokes {strokes}, {seconds} s, {does:?}");
                let mut strikes = Strikes::new(strikes_a_second, strokes);
                let mut usual = peak(&strikes.play(120)[TICK * 30..]);
                strikes.stand(seconds, does);
                let peak_after = peak(&strikes.play(60));
                let after = db(peak_after, usual);
                let stats = strikes.game.scene.stats();
                println!("{what}: {after:+.1} dB, {} stale of {}", stats.stale, stats.events);
                if strikes_a_second == 0 {
                    // A rough ground is louder here and there: as it sounds there without a gap.
                    let mut without = Strikes::new(0, true);
                    without.play(120 + 60 * seconds as usize);
                    usual = usual.max(peak(&without.play(60)));
                }
                let after = db(peak_after, usual);
                println!("    beside the same places without a gap: {after:+.1} dB");
                if after > 3.0 {
                    bangs.push(format!("{what}: {after:+.1} dB"));
                }
                let message = strikes.game.scene.why_silent().iter().any(
                    |because| matches!(because, SilenceReason::Stale { count } if *count == stats.stale),
                );
                assert_eq!(message, strikes_a_second > 0, "{what}: {:?}", strikes.game.scene.why_silent());
                assert!(strikes_a_second == 0 || stats.stale > 0, "{what}");
            }
        }
    }
    assert!(bangs.is_empty(), "{}", bangs.join("\n"));
}

#[test]
fn what_is_struck_after_a_gap_is_heard() {
    let mut strikes = Strikes::new(5, false);
    let usual = peak(&strikes.play(120));
    strikes.stand(10, Does::Nothing);
    strikes.play(60);
    let stale = strikes.game.scene.stats().stale;
    let later = db(peak(&strikes.play(120)), usual);
    assert!(later.abs() < 1.0, "{later} dB");
    assert_eq!(strikes.game.scene.stats().stale, stale, "nothing more is dropped");
}

#[test]
fn nothing_is_dropped_where_audio_is_rendered_in_long_blocks() {
    let mut strikes = Strikes::new(20, false);
    let mut audio = vec![0.0; 6 * TICK];
    for _ in 0..40 {
        (0..6).for_each(|_| strikes.report());
        strikes.game.renderer.render(&mut [&mut vec![0.0; 6 * TICK]], &mut [&mut audio]);
    }
    assert_eq!((strikes.game.scene.stats().stale, strikes.game.scene.stats().impacts), (0, 80));
}

/// A game and an audio thread in steps of time.
#[derive(Debug, Clone, Copy)]
struct Run {
    strikes_a_second: u32,
    block: usize,
    /// The audio stops there, and for so long, s.
    stops_s: f64,
    gap_s: f64,
    /// The game stops there, and for so long; its ticks then come all at once.
    hitches_s: f64,
    hitch_s: f64,
    jitter_s: f64,
}

impl Run {
    /// By how much the loudest strike after the audio has stopped is over that of before, dB.
    fn louder_db(&self, rng: &mut Rng) -> f64 {
        let Self { block, stops_s, gap_s, hitches_s, hitch_s, jitter_s, .. } = *self;
        let back_s = stops_s + gap_s;
        let mut strikes = Strikes::new(self.strikes_a_second, false);
        let mut heard: Vec<(f64, f32)> = Vec::new();
        let (mut rendered_s, mut message) = (0.0, 0u32);
        let told_at = |tick: u32, jitter_s: f64| {
            let at_s = f64::from(tick) / 60.0 + 0.007 + jitter_s;
            if (hitches_s..hitches_s + hitch_s).contains(&at_s) { hitches_s + hitch_s } else { at_s }
        };
        let mut next_s = told_at(0, 0.0);
        while rendered_s < back_s + 1.5 {
            while next_s <= rendered_s {
                strikes.report();
                message += 1;
                next_s = told_at(message, jitter_s * rng.uniform());
            }
            if !(stops_s..back_s).contains(&rendered_s) {
                let mut audio = vec![0.0; block];
                strikes.game.renderer.render(&mut [&mut vec![0.0; block]], &mut [&mut audio]);
                heard.extend(audio.iter().map(|x| (rendered_s, *x)));
            }
            rendered_s += block as f64 / RATE_HZ;
        }
        let loudest = |from_s: f64, to_s: f64| {
            let within = heard.iter().filter(|(at_s, _)| (from_s..to_s).contains(at_s));
            within.fold(0.0f64, |most, (_, x)| most.max(f64::from(x.abs())))
        };
        db(loudest(back_s, f64::INFINITY), loudest(0.0, stops_s))
    }
}

const BLOCKS: [usize; 6] = [64, 128, 256, 512, 1024, 2048];

#[test]
fn no_gap_and_no_hitch_of_any_length_bangs() {
    let mut rng = Rng::new(52);
    let mut bangs = Vec::new();
    for run in 0..240 {
        let strikes_a_second = [5, 10, 20][run % 3];
        let gap_s = 0.02 * (150.0f64).powf(rng.uniform());
        let block = BLOCKS[(6.0 * rng.uniform()) as usize];
        let (stops_s, jitter_s) = (2.0 + 0.3 * rng.uniform(), [0.0, 0.004][run / 3 % 2]);
        // Each third game hitches as well.
        let hitch_s = if run % 9 < 3 { 0.15 } else { 0.0 };
        let hitches_s = stops_s + gap_s - 0.05;
        let run = Run { strikes_a_second, block, stops_s, gap_s, hitches_s, hitch_s, jitter_s };
        let louder_db = run.louder_db(&mut rng);
        if louder_db > 3.0 {
            bangs.push(format!("{run:?}: {louder_db:+.1} dB"));
        }
    }
    assert!(bangs.is_empty(), "{}", bangs.join("\n"));
}

#[test]
fn a_short_hitch_of_the_game_throws_no_two_strikes_together() {
    let mut rng = Rng::new(53);
    let mut worst_db = f64::NEG_INFINITY;
    for number in 0..120 {
        let run = Run {
            strikes_a_second: 20,
            block: BLOCKS[(6.0 * rng.uniform()) as usize],
            stops_s: 1.0,
            gap_s: 0.0,
            hitches_s: 1.0 + 0.3 * rng.uniform(),
            hitch_s: if number % 3 == 0 { 0.06 + 0.19 * rng.uniform() } else { 0.02 + 0.04 * rng.uniform() },
            jitter_s: [0.0, 0.004][number % 2],
        };
        let louder_db = run.louder_db(&mut rng);
        worst_db = worst_db.max(louder_db);
        assert!(louder_db <= 3.0, "{run:?}: {louder_db:+.1} dB");
    }
    println!("{worst_db:+.1} dB at most");
}

#[test]
fn a_headset_that_comes_back_at_another_rate_does_not_bang() {
    for (seconds, rate_hz) in [(1, 44_100.0), (3, 24_000.0), (10, 96_000.0)] {
        let mut strikes = Strikes::new(20, false);
        strikes.play(120);
        strikes.stand(seconds, Does::Nothing);
        strikes.game.renderer = strikes.game.scene.at_rate(strikes.game.renderer, rate_hz).unwrap().renderer;
        let mut second = || {
            let mut audio = vec![0.0; (rate_hz / 60.0) as usize];
            let mut loudest = 0.0f64;
            for _ in 0..60 {
                strikes.report();
                strikes.game.renderer.render(&mut [&mut vec![0.0; audio.len()]], &mut [&mut audio]);
                loudest = loudest.max(peak(&audio));
            }
            loudest
        };
        let at_first = second();
        second();
        let after = db(at_first, second());
        println!("{seconds} s, {rate_hz} Hz: {after:+.1} dB, {} stale", strikes.game.scene.stats().stale);
        assert!(after <= 3.0, "{seconds} s, {rate_hz} Hz: {after:+.1} dB");
        assert!(strikes.game.scene.stats().stale > 0, "{seconds} s, {rate_hz} Hz");
    }
}

#[test]
fn a_recording_over_a_gap_sounds_as_the_game_did() {
    let gaps =
        [(Does::Nothing, 3), (Does::Nothing, 1), (Does::Reset, 3), (Does::FadeAll, 3), (Does::Pause, 3)];
    for (does, seconds) in gaps {
        let mut strikes = Strikes::new(20, false);
        strikes.game.scene.start_recording(&Names::default());
        let mut heard = strikes.play(60);
        strikes.stand(seconds, does);
        heard.extend(strikes.play(60));
        // What is on its way is played, too.
        let mut rest = vec![0.0; 20 * TICK];
        strikes.game.renderer.render(&mut [&mut vec![0.0; 20 * TICK]], &mut [&mut rest]);
        heard.extend(rest);
        heard.drain(..strikes.game.renderer.latency_samples());
        let log = strikes.game.scene.stop_recording();
        let recorded = log.lines.iter().filter(|line| matches!(line.event, LogEvent::Impact { .. })).count();
        let played = strikes.game.scene.stats().impacts;
        println!("{does:?}, {seconds} s: {recorded} recorded, {played} played");
        assert_eq!(played, recorded as u64, "{does:?}, {seconds} s");
        let Engine { mut scene, renderer, mut names, .. } =
            Config { sample_rate_hz: RATE_HZ, ..Config::default() }.build().unwrap();
        names.bodies.insert("body 0".into(), scene.add_body(block()).unwrap());
        let take = offline::render(scene, renderer, &log, &names, &Options::default()).unwrap();
        assert_eq!((take.stats.impacts, take.stats.stale), (recorded as u64, 0), "{does:?}");
        if matches!(does, Does::FadeAll | Does::Pause) {
            // What the game does to everything is an edit, which a log renders by `render_edited`.
            continue;
        }
        let replayed = &take.audio[0];
        let n = heard.len().min(replayed.len());
        let differs = (0..n).map(|i| (heard[i] - replayed[i]).abs()).fold(0.0f32, f32::max);
        assert!(f64::from(differs) < 1e-6 * peak(&heard), "{does:?}, {seconds} s: {differs}");
    }
}

#[test]
fn a_device_that_is_lost_and_comes_back_does_not_bang() {
    for (strikes_every, seconds) in [(12, 2), (3, 1), (3, 2)] {
        let Engine { mut scene, renderer, .. } = common::raw_live(RATE_HZ).build().unwrap();
        let block = scene.add_body(block()).unwrap();
        let mut device = Interleaver::new(renderer, ChannelMap::stereo_then_haptics(1));
        let began = Instant::now();
        let mut tick = 0u32;
        // Loudest of so many ticks in real time.
        let mut play = |scene: &mut Scene, ticks: u32| {
            let mut loudest = 0.0f32;
            for _ in 0..ticks {
                let due_s = f64::from(tick) / 60.0;
                let due = began + Duration::from_secs_f64(due_s);
                std::thread::sleep(due.saturating_duration_since(Instant::now()));
                if tick.is_multiple_of(strikes_every) {
                    let impact = Impact::on(block).striker(Material::STEEL, 0.01, 0.005);
                    scene.report(due_s, ContactEvent::Impact(impact)).unwrap();
                }
                tick += 1;
                loudest = loudest.max(scene.stats().bus_levels[0]);
            }
            f64::from(loudest)
        };
        let sink = NullSink::start(device, 256).unwrap();
        let usual = play(&mut scene, 60);
        device = sink.stop().unwrap().0;
        play(&mut scene, 60 * seconds);
        let sink = NullSink::start(device, 256).unwrap();
        let after = db(play(&mut scene, 60), usual);
        drop(sink);
        let stale = scene.stats().stale;
        println!("each {strikes_every} ticks, {seconds} s: {after:+.1} dB, {stale} stale");
        assert!(after <= 3.0, "each {strikes_every} ticks, {seconds} s: {after:+.1} dB");
        assert!(stale > 2, "{stale}");
        let message =
            |because: &SilenceReason| matches!(because, SilenceReason::Stale { count } if *count == stale);
        assert!(scene.why_silent().iter().any(message), "{:?}", scene.why_silent());
    }
}
