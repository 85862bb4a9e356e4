//! What an AHAP holds, gathered into envelopes and strokes.

use crate::clip::{AmplitudePoint, Clip, Emphasis, FrequencyPoint, Line, Read};
use crate::error::{PortError, within};
use serde_json::Value;

/// How long a clip of strokes goes on behind the last one, s.
const STROKE_S: f64 = 0.05;

/// A continuous event as it was read.
struct Held {
    begins_s: f64,
    ends_s: f64,
    intensity: f64,
    sharpness: f64,
}

#[derive(Default)]
pub(crate) struct Pieces {
    held: Vec<Held>,
    strokes: Vec<(f64, Emphasis)>,
    intensity: Vec<(f64, f64)>,
    sharpness: Vec<(f64, f64)>,
    told: Vec<String>,
}

fn number(of: &Value, key: &str, range: [f64; 2]) -> Result<f64, PortError> {
    let value = of.get(key).and_then(Value::as_f64);
    within(key, value.ok_or_else(|| PortError::new(key, "is missing", "must be a number"))?, range)
}

const TIME_S: [f64; 2] = [0.0, crate::clip::LONGEST_S];

impl Pieces {
    /// Everything in a file.
    pub(crate) fn add_file(&mut self, source: &str) -> Result<(), PortError> {
        let right = "must be JSON with Version and Pattern, a list of Event and ParameterCurve";
        let file: Value =
            serde_json::from_str(source).map_err(|error| PortError::new("ahap", error, right))?;
        let pattern = file.get("Pattern").and_then(Value::as_array);
        let pattern = pattern.ok_or_else(|| PortError::new("Pattern", "is no list", right))?;
        for (index, item) in pattern.iter().enumerate() {
            self.add(item).map_err(|error| error.within(format!("Pattern[{index}]")))?;
        }
        Ok(())
    }

    fn add(&mut self, item: &Value) -> Result<(), PortError> {
        if let Some(event) = item.get("Event") {
            return self.event(event);
        }
        if let Some(curve) = item.get("ParameterCurve") {
            return self.curve(curve);
        }
        if item.get("Parameter").is_some() {
            self.tell("a single Parameter is read past");
            return Ok(());
        }
        Err(PortError::new("item", "is unknown", "must be Event, ParameterCurve or Parameter"))
    }

    fn tell(&mut self, what: &str) {
        if !self.told.iter().any(|told| told == what) {
            self.told.push(what.to_owned());
        }
    }

    fn event(&mut self, event: &Value) -> Result<(), PortError> {
        let begins_s = number(event, "Time", TIME_S)?;
        let (mut intensity, mut sharpness) = (1.0, 0.5);
        for parameter in event.get("EventParameters").and_then(Value::as_array).into_iter().flatten() {
            let value = number(parameter, "ParameterValue", [-1e6, 1e6])?.clamp(0.0, 1.0);
            match parameter.get("ParameterID").and_then(Value::as_str) {
                Some("HapticIntensity") => intensity = value,
                Some("HapticSharpness") => sharpness = value,
                Some("AudioVolume" | "AudioPitch" | "AudioPan" | "AudioBrightness") => {}
                _ => self.tell("attack, decay and release of events are read past"),
            }
        }
        match event.get("EventType").and_then(Value::as_str) {
            Some("HapticTransient") => {
                let stroke = Emphasis { amplitude: intensity * intensity, frequency: sharpness };
                self.strokes.push((begins_s, stroke));
            }
            Some("HapticContinuous") => {
                let ends_s = begins_s + number(event, "EventDuration", TIME_S)?;
                self.held.push(Held { begins_s, ends_s, intensity, sharpness });
            }
            Some("AudioCustom" | "AudioContinuous") => self.tell("sounds are no vibration and are read past"),
            other => {
                let what = format!("{} is unknown", other.unwrap_or("nothing"));
                let right = "must be HapticContinuous, HapticTransient, AudioCustom or AudioContinuous";
                return Err(PortError::new("EventType", what, right));
            }
        }
        Ok(())
    }

    fn curve(&mut self, curve: &Value) -> Result<(), PortError> {
        let begins_s = number(curve, "Time", TIME_S)?;
        let points = curve.get("ParameterCurveControlPoints").and_then(Value::as_array);
        let points = points.ok_or_else(|| {
            PortError::new(
                "ParameterCurveControlPoints",
                "is missing",
                "must be a list of Time and ParameterValue",
            )
        })?;
        let into = match curve.get("ParameterID").and_then(Value::as_str) {
            Some("HapticIntensityControl") => &mut self.intensity,
            Some("HapticSharpnessControl") => &mut self.sharpness,
            _ => {
                self.tell("curves of other parameters than intensity and sharpness are read past");
                return Ok(());
            }
        };
        for (index, point) in points.iter().enumerate() {
            let at = |error: PortError| error.within(format!("ParameterCurveControlPoints[{index}]"));
            let time_s = begins_s + number(point, "Time", TIME_S).map_err(at)?;
            let value = number(point, "ParameterValue", [-1e6, 1e6]).map_err(at)?;
            into.push((time_s, value.clamp(-1.0, 1.0)));
        }
        Ok(())
    }

