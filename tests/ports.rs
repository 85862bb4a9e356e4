//! Ports: what they give is what leaves, whoever reads late is told, and the audio half does not
//! notice.

use crate::common;
use crate::counting;

use asperity::live::ports::{Feed, Force, ForceRow, ForceRows, Of, Opened, Outlet, Pcm, Picture};
use asperity::live::ports::{FrameCounts, FrameStage, HeadsetFrame, HeadsetFrames};
use asperity::live::ports::{Levels, Point, PointSettings, Points, PortKind, PortSetup, Tone};
use asperity::surface::sand::{SandDesign, SandSource};
use asperity::{
    ActuatorSettings, AddError, AudioBus, Body, BusId, ChannelId, Config, ContactBlock, ContactEvent,
    ContactId, ContactSample, Engine, Quantity, Renderer, Scene, Surface, SurfaceId, Tap, Touching,
};
use asperity_dsp::vibration_points::{PointDesign, PointState};
use common::{bar, grating, plate};
use counting::heap_operations;

/// A hand on each of two channels, a bar on the second bus, three fingers: two on channel 0, one on
/// 1.
struct Game {
    scene: Scene,
    renderer: Renderer,
    surface: SurfaceId,
    step: u32,
    touches: bool,
}

impl Game {
    fn new(rate_hz: f64) -> Self {
        let acceleration = ActuatorSettings {
            output: Quantity::Acceleration,
            full_scale: 100.0,
            ..ActuatorSettings::default()
        };
        let config = Config {
            actuators: vec![ActuatorSettings::default(), acceleration],
            audio: vec![AudioBus::default(); 2],
            ..Config { sample_rate_hz: rate_hz, ..Config::default() }
        };
        let Engine { mut scene, renderer, .. } = config.build().unwrap();
        let body = scene.add_body(Body::new(bar()).bus(BusId(1))).unwrap();
        let surface = scene.add_surface(grating(2e-3, 5e-5).body(body)).unwrap();
        Self { scene, renderer, surface, step: 0, touches: false }
    }

    /// One step of 60 Hz.
    fn report(&mut self) {
        let t = f64::from(self.step) / 60.0;
        for finger in 0..3u64 {
            let sample = ContactSample {
                uv: [0.1 + 0.2 * finger as f64 + 0.7 * t, 0.5],
                velocity_m_s: Some([0.1, 0.0]),
                normal_force_n: 0.5 + finger as f64,
                closing_m_s: 0.0,
                ..ContactSample::default()
            };
            let event = if !self.touches {
                let hand = ChannelId(u16::from(finger == 2));
                ContactEvent::begin_with(ContactId(finger), Touching::on(self.surface).felt_by(hand), sample)
            } else {
                ContactEvent::moved(ContactId(finger), sample)
            };
            self.scene.report(t, event).unwrap();
        }
        (self.touches, self.step) = (true, self.step + 1);
    }

    /// One step of nothing.
    fn rest(&mut self) {
        for finger in (0..3).filter(|_| self.touches) {
            let end = ContactEvent::end(ContactId(finger));
            self.scene.report(f64::from(self.step) / 60.0, end).unwrap();
        }
        (self.touches, self.step) = (false, self.step + 1);
    }

    /// Everything up to the next step, in blocks of `frames`; what left, a channel each.
    fn render(&mut self, frames: usize, left: &mut [Vec<f32>; 4], tap: &mut dyn Tap) {
        let until = (f64::from(self.step) / 60.0 * self.renderer.sample_rate_hz()) as u64;
        while self.renderer.position() < until {
            let n = frames.min((until - self.renderer.position()) as usize);
            let mut out = vec![vec![0.0; n]; 4];
            let [a, b, c, d] = &mut out[..] else { unreachable!() };
            self.renderer.render_tapped(&mut [a, b], &mut [c, d], tap);
            left.iter_mut().zip(&out).for_each(|(left, out)| left.extend(out));
        }
    }

