//! Levels of engines made in code: whatever is added, its reference motions and twice their speed
//! stay within full scale, what sounds keeps its level, and content that was there costs nothing.

use crate::common::{peak, rms};
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::{
    Body, BodyId, ChannelId, ClipReason, ClockMode, Config, ContactEvent, ContactId, ContactSample, Engine,
    Impact, LevelPolicy, Material, Renderer, Scene, Stock, Surface, Touching, probe_by_name,
};
use std::path::Path;
use std::time::Instant;

fn live(levels: LevelPolicy) -> Config {
    let found = Config { levels, clock: ClockMode::default(), ..Config::live(44_100.0) };
    if levels == LevelPolicy::AsGiven { Config { levels, ..Config::default() } } else { found }
}

/// A scene and what it has played.
struct Played {
    scene: Scene,
    renderer: Renderer,
    time_s: f64,
    haptic: Vec<f32>,
    audio: Vec<f32>,
}

impl Played {
    fn new(config: Config) -> Self {
        let Engine { scene, renderer, .. } = config.build().unwrap();
        Self { scene, renderer, time_s: 0.0, haptic: Vec::new(), audio: Vec::new() }
    }

    fn body(&mut self, body: Body) -> BodyId {
        self.scene.add_body(body).unwrap()
    }

    /// A step of 1/60 s.
    fn step(&mut self, event: Option<ContactEvent>) {
        if let Some(event) = event {
            self.scene.report(self.time_s, event).unwrap();
        }
        let (mut haptic, mut audio) = ([0.0; 735], [0.0; 735]);
        self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        self.haptic.extend(haptic);
        self.audio.extend(audio);
        self.time_s += 1.0 / 60.0;
    }

    /// A slanting stroke of half a second on a surface of 1 m; the audio and the haptic samples of
    /// its settled part.
    fn stroke(&mut self, touching: Touching, force_n: f64, speed_m_s: f64) -> [Vec<f32>; 2] {
        let velocity = [0.6 * speed_m_s, -0.8 * speed_m_s];
        let mut from = 0;
        for step in 0..30 {
            let t = f64::from(step) / 60.0;
            let sample = ContactSample::new([0.05 + velocity[0] * t, 0.9 + velocity[1] * t], force_n)
                .sliding(velocity);
            let begin = ContactEvent::begin_with(ContactId(1), touching, sample);
            self.step(Some(if step == 0 { begin } else { ContactEvent::moved(ContactId(1), sample) }));
            if step == 6 {
                from = self.audio.len();
            }
        }
        let part = [self.audio[from..].to_vec(), self.haptic[from..].to_vec()];
        self.step(Some(ContactEvent::end(ContactId(1))));
        (0..6).for_each(|_| self.step(None));
        part
    }

    fn drop(&mut self, body: BodyId, mass_kg: f64, speed_m_s: f64) {
        let fallen =
            Impact { mass_kg, speed_m_s, restitution: 0.3, striker: Material::STONE, ..Impact::on(body) };
        self.step(Some(ContactEvent::Impact(fallen)));
        (0..12).for_each(|_| self.step(None));
    }
}

fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

fn ground(relief_m: f64, material: Material) -> Surface {
    Surface::flat(1.0, 1.0).unwrap().material(material).micro_relief_m(relief_m)
}

/// Numbers between 0 and 1 from a seed.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn material(number: f64) -> Material {
    Material::PRESETS[(number * Material::PRESETS.len() as f64) as usize].material
}

fn stock(number: f64) -> Stock {
    Stock::ALL[(number * Stock::ALL.len() as f64) as usize].1
}

