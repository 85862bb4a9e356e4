//! Levels of a live scene: found by trials when bodies and surfaces are added, kept by content,
//! applied where a body is struck and a surface stroked.

use crate::model::actuator::{ActuatorSettings, Quantity};
use crate::model::body::Body;
use crate::model::config::Config;
use crate::model::error::AddError;
use crate::model::level_policy::LevelPolicy;
use crate::model::levels::{AUDIO_REFERENCE, HAPTIC_REFERENCE, SILENT, STRIKE, STRIKE_REFERENCE};
use crate::model::material::Material;
use crate::model::modal_model::ModalModel;
use crate::model::mode_shapes::Unit;
use crate::model::stock::Stock;
use crate::model::surface::Surface;

use crate::resource::surface::{StrokeLevel, SurfaceLevels};
use asperity_dsp::hertz::{HertzContact, HertzPulse};
use asperity_dsp::micro_contact::Probe;
use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Rms towards which a stroke grows that nobody feels, full scale 1: −20 dB. Peaks are four times
/// as high, two bodies may sound, and the growth of one stands for that of the other.
const LOUDEST_STROKE: f64 = 0.1;
/// Exponent of a stroke's growth with its speed, the least that was measured on ground that is
/// pressed hard: with a greater one what slides faster would be softer.
const SPEED_EXPONENT: f64 = 0.4;
/// Bodies of which the trials are kept.
const MOST_BODIES: usize = 64;
/// Surfaces of which the trials are kept, each on the body that it had.
const MOST_SURFACES: usize = 256;
/// Impulse of a reference strike, N·s.
const STRIKE_N_S: f64 = 2.0 * STRIKE.mass_kg * STRIKE.speed_m_s;
/// Body under a surface that has none, for what is held and rings by strokes on it.
const STAND_IN: (Stock, Material, f64) = (Stock::Plate, Material::CERAMIC, 0.14);

/// Forces of the strokes that show how a surface grows louder, N, and their speed, m/s: from what
/// weighs 10 g to what weighs 100 kg.
pub(crate) const FORCES_N: [f64; 5] = [0.1, 1.0, 10.0, 100.0, 1000.0];
pub(crate) const FAST_M_S: f64 = 1.0;

/// Figures of a body at a gain of 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyTrial {
    /// Rms where it is drawn over a plain ground as a rigid tool is: the same excitation for every
    /// body.
    pub(crate) drawn: f64,
    /// Peak of one reference strike, and of fifty a second.
    pub(crate) struck: f64,
    pub(crate) burst: f64,
}

/// Figures of a surface with one probe.
#[derive(Debug, Clone)]
pub(crate) struct StrokeTrial {
    /// Rms of its body under the reference stroke, and of each [kind](kinds) of channel.
    pub(crate) heard: f64,
    pub(crate) felt: Vec<f64>,
    /// Rms of its body at each of [`FORCES_N`].
    pub(crate) fast: [f64; FORCES_N.len()],
}

/// A surface, and its figures with each probe.
pub(crate) type SurfaceTrials = (Surface, Vec<StrokeTrial>);

/// Places of probes, none for the engine's own, and the probes.
pub(crate) type Probes = [(Option<usize>, Probe)];

/// Trials, which need an engine of their own.
#[derive(Clone, Copy)]
pub(crate) struct Trials {
    pub(crate) of_body: fn(&Config, &Body) -> Result<BodyTrial, AddError>,
    /// Renders over a surface and gives it back.
    pub(crate) of_surface: fn(&Config, Surface, &Body, &Probes) -> Result<SurfaceTrials, AddError>,
    /// Hashes the content of a surface as far as reference strokes meet it.
    pub(crate) content: fn(&mut Surface) -> Result<DefaultHasher, AddError>,
}

/// The first channel of each kind of output among those of an engine.
pub(crate) fn kinds(channels: &[ActuatorSettings]) -> Vec<usize> {
    let first = |kind| channels.iter().position(|channel| channel.output == kind);
    let kinds = [Quantity::Displacement, Quantity::Acceleration, Quantity::Tangential, Quantity::Force];
    kinds.into_iter().filter_map(first).collect()
}

