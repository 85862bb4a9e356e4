//! A finger that rests in sand: its print, what it feels, and that nothing hits it.

use crate::common;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::{Options, Render};
use asperity::surface::sand::{SandDesign, SandLaw, SandSource};
use asperity::{ContactBlock, Surface, Tap};
use common::{render_tapped, si_config};

const SIDE_M: f64 = 0.1;
const DEPTH_M: f64 = 0.05;
const RATE_HZ: f64 = 44_100.0;

/// Sand that stands steeply, so that a print is still there when the finger is lifted.
fn bed() -> SandDesign {
    SandDesign {
        width_m: SIDE_M,
        height_m: SIDE_M,
        cells: 256,
        depth_m: DEPTH_M,
        talus_deg: 80.0,
        ..SandDesign::default()
    }
}

/// A finger that drags along u for a while, and then stays where it is.
#[derive(Clone, Copy)]
struct Hand {
    normal_force_n: f64,
    begins_s: f64,
    drags_m_s: f64,
    drags_s: f64,
    rests_s: f64,
    reports_hz: f64,
}

impl Hand {
    fn rests(normal_force_n: f64, begins_s: f64, rests_s: f64) -> Self {
        Self { normal_force_n, begins_s, drags_m_s: 0.0, drags_s: 0.0, rests_s, reports_hz: 60.0 }
    }

    fn log(&self) -> ContactLog {
        let steps = ((self.drags_s + self.rests_s) * self.reports_hz).round() as usize;
        let sample = |step: usize| {
            let t = step as f64 / self.reports_hz;
            let moves = t < self.drags_s;
            ContactSample {
                uv: [0.303 + self.drags_m_s * t.min(self.drags_s) / SIDE_M, 0.517],
                velocity_m_s: Some([if moves { self.drags_m_s } else { 0.0 }, 0.0]),
                normal_force_n: self.normal_force_n,
                closing_m_s: 0.0,
                ..ContactSample::default()
            }
        };
        let at = |step: usize| self.begins_s + step as f64 / self.reports_hz;
        let begin = LogEvent::begin(1, "s", 0, sample(0));
        let mut lines = vec![LogLine { t: self.begins_s, event: begin }];
        let moved = |step: usize| LogLine { t: at(step), event: LogEvent::moved(1, sample(step)) };
        lines.extend((1..=steps).map(moved));
        lines.push(LogLine { t: at(steps), event: LogEvent::End { contact: 1 } });
        ContactLog { lines }
    }

    /// From when on nothing moves any more: the path's filter has settled.
    fn still_s(&self) -> f64 {
        self.begins_s + if self.drags_s > 0.0 { self.drags_s + 0.15 } else { 0.0 }
    }
}

/// Contact force and profile, sample by sample, while the contact lasts.
#[derive(Default)]
struct Felt {
    rows: Vec<(u64, f64, f64)>,
    speeds_m_s: Vec<(u64, f64)>,
}

impl Tap for Felt {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        let rows = block.contact_samples.iter().enumerate();
        self.rows
            .extend(rows.map(|(i, row)| (block.first_sample + i as u64, row.contact_force_n, row.height_m)));
        let speeds = block.velocity_m_s.iter().map(|[u, v]| u.hypot(*v));
        self.speeds_m_s.extend((block.first_sample..).zip(speeds));
    }
}

fn touch(design: &SandDesign, hand: &Hand) -> (Render, Felt) {
    let sand = SandSource::synchronous(design, 1).unwrap();
    let surface = Surface::new(sand, SIDE_M, SIDE_M).unwrap().wraps(false);
    let mut felt = Felt::default();
    let options = Options { tail_s: 0.1, ..Options::default() };
    let render = render_tapped(si_config(), surface, &hand.log(), &options, &mut felt);
    (render, felt)
}

