//! Stimuli of a study as WAV files that a browser plays: rendered or taken as they are, all of them
//! with one gain a sense.

use super::spec::{Protocol, Role, Senses, Stimulus, Study};
use crate::error::CliError;
use crate::output::{self, Outputs};
use crate::progress::Progress;
use crate::render;
use crate::scene_log::load_log;
use crate::wav::{self, Bits};
use asperity::files::scene_file::SceneFile;
use asperity_dsp::butterworth::{Butterworth, State};
use serde::Serialize;
use std::path::Path;

/// Peak of the loudest stimulus.
const PEAK: f32 = 0.9;
/// Corner of an anchor that nobody gives (ITU-R BS.1534), Hz.
const ANCHOR_HZ: f64 = 3500.0;

/// A stimulus as the page has it; paths are relative to it.
#[derive(Debug, Serialize)]
pub struct Shown {
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    sound: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    touch: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    label: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    set: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    role: Option<Role>,
    #[serde(skip_serializing_if = "Option::is_none")]
    level: Option<f64>,
}

/// Samples of one sense.
struct Signal {
    rate_hz: f64,
    samples: Vec<f32>,
}

impl Signal {
    fn peak(&self) -> f32 {
        self.samples.iter().fold(0.0, |peak, sample| peak.max(sample.abs()))
    }

    /// Low-pass of fourth order: the second-order filter twice.
    fn dull(&self) -> Result<Self, CliError> {
        let filter = Butterworth::new(ANCHOR_HZ, self.rate_hz).map_err(CliError::from_error)?;
        let mut samples = self.samples.clone();
        for _ in 0..2 {
            let mut state = State::default();
            samples.iter_mut().for_each(|x| *x = state.tick(&filter, f64::from(*x)).low as f32);
        }
        Ok(Self { rate_hz: self.rate_hz, samples })
    }
}

/// Sound and touch of a stimulus.
type Signals = [Option<Signal>; 2];

/// Writes `stimuli/` of a page. Returns what the page plays, the place of the loudest, and what is
/// to be warned of.
///
/// # Errors
/// When a scene, a WAV or a picture cannot be read, or a file cannot be written.
pub fn write(
    study: &Study,
    folder: &Path,
    outputs: &mut Outputs,
) -> Result<(Vec<Shown>, usize, Vec<String>), CliError> {
    let mut warnings = Vec::new();
    let mut progress = Progress::new("rendering", study.stimulus.len() as u64);
    let mut all: Vec<(Stimulus, Signals)> = Vec::new();
    for stimulus in &study.stimulus {
        all.push((stimulus.clone(), signals(stimulus, study.senses, &mut warnings)?));
        progress.advance(1);
    }
    if study.protocol == Protocol::Rating {
        add_anchors(&mut all)?;
    }
    let peak = |sense: usize| {
        all.iter().filter_map(|(_, signals)| signals[sense].as_ref()).map(Signal::peak).fold(0.0, f32::max)
    };
    let gains = [0, 1].map(|sense| if peak(sense) > 0.0 { PEAK / peak(sense) } else { 1.0 });
    let strength = |signals: &Signals| {
        let of = |sense: usize| signals[sense].as_ref().map_or(0.0, |s: &Signal| s.peak() * gains[sense]);
        of(0).max(of(1))
    };
    let loudest = (0..all.len()).max_by(|a, b| strength(&all[*a].1).total_cmp(&strength(&all[*b].1)));
    let mut shown = Vec::new();
    for (number, (stimulus, signals)) in all.iter().enumerate() {
        if strength(signals) < 1e-3 {
            warnings.push(format!("stimulus {:?} is silent beside the loudest", stimulus.name));
        }
        shown.push(write_one(number, stimulus, signals, gains, folder, outputs)?);
    }
    Ok((shown, loudest.unwrap_or(0), warnings))
}

