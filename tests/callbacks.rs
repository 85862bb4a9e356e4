//! Callbacks as engines really call them, from public reports: told twice, told late, told never,
//! told of the wrong body; pools, scales, networks.

use crate::common;

use asperity::{
    ActuatorSettings, Body, BodyId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Impact,
    Material, SilenceReason, Stats, Stock,
};
use common::game::{Game, TICK_S, block};
use common::{SIDE_M, peak, rms};

const RATE_HZ: f64 = 48_000.0;
const TICK: usize = 800;

/// Actions of the tests' game beside reports.
impl Game {
    fn live() -> Self {
        let si = ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() };
        Self::new(Config { actuators: vec![si], ..common::raw_live(RATE_HZ) })
    }

    fn strike(&mut self, body: BodyId, speed_m_s: f64) {
        self.report(blow(body, speed_m_s));
    }

    fn strike_block(&mut self, speed_m_s: f64) {
        self.strike(self.block, speed_m_s);
    }

    /// A report of a stroke along u.
    fn stroke(&mut self, contact: u64, speed_m_s: f64, begins: bool) {
        self.touch(contact, along(self.now_s(), speed_m_s), begins);
    }

    /// Ticks, each with the game's part in it; returns the heard and the felt samples.
    fn run(&mut self, ticks: u32, mut does: impl FnMut(&mut Self, u32)) -> (Vec<f32>, Vec<f32>) {
        let (mut heard, mut felt) = (Vec::new(), Vec::new());
        for tick in 0..ticks {
            does(self, tick);
            let (mut haptic, mut audio) = ([0.0; TICK], [0.0; TICK]);
            self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            self.tick += 1;
            heard.extend(audio);
            felt.extend(haptic);
        }
        (heard, felt)
    }

    fn stats(&self) -> Stats {
        self.scene.stats()
    }

    fn says(&self, what: impl Fn(&SilenceReason) -> bool) -> bool {
        self.scene.why_silent().iter().any(what)
    }
}

fn blow(body: BodyId, speed_m_s: f64) -> ContactEvent {
    ContactEvent::Impact(Impact::on(body).striker(Material::STEEL, 0.01, 0.005).at_speed(speed_m_s))
}

fn along(time_s: f64, speed_m_s: f64) -> ContactSample {
    ContactSample::new([0.1 + speed_m_s * time_s / SIDE_M, 0.5], 0.6).sliding([speed_m_s, 0.0])
}

fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// One strike alone.
fn alone(speed_m_s: f64) -> Vec<f32> {
    let mut game = Game::live();
    game.run(30, |game, tick| {
        if tick == 0 {
            game.strike_block(speed_m_s);
        }
    })
    .0
}

#[test]
fn a_collision_reported_four_times_sounds_once_within_the_least_time() {
    // Once for each collider and each side: both of a pair tell the other.
    for (least_time_s, wanted_db, too_soon) in [(0.0, 12.0, 0), (0.03, 0.0, 3)] {
        let mut game = Game::live();
        let body = game.scene.add_body(block().least_time_s(least_time_s)).unwrap();
        let heard = game.run(30, |game, tick| {
            if tick == 0 {
                (0..4).for_each(|_| game.strike(body, 1.0));
            }
        });
        let louder = db(peak(&heard.0) / peak(&alone(1.0)));
        assert!((louder - wanted_db).abs() < 0.2, "{least_time_s} s: {louder} dB");
        assert_eq!(game.stats().too_soon, too_soon);
    }
}

#[test]
fn uncleared_events_sound_once_within_the_least_time() {
    // A queue of events that is read but not emptied tells a strike again in each of three ticks.
    let mut game = Game::live();
    let body = game.scene.add_body(block().least_time_s(0.1)).unwrap();
    let heard = game.run(30, |game, tick| {
        if tick < 3 {
            game.strike(body, 1.0);
        }
    });
    assert!((db(peak(&heard.0) / peak(&alone(1.0)))).abs() < 0.2);
    assert_eq!((game.stats().impacts, game.stats().too_soon), (1, 2));
}

#[test]
fn a_weak_blow_never_cuts_a_strong_one_off() {
    let mut game = Game::live();
    let both = game.run(30, |game, tick| match tick {
        0 => game.strike_block(1.0),
        3 => game.strike_block(0.01),
        _ => {}
    });
    let (one, weak) = (alone(1.0), alone(0.01));
    let left: Vec<f32> = both.0.iter().zip(&one).map(|(both, one)| both - one).collect();
    let added = db(peak(&left) / peak(&weak));
    assert!(added.abs() < 0.2, "the strong one stays, the weak one comes to it: {added} dB");
}