/// A thing of 10 g to 100 kg on ground of 1 µm to 1 mm among up to two others, at reference motions
/// and twice their speed: it slides and drops, a finger and a stylus stroke. By how much limiters
/// turn down, dB.
fn limited_db(mut any: impl FnMut() -> f64) -> f64 {
    let [mass_kg, relief_m] = [10f64.powf(-2.0 + 4.0 * any()), 10f64.powf(-6.0 + 3.0 * any())];
    let mut played = Played::new(live(LevelPolicy::Shared));
    let [rigid, stylus] =
        ["rigid", "stylus"].map(|name| played.scene.add_probe(probe_by_name(name).unwrap()).unwrap());
    for _ in 0..(3.0 * any()) as usize {
        let of = material(any());
        let other = played.body(Body::stock(stock(any()), of, 0.05 + 0.7 * any()).unwrap());
        played.scene.add_surface(ground(1e-5, of).body(other)).unwrap();
    }
    let size_m = 0.3 * (mass_kg / 5.0).cbrt().clamp(0.1, 3.0);
    let thing = played.body(Body::stock(stock(any()), material(any()), size_m).unwrap());
    let floor = material(any());
    let surface = ground(relief_m, floor);
    let surface = if any() < 0.5 {
        surface.body(played.body(Body::stock(Stock::Plate, floor, 0.5).unwrap()))
    } else {
        surface
    };
    let top = played.scene.add_surface(surface).unwrap();
    for faster in [1.0, 2.0] {
        played.stroke(Touching::on(top).probe(rigid).held_by(thing), 9.81 * mass_kg, faster);
        played.drop(thing, mass_kg, 2.43 * faster);
        let finger = Touching::on(top).felt_by(ChannelId(0));
        played.stroke(finger, 1.0, 0.1 * faster);
        played.stroke(finger.probe(stylus), 1.0, 0.1 * faster);
    }
    let most = peak(&played.audio).max(peak(&played.haptic));
    assert!(most <= 1.0, "{most} over full scale");
    played.renderer.limiter_db()
}

#[test]
fn sixty_engines_without_a_gain_stay_within_full_scale() {
    let limited: Vec<f64> =
        (1..=60).map(|case| limited_db(numbers(0x9E37_79B9_7F4A_7C15 ^ (case << 40)))).collect();
    let within = limited.iter().filter(|by_db| **by_db <= 6.0).count();
    println!(
        "limiter ≤ 6 dB in {within} of 60, at most {:.1} dB",
        limited.iter().fold(0.0, |a, b| f64::max(a, *b))
    );
    assert!(within >= 54, "{within} of 60: {limited:.1?}");
}

#[test]
fn a_finger_with_its_own_level_is_within_a_decibel_of_scenes() {
    let mut worst = [0.0f64; 2];
    for (index, preset) in Material::PRESETS.iter().enumerate() {
        let relief_m = [1e-6, 2e-5, 3e-4][index % 3];
        let mut played = Played::new(live(LevelPolicy::Each));
        // Others are there, louder and softer.
        for material in [Material::STEEL, Material::RUBBER] {
            let body = played.body(Body::stock(Stock::Bar, material, 0.3).unwrap());
            played.scene.add_surface(ground(1e-3, material).body(body)).unwrap();
        }
        let body = played.body(Body::stock(Stock::Plate, preset.material, 0.14).unwrap());
        let top = played.scene.add_surface(ground(relief_m, preset.material).body(body)).unwrap();
        let stroked = played.stroke(Touching::on(top).felt_by(ChannelId(0)), 1.0, 0.1);
        let toml = format!(
            "[[body]]\nname = \"b\"\nstock = \"plate\"\nsize_m = 0.14\nmaterial = \"{}\"\n[[surface]]\nname = \"s\"\nbody = \"b\"\n\
             width_m = 1.0\nheight_m = 1.0\nmicro_relief_m = {relief_m:e}\n[[actuator]]\noutput = \"displacement\"\n",
            preset.name
        );
        let file = SceneFile::parse(&toml, Path::new("scene.toml")).unwrap();
        let Engine { scene, renderer, names, .. } = Engine::from_scene(&file, &Overrides::default()).unwrap();
        let top = names.surfaces["s"];
        let mut same = Played { scene, renderer, time_s: 0.0, haptic: Vec::new(), audio: Vec::new() };
        let from_file = same.stroke(Touching::on(top).felt_by(ChannelId(0)), 1.0, 0.1);
        for sense in 0..2 {
            let off_db = db(rms(&stroked[sense]) / rms(&from_file[sense]));
            worst[sense] = worst[sense].max(off_db.abs());
            if off_db.abs() > 0.5 {
                println!("{} {relief_m:e}: sense {sense} off by {off_db:.2} dB", preset.name);
            }
        }
    }
    println!("heard off by at most {:.2} dB, felt by {:.2} dB", worst[0], worst[1]);
    assert!(worst[0] <= 1.0 && worst[1] <= 1.0, "{worst:?}");
}