/// Contact times for which the peak of a blow is worked out, s: each so many times the one before.
const TIMES: usize = 14;
const SHORTEST_S: f64 = 2e-5;
const TIME_RATIO: f64 = 2.0;

/// Peak of an impact of 1 N·s on a body, full scale 1, by the logarithm of its contact's duration.
///
/// ```text
/// peak(τ) = max(c Σ |aᵢ| p(fᵢ τ), Σ |aᵢ| q(fᵢ τ))      p(x) = (1 + (1.35 x)⁵)^(−½),  q(x) = 0.13 / x above 1
/// ```
/// p: envelope of the spectrum of Hertz' pulse (within 4 dB); c: that of the reference strike,
/// whose modes do not peak at once. q: half the share with which a mode follows a slow force, since
/// not all push alike. aᵢ, fᵢ: modes and bands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BlowPeaks([f64; TIMES]);

impl BlowPeaks {
    /// Peaks of nothing that rings.
    const SILENT: Self = Self([0.0; TIMES]);

    /// Peaks of a body at a gain; that of the reference strike is known at a gain of 1.
    fn of(body: &Body, gain: f64, reference_per_n_s: f64) -> Self {
        let lines = lines(&body.model);
        let sum = |share: &dyn Fn(f64) -> f64| lines.iter().map(|[hz, a]| a * share(*hz)).sum::<f64>();
        let rung = |time_s: f64| sum(&|hz| spectrum(hz * time_s));
        let known = rung(reference_time_s(body.material));
        let unit = gain * reference_per_n_s / known.max(f64::MIN_POSITIVE);
        Self(std::array::from_fn(|k| {
            let time_s = SHORTEST_S * TIME_RATIO.powi(k as i32);
            f64::max(unit * rung(time_s), gain * sum(&|hz| followed(hz * time_s)))
        }))
    }

    /// Peak of a pulse.
    fn at(&self, pulse: HertzPulse) -> f64 {
        pulse.elastic_parts().map(|part| self.at_elastic(part)).sum()
    }

    fn at_elastic(&self, pulse: HertzPulse) -> f64 {
        let steps = libm::log2(pulse.contact_time_s / SHORTEST_S) / libm::log2(TIME_RATIO);
        let steps = steps.clamp(0.0, (TIMES - 1) as f64);
        let below = (steps as usize).min(TIMES - 2);
        let [low, high] = [self.0[below], self.0[below + 1]];
        pulse.impulse_n_s * (low + (steps - below as f64) * (high - low))
    }
}

/// Frequency, Hz, and amplitude after 1 N·s of each mode and of each band.
fn lines(model: &ModalModel) -> Vec<[f64; 2]> {
    let modes = model.modes.iter().map(|mode| [mode.frequency_hz, mode.amplitude.abs()]);
    let bands = model.diffuse.iter().flat_map(|diffuse| &diffuse.bands);
    let bands = bands.map(|band| [band.centre_hz, band.amplitude()]);
    modes.chain(bands).map(|[hz, a]| [hz, a / model.impulse_n_s]).collect()
}

/// Spectrum of a pulse of this duration, periods of a mode, over that of an impulse.
fn spectrum(periods: f64) -> f64 {
    (1.0 + libm::pow(1.35 * periods, 5.0)).sqrt().recip()
}

/// Share of a mode's answer to an impulse with which it follows such a pulse.
fn followed(periods: f64) -> f64 {
    if periods > 1.0 { 0.13 / periods } else { 0.0 }
}

/// Duration of the reference strike on a body of this material, s.
fn reference_time_s(material: Material) -> f64 {
    let [steel, body] = [Material::STEEL, material].map(|material| material.elastic());
    HertzContact::new(&steel, &body, STRIKE.radius_m, STRIKE.mass_kg)
        .map_or(SHORTEST_S, |contact| contact.contact_time_s(STRIKE.speed_m_s))
}

/// Level of one body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BodyLevel {
    /// Gain of its modes.
    pub(crate) gain: f64,
    /// Gain with which it would land on the reference: that of trials of its surfaces, so that what
    /// rings beside it on them has its own level.
    pub(crate) own_gain: f64,
    /// Gain of impacts beside strokes.
    pub(crate) strike_gain: f64,
    /// Peaks of impacts; 0 where nothing is known.
    pub(crate) blows: BlowPeaks,
}

