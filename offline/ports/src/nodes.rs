//! Nodes: both envelopes on a grid, on their way to a clip.

use crate::clip::{About, AmplitudePoint, Clip, Emphasis, FrequencyPoint};
use crate::device::Device;

/// Points of both envelopes before they are thinned.
#[derive(Debug, Clone, Default)]
pub(crate) struct Nodes {
    pub(crate) time_s: Vec<f64>,
    pub(crate) amplitude: Vec<f64>,
    pub(crate) hz: Vec<f64>,
    pub(crate) strokes: Vec<(f64, Emphasis)>,
}

impl Nodes {
    /// The nodes of the next stretch, which begins where these end.
    pub(crate) fn append(&mut self, other: Self, from_s: f64) {
        let skip = usize::from(!self.time_s.is_empty());
        self.time_s.extend(other.time_s.iter().skip(skip).map(|t| t + from_s));
        self.amplitude.extend(other.amplitude.iter().skip(skip));
        self.hz.extend(other.hz.iter().skip(skip));
        self.strokes.extend(other.strokes.iter().map(|(t, e)| (t + from_s, *e)));
    }

    /// The greatest amplitude.
    pub(crate) fn peak(&self) -> f64 {
        let strokes = self.strokes.iter().map(|(_, e)| e.amplitude);
        self.amplitude.iter().copied().chain(strokes).fold(0.0, f64::max)
    }

    /// As a clip, times a gain.
    pub(crate) fn clip(&self, gain: f64, device: &Device, about: &About) -> Clip {
        let rounded = |x: f64| (x * 1e6).round() / 1e6;
        let times = || self.time_s.iter().map(|t| rounded(*t));
        let frequency = times().zip(&self.hz);
        let frequency = frequency
            .map(|(time_s, hz)| FrequencyPoint { time_s, frequency: rounded(device.frequency(*hz)) })
            .collect();
        let mut amplitude: Vec<AmplitudePoint> = times()
            .zip(&self.amplitude)
            .map(|(time_s, a)| AmplitudePoint {
                time_s,
                amplitude: rounded((gain * a).min(1.0)),
                emphasis: None,
            })
            .collect();
        for (begins_s, stroke) in &self.strokes {
            // At the nearest node, so that a stroke costs no point.
            let next = amplitude.partition_point(|p| p.time_s < *begins_s).min(amplitude.len() - 1);
            let before = next.saturating_sub(1);
            let nearer =
                (amplitude[next].time_s - begins_s).abs() <= (amplitude[before].time_s - begins_s).abs();
            let point = &mut amplitude[if nearer { next } else { before }];
            let level = rounded((gain * stroke.amplitude).min(1.0)).max(point.amplitude);
            point.emphasis = Some(Emphasis { amplitude: level, frequency: rounded(stroke.frequency) });
        }
        Clip { amplitude, frequency, about: about.clone() }
    }
}
