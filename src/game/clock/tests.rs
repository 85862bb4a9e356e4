//! Stamps of exact and of live clocks.

use super::*;

#[test]
fn offline_a_stamp_is_its_own_sample() {
    let mut clock = Clock::new(ClockMode::Exact, 44_100.0);
    for (t, sample, fraction) in [(0.0, 0, 0.0), (0.0167, 736, 120.0 / 256.0), (1.0, 44_100, 0.0)] {
        let stamp = clock.stamp(t, 0, false).stamp;
        assert_eq!((stamp.sample(), stamp.fraction()), (sample, fraction));
    }
}

#[test]
fn a_stamp_written_as_a_time_is_read_back_equal() {
    let mut rng = asperity_dsp::rng::Rng::new(5);
    for rate in [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0] {
        for _ in 0..10_000 {
            let stamp = Stamp::at(1e9 * rng.uniform());
            assert_eq!(
                Clock::new(ClockMode::Exact, rate).stamp(stamp.samples() / rate, 0, false).stamp,
                stamp
            );
        }
    }
}

#[test]
fn live_the_first_event_holds_at_the_next_sample() {
    let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
    assert_eq!(
        clock.stamp(1234.5, 960, false),
        Stamped { stamp: Stamp::at(960.0), jumped: false, repaced: false }
    );
}

#[test]
fn live_stamps_keep_their_distance_although_they_arrive_in_bursts() {
    let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
    let first = clock.stamp(10.0, 0, false).stamp.sample();
    // Two physics steps reported together, half a step late.
    let second = clock.stamp(10.0 + 1.0 / 60.0, 1200, false).stamp.sample();
    let third = clock.stamp(10.0 + 2.0 / 60.0, 1200, false).stamp.sample();
    assert!((second - first).abs_diff(800) <= 1);
    assert!((third - second).abs_diff(800) <= 21);
}

#[test]
fn live_a_clock_that_drifts_by_200_ppm_is_followed() {
    let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
    let mut worst = 0.0f64;
    for step in 0..20_000u64 {
        let game_s = step as f64 / 60.0;
        let position = (game_s * 48_000.0 * 1.0002) as u64;
        let lead = clock.stamp(game_s, position, false).stamp.samples() - position as f64;
        worst = worst.max(lead.abs());
    }
    assert!(worst < 48.0, "{worst} samples");
}

/// Stamps of 60 game ticks a game second at a pace, reported at 60 frames a second in blocks of
/// 256 samples.
fn leads_at_pace(pace: f64, frames: u64) -> (Clock, Vec<f64>, usize) {
    let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
    let mut jumps = 0;
    let leads = (0..frames)
        .map(|frame| {
            let position = frame * 800 / 256 * 256;
            let stamped = clock.stamp(7.0 + pace * frame as f64 / 60.0, position, false);
            jumps += usize::from(stamped.jumped);
            stamped.stamp.samples() - position as f64
        })
        .collect();
    (clock, leads, jumps)
}

#[test]
fn live_slow_motion_and_fast_motion_are_followed_within_two_seconds() {
    for pace in [0.25, 0.5, 1.0, 2.0, 3.0] {
        let (clock, leads, jumps) = leads_at_pace(pace, 600);
        assert!((clock.pace() / pace - 1.0).abs() < 0.06, "{pace}: {}", clock.pace());
        let late = leads[150..].iter().fold(0.0f64, |worst, lead| worst.max(lead.abs()));
        assert!(late < 0.06 * 48_000.0, "{pace}: {late} samples off");
        assert!(jumps <= 12, "{pace}: {jumps} jumps");
    }
}

#[test]
fn live_eight_ticks_at_once_keep_their_distance_and_tie_nothing_anew() {
    let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
    let mut last = 0.0;
    for tick in 0..800u64 {
        let position = (tick / 8 * 8 * 800) / 256 * 256;
        let stamped = clock.stamp(tick as f64 / 60.0, position, false);
        let now = stamped.stamp.samples();
        assert!(!stamped.jumped && !stamped.repaced, "tick {tick}");
        assert!(tick == 0 || (now - last - 800.0).abs() < 260.0, "tick {tick}: {}", now - last);
        last = now;
    }
}

#[test]
fn after_a_reset_the_next_stamp_holds_at_the_next_sample() {
    let mut clock = Clock::new(ClockMode::Exact, 48_000.0);
    clock.stamp(100.0, 0, false);
    clock.reset(9_600);
    assert_eq!(clock.stamp(0.0, 9_600, false).stamp, Stamp::whole(9_600));
    assert_eq!(clock.stamp(0.5, 9_728, false).stamp, Stamp::whole(33_600));
}

#[test]
fn live_strikes_that_come_late_and_at_once_keep_their_distance() {
    let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
    for tick in 0..60u64 {
        clock.stamp(tick as f64 / 60.0, tick * 800, false);
    }
    // Three ticks late, and all at once.
    let at = |clock: &mut Clock, tick: u64| {
        let stamp = clock.stamp(tick as f64 / 60.0, 50_400, true).stamp;
        clock.note_strike(stamp);
        stamp.samples().max(50_400.0)
    };
    let sounds = [60, 62, 63].map(|tick| at(&mut clock, tick));
    assert!(sounds[0] == 50_400.0 && (sounds[1] - sounds[0] - 1600.0).abs() < 1.0, "{sounds:?}");
    assert!((sounds[2] - sounds[1] - 800.0).abs() < 1.0, "{sounds:?}");
}

#[test]
fn a_live_game_that_stalls_or_skips_stays_in_order() {
    let mut clock = Clock::new(ClockMode::LIVE, 48_000.0);
    clock.stamp(0.0, 0, false);
    let tied = |sample| Stamped { stamp: Stamp::at(sample), jumped: true, repaced: false };
    assert_eq!(clock.stamp(0.01, 96_000, false), tied(96_000.0));
    assert_eq!(clock.stamp(500.0, 96_064, false), tied(96_064.0));
    assert_eq!(clock.stamp(0.0, 96_128, false), tied(96_128.0));
}