/// Trials of a scene, and the levels that its things share.
pub(crate) struct Levels {
    trials: Trials,
    body: Option<f64>,
    strikes: Option<f64>,
    heard: Option<f64>,
    felt: HashMap<usize, Option<f64>>,
    bodies: Vec<(ModalModel, Material, BodyTrial)>,
    surfaces: HashMap<u64, Vec<StrokeTrial>>,
}

impl BodyLevel {
    /// Level of nothing that rings.
    pub(crate) const SILENT: Self =
        Self { gain: 1.0, own_gain: 1.0, strike_gain: 1.0, blows: BlowPeaks::SILENT };

    /// Level of a body as its numbers say.
    pub(crate) fn given(body: &Body) -> Self {
        let strike_gain = body.strike_gain.unwrap_or(1.0);
        Self { strike_gain, ..Self::SILENT }
    }

    /// The factor that keeps an impact within full scale.
    pub(crate) fn blow_factor(&self, pulse: HertzPulse) -> f64 {
        let peak = self.blows.at(pulse);
        (1.0 + peak * peak).sqrt().recip()
    }
}

impl StrokeLevel {
    /// The factor that keeps a stroke within [`LOUDEST_STROKE`].
    pub(crate) fn stroke_factor(&self, force_n: f64, speed_m_s: f64) -> f64 {
        let decades = libm::log10(force_n.max(FORCES_N[0]) / FORCES_N[0]);
        let below = (decades as usize).min(FORCES_N.len() - 2);
        let share = (decades - below as f64).clamp(0.0, 1.0);
        let [low, high] = [self.fast[below], self.fast[below + 1]];
        let rms = (low + share * (high - low)) * libm::pow(speed_m_s / FAST_M_S, SPEED_EXPONENT);
        let over = rms / LOUDEST_STROKE;
        (1.0 + over * over).sqrt().recip()
    }
}

impl Levels {
    /// Nothing found yet.
    pub(crate) fn new(trials: Trials) -> Self {
        let (bodies, surfaces, felt) = Default::default();
        Self { trials, body: None, strikes: None, heard: None, felt, bodies, surfaces }
    }

    /// Level of a body that is added.
    pub(crate) fn body(&mut self, config: &Config, body: &Body) -> Result<BodyLevel, AddError> {
        let given = BodyLevel::given(body);
        let in_pascals = body.model.unit == Unit::PascalsAtOneMetre
            && config.audio.get(body.bus).is_some_and(|bus| bus.pascals_at_full_scale.is_some());
        if config.levels == LevelPolicy::AsGiven || in_pascals {
            return Ok(given);
        }
        let trial = self.body_trial(config, body)?;
        let (found, reference) = match (trial.drawn > SILENT, trial.struck > SILENT) {
            (true, _) => (trial.drawn, AUDIO_REFERENCE),
            (false, true) => (trial.struck, STRIKE_REFERENCE),
            (false, false) => return Ok(given),
        };
        let gain = config.levels.factor(reference, found, &mut self.body);
        let within = (gain * trial.burst).max(1.0);
        let own = config.levels.factor(1.0, within, &mut self.strikes);
        let strike_gain = body.strike_gain.unwrap_or(own);
        let blows = BlowPeaks::of(body, gain * strike_gain, trial.struck / STRIKE_N_S);
        Ok(BodyLevel { gain, own_gain: reference / found, strike_gain, blows })
    }

    /// Peak of an impact of 1 N·s on a body whose gains are 1.
    pub(crate) fn peak_per_n_s(&mut self, config: &Config, body: &Body) -> Result<f64, AddError> {
        Ok(self.body_trial(config, body)?.struck / STRIKE_N_S)
    }

    fn body_trial(&mut self, config: &Config, body: &Body) -> Result<BodyTrial, AddError> {
        let known = self.bodies.iter().find(|(model, of, _)| *of == body.material && *model == body.model);
        if let Some((_, _, trial)) = known {
            return Ok(*trial);
        }
        let trial = (self.trials.of_body)(config, body)?;
        if self.bodies.len() == MOST_BODIES {
            self.bodies.remove(0);
        }
        self.bodies.push((body.model.clone(), body.material, trial));
        Ok(trial)
    }