    /// Steps while nobody reads, in blocks of 64 without a heap operation; what left on the first
    /// channel.
    fn play_unread(&mut self, steps: u32) -> Vec<f32> {
        let (mut haptic, mut audio) = ([[0.0f32; 64]; 2], [[0.0f32; 64]; 2]);
        let (mut left, mut touched) = (Vec::new(), 0);
        while self.step < steps {
            self.report();
            while (self.renderer.position() as f64) < f64::from(self.step) / 60.0 * 44_100.0 {
                let ([a, b], [c, d]) = (&mut haptic, &mut audio);
                touched += heap_operations(|| self.renderer.render(&mut [a, b], &mut [c, d]));
                left.extend(haptic[0]);
            }
        }
        assert_eq!(touched, 0, "heap operations on the audio half");
        left
    }
}

struct Nothing;
impl Tap for Nothing {
    fn is_watching(&self) -> bool {
        false
    }
    fn contact(&mut self, _: &ContactBlock<'_>) {}
}

#[test]
fn a_pcm_port_gives_the_leaving_samples_at_any_rate() {
    for rate_hz in [8_000.0, 22_050.0, 44_100.0, 48_000.0] {
        for frames in [1, 64, 333] {
            let mut game = Game::new(rate_hz);
            let feeds = [Feed::Haptic(ChannelId(0)), Feed::Haptic(ChannelId(1)), Feed::Bus(0), Feed::Bus(1)];
            let mut ports = feeds.map(|from| game.scene.open_port(Pcm { from, holds_s: 2.0 }).unwrap());
            let mut left: [Vec<f32>; 4] = Default::default();
            for _ in 0..20 {
                game.report();
                game.render(frames, &mut left, &mut Nothing);
            }
            for (port, left) in ports.iter_mut().zip(&left) {
                let mut read = vec![0.0; left.len() + 100];
                let count = port.read(&mut read);
                assert!(read[..count] == left[..], "{rate_hz} Hz, {frames} frames");
                assert_eq!((port.lost(), port.position()), (0, left.len() as u64));
            }
            assert!(
                [0, 1, 3].iter().all(|&i| left[i].iter().any(|x| *x != 0.0))
                    && left[2].iter().all(|x| *x == 0.0)
            );
        }
    }
}

#[test]
fn an_open_port_changes_no_bit_of_what_leaves() {
    let render = |ports: bool| {
        let mut game = Game::new(44_100.0);
        let open = ports.then(|| {
            let pcm = game.scene.open_port(Pcm { from: Feed::Bus(1), holds_s: 0.1 }).unwrap();
            (pcm, game.scene.open_port(Force { rate_hz: 1000.0, holds_s: 0.1 }).unwrap())
        });
        let mut left: [Vec<f32>; 4] = Default::default();
        for _ in 0..20 {
            game.report();
            game.render(64, &mut left, &mut Nothing);
        }
        drop(open);
        left
    };
    assert!(render(true) == render(false));
}

/// What the force port ought to say, from the tap.
struct Rows(ForceRows, Vec<ForceRow>, u64);

impl Tap for Rows {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.0.close(block.first_sample, |row| self.1.push(row));
        self.0.add(block);
        self.2 = block.first_sample + block.force_n.len() as u64;
    }
}

#[test]
fn a_force_port_gives_offline_rows_and_sums_them_by_hand() {
    for (rate_hz, force_rate_hz) in
        [(44_100.0, 1000.0), (44_100.0, 5000.0), (22_050.0, 1000.0), (192_000.0, 2000.0)]
    {
        let mut game = Game::new(rate_hz);
        let mut port = game.scene.open_port(Force { rate_hz: force_rate_hz, holds_s: 2.0 }).unwrap();
        let mut expected = Rows(ForceRows::new(force_rate_hz, rate_hz, 8), Vec::new(), 0);
        let mut left: [Vec<f32>; 4] = Default::default();
        let mut read = Vec::new();
        for _ in 0..20 {
            game.report();
            game.render(64, &mut left, &mut expected);
            read.extend(std::iter::from_fn(|| port.read()));
        }
        let end = expected.2;
        expected.0.close(end, |row| expected.1.push(row));
        assert!(read.len() > (0.3 * 5.0 * force_rate_hz) as usize);
        assert!(read == expected.1, "{rate_hz} Hz, {force_rate_hz} rows a second");
        assert_eq!(port.lost(), 0);
        for tick in read.chunk_by(|a, b| a.tick == b.tick) {
            let of = |of: Of| tick.iter().find(|row| row.of == of).unwrap().force_n;
            let [a, b, c] = [0, 1, 2].map(|finger| of(Of::Contact(ContactId(finger))));
            let both = of(Of::Hand(ChannelId(0)));
            assert!(
                (0..3).all(|axis| (both[axis] - a[axis] - b[axis]).abs() <= 1e-15 + 1e-12 * both[axis].abs())
            );
            assert_eq!((of(Of::Hand(ChannelId(1))), tick.len()), (c, 5));
        }
    }
}

