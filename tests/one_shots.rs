//! Bodies that come, are struck and go: nothing else waits for them, and what was struck rings out.

use crate::common;

use asperity::{
    Body, BodyId, BusId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Impact, Material,
    ModalModel, Mode, Renderer, Scene, Stock, SurfaceId,
};
use common::{SIDE_M, bar, plate};
use std::time::Instant;

const RATE_HZ: f64 = 48_000.0;
/// Samples in a tick of 60 Hz.
const TICK: usize = 800;

fn body(frequency_hz: f64, decay_per_s: f64) -> Body {
    let mode = Mode { frequency_hz, decay_per_s, amplitude: 0.01, phase_rad: 0.0 };
    Body::new(ModalModel::new(vec![mode], 0.01).unwrap()).material(Material::GLASS)
}

fn strike(body: BodyId) -> ContactEvent {
    ContactEvent::Impact(Impact::on(body).striker(Material::STEEL, 0.01, 0.005))
}

/// A stroke on one bus, a bell on another, and shards on a third.
struct Game {
    scene: Scene,
    renderer: Renderer,
    bell: BodyId,
    surface: SurfaceId,
    tick: u32,
    stroke: Vec<f32>,
    felt: Vec<f32>,
    bells: Vec<f32>,
    shards: Vec<f32>,
}

impl Game {
    fn new() -> Self {
        let buses = vec![asperity::AudioBus::default(); 3];
        let config = Config { audio: buses, ..common::raw_live(RATE_HZ) };
        let Engine { mut scene, renderer, .. } = config.build().unwrap();
        let ground = scene.add_body(bar()).unwrap();
        let surface = scene.add_surface(plate(0.8).body(ground)).unwrap();
        let bell = scene.add_body(body(900.0, 40.0).bus(BusId(1))).unwrap();
        let (stroke, felt, bells, shards) = Default::default();
        Self { scene, renderer, bell, surface, tick: 0, stroke, felt, bells, shards }
    }

    fn now_s(&self) -> f64 {
        f64::from(self.tick) / 60.0
    }

    /// Adds, strikes and removes so many shards.
    fn shatter(&mut self, count: usize, shard: &Body) {
        for _ in 0..count {
            let id = self.scene.add_body(shard.clone().bus(BusId(2))).unwrap();
            self.scene.report(self.now_s(), strike(id)).unwrap();
            self.scene.remove_body(id).unwrap();
        }
    }

    fn ring_bell(&mut self) {
        self.scene.report(self.now_s(), strike(self.bell)).unwrap();
    }

    /// Strokes and renders a tick.
    fn play(&mut self) {
        let t = self.now_s();
        let sample = ContactSample::new([0.1 + 0.02 * t / SIDE_M, 0.5], 0.6).sliding([0.02, 0.0]);
        let event = if self.tick == 0 {
            ContactEvent::begin(ContactId(1), self.surface, ChannelId(0), sample)
        } else {
            ContactEvent::moved(ContactId(1), sample)
        };
        self.scene.report(t, event).unwrap();
        self.tick += 1;
        let mut out = [[0.0; TICK]; 4];
        let [felt, stroke, bells, shards] = &mut out;
        self.renderer.render(&mut [felt], &mut [stroke, bells, shards]);
        self.felt.extend(out[0]);
        self.stroke.extend(out[1]);
        self.bells.extend(out[2]);
        self.shards.extend(out[3]);
    }
}

/// First sample of `x` from `from` on that is not silence.
fn begins(x: &[f32], from: usize) -> usize {
    from + x[from..].iter().position(|x| x.abs() > 1e-9).expect("it is heard")
}

/// Largest difference of the two over the largest of the first, dB.
fn differs_db(a: &[f32], b: &[f32]) -> f64 {
    let most = |x: &mut dyn Iterator<Item = f32>| x.fold(1e-30f32, |most, x| most.max(x.abs()));
    let off = most(&mut a.iter().zip(b).map(|(a, b)| a - b));
    20.0 * f64::from(off / most(&mut a.iter().copied())).log10()
}

