//! Motions as they are reported: place against velocity, step by step, surface by surface.
//!
//! A report holds a place and a velocity. From one report of a contact to the next its place moves
//! by `d = Δuv · size`, and its velocity says `e = ½ (v₀ + v₁) Δt`. Whoever writes uv in
//! millimetres or a velocity in uv a second has `|d| / |e|` wrong by the same factor at every step,
//! and the factor shows which. Medians over the steps on a surface are compared, so that teleports,
//! hitches and the first step of a stroke do not count; a motion whose factors scatter (a crate
//! that rests on this corner and that) is not judged.
//!
//! ```text
//! factor of u, v        likely
//! width_m, height_m     uv in m, or velocity in uv/s
//! 100, 1000 times that  uv in cm, in mm
//! above 8               uv in texels
//! 1/100                 velocity in cm/s
//! 1/1000                velocity in mm/s; times in ms where steps last 0.3 s and more
//! anything else         a plane of another size than the surface
//! ```

use super::{Contradiction, Likely};
use crate::model::event::{ContactEvent, ContactId, ContactSample};
use crate::model::id::SurfaceId;
use crate::model::rising::rising;
use std::collections::HashMap;

/// Slower motion is not compared, m/s: what rests jitters.
const LEAST_SPEED_M_S: f64 = 0.005;
/// Fewer steps on a surface are not judged.
const LEAST_STEPS: u32 = 6;
/// A place that leaps by more, forth and back, may be two fingers', m.
const LEAP_M: f64 = 0.002;
/// A step that is longer by more than the one before and the one after is a hop.
const HOP: f64 = 2.5;
/// Cosine below which a contact turns sharply.
const SHARP: f64 = 0.25;
/// Number of reports a hop, at most, that are no strokes with a hitch now and then.
const REPORTS_A_HOP: u32 = 20;
/// Fields of a histogram for a factor of two.
const FIELDS_AN_OCTAVE: f64 = 16.0;
/// Fields of a histogram; the middle one holds a factor of 1.
const FIELDS: usize = 640;
/// Longer steps than this are no game's, s: times in milliseconds.
const LONG_STEP_S: f64 = 0.3;
/// A factor that is reported lies beyond this one or its inverse.
const FACTOR: f64 = 2.0;
/// Fields on either side of the median that count as its own.
const NEAR: usize = 8;
/// A step over a larger share of the surface may have crossed its edge.
const FAST: f64 = 0.4;
/// More laps in a step are no motion, but another unit.
const MOST_LAPS: f64 = 2.5;
/// Factors of one unit differ by less.
const ALIKE: f64 = 1.15;

/// Newest report of a contact, and the step that led to it.
#[derive(Clone, Copy)]
struct Last {
    surface: SurfaceId,
    time_s: f64,
    sample: ContactSample,
    /// Time at which its place changed last: it may be reported more often than it moves.
    since_s: f64,
    step_m: Option<[f64; 2]>,
    /// The step before that one.
    before_m: Option<[f64; 2]>,
}

/// Size and period of a surface, by which places on it are compared.
#[derive(Clone, Copy)]
pub(crate) struct Sheet {
    pub(crate) size_m: [f64; 2],
    /// Period, m; infinite where it does not repeat.
    pub(crate) period_m: [f64; 2],
}

/// Histogram of factors.
struct Factors {
    fields: [u32; FIELDS],
    count: u32,
    against: u32,
}

/// Counts of what was reported on one surface.
struct Tally {
    sheet: Sheet,
    reports: u32,
    begins_again: u32,
    leaps: u32,
    /// Hops of contacts without a velocity.
    hops: u32,
    steps: u32,
    agree: u32,
    swapped: u32,
    seconds: f64,
    said_m: f64,
    axes: [Factors; 2],
}

/// Compares what is reported, contact by contact.
#[derive(Default)]
pub(crate) struct Motions {
    contacts: HashMap<ContactId, Last>,
    tallies: HashMap<SurfaceId, Tally>,
}

impl Motions {
    /// Drops what was seen on a surface that is gone.
    pub(crate) fn forget(&mut self, surface: SurfaceId) {
        self.tallies.remove(&surface);
    }