#[test]
fn a_stalled_reader_loses_the_oldest_and_knows_how_many() {
    let mut game = Game::new(44_100.0);
    let mut pcm = game.scene.open_port(Pcm { from: Feed::Haptic(ChannelId(0)), holds_s: 0.25 }).unwrap();
    let mut force = game.scene.open_port(Force { rate_hz: 1000.0, holds_s: 0.25 }).unwrap();
    let left = game.play_unread(150);
    let mut read = vec![0.0; left.len()];
    let count = pcm.read(&mut read);
    assert!((11_025..44_100 / 2).contains(&count), "{count}");
    assert!(read[..count] == left[left.len() - count..], "the newest are left");
    assert_eq!(pcm.lost(), (left.len() - count) as u64);
    let rows: Vec<_> = std::iter::from_fn(|| force.read()).collect();
    let all = rows.len() as u64 + force.lost();
    assert!(force.lost() > 0 && (12_000..=12_500).contains(&all), "{all} rows, {} lost", force.lost());
    assert!(rows.windows(2).all(|pair| pair[0].tick <= pair[1].tick) && rows.last().unwrap().tick >= 2_490);
    // From here on it keeps up.
    game.report();
    game.render(64, &mut Default::default(), &mut Nothing);
    let lost = (pcm.lost(), force.lost());
    assert!(pcm.read(&mut read) > 0 && force.newest(ChannelId(1)).unwrap().1[2] > 1.0);
    assert_eq!((pcm.lost(), force.lost()), lost);
}

/// 100 points a second for a headset's controller.
const HEADSET: PointSettings = PointSettings { rate_hz: 100.0, band_hz: [55.0, 200.0], tone: Tone::Drawn };

/// What the causal reduction makes of samples offline.
fn reduced(samples: &[f32], settings: PointSettings, rate_hz: f64) -> Vec<Point> {
    let design = PointDesign::new(settings, rate_hz).unwrap();
    let mut state = PointState::default();
    samples.iter().filter_map(|x| state.tick(&design, f64::from(*x))).collect()
}

#[test]
fn points_and_levels_are_those_of_the_offline_reduction() {
    for (rate_hz, frames) in [(8_000.0, 64), (44_100.0, 1), (44_100.0, 333), (48_000.0, 64)] {
        let mut game = Game::new(rate_hz);
        let from = Feed::Haptic(ChannelId(0));
        let mut points = game.scene.open_port(Points { from, settings: HEADSET, holds_s: 2.0 }).unwrap();
        let mut levels = game.scene.open_port(Levels { from, rate_hz: 30.0, holds_s: 2.0 }).unwrap();
        let mut left: [Vec<f32>; 4] = Default::default();
        for _ in 0..30 {
            game.report();
            game.render(frames, &mut left, &mut Nothing);
        }
        let read: Vec<Point> = std::iter::from_fn(|| points.read()).collect();
        assert_eq!((read.len(), points.lost(), points.rate_hz()), (50, 0, 100.0));
        assert!(read == reduced(&left[0], HEADSET, rate_hz), "{rate_hz} Hz, {frames} frames");
        assert!(read.iter().any(|point| point.amplitude > 0.0));
        let motors = PointSettings { rate_hz: 30.0, band_hz: [20.0, 250.0], tone: Tone::Strongest };
        let expected: Vec<[f64; 2]> =
            reduced(&left[0], motors, rate_hz).iter().map(|point| [point.low, point.high]).collect();
        let read: Vec<[f64; 2]> = std::iter::from_fn(|| levels.read()).collect();
        assert!(read == expected && levels.newest() == expected[expected.len() - 1]);
    }
}

