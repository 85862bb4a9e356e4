//! Authored clips beside strokes on a haptic channel.

use crate::common;
use crate::counting::heap_operations;

use asperity::{
    ActuatorSettings, ChannelId, Clip, Config, ContactEvent, ContactId, ContactSample, Engine, Renderer,
    Scene, SurfaceId,
};
use common::grating;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 48_000.0;

fn engine(channels: usize) -> (Scene, Renderer, SurfaceId) {
    let config = Config {
        sample_rate_hz: RATE_HZ,
        actuators: vec![ActuatorSettings::default(); channels],
        ..Config::default()
    };
    let Engine { mut scene, renderer, .. } = config.build().unwrap();
    let surface = scene.add_surface(grating(2e-3, 5e-5)).unwrap();
    (scene, renderer, surface)
}

fn stroke(scene: &mut Scene, surface: SurfaceId) {
    let sample = ContactSample::new([0.1, 0.5], 0.6).sliding([0.1, 0.0]);
    scene.report(0.0, ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample)).unwrap();
}

fn on(renderer: &mut Renderer, samples: usize, block: usize) -> Vec<f32> {
    let mut felt = Vec::new();
    while felt.len() < samples {
        let n = block.min(samples - felt.len());
        let mut haptic = vec![vec![0.0; n]; renderer.haptic_channels()];
        let mut audio = vec![0.0; n];
        let mut slices: Vec<&mut [f32]> = haptic.iter_mut().map(Vec::as_mut_slice).collect();
        renderer.render(&mut slices, &mut [&mut audio]);
        felt.extend(&haptic[0]);
    }
    felt
}

fn hum(hz: f64, seconds: f64, rate_hz: f64) -> Vec<f32> {
    (0..(seconds * rate_hz) as usize).map(|n| (0.02 * (TAU * hz * n as f64 / rate_hz).sin()) as f32).collect()
}

#[test]
fn thirty_two_clips_beside_a_stroke_are_their_sum() {
    let clip = |n: usize| Clip {
        gain: 0.5 + 0.1 * n as f64,
        ..Clip::new(hum(60.0 + 7.0 * n as f64, 0.2, RATE_HZ), RATE_HZ)
    };
    let starts_s = |n: usize| 0.01 + 0.002 * n as f64;
    let (mut scene, mut renderer, surface) = engine(1);
    stroke(&mut scene, surface);
    let alone = on(&mut renderer, 16_000, 256);
    let (mut scene, mut renderer, surface) = engine(1);
    stroke(&mut scene, surface);
    (0..32).for_each(|n| scene.play_clip(starts_s(n), ChannelId(0), &clip(n)).unwrap());
    // One more is one too many.
    scene.play_clip(starts_s(32), ChannelId(0), &clip(0)).unwrap();
    let both = on(&mut renderer, 16_000, 256);
    assert_eq!(scene.stats().clips_dropped, 1);
    for (i, felt) in both.iter().enumerate() {
        let clips: f64 = (0..32)
            .map(|n| {
                let at = i as f64 - (starts_s(n) * RATE_HZ).round();
                let edge = 0.002 * RATE_HZ;
                let inside = (0.0..9600.0).contains(&at);
                let from_end = at.min(9599.0 - at);
                let rise = if from_end < edge {
                    0.5 - 0.5 * (std::f64::consts::PI * (from_end + 0.5) / edge).cos()
                } else {
                    1.0
                };
                let wave = 0.02 * (TAU * (60.0 + 7.0 * n as f64) * at / RATE_HZ).sin();
                if inside { rise * (0.5 + 0.1 * n as f64) * wave } else { 0.0 }
            })
            .sum();
        assert!((f64::from(*felt) - f64::from(alone[i]) - clips).abs() < 1e-6, "{i}");
    }
}

#[test]
fn strokes_are_ducked_under_a_clip_without_a_click() {
    let (mut scene, mut renderer, surface) = engine(1);
    stroke(&mut scene, surface);
    let alone = on(&mut renderer, 12_000, 64);
    let (mut scene, mut renderer, surface) = engine(1);
    stroke(&mut scene, surface);
    let silence = Clip { ducking: 0.25, ..Clip::new(vec![0.0; 4800], RATE_HZ) };
    scene.play_clip(0.05, ChannelId(0), &silence).unwrap();
    let ducked = on(&mut renderer, 12_000, 64);
    let ratio =
        |range: std::ops::Range<usize>| common::rms(&ducked[range.clone()]) / common::rms(&alone[range]);
    assert!((ratio(1000..2300) - 1.0).abs() < 1e-9);
    assert!((ratio(4400..7000) - 0.25).abs() < 1e-3, "{}", ratio(4400..7000));
    assert!((ratio(9500..12_000) - 1.0).abs() < 1e-3);
    // What the duck itself adds: no step above −60 dB of what is felt.
    let gain = |i: usize| f64::from(ducked[i]) / f64::from(alone[i]);
    let peak = alone.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
    let strong: Vec<usize> = (2300..9500).filter(|i| alone[*i].abs() > 0.2 * peak).collect();
    for pair in strong.windows(2).filter(|pair| pair[1] == pair[0] + 1) {
        assert!((gain(pair[1]) - gain(pair[0])).abs() < 4e-3, "{}", pair[0]);
    }
}

