//! Formats: what is written keeps every rule, comes back as it was, and nothing broken gets in.

use asperity_dsp::rng::Rng;
use asperity_ports::{AmplitudePoint, Clip, Device, Emphasis, FrequencyPoint, Read};
use asperity_ports::{ahap, android, haptic_file, hjif, keyframes, oscillator, xr};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Any clip that keeps the rules, jumps and strokes among its points.
fn clips() -> impl Strategy<Value = Clip> {
    let amplitude = prop::collection::vec(
        (0.0..0.4_f64, 0.0..=1.0_f64, prop::option::of((0.0..=1.0_f64, 0.0..=1.0_f64))),
        1..700,
    );
    let frequency = prop::collection::vec((0.0..=1.0_f64, 0.0..=1.0_f64), 0..700);
    (amplitude, frequency).prop_map(|(steps, tones)| {
        let mut time_s = 0.0;
        let mut points = vec![AmplitudePoint { time_s: 0.0, amplitude: 0.3, emphasis: None }];
        for (step_s, amplitude, stroke) in steps {
            time_s += if step_s < 0.02 { 0.0 } else { step_s };
            let emphasis = stroke.map(|(above, frequency)| Emphasis {
                amplitude: amplitude + above * (1.0 - amplitude),
                frequency,
            });
            points.push(AmplitudePoint { time_s, amplitude, emphasis });
        }
        time_s += 0.01;
        points.push(AmplitudePoint { time_s, amplitude: 0.0, emphasis: None });
        let mut tones: Vec<FrequencyPoint> = tones
            .into_iter()
            .map(|(at, frequency)| FrequencyPoint { time_s: at * time_s, frequency })
            .collect();
        tones.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        Clip { amplitude: points, frequency: tones, ..Clip::default() }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn a_haptic_file_comes_back_to_the_bit(clip in clips()) {
        let back = haptic_file::parse(&haptic_file::write(&clip).unwrap()).unwrap();
        prop_assert_eq!(back, Read { clip, remarks: Vec::new() });
    }

    #[test]
    fn no_ahap_curve_exceeds_16_points_and_no_event_30_s(clip in clips()) {
        let files = ahap::write(&clip, None).unwrap();
        let file: serde_json::Value = serde_json::from_str(&files.main).unwrap();
        let mut ends_s = 0.0;
        for item in file["Pattern"].as_array().unwrap() {
            if let Some(points) = item["ParameterCurve"]["ParameterCurveControlPoints"].as_array() {
                prop_assert!((1..=ahap::MOST_POINTS).contains(&points.len()));
                prop_assert_eq!(points[0]["Time"].as_f64(), Some(0.0));
                prop_assert!(points.windows(2).all(|w| w[0]["Time"].as_f64() <= w[1]["Time"].as_f64()));
                prop_assert!(points.iter().all(|p| (0.0..=1.0).contains(&p["ParameterValue"].as_f64().unwrap())));
            } else {
                prop_assert_eq!(item["Event"]["EventType"].as_str(), Some("HapticContinuous"));
                let length_s = item["Event"]["EventDuration"].as_f64().unwrap();
                prop_assert!(length_s > 0.0 && length_s <= ahap::LONGEST_EVENT_S);
                ends_s = item["Event"]["Time"].as_f64().unwrap() + length_s;
            }
        }
        prop_assert!((ends_s - clip.duration_s()).abs() < 1e-6);
        prop_assert_eq!(files.transients.is_some(), clip.amplitude.iter().any(|p| p.emphasis.is_some()));
    }

    #[test]
    fn an_ahap_comes_back_with_the_same_envelopes(clip in clips()) {
        let files = ahap::write(&clip, None).unwrap();
        let back = match &files.transients {
            Some(strokes) => ahap::parse_both(&files.main, strokes),
            None => ahap::parse(&files.main),
        }.unwrap().clip;
        prop_assert!((back.duration_s() - clip.duration_s()).abs() < 1e-6);
        // At every place but the jumps, where both sides are right.
        let jumps: Vec<f64> = clip.amplitude.windows(2).filter(|w| w[0].time_s == w[1].time_s).map(|w| w[0].time_s).collect();
        let near_jump = |t: f64| jumps.iter().any(|j| (j - t).abs() < 2e-3);
        let times: Vec<f64> = clip.amplitude.iter().map(|p| p.time_s).filter(|t| !near_jump(*t) && *t < clip.duration_s()).collect();
        for t in times {
            let at = |clip: &Clip| clip.amplitude.iter().find(|p| (p.time_s - t).abs() < 1e-7).map(|p| p.amplitude);
            let (was, is) = (at(&clip).unwrap(), at(&back));
            // A ramp may rise by 100 a second, and times agree to 1e-7 s.
            prop_assert!(is.is_some_and(|is| (was - is).abs() < 1e-5), "at {t} s: {was} {is:?}");
        }
        let strokes = |clip: &Clip| clip.amplitude.iter().filter(|p| p.emphasis.is_some()).count();
        prop_assert!(strokes(&back) <= strokes(&clip));
    }

    #[test]
    fn a_phones_file_keeps_its_rules(clip in clips()) {
        let file = android::file(&clip, &Device::quest()).unwrap();
        let waveform = &file.waveform;
        prop_assert_eq!(waveform.timings_ms.len(), waveform.amplitudes.len());
        prop_assert!(waveform.timings_ms.iter().all(|t| *t > 0) && waveform.amplitudes.iter().all(|a| *a >= 1));
        prop_assert_eq!(waveform.timings_ms.iter().sum::<u64>(), (clip.duration_s() * 1e3).round().max(1.0) as u64);
        prop_assert_eq!(file.basic_envelope.last().unwrap().intensity, 0.0);
        prop_assert_eq!(file.waveform_envelope.last().unwrap().amplitude, 0.0);
        for (basic, physical) in file.basic_envelope.iter().zip(&file.waveform_envelope) {
            prop_assert!((android::LEAST_MS..=android::MOST_MS).contains(&physical.duration_ms));
            prop_assert_eq!(basic.duration_ms, physical.duration_ms);
            prop_assert!((0.0..=1.0).contains(&basic.intensity) && (0.0..=1.0).contains(&basic.sharpness));
            prop_assert!((0.0..=1.0).contains(&physical.amplitude) && (55.0..=200.0).contains(&physical.frequency_hz));
        }
    }

    #[test]
    fn no_parametric_frame_breaks_a_rule_of_the_specification(clip in clips(), first_frame_s in 0.0..0.3_f64) {
        let device = Device::quest();
        let Ok(frames) = xr::frames(&clip, &device, first_frame_s) else { return Ok(()) };
        prop_assert_eq!(xr::broken_rule(&frames, first_frame_s), None);
        let ends_s = frames.last().and_then(xr::Frame::ends_ns).unwrap() as f64 * 1e-9;
        prop_assert!((ends_s - clip.duration_s().max(first_frame_s)).abs() < 1e-6 || frames.len() > 1);
        prop_assert!((ends_s - clip.duration_s()).abs() < 1e-6 || frames.len() == 1);
    }

    #[test]
    fn frames_as_they_were_written_once_are_refused(clip in clips()) {
        // Times of each frame from 0, and the range of frequencies in every one.
        let Ok(mut frames) = xr::frames(&clip, &Device::quest(), 0.05) else { return Ok(()) };
        let Some(later) = frames.get_mut(1) else { return Ok(()) };
        let was = later.clone();
        (later.min_frequency_hz, later.max_frequency_hz) = (55.0, 200.0);
        prop_assert_eq!(xr::broken_rule(&frames, 0.05), Some((1, "a later frame says its frequencies")));
        frames[1] = was;
        frames[1].amplitude.iter_mut().for_each(|point| point.time_ns /= 1000);
        prop_assert_eq!(xr::broken_rule(&frames, 0.05), Some((1, "times fall")));
    }

    #[test]
    fn broken_files_are_refused_in_one_line_or_read(seed in 0_u64..4000) {
        let mut rng = Rng::new(seed);
        let clip = Clip {
            amplitude: (0..40).map(|i| AmplitudePoint {
                time_s: 0.01 * f64::from(i),
                amplitude: 0.5,
                emphasis: (i % 7 == 0).then_some(Emphasis { amplitude: 0.9, frequency: 0.2 }),
            }).collect(),
            frequency: vec![FrequencyPoint { time_s: 0.0, frequency: 0.1 }],
            ..Clip::default()
        };
        let wave: Vec<f64> = (0..400).map(|n| 0.5 * (0.1 * f64::from(n)).sin()).collect();
        let texts = [
            haptic_file::write(&clip).unwrap(),
            ahap::write(&clip, Some("a.wav")).unwrap().main,
            hjif::write(&wave, 1000.0, 40.0, "").unwrap().text,
        ];
        for (kind, text) in texts.iter().enumerate() {
            let broken = mutated(text, &mut rng);
            let refused = match kind {
                0 => haptic_file::parse(&broken).err(),
                1 => ahap::parse(&broken).err(),
                _ => hjif::rendered(&broken, 0).err(),
            };
            if let Some(error) = refused {
                prop_assert!(!error.to_string().contains('\n') && error.to_string().contains("; "), "{error}");
            }
            prop_assert!(Device::parse(&broken).is_err());
        }
    }
}

/// A few characters changed, taken out, doubled, or a number made absurd.
fn mutated(text: &str, rng: &mut Rng) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + rng.next_u32() % 4 {
        let at = rng.next_u32() as usize % bytes.len();
        match rng.next_u32() % 5 {
            0 => bytes[at] = b" {}[]\",:-09eE.truenl"[rng.next_u32() as usize % 20],
            1 => bytes.truncate(at.max(1)),
            2 => {
                let end = (at + 1 + rng.next_u32() as usize % 30).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            3 => {
                bytes.remove(at);
                if bytes.is_empty() {
                    bytes.push(b'{');
                }
            }
            _ => {
                if let Some(digit) = (at..bytes.len()).find(|i| bytes[*i].is_ascii_digit()) {
                    let absurd: &[u8] = [b"1e308".as_slice(), b"-5", b"1e999", b"99999999999", b"null"]
                        [rng.next_u32() as usize % 5];
                    bytes.splice(digit..=digit, absurd.iter().copied());
                }
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn each_rule_of_a_clip_is_refused_by_its_point() {
    let good = r#"{"version":{"major":1,"minor":0,"patch":0},"signals":{"continuous":{"envelopes":{"amplitude":[{"time":0,"amplitude":0.2},{"time":1,"amplitude":0.5,"emphasis":{"amplitude":0.6,"frequency":0.7}}],"frequency":[{"time":0.5,"frequency":0.9}]}}}}"#;
    assert!(haptic_file::parse(good).is_ok());
    for (from, to, at) in [
        ("\"amplitude\":0.2", "\"amplitude\":1.2", "amplitude[0].amplitude"),
        ("\"time\":1,", "\"time\":-1,", "amplitude[1].time"),
        ("\"time\":1,", "\"time\":0,", "lasts 0 s"),
        ("\"amplitude\":0.6", "\"amplitude\":0.4", "amplitude[1].emphasis.amplitude"),
        ("\"frequency\":0.7", "\"frequency\":7", "amplitude[1].emphasis.frequency"),
        ("\"frequency\":0.9", "\"frequency\":-0.9", "frequency[0].frequency"),
        ("\"major\":1", "\"major\":2", "version"),
        ("\"signals\"", "\"signal\"", "haptic"),
    ] {
        let error = haptic_file::parse(&good.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(at), "{error} lacks {at}");
    }
    let late = haptic_file::parse(&good.replace("\"time\":0.5", "\"time\":1.5")).unwrap();
    assert!(late.remarks[0].contains("1 frequency points") && late.clip.frequency.is_empty());
}

/// What a phone plays: the square of the intensities that its curve joins by straight lines.
fn played(file: &str, time_s: f64) -> f64 {
    let file: serde_json::Value = serde_json::from_str(file).unwrap();
    let curves = file["Pattern"].as_array().unwrap().iter().map(|item| &item["ParameterCurve"]);
    let curves = curves.filter(|curve| curve["ParameterID"] == "HapticIntensityControl");
    let points = curves.flat_map(|curve| {
        let begins_s = curve["Time"].as_f64().unwrap();
        let points = curve["ParameterCurveControlPoints"].as_array().unwrap().iter();
        points.map(move |p| (begins_s + p["Time"].as_f64().unwrap(), p["ParameterValue"].as_f64().unwrap()))
    });
    let points: Vec<(f64, f64)> = points.collect();
    let after = points.partition_point(|p| p.0 <= time_s).clamp(1, points.len() - 1);
    let ((from_s, a), (to_s, b)) = (points[after - 1], points[after]);
    let part = if to_s > from_s { (time_s - from_s) / (to_s - from_s) } else { 1.0 };
    (a + part * (b - a)).powi(2)
}

#[test]
fn a_slow_fade_is_as_strong_in_an_ahap_halfway() {
    for (a, b) in [(0.0, 1.0), (1.0, 0.0), (0.02, 0.7), (0.9, 0.3), (0.5, 0.5), (0.0, 0.0004)] {
        let point = |time_s, amplitude| AmplitudePoint { time_s, amplitude, emphasis: None };
        let clip = Clip { amplitude: vec![point(0.0, a), point(1.0, b), point(3.0, b)], ..Clip::default() };
        let file = ahap::write(&clip, None).unwrap().main;
        let mut back = ahap::parse(&file).unwrap().clip;
        for time_s in (1..100).map(|i| f64::from(i) / 100.0) {
            let (expected, is) = (a + time_s * (b - a), played(&file, time_s));
            let off_db = 20.0 * (is / expected).log10();
            assert!(
                is == expected || off_db.abs() < 0.3 || (is - expected).abs() < 0.001,
                "{a} {b} {time_s}: {is}"
            );
        }
        // What is read and written again grows by nothing.
        let points = back.amplitude.len();
        assert!(points < 20, "{points}");
        for _ in 0..3 {
            back = ahap::parse(&ahap::write(&back, None).unwrap().main).unwrap().clip;
        }
        assert_eq!(back.amplitude.len(), points, "{a} {b}");
    }
}

#[test]
fn sounds_and_strokes_of_an_ahap_are_where_they_belong() {
    let stroke = Some(Emphasis { amplitude: 0.64, frequency: 0.3 });
    let point = |time_s, amplitude, emphasis| AmplitudePoint { time_s, amplitude, emphasis };
    let silent = Clip { amplitude: vec![point(0.0, 0.0, stroke), point(1.0, 0.0, None)], ..Clip::default() };
    let files = ahap::write(&silent, Some("hit.wav")).unwrap();
    assert!(
        files.transients.is_none()
            && files.main.contains("HapticTransient")
            && files.main.contains("hit.wav")
    );
    assert!(files.main.contains("\"ParameterValue\":0.8"));
    let loud = Clip { amplitude: vec![point(0.0, 0.25, stroke), point(1.0, 0.0, None)], ..Clip::default() };
    let files = ahap::write(&loud, None).unwrap();
    assert!(!files.main.contains("HapticTransient") && files.transients.unwrap().contains("HapticTransient"));
}

#[test]
fn a_curve_keeps_a_500_hz_sine_to_30_db() {
    for (frequency_hz, points_per_s) in
        [(500.0, 4000.0), (487.3, 4000.0), (300.0, 4000.0), (150.0, 2000.0), (60.0, 1000.0)]
    {
        let wave: Vec<f64> =
            (0..8000).map(|n| 0.9 * (TAU * frequency_hz * f64::from(n) / 8000.0).sin()).collect();
        let written = hjif::write(&wave, points_per_s, 60.0, "").unwrap();
        let energy: f64 = wave.iter().map(|x| x * x).sum();
        let error: f64 = wave.iter().zip(&written.samples).map(|(a, b)| (a - b).powi(2)).sum();
        let snr_db = 10.0 * (energy / error).log10();
        println!("{frequency_hz} Hz: {snr_db:.1} dB, {} keyframes", written.keyframes);
        assert!(snr_db >= 30.0 && written.keyframes <= points_per_s as usize, "{frequency_hz} Hz: {snr_db}");
        let read = hjif::rendered(&written.text, 0).unwrap();
        assert_eq!(read.len(), wave.len());
        let worst = read.iter().zip(&written.samples).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "the reader differs from the writer by {worst}");
    }
    let few = keyframes::keyframes(&[0.0, 1.0, 0.0], 2, 300.0);
    assert_eq!((few.len(), few[0].0, few[1].0), (2, 0, 2));
}

#[test]
fn others_waves_and_transients_are_rendered_and_the_rest_named() {
    let file = |bands: &str| {
        format!(
            r#"{{"timescale":1000,"perceptions":[{{"effect_library":[{{"id":7,"effect_type":"Basis","base_signal":"Sine","keyframes":[{{"relative_position":0,"amplitude_modulation":0.5,"frequency_modulation":100}},{{"relative_position":500,"amplitude_modulation":0.5,"frequency_modulation":100}}]}}],"channels":[{{"gain":2.0,"bands":[{bands}]}}]}}]}}"#
        )
    };
    let wave = hjif::rendered(
        &file(
            r#"{"band_type":"VectorialWave","effects":[{"effect_type":"Reference","id":7,"position":100}]}"#,
        ),
        0,
    )
    .unwrap();
    assert_eq!(wave.len(), 4801);
    for (n, sample) in wave.iter().enumerate().take(4800).skip(800) {
        assert!((sample - (TAU * 100.0 * (n - 800) as f64 / 8000.0).sin()).abs() < 1e-6, "{n}");
    }
    let knock = hjif::rendered(&file(r#"{"band_type":"Transient","effects":[{"effect_type":"Basis","position":0,"keyframes":[{"relative_position":0,"amplitude_modulation":1}]}]}"#), 0).unwrap();
    assert_eq!(knock.len(), 177);
    for (bands, word) in [
        (r#"{"band_type":"WaveletWave","effects":[{"effect_type":"Basis","keyframes":[]}]}"#, "WaveletWave"),
        (
            r#"{"band_type":"Curve","curve_type":"Akima","effects":[{"effect_type":"Basis","keyframes":[]}]}"#,
            "Akima",
        ),
        (r#"{"band_type":"Curve","effects":[{"effect_type":"Composite","keyframes":[]}]}"#, "Composite"),
        (r#"{"band_type":"Curve","effects":[{"effect_type":"Reference","id":8}]}"#, "library"),
    ] {
        let error = hjif::rendered(&file(bands), 0).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
    assert!(hjif::rendered(&file(""), 1).is_err() && hjif::rendered(&file(""), 0).is_err());
}

#[test]
fn what_a_phone_is_left_with_has_the_level_of_the_clip() {
    let point = |time_s| AmplitudePoint { time_s, amplitude: 0.5, emphasis: None };
    let clip = Clip { amplitude: vec![point(0.0), point(2.0)], ..Clip::default() };
    let device = Device::quest();
    let phone = android::rendered(&android::file(&clip, &device).unwrap().waveform_envelope, 8000.0);
    let whole = oscillator::rendered(&clip, &device, 8000.0);
    assert_eq!(phone.len(), whole.len());
    let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    assert!((rms(&phone[800..15_000]) / rms(&whole[800..15_000]) - 1.0).abs() < 0.01);
}
