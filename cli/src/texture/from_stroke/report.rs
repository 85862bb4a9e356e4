//! Report of a surface from strokes: `surface.json`, and in words.

use crate::output;
use asperity_plot::quantity;
use asperity_stroke::report::Report;
use serde::Serialize;
use std::path::Path;

/// Figures of the surface, and the files beside them.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Written<'a> {
    #[serde(flatten)]
    pub(super) report: Report<'a>,
    pub(super) files: Vec<String>,
}

impl Written<'_> {
    pub(super) fn in_words(&self, folder: &Path) -> String {
        let report = &self.report;
        let mut text = format!(
            "{} octaves, α {:.2} ± {:.2} of the ground (a tip that rides it feels a steeper one); explains {:.0} % of the recorded levels, {:.1} dB beside them",
            report.octaves.len(),
            report.alpha,
            report.alpha_se,
            100.0 * report.explained,
            report.beside_db
        );
        for octave in &report.octaves {
            text.push_str(&format!(
                "\n  about {}: {} ± {:.1} dB",
                quantity(octave.wavelength_m, "m"),
                quantity(octave.rms_m, "m"),
                octave.rms_se_db
            ));
        }
        for line in report.lines {
            text.push_str(&format!(
                "\n  line of {}, amplitude {}",
                quantity(line.period_m, "m"),
                quantity(line.amplitude_m, "m")
            ));
        }
        if let Some(friction) = report.friction {
            text.push_str(&format!("\n  friction {friction:.2}"));
        }
        if let (Some(m_n), Some(se_m_n)) = (report.compliance_m_n, report.compliance_se_m_n) {
            text.push_str(&format!("\n  sinks {:.1} ± {:.1} µm/N", 1e6 * m_n, 1e6 * se_m_n));
        }
        text.push_str(&format!(
            "{}\nwrote {}; hear and feel it: asperity render {} -o stroke",
            output::warned(report.warnings),
            self.files.join(", "),
            output::quoted(&folder.join("scene.toml"))
        ));
        text
    }
}
