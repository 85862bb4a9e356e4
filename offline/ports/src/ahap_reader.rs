//! Events and parameters of an AHAP, gathered into envelopes and strokes.
//!
//! | in the file | here |
//! |---|---|
//! | `HapticIntensityControl` | multiplies the intensity of every event, strokes too |
//! | `HapticSharpnessControl` | is added to the sharpness of every event, strokes too |
//! | `ParameterCurve` | straight from point to point; it acts from its first point on and is held behind its last |
//! | `Parameter` | a step that is held |
//! | `AttackTime`, `DecayTime`, `ReleaseTime` | straight ramps of the intensity of as many seconds; decay without `Sustained` only |
//!
//! The vendor says of the three times that they run from 0 to 1 and grow, not by what law: they are
//! told. Curves of a file that holds strokes alone do not reach the file beside it, as two patterns
//! are played by themselves. Intensities are squared, so that a ramp of one bends: it is cut into
//! pieces that stay within 0.3 dB of it, down to −60 dB.

use crate::clip::{AmplitudePoint, Clip, Emphasis, FrequencyPoint, Line, Read};
use crate::error::{PortError, within};
use crate::track::Track;
use serde_json::Value;

/// Length of a clip of strokes behind the last one, s.
const STROKE_S: f64 = 0.05;
/// A ramp of intensity is cut where it has grown by this factor: its square is then within 0.25 dB
/// of straight.
const GROWN: f64 = 1.4;
/// Intensities below this are not told apart: −60 dB.
const FAINT: f64 = 0.03;
/// Share by which a straight piece may miss the power in its middle: 0.25 dB.
const STRAIGHT: f64 = 0.03;

/// A continuous event as it was read.
struct Held {
    begins_s: f64,
    ends_s: f64,
    intensity: f64,
    sharpness: f64,
    attack_s: f64,
    release_s: f64,
    /// Parameters of an event that is not sustained.
    decay_s: Option<f64>,
}

impl Held {
    /// Times at which its intensity bends, s.
    fn bends_s(&self) -> [f64; 5] {
        let full_s = (self.begins_s + self.attack_s).min(self.ends_s);
        let decayed_s = self.decay_s.map_or(self.ends_s, |decay_s| (full_s + decay_s).min(self.ends_s));
        [self.begins_s, full_s, decayed_s, self.ends_s, self.ends_s + self.release_s]
    }

    /// Intensity at a time within it.
    fn intensity_at(&self, time_s: f64) -> f64 {
        let [begins_s, full_s, _, ends_s, _] = self.bends_s();
        let held = |time_s: f64| {
            let attack = if self.attack_s > 0.0 { (time_s - begins_s) / self.attack_s } else { 1.0 };
            let decay = match self.decay_s {
                Some(decay_s) if time_s > full_s => {
                    if decay_s > 0.0 {
                        1.0 - (time_s - full_s) / decay_s
                    } else {
                        0.0
                    }
                }
                _ => 1.0,
            };
            attack.clamp(0.0, 1.0) * decay.max(0.0)
        };
        let release = if time_s > ends_s { 1.0 - (time_s - ends_s) / self.release_s.max(1e-12) } else { 1.0 };
        self.intensity * held(time_s.min(ends_s)) * release.max(0.0)
    }
}

