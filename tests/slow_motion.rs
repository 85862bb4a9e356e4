//! Slow motion whose pitch bends: what leaves is a tape of what happens in the game's time.

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::{Body, BodyId, Config, ContactEvent, Engine, Impact, ModalModel, Mode, Renderer, Scene};
use std::collections::HashMap;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;

/// A body of one mode.
fn tone(frequency_hz: f64, decay_per_s: f64) -> Body {
    let mode = Mode { frequency_hz, decay_per_s, amplitude: 0.3, phase_rad: 0.0 };
    Body::new(ModalModel::new(vec![mode], 0.01).unwrap())
}

fn engine(body: Body) -> (Scene, Renderer, BodyId) {
    let Engine { mut scene, renderer, .. } = Config::default().build().unwrap();
    let body = scene.add_body(body).unwrap();
    (scene, renderer, body)
}

/// Renders so many samples of sound in blocks.
fn on(renderer: &mut Renderer, samples: usize, block: usize, into: &mut Vec<f32>) {
    let end = into.len() + samples;
    while into.len() < end {
        let n = block.min(end - into.len());
        let (mut haptic, mut audio) = (vec![0.0; n], vec![0.0; n]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        into.extend(audio);
    }
}

/// Frequency between the first and the last upward crossing, Hz.
fn frequency_hz(x: &[f32]) -> f64 {
    let rises = x.windows(2).enumerate().filter(|(_, pair)| pair[0] < 0.0 && pair[1] >= 0.0);
    let at: Vec<f64> = rises.map(|(i, p)| i as f64 + f64::from(-p[0]) / f64::from(p[1] - p[0])).collect();
    (at.len() - 1) as f64 / (at[at.len() - 1] - at[0]) * RATE_HZ
}

#[test]
fn a_bell_sounds_as_low_and_as_long_as_time_runs_slowly() {
    for scale in [0.1, 0.25, 0.5, 0.8, 1.0, 1.5, 2.0] {
        let (mut scene, mut renderer, body) = engine(tone(800.0, 3.0));
        let mut sound = Vec::new();
        on(&mut renderer, 100, 64, &mut sound);
        scene.report(0.01, ContactEvent::Impact(Impact::on(body))).unwrap();
        scene.set_time_scale(scale, true).unwrap();
        on(&mut renderer, 60_000, 256, &mut sound);
        let rings = &sound[(2000.0 / scale) as usize..(2000.0 / scale) as usize + 20_000];
        let ratio = frequency_hz(rings) / (800.0 * scale);
        assert!((ratio - 1.0).abs() < 1e-3, "{scale}: {ratio}");
        // A damped sine obeys its own recurrence: nothing else is heard.
        let (r, w) = ((-3.0 * scale / RATE_HZ).exp(), TAU * 800.0 * scale / RATE_HZ);
        let peak = rings.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        for three in rings.windows(3) {
            let [a, b, c] = [0, 1, 2].map(|i| f64::from(three[i]));
            let rest = c - 2.0 * r * w.cos() * b + r * r * a;
            assert!(rest.abs() < 1e-4 * f64::from(peak), "{scale}: {rest} of {peak}");
        }
    }
}

/// A strike, time that slows down, runs fast, and is itself again.
fn bent(block: usize) -> Vec<f32> {
    let (mut scene, mut renderer, body) = engine(tone(523.0, 2.0));
    scene.report(0.001, ContactEvent::Impact(Impact::on(body))).unwrap();
    let mut sound = Vec::new();
    for (scale, samples) in [(1.0, 3000), (0.3, 5000), (1.7, 3333), (0.71, 1000), (1.0, 9000)] {
        scene.set_time_scale(scale, true).unwrap();
        on(&mut renderer, samples, block, &mut sound);
    }
    sound
}

#[test]
fn however_blocks_are_cut_bent_sound_has_the_same_bits() {
    let whole = bent(4096);
    for block in [1, 63, 64, 441] {
        assert!(bent(block) == whole, "{block}");
    }
}

#[test]
fn time_that_is_itself_again_leaves_no_trace_and_no_click() {
    let sound = bent(256);
    let (mut scene, mut renderer, body) = engine(tone(523.0, 2.0));
    scene.report(0.001, ContactEvent::Impact(Impact::on(body))).unwrap();
    let mut plain = Vec::new();
    on(&mut renderer, 30_000, 256, &mut plain);
    // The same samples, as many later as were missed.
    let last = &sound[sound.len() - 4000..];
    assert!((0..plain.len() - 4000).any(|at| plain[at..at + 4000] == *last));
    // No step beyond what the steepest sine makes.
    let peak = sound.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
    let steepest = 1.05 * TAU * 523.0 * 1.7 / RATE_HZ;
    let steps = sound[200..].windows(2).map(|pair| (pair[1] - pair[0]).abs());
    assert!(f64::from(steps.fold(0.0, f32::max)) < steepest * f64::from(peak));
}

fn rendered(log: &str, block_frames: usize) -> offline::Render {
    let (scene, renderer, body) = engine(tone(800.0, 30.0));
    let names = Names { bodies: HashMap::from([("bell".to_owned(), body)]), ..Names::default() };
    let log = ContactLog::parse(log, "log").unwrap();
    let options = Options { block_frames, tail_s: 0.5, ..Options::default() };
    offline::render(scene, renderer, &log, &names, &options).unwrap()
}

/// Samples at which something begins to sound after silence.
fn onsets(x: &[f32]) -> Vec<usize> {
    let mut quiet = usize::MAX;
    let mut found = Vec::new();
    for (i, x) in x.iter().enumerate() {
        if x.abs() > 1e-4 {
            if quiet > 400 {
                found.push(i);
            }
            quiet = 0;
        } else {
            quiet = quiet.saturating_add(1);
        }
    }
    found
}

#[test]
fn a_log_runs_as_slowly_as_its_line_says_from_there_on() {
    let strike = |t: f64| {
        format!(
            "{{\"t\":{t},\"event\":\"impact\",\"body\":\"bell\",\"speed_m_s\":1.0,\"mass_kg\":0.01,\"radius_m\":0.005,\"striker\":\"steel\"}}\n"
        )
    };
    for bend in [false, true] {
        let slow = format!("{{\"t\":1.0,\"event\":\"time_scale\",\"scale\":0.5,\"bend_pitch\":{bend}}}\n");
        let back = "{\"t\":2.0,\"event\":\"time_scale\",\"scale\":1.0}\n";
        let log = [strike(0.5), slow, strike(1.5), back.to_owned(), strike(3.0)].concat();
        let take = rendered(&log, 256);
        // Half a second before, one game second in two, and one more.
        for (onset, due_s) in onsets(&take.audio[0]).iter().zip([0.5, 2.0, 4.0]) {
            let heard_s = *onset as f64 / RATE_HZ;
            assert!((heard_s - due_s).abs() < 2e-3, "bent {bend}: {heard_s} for {due_s} s");
        }
        assert_eq!(onsets(&take.audio[0]).len(), 3);
        assert!((take.duration_s() - 4.5).abs() < 1e-3, "{}", take.duration_s());
        let rings = &take.audio[0][(2.01 * RATE_HZ) as usize..][..2000];
        let wanted_hz = if bend { 400.0 } else { 800.0 };
        assert!((frequency_hz(rings) / wanted_hz - 1.0).abs() < 1e-3, "{}", frequency_hz(rings));
        assert!(rendered(&log, 33).audio == take.audio);
    }
}

#[test]
fn a_recording_of_bent_time_replays_to_the_bit() {
    let (mut scene, mut renderer, body) = engine(tone(800.0, 30.0));
    let names = Names { bodies: HashMap::from([("bell".to_owned(), body)]), ..Names::default() };
    scene.start_recording(&names);
    let mut sound = Vec::new();
    let mut time_s = 0.0;
    for (step, scale) in [1.0, 0.4, 0.4, 1.3, 1.0, 1.0, 1.0].into_iter().enumerate() {
        scene.set_time_scale(scale, true).unwrap();
        if step < 6 {
            scene.report(time_s + 0.02, ContactEvent::Impact(Impact::on(body))).unwrap();
        }
        on(&mut renderer, 4410, 128, &mut sound);
        time_s += 0.1 * scale;
    }
    let recorded = scene.stop_recording();
    let mut text = Vec::new();
    recorded.write(&mut text).unwrap();
    let take = rendered(std::str::from_utf8(&text).unwrap(), 256);
    let latency = renderer.latency_samples();
    assert!(take.audio[0].len() > 20_000);
    assert!(take.audio[0][..20_000] == sound[latency..latency + 20_000]);
}

#[test]
fn a_scale_out_of_range_is_refused_by_name() {
    let (mut scene, _renderer, _) = engine(tone(800.0, 3.0));
    for (scale, bend_pitch) in [(0.0, false), (f64::NAN, true), (0.05, true), (2.5, true)] {
        let refused = scene.set_time_scale(scale, bend_pitch).unwrap_err().to_string();
        assert!(refused.starts_with("time_scale"), "{refused}");
    }
    for wrong in ["\"scale\":0.01,\"bend_pitch\":true", "\"scale\":0.0"] {
        let log = format!("{{\"t\":0.5,\"event\":\"time_scale\",{wrong}}}\n");
        let (scene, renderer, _) = engine(tone(800.0, 3.0));
        let log = ContactLog::parse(&log, "log").unwrap();
        assert!(offline::render(scene, renderer, &log, &Names::default(), &Options::default()).is_err());
    }
}
