//! Inputs: samples, a scene that is rendered, or a clip.

use super::{name_of, port::transients_of};
use crate::error::CliError;
use crate::scene_log::{load_log, read_past};
use crate::shapes;
use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::offline;
use asperity::{Engine, Quantity};
use asperity_fit::recording::{RecordingError, Sound};
use asperity_ports::{Clip, Device, ahap, haptic_file, hjif};
use std::path::Path;

/// Longest file that is read as text, bytes.
const LONGEST_TEXT: u64 = 1 << 30;

/// Vibration that was read.
pub enum Input {
    /// Samples of displacement.
    Samples {
        samples: Vec<f64>,
        rate_hz: f64,
        /// Times at which contacts begin and bodies are struck, s.
        strokes_s: Vec<f64>,
        remarks: Vec<String>,
        source: String,
    },
    /// Envelopes.
    Clip { clip: Clip, remarks: Vec<String> },
}

/// Reads a file by the end of its name.
pub fn read(path: &Path, channel: usize, _device: &Device) -> Result<Input, CliError> {
    let name = name_of(path);
    let ending = name.rsplit('.').next().unwrap_or_default().to_lowercase();
    let remarks = |error: asperity_ports::PortError| CliError::from_error(error.within(path.display()));
    match ending.as_str() {
        "wav" | "aif" | "aiff" | "flac" | "ogg" | "oga" | "mp3" | "m4a" => sound(path, channel),
        "toml" => scene(path, channel),
        "haptic" => {
            let read = haptic_file::parse(&text(path)?).map_err(remarks)?;
            Ok(Input::Clip { clip: read.clip, remarks: read.remarks })
        }
        "ahap" => clip_of_ahap(path),
        "hjif" => {
            let samples = hjif::rendered(&text(path)?, channel).map_err(remarks)?;
            Ok(Input::Samples {
                samples,
                rate_hz: hjif::RATE_HZ,
                strokes_s: Vec::new(),
                remarks: Vec::new(),
                source: name,
            })
        }
        _ => Err(CliError::file(
            path,
            "is no format that is read",
            "must end in .wav, .aiff, .flac, .ogg, .mp3, .m4a, .toml, .haptic, .ahap or .hjif",
        )),
    }
}

fn text(path: &Path) -> Result<String, CliError> {
    let length = std::fs::metadata(path).map_err(|error| CliError::read(path, &error))?.len();
    if length > LONGEST_TEXT {
        return Err(CliError::file(path, format!("has {length} bytes"), "must be at most 1 GiB"));
    }
    let bytes = std::fs::read(path).map_err(|error| CliError::read(path, &error))?;
    String::from_utf8(bytes).map_err(|_| CliError::file(path, "is no text", "must be JSON in UTF-8"))
}

/// A clip, and its strokes where they lie in a file of their own beside it.
fn clip_of_ahap(path: &Path) -> Result<Input, CliError> {
    let at =
        |path: &Path, error: asperity_ports::PortError| CliError::from_error(error.within(path.display()));
    let beside = transients_of(path);
    let main = text(path)?;
    if !beside.exists() {
        let read = ahap::parse(&main).map_err(|error| at(path, error))?;
        return Ok(Input::Clip { clip: read.clip, remarks: read.remarks });
    }
    crate::output::reads([&beside]);
    let read = ahap::parse_both(&main, &text(&beside)?).map_err(|error| at(path, error))?;
    let mut remarks = read.remarks;
    remarks.push(format!("strokes are from {}", name_of(&beside)));
    Ok(Input::Clip { clip: read.clip, remarks })
}

/// One channel of a sound file.
fn sound(path: &Path, channel: usize) -> Result<Input, CliError> {
    let sound = Sound::load(path, channel, asperity_ports::clip::LONGEST_S).map_err(|error| match error {
        RecordingError::NoSuchChannel { name, wanted, last } => CliError::new(
            "--channel",
            format!("{wanted} is not in {name}"),
            format!("must be below {}", last + 1),
        ),
        other => CliError::from_error(other),
    })?;
    let name = name_of(path);
    let cut = format!("{name} ends before its header says: what is there was read");
    Ok(Input::Samples {
        samples: sound.samples,
        rate_hz: sound.sample_rate_hz,
        strokes_s: Vec::new(),
        remarks: if sound.truncated { vec![cut] } else { Vec::new() },
        source: name,
    })
}

/// Quantity that drives an actuator of a scene.
fn scene(path: &Path, channel: usize) -> Result<Input, CliError> {
    let mut file = SceneFile::load(path)?;
    let Some(actuator) = file.actuators.get(channel) else {
        let right = format!("must be below {}, the number of [[actuator]] tables", file.actuators.len());
        return Err(CliError::new("--channel", format!("{channel} is not in {}", path.display()), right));
    };
    let given = match actuator.settings.output {
        Quantity::Displacement | Quantity::Tangential => None,
        Quantity::Acceleration => Some("acceleration"),
        Quantity::Force => Some("force"),
    };
    if let Some(given) = given {
        let what = format!("actuator {channel} gives {given}");
        return Err(CliError::file(path, what, "write output = \"displacement\" to make a clip of it"));
    }
    let (log, unread) = load_log(&file)?;
    shapes::solve(&mut file)?;
    let built = Engine::from_scene(&file, &Overrides::default())?;
    let settings = offline::Options { tail_s: file.tail_s, ..offline::Options::default() };
    let Engine { scene, renderer, names, .. } = built;
    let render = offline::render(scene, renderer, &log, &names, &settings)
        .map_err(|error| CliError::from_error(error).within(path.display()))?;
    let samples = render.haptic[channel].iter().map(|x| f64::from(*x)).collect();
    Ok(Input::Samples {
        samples,
        rate_hz: render.sample_rate_hz,
        strokes_s: strokes_s(&log, channel),
        remarks: unread.iter().map(|place| read_past(place)).collect(),
        source: name_of(path),
    })
}

/// Times at which something lands on a channel's hand or strikes in it, s.
pub fn strokes_s(log: &ContactLog, channel: usize) -> Vec<f64> {
    let felt_here = |event: &LogEvent| match event {
        LogEvent::Begin { touching, .. } => touching.hand.actuator,
        LogEvent::Impact { hand, .. } => hand.actuator,
        LogEvent::Move { .. } | LogEvent::End { .. } | LogEvent::Motion { .. } | LogEvent::Edit(_) => None,
    };
    let here = |actuator: Option<u16>| actuator.is_some_and(|actuator| usize::from(actuator) == channel);
    log.lines.iter().filter(|line| here(felt_here(&line.event))).map(|line| line.t).collect()
}