fn rms(x: &[f32]) -> f64 {
    (x.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}

#[test]
fn three_hundred_shards_in_a_tick_drop_nothing_else() {
    let mut one = None;
    for count in [1, 5, 16, 40, 100, 300] {
        let mut games = [Game::new(), Game::new()];
        for (game, shards) in games.iter_mut().zip([0, count]) {
            (0..30).for_each(|_| game.play());
            game.shatter(shards, &body(3_000.0, 30.0));
            game.ring_bell();
            (0..60).for_each(|_| game.play());
        }
        let [alone, beside] = &games;
        let (usual, now) = (begins(&alone.bells, 30 * TICK), begins(&beside.bells, 30 * TICK));
        let off = [differs_db(&alone.stroke, &beside.stroke), differs_db(&alone.felt, &beside.felt)];
        println!("{count}: bell {} samples later, stroke off by {off:?} dB", now - usual);
        assert_eq!(now, usual, "{count}");
        assert!(off.iter().all(|off| *off < -60.0), "{count}: {off:?}");
        let stats = beside.scene.stats();
        assert_eq!(stats.impacts, count as u64 + 1, "{count}");
        assert_eq!(stats.given_way, count.saturating_sub(64) as u64, "{count}");
        // All shards sound at once where there is room: as many times as loud as one.
        let loudness = rms(&beside.shards[30 * TICK..31 * TICK]);
        let times = loudness / *one.get_or_insert(loudness);
        println!("{count}: {times:.2} times as loud as one");
        assert!(
            if count <= 64 { (times / count as f64 - 1.0).abs() < 1e-3 } else { times > 60.0 },
            "{times}"
        );
    }
}

#[test]
fn sixty_shots_a_second_for_a_minute_never_lag() {
    let mut game = Game::new();
    (0..30).for_each(|_| game.play());
    let mut latest = 0;
    for second in 0..60 {
        for tick in 0..60 {
            game.shatter(1, &body(3_000.0, 6.0));
            if tick == 30 {
                game.ring_bell();
            }
            game.play();
        }
        let rung = (30 + second * 60 + 30) * TICK;
        latest = latest.max(begins(&game.bells[rung - 2 * TICK..], 2 * TICK) - 2 * TICK);
        game.bells[..rung + TICK].fill(0.0);
    }
    println!("latest {latest} samples; {} gave way", game.scene.stats().given_way);
    let stats = game.scene.stats();
    assert_eq!((stats.impacts, stats.dropped, stats.stale, stats.lapsed), (3_660, 0, 0, 0));
    assert!(latest < TICK, "{latest}");
}

#[test]
fn a_body_removed_after_a_strike_rings_out() {
    let stock = |shape, material, size_m| Body::stock(shape, material, size_m).unwrap();
    for shape in [
        stock(Stock::Plate, Material::STEEL, 0.4),
        stock(Stock::Bowl, Material::BRASS, 0.14),
        stock(Stock::Block, Material::WOOD, 0.1),
    ] {
        let heard = [0, 1, 2].map(|does| {
            let Engine { mut scene, mut renderer, .. } = common::raw_live(RATE_HZ).build().unwrap();
            let id = scene.add_body(shape.clone().gain(0.5)).unwrap();
            scene.report(0.0, strike(id)).unwrap();
            match does {
                0 => {}
                1 => scene.remove_body(id).unwrap(),
                _ => scene.replace_body(id, body(200.0, 3.0)).unwrap(),
            }
            let mut audio = vec![0.0; 96_000];
            renderer.render(&mut [&mut vec![0.0; 96_000]], &mut [&mut audio]);
            audio
        });
        for (from, to) in [(4_800, 9_600), (9_600, 24_000), (24_000, 48_000)] {
            let level = |x: &[f32]| 20.0 * rms(&x[from..to]).log10();
            let [kept, removed, replaced] = heard.each_ref().map(|x| level(x));
            println!("{kept:.2} kept, {removed:.2} removed, {replaced:.2} replaced");
            assert!(kept < -200.0 || (kept - removed).abs() < 0.5, "{kept} dB, {removed} dB");
            assert!(kept < -200.0 || (kept - replaced).abs() < 0.5, "{kept} dB, {replaced} dB");
        }
    }
}

#[test]
fn bodies_beyond_the_limit_fade_quietest_first_without_a_click() {
    let Engine { mut scene, mut renderer, .. } = common::raw_live(RATE_HZ).build().unwrap();
    let mut audio = Vec::new();
    let mut play = |audio: &mut Vec<f32>, blocks: usize| {
        for _ in 0..blocks {
            let mut block = [0.0; 64];
            renderer.render(&mut [&mut [0.0; 64]], &mut [&mut block]);
            audio.extend(block);
        }
    };
    // One that is loud among many that are soft; they ring, and then all go at once.
    let bodies: Vec<_> = (0..250)
        .map(|index| {
            let shape = body(150.0 + f64::from(index % 100), 0.05);
            let id = scene.add_body(shape.gain(if index == 100 { 50.0 } else { 0.1 })).unwrap();
            scene.report(f64::from(index) * 64.0 / RATE_HZ, strike(id)).unwrap();
            play(&mut audio, 1);
            id
        })
        .collect();
    play(&mut audio, 150);
    bodies.into_iter().for_each(|id| scene.remove_body(id).unwrap());
    play(&mut audio, 1500);
    assert_eq!(scene.stats().given_way, 250 - 64);
    let gone = 400 * 64;
    let (before, after) = (&audio[gone - 4_800..gone], &audio[gone - 2..gone + 9_600]);
    let one = rms(&audio[audio.len() - 4_800..]) / rms(before);
    let corner = |x: &[f32]| {
        let bend = |x: &[f32]| f64::from(x[0] - 2.0 * x[1] + x[2]).abs();
        x.windows(3).map(bend).fold(0.0, f64::max)
    };
    println!("{one:.3} of it is left; corner {:.2e} over {:.2e}", corner(after), corner(before));
    assert!(corner(after) < 2.0 * corner(before), "{} over {}", corner(after), corner(before));
    assert!((0.7..=1.2).contains(&one), "the loud one goes on: {one}");
    // A loud one that has rung for a while outlives any number of soft ones.
    let loud = scene.add_body(body(150.0, 0.05).gain(50.0)).unwrap();
    let now_s = 1900.0 * 64.0 / RATE_HZ;
    scene.report(now_s, strike(loud)).unwrap();
    scene.remove_body(loud).unwrap();
    play(&mut audio, 150);
    for index in 0..200 {
        let id = scene.add_body(body(250.0, 0.05).gain(0.1)).unwrap();
        scene.report(now_s + (150.0 + f64::from(index)) * 64.0 / RATE_HZ, strike(id)).unwrap();
        scene.remove_body(id).unwrap();
        play(&mut audio, 1);
    }
    play(&mut audio, 150);
    let at = (1900 + 150) * 64;
    let kept = rms(&audio[audio.len() - 4_800..]) / rms(&audio[at - 4_800..at]);
    println!("{kept:.3} of the loud one is left");
    assert!((0.8..=1.2).contains(&kept), "{kept}");
}

#[test]
fn a_known_stock_body_costs_the_game_next_to_nothing() {
    let Engine { mut scene, mut renderer, .. } = common::raw_live(RATE_HZ).build().unwrap();
    let (mut took, mut fresh) = (Vec::new(), Vec::new());
    for tick in 0..300 {
        let began = Instant::now();
        // Each tenth is of a size of its own, as if it had never been there.
        let is_new = tick % 10 == 0;
        let size_m = if is_new { 0.1 + 1e-5 * f64::from(tick) } else { 0.08 };
        let shot = Body::stock(Stock::Block, Material::WOOD, size_m).unwrap();
        let id = scene.add_body(shot).unwrap();
        if is_new { &mut fresh } else { &mut took }.push(began.elapsed().as_secs_f64());
        scene.report(f64::from(tick) / 60.0, strike(id)).unwrap();
        scene.remove_body(id).unwrap();
        renderer.render(&mut [&mut [0.0; TICK]], &mut [&mut [0.0; TICK]]);
    }
    let median = |times: &mut Vec<f64>| {
        times.sort_by(f64::total_cmp);
        1e6 * times[times.len() / 2]
    };
    let (again, fresh) = (median(&mut took), median(&mut fresh));
    println!("new {fresh:.0} us, there before {again:.0} us");
    assert!(3.0 * again < fresh, "{again} us, {fresh} us");
}

#[test]
fn a_body_that_comes_again_sounds_as_it_did_to_the_bit() {
    let shapes = [
        Body::stock(Stock::Block, Material::WOOD, 0.1).unwrap(),
        Body::stock(Stock::Bowl, Material::CERAMIC, 0.05).unwrap(),
        body(3_000.0, 30.0),
    ];
    for shape in shapes {
        let config = Config { sample_rate_hz: RATE_HZ, ..Config::default() };
        let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
        let heard = [0.0, 8.0].map(|t| {
            let id = scene.add_body(shape.clone()).unwrap();
            scene.report(t, strike(id)).unwrap();
            scene.remove_body(id).unwrap();
            let mut audio = vec![0.0f32; 8 * RATE_HZ as usize];
            audio.chunks_mut(TICK).for_each(|audio| renderer.render(&mut [&mut [0.0; TICK]], &mut [audio]));
            audio
        });
        assert!(heard[0].iter().any(|x| *x != 0.0) && heard[0] == heard[1]);
        assert_eq!(scene.collect(), 1, "the second has come home");
    }
}