/// Settled rms of a finger on a wooden plate that rings long, by the engine's own probe or an added
/// one.
fn finger_on_a_plate(levels: LevelPolicy, is_added: bool) -> f64 {
    let mut played = Played::new(live(levels));
    let probe = is_added.then(|| {
        // What is added before it is loud, and rings on.
        played.scene.add_probe(probe_by_name("steel-rod").unwrap()).unwrap();
        played.scene.add_probe(probe_by_name("fingertip").unwrap()).unwrap()
    });
    let plate = played.body(Body::stock(Stock::Bowl, Material::STEEL, 0.3).unwrap());
    let surface = played.scene.add_surface(ground(1e-4, Material::STEEL).body(plate)).unwrap();
    let finger = Touching::on(surface);
    let touching = probe.map_or(finger, |probe| finger.probe(probe));
    rms(&played.stroke(touching, 1.0, 0.1)[0])
}

#[test]
fn an_added_finger_is_as_loud_as_the_engines_own() {
    for levels in [LevelPolicy::Shared, LevelPolicy::Each, LevelPolicy::AsGiven] {
        let [own, added] = [false, true].map(|is_added| finger_on_a_plate(levels, is_added));
        assert!(db(added / own).abs() < 0.1, "{levels:?}: {} dB", db(added / own));
    }
}

#[test]
fn what_sounds_keeps_its_level_when_something_louder_is_added() {
    let played = |louder: bool| {
        let mut played = Played::new(live(LevelPolicy::Shared));
        let body = played.body(Body::stock(Stock::Plate, Material::WOOD, 0.14).unwrap());
        let top = played.scene.add_surface(ground(1e-6, Material::WOOD).body(body)).unwrap();
        let touching = Touching::on(top).felt_by(ChannelId(0));
        let before = played.stroke(touching, 1.0, 0.1);
        if louder {
            let bell = played.body(Body::stock(Stock::Bowl, Material::STEEL, 0.1).unwrap());
            let rough = played.scene.add_surface(ground(1e-3, Material::STEEL).body(bell)).unwrap();
            let [heard, felt] = played.stroke(Touching::on(rough).felt_by(ChannelId(0)), 1.0, 0.1);
            assert!(
                db(rms(&heard)) < -26.0 && db(rms(&felt)) < -20.0,
                "{} {}",
                db(rms(&heard)),
                db(rms(&felt))
            );
            (0..60).for_each(|_| played.step(None));
        } else {
            (0..97).for_each(|_| played.step(None));
        }
        (before, played.stroke(touching, 1.0, 0.1))
    };
    let ((a, b), (c, d)) = (played(false), played(true));
    assert_eq!(a, c);
    for sense in 0..2 {
        assert!(db(rms(&b[sense]) / rms(&d[sense])).abs() < 0.3);
    }
}

#[test]
fn shared_levels_keep_differences_and_levels_of_ones_own_do_not() {
    let apart_db = |policy| {
        let mut played = Played::new(live(policy));
        let levels = [1e-4, 1e-5].map(|relief_m| {
            let body = played.body(Body::stock(Stock::Plate, Material::WOOD, 0.14).unwrap());
            let top = played.scene.add_surface(ground(relief_m, Material::WOOD).body(body)).unwrap();
            played.stroke(Touching::on(top).felt_by(ChannelId(0)), 1.0, 0.1).map(|x| db(rms(&x)))
        });
        [0, 1].map(|sense| levels[0][sense] - levels[1][sense])
    };
    let [given, shared, each] = [LevelPolicy::AsGiven, LevelPolicy::Shared, LevelPolicy::Each].map(apart_db);
    for sense in 0..2 {
        assert!(given[sense] > 10.0 && (shared[sense] - given[sense]).abs() < 1.0, "{given:?} {shared:?}");
        assert!(each[sense].abs() < 2.0, "{each:?}");
    }
}

