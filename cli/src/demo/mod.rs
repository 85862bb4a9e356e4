//! `asperity demo`: the main job in one command, with nothing to download and nothing to install.
//!
//! Writes the shipped scenes into a folder, fits the shipped recording, renders every scene through the
//! very path of `asperity render --plot`, and writes an index that says what each file is.

mod demo_scene;
mod gallery;
mod index;
mod plates;
mod scenes;
mod strokes;

use crate::error::CliError;
use crate::fit;
use crate::output::{self, Outputs, ensure_folder};
use crate::progress::Progress;
use crate::render;
use clap::Args;
use demo_scene::DemoScene;
use std::path::{Path, PathBuf};

/// Modes kept of the shipped recording: enough for a tile, found in a few seconds.
const FIT_MODES: usize = 32;

/// The recording that the demo fits: synthetic, a tile in a room with noise.
const TILE_STRIKE: &[u8] = include_bytes!("../../assets/tile_strike.wav");

/// Fit a shipped recording, render the shipped scenes, and say what to listen to
#[derive(Debug, Args)]
pub struct Options {
    /// Folder to fill
    #[arg(short, long = "output", value_name = "DIR", default_value = "demo-out")]
    pub output: PathBuf,
}

/// Runs the verb.
///
/// # Errors
/// When the folder cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let folder = &options.output;
    ensure_folder(folder)?;
    let scenes = scenes::scenes();
    write_inputs(folder, &scenes)?;
    let mut progress = Progress::new("rendering", 1 + scenes.len() as u64);
    let fitted = fit::fit(&fit::Options {
        plot: Some(folder.join("tile.fit.svg")),
        resynthesis: Some(folder.join("tile.resynthesis.wav")),
        max_modes: FIT_MODES,
        ..fit::Options::plain(folder.join("tile_strike.wav"), folder.join("tile.modes.json"))
    })?;
    progress.advance(1);
    let mut reports = Vec::new();
    for scene in &scenes {
        let report = render::render(&render::Options {
            scene: folder.join(format!("{}.toml", scene.name)),
            output: folder.join(scene.name),
            rate: None,
            block: 256,
            seed: None,
            integrator: None,
            path: None,
            trace: false,
            force: false,
            plot: true,
            json: false,
        })?;
        reports.push(report);
        progress.advance(1);
    }
    drop(progress);
    let mut outputs = Outputs::new();
    outputs.write(&folder.join("index.html"), index::html(&scenes, &reports, &fitted).as_bytes())?;
    outputs.write(&folder.join("README.txt"), index::text(&scenes, &reports, &fitted).as_bytes())?;
    outputs.commit()?;
    output::say(&index::summary(folder, &scenes, &reports, &fitted));
    Ok(())
}

/// Scenes, logs, maps and modes.
fn write_inputs(folder: &Path, scenes: &[DemoScene]) -> Result<(), CliError> {
    let mut outputs = Outputs::new();
    let mut write = |name: &str, bytes: &[u8]| outputs.write(&folder.join(name), bytes);
    write("plate.modes.json", scenes::plate_modes().to_json().as_bytes())?;
    write("bar.modes.json", scenes::bar_modes().to_json().as_bytes())?;
    write("tile_strike.wav", TILE_STRIKE)?;
    for scene in scenes {
        let mut log = Vec::new();
        scene.log.write(&mut log).map_err(|error| CliError::write(&folder.join(scene.name), &error))?;
        write(&format!("{}.toml", scene.name), scene.toml.as_bytes())?;
        write(&format!("{}.jsonl", scene.name), &log)?;
        for (name, bytes) in &scene.assets {
            write(name, bytes)?;
        }
    }
    outputs.commit()?;
    Ok(())
}
