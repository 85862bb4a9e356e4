//! Signals that arrive live at a headset, a pad of four channels and a pad of two motors, against
//! the causal reduction of the same signal offline: scenes and recordings of which none was tuned
//! on.

use crate::reduction::wav;
use asperity::live::channel_map::{ChannelMap, Interleaver};
use asperity::live::ports::{Feed, FrameStage, HeadsetFrame, HeadsetFrames, Levels};
use asperity::{
    Body, ChannelId, Clip as Waveform, Config, ContactEvent, ContactId, ContactSample, Engine, Impact,
    Material, Scene, Stock, Surface,
};
use asperity_dsp::vibration_points::{Point, PointSettings, Tone};
use asperity_evidence::corpus::corpus;
use asperity_ports::{AmplitudePoint, Clip, Device, FrequencyPoint, dualsense, felt, rumble};
use std::f64::consts::TAU;

const RATE_HZ: f64 = 48_000.0;
const POINTS: PointSettings = PointSettings { rate_hz: 100.0, band_hz: [55.0, 200.0], tone: Tone::Drawn };
const TICK_S: f64 = 1.0 / 60.0;
const FROM: Feed = Feed::Haptic(ChannelId(0));

/// A thing to feel: what happens at each tick of 60 Hz.
type Happens = Box<dyn FnMut(&mut Scene, u32)>;
type Build<'a> = dyn Fn(&mut Scene) -> Happens + 'a;

fn engine() -> Engine {
    Config { sample_rate_hz: RATE_HZ, ..Config::default() }.build().unwrap()
}

/// A stroke of a material; it pauses for `rests` of every 60 ticks.
fn stroke(material: Material, speed_m_s: f64, force_n: f64, rests: u32) -> impl Fn(&mut Scene) -> Happens {
    move |scene| {
        let body = scene.add_body(Body::stock(Stock::Plate, material, 0.2).unwrap()).unwrap();
        let top = Surface::flat(0.2, 0.2).unwrap().material(material).body(body);
        let (top, mut touches) = (scene.add_surface(top).unwrap(), false);
        Box::new(move |scene, tick| {
            let t = f64::from(tick) * TICK_S;
            let sample =
                ContactSample::new([0.1 + speed_m_s * t / 0.2, 0.5], force_n).sliding([speed_m_s, 0.0]);
            let lifted = tick % 60 >= 60 - rests;
            let event = match (touches, lifted) {
                (true, true) => ContactEvent::end(ContactId(1)),
                (false, true) => return,
                (true, false) => ContactEvent::moved(ContactId(1), sample),
                (false, false) => ContactEvent::begin(ContactId(1), top, ChannelId(0), sample),
            };
            touches = !lifted;
            scene.report(t, event).unwrap();
        })
    }
}

fn strikes(scene: &mut Scene) -> Happens {
    let bell = scene.add_body(Body::stock(Stock::Bar, Material::WOOD, 0.3).unwrap()).unwrap();
    Box::new(move |scene, tick| {
        if tick % 24 == 12 {
            let blow = Impact::from_impulse(bell, 0.01, 0.5, 0.6).felt_by(ChannelId(0));
            scene.report(f64::from(tick) * TICK_S, ContactEvent::Impact(blow)).unwrap();
        }
    })
}

fn recording(samples: Vec<f64>, rate_hz: f64) -> impl Fn(&mut Scene) -> Happens {
    move |_| {
        let clip = Waveform::new(samples.iter().map(|x| *x as f32).collect(), rate_hz);
        Box::new(move |scene, tick| {
            if tick == 12 {
                scene.play_clip(12.0 * TICK_S, ChannelId(0), &clip).unwrap();
            }
        })
    }
}