/// The print is as deep as the law says, the resting finger is pressed by what presses it, and
/// feels no blow on the way there.
fn assert_at_rest(name: &str, design: &SandDesign, hand: &Hand, blow: f64) {
    let (render, felt) = touch(design, hand);
    let depth_m = design.law.depth_m(hand.normal_force_n).min(design.depth_m);
    let print_m = design.depth_m - render.sand[0].picture.lowest_m;
    let end_s = hand.begins_s + hand.drags_s + hand.rests_s;
    let worst = |from_s: f64| {
        let rows = felt.rows.iter().filter(|(sample, ..)| {
            let t = *sample as f64 / RATE_HZ;
            t >= from_s && t < end_s
        });
        rows.fold((0.0_f64, 0), |(worst, n), row| {
            (worst.max((row.1 / hand.normal_force_n - 1.0).abs()), n + 1)
        })
    };
    let ((at_rest, rows), (all, _)) = (worst(hand.still_s()), worst(0.0));
    let off = print_m / depth_m - 1.0;
    println!(
        "{name}: print {:+.3} % off, force at rest {:.2} %, ever {:.0} %",
        1e2 * off,
        1e2 * at_rest,
        1e2 * all
    );
    assert!(rows > 1000);
    assert!(off.abs() < 0.01, "{name}: a print of {print_m} m for a law of {depth_m} m");
    assert!(at_rest < 0.05, "{name}: {at_rest} of the pressed force besides it");
    assert!(all < blow, "{name}: a blow of {all} times the pressed force");
}

#[test]
fn a_resting_finger_prints_the_sand_without_a_blow() {
    let cases =
        [(1.0, 0, 0.2), (3.0, 32, 0.2), (3.0, 64, 1.0), (6.0, 4410, 0.2), (2.3, 1001, 2.0), (4.7, 65, 0.4)];
    for (force_n, sample, rests_s) in cases {
        let hand = Hand::rests(force_n, sample as f64 / RATE_HZ, rests_s);
        assert_at_rest(&format!("{force_n} N from sample {sample} for {rests_s} s"), &bed(), &hand, 0.05);
    }
}

#[test]
fn the_felt_print_is_reported_though_sand_slides_into_it() {
    // The default bed stands at 30 degrees: what is steeper slides once the finger has left.
    let design = SandDesign { talus_deg: SandDesign::default().talus_deg, ..bed() };
    for force_n in [1.0, 3.0, 6.0] {
        let (render, _) = touch(&design, &Hand::rests(force_n, 0.01, 0.3));
        let off = render.sand[0].figures.print_m / design.law.depth_m(force_n) - 1.0;
        let left_m = design.depth_m - render.sand[0].picture.lowest_m;
        println!("{force_n} N: print {:+.3} % off, {:.2} mm of it left", 1e2 * off, 1e3 * left_m);
        assert!(off.abs() < 0.01, "{force_n} N: {off}");
        assert!(left_m <= render.sand[0].figures.print_m);
    }
}

#[test]
fn a_finger_that_stops_dragging_leaves_its_print_and_no_blow() {
    for (normal_force_n, drags_m_s, reports_hz) in [(1.5, 0.08, 60.0), (3.0, 0.13, 90.0), (6.0, 0.05, 144.0)]
    {
        let hand =
            Hand { normal_force_n, begins_s: 0.0137, drags_m_s, drags_s: 0.25, rests_s: 0.6, reports_hz };
        // While it drags, grains and heaps are felt; the blow was 55 times the force.
        assert_at_rest(&format!("{normal_force_n} N at {drags_m_s} m/s"), &bed(), &hand, 0.5);
    }
}

/// Largest contact force over the pressed one and largest haptic sample between two instants, and
/// the fastest speed there.
fn hardest(render: &Render, felt: &Felt, force_n: f64, (from_s, until_s): (f64, f64)) -> (f64, f64, f64) {
    let within = |sample: u64| (from_s..until_s).contains(&(sample as f64 / RATE_HZ));
    let rows = felt.rows.iter().filter(|(sample, ..)| within(*sample));
    let most = rows.fold(0.0f64, |most, row| most.max(row.1 / force_n));
    let fast = felt.speeds_m_s.iter().filter(|(sample, _)| within(*sample));
    let fastest = fast.fold(0.0f64, |most, row| most.max(row.1));
    let haptic = &render.haptic[0][(from_s * RATE_HZ) as usize..(until_s * RATE_HZ) as usize];
    (most, common::peak(haptic), fastest)
}