    /// Notes an accepted event; `sheet` gives the surface's size, and a contact that is silent for
    /// `timeout_s` has ended.
    pub(crate) fn note(
        &mut self,
        time_s: f64,
        event: &ContactEvent,
        timeout_s: f64,
        sheet: impl FnOnce(SurfaceId) -> Option<Sheet>,
    ) {
        let (contact, sample) = match event {
            ContactEvent::Begin { contact, sample, .. } | ContactEvent::Moved { contact, sample, .. } => {
                (*contact, *sample)
            }
            ContactEvent::End { contact } => {
                self.contacts.remove(contact);
                return;
            }
            ContactEvent::Impact(_) | ContactEvent::Motion { .. } => return,
        };
        let last = self.contacts.get(&contact).copied();
        let surface = match (event, last) {
            (ContactEvent::Begin { touching, .. }, _) => touching.surface,
            (_, Some(last)) => last.surface,
            _ => return,
        };
        let last = last.filter(|last| last.surface == surface);
        let step_m = sheet(surface).and_then(|sheet| {
            let tally = self.tallies.entry(surface).or_insert_with(|| Tally::new(sheet));
            let begins = matches!(event, ContactEvent::Begin { .. });
            tally.reports += 1;
            let touches = |last: Last| time_s - last.time_s <= timeout_s;
            tally.begins_again += u32::from(begins && last.is_some_and(touches));
            last.filter(|last| last.sample.uv != sample.uv)
                .and_then(|last| tally.step(&last, time_s, &sample))
        });
        let stays = last.filter(|last| last.sample.uv == sample.uv);
        let last = match stays {
            Some(last) => Last { time_s, ..last },
            None => {
                let before_m = last.and_then(|last| last.step_m);
                Last { surface, time_s, sample, since_s: time_s, step_m, before_m }
            }
        };
        self.contacts.insert(contact, last);
    }

    /// Contradictions found so far, surface by surface.
    pub(crate) fn contradictions(&self) -> Vec<Contradiction> {
        let found: Vec<_> =
            self.tallies.iter().flat_map(|(surface, tally)| tally.contradictions(*surface)).collect();
        let surfaces: Vec<_> = found.iter().map(|found| found.surface().index() as f64).collect();
        rising(&surfaces).into_iter().map(|place| found[place]).collect()
    }
}

impl Tally {
    fn new(sheet: Sheet) -> Self {
        let axis = || Factors { fields: [0; FIELDS], count: 0, against: 0 };
        Self {
            sheet,
            reports: 0,
            begins_again: 0,
            leaps: 0,
            hops: 0,
            steps: 0,
            agree: 0,
            swapped: 0,
            seconds: 0.0,
            said_m: 0.0,
            axes: [axis(), axis()],
        }
    }

    /// Counts a step of a contact and returns how far its place moved.
    fn step(&mut self, last: &Last, time_s: f64, sample: &ContactSample) -> Option<[f64; 2]> {
        let step_s = time_s - last.since_s;
        let said = last.sample.velocity_m_s.zip(sample.velocity_m_s);
        let e = said.map(|(a, b)| [0, 1].map(|c| 0.5 * (a[c] + b[c]) * step_s));
        let d = self.sheet.moved_m(last.sample.uv, sample.uv, e.unwrap_or_default());
        if !d.iter().all(|d| d.is_finite()) {
            return None;
        }
        if let Some(before) = last.step_m {
            let shorter = length(d).min(length(before));
            let back = length([d[0] + before[0], d[1] + before[1]]) < 0.5 * shorter;
            self.leaps += u32::from(shorter > LEAP_M && back);
            let turned = d[0] * before[0] + d[1] * before[1];
            let sharp = shorter > LEAP_M && turned < SHARP * length(d) * length(before);
            let alone = last.before_m.is_some_and(|two_before| {
                length(before) > LEAP_M.max(HOP * length(d).max(length(two_before)))
            });
            self.hops += u32::from(said.is_none() && (sharp || alone));
        }
        if let (Some(e), Some((a, b))) = (e, said) {
            let goes_on = a[0] * b[0] + a[1] * b[1] > 0.0 && length(a).min(length(b)) >= LEAST_SPEED_M_S;
            if goes_on && step_s > 0.0 {
                self.compare(d, e, step_s);
            }
        }
        Some(d)
    }

    fn compare(&mut self, d: [f64; 2], e: [f64; 2], step_s: f64) {
        self.steps += 1;
        self.seconds += step_s;
        self.said_m += length(e);
        let off = |e: [f64; 2]| length([d[0] - e[0], d[1] - e[1]]);
        let agrees = off(e) <= 0.35 * length(e).max(length(d));
        self.agree += u32::from(agrees);
        self.swapped += u32::from(!agrees && off([e[1], e[0]]) <= 0.15 * length(e));
        for (axis, (d, along)) in self.axes.iter_mut().zip(d.into_iter().zip(e)) {
            if along.abs() > 0.25 * length(e) && d != 0.0 {
                axis.add(d / along);
            }
        }
    }

    fn contradictions(&self, surface: SurfaceId) -> Vec<Contradiction> {
        let mut found = Vec::new();
        let many = |count: u32| count > LEAST_STEPS && 2 * count > self.reports;
        if many(self.begins_again) {
            found.push(Contradiction::BeginsAgain { surface, count: self.begins_again });
        }
        if many(self.leaps) {
            found.push(Contradiction::TwoPlaces { surface, count: self.leaps });
        } else if self.hops > LEAST_STEPS && REPORTS_A_HOP * self.hops > self.reports {
            found.push(Contradiction::Hops { surface, count: self.hops });
        } else if self.steps >= LEAST_STEPS && 2 * self.agree < self.steps {
            found.extend(self.motion(surface));
        }
        found
    }

