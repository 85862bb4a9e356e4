//! The level policy: what `full_scale` and `gain` are where a scene does not say.
//!
//! One reference stroke, 0.1 m/s at 1 N, is rendered over every surface of the scene with every
//! probe, four times in directions of its own, before anything else; the loudest and the strongest
//! of them land on the reference levels below. So levels follow from relief, probe, material and
//! modes, whatever they are, and within a scene surfaces and probes keep their differences. From
//! there a stroke grows as it does: faster and harder is stronger.
//!
//! | | reference level | head room to full scale |
//! |---|---|---|
//! | haptic channel | −26 dBFS rms ([`HAPTIC_REFERENCE`]) | strokes four times as fast and five times as hard, with peaks of four times their rms |
//! | audio bus | −32 dBFS rms ([`AUDIO_REFERENCE`]) | the same for sound, whose peaks are higher |
//!
//! Buses without a gain of their own share one, so that bodies on different buses keep their
//! loudness beside each other: the loudest stroke of them all lands on the reference.
//!
//! A bus that says how many pascals full scale is, and holds bodies whose modes are in pascals, has
//! their level from there: the gain by policy follows from other bodies and leaves these alone; a
//! bus without others has 1.
//!
//! Strikes are far louder than strokes where mechanics has the word, and what rings long adds them
//! up. So impacts have a gain of their own beside strokes, `strike_gain`, at most 1: one for all
//! bodies whose bus has its gain from here, the greatest with which fifty reference strikes a
//! second, 10 g of steel at 0.5 m/s, peak within full scale on every one of them. Bodies keep their
//! loudness beside each other when they are struck; a `strike_gain` that a body writes is its own,
//! and 1 is mechanics'.
//!
//! Where no stroke is heard, one reference strike counts: it peaks at −12 dBFS. Sand is left out,
//! because the stroke would leave its print; a scene of nothing else has [`FALLBACK_FULL_SCALE_M`]
//! and a gain of 1. Where a level was resolved a peak limiter stands behind it, unless the scene
//! says `limit = false`.

use crate::engine::Engine;
use crate::files::FileError;
use crate::files::contact_log::{ContactLog, LogEdit, LogEvent, LogHand, LogLine, Striker};
use crate::files::scene_file::{SceneFile, Source};
use crate::make::maker::felt_force_exponent;
use crate::model::actuator::Quantity;
use crate::model::event::ContactSample;
pub use crate::model::levels::{
    AUDIO_REFERENCE, HAPTIC_REFERENCE, Levels, REFERENCE_FORCE_N, REFERENCE_SPEED_M_S, STRIKE_REFERENCE,
};
use crate::model::levels::{BURST, FROM, PAUSE_S, SETTLED_S, SILENT, STRIKE, STROKE_S, WAYS, mean_power};
use crate::offline::{self, Options, Render};
use asperity_dsp::limits::output as limits;

/// Displacement at full scale where nothing says better, m.
pub const FALLBACK_FULL_SCALE_M: f64 = 1e-4;
/// Acceleration at full scale where nothing says better, m/s².
pub const FALLBACK_FULL_SCALE_M_S2: f64 = 50.0;
/// Contact force at full scale where nothing says better, N.
pub const FALLBACK_FULL_SCALE_N: f64 = 10.0;

impl Levels {
    /// Levels of the scene; NaN where it has none.
    fn written(file: &SceneFile) -> Self {
        Self {
            full_scale: file.actuators.iter().map(|entry| entry.full_scale.unwrap_or(f64::NAN)).collect(),
            felt_force_exponent: file.actuators.iter().map(felt_force_exponent).collect(),
            gain: file.audio.iter().map(|entry| entry.gain.unwrap_or(f64::NAN)).collect(),
            strike_gain: file.bodies.iter().map(|entry| entry.strike_gain.unwrap_or(1.0)).collect(),
        }
    }

    fn is_whole(&self) -> bool {
        self.full_scale.iter().chain(&self.gain).all(|level| level.is_finite())
    }
}