#[test]
fn equal_additions_give_equal_bits() {
    let bits = || {
        let mut played = Played::new(live(LevelPolicy::Shared));
        let body = played.body(Body::stock(Stock::Pan, Material::STEEL, 0.3).unwrap());
        let top = played.scene.add_surface(ground(3e-5, Material::STEEL).body(body)).unwrap();
        played.drop(body, 2.0, 1.0);
        played
            .stroke(Touching::on(top).felt_by(ChannelId(0)), 0.7, 0.2)
            .map(|x| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
    };
    assert_eq!(bits(), bits());
}

#[test]
fn the_trial_leaves_a_surface_as_it_was() {
    let heard = |policy| {
        let mut played = Played::new(Config { seed: 3, ..live(policy) });
        let body = played.body(Body::stock(Stock::Plate, Material::GLASS, 0.14).unwrap());
        let top = played.scene.add_surface(ground(2e-5, Material::GLASS).body(body)).unwrap();
        played.stroke(Touching::on(top).felt_by(ChannelId(0)), 0.5, 0.05)
    };
    let (found, given) = (heard(LevelPolicy::Each), heard(LevelPolicy::AsGiven));
    // Stay clear of the limiters of either.
    for (found, given) in found.iter().zip(&given) {
        let factor = rms(found) / rms(given);
        let left = found
            .iter()
            .zip(given)
            .map(|(a, b)| (f64::from(*a) - factor * f64::from(*b)).powi(2))
            .sum::<f64>();
        let off_db = 10.0 * (left / found.len() as f64).log10() - db(rms(found));
        assert!(off_db < -80.0, "{off_db} dB");
    }
}

#[test]
fn what_the_game_sets_counts() {
    let heard = |gain: f64, strike_gain: Option<f64>| {
        let mut played = Played::new(live(LevelPolicy::Shared));
        let body = Body::stock(Stock::Plate, Material::WOOD, 0.14).unwrap().gain(gain);
        let body = played.body(strike_gain.map_or(body.clone(), |strike_gain| body.strike_gain(strike_gain)));
        played.scene.report(0.0, ContactEvent::Impact(Impact::from_impulse(body, 1e-3, 0.5, 0.6))).unwrap();
        (0..10).for_each(|_| played.step(None));
        (peak(&played.audio), played.scene.strike_gain_of(body).unwrap())
    };
    let (whole, found) = heard(1.0, None);
    assert!((db(heard(0.5, None).0 / whole) + 6.02).abs() < 0.01);
    let (third, message) = heard(1.0, Some(found / 3.0));
    assert!(message == found / 3.0 && (db(third / whole) + 9.54).abs() < 0.3, "{third} {whole}");
}

#[test]
fn content_that_was_there_is_added_in_microseconds() {
    let mut played = Played::new(live(LevelPolicy::Shared));
    let body = || Body::stock(Stock::Plate, Material::CERAMIC, 0.2).unwrap();
    let timed = |scene: &mut Scene, take: &mut dyn FnMut(&mut Scene)| {
        let began = Instant::now();
        take(scene);
        began.elapsed().as_secs_f64()
    };
    let first_s = timed(&mut played.scene, &mut |scene| assert!(scene.add_body(body()).is_ok()));
    let id = played.body(body());
    let mut surfaces = Vec::new();
    let first_surface_s = timed(&mut played.scene, &mut |scene| {
        surfaces.push(scene.add_surface(ground(2e-5, Material::CERAMIC).body(id)).unwrap());
    });
    let (mut bodies_s, mut surfaces_s) = (Vec::new(), Vec::new());
    for _ in 0..60 {
        let new = body();
        let mut id = None;
        let mut new = Some(new);
        bodies_s.push(timed(&mut played.scene, &mut |scene| id = scene.add_body(new.take().unwrap()).ok()));
        let mut top = Some(ground(2e-5, Material::CERAMIC).body(id.unwrap()));
        surfaces_s.push(timed(&mut played.scene, &mut |scene| {
            surfaces.push(scene.add_surface(top.take().unwrap()).unwrap());
        }));
        played.scene.remove_surface(surfaces.pop().unwrap()).unwrap();
        played.scene.remove_body(id.unwrap()).unwrap();
        (0..4).for_each(|_| played.step(None));
    }
    bodies_s.sort_by(f64::total_cmp);
    surfaces_s.sort_by(f64::total_cmp);
    println!(
        "first body {:.1} ms, surface {:.1} ms; again body {:.1} µs, surface {:.1} µs in the median",
        1e3 * first_s,
        1e3 * first_surface_s,
        1e6 * bodies_s[30],
        1e6 * surfaces_s[30]
    );
    assert!(bodies_s[30] < 0.1 * first_s && surfaces_s[30] < 0.1 * first_surface_s);
}

#[test]
fn the_readmes_snippet_stays_within_full_scale_without_its_limiter() {
    let Engine { mut scene, mut renderer, .. } = Config::live(44_100.0).build().unwrap();
    let plate = scene.add_body(Body::stock(Stock::Plate, Material::CERAMIC, 0.14).unwrap()).unwrap();
    let top = Surface::flat(0.14, 0.14).unwrap().material(Material::CERAMIC).body(plate);
    let top = scene.add_surface(top).unwrap();
    let finger = ContactSample::new([0.3, 0.5], 0.6).sliding([0.1, 0.0]);
    scene.report(0.0, ContactEvent::begin(ContactId(1), top, ChannelId(0), finger)).unwrap();
    scene.report(0.0, ContactEvent::Impact(Impact::from_impulse(plate, 0.002, 0.5, 0.6))).unwrap();
    let (mut haptic, mut audio) = ([0.0; 8192], [0.0; 8192]);
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    println!("heard {:.2}, felt {:.2}, limiter {:.1} dB", peak(&audio), peak(&haptic), renderer.limiter_db());
    assert!((0.05..0.9).contains(&peak(&audio)) && renderer.limiter_db() == 0.0);
    assert!(scene.why_clipped().is_empty());
}

#[test]
fn what_clips_is_named_with_what_to_turn_and_by_how_much() {
    let mut played = Played::new(live(LevelPolicy::AsGiven));
    let quiet = played.body(Body::stock(Stock::Block, Material::WOOD, 0.1).unwrap());
    let bell = Body::stock(Stock::Bowl, Material::STEEL, 0.1).unwrap();
    let id = played.body(bell.clone());
    let tap = Impact { mass_kg: 1e-7, ..Impact::on(quiet) };
    played.step(Some(ContactEvent::Impact(tap)));
    let hard = |id| ContactEvent::Impact(Impact { mass_kg: 0.3, speed_m_s: 2.0, ..Impact::on(id) });
    played.step(Some(hard(id)));
    let because = played.scene.why_clipped();
    let ClipReason::Blows { body, by_db, strike_gain } = because[0] else { panic!("{because:?}") };
    println!("{}", because[0]);
    assert!(because.len() == 1 && body == id && by_db > 6.0);
    // What it says helps.
    let mut mended = Played::new(live(LevelPolicy::AsGiven));
    let id = mended.body(bell.strike_gain(strike_gain));
    mended.step(Some(hard(id)));
    assert!(peak(&mended.audio) <= 1.05 && mended.scene.why_clipped().is_empty(), "{}", peak(&mended.audio));
}

#[test]
fn strokes_that_clip_are_named_with_their_surface() {
    let mut played = Played::new(live(LevelPolicy::AsGiven));
    let crate_ = played.body(Body::stock(Stock::Plate, Material::SOFTWOOD, 0.4).unwrap());
    let rigid = played.scene.add_probe(probe_by_name("rigid").unwrap()).unwrap();
    let bricks = played.scene.add_surface(ground(5e-3, Material::BRICK)).unwrap();
    played.stroke(Touching::on(bricks).probe(rigid).held_by(crate_), 63.0, 1.0);
    let because = played.scene.why_clipped();
    println!("{}", because[0]);
    let message = because[0].to_string();
    assert!(matches!(because[0], ClipReason::Strokes { surface, .. } if surface == bricks), "{because:?}");
    assert!(
        ["relief_m", "Body::gain", "AudioBus::gain", "63.00 N"].iter().all(|word| message.contains(word)),
        "{message}"
    );
    // Levels that are found hold the same crate.
    let mut found = Played::new(live(LevelPolicy::Shared));
    let crate_ = found.body(Body::stock(Stock::Plate, Material::SOFTWOOD, 0.4).unwrap());
    let rigid = found.scene.add_probe(probe_by_name("rigid").unwrap()).unwrap();
    let bricks = found.scene.add_surface(ground(5e-3, Material::BRICK)).unwrap();
    let [heard, _] = found.stroke(Touching::on(bricks).probe(rigid).held_by(crate_), 63.0, 1.0);
    println!("crate on bricks: {:.1} dB rms, limiter {:.1} dB", db(rms(&heard)), found.renderer.limiter_db());
    assert!(found.renderer.limiter_db() <= 6.0 && db(rms(&heard)) > -40.0);
}

#[test]
fn a_felt_blow_that_clips_is_no_blow_that_is_heard() {
    let mut played = Played::new(live(LevelPolicy::Shared));
    let body = played.body(Body::stock(Stock::Box, Material::SOFTWOOD, 0.3).unwrap());
    let felt = Impact { mass_kg: 5.0, speed_m_s: 4.0, ..Impact::on(body) }.felt_by(ChannelId(0));
    played.step(Some(ContactEvent::Impact(felt)));
    (0..12).for_each(|_| played.step(None));
    let because = played.scene.why_clipped();
    let (felt, heard) = because.split_last().unwrap();
    assert!(matches!(felt, ClipReason::Felt { by_db } if *by_db > 20.0), "{because:?}");
    assert!(heard.iter().all(|reason| reason.by_db() < 6.0), "{because:?}");
    let message = felt.to_string();
    assert!(message.contains("full_scale") && message.contains("Impact::gain"), "{message}");
}

#[test]
fn a_surface_that_was_prepared_is_added_with_the_same_level() {
    let heard = |prepared: bool| {
        let mut played = Played::new(live(LevelPolicy::Shared));
        let new = Body::stock(Stock::Bowl, Material::GLASS, 0.1).unwrap();
        if prepared {
            played.scene.prepare_body(&new).unwrap();
        }
        let body = played.body(new);
        let surface = ground(2e-5, Material::GLASS).body(body);
        let surface = if prepared { played.scene.prepare(surface).unwrap() } else { surface };
        let top = played.scene.add_surface(surface).unwrap();
        played.stroke(Touching::on(top).felt_by(ChannelId(0)), 0.5, 0.1)
    };
    assert_eq!(heard(false), heard(true));
}

#[test]
fn what_falls_hard_is_louder_than_a_tap() {
    for (shape, of, size_m) in [
        (Stock::Plate, Material::CERAMIC, 0.14),
        (Stock::Box, Material::SOFTWOOD, 0.4),
        (Stock::Can, Material::STEEL, 0.11),
        (Stock::Door, Material::WOOD, 2.0),
        (Stock::Bar, Material::STEEL, 0.3),
        (Stock::Cushion, Material::FOAM, 0.3),
    ] {
        let mut tap = 0.0;
        // From 10 g to 100 kg at 1.5 m/s.
        for decade in 0..5 {
            let mut played = Played::new(live(LevelPolicy::Shared));
            let body = played.body(Body::stock(shape, of, size_m).unwrap());
            let impulse_n_s = 0.02 * 10f64.powi(decade);
            played.step(Some(ContactEvent::Impact(Impact::from_impulse(body, impulse_n_s, 3.0, 0.3))));
            (0..12).for_each(|_| played.step(None));
            let loud = rms(&played.audio);
            println!("{shape:?} {impulse_n_s} N·s: {:.1} dB, peak {:.2}", db(loud), peak(&played.audio));
            if decade == 0 {
                tap = loud;
            }
            assert!(loud >= tap, "{shape:?}, {impulse_n_s} N·s: {:.1} dB under a tap", db(tap / loud));
        }
    }
}

#[test]
fn cushions_and_bowls_stay_within_nine_decibels_of_full_scale() {
    for (name, kind) in Stock::ALL {
        for of in ["steel", "wood", "denim"] {
            let mut played = Played::new(live(LevelPolicy::Shared));
            let of = Material::by_name(of).unwrap();
            let body = played.body(Body::stock(kind, of, 0.3).unwrap());
            for striker in ["steel", "rubber", "foam"] {
                for mass_kg in [0.05, 20.0] {
                    let (striker, radius_m) =
                        (Material::by_name(striker).unwrap(), 0.05 * f64::cbrt(mass_kg));
                    let blow = Impact {
                        mass_kg,
                        radius_m,
                        striker,
                        speed_m_s: 2.4,
                        restitution: 0.0,
                        ..Impact::on(body)
                    };
                    played.step(Some(ContactEvent::Impact(blow)));
                    (0..9).for_each(|_| played.step(None));
                    let by_db = played.renderer.limiter_db();
                    assert!(by_db < 9.0, "{name}, {mass_kg} kg of {striker:?}: {by_db} dB");
                }
            }
        }
    }
}

#[test]
fn what_slides_faster_or_heavier_is_not_softer() {
    let slid = |force_n: f64, speed_m_s: f64| {
        let mut played = Played::new(live(LevelPolicy::Shared));
        let rigid = played.scene.add_probe(probe_by_name("rigid").unwrap()).unwrap();
        let thing = played.body(Body::stock(Stock::Barrel, Material::WOOD, 0.9).unwrap());
        let top = played.scene.add_surface(ground(2e-5, Material::STONE)).unwrap();
        let [heard, _] = played.stroke(Touching::on(top).probe(rigid).held_by(thing), force_n, speed_m_s);
        db(rms(&heard))
    };
    for force_n in [5.0, 50.0, 300.0] {
        let levels = [0.3, 1.0, 2.0].map(|speed_m_s| slid(force_n, speed_m_s));
        println!("{force_n} N: {levels:.1?} dB");
        assert!(levels.windows(2).all(|pair| pair[1] > pair[0] - 1.0), "{force_n} N: {levels:?}");
    }
}
