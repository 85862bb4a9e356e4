//! `asperity demo`: the main job in one command, with nothing to download and nothing to install.
//!
//! Writes the shipped scenes into a folder, fits the shipped recording, solves the shipped mesh,
//! gives every scene the gain that makes it as loud as the others ([`loudness`]), renders it
//! through the very path of `asperity render --plot`, and writes an index that says what each file
//! is.

mod answering;
mod bowl;
mod demo_scene;
mod gallery;
mod index;
mod knuckle;
mod loudness;
pub mod plates;
pub mod scenes;
pub mod strokes;
mod touchers;

use crate::arguments::plain;
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

/// The body fitted to that recording.
const TILE_MODES: &str = "tile.modes.json";
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
    // The fit takes longest; what does not need its body is done beside it.
    let (with_bodies, others): (Vec<usize>, Vec<usize>) = (0..scenes.len())
        .partition(|&index| [TILE_MODES, bowl::MODES].iter().any(|name| scenes[index].toml.contains(name)));
    let mut reports: Vec<Option<render::Report>> = scenes.iter().map(|_| None).collect();
    let mut render_all = |indices: &[usize]| -> Result<(), CliError> {
        for &index in indices {
            reports[index] = Some(render_scene(folder, scenes[index].name)?);
            progress.advance(1);
        }
        Ok(())
    };
    let (fitted, solved) = std::thread::scope(|scope| {
        let fitting = scope.spawn(|| fit_tile(folder));
        let solved = bowl::solve(folder);
        let rendered = render_all(&others);
        let fitted = fitting.join().unwrap_or_else(|payload| std::panic::resume_unwind(payload));
        rendered.and(fitted).and_then(|fitted| Ok((fitted, solved?)))
    })?;
    render_all(&with_bodies)?;
    let reports: Vec<render::Report> = reports.into_iter().flatten().collect();
    progress.advance(1);
    drop(progress);
    let bodies = index::Bodies { fitted, solved };
    let mut outputs = Outputs::new();
    outputs.write(&folder.join("index.html"), index::html(&scenes, &reports, &bodies).as_bytes())?;
    outputs.write(&folder.join("README.txt"), index::text(&scenes, &reports, &bodies).as_bytes())?;
    outputs.commit()?;
    output::say(&index::summary(folder, &scenes, &reports, &bodies));
    Ok(())
}

fn fit_tile(folder: &Path) -> Result<fit::Report, CliError> {
    fit::fit(&fit::Options {
        plot: Some(folder.join("tile.fit.svg")),
        resynthesis: Some(folder.join("tile.resynthesis.wav")),
        max_modes: FIT_MODES,
        ..plain(&folder.join("tile_strike.wav"), &folder.join(TILE_MODES))?
    })
}

fn render_scene(folder: &Path, name: &str) -> Result<render::Report, CliError> {
    loudness::level(&folder.join(format!("{name}.toml")))?;
    let (scene, stem) = (folder.join(format!("{name}.toml")), folder.join(name));
    render::render(&render::Options { plot: true, ..plain(&scene, &stem)? })
}

/// Scenes, logs, maps and modes.
fn write_inputs(folder: &Path, scenes: &[DemoScene]) -> Result<(), CliError> {
    let mut outputs = Outputs::new();
    let mut write = |name: &str, bytes: &[u8]| outputs.write(&folder.join(name), bytes);
    write("plate.modes.json", scenes::plate_modes().to_json().as_bytes())?;
    write("bar.modes.json", scenes::bar_modes().to_json().as_bytes())?;
    write("tile_strike.wav", TILE_STRIKE)?;
    for scene in scenes {
        write(&format!("{}.toml", scene.name), scene.toml.as_bytes())?;
        write(&format!("{}.jsonl", scene.name), scene.log.to_jsonl().as_bytes())?;
        for (name, bytes) in &scene.assets {
            write(name, bytes)?;
        }
    }
    outputs.commit()?;
    Ok(())
}