#[test]
fn a_blow_twice_as_fast_is_six_decibels_louder() {
    let louder = db(peak(&alone(0.2)) / peak(&alone(0.1)));
    assert!((5.0..9.0).contains(&louder), "{louder} dB");
    assert_eq!(peak(&alone(0.0)), 0.0);
}

#[test]
fn a_body_that_is_told_to_strike_itself_sounds_as_struck_once() {
    let mut game = Game::live();
    let block = game.block;
    let heard = game.run(30, |game, tick| {
        if tick == 0 {
            let impact = Impact::on(block).striker(Material::STEEL, 0.01, 0.005).at_speed(1.0);
            game.report(ContactEvent::Impact(Impact { other: Some(block), ..impact }));
        }
    });
    assert!(db(peak(&heard.0) / peak(&alone(1.0))).abs() < 0.1);
}

#[test]
fn no_mass_and_infinite_mass_are_refused_in_words() {
    let mut game = Game::live();
    for mass_kg in [0.0, f64::INFINITY, f64::NAN, -1.0] {
        let impact = Impact::on(game.block).striker(Material::STEEL, mass_kg, 0.005).at_speed(1.0);
        let error = game.scene.report(0.0, ContactEvent::Impact(impact)).unwrap_err().to_string();
        assert!(error.contains("mass_kg"), "{error}");
    }
    assert!(game.says(|because| matches!(because, SilenceReason::Refused { count: 4, .. })));
}

#[test]
fn a_slide_reported_by_both_sides_is_loud_as_two() {
    let level = |ids: [u64; 2]| {
        let mut game = Game::live();
        let (heard, felt) = game.run(90, |game, tick| {
            for id in ids {
                game.stroke(id, 0.1, tick == 0);
            }
        });
        (db(rms(&heard[48_000..])), db(rms(&felt[48_000..])), game.stats())
    };
    let (once, felt_once, _) = level([1, 1]);
    let (twice, felt_twice, stats) = level([1, 2]);
    println!("told twice: heard {:+.1} dB, felt {:+.1} dB", twice - once, felt_twice - felt_once);
    assert!((twice - once).abs() < 7.0 && stats.contacts == 2);
}

#[test]
fn an_end_in_every_frame_is_harmless_and_a_lost_begin_reported() {
    let mut game = Game::live();
    game.run(60, |game, tick| {
        if tick < 10 {
            game.stroke(1, 0.1, tick == 0);
        } else {
            game.report(ContactEvent::end(ContactId(1)));
        }
    });
    assert_eq!(game.stats().contacts, 0);
    let mut game = Game::live();
    let (heard, _) = game.run(60, |game, _| game.stroke(7, 0.1, false));
    assert_eq!(peak(&heard), 0.0);
    assert!(game.says(|because| matches!(because, SilenceReason::Orphaned { .. })));
}

#[test]
fn a_controller_whose_end_is_lost_stops_within_half_a_second() {
    let mut game = Game::live();
    game.run(30, |game, tick| game.stroke(1, 0.1, tick == 0));
    let (_, felt) = game.run(60, |_, _| ());
    assert!(peak(&felt[..6 * TICK]) > 0.0 && peak(&felt[30 * TICK..]) < 1e-9);
    assert!(game.says(|because| matches!(because, SilenceReason::Lapsed { count: 1, .. })));
}

#[test]
fn haptics_after_ten_minutes_are_those_of_the_first() {
    let mut game = Game::live();
    let mut to_and_fro = |ticks: u32, base: u32| {
        game.run(ticks, |game, tick| {
            let turns = (base + tick) / 60;
            let t = f64::from((base + tick) % 60) * TICK_S;
            let (way, sign) = if turns.is_multiple_of(2) { (t, 1.0) } else { (1.0 - t, -1.0) };
            let sample = ContactSample::new([0.1 + 0.1 * way / SIDE_M, 0.5], 0.6).sliding([0.1 * sign, 0.0]);
            let event = if base + tick == 0 {
                ContactEvent::begin(ContactId(1), game.surface, ChannelId(0), sample)
            } else {
                ContactEvent::moved(ContactId(1), sample)
            };
            game.report(event);
        })
        .1
    };
    let first = rms(&to_and_fro(240, 0)[48_000..]);
    for minute in 0..10 {
        to_and_fro(3600, 240 + 3600 * minute);
    }
    let last = rms(&to_and_fro(240, 240 + 36_000)[48_000..]);
    assert!(db(last / first).abs() < 0.5, "{} dB", db(last / first));
}

