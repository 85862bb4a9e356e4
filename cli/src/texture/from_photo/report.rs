//! The report of `from-photo`: `report.json`, `--json` and the lines for people.

use super::Options;
use crate::output;
use crate::texture::object::SizeMm;
use asperity_pictures::from_photo::{DECIDED, PhotoSurface};
use asperity_pictures::shape_from_shading::Method;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(Debug, Serialize)]
struct LatticeReport {
    t1_px: [f64; 2],
    t2_px: [f64; 2],
    confidence: f64,
    /// Fraction of the picture's variance that repeats.
    share: f64,
    /// True where the pattern wanders off the lattice: heights are then the whole picture's.
    wanders: bool,
}

/// The pattern's cell as heights.
#[derive(Debug, Serialize)]
struct CellReport {
    t1_m: [f64; 2],
    t2_m: [f64; 2],
    relief_m: f64,
}

/// Contents of `report.json` and `--json`.
#[derive(Debug, Serialize)]
pub struct Report {
    photo: PathBuf,
    /// Texels of the maps; those of the photograph over `reduced_by`.
    width: usize,
    height: usize,
    reduced_by: usize,
    texel_m: f64,
    width_m: f64,
    height_m: f64,
    /// True where no option gave the width.
    width_is_assumed: bool,
    relief_m: f64,
    micro_relief_m: f64,
    /// Width in millimetres.
    #[serde(flatten)]
    size: SizeMm,
    /// Factor on the heights that contrast gives; may be passed again as `--calibration`.
    calibration: f64,
    method: &'static str,
    /// Which way up: `bright-is-high`, `bright-is-deep`, `light` (shading under a given light), or
    /// `undecided` (heights are as if bright were high).
    sign: &'static str,
    /// 0 nothing known, 1 given; decided from 0.5.
    sign_confidence: f64,
    /// Unit vector to the light that was used.
    light: Option<[f64; 3]>,
    /// True where that light was found in the picture.
    light_is_estimated: bool,
    unexplained: Option<f64>,
    /// Rms of what was taken for the camera's noise, of white.
    noise: f64,
    lattice: Option<LatticeReport>,
    wallpaper_group: Option<&'static str>,
    cell: Option<CellReport>,
    fractal_dimension: Option<f64>,
    /// Mean of the roughness map.
    roughness: f64,
    roughness_mean: f64,
    tileable: bool,
    warnings: Vec<String>,
    seconds: f64,
    files: Vec<String>,
}

/// Sizes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub texel_m: f64,
    pub reduced_by: usize,
    pub calibration: f64,
}