#[test]
fn a_stalled_reader_of_points_and_pcm_costs_the_audio_half_nothing() {
    let mut game = Game::new(44_100.0);
    let from = Feed::Haptic(ChannelId(0));
    let mut points = game.scene.open_port(Points { from, settings: HEADSET, holds_s: 0.25 }).unwrap();
    let mut levels = game.scene.open_port(Levels { from, rate_hz: 60.0, holds_s: 0.25 }).unwrap();
    let mut pcm = game.scene.open_port(Pcm { from, holds_s: 0.25 }).unwrap();
    let left = game.play_unread(120);
    let all = reduced(&left, HEADSET, 44_100.0);
    let read: Vec<Point> = std::iter::from_fn(|| points.read()).collect();
    assert!(read[..] == all[all.len() - read.len()..], "the newest are left");
    assert_eq!(points.lost(), (all.len() - read.len()) as u64);
    assert!(points.lost() > 100 && read.len() >= 25, "{} lost, {} read", points.lost(), read.len());
    levels.newest();
    assert!(levels.lost() > 50);
    let mut samples = vec![0.0; left.len()];
    let count = pcm.read(&mut samples);
    assert_eq!(pcm.lost(), (left.len() - count) as u64);
}

/// A runtime that keeps to `XR_EXT_haptic_parametric`: a stream it plays, its beginning, the time
/// of its last point.
#[derive(Default)]
struct Runtime {
    stream: Option<(f64, i64)>,
    frames: usize,
    ended: usize,
}

impl Runtime {
    /// One call at `now_s`; panics where the specification refuses it.
    fn apply(&mut self, frame: &HeadsetFrame, first_frame_s: f64, now_s: f64) {
        self.stream =
            self.stream.filter(|(began_s, last_ns)| (now_s - began_s) * 1e9 <= *last_ns as f64 + 5e7);
        let HeadsetFrame { stage, points, band_hz } = frame;
        let begins = *stage == FrameStage::First;
        assert!(begins || self.stream.is_some(), "no stream is running");
        assert!(points.len() >= if begins { 2 } else { 1 } && points.len() <= 500);
        let from_ns = if begins { 0 } else { self.stream.unwrap().1 };
        assert!(points[0].time_ns >= from_ns && points.is_sorted_by_key(|point| point.time_ns));
        assert!(points.iter().all(|point| (0.0..=1.0).contains(&point.amplitude)));
        assert!(points.iter().all(|point| (0.0..=1.0).contains(&point.frequency)));
        assert_eq!(band_hz.is_some(), begins, "the first frame alone says its range");
        let last_ns = points[points.len() - 1].time_ns;
        assert!(!begins || points[0].time_ns == 0 && last_ns as f64 >= first_frame_s * 1e9);
        let began_s = if begins { now_s } else { self.stream.unwrap().0 };
        self.stream = (*stage != FrameStage::Last).then_some((began_s, last_ns));
        self.frames += 1;
        self.ended += usize::from(*stage == FrameStage::Last);
    }
}

