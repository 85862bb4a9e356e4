//! `asperity stroke WHAT -o DIR`: what a surface sounds and feels like under a finger or a tool,
//! without a scene and without a log.
//!
//! | file | content |
//! |---|---|
//! | [`ground`] | what is stroked: a map, a photograph, a folder of `from-photo`, a scene |
//! | [`hand`] | how the hand moves, as a contact log |

mod ground;
mod hand;

use crate::arguments::positive;
use crate::error::CliError;
use crate::sounds::{self, Folder, Loop, MOST_TAIL_S, Sound, short, take_suffix};
use asperity::files::contact_log::ContactLog;
use clap::Args;
use ground::Ground;
use hand::{Hand, Path as Way};
use std::path::PathBuf;

/// A loop begins this long after the landing, when the finger's arrival has died away, s.
const SETTLED_S: f64 = 1.0;
/// Stroke where no option says another.
const SPEED_M_S: f64 = 0.1;
const FORCE_N: f64 = 0.6;
const SECONDS: f64 = 2.0;

/// Stroke a surface and write what it sounds and feels like, with the scene and the log of each
/// sound beside it
#[derive(Debug, Clone, Args)]
pub struct Options {
    /// A height map, a photograph, a folder of `asperity texture from-photo`, or a scene. A JPEG or
    /// a picture in colours is a photograph, a grey picture of another format a height map; a grey
    /// photograph goes through `asperity texture from-photo` first
    #[arg(value_name = "MAP|PHOTO|DIR|SCENE.toml")]
    pub what: PathBuf,
    /// Probe: fingertip, fingernail, stylus, …, or a probe of the scene [default: the scene's]
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',')]
    pub probe: Vec<String>,
    /// Speed, m/s [default: 0.1]
    #[arg(long, value_name = "M_S", num_args = 1.., value_delimiter = ',', value_parser = positive)]
    pub speed: Vec<f64>,
    /// Pressing force, N [default: 0.6]
    #[arg(long, value_name = "N", num_args = 1.., value_delimiter = ',', value_parser = positive)]
    pub force: Vec<f64>,
    /// Motion of the hand: line, circle, zigzag, or a contact log, which is rendered at the scene's
    /// own levels
    #[arg(long, value_name = "line|circle|zigzag|LOG.jsonl", default_value = "line")]
    pub path: Way,
    /// Length of the stroke, and of a loop, s [default: 2]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Cut each sound so that it follows itself without a seam
    #[arg(long = "loop")]
    pub seamless: bool,
    /// Which surface of a scene [default: its first]
    #[arg(long, value_name = "NAME")]
    pub surface: Option<String>,
    /// Width of a map or a photograph, m [default: 40 mm a 256 texels]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub width_m: Option<f64>,
    /// Height of white over black, m [default: 1 mm for a map, what contrast gives for a
    /// photograph]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub relief_m: Option<f64>,
    /// Material of the body under a map or a photograph: a plate, a sheet of cloth, a cushion of
    /// foam [default: wood under a map]
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Folder, format, takes
    #[command(flatten)]
    pub sounds: sounds::Options,
}

/// Runs the verb.
///
/// # Errors
/// When the surface is none, an option does not fit it, or a file cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let beside_a_log = [
        ("--loop", options.seamless),
        ("--speed", !options.speed.is_empty()),
        ("--force", !options.force.is_empty()),
        ("--seconds", options.seconds.is_some()),
    ];
    if let (Way::Log(_), Some((option, _))) = (&options.path, beside_a_log.iter().find(|(_, given)| *given)) {
        let right = format!("leave out {option}, or write --path line, circle or zigzag");
        return Err(CliError::new(option, "stands beside a contact log", right));
    }
    let folder = Folder::open(&options.sounds.output)?;
    let (ground, mut remarks) = Ground::of(options, &folder)?;
    let sounds = sounds_of(options, &ground, &mut remarks.assumed)?;
    let mut inputs = ground.inputs.clone();
    if let Way::Log(path) = &options.path {
        inputs.push(path.clone());
    }
    sounds::make(&sounds, &options.sounds, &folder, &inputs, remarks)
}

fn sounds_of(options: &Options, ground: &Ground, assumed: &mut Vec<String>) -> Result<Vec<Sound>, CliError> {
    if let Way::Log(path) = &options.path {
        let log = ContactLog::load(path).map_err(CliError::from_error)?;
        let name = format!("{}-{}", ground.name, sounds::stem(path));
        let sound = |probe: Option<&String>| -> Result<Sound, CliError> {
            let (scene, _) = ground.with_probe(probe.map(String::as_str))?;
            let name = probe.map_or(name.clone(), |probe| format!("{name}-{probe}"));
            let tail_s = ground.tail_s;
            Ok(Sound { name, scene, log: log.clone(), tail_s, is_felt: true, cut: None })
        };
        return match options.probe.as_slice() {
            [] => Ok(vec![sound(None)?]),
            probes => probes.iter().map(|probe| sound(Some(probe))).collect(),
        };
    }
    let probes: Vec<Option<&str>> = match options.probe.as_slice() {
        [] => vec![None],
        probes => probes.iter().map(|probe| Some(probe.as_str())).collect(),
    };
    let or = |given: &[f64], usual: f64| if given.is_empty() { vec![usual] } else { given.to_vec() };
    let (speeds_m_s, forces_n) = (or(&options.speed, SPEED_M_S), or(&options.force, FORCE_N));
    let (takes, seconds) = (options.sounds.takes, options.seconds.unwrap_or(SECONDS));
    let mut sounds = Vec::new();
    for probe in probes {
        let (scene, named) = ground.with_probe(probe)?;
        for speed_m_s in &speeds_m_s {
            for force_n in &forces_n {
                for take in 1..=takes {
                    let hand = Hand {
                        path: options.path.clone(),
                        speed_m_s: *speed_m_s,
                        force_n: *force_n,
                        seconds,
                        settled_s: options.seamless.then_some(SETTLED_S),
                        extent_m: ground.extent_m,
                        runs_on: ground.runs_on,
                        surface: ground.surface.clone(),
                        probe: named.clone(),
                        seed: options.sounds.seed.wrapping_mul(1000).wrapping_add(u64::from(take)),
                        is_first: take == 1,
                    };
                    if let Some(remark) = hand.repetition().filter(|_| options.seamless && take == 1) {
                        assumed.push(remark);
                    }
                    let name = format!(
                        "{}-{}-{}m_s-{}N-{}{}{}",
                        ground.name,
                        probe.unwrap_or(&ground.probe),
                        short(*speed_m_s),
                        short(*force_n),
                        options.path,
                        if options.seamless { "-loop" } else { "" },
                        take_suffix(take, takes)
                    );
                    let cut = options.seamless.then_some(Loop { from_s: SETTLED_S, seconds });
                    let (scene, log) = (scene.clone(), hand.log());
                    let tail_s = if options.seamless { 0.0 } else { MOST_TAIL_S.min(ground.tail_s) };
                    sounds.push(Sound { name, scene, log, tail_s, is_felt: true, cut });
                }
            }
        }
    }
    Ok(sounds)
}