    /// Disagreement of place and velocity, if there is one.
    fn motion(&self, surface: SurfaceId) -> Option<Contradiction> {
        if 10 * self.swapped >= 6 * self.steps {
            return Some(Contradiction::Swapped { surface });
        }
        let factors = [0, 1].map(|c| self.axes[c].steady(self.steps / 4));
        let known = || factors.iter().flatten();
        if known().any(|factor| !(1.0 / FACTOR..=FACTOR).contains(factor)) {
            let velocity_m_s = self.said_m / self.seconds;
            let mean = libm::pow(known().product(), 1.0 / known().count() as f64);
            let likely = self.likely(factors);
            return Some(Contradiction::Speed { surface, uv_m_s: velocity_m_s * mean, velocity_m_s, likely });
        }
        let axes =
            [0, 1].map(|c| factors[c].is_some() && 10 * self.axes[c].against >= 8 * self.axes[c].count);
        (axes != [false; 2]).then_some(Contradiction::Turned { surface, axes })
    }

    fn likely(&self, factors: [Option<f64>; 2]) -> Likely {
        let size_m = self.sheet.size_m;
        let of_size = |scale: f64| size_m.map(|m| m * scale);
        let long_steps = self.seconds / f64::from(self.steps) >= LONG_STEP_S;
        let thousandth = if long_steps { Likely::TimesInMilliseconds } else { Likely::VelocityInMillimetres };
        let candidates = [
            (Likely::UvInMetres, of_size(1.0)),
            (Likely::UvInMillimetres, of_size(1e3)),
            (Likely::UvInCentimetres, of_size(1e2)),
            (thousandth, [1e-3; 2]),
            (Likely::VelocityInCentimetres, [1e-2; 2]),
        ];
        let off = |expected: &[f64; 2]| {
            let axes = factors
                .iter()
                .zip(expected)
                .filter_map(|(factor, expected)| Some(libm::log(factor.as_ref()? / expected).abs()));
            axes.fold(0.0, f64::max)
        };
        let nearest = candidates.iter().min_by(|a, b| off(&a.1).total_cmp(&off(&b.1)));
        match nearest {
            Some((likely, expected)) if off(expected) < libm::log(ALIKE) => *likely,
            _ if factors.iter().flatten().all(|factor| *factor > 8.0) => Likely::UvInTexels,
            _ => Likely::AnotherSize([0, 1].map(|c| factors[c].map(|factor| size_m[c] / factor))),
        }
    }
}

impl Sheet {
    /// Distance that a place has moved, m: over the edge of a surface that repeats, the way that
    /// the velocity says or the shorter one.
    fn moved_m(&self, from: [f64; 2], to: [f64; 2], said_m: [f64; 2]) -> [f64; 2] {
        let d = [0, 1].map(|c| (to[c] - from[c]) * self.size_m[c]);
        let wraps = |c: usize| {
            self.period_m[c].is_finite() && [from[c], to[c]].iter().all(|uv| (0.0..=1.0).contains(uv))
        };
        // So fast that an edge is crossed at every other step: whole laps are no movement, if they
        // are few.
        let is_fast = |c: &usize| wraps(*c) && said_m[*c].abs() > FAST * self.period_m[*c];
        let laps = [0, 1].map(|c| (said_m[c] - d[c]) / self.period_m[c]);
        let whole = |c: usize| (laps[c] - laps[c].round()).abs() < 0.05 && laps[c].abs() < MOST_LAPS;
        let by_velocity = [0, 1].into_iter().filter(is_fast).all(whole);
        [0, 1].map(|c| match self.period_m[c] {
            period_m if is_fast(&c) && by_velocity => d[c] + laps[c].round() * period_m,
            period_m if wraps(c) && d[c].abs() > 0.5 * period_m => d[c] - period_m.copysign(d[c]),
            _ => d[c],
        })
    }
}

impl Factors {
    fn add(&mut self, factor: f64) {
        let field = (libm::log2(factor.abs()) * FIELDS_AN_OCTAVE + 0.5 * FIELDS as f64).round();
        self.fields[(field.max(0.0) as usize).min(FIELDS - 1)] += 1;
        self.count += 1;
        self.against += u32::from(factor < 0.0);
    }

    /// Factor that most have, if they have one: the mean around the median.
    fn steady(&self, least: u32) -> Option<f64> {
        if self.count < least.max(LEAST_STEPS / 2) {
            return None;
        }
        let mut below = 0;
        let median = self.fields.iter().position(|count| {
            below += count;
            2 * below >= self.count
        })?;
        let near = || median.saturating_sub(NEAR)..(median + NEAR + 1).min(FIELDS);
        let count: u32 = near().map(|field| self.fields[field]).sum();
        if 10 * count < 6 * self.count {
            return None;
        }
        let log2 = |field: usize| (field as f64 - 0.5 * FIELDS as f64) / FIELDS_AN_OCTAVE;
        let sum: f64 = near().map(|field| f64::from(self.fields[field]) * log2(field)).sum();
        Some(libm::exp2(sum / f64::from(count)))
    }
}

fn length([u, v]: [f64; 2]) -> f64 {
    libm::hypot(u, v)
}