#[test]
fn a_finger_stopped_dead_in_sand_is_not_hit_at_30_hz() {
    let cases = [
        (1.5, 0.1, 30.0),
        (1.5, 0.5, 30.0),
        (3.0, 0.5, 30.0),
        (6.0, 0.5, 30.0),
        (1.5, 0.5, 60.0),
        (3.0, 0.3, 90.0),
    ];
    for (normal_force_n, drags_m_s, reports_hz) in cases {
        let drags_s = f64::min(0.3, 0.055 / drags_m_s);
        let hand = Hand { normal_force_n, begins_s: 0.0137, drags_m_s, drags_s, rests_s: 0.6, reports_hz };
        let (render, felt) = touch(&bed(), &hand);
        let stops_s = hand.begins_s + (drags_s * reports_hz).ceil() / reports_hz;
        let stroke = hardest(&render, &felt, normal_force_n, (hand.begins_s + 0.02, stops_s));
        let stop = hardest(&render, &felt, normal_force_n, (stops_s, hand.begins_s + drags_s + 0.59));
        println!(
            "{normal_force_n} N, {drags_m_s} m/s, {reports_hz} Hz: stroke {:.2} x the force, {:.1} um; stop {:.2} x, {:.1} um, {:.2} x the speed",
            stroke.0,
            1e6 * stroke.1,
            stop.0,
            1e6 * stop.1,
            stop.2 / drags_m_s
        );
        assert!(
            stop.1 <= 2.0 * stroke.1,
            "{normal_force_n} N, {drags_m_s} m/s: {} m after {} m",
            stop.1,
            stroke.1
        );
        assert!(stop.0 <= 2.0 * stroke.0 && stop.2 <= 1.5 * drags_m_s, "{stop:?} after {stroke:?}");
    }
}

/// A finger that goes to and fro in its own furrow reads the level around it and not the furrow's
/// bottom.
#[test]
fn a_finger_returning_in_its_furrow_does_not_fall_every_frame() {
    for (normal_force_n, drags_m_s) in [(1.5, 0.1), (1.5, 0.4), (3.0, 0.4)] {
        let there_s = 0.05 / drags_m_s;
        let there = Hand {
            normal_force_n,
            begins_s: 0.0,
            drags_m_s,
            drags_s: there_s,
            rests_s: 0.3,
            reports_hz: 120.0,
        };
        let mut log = there.log();
        log.lines.pop();
        let (back_from_s, step_s) = (there_s + 0.3, 1.0 / 120.0);
        for step in 1..=((there_s + 0.3) / step_s) as usize {
            let t = step as f64 * step_s;
            let moves = t < there_s;
            let sample = ContactSample {
                uv: [0.303 + (0.05 - drags_m_s * t.min(there_s)) / SIDE_M, 0.517],
                velocity_m_s: Some([if moves { -drags_m_s } else { 0.0 }, 0.0]),
                normal_force_n,
                closing_m_s: 0.0,
                ..ContactSample::default()
            };
            log.lines.push(LogLine { t: back_from_s + t, event: LogEvent::moved(1, sample) });
        }
        let until_s = log.lines.last().map_or(0.0, |line| line.t);
        log.lines.push(LogLine { t: until_s, event: LogEvent::End { contact: 1 } });
        let sand = SandSource::synchronous(&bed(), 1).unwrap();
        let surface = Surface::new(sand, SIDE_M, SIDE_M).unwrap().wraps(false);
        let mut felt = Felt::default();
        let options = Options { tail_s: 0.1, ..Options::default() };
        let render = render_tapped(si_config(), surface, &log, &options, &mut felt);
        let there = hardest(&render, &felt, normal_force_n, (0.02, there_s));
        let back = hardest(&render, &felt, normal_force_n, (back_from_s, back_from_s + there_s));
        println!(
            "{normal_force_n} N, {drags_m_s} m/s: there {:.2} x, {:.1} um; back {:.2} x, {:.1} um",
            there.0,
            1e6 * there.1,
            back.0,
            1e6 * back.1
        );
        // It was 4.8 times as much at 0.4 m/s.
        assert!(back.1 <= 2.0 * there.1, "{} m back, {} m there", back.1, there.1);
        assert!(back.0 < 1.5 * there.0, "{back:?} after {there:?}");
    }
}