#[test]
fn a_thousand_bodies_through_a_pool_play_and_keep_no_place() {
    let mut game = Game::live();
    let (heard, _) = game.run(1000, |game, _| {
        let body = game.scene.add_body(block()).unwrap();
        game.strike(body, 0.2);
        game.scene.remove_body(body).unwrap();
    });
    let loud = heard.chunks(10 * TICK).all(|part| peak(part) > 0.1 * peak(&alone(0.2)));
    assert!(loud && game.stats().impacts >= 999, "{:?}", game.stats().impacts);
}

#[test]
fn places_at_30_hz_reported_at_120_are_felt_as_strokes() {
    // A network interpolates; the collider behind it moves in steps.
    let felt = |stair: bool| {
        let mut game = Game::live();
        let (_, felt) = game.run(120, |game, tick| {
            for half in 0..2 {
                let now_s = game.now_s() + 0.5 * TICK_S * f64::from(half);
                let at_s = if stair { (now_s * 30.0).floor() / 30.0 } else { now_s };
                let sample = along(at_s, 0.1);
                let event = if tick == 0 && half == 0 {
                    ContactEvent::begin(ContactId(1), game.surface, ChannelId(0), sample)
                } else {
                    ContactEvent::moved(ContactId(1), sample)
                };
                game.scene.report(now_s, event).unwrap();
            }
        });
        (rms(&felt[48_000..]), peak(&felt[48_000..]))
    };
    let (smooth, stair) = (felt(false), felt(true));
    println!("stair: rms {:+.1} dB, peak {:+.1} dB", db(stair.0 / smooth.0), db(stair.1 / smooth.1));
    assert!(db(stair.0 / smooth.0).abs() < 3.0 && db(stair.1 / smooth.1).abs() < 4.0);
}

#[test]
fn a_hand_frozen_for_two_seconds_and_moved_is_no_blow() {
    let mut game = Game::live();
    let (_, usual) = game.run(60, |game, tick| game.stroke(1, 0.1, tick == 0));
    // Updates stay away; the game stands at the last place and tells it.
    let held = along(game.now_s(), 0.1);
    game.run(120, |game, _| {
        let rests = ContactSample { velocity_m_s: Some([0.0, 0.0]), ..held };
        game.report(ContactEvent::moved(ContactId(1), rests));
    });
    let (_, after) = game.run(60, |game, _| game.stroke(1, 0.1, false));
    let louder = db(peak(&after) / peak(&usual[TICK * 10..]));
    assert!(louder < 3.0, "{louder} dB");
}

#[test]
fn a_thing_that_is_put_back_at_its_start_stops_sounding_there() {
    let mut game = Game::live();
    let (before, _) = game.run(60, |game, tick| game.stroke(1, 0.3, tick == 0));
    let (after, _) = game.run(60, |game, _| {
        let sample = ContactSample::new([0.1, 0.5], 0.6).sliding([0.0, 0.0]);
        game.report(ContactEvent::moved(ContactId(1), sample));
    });
    let softer = db(rms(&after[24_000..]).max(1e-12) / rms(&before[24_000..]));
    assert!(softer < -60.0, "{softer} dB");
    assert!(peak(&after) < 2.0 * peak(&before[24_000..]));
}

#[test]
fn a_pinched_thing_buzzes_no_louder_than_its_blows() {
    let mut game = Game::live();
    let (heard, _) = game.run(120, |game, _| {
        game.strike_block(0.3);
        game.strike_block(0.3);
    });
    let louder = db(peak(&heard) / peak(&alone(0.3)));
    println!("120 blows a second: {louder:+.1} dB over one");
    let mut game = Game::live();
    let body = game.scene.add_body(block().least_time_s(0.06)).unwrap();
    let (heard, _) = game.run(120, |game, _| (0..2).for_each(|_| game.strike(body, 0.3)));
    let calmer = db(peak(&heard) / peak(&alone(0.3)));
    assert!(louder < 12.0 && calmer < 1.5, "{louder} dB, {calmer} dB");
}

#[test]
fn a_missing_controller_is_refused_and_a_resting_one_is_muted() {
    let mut game = Game::live();
    let begin = ContactEvent::begin(ContactId(1), game.surface, ChannelId(1), along(0.0, 0.1));
    let error = game.scene.report(0.0, begin).unwrap_err().to_string();
    assert!(error.contains('1'), "{error}");
    game.scene.set_haptic_gain(ChannelId(0), 0.0).unwrap();
    let (heard, felt) = game.run(60, |game, tick| game.stroke(1, 0.1, tick == 0));
    assert!(peak(&felt[12 * TICK..]) < 1e-12 && peak(&heard) > 0.0);
}