/// The levels of a scene; `assemble` builds it with levels of 1 and nothing behind them.
pub(super) fn resolve(
    file: &SceneFile,
    calibrated: &[bool],
    assemble: impl FnOnce(&Levels) -> Result<Engine, FileError>,
) -> Result<Levels, FileError> {
    let mut levels = Levels::written(file);
    if levels.is_whole() {
        return Ok(levels);
    }
    let plain = Levels {
        full_scale: vec![1.0; levels.full_scale.len()],
        gain: vec![1.0; levels.gain.len()],
        ..levels.clone()
    };
    let trials = Trials::of(file, calibrated);
    let Engine { scene, renderer, names, .. } = assemble(&plain)?;
    let options = Options { tail_s: 0.3, ..Options::default() };
    let render =
        offline::render(scene, renderer, &trials.log, &names, &options).map_err(FileError::from_error)?;
    for (channel, level) in levels.full_scale.iter_mut().enumerate().filter(|(_, level)| level.is_nan()) {
        let kind = file.actuators[channel].settings.output;
        let strongest = trials.strongest(&render, |stroke| {
            (file.actuators[stroke.actuator].settings.output == kind)
                .then(|| &render.haptic[stroke.actuator][..])
        });
        *level = match kind {
            _ if strongest > SILENT => strongest / HAPTIC_REFERENCE,
            Quantity::Displacement | Quantity::Tangential => FALLBACK_FULL_SCALE_M,
            Quantity::Acceleration => FALLBACK_FULL_SCALE_M_S2,
            Quantity::Force => FALLBACK_FULL_SCALE_N,
        };
    }
    let shared: Vec<usize> =
        (0..levels.gain.len()).filter(|&bus| levels.gain[bus].is_nan() && trials.levelled[bus]).collect();
    let gain = trials.gain(&render, &shared);
    for (bus, level) in levels.gain.iter_mut().enumerate().filter(|(_, level)| level.is_nan()) {
        *level = if shared.contains(&bus) { gain } else { 1.0 };
    }
    let silent =
        |burst: &&Burst| shared.contains(&burst.bus) && file.bodies[burst.body].strike_gain.is_none();
    let loudest =
        trials.bursts.iter().filter(silent).map(|burst| gain * burst.peak(&render)).fold(0.0, f64::max);
    for burst in trials.bursts.iter().filter(silent) {
        levels.strike_gain[burst.body] = loudest.max(1.0).recip();
    }
    Ok(levels)
}

/// A reference stroke among the trials.
struct Trial {
    actuator: usize,
    /// Bus of the body that it rings; none where that is set in pascals, or nothing rings.
    bus: Option<usize>,
    start_s: f64,
}

/// Reference strikes that follow each other on one body.
struct Burst {
    body: usize,
    bus: usize,
    start_s: f64,
}

impl Burst {
    /// Between this one and the next, s: what rings is damped in it.
    pub(crate) const PAUSE_S: f64 = 0.15;

    fn length_s() -> f64 {
        f64::from(BURST.0) * BURST.1
    }

    /// Its peak.
    fn peak(&self, render: &Render) -> f64 {
        let ends_s = [self.start_s, self.start_s + Self::length_s()];
        peak(&render.audio[self.bus], ends_s, render.sample_rate_hz)
    }
}

/// Everything that is tried, as a log.
struct Trials {
    log: ContactLog,
    strokes: Vec<Trial>,
    /// True for each bus that a body plays on and that does not say in pascals how loud it is.
    levelled: Vec<bool>,
    /// Times of the single strikes, from and to.
    strikes_s: [f64; 2],
    bursts: Vec<Burst>,
}

impl Trials {
    fn of(file: &SceneFile, calibrated: &[bool]) -> Self {
        let is_calibrated = |name: &String| {
            file.bodies.iter().zip(calibrated).any(|(body, calibrated)| body.name == *name && *calibrated)
        };
        let bus_of = |name: &String| {
            let body = file.bodies.iter().find(|body| body.name == *name && !is_calibrated(name))?;
            // Where it is loudest.
            Some(body.plays_on(&file.audio)[0].0)
        };
        let mut trials = Self {
            log: ContactLog { lines: Vec::new() },
            strokes: Vec::new(),
            levelled: vec![false; file.audio.len()],
            strikes_s: [0.0; 2],
            bursts: Vec::new(),
        };
        for body in file.bodies.iter().filter(|body| !is_calibrated(&body.name)) {
            body.plays_on(&file.audio).iter().for_each(|(bus, _)| trials.levelled[*bus] = true);
        }
        let probes = std::iter::once(None).chain(file.probes.iter().map(|(name, _)| Some(name.as_str())));
        let probes: Vec<Option<&str>> = probes.collect();
        let mut at_s = 0.0;
        for (surface, entry) in file.surfaces.iter().enumerate() {
            if matches!(entry.source, Source::Sand(_)) {
                continue;
            }
            for probe in &probes {
                for actuator in kinds(file) {
                    for way in WAYS {
                        let bus = entry.body.as_ref().and_then(bus_of);
                        trials.stroke(file, (surface, *probe, actuator), way, (at_s, bus));
                        at_s += STROKE_S + PAUSE_S;
                    }
                }
            }
        }
        trials.strikes_s[0] = at_s;
        for body in file.bodies.iter().filter(|body| !is_calibrated(&body.name)) {
            trials.log.lines.push(LogLine { t: at_s, event: strike(&body.name) });
            at_s += PAUSE_S;
        }
        trials.strikes_s[1] = at_s;
        for (body, entry) in file.bodies.iter().enumerate() {
            if let Some(bus) = bus_of(&entry.name).filter(|bus| file.audio[*bus].gain.is_none()) {
                trials.burst(&entry.name, Burst { body, bus, start_s: at_s + Burst::PAUSE_S });
                at_s += Burst::PAUSE_S + Burst::length_s();
            }
        }
        trials
    }