#[test]
fn curved_sand_is_one_law_for_the_finger_and_its_print() {
    let law = SandLaw { stiffness_n: 2.0, exponent_per_m: 300.0, ..SandLaw::default() };
    let design = SandDesign { law, ..bed() };
    for force_n in [1.0, 6.0] {
        let hand = Hand::rests(force_n, 0.01, 0.3);
        assert_at_rest(&format!("curved, {force_n} N"), &design, &hand, 0.05);
        let (_, felt) = touch(&design, &hand);
        let (.., height_m) = felt.rows[felt.rows.len() / 2];
        // Grains are up to 0.1 mm high.
        assert!((height_m + law.depth_m(force_n)).abs() < 1e-4, "{height_m} m under {force_n} N");
    }
}

#[test]
fn a_bed_has_a_bottom_that_carries_what_the_sand_does_not() {
    let law = SandLaw { stiffness_n: 5.0, ..SandLaw::default() };
    let design = SandDesign { depth_m: 0.01, law, ..bed() };
    assert!(law.depth_m(40.0) > 1.0);
    let (render, felt) = touch(&design, &Hand::rests(40.0, 0.01, 0.3));
    let (_, force_n, height_m) = felt.rows[felt.rows.len() / 2];
    assert!((height_m + 0.01).abs() < 1e-4 && (force_n - 40.0).abs() < 0.4, "{height_m} m, {force_n} N");
    assert_eq!(render.sand[0].picture.lowest_m, 0.0);
    assert_eq!(render.stats.quarantined, 0);
}

#[test]
fn a_resting_finger_in_sand_wakes_when_another_moves_the_sand() {
    // The second finger drags past the first one, 6 mm beside it.
    let mut log = Hand::rests(2.0, 0.0, 1.0).log();
    let by = Hand { begins_s: 0.4, drags_m_s: 0.2, drags_s: 0.2, rests_s: 0.1, ..Hand::rests(2.0, 0.0, 0.0) };
    let beside = by.log().lines.into_iter().map(|line| {
        let aside =
            |sample: ContactSample| ContactSample { uv: [sample.uv[0] - 0.2, sample.uv[1] + 0.06], ..sample };
        let event = match line.event {
            LogEvent::Begin { touching, sample, .. } => {
                LogEvent::Begin { contact: 2, touching, sample: aside(sample) }
            }
            LogEvent::Move { sample, .. } => LogEvent::moved(2, aside(sample)),
            _ => LogEvent::End { contact: 2 },
        };
        LogLine { event, ..line }
    });
    log.lines.extend(beside);
    log.lines.sort_by(|a, b| a.t.total_cmp(&b.t));
    let sand = || {
        let source = SandSource::synchronous(&bed(), 1).unwrap();
        Surface::new(source, SIDE_M, SIDE_M).unwrap().wraps(false)
    };
    let run = |block_frames| {
        let options = Options { tail_s: 0.1, block_frames, ..Options::default() };
        let mut felt = Felt::default();
        (render_tapped(si_config(), sand(), &log, &options, &mut felt), felt)
    };
    let (render, felt) = run(256);
    let hardest_n = felt.rows.iter().fold(0.0_f64, |most, row| most.max(row.1));
    assert!(hardest_n < 4.0, "{hardest_n} N for 2 N pressed");
    // Whoever sleeps and wakes does so on absolute samples.
    let (split, _) = run(37);
    assert_eq!((render.audio, render.haptic), (split.audio, split.haptic));
}
