//! The shipped actuator profiles in a scene file: equalised and limited channels from outside.

use crate::support;

use support::{Scene, TOML};

const PROFILES: [&str; 4] = ["lra-170", "console-voice-coil", "haptuator", "vr-controller"];

/// What the stroke sends to an actuator with these keys. Full scale is an LRA's motion.
fn channel(keys: &str) -> Vec<f32> {
    let scene = Scene::new();
    scene.write("scene.toml", TOML.replace("full_scale = 1.0", &format!("full_scale = 1.2e-5\n{keys}")));
    assert!(scene.report(&[])["haptic_peak"][0].is_number());
    scene.samples("out.haptic.wav")
}

fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |peak, sample| peak.max(sample.abs()))
}

#[test]
fn every_profile_equalises_and_limits_a_stroke() {
    let plain = channel("");
    for profile in PROFILES {
        let equalised = channel(&format!("equalise = \"{profile}\""));
        assert!(equalised != plain && peak(&equalised) > 0.0, "{profile}: the equaliser changes the drive");
        let both = channel(&format!("equalise = \"{profile}\"\nlimit = \"{profile}\""));
        assert!(both.iter().all(|sample| sample.is_finite()), "{profile}");
        assert!(peak(&both) > 0.0 && peak(&both) <= 1.0, "{profile}: drive up to {}", peak(&both));
    }
}