#[derive(Default)]
pub(crate) struct Pieces {
    held: Vec<Held>,
    strokes: Vec<(f64, Emphasis)>,
    intensity: Track,
    sharpness: Track,
    remarks: Vec<String>,
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
        let file = crate::json5_text::value(source).map_err(|error| PortError::new("ahap", error, right))?;
        let pattern = file.get("Pattern").and_then(Value::as_array);
        let pattern = pattern.ok_or_else(|| PortError::new("Pattern", "is no list", right))?;
        let (first, before) = (self.strokes.len(), (self.intensity.clone(), self.sharpness.clone()));
        (self.intensity, self.sharpness) = (Track::default(), Track::default());
        for (index, item) in pattern.iter().enumerate() {
            self.add(item).map_err(|error| error.within(format!("Pattern[{index}]")))?;
        }
        let (intensity, sharpness) = (self.intensity.points(1.0), self.sharpness.points(0.0));
        for (time_s, stroke) in &mut self.strokes[first..] {
            let factor = intensity.at(*time_s, true).max(0.0);
            stroke.amplitude = (stroke.amplitude * factor * factor).min(1.0);
            stroke.frequency = (stroke.frequency + sharpness.at(*time_s, true)).clamp(0.0, 1.0);
        }
        self.intensity.append(before.0);
        self.sharpness.append(before.1);
        Ok(())
    }

    fn add(&mut self, item: &Value) -> Result<(), PortError> {
        if let Some(event) = item.get("Event") {
            return self.event(event);
        }
        if let Some(curve) = item.get("ParameterCurve") {
            return self.curve(curve);
        }
        if let Some(parameter) = item.get("Parameter") {
            let time_s = optional(parameter, "Time", TIME_S)?.unwrap_or(0.0);
            let value = number(parameter, "ParameterValue", [-1e6, 1e6])?.clamp(-1.0, 1.0);
            if let Some(track) = self.track(parameter) {
                track.put(vec![(time_s, value)]);
            }
            return Ok(());
        }
        Err(PortError::new("item", "is unknown", "must be Event, ParameterCurve or Parameter"))
    }

    /// Target of a parameter.
    fn track(&mut self, parameter: &Value) -> Option<&mut Track> {
        match parameter.get("ParameterID").and_then(Value::as_str) {
            Some("HapticIntensityControl") => Some(&mut self.intensity),
            Some("HapticSharpnessControl") => Some(&mut self.sharpness),
            _ => {
                self.remark("curves of other parameters than intensity and sharpness are read past");
                None
            }
        }
    }

    fn remark(&mut self, what: &str) {
        if !self.remarks.iter().any(|remark| remark == what) {
            self.remarks.push(what.to_owned());
        }
    }

    fn event(&mut self, event: &Value) -> Result<(), PortError> {
        let begins_s = number(event, "Time", TIME_S)?;
        let (mut intensity, mut sharpness) = (1.0, 0.5);
        let (mut attack_s, mut decay_s, mut release_s, mut sustained) = (0.0, 0.0, 0.0, true);
        for parameter in event.get("EventParameters").and_then(Value::as_array).into_iter().flatten() {
            let value = number(parameter, "ParameterValue", [-1e6, 1e6])?.clamp(0.0, 1.0);
            match parameter.get("ParameterID").and_then(Value::as_str) {
                Some("HapticIntensity") => intensity = value,
                Some("HapticSharpness") => sharpness = value,
                Some("AttackTime") => attack_s = value,
                Some("DecayTime") => decay_s = value,
                Some("ReleaseTime") => release_s = value,
                Some("Sustained") => sustained = value > 0.0,
                // The vendor's reader ignores what it does not know.
                _ => {}
            }
        }
        let is_held = event.get("EventType").and_then(Value::as_str) == Some("HapticContinuous");
        if is_held && (attack_s > 0.0 || release_s > 0.0 || !sustained) {
            self.remark("attack, decay and release of events are read as straight ramps of as many seconds");
        }
        match event.get("EventType").and_then(Value::as_str) {
            Some("HapticTransient") => {
                let stroke = Emphasis { amplitude: intensity * intensity, frequency: sharpness };
                self.strokes.push((begins_s, stroke));
            }
            Some("HapticContinuous") => {
                let ends_s = begins_s + number(event, "EventDuration", TIME_S)?;
                let decay_s = (!sustained).then_some(decay_s);
                self.held.push(Held { begins_s, ends_s, intensity, sharpness, attack_s, release_s, decay_s });
            }
            Some("AudioCustom" | "AudioContinuous") => {
                self.remark("sounds are no vibration and are read past")
            }
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
        let mut read = Vec::with_capacity(points.len());
        for (index, point) in points.iter().enumerate() {
            let at = |error: PortError| error.within(format!("ParameterCurveControlPoints[{index}]"));
            let time_s = begins_s + number(point, "Time", TIME_S).map_err(at)?;
            let value = number(point, "ParameterValue", [-1e6, 1e6]).map_err(at)?;
            read.push((time_s, value.clamp(-1.0, 1.0)));
        }
        if let Some(track) = self.track(curve) {
            track.put(read);
        }
        Ok(())
    }

    /// The clip that all of it makes.
    pub(crate) fn clip(mut self) -> Result<Read, PortError> {
        self.strokes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ends_s = self.held.iter().map(|h| h.bends_s()[4]).fold(0.0, f64::max);
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
        let (amplitude, mut frequency) = (self.amplitude(last_s), self.frequency());
        // Edges of both are the same to rounding.
        if let [first, .., last] = &amplitude[..] {
            frequency.iter_mut().for_each(|p| p.time_s = p.time_s.clamp(first.time_s, last.time_s));
        }
        let clip = Clip { amplitude, frequency, ..Clip::default() };
        Ok(Read { clip: clip.checked()?, remarks: self.remarks })
    }

    /// Times at which the envelope bends: twice where it may jump.
    fn amplitude(&self, last_s: f64) -> Vec<AmplitudePoint> {
        let curve = self.intensity.points(1.0);
        let mut edges: Vec<f64> = self.held.iter().flat_map(Held::bends_s).collect();
        edges.push(last_s);
        edges.extend(self.strokes.first().map(|(begins_s, _)| *begins_s));
        let first_s = edges.iter().copied().fold(last_s, f64::min);
        let bends = curve.times_s().chain(curve.crossings_s(0.0));
        edges.extend(bends.filter(|t| *t > first_s && *t < last_s));
        edges.sort_by(f64::total_cmp);
        // Events that follow each other without a gap are one.
        edges.dedup_by(|b, a| (*a - *b).abs() < 1e-9);
        if edges.len() < 2 {
            edges.insert(0, 0.0);
        }
        let mut points: Vec<(f64, f64)> = Vec::new();
        for span in edges.windows(2) {
            let (from_s, to_s) = (span[0], span[1]);
            let middle_s = 0.5 * (from_s + to_s);
            let sounding: Vec<&Held> =
                self.held.iter().filter(|h| h.begins_s <= middle_s && middle_s < h.bends_s()[4]).collect();
            // The edges of an event are its own only to rounding.
            let inside = |h: &Held, t: f64| h.intensity_at(t.clamp(h.begins_s, h.bends_s()[4]));
            let ends = |t: f64, behind: bool| -> Vec<f64> {
                let factor = curve.at(t, behind).max(0.0);
                let one_sided = if behind { t + 1e-12 } else { t - 1e-12 };
                sounding.iter().map(|h| inside(h, one_sided) * factor).collect()
            };
            let (from, to) = (ends(from_s, true), ends(to_s, false));
            let ramps = sounding.iter().any(|h| inside(h, from_s) != inside(h, to_s));
            let time_s = |part: f64| if part == 1.0 { to_s } else { from_s + part * (to_s - from_s) };
            let power = |part: f64| -> f64 {
                let levels = if ramps {
                    ends(time_s(part), part < 1.0)
                } else {
                    from.iter().zip(&to).map(|(a, b)| a + part * (b - a)).collect()
                };
                levels.iter().map(|level| level * level).sum::<f64>().min(1.0)
            };
            let mut cuts = parts(&from, &to);
            // Events that reach 1 together bend there, where none of them has a cut.
            let reaches = |levels: &[f64]| levels.iter().map(|level| level * level).sum::<f64>() > 1.0;
            if ramps || reaches(&from) != reaches(&to) {
                halve(&mut cuts, power);
            }
            points.extend(cuts.into_iter().map(|part| (time_s(part), power(part))));
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

    /// Sharpness of the events and what the curves add to it, stepping where events do.
    fn frequency(&self) -> Vec<FrequencyPoint> {
        let curve = self.sharpness.points(0.0);
        let begins_s = self.held.iter().map(|h| h.begins_s).fold(f64::MAX, f64::min);
        let ends_s = self.held.iter().map(|h| h.bends_s()[4]).fold(0.0, f64::max);
        let mut edges: Vec<f64> = self.held.iter().flat_map(|h| [h.begins_s, h.bends_s()[4]]).collect();
        // Where the sum reaches an end of its range, it stays there.
        let held = self.held.iter().flat_map(|h| [-h.sharpness, 1.0 - h.sharpness]);
        let bends = curve.times_s().chain(held.flat_map(|level| curve.crossings_s(level)));
        edges.extend(bends.filter(|t| *t > begins_s && *t < ends_s));
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|b, a| (*a - *b).abs() < 1e-9);
        let mut points: Vec<FrequencyPoint> = Vec::new();
        for span in edges.windows(2) {
            let middle_s = 0.5 * (span[0] + span[1]);
            // The event that began last; a pause keeps the sharpness of the one before it.
            let Some(own) = self.held.iter().filter(|h| h.begins_s <= middle_s).max_by(|a, b| {
                let sounds = |h: &Held| middle_s < h.bends_s()[4];
                sounds(a).cmp(&sounds(b)).then(a.begins_s.total_cmp(&b.begins_s))
            }) else {
                continue;
            };
            for (time_s, behind) in [(span[0], true), (span[1], false)] {
                let frequency = (own.sharpness + curve.at(time_s, behind)).clamp(0.0, 1.0);
                points.push(FrequencyPoint { time_s, frequency });
            }
        }
        points.dedup();
        // What does not change needs one point.
        if points.iter().all(|p| p.frequency == points[0].frequency) {
            points.truncate(1);
        }
        points
    }
}

/// Cuts of ramps of intensities, as parts of their length: their squares are straight enough in
/// between.
pub(crate) fn parts(from: &[f64], to: &[f64]) -> Vec<f64> {
    let mut parts = vec![0.0, 1.0];
    for (&a, &b) in from.iter().zip(to) {
        let (low, high) = (a.min(b).max(FAINT), a.max(b));
        let levels = std::iter::successors(Some(high / GROWN), |x| Some(x / GROWN));
        // What was cut so before is not cut again beside its ends.
        let levels = levels.take_while(|x| *x > low * (1.0 + 1e-6)).chain((a.min(b) < low).then_some(low));
        parts.extend(levels.map(|x| (x - a) / (b - a)).filter(|part| *part > 0.0 && *part < 1.0));
    }
    parts.sort_by(f64::total_cmp);
    parts.dedup();
    parts
}

/// Halves what is not straight between two cuts: a ramp under a curve that moves.
fn halve(cuts: &mut Vec<f64>, power: impl Fn(f64) -> f64) {
    let mut next = 1;
    while let (Some(&from), Some(&to)) = (cuts.get(next - 1), cuts.get(next)) {
        let middle = 0.5 * (from + to);
        let (here, straight) = (power(middle), 0.5 * (power(from) + power(to)));
        let bends = (here - straight).abs() > STRAIGHT * here.max(FAINT * FAINT);
        if to - from > 0.5 || (bends && to - from > 1e-3) {
            cuts.insert(next, middle);
        } else {
            next += 1;
        }
    }
}

/// A number that may be missing.
fn optional(of: &Value, key: &str, range: [f64; 2]) -> Result<Option<f64>, PortError> {
    if of.get(key).is_none() { Ok(None) } else { number(of, key, range).map(Some) }
}