#[test]
fn frames_keep_a_headsets_rules_and_count_every_point() {
    for (first_frame_s, full_scale, drift) in [(0.0, 1.0, 1.0), (0.05, 2e-4, 1.0003), (0.3, 1e-5, 0.9997)] {
        let mut game = Game::new(48_000.0);
        let from = Feed::Haptic(ChannelId(0));
        let kind = HeadsetFrames { from, settings: HEADSET, full_scale, first_frame_s, holds_s: 0.25 };
        let mut port = game.scene.open_port(kind).unwrap();
        let (mut runtime, mut left, mut random) = (Runtime::default(), [const { Vec::new() }; 4], 1u32);
        for step in 0..1200 {
            // Three seconds of strokes, two of nothing.
            if step % 300 < 180 {
                game.report();
            } else {
                game.rest();
            }
            game.render(64, &mut left, &mut Nothing);
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let waits = random >> 24 < 40 || (600..621).contains(&step);
            if random >> 24 == 255 {
                (runtime.stream, _) = (None, port.restart());
            }
            let now_s = f64::from(step + 1) / 60.0 * drift;
            while let Some(frame) = (!waits).then(|| port.read(now_s)).flatten() {
                runtime.apply(&frame, first_frame_s, now_s);
            }
        }
        while port.read(20.1 * drift).is_some() {}
        let FrameCounts { framed, silent, dropped } = port.counts();
        let points = reduced(&left[0], HEADSET, 48_000.0).len() as u64;
        assert_eq!(framed + silent + dropped, points, "{first_frame_s} s");
        assert!(runtime.frames > 300 && runtime.ended >= 2 && framed > points / 4, "{:?}", port.counts());
        assert!(dropped < points / 8, "{:?}", port.counts());
    }
    let mut game = Game::new(48_000.0);
    let from = Feed::Haptic(ChannelId(0));
    let kind = HeadsetFrames { from, settings: HEADSET, full_scale: 1.0, first_frame_s: 0.05, holds_s: 0.25 };
    for (wrong, field) in [
        (HeadsetFrames { full_scale: 0.0, ..kind }, "full_scale"),
        (HeadsetFrames { first_frame_s: -1.0, ..kind }, "first_frame_s"),
    ] {
        assert!(game.scene.open_port(wrong).err().unwrap().to_string().starts_with(field));
    }
}

#[test]
fn points_that_no_device_plays_are_refused_by_name() {
    let Engine { mut scene, .. } = Config::default().build().unwrap();
    let points = |settings, from| Points { from, settings, holds_s: 0.1 };
    let from = Feed::Haptic(ChannelId(0));
    let mut refused = |port: Points| scene.open_port(port).err().unwrap().to_string();
    assert!(refused(points(PointSettings { rate_hz: 0.0, ..HEADSET }, from)).starts_with("rate_hz"));
    assert!(
        refused(points(PointSettings { band_hz: [f64::NAN; 2], ..HEADSET }, from)).starts_with("band_hz")
    );
    assert!(refused(points(HEADSET, Feed::Bus(7))).starts_with("bus: 7"));
    assert!(refused(points(HEADSET, Feed::Haptic(ChannelId(9)))).starts_with("actuator"));
    assert!(refused(Points { holds_s: 0.0, ..points(HEADSET, from) }).starts_with("holds_s"));
}

#[test]
fn readers_on_threads_of_their_own_get_every_sample() {
    let mut game = Game::new(44_100.0);
    let mut port = game.scene.open_port(Pcm { from: Feed::Bus(1), holds_s: 10.0 }).unwrap();
    let reading = std::thread::spawn(move || {
        let (mut all, mut some) = (Vec::new(), [0.0; 100]);
        while all.len() < 22_050 {
            let count = port.read(&mut some);
            all.extend_from_slice(&some[..count]);
        }
        (all, port.lost())
    });
    let mut left: [Vec<f32>; 4] = Default::default();
    for _ in 0..30 {
        game.report();
        game.render(64, &mut left, &mut Nothing);
    }
    let (read, lost) = reading.join().unwrap();
    assert_eq!(lost, 0);
    assert!(read[..] == left[3][..read.len()]);
}

#[test]
fn impossible_ports_are_refused_and_a_dropped_reader_makes_room() {
    let config = Config { max_ports: 2, ..Config::default() };
    let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let surface = scene.add_surface(plate(0.5)).unwrap();
    let pcm = |from| Pcm { from, holds_s: 0.1 };
    let refused = |error: AddError| error.to_string();
    assert!(refused(scene.open_port(pcm(Feed::Bus(1))).err().unwrap()).starts_with("bus: 1"));
    assert!(refused(scene.open_port(pcm(Feed::Haptic(ChannelId(1)))).err().unwrap()).starts_with("actuator"));
    let endless = Pcm { holds_s: f64::NAN, ..pcm(Feed::Bus(0)) };
    assert!(refused(scene.open_port(endless).err().unwrap()).starts_with("holds_s"));
    for rate_hz in [0.0, 1e6, 19_999.0 + 1e5] {
        let error = scene.open_port(Force { rate_hz, holds_s: 0.1 }).err().unwrap();
        assert!(refused(error).starts_with("rate_hz"));
    }
    assert_eq!(scene.open_port(Picture { surface }).err().unwrap(), AddError::NeverChanges);
    let (first, second) =
        (scene.open_port(pcm(Feed::Bus(0))).unwrap(), scene.open_port(pcm(Feed::Bus(0))).unwrap());
    let full = AddError::Full { kind: "ports", capacity: 2 };
    assert_eq!(scene.open_port(pcm(Feed::Bus(0))).err(), Some(full));
    drop(first);
    renderer.render(&mut [&mut [0.0; 256]], &mut [&mut [0.0; 256]]);
    let third = scene.open_port(pcm(Feed::Bus(0)));
    assert!(third.is_ok());
    drop(second);
}