#[test]
fn a_clip_of_another_rate_is_the_same_wave_without_clicks() {
    for rate_hz in [2000.0, 8000.0, 44_100.0, 96_000.0] {
        let (mut scene, mut renderer, _) = engine(1);
        // A cosine: it begins at its peak.
        let wave = |n: usize| (0.5 * (TAU * 170.0 * n as f64 / rate_hz).cos()) as f32;
        let clip = Clip::new((0..(0.3 * rate_hz) as usize).map(wave).collect(), rate_hz);
        scene.play_clip(0.01, ChannelId(0), &clip).unwrap();
        let felt = on(&mut renderer, 20_000, 256);
        for (i, x) in felt.iter().enumerate().take(13_000).skip(1500) {
            let wanted = 0.5 * (TAU * 170.0 * (i as f64 - 480.0) / RATE_HZ).cos();
            assert!((f64::from(*x) - wanted).abs() < 1e-3, "{rate_hz} Hz, {i}: {x} for {wanted}");
        }
        let steps = felt.windows(2).map(|pair| f64::from((pair[1] - pair[0]).abs()));
        // The steepest of the cosine and of its fade.
        let steepest = 0.5 * (TAU * 170.0 / RATE_HZ + std::f64::consts::FRAC_PI_2 / (0.002 * RATE_HZ));
        assert!(steps.fold(0.0, f64::max) < 1.05 * steepest);
        assert!(felt[15_000..].iter().all(|x| *x == 0.0));
    }
}

#[test]
fn clips_have_the_same_bits_in_any_blocks() {
    let render = |block: usize, plays: bool| {
        let (mut scene, mut renderer, surface) = engine(2);
        stroke(&mut scene, surface);
        if plays {
            let clip = Clip { ducking: 0.4, ..Clip::new(hum(90.0, 0.05, 8000.0), 8000.0) };
            scene.play_clip(0.02, ChannelId(0), &clip).unwrap();
            scene.play_clip(0.0301, ChannelId(0), &clip).unwrap();
        }
        on(&mut renderer, 9000, block)
    };
    let whole = render(4096, true);
    for block in [1, 17, 64, 1000] {
        assert!(render(block, true) == whole, "{block}");
    }
    let plain = render(256, false);
    assert!(whole[..900] == plain[..900] && whole != plain);
}

#[test]
fn a_clip_that_is_none_is_refused_by_name() {
    let (mut scene, _renderer, _) = engine(1);
    let good = Clip::new(vec![0.1; 10], 8000.0);
    for (clip, channel, field) in [
        (Clip { gain: -1.0, ..good.clone() }, 0, "gain"),
        (Clip { ducking: 2.0, ..good.clone() }, 0, "ducking"),
        (Clip { rate_hz: f64::NAN, ..good.clone() }, 0, "rate_hz"),
        (Clip { samples: vec![], ..good.clone() }, 0, "samples"),
        (Clip { samples: vec![0.0, f32::NAN], ..good.clone() }, 0, "samples"),
        (good.clone(), 3, "actuator"),
    ] {
        let refused = scene.play_clip(0.0, ChannelId(channel), &clip).unwrap_err().to_string();
        assert!(refused.starts_with(field), "{refused}");
    }
    scene.play_clip(1.0, ChannelId(0), &good).unwrap();
    assert!(scene.play_clip(0.5, ChannelId(0), &good).unwrap_err().to_string().starts_with("time_s"));
}

#[test]
fn clips_and_bent_time_touch_no_heap_on_the_audio_half() {
    let (mut scene, mut renderer, surface) = engine(1);
    stroke(&mut scene, surface);
    for n in 0..40 {
        scene
            .play_clip(0.001 * f64::from(n), ChannelId(0), &Clip::new(hum(90.0, 0.05, 8000.0), 8000.0))
            .unwrap();
    }
    scene.set_time_scale(0.4, true).unwrap();
    let (mut haptic, mut audio) = ([0.0; 256], [0.0; 256]);
    let mut block = || renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    assert_eq!(heap_operations(|| (0..60).for_each(|_| block())), 0);
    scene.set_time_scale(1.0, true).unwrap();
    assert_eq!(heap_operations(|| (0..60).for_each(|_| block())), 0);
}