impl Report {
    pub(super) fn new(
        options: &Options,
        surface: &PhotoSurface,
        size: Size,
        seconds: f64,
        files: Vec<String>,
    ) -> Self {
        let (width, height) = (surface.displacement.width, surface.displacement.height);
        let repetition = surface.repetition.as_ref();
        let texel_mm = 1e3 * size.texel_m;
        let [width_mm, height_mm] = [width, height].map(|n| n as f64 * texel_mm);
        let size_mm = SizeMm { width_mm, height_mm, texel_mm, relief_mm: 1e3 * surface.relief_m };
        let mut warnings: Vec<String> = surface.doubts.iter().map(ToString::to_string).collect();
        warnings.extend(options.object.stl.as_ref().and(size_mm.warning()));
        if size_mm.relief_mm > 0.5 * size_mm.width_mm.max(size_mm.height_mm) {
            warnings.push(format!(
                "a relief of {:.0} mm on a picture {:.0} mm wide is no surface to touch: give --relief-m, or leave --method out",
                size_mm.relief_mm, size_mm.width_mm
            ));
        }
        Self {
            photo: options.photo.clone(),
            width,
            height,
            reduced_by: size.reduced_by,
            texel_m: size.texel_m,
            width_m: width as f64 * size.texel_m,
            height_m: height as f64 * size.texel_m,
            width_is_assumed: options.assumes_width(),
            relief_m: surface.relief_m,
            micro_relief_m: surface.micro_relief_m,
            size: size_mm,
            calibration: size.calibration,
            method: match surface.shape.method {
                Method::Integrable(_) => "integrable",
                Method::TsaiShah(_) => "tsai-shah",
                Method::DarkIsDeep => "dark-is-deep",
                Method::FlatGround => "flat-ground",
            },
            sign: sign(surface),
            sign_confidence: surface.sign.confidence,
            light: surface.shape.light.map(|light| light.direction()),
            light_is_estimated: surface.light_was_found,
            unexplained: surface.shape.unexplained,
            noise: surface.noise,
            lattice: repetition.map(|found| LatticeReport {
                t1_px: found.lattice.t1_px,
                t2_px: found.lattice.t2_px,
                confidence: found.lattice.confidence,
                share: found.share,
                wanders: found.wanders,
            }),
            wallpaper_group: repetition.map(|found| found.group.name()),
            cell: surface.cell.as_ref().map(|cell| CellReport {
                t1_m: cell.t1_m,
                t2_m: cell.t2_m,
                relief_m: cell.relief_m,
            }),
            fractal_dimension: surface.dimension,
            roughness: surface.roughness.mean(),
            roughness_mean: surface.roughness.mean(),
            tileable: surface.tileable,
            warnings,
            seconds,
            files,
        }
    }

    /// Width of the photograph, and the option for another one where it was assumed.
    pub fn width_in_words(&self) -> String {
        let millimetres = format!("{} mm wide", (1e3 * self.width_m).round());
        if self.width_is_assumed {
            format!("taken to be {millimetres} (--width-m says another width)")
        } else {
            millimetres
        }
    }

    /// Doubts.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Report for people.
    pub fn in_words(&self, options: &Options) -> String {
        let lattice = self.lattice.as_ref().map_or("nothing repeats".to_owned(), |lattice| {
            let group = self.wallpaper_group.unwrap_or("p1");
            let wanders = if lattice.wanders { ", but wanders: nothing is averaged" } else { "" };
            format!("repeats along {:.1?} and {:.1?} texels ({group}){wanders}", lattice.t1_px, lattice.t2_px)
        });
        let mut text = format!("{}; {lattice}; heights by {}", self.width_in_words(), self.method);
        if let (Some([x, y, z]), true) = (self.light, self.light_is_estimated) {
            let _ = write!(text, " under a light found at ({x:.2}, {y:.2}, {z:.2})");
        }
        let _ = write!(
            text,
            ", {} (confidence {:.2}), relief {}{}, micro-relief {}, roughness {:.2}",
            self.sign,
            self.sign_confidence,
            asperity_plot::quantity(self.relief_m, "m"),
            if options.relief_m.is_none() && self.relief_m > 0.0 {
                " by its contrast (--relief-m where it is known)"
            } else {
                ""
            },
            asperity_plot::quantity(self.micro_relief_m, "m"),
            self.roughness,
        );
        text.push_str(
            "; overview.png: above the photograph, its pattern and what differs from it, below the heights, the heights lit \
             from above left and the roughness",
        );
        if self.reduced_by > 1 {
            let _ =
                write!(text, "\nreduced by {} to {} × {} texels", self.reduced_by, self.width, self.height);
        }
        let _ = write!(
            text,
            "{}\nwrote {} files to {}\nnext: asperity render {} -o {}",
            output::warned(&self.warnings),
            self.files.len(),
            options.output.display(),
            output::quoted(&options.output.join("scene.toml")),
            output::quoted(&options.output.join("stroke")),
        );
        text
    }
}

fn sign(surface: &PhotoSurface) -> &'static str {
    match surface.sign {
        sign if sign.confidence < DECIDED => "undecided",
        sign if sign.bright_is_deep => "bright-is-deep",
        _ if surface.shape.method == Method::DarkIsDeep => "bright-is-high",
        _ => "light",
    }
}
