//! Report of a surface from strokes: `surface.json`, and in words.

use asperity_plot::quantity;
use asperity_stroke::StrokeSurface;
use asperity_stroke::relief::wavenumber;
use serde::Serialize;
use std::path::Path;

/// Figures of the surface.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Report {
    octaves: Vec<Octave>,
    /// Third octaves of the felt spectrum.
    bands: Vec<Band>,
    alpha: f64,
    alpha_se: f64,
    /// Missing where no outer scale was seen.
    outer_scale_m: Option<f64>,
    lines: Vec<Line>,
    speed_wander: f64,
    friction: Option<f64>,
    /// Level beside the contact law for each doubling of force; missing where forces do not differ.
    force_db_per_octave: Option<f64>,
    explained: f64,
    beside_db: f64,
    contact_force_rms: f64,
    colour: Vec<Colour>,
    recorded: Vec<Recorded>,
    roughness: f64,
    micro_relief_m: f64,
    micro_relief_octaves_db: Vec<f64>,
    warnings: Vec<String>,
    files: Vec<String>,
}

#[derive(Debug, Clone, Serialize)]
struct Octave {
    wavelength_m: f64,
    rms_m: f64,
    /// Sampling and the probe's constants.
    rms_se_db: f64,
    sampling_se_db: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Band {
    wavenumber_per_m: f64,
    /// Density of the felt height, dB re 1 m³.
    level_db: f64,
    se_db: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Line {
    period_m: f64,
    amplitude_m: f64,
    period_se_m: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Colour {
    frequency_hz: f64,
    gain_db: f64,
    se_db: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Recorded {
    speed_m_s: f64,
    force_n: f64,
    seconds: f64,
}

impl Report {
    pub(super) fn new(found: &StrokeSurface, files: Vec<String>) -> Self {
        let octaves =
            found.octaves.iter().zip(&found.probe_se_db).filter(|(octave, _)| !octave.is_extrapolated);
        Self {
            octaves: octaves
                .map(|(octave, probe_se_db)| Octave {
                    wavelength_m: octave.wavelength_m,
                    rms_m: octave.rms_m,
                    rms_se_db: octave.se_db.hypot(*probe_se_db),
                    sampling_se_db: octave.se_db,
                })
                .collect(),
            bands: found
                .bands
                .iter()
                .map(|band| Band {
                    wavenumber_per_m: wavenumber(band.band),
                    level_db: band.level_db,
                    se_db: band.se_db,
                })
                .collect(),
            alpha: found.law.alpha,
            alpha_se: found.law.alpha_se,
            outer_scale_m: Some(found.law.outer_scale_m).filter(|scale| scale.is_finite()),
            lines: found
                .lines
                .iter()
                .map(|line| Line {
                    period_m: line.period_m,
                    amplitude_m: line.amplitude_m,
                    period_se_m: line.period_se_m,
                })
                .collect(),
            speed_wander: found.wander,
            friction: found.friction,
            force_db_per_octave: found.force_db_per_octave,
            explained: found.explained,
            beside_db: found.beside_db,
            contact_force_rms: found.lift,
            colour: found
                .colour
                .iter()
                .map(|c| Colour { frequency_hz: c.frequency_hz, gain_db: c.gain_db, se_db: c.se_db })
                .collect(),
            recorded: found
                .groups
                .iter()
                .map(|g| Recorded { speed_m_s: g.speed_m_s, force_n: g.force_n, seconds: g.seconds })
                .collect(),
            roughness: found.relief.roughness,
            micro_relief_m: found.relief.micro_relief_m,
            micro_relief_octaves_db: found.relief.octaves_db.map(|db| (100.0 * db).round() / 100.0).to_vec(),
            warnings: found.warnings.clone(),
            files,
        }
    }

    pub(super) fn in_words(&self, folder: &Path) -> String {
        let mut text = format!(
            "{} octaves, α {:.2} ± {:.2}; explains {:.0} % of the recorded levels, {:.1} dB beside them",
            self.octaves.len(),
            self.alpha,
            self.alpha_se,
            100.0 * self.explained,
            self.beside_db
        );
        for octave in &self.octaves {
            text.push_str(&format!(
                "\n  about {}: {} ± {:.1} dB",
                quantity(octave.wavelength_m, "m"),
                quantity(octave.rms_m, "m"),
                octave.rms_se_db
            ));
        }
        for line in &self.lines {
            text.push_str(&format!(
                "\n  line of {}, amplitude {}",
                quantity(line.period_m, "m"),
                quantity(line.amplitude_m, "m")
            ));
        }
        if let Some(friction) = self.friction {
            text.push_str(&format!("\n  friction {friction:.2}"));
        }
        for warning in &self.warnings {
            text.push_str(&format!("\nwarning: {warning}"));
        }
        text.push_str(&format!(
            "\nwrote {}; hear and feel it: asperity render {} -o stroke",
            self.files.join(", "),
            folder.join("scene.toml").display()
        ));
        text
    }
}