    /// The clip that all of it makes.
    pub(crate) fn clip(mut self) -> Result<Read, PortError> {
        for points in [&mut self.intensity, &mut self.sharpness] {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            // Joints of split curves, to the rounding of times that count from a curve's own beginning.
            points.dedup_by(|b, a| (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9);
        }
        self.strokes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ends_s = self.held.iter().map(|h| h.ends_s).fold(0.0, f64::max);
        // A stroke by itself lasts as long as strokes do.
        let rings_s = if self.held.is_empty() { STROKE_S } else { 0.0 };
        let last_s = self.strokes.last().map_or(ends_s, |(at, _)| ends_s.max(at + rings_s));
        if last_s <= 0.0 {
            return Err(PortError::new(
                "Pattern",
                "holds no vibration",
                "must have a haptic event that lasts",
            ));
        }
        let clip = Clip { amplitude: self.amplitude(last_s), frequency: self.frequency(), ..Clip::default() };
        Ok(Read { clip: clip.checked()?, told: self.told })
    }

    /// Times at which the envelope bends: twice where it may jump.
    fn amplitude(&self, last_s: f64) -> Vec<AmplitudePoint> {
        let mut edges: Vec<f64> = self.held.iter().flat_map(|h| [h.begins_s, h.ends_s]).collect();
        edges.push(last_s);
        edges.extend(self.strokes.first().map(|(begins_s, _)| *begins_s));
        edges.sort_by(f64::total_cmp);
        // Events that follow each other without a gap are one.
        edges.dedup_by(|b, a| (*a - *b).abs() < 1e-9);
        if edges.len() < 2 {
            edges.insert(0, 0.0);
        }
        let mut points: Vec<(f64, f64)> = Vec::new();
        let mut inner = self.intensity.iter().map(|p| p.0).peekable();
        for span in edges.windows(2) {
            let (from_s, to_s) = (span[0], span[1]);
            let middle_s = 0.5 * (from_s + to_s);
            let sounding: Vec<&Held> =
                self.held.iter().filter(|h| h.begins_s <= middle_s && middle_s < h.ends_s).collect();
            let level = |intensity: f64| -> f64 {
                sounding.iter().map(|h| (h.intensity * intensity.max(0.0)).powi(2)).sum::<f64>().min(1.0)
            };
            points.push((from_s, level(self.intensity_at(from_s, true))));
            while inner.next_if(|t| *t <= from_s).is_some() {}
            while let Some(time_s) = inner.next_if(|t| *t < to_s) {
                if points.last().is_some_and(|p| p.0 == time_s) {
                    points.push((time_s, level(self.intensity_at(time_s, true))));
                } else {
                    points.push((time_s, level(self.intensity_at(time_s, false))));
                }
            }
            points.push((to_s, level(self.intensity_at(to_s, false))));
        }
        points.dedup_by(|b, a| a.0 == b.0 && a.1 == b.1);
        let mut out: Vec<AmplitudePoint> = points
            .iter()
            .map(|&(time_s, amplitude)| AmplitudePoint { time_s, amplitude, emphasis: None })
            .collect();
        for (time_s, stroke) in &self.strokes {
            let index = out.partition_point(|p| p.time_s < *time_s - 1e-9);
            let there = out.get(index).is_some_and(|p| (p.time_s - time_s).abs() < 1e-9);
            if !there {
                let amplitude = Line::new(points.iter().copied()).at(*time_s);
                out.insert(index, AmplitudePoint { time_s: *time_s, amplitude, emphasis: None });
            }
            let point = &mut out[index];
            point.emphasis = Some(Emphasis { amplitude: stroke.amplitude.max(point.amplitude), ..*stroke });
        }
        out
    }

    /// What the intensity curves multiply by at a time, before a jump or behind it; 1 without a curve.
    fn intensity_at(&self, time_s: f64, behind: bool) -> f64 {
        value_at(&self.intensity, time_s, behind).unwrap_or(1.0)
    }

    fn frequency(&self) -> Vec<FrequencyPoint> {
        let own = |time_s: f64| {
            let event = self.held.iter().rfind(|h| h.begins_s <= time_s + 1e-9 && time_s <= h.ends_s + 1e-9);
            event.or(self.held.first()).map_or(0.5, |h| h.sharpness)
        };
        let ends_s = self.held.iter().map(|h| h.ends_s).fold(0.0, f64::max);
        if self.sharpness.is_empty() {
            let point = |h: &Held| FrequencyPoint { time_s: h.begins_s, frequency: h.sharpness };
            return self.held.iter().map(point).collect();
        }
        self.sharpness
            .iter()
            .filter(|(time_s, _)| *time_s <= ends_s)
            .map(|&(time_s, value)| FrequencyPoint {
                time_s,
                frequency: (own(time_s) + value).clamp(0.0, 1.0),
            })
            .collect()
    }
}

/// A curve's value at a time; at a jump the value before it or behind it.
fn value_at(points: &[(f64, f64)], time_s: f64, behind: bool) -> Option<f64> {
    let next = points.partition_point(|p| if behind { p.0 <= time_s } else { p.0 < time_s });
    match (next.checked_sub(1).map(|i| points[i]), points.get(next)) {
        (None, None) => None,
        (None, Some(first)) => Some(first.1),
        (Some(last), None) => Some(last.1),
        (Some(a), Some(b)) if b.0 > a.0 => Some(a.1 + (time_s - a.0) / (b.0 - a.0) * (b.1 - a.1)),
        (Some(a), Some(_)) => Some(a.1),
    }
}
