//! Reports as physics engines and trackers make them: steps without force, hitches, lost reports,
//! slow first intervals, velocities that are always zero, teleports. None of it may be felt as a
//! blow.

use crate::common;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::offline::{Options, Render};
use asperity::{Config, ContactBlock, Extent, Probe, SilenceReason, Surface, Tap, Wrap, probe_by_name};
use asperity_dsp::rng::Rng;
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use common::{SIDE_M, peak, plate, render_tapped, si_config, stroke};

const SPEED_M_S: f64 = 0.1;
const FORCE_N: f64 = 0.6;
const RATE_HZ: f64 = 44_100.0;
/// After the beginning, before the end.
const MIDDLE: std::ops::Range<usize> = 13_230..83_790;

/// The hardest and the fastest that contacts were.
#[derive(Default)]
struct Hardest {
    force_n: f64,
    speed_m_s: f64,
    /// By the positions, as a reader of the trace sees it: a step is a speed too.
    shown_m_s: f64,
    /// The latest sample and where the contact was.
    last: Option<(u64, [f64; 2])>,
}

impl Tap for Hardest {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        let rows = block.contact_samples.iter().zip(block.velocity_m_s);
        for (i, (row, [u, v])) in rows.enumerate() {
            if MIDDLE.contains(&(block.first_sample as usize + i)) {
                self.force_n = self.force_n.max(row.contact_force_n);
                self.speed_m_s = self.speed_m_s.max(u.hypot(*v));
            }
        }
        for (sample, at_m) in (block.first_sample..).zip(block.position_m) {
            if let Some((before, was_m)) = self.last
                && before + 1 == sample
                && MIDDLE.contains(&(sample as usize))
            {
                let way_m = (at_m[0] - was_m[0]).hypot(at_m[1] - was_m[1]);
                self.shown_m_s = self.shown_m_s.max(way_m * RATE_HZ);
            }
            self.last = Some((sample, *at_m));
        }
    }
}

/// 4 mm of smooth hills, 47 mm from one to the next.
fn hills() -> Surface {
    let width = 384;
    let height = |i: usize| 2e-3 * (6.0 * std::f64::consts::PI * (i as f64 + 0.5) / width as f64).sin();
    let values = (0..width).map(height).collect::<Vec<_>>().repeat(4);
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let map = HeightMap::new(&Raster { width, height: 4, values }, extent, Wrap::Repeat).unwrap();
    Surface::new(map, SIDE_M, SIDE_M).unwrap().micro_relief_m(0.0)
}

