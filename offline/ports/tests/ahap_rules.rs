//! Rules of AHAP as its vendor documents them: what curves, parameters and envelopes do to events.

use asperity_ports::{Clip, Device, ahap, haptic_file};

fn event(kind: &str, time: f64, rest: &str) -> String {
    format!(
        r#"{{"Event":{{"Time":{time},"EventType":"Haptic{kind}","EventParameters":[{{"ParameterID":"HapticIntensity","ParameterValue":1}},{{"ParameterID":"HapticSharpness","ParameterValue":0.2}}]{rest}}}}}"#
    )
}

fn curve(of: &str, time: f64, points: &[(f64, f64)]) -> String {
    let points: Vec<String> =
        points.iter().map(|(t, v)| format!(r#"{{"Time":{t},"ParameterValue":{v}}}"#)).collect();
    format!(
        r#"{{"ParameterCurve":{{"ParameterID":"Haptic{of}Control","Time":{time},"ParameterCurveControlPoints":[{}]}}}}"#,
        points.join(",")
    )
}

fn clip(pattern: &[String]) -> Clip {
    let text = format!(r#"{{"Version":1,"Pattern":[{}]}}"#, pattern.join(","));
    ahap::parse(&text).unwrap_or_else(|error| panic!("{error}: {text}")).clip
}

/// Amplitude and frequency at a time.
fn at(clip: &Clip, time_s: f64) -> (f64, f64) {
    clip.sampled(1e4).nth((1e4 * time_s).round() as usize).unwrap()
}

#[test]
fn taps_are_as_weak_and_as_sharp_as_the_curves_make_them() {
    let pattern = [
        event("Transient", 0.5, ""),
        event("Continuous", 0.0, r#","EventDuration":1"#),
        curve("Intensity", 0.0, &[(0.0, 0.3), (1.0, 0.3)]),
        curve("Sharpness", 0.0, &[(0.0, 0.4), (1.0, 0.4)]),
    ];
    let clip = clip(&pattern);
    let tap = clip.amplitude.iter().find_map(|p| p.emphasis).unwrap();
    assert!((tap.amplitude - 0.09).abs() < 1e-9 && (tap.frequency - 0.6).abs() < 1e-9, "{tap:?}");
}

#[test]
fn an_early_curve_is_no_fault_and_a_late_one_acts_late() {
    let early = [
        event("Continuous", 0.2, r#","EventDuration":1"#),
        curve("Sharpness", 0.0, &[(0.0, 0.0), (0.4, 0.4)]),
    ];
    let early = clip(&early);
    assert!(
        (early.frequency[0].time_s - 0.2).abs() < 1e-9 && (early.frequency[0].frequency - 0.4).abs() < 1e-9
    );
    assert!((at(&early, 1.0).1 - 0.6).abs() < 1e-9);
    let late = [
        event("Continuous", 0.0, r#","EventDuration":2"#),
        curve("Intensity", 1.0, &[(0.0, 0.2), (0.5, 0.2)]),
    ];
    let late = clip(&late);
    for (time_s, level) in [(0.0, 1.0), (0.99, 1.0), (1.01, 0.04), (1.9, 0.04)] {
        assert!((at(&late, time_s).0 - level).abs() < 1e-9, "{time_s}");
    }
}

#[test]
fn a_parameter_is_a_step_and_an_intensity_ramp_its_square() {
    let step = r#"{"Parameter":{"ParameterID":"HapticIntensityControl","Time":0.5,"ParameterValue":0.5}}"#;
    let stepped = clip(&[event("Continuous", 0.0, r#","EventDuration":1"#), step.to_owned()]);
    assert_eq!((at(&stepped, 0.4).0, at(&stepped, 0.6).0), (1.0, 0.25));
    let ramp = clip(&[
        event("Continuous", 0.0, r#","EventDuration":1"#),
        curve("Intensity", 0.0, &[(0.0, 0.2), (1.0, 1.0)]),
    ]);
    for time_s in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let (level, expected) = (at(&ramp, time_s).0, (0.2 + 0.8 * time_s).powi(2));
        assert!(20.0 * (level / expected).log10().abs() < 0.3, "{time_s}: {level} {expected}");
    }
}

#[test]
fn attack_decay_and_release_are_ramps_and_told() {
    let parameters = r#""EventParameters":[{"ParameterID":"AttackTime","ParameterValue":0.5},{"ParameterID":"ReleaseTime","ParameterValue":0.4}]"#;
    let text = format!(
        r#"{{"Version":1,"Pattern":[{{"Event":{{"Time":0,"EventType":"HapticContinuous","EventDuration":1,{parameters}}}}}]}}"#
    );
    let read = ahap::parse(&text).unwrap();
    assert!(read.remarks[0].contains("attack"), "{:?}", read.remarks);
    assert!((read.clip.duration_s() - 1.4).abs() < 1e-9);
    for (time_s, level) in [(0.25, 0.25), (0.75, 1.0), (1.2, 0.25)] {
        let is = at(&read.clip, time_s).0;
        assert!(20.0 * (is / level).log10().abs() < 0.3, "{time_s}: {is}");
    }
}

#[test]
fn a_release_under_a_falling_curve_is_weak_by_both() {
    let release = r#","EventDuration":0.435"#;
    let held = event("Continuous", 0.0, release).replace(
        r#""EventParameters":["#,
        r#""EventParameters":[{"ParameterID":"ReleaseTime","ParameterValue":0.2},"#,
    );
    let clip = clip(&[held, curve("Intensity", 0.0, &[(0.435, 0.8), (0.635, 0.2)])]);
    for part in [0.1, 0.3, 0.5, 0.7] {
        let (level, expected) =
            (at(&clip, 0.435 + 0.2 * part).0, ((1.0 - part) * (0.8 - 0.6 * part)).powi(2));
        assert!(20.0 * (level / expected).log10().abs() < 0.5, "{part}: {level} {expected}");
    }
}

#[test]
fn an_attack_under_a_falling_curve_swells_and_fades() {
    let held = event("Continuous", 0.0, r#","EventDuration":0.4"#).replace(
        r#""EventParameters":["#,
        r#""EventParameters":[{"ParameterID":"AttackTime","ParameterValue":0.2},"#,
    );
    let clip = clip(&[held, curve("Intensity", 0.0, &[(0.0, 1.0), (0.2, 0.0)])]);
    for part in [0.05, 0.2, 0.4, 0.45, 0.6, 0.8, 0.95] {
        let (level, expected) = (at(&clip, 0.2 * part).0, ((1.0 - part) * part).powi(2));
        assert!(20.0 * (level / expected).log10().abs() < 0.5, "{part}: {level} {expected}");
    }
}

#[test]
fn events_that_are_full_together_stay_full_until_they_fade() {
    let held = |intensity: &str| {
        let held = event("Continuous", 0.0, r#","EventDuration":1"#);
        held.replace(r#""HapticIntensity","ParameterValue":1"#, &format!(r#""HapticIntensity",{intensity}"#))
    };
    let fading = r#""ParameterValue":0.765},{"ParameterID":"Sustained","ParameterValue":0},{"ParameterID":"DecayTime","ParameterValue":0.543"#;
    let decays = clip(&[held(r#""ParameterValue":0.741"#), held(fading)]);
    let eight = held(r#""ParameterValue":0.8"#);
    let curved = clip(&[eight.clone(), eight, curve("Intensity", 0.0, &[(0.0, 1.0), (1.0, 0.3)])]);
    for step in 1..54 {
        let time_s = 0.01 * f64::from(step);
        let faded = 0.765 * (1.0 - time_s / 0.543);
        let both = [0.741_f64.powi(2) + faded * faded, 1.28 * (1.0 - 0.7 * time_s).powi(2)];
        for (clip, power) in [&decays, &curved].into_iter().zip(both) {
            let (level, expected) = (at(clip, time_s).0, power.min(1.0));
            assert!(20.0 * (level / expected).log10().abs() < 0.5, "{time_s}: {level} {expected}");
        }
    }
}

#[test]
fn trailing_commas_and_comments_of_the_vendors_samples_are_read() {
    let text = r#"{"Version": 1.0, // as shipped
        "Pattern": [{"Event": {"Time": 0.0, "EventType": "HapticTransient", "EventParameters": [],},},],}"#;
    assert_eq!(ahap::parse(text).unwrap().clip.amplitude.len(), 2);
    assert!(ahap::parse(&"[".repeat(100_000)).is_err());
}

#[test]
fn a_clip_that_names_its_major_version_alone_is_read() {
    let text = r#"{"version":{"major":1},"signals":{"continuous":{"envelopes":{"amplitude":[{"time":0,"amplitude":1},{"time":1,"amplitude":0}]}}}}"#;
    assert_eq!(haptic_file::parse(text).unwrap().clip.duration_s(), 1.0);
}

#[test]
fn a_configuration_of_the_vendors_editor_is_a_device() {
    let text = "{\n  // keys without quotes\n  continuous: {frequency_min: 60.0, frequency_max: 210, emphasis_ducking: .4,},\n}";
    assert_eq!(Device::parse(text).unwrap().band_hz, [60.0, 210.0]);
}