#[test]
fn sand_is_seen_moving_without_the_audio_half() {
    let design = SandDesign { width_m: 0.1, height_m: 0.1, cells: 256, ..SandDesign::default() };
    let (source, mut worker) = SandSource::threaded(&design, 1).unwrap();
    let Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let surface = scene.add_surface(Surface::new(source, 0.1, 0.1).unwrap().wraps(false)).unwrap();
    let mut picture = scene.open_port(Picture { surface }).unwrap();
    let mut drawn = vec![0.0f32; 256 * 256];
    let mut draw = |picture: &mut asperity::live::ports::PicturePort| {
        picture.changed(|tile| {
            for (y, row) in tile.height_m.chunks(tile.size[0]).enumerate() {
                let first = (tile.at[1] + y) * 256 + tile.at[0];
                drawn[first..first + tile.size[0]].copy_from_slice(row);
            }
        })
    };
    worker.frame();
    assert_eq!(draw(&mut picture), 64, "the whole bed at first");
    let mut counts = Vec::new();
    for step in 0..60u32 {
        let t = f64::from(step) / 60.0;
        let sample = ContactSample {
            uv: [0.2 + 0.5 * t, 0.5],
            velocity_m_s: Some([0.05, 0.0]),
            normal_force_n: 2.0,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = if step == 0 {
            ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample)
        } else {
            ContactEvent::moved(ContactId(1), sample)
        };
        scene.report(t, event).unwrap();
        while (renderer.position() as f64) < (t + 1.0 / 60.0) * 44_100.0 {
            renderer.render(&mut [&mut [0.0; 64]], &mut [&mut [0.0; 64]]);
        }
        worker.frame();
        counts.push(draw(&mut picture));
    }
    assert!(counts.iter().sum::<usize>() > 30 && counts.iter().all(|&tiles| tiles <= 16), "{counts:?}");
    let grid = worker.simulation().grid();
    let lies = |at: usize| grid.height_m(at % 256, at / 256) as f32;
    assert!(drawn.iter().enumerate().all(|(at, height_m)| *height_m == lies(at)));
    assert!(drawn.iter().copied().fold(f32::INFINITY, f32::min) < 0.0495, "a furrow");
    assert_eq!(picture.missed(), 0);
}

/// A kind that is none of the crate's: counts samples.
struct Count;
struct Counter(std::sync::Arc<std::sync::atomic::AtomicU64>);

impl Outlet for Counter {
    fn bus(&mut self, _bus: usize, _first: u64, samples: &[f32]) {
        self.0.fetch_add(samples.len() as u64, std::sync::atomic::Ordering::Relaxed);
    }
    fn is_closed(&self) -> bool {
        std::sync::Arc::strong_count(&self.0) == 1
    }
}

impl PortKind for Count {
    type Port = std::sync::Arc<std::sync::atomic::AtomicU64>;
    fn open(self, _setup: &PortSetup<'_>) -> Result<Opened<Self::Port>, AddError> {
        let count = Self::Port::default();
        Ok(Opened { outlet: Some(Box::new(Counter(count.clone()))), port: count })
    }
}

#[test]
fn another_crate_adds_a_kind_of_port_of_its_own() {
    let Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let count = scene.open_port(Count).unwrap();
    renderer.render(&mut [&mut [0.0; 100]], &mut [&mut [0.0; 100]]);
    assert_eq!(count.load(std::sync::atomic::Ordering::Relaxed), 100);
}
