//! Loudness of the demo's scenes: all the same, so that the first click is no louder than the next.

use crate::error::CliError;
use crate::output::{self, Outputs};
use crate::render;
use crate::scene_log::load_log;
use crate::sounds::integrated_lufs;
use asperity::files::scene_file::SceneFile;
use std::path::Path;

/// Integrated loudness of every scene, LUFS. Source: EBU R 128; every scene peaks below full scale
/// with it.
const LUFS: f64 = -23.0;

/// Writes the gain into a scene file with which it has that loudness.
///
/// # Errors
/// When the scene cannot be rendered or written.
pub fn level(path: &Path) -> Result<(), CliError> {
    let text = std::fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
    let file = SceneFile::load(path)?;
    let (log, _) = load_log(&file)?;
    let (render, _) = render::in_memory(file, &log)?;
    let audio: Vec<&[f32]> = render.audio.iter().map(Vec::as_slice).collect();
    let Some(lufs) = integrated_lufs(&audio, render.sample_rate_hz) else { return Ok(()) };
    // Every file that was read here is the demo's own.
    output::clear_reads();
    let mut outputs = Outputs::new();
    outputs.write(path, louder(&text, LUFS - lufs).as_bytes())?;
    outputs.commit().map(drop)
}

/// A scene's text with every `gain` under `[audio]` so many decibels louder, to three digits.
fn louder(text: &str, by_db: f64) -> String {
    let (before, audio) = text.split_at(text.find("[audio]").unwrap_or(text.len()));
    let line =
        |line: &str| match line.strip_prefix("gain = ").and_then(|gain| gain.trim().parse::<f64>().ok()) {
            Some(gain) => format!("gain = {}\n", three_digits(gain * 10f64.powf(by_db / 20.0))),
            None => line.to_owned(),
        };
    before.to_owned() + &audio.split_inclusive('\n').map(line).collect::<String>()
}

fn three_digits(value: f64) -> f64 {
    let unit = 10f64.powf(value.abs().max(1e-9).log10().floor() - 2.0);
    // As decimals write it, without the last bits of a product.
    format!("{:.9}", (value / unit).round() * unit).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_gain_of_the_sound_is_changed() {
        let text = "[[body]]\nstrike_gain = 0.5\n\n[[actuator]]\nfull_scale = 0.001\n\n[audio]\ngain = 5.0\nlimit = true\n";
        assert_eq!(louder(text, -20.0), text.replace("gain = 5.0", "gain = 0.5"));
        assert_eq!(louder("[audio]\ngain = 2.0\n", 3.0), "[audio]\ngain = 2.83\n");
        assert_eq!(louder("tail_s = 1.0\n", 3.0), "tail_s = 1.0\n");
    }

    #[test]
    fn every_scene_says_its_gain_so_that_it_can_be_levelled() {
        for scene in super::super::scenes::scenes() {
            assert_ne!(louder(&scene.toml, 6.0), scene.toml, "{}", scene.name);
        }
    }
}
