//! The picture of a finished render: units, labels, surfaces from above.

use super::Report;
use super::picture::{self, ContactCurve, Ground, HapticChannel, Take};
use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::files::scene_file::{RoughnessEntry, SceneFile, Source, SurfaceEntry};
use asperity::load;
use asperity::offline::Render;
use asperity::{Quantity, SurfaceId, Wrap};
use asperity_surface::image_io::load_channel;
use asperity_surface::raster::Raster;
use std::path::Path;

/// Draws the picture of `STEM.svg`.
pub fn draw(
    file: &SceneFile,
    log: &ContactLog,
    render: &Render,
    curves: &[ContactCurve],
    report: &Report,
    names: &[(String, SurfaceId)],
) -> String {
    let has_skin = file.probe.ridge_m > 0.0;
    let exponents = report.felt_force_exponent.iter().map(|exponent| if has_skin { *exponent } else { 0.0 });
    let haptic = file.actuators.iter().zip(&render.haptic).zip(exponents).map(
        |((actuator, samples), felt_force_exponent)| {
            let (quantity, unit) = match actuator.settings.output {
                Quantity::Displacement => ("displacement", "m"),
                Quantity::Acceleration => ("acceleration", "m/s²"),
                Quantity::Tangential => ("tangential displacement", "m"),
                Quantity::Force => ("contact force", "N"),
            };
            let full_scale = actuator.full_scale.unwrap_or(1.0);
            HapticChannel { quantity, unit, full_scale, felt_force_exponent, samples }
        },
    );
    let impacts_s = log
        .lines
        .iter()
        .filter(|line| matches!(line.event, LogEvent::Impact { .. }))
        .map(|line| line.t)
        .collect();
    let surfaces: Vec<&str> = file.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    picture::draw(&Take {
        title: title(&file.path),
        summary: vec![format!(
            "{} at {} Hz · {} · {}, {}, {} · audio peak {}",
            asperity_plot::quantity(report.duration_s, "s"),
            report.sample_rate_hz,
            if surfaces.is_empty() { "no surface".to_owned() } else { surfaces.join(", ") },
            asperity_plot::counted(report.events, "event"),
            asperity_plot::counted(report.micro_collisions, "micro-collision"),
            asperity_plot::counted(report.impacts, "impact"),
            asperity_plot::quantity(20.0 * f64::from(report.audio_peak).max(1e-10).log10(), "dB"),
        )],
        sample_rate_hz: render.sample_rate_hz,
        audio: &render.mix(),
        haptic: haptic.collect(),
        contacts: curves,
        impacts_s,
        grounds: grounds(file, render, names),
    })
}

/// Texels a side of a surface in the picture.
const GROUND_PX: usize = 192;

/// The surfaces as they are seen from above: what has a relief as it is at first, sand as it lies
/// afterwards, and what is flat by its map of roughness.
fn grounds(file: &SceneFile, render: &Render, names: &[(String, SurfaceId)]) -> Vec<Ground> {
    file.surfaces
        .iter()
        .filter_map(|surface| {
            let id = names.iter().find(|(name, _)| *name == surface.name)?.1;
            let sand = render.sand.iter().find(|sand| sand.surface == id);
            let (title, heights) = match (&surface.source, sand) {
                (_, Some(sand)) => ("the sand afterwards", sand.picture.raster.clone()),
                (Source::Map { image, invert, .. }, _) => {
                    let raster = load_channel(&image.path, image.channel).ok()?.raster;
                    let upright = if *invert { raster.map(|height| 1.0 - height) } else { raster };
                    ("from above", upright)
                }
                (Source::Flat, _) => ("from above", Raster::constant(1, 1, 0.0)),
                _ => ("from above", load::relief(surface, file.seed, GROUND_PX)?),
            };
            let (low, high) = heights.range();
            let (title, heights) = if low < high {
                (title, heights)
            } else {
                ("its roughness: light is matte", roughness(surface)?)
            };
            // Sand ends at its edges.
            let wrap = if sand.is_some() { Wrap::Clamp } else { surface.wrap };
            Some(Ground {
                wrap,
                title: title.to_owned(),
                extent_m: [surface.width_m, surface.height_m],
                heights: thumbnail(&heights),
                surface: format!(" on {}", surface.name),
            })
        })
        .collect()
}

/// A surface's map of R, where it has one that varies.
fn roughness(surface: &SurfaceEntry) -> Option<Raster> {
    let RoughnessEntry::Map { image, gloss } = &surface.roughness else { return None };
    let raster = load_channel(&image.path, image.channel).ok()?.raster;
    let (low, high) = raster.range();
    let raster = if *gloss { raster.map(|gloss| 1.0 - gloss) } else { raster };
    (low < high).then_some(raster)
}

/// A small copy whose heights fill 0–1.
fn thumbnail(heights: &Raster) -> Raster {
    let (width, height) = (heights.width.min(GROUND_PX), heights.height.min(GROUND_PX));
    let (low, high) = heights.range();
    let span = if high > low { high - low } else { 1.0 };
    Raster::from_fn(width, height, |x, y| {
        let (x, y) = (x * heights.width / width, y * heights.height / height);
        (heights.at(x, y) - low) / span
    })
}

fn title(path: &Path) -> String {
    path.file_stem().map_or_else(|| "render".to_owned(), |stem| stem.to_string_lossy().into_owned())
}