/// Reports of one finger at 60 Hz for 2 s: `change` may alter a report or drop it.
fn reports(mut change: impl FnMut(usize, f64, &mut ContactSample) -> bool) -> ContactLog {
    let mut lines = Vec::new();
    for step in 0..120 {
        let t = step as f64 / 60.0;
        let mut sample = ContactSample {
            uv: [0.1 + SPEED_M_S * t / SIDE_M, 0.525],
            velocity_m_s: Some([SPEED_M_S, 0.0]),
            normal_force_n: FORCE_N,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let stays = change(step, t, &mut sample);
        let event = if step == 0 { LogEvent::begin(1, "s", 0, sample) } else { LogEvent::moved(1, sample) };
        if stays {
            lines.push(LogLine { t, event });
        }
    }
    lines.push(LogLine { t: 2.0, event: LogEvent::End { contact: 1 } });
    ContactLog { lines }
}

fn felt(surface: Surface, log: &ContactLog) -> (Render, Hardest) {
    let mut hardest = Hardest::default();
    let take = render_tapped(si_config(), surface, log, &Options::default(), &mut hardest);
    (take, hardest)
}

/// Largest change of the slope within a sample: what a step or a corner has and a stroke has not.
fn corner(x: &[f32]) -> f64 {
    x.windows(3)
        .map(|x| (f64::from(x[0]) - 2.0 * f64::from(x[1]) + f64::from(x[2])).abs())
        .fold(0.0, f64::max)
}

/// That `log` is felt like the clean stroke over the same surface; returns the render.
fn is_felt_like_a_stroke(what: &str, surface: fn() -> Surface, log: &ContactLog) -> Render {
    let (clean, steady) = felt(surface(), &reports(|_, _, _| true));
    let (take, hardest) = felt(surface(), log);
    let (own, now) = (&clean.haptic[0][MIDDLE], &take.haptic[0][MIDDLE]);
    println!(
        "{what}: haptic {:.2} x, force {:.2} x, speed {:.2} x, step {:.1} dB of the peak",
        peak(now) / peak(own),
        hardest.force_n / steady.force_n,
        hardest.speed_m_s / SPEED_M_S,
        20.0 * ((corner(now) - 2.0 * corner(own)).max(1e-12) / peak(own)).log10()
    );
    assert!(peak(now) <= 2.0 * peak(own), "{what}: {} m over {} m", peak(now), peak(own));
    assert!(
        hardest.force_n <= 2.0 * steady.force_n,
        "{what}: {} N over {} N",
        hardest.force_n,
        steady.force_n
    );
    assert!(hardest.speed_m_s <= 1.5 * SPEED_M_S, "{what}: {} m/s", hardest.speed_m_s);
    // While a contact jumps, two strokes are felt at once.
    let step = corner(now) - 2.0 * corner(own);
    assert!(step <= 1e-3 * peak(own), "{what}: a step of {step} m in {} m", peak(own));
    take
}

fn hilly_and_matte(what: &str, log: &ContactLog) -> Render {
    is_felt_like_a_stroke(&format!("{what}, hills"), hills, log);
    is_felt_like_a_stroke(&format!("{what}, matte"), || plate(0.9), log)
}

/// [`hilly_and_matte`] of a stroke that goes on all the while: one contact, and the places in its
/// trace go no faster.
fn goes_on(what: &str, log: &ContactLog) {
    for surface in [hills as fn() -> Surface, || plate(0.9)] {
        let take = is_felt_like_a_stroke(what, surface, log);
        let (_, hardest) = felt(surface(), log);
        assert_eq!(take.stats.jumps, 0, "{what}");
        let ratio = hardest.shown_m_s / SPEED_M_S;
        assert!(ratio <= 1.45 && ratio > 0.99, "{what}: {ratio}");
    }
}

#[test]
fn one_step_without_force_does_not_throw_the_finger() {
    let take = hilly_and_matte(
        "one empty report",
        &reports(|step, _, sample| {
            sample.normal_force_n *= f64::from(u8::from(step != 60));
            true
        }),
    );
    assert_eq!(take.stats.unpressed, 1);
}

#[test]
fn a_solver_that_reports_a_force_every_other_step_is_no_drum() {
    let take = hilly_and_matte(
        "0 and 1 N in turn",
        &reports(|step, _, sample| {
            sample.normal_force_n *= (step % 2) as f64;
            true
        }),
    );
    assert_eq!(take.stats.unpressed, 60);
}

#[test]
fn a_finger_lifted_without_an_end_fades_and_rises_on_return() {
    for empty in [2, 3, 5, 10, 14] {
        let log = reports(|step, _, sample| {
            sample.normal_force_n *= f64::from(u8::from(!(60..60 + empty).contains(&step)));
            true
        });
        let take = hilly_and_matte(&format!("{empty} empty reports"), &log);
        assert_eq!(take.stats.unpressed, empty as u64);
        assert_eq!(take.stats.orphaned, 0);
    }
}

#[test]
fn a_hitch_of_the_game_is_neither_a_zip_nor_a_blow() {
    for missing in [1, 2, 3, 4, 6, 9, 12] {
        goes_on(
            &format!("{missing} reports missing"),
            &reports(|step, _, _| !(60..60 + missing).contains(&step)),
        );
    }
}

#[test]
fn a_tenth_of_the_reports_may_get_lost() {
    for seed in 1..=4 {
        let mut rng = Rng::new(seed);
        goes_on(&format!("a tenth lost, {seed}"), &reports(|step, _, _| step == 0 || rng.uniform() > 0.1));
    }
}

#[test]
fn a_game_that_starts_slowly_does_not_hurry() {
    for every in [3, 6] {
        goes_on(&format!("{} Hz", 60 / every), &reports(|step, _, _| step % every == 0));
    }
}

#[test]
fn velocities_that_are_always_zero_make_no_landing_of_every_report() {
    goes_on(
        "zero velocities",
        &reports(|_, _, sample| {
            sample.velocity_m_s = Some([0.0; 2]);
            true
        }),
    );
}

#[test]
fn a_teleport_over_relief_is_no_blow() {
    // From the slope of one hill into the valley, and back.
    for metres in [0.008, 0.0235, 0.03, 0.22, -0.013] {
        let take = hilly_and_matte(
            &format!("teleport by {metres} m"),
            &reports(|step, _, sample| {
                if (60..75).contains(&step) {
                    sample.uv[1] += 0.3;
                    sample.uv[0] += metres / SIDE_M;
                }
                true
            }),
        );
        assert_eq!(take.stats.jumps, 2);
    }
}

#[test]
fn a_finger_that_teleports_at_every_report_is_quiet_and_ends() {
    let mut rng = Rng::new(3);
    let take = hilly_and_matte(
        "teleports only",
        &reports(|_, _, sample| {
            sample.uv = [rng.uniform(), rng.uniform()];
            true
        }),
    );
    assert!(take.stats.jumps > 100);
    assert_eq!(take.stats.contacts, 0);
}

#[test]
fn a_leaping_stick_warns_with_its_remedy_and_a_finger_does_not() {
    let over_ribs = |probe: Probe, force_n: f64| {
        let config = Config { probe, ..si_config() };
        let ribs = common::grating(2e-3, 0.5e-3);
        let take = common::render(config, ribs, &stroke(SIDE_M, 0.2, force_n, 1.0), &Options::default());
        (
            take.stats.blows,
            take.why_silent.iter().any(|reported| matches!(reported, SilenceReason::Leapt { .. })),
        )
    };
    let (blows, reported) = over_ribs(probe_by_name("rigid").unwrap(), 0.1);
    println!("{blows} blows");
    assert!(blows > 5 && reported, "{blows} blows, told: {reported}");
    assert_eq!(over_ribs(Probe::default(), FORCE_N), (0, false));
}

/// Mean of the contact's force and of what presses, over whole roofs.
struct MeanForce {
    over: std::ops::Range<u64>,
    contact_n: f64,
    pressed_n: f64,
}

impl Tap for MeanForce {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        for (sample, row) in (block.first_sample..).zip(block.contact_samples) {
            if self.over.contains(&sample) {
                self.contact_n += row.contact_force_n;
                self.pressed_n += row.normal_force_n;
            }
        }
    }
}