/// All of the haptic and the audio channel, by a render without a port.
fn offline(seconds: f64, build: &Build<'_>) -> [Vec<f32>; 2] {
    let Engine { mut scene, mut renderer, .. } = engine();
    let mut happens = build(&mut scene);
    let mut left = [Vec::new(), Vec::new()];
    for tick in 0..(seconds / TICK_S) as u32 {
        happens(&mut scene, tick);
        let (mut haptic, mut audio) = ([0.0; 800], [0.0; 800]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        left[0].extend(haptic);
        left[1].extend(audio);
    }
    left
}

/// Frames one behind another in the time of their calls, as a runtime plays them.
fn as_clip(frames: &[(f64, HeadsetFrame)]) -> Clip {
    let mut clip = Clip::default();
    let (mut began_s, mut last_s) = (0.0, 0.0);
    let mut add = |time_s: f64, amplitude: f64, frequency: f64| {
        last_s = time_s.max(last_s);
        clip.amplitude.push(AmplitudePoint { time_s: last_s, amplitude, emphasis: None });
        clip.frequency.push(FrequencyPoint { time_s: last_s, frequency });
    };
    add(0.0, 0.0, 0.0);
    for (now_s, frame) in frames {
        if frame.stage == FrameStage::First {
            began_s = *now_s;
            add(began_s, 0.0, f64::from(frame.points[0].frequency));
        }
        for point in &frame.points {
            let time_s = began_s + point.time_ns as f64 * 1e-9;
            add(time_s, f64::from(point.amplitude), f64::from(point.frequency));
        }
    }
    clip
}

fn reduced(points: &[Point], full_scale: f64, device: &Device) -> Clip {
    let mut clip = Clip::default();
    for point in points {
        let time_s = point.tick as f64 / POINTS.rate_hz;
        let amplitude = (point.amplitude / full_scale).min(1.0);
        clip.amplitude.push(AmplitudePoint { time_s, amplitude, emphasis: None });
        clip.frequency.push(FrequencyPoint { time_s, frequency: device.frequency(point.frequency_hz) });
    }
    clip
}

/// Largest difference of third octaves of the device's range, dB; what lies 30 dB below the
/// strongest counts as that. No device promises the phase of its oscillator, and a blow that is as
/// short as a period depends on it: power is that of sine and cosine.
fn apart_db(was: &Clip, is: &Clip, device: &Device) -> f64 {
    let [was, is] = [was, is].map(|clip| third_octaves(clip, device));
    let floor = was.iter().copied().fold(0.0, f64::max) * 1e-3;
    was.iter().zip(&is).map(|(a, b)| (10.0 * (b.max(floor) / a.max(floor)).log10()).abs()).fold(0.0, f64::max)
}

fn third_octaves(clip: &Clip, device: &Device) -> Vec<f64> {
    let mut turns = 0.0;
    let waves = clip.sampled(felt::RATE_HZ).map(|(amplitude, frequency)| {
        let (sine, cosine) = f64::sin_cos(TAU * turns);
        turns += device.hz(frequency) / felt::RATE_HZ;
        (amplitude * sine, amplitude * cosine)
    });
    let (sine, cosine): (Vec<f64>, Vec<f64>) = waves.unzip();
    // Bins of one width, whichever of two is longer: beyond its end a wave is nothing.
    let count = (5.0 * felt::RATE_HZ) as usize;
    assert!(sine.len() <= count);
    let [low_hz, high_hz] = device.band_hz;
    let centres_hz = (-13..-5).map(|k| 1000.0 * 2f64.powf(f64::from(k) / 3.0));
    let inside = centres_hz.filter(|hz| (low_hz * 0.9..high_hz * 1.1).contains(hz));
    let power = |centre_hz: f64| {
        let bin = |side: f64| (5.0 * centre_hz * 2f64.powf(side / 6.0)).ceil() as usize;
        let bins = (bin(-1.0)..bin(1.0)).map(|bin| bin as f64 / count as f64);
        bins.map(|turns| bin_power(&sine, turns) + bin_power(&cosine, turns)).sum()
    };
    inside.map(power).collect()
}

fn bin_power(x: &[f64], turns_a_sample: f64) -> f64 {
    // Goertzel's recursion.
    let c = 2.0 * (TAU * turns_a_sample).cos();
    let (a, b) = x.iter().fold((0.0, 0.0), |(a, b), x| (x + c * a - b, a));
    a * a + b * b - c * a * b
}

/// Frames hold the points of the reduction one by one, but for the silence that begins and that
/// which ends a stream.
fn same_points(name: &str, frames: &[(f64, HeadsetFrame)], reduced: &Clip) {
    let points: Vec<[f32; 2]> = reduced
        .amplitude
        .iter()
        .zip(&reduced.frequency)
        .map(|(a, f)| [a.amplitude as f32, f.frequency as f32])
        .collect();
    let mut at = 0;
    for (_, HeadsetFrame { stage, points: framed, .. }) in frames {
        let silent = if *stage == FrameStage::First { 2 } else { 0 };
        let near =
            |point: &[f32; 2], framed: [f32; 2]| point.iter().zip(framed).all(|(a, b)| (a - b).abs() < 1e-5);
        let value = |index: usize| [framed[index].amplitude, framed[index].frequency];
        if silent > 0 {
            let ahead = points[at..].iter().position(|point| near(point, value(silent)));
            at += ahead.unwrap_or_else(|| panic!("{name}: a point of nothing"));
        }
        let kept = framed.len() - usize::from(*stage == FrameStage::Last);
        for index in silent..kept {
            assert!(
                near(&points[at + index - silent], value(index)),
                "{name}: point {}",
                at + index - silent
            );
        }
        at += framed.len() - silent;
    }
}

/// Errors of what arrives live at the three devices: of third octaves, and the largest of motor
/// levels, dB.
fn arrives(name: &str, seconds: f64, build: &Build<'_>) -> [f64; 2] {
    let device = Device::quest();
    let [haptic, audio] = offline(seconds, build);
    let was: Vec<f64> = haptic.iter().map(|x| f64::from(*x)).collect();
    let points = rumble::causal(&was, RATE_HZ, POINTS).unwrap();
    let full_scale = points.iter().map(|point| point.amplitude).fold(0.0, f64::max);
    assert!(full_scale > 0.0, "{name}: nothing to feel");
    let Engine { mut scene, renderer, .. } = engine();
    let mut happens = build(&mut scene);
    let kind = HeadsetFrames { from: FROM, settings: POINTS, full_scale, first_frame_s: 0.05, holds_s: 0.25 };
    let mut headset = scene.open_port(kind).unwrap();
    let mut motors = scene.open_port(Levels { from: FROM, rate_hz: 60.0, holds_s: 0.25 }).unwrap();
    let mut pad = Interleaver::new(renderer, ChannelMap::dualsense());
    let (mut frames, mut levels, mut four) = (Vec::new(), Vec::new(), Vec::new());
    for tick in 0..(seconds / TICK_S) as u32 {
        happens(&mut scene, tick);
        let mut block = [0.0; 4 * 800];
        pad.fill(&mut block, 4);
        four.extend(block);
        let now_s = f64::from(tick + 1) * TICK_S;
        frames.extend(std::iter::from_fn(|| headset.read(now_s)).map(|frame| (now_s, frame)));
        levels.extend(std::iter::from_fn(|| motors.read()));
    }
    assert_eq!(headset.counts().dropped + motors.lost(), 0, "{name}");
    // The pad's four channels are those of the render, to the bit.
    let frames_of_four = dualsense::four_channels([&audio, &audio], [&haptic, &[]]);
    let differ = four
        .chunks_exact(4)
        .zip(&frames_of_four)
        .filter(|(is, was)| is.iter().zip(*was).any(|(is, was)| is.clamp(-1.0, 1.0) != *was));
    assert_eq!((differ.count(), four.len()), (0, 4 * frames_of_four.len()), "{name}");
    let expected = rumble::levels(&was, RATE_HZ, 60.0).unwrap();
    // 30 dB below the loudest level, and 20 counts of the motor's 65,535, count as that.
    let loudest = expected.iter().flatten().copied().max().unwrap_or(0);
    let floor = (f64::from(loudest) / 32.0).max(20.0);
    let motors_db = expected.iter().zip(&levels).flat_map(|(was, is)| was.iter().zip(is)).map(|(was, is)| {
        let [was, is] = [f64::from(*was), is.min(1.0) * 65_535.0].map(|x| x.max(floor));
        (20.0 * (is / was).log10()).abs()
    });
    let motors_db = motors_db.fold(0.0, f64::max);
    let reduced = reduced(&points, full_scale, &device);
    same_points(name, &frames, &reduced);
    let frames_db = apart_db(&reduced, &as_clip(&frames), &device);
    println!(
        "{name}: {} frames, third octaves within {frames_db:.2} dB; motors within {motors_db:.3} dB",
        frames.len()
    );
    [frames_db, motors_db]
}

#[test]
fn five_strokes_arrive_as_the_causal_reduction_has_them() {
    let scenes: [(&str, Box<Build<'_>>); 5] = [
        ("ceramic", Box::new(stroke(Material::CERAMIC, 0.1, 0.6, 0))),
        ("wood", Box::new(stroke(Material::WOOD, 0.05, 1.0, 0))),
        ("steel, fast", Box::new(stroke(Material::STEEL, 0.25, 2.0, 0))),
        ("brass, in strokes", Box::new(stroke(Material::BRASS, 0.12, 0.8, 20))),
        ("glass, lightly", Box::new(stroke(Material::GLASS, 0.07, 0.2, 5))),
    ];
    for (name, build) in &scenes {
        let errors_db = arrives(name, 4.0, &build);
        assert!(errors_db.iter().all(|db| *db <= 1.0), "{name}: {errors_db:?}");
    }
}

/// A blow is shorter than the first frame that a runtime wants.
#[test]
fn blows_and_their_recordings_arrive_as_short_and_strong() {
    let errors_db = arrives("a bar that is struck", 4.0, &strikes);
    assert!(errors_db.iter().all(|db| *db <= 1.0), "{errors_db:?}");
    let Some(folder) = corpus("impacts") else { return };
    for name in [
        "glockenspiel_2096.57",
        "js30_metal-ping-1",
        "kenney_impactBell_heavy_000",
        "vcsl_Claves1_Hit_v3_rr1_Mid",
        "vcsl_xylo_medium_C5_ff",
    ] {
        let (samples, rate_hz) = wav(&folder.join(format!("{name}.wav")));
        let seconds = (samples.len() as f64 / rate_hz).min(4.0) + 0.5;
        let errors_db = arrives(name, seconds, &recording(samples, rate_hz));
        assert!(errors_db.iter().all(|db| *db <= 1.0), "{name}: {errors_db:?}");
    }
}