    /// Modes that are `gain` times as loud.
    pub(crate) fn model_at(model: &ModalModel, gain: f64) -> Result<Cow<'_, ModalModel>, AddError> {
        if gain == 1.0 {
            return Ok(Cow::Borrowed(model));
        }
        model.clone().with_gain(gain).map(Cow::Owned).map_err(|_| too_loud(gain))
    }

    /// A body that lands on the reference.
    fn at_reference(body: &Body, level: BodyLevel) -> Result<Body, AddError> {
        Ok(Body { model: Self::model_at(&body.model, level.own_gain)?.into_owned(), ..body.clone() })
    }

    /// Levels of the strokes on a surface that is added, and the surface. `body` is what it rings,
    /// and its level.
    pub(crate) fn surface(
        &mut self,
        config: &Config,
        surface: Surface,
        body: Option<(&Body, BodyLevel)>,
        probes: &Probes,
    ) -> Result<(Surface, SurfaceLevels), AddError> {
        // A stroke would leave its print.
        if config.levels == LevelPolicy::AsGiven || surface.properties().picture.is_some() {
            return Ok((surface, SurfaceLevels::default()));
        }
        let body = match body {
            Some((body, level)) => Self::at_reference(body, level)?,
            None => self.stand_in(config)?,
        };
        let rubs = surface.rubs().is_some();
        let (surface, trials) = self.surface_trials(config, surface, &body, probes)?;
        let levels = probes.iter().zip(trials).map(|((place, _), trial)| {
            let found = if rubs { 0.0 } else { trial.heard };
            let heard =
                if rubs { 1.0 } else { config.levels.factor(AUDIO_REFERENCE, found, &mut self.heard) };
            let felt = self.felt(config, &trial.felt);
            let fast = trial.fast.map(|rms| if rubs { 0.0 } else { heard * rms });
            (*place, StrokeLevel { heard, felt, fast })
        });
        let levels = SurfaceLevels(levels.collect());
        Ok((surface, levels))
    }

    /// Factor of each channel; `found` is by kind.
    fn felt(&mut self, config: &Config, found: &[f64]) -> Box<[f64]> {
        let kinds = kinds(&config.actuators);
        let factor = |(channel, settings): (usize, &ActuatorSettings)| {
            let kind = kinds.iter().position(|first| config.actuators[*first].output == settings.output);
            let found = kind.map_or(0.0, |kind| found[kind]);
            let found = if found > SILENT { found } else { 0.0 };
            let shared = self.felt.entry(channel).or_default();
            config.levels.factor(HAPTIC_REFERENCE * settings.full_scale, found, shared)
        };
        config.actuators.iter().enumerate().map(factor).collect()
    }

    fn stand_in(&mut self, config: &Config) -> Result<Body, AddError> {
        let (shape, material, size_m) = STAND_IN;
        let body = Body::stock(shape, material, size_m).map_err(|_| AddError::Unknown("plate"))?;
        let level = self.body(config, &body)?;
        Self::at_reference(&body, level)
    }

    fn surface_trials(
        &mut self,
        config: &Config,
        mut surface: Surface,
        body: &Body,
        probes: &Probes,
    ) -> Result<SurfaceTrials, AddError> {
        let mut hasher = (self.trials.content)(&mut surface)?;
        let rings = surface.body.is_some();
        format!("{rings} {probes:?} {:?} {:?}", body.material, body.model.impulse_n_s).hash(&mut hasher);
        for mode in &body.model.modes {
            [mode.frequency_hz, mode.decay_per_s, mode.amplitude].map(f64::to_bits).hash(&mut hasher);
        }
        let key = hasher.finish();
        if let Some(trials) = self.surfaces.get(&key) {
            return Ok((surface, trials.clone()));
        }
        let (surface, trials) = (self.trials.of_surface)(config, surface, body, probes)?;
        // A game that makes surfaces without end measures them anew now and then.
        if self.surfaces.len() == MOST_SURFACES {
            self.surfaces.clear();
        }
        self.surfaces.insert(key, trials.clone());
        Ok((surface, trials))
    }
}

fn too_loud(value: f64) -> AddError {
    let expected = "a level at which no amplitude leaves ±1e9; write the body's modes in other units";
    AddError::Design(asperity_dsp::DesignError { field: "level", value, expected })
}