/// Files are numbered: a name would give the answer away to anybody who looks at what the browser
/// loads.
fn write_one(
    number: usize,
    stimulus: &Stimulus,
    signals: &Signals,
    gains: [f32; 2],
    folder: &Path,
    outputs: &mut Outputs,
) -> Result<Shown, CliError> {
    let mut paths = [None, None];
    for (sense, word) in ["sound", "touch"].into_iter().enumerate() {
        let Some(signal) = &signals[sense] else { continue };
        let name = format!("stimuli/{number:03}.{word}.wav");
        let scaled: Vec<f32> = signal.samples.iter().map(|x| x * gains[sense]).collect();
        wav::write_bits(outputs, &folder.join(&name), &[&scaled], signal.rate_hz, Bits::Sixteen)?;
        paths[sense] = Some(name);
    }
    let picture = match &stimulus.picture {
        None => None,
        Some(path) => {
            let bytes = std::fs::read(path).map_err(|error| CliError::read(path, &error))?;
            output::reads([path]);
            let ending = path.extension().unwrap_or_default().to_string_lossy();
            let name = format!("stimuli/{number:03}.{ending}");
            outputs.write(&folder.join(&name), &bytes)?;
            Some(name)
        }
    };
    let [sound, touch] = paths;
    let Stimulus { name, label, set, role, level, .. } = stimulus.clone();
    Ok(Shown { name, sound, touch, picture, label, set, role, level })
}

fn signals(stimulus: &Stimulus, senses: Senses, warnings: &mut Vec<String>) -> Result<Signals, CliError> {
    let (heard, felt) = (senses != Senses::Touch, senses != Senses::Sound);
    if let Some(path) = &stimulus.scene {
        let file = SceneFile::load(path)?;
        let (log, _) = load_log(&file)?;
        let (render, remarks) = render::in_memory(file, &log)?;
        warnings.extend(remarks.into_iter().map(|warning| format!("{}: {warning}", path.display())));
        let signal = |channels: &[Vec<f32>]| {
            let samples = channels.first()?.clone();
            Some(Signal { rate_hz: render.sample_rate_hz, samples })
        };
        let signals = [(heard, signal(&render.audio)), (felt, signal(&render.haptic))];
        if felt && signals[1].1.is_none() {
            let right = "add an [[actuator]], or write senses = \"sound\"";
            return Err(CliError::file(path, "has no haptic channel", right));
        }
        return Ok(signals.map(|(is_wanted, signal)| signal.filter(|_| is_wanted)));
    }
    let read = |path: &Option<std::path::PathBuf>| path.as_deref().map(read_wav).transpose();
    let (first, second) = (read(&stimulus.wav)?, read(&stimulus.haptic_wav)?);
    Ok(match senses {
        Senses::Sound => [first, None],
        Senses::Touch => [None, second.or(first)],
        Senses::Both => [first, second],
    })
}

/// First channel of a WAV file.
fn read_wav(path: &Path) -> Result<Signal, CliError> {
    output::reads([path]);
    let refuse = |error: hound::Error| match error {
        hound::Error::IoError(error) => CliError::read(path, &error),
        other => {
            CliError::file(path, format!("is no WAV file that is read here ({other})"), "use PCM or float")
        }
    };
    let mut reader = hound::WavReader::open(path).map_err(refuse)?;
    let spec = reader.spec();
    let every = usize::from(spec.channels);
    let samples: Result<Vec<f32>, hound::Error> = match spec.sample_format {
        hound::SampleFormat::Float => reader.samples::<f32>().step_by(every).collect(),
        hound::SampleFormat::Int => {
            let whole = (1i64 << (spec.bits_per_sample - 1)) as f32;
            reader.samples::<i32>().step_by(every).map(|x| x.map(|x| x as f32 / whole)).collect()
        }
    };
    Ok(Signal { rate_hz: f64::from(spec.sample_rate), samples: samples.map_err(refuse)? })
}

/// Sets that have a reference and no anchor get the reference without its high frequencies.
fn add_anchors(all: &mut Vec<(Stimulus, Signals)>) -> Result<(), CliError> {
    let has_anchor = |set: &Option<String>, all: &[(Stimulus, Signals)]| {
        all.iter().any(|(one, _)| one.set == *set && one.role == Some(Role::Anchor))
    };
    let mut anchors = Vec::new();
    for (reference, signals) in all.iter() {
        if reference.role != Some(Role::Reference) || has_anchor(&reference.set, all) {
            continue;
        }
        let dulled = |signal: &Option<Signal>| signal.as_ref().map(Signal::dull).transpose();
        let mut stimulus = reference.clone();
        stimulus.name = reference.set.as_ref().map_or("anchor".to_owned(), |set| format!("{set} anchor"));
        stimulus.role = Some(Role::Anchor);
        anchors.push((stimulus, [dulled(&signals[0])?, dulled(&signals[1])?]));
    }
    all.extend(anchors);
    Ok(())
}