#[test]
fn a_probe_off_a_roofs_crest_presses_as_computed_or_is_reported() {
    let (mut reported, mut tried) = (0, 0);
    for (name, probe) in asperity::PROBE_PRESETS {
        for (roof_m, slope) in [(0.5, 0.5), (1.0, 0.5), (0.5, 0.2), (0.25, 0.1)] {
            for (speed_m_s, force_n) in [(0.3, 0.5), (1.0, 0.5), (1.0, 2.0)] {
                let width = (roof_m * 400.0) as usize;
                let height = |i: usize| {
                    let along = (i as f64 + 0.5) / width as f64;
                    0.5 * roof_m * slope * (1.0 - (2.0 * along - 1.0).abs())
                };
                let values = (0..width).map(height).collect::<Vec<_>>().repeat(4);
                let extent = Extent { width_m: roof_m, height_m: SIDE_M, relief_m: 1.0 };
                let map = HeightMap::new(&Raster { width, height: 4, values }, extent, Wrap::Repeat).unwrap();
                let roofs = Surface::new(map, roof_m, SIDE_M).unwrap().micro_relief_m(0.0);
                let roofs_s = roof_m / speed_m_s;
                let roofs_heard = (3.0 / roofs_s).ceil();
                let seconds = (roofs_heard + 2.0) * roofs_s;
                let log = stroke(roof_m, speed_m_s, force_n, seconds);
                let first = (1.5 * roofs_s * RATE_HZ) as u64;
                let over = first..first + (roofs_heard * roofs_s * RATE_HZ) as u64;
                let mut mean = MeanForce { over, contact_n: 0.0, pressed_n: 0.0 };
                let config = Config { probe, ..si_config() };
                let take = render_tapped(config, roofs, &log, &Options::default(), &mut mean);
                let off = mean.contact_n / mean.pressed_n - 1.0;
                let leapt =
                    take.why_silent.iter().any(|reported| matches!(reported, SilenceReason::Leapt { .. }));
                let what = format!("{name}, roofs of {roof_m} m, {slope} m/m, {speed_m_s} m/s, {force_n} N");
                println!("{what}: {:+.2} %, {} blows, told {leapt}", 100.0 * off, take.stats.blows);
                assert!(off.abs() <= 0.01 || leapt, "{what}: {:+.2} % and no word", 100.0 * off);
                let slow = name == "fingertip" && speed_m_s < 0.5;
                assert!(!(slow && leapt), "{what}: a slow finger stays on the ground");
                (reported, tried) = (reported + usize::from(leapt), tried + 1);
            }
        }
    }
    println!("{reported} of {tried} told");
}

#[test]
fn the_clean_stroke_is_what_the_others_are_held_to() {
    let log = stroke(SIDE_M, SPEED_M_S, FORCE_N, 2.0);
    let (take, hardest) = felt(hills(), &log);
    assert!(peak(&take.haptic[0][MIDDLE]) > 1e-6 && hardest.force_n > 0.9 * FORCE_N);
    assert_eq!((take.stats.jumps, take.stats.unpressed), (0, 0));
}