#[test]
fn an_entity_with_impacts_off_is_silent_beside_its_neighbour() {
    let mut game = Game::live();
    let quiet = game.scene.add_body(block()).unwrap();
    game.scene.set_body_gain(quiet, 0.0).unwrap();
    let (heard, _) = game.run(20, |game, tick| {
        if tick == 5 {
            game.strike(quiet, 1.0);
        }
    });
    assert!(peak(&heard) < 1e-9);
    let (heard, _) = game.run(20, |game, tick| {
        if tick == 0 {
            game.strike_block(1.0);
        }
    });
    assert!(peak(&heard) > 0.0);
}

#[test]
fn a_huge_thing_is_added_and_heard_or_refused() {
    for size in [300.0, 0.02] {
        let mut game = Game::live();
        match Body::stock(Stock::Block, Material::WOOD, 0.1 * size) {
            Ok(body) => {
                let body = match game.scene.add_body(body) {
                    Ok(body) => body,
                    Err(error) => {
                        assert!(error.to_string().contains("mass_kg"), "{error}");
                        continue;
                    }
                };
                let (heard, _) = game.run(60, |game, tick| {
                    if tick == 0 {
                        game.strike(body, 1.0);
                    }
                });
                assert!(heard.iter().all(|x| x.is_finite()), "x {size}");
                println!("x {size}: {:.1} dB", db(peak(&heard).max(1e-12)));
            }
            Err(error) => assert!(error.to_string().contains("size_m"), "{error}"),
        }
    }
}

#[test]
fn negative_and_repeated_times_are_followed() {
    let mut game = Game::live();
    let mut heard = 0.0f64;
    for k in 0..120 {
        let t = -10.0 + f64::from(k / 2 * 2) * TICK_S;
        if k % 12 == 0 {
            let strikes = blow(game.block, 1.0);
            game.scene.report(t, strikes).unwrap();
        }
        let (mut haptic, mut audio) = ([0.0; TICK], [0.0; TICK]);
        game.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        heard = heard.max(peak(&audio));
    }
    let stats = game.stats();
    assert_eq!((stats.impacts, stats.refused), (10, 0));
    assert!(db(heard / peak(&alone(1.0))).abs() < 3.0);
}

#[test]
fn a_hundred_things_that_land_in_one_tick_are_each_struck() {
    let mut game = Game::live();
    let bodies: Vec<BodyId> = (0..100).map(|_| game.scene.add_body(block()).unwrap()).collect();
    let (heard, _) = game.run(30, |game, tick| {
        if tick == 0 {
            bodies.iter().for_each(|body| game.strike(*body, 0.1));
        }
    });
    assert_eq!(game.stats().impacts, 100);
    assert!(heard.iter().all(|x| x.is_finite()) && peak(&heard) > 0.0);
}

#[test]
fn a_begin_repeated_without_an_end_continues_one_contact() {
    let level = |again_every: u32| {
        let mut game = Game::live();
        let (heard, felt) = game.run(120, |game, tick| game.stroke(1, 0.1, tick % again_every == 0));
        assert_eq!(game.stats().contacts, 1);
        (rms(&heard[48_000..]), peak(&felt[48_000..]))
    };
    let (once, again) = (level(1000), level(20));
    println!("heard {:+.1} dB, felt peak {:+.1} dB", db(again.0 / once.0), db(again.1 / once.1));
    assert!(db(again.0 / once.0).abs() < 1.5 && db(again.1 / once.1) < 3.0);
}

#[test]
fn a_body_with_a_least_time_sounds_again_while_game_time_stands() {
    // A menu over a game whose time scale is 0.
    let mut game = Game::live();
    let body = game.scene.add_body(block().least_time_s(0.1)).unwrap();
    let mut heard = Vec::new();
    for tick in 0..60 {
        if tick % 30 == 0 {
            game.scene.report(5.0, blow(body, 1.0)).unwrap();
        }
        let (mut haptic, mut audio) = ([0.0; TICK], [0.0; TICK]);
        game.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        heard.extend(audio);
    }
    assert_eq!((game.stats().impacts, game.stats().too_soon), (2, 0));
    assert!(peak(&heard[30 * TICK..]) > 0.5 * peak(&heard[..30 * TICK]));
}
