//! Warnings of a render: what was refused, lost or clipped, and why an output is silence.

use super::Report;
use asperity::offline::silence::Rendered;

/// One line each, with the key or field that mends it.
pub fn warnings(rendered: &Rendered<'_>, report: &Report) -> Vec<String> {
    let file = rendered.file;
    let mut remarks = rendered.losses();
    remarks.extend(clipped(report));
    // Who asked for a limiter knows that it works.
    let asked = file.audio.iter().any(|bus| bus.limit == Some(true))
        || file.actuators.iter().any(|actuator| actuator.limit_peaks == Some(true));
    remarks.extend(turned_down(report).filter(|_| !asked));
    remarks.extend(rendered.silences());
    remarks
}

fn clipped(report: &Report) -> Vec<String> {
    let mut remarks = Vec::new();
    if report.audio_peak > 1.0 {
        let peak = report.audio_peak;
        remarks.push(format!(
            "the audio exceeds full scale (peak {peak:.2}): lower gain under [audio], or write limit = true there"
        ));
    }
    for (channel, peak) in report.haptic_peak.iter().enumerate().filter(|(_, peak)| **peak > 1.0) {
        remarks.push(format!(
            "haptic channel {channel} peaks at {peak:.2} of full scale: raise full_scale of its [[actuator]], or write \
             limit = true there"
        ));
    }
    remarks
}

/// A limiter that works as hard as that is heard and felt.
const HARD_DB: f64 = 6.0;

fn turned_down(report: &Report) -> Option<String> {
    let by_db = report.limiter_db;
    (by_db > HARD_DB).then(|| {
        format!(
            "a limiter turned down by up to {by_db:.1} dB: lower gain under [audio], strike_gain of the [[body]], or raise full_scale of the [[actuator]] (in use: \
             gain {}, full_scale {:?})",
            report.gain, report.full_scale
        )
    })
}