    /// Adds a burst; what rang before is damped.
    fn burst(&mut self, name: &str, burst: Burst) {
        let damped = LogLine { t: burst.start_s - Burst::PAUSE_S, event: LogEvent::Edit(LogEdit::FadeAll) };
        self.log.lines.push(damped);
        self.log.lines.extend(
            (0..BURST.0).map(|n| LogLine { t: burst.start_s + f64::from(n) * BURST.1, event: strike(name) }),
        );
        self.bursts.push(burst);
    }

    fn stroke(
        &mut self,
        file: &SceneFile,
        (surface, probe, actuator): (usize, Option<&str>, usize),
        way: [f64; 2],
        (start_s, bus): (f64, Option<usize>),
    ) {
        let entry = &file.surfaces[surface];
        let size_m = [entry.width_m, entry.height_m];
        let contact = self.strokes.len() as u64;
        let sample = |t: f64| {
            let velocity_m_s = way.map(|share| share * REFERENCE_SPEED_M_S);
            let uv = [0, 1].map(|axis| FROM[axis] + velocity_m_s[axis] * t / size_m[axis]);
            let velocity_m_s = Some(velocity_m_s);
            ContactSample {
                uv,
                velocity_m_s,
                normal_force_n: REFERENCE_FORCE_N,
                closing_m_s: 0.0,
                ..ContactSample::default()
            }
        };
        let hand = LogHand { probe: probe.map(str::to_owned), ..LogHand::felt_by(actuator as u16) };
        let times = (0..(STROKE_S * 60.0) as usize).map(|step| step as f64 / 60.0);
        let samples = times.map(|t| (start_s + t, sample(t)));
        self.log.lines.extend(LogLine::contact(contact, (&entry.name, hand), samples, start_s + STROKE_S));
        self.strokes.push(Trial { actuator, bus, start_s });
    }

    /// The gain that some buses share: the loudest stroke on them lands on its reference, or a
    /// strike where no stroke is heard.
    fn gain(&self, render: &Render, buses: &[usize]) -> f64 {
        let heard =
            |stroke: &Trial| stroke.bus.filter(|bus| buses.contains(bus)).map(|bus| &render.audio[bus][..]);
        let loudest = self.strongest(render, heard);
        let struck = buses.iter().map(|&bus| self.struck(render, &render.audio[bus])).fold(0.0, f64::max);
        let gain = match (loudest > SILENT, struck > SILENT) {
            (true, _) => AUDIO_REFERENCE / loudest,
            (false, true) => STRIKE_REFERENCE / struck,
            (false, false) => 1.0,
        };
        gain.min(limits::AUDIO_GAIN.high)
    }

    /// Greatest rms of what strokes in all directions give: the mean of their levels in decibels,
    /// so that ground that is loud in one of them lands in the middle.
    fn strongest<'a>(&self, render: &Render, of: impl Fn(&Trial) -> Option<&'a [f32]>) -> f64 {
        let power = |trial: &Trial| {
            let samples = of(trial)?;
            let range = [SETTLED_S, STROKE_S].map(|s| ((trial.start_s + s) * render.sample_rate_hz) as usize);
            let part = samples.get(range[0]..range[1])?;
            Some(part.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / part.len().max(1) as f64)
        };
        let means = self.strokes.chunks(WAYS.len()).filter_map(|strokes| {
            let powers: Vec<f64> = strokes.iter().filter_map(power).collect();
            mean_power(&powers)
        });
        means.fold(0.0, f64::max).sqrt()
    }

    /// Peak of what the strikes give.
    fn struck(&self, render: &Render, samples: &[f32]) -> f64 {
        peak(samples, self.strikes_s, render.sample_rate_hz)
    }
}

/// Largest sample between two times.
fn peak(samples: &[f32], ends_s: [f64; 2], sample_rate_hz: f64) -> f64 {
    let [from, to] = ends_s.map(|s| ((s * sample_rate_hz) as usize).min(samples.len()));
    samples[from..to].iter().fold(0.0, |peak, x| peak.max(f64::from(x.abs())))
}

/// The first actuator of each kind of output.
fn kinds(file: &SceneFile) -> Vec<usize> {
    let first = |kind| file.actuators.iter().position(|entry| entry.settings.output == kind);
    [Quantity::Displacement, Quantity::Acceleration, Quantity::Tangential, Quantity::Force]
        .into_iter()
        .filter_map(first)
        .collect()
}

/// The reference strike on a body.
fn strike(body: &str) -> LogEvent {
    let steel = Striker::Preset("steel".to_owned());
    LogEvent::strike(body, STRIKE.speed_m_s, steel, (STRIKE.mass_kg, STRIKE.radius_m))
}
