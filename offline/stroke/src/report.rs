//! Report of a surface from strokes: what `surface.json` holds and Python gets.

use crate::colour::Colour;
use crate::lines::Line;
use crate::relief::{self, Band, Group, wavenumber};
use crate::surface::StrokeSurface;
use serde::Serialize;

/// Every estimate with its standard error.
#[derive(Debug, Clone, Serialize)]
pub struct Report<'a> {
    /// Octaves of the felt height that the recording holds.
    pub octaves: Vec<Octave>,
    /// Third octaves of the felt spectrum.
    pub bands: Vec<ThirdOctave>,
    /// Exponent of the ground's spectrum, S ∝ q^−α.
    pub alpha: f64,
    /// Its standard error.
    pub alpha_se: f64,
    /// Wavelength above which the spectrum is flat, m; missing where none was seen.
    pub outer_scale_m: Option<f64>,
    /// Lines, the strongest first.
    pub lines: &'a [Line],
    /// Deviation of the speed that the lines show, a share.
    pub speed_wander: f64,
    /// Coefficient of friction, where something showed it.
    pub friction: Option<f64>,
    /// Sinking of the ground, m/N, where a displacement under a changing force showed it.
    pub compliance_m_n: Option<f64>,
    /// Its standard error, m/N.
    pub compliance_se_m_n: Option<f64>,
    /// Level beside the contact law for each doubling of force, dB; missing where forces do not
    /// differ.
    pub force_db_per_octave: Option<f64>,
    /// Share of the variance of the recorded third octaves that the surface as it plays explains.
    pub explained: f64,
    /// Rms of what it leaves, dB.
    pub beside_db: f64,
    /// Contact's changing force over its mean.
    pub contact_force_rms: f64,
    /// Response of the rig.
    pub colour: &'a [Colour],
    /// Speeds, forces and times of the recording.
    pub recorded: &'a [Group],
    /// Roughness of a scene's surface.
    pub roughness: f64,
    /// Its micro-relief, m.
    pub micro_relief_m: f64,
    /// Gains of its octaves, coarsest first, dB.
    pub micro_relief_octaves_db: Vec<f64>,
    /// Remarks on the recording.
    pub warnings: &'a [String],
}

/// Octave of the felt height.
#[derive(Debug, Clone, Serialize)]
pub struct Octave {
    /// Wavelength about which it lies, m.
    pub wavelength_m: f64,
    /// Rms, m.
    pub rms_m: f64,
    /// Standard error of sampling and of the probe's constants, dB.
    pub rms_se_db: f64,
    /// Standard error of sampling alone, dB.
    pub sampling_se_db: f64,
}

/// Third octave of the felt spectrum.
#[derive(Debug, Clone, Serialize)]
pub struct ThirdOctave {
    /// Wavenumber of its centre, 1/m.
    pub wavenumber_per_m: f64,
    /// Density of the felt height, dB re 1 m³.
    pub level_db: f64,
    /// Standard error of sampling, dB.
    pub se_db: f64,
}

impl<'a> Report<'a> {
    /// Report of a surface.
    #[must_use]
    pub fn of(found: &'a StrokeSurface) -> Self {
        let octaves = found.octaves.iter().zip(&found.probe_se_db);
        let octave = |(octave, probe_se_db): (&relief::Octave, &f64)| Octave {
            wavelength_m: octave.wavelength_m,
            rms_m: octave.rms_m,
            rms_se_db: octave.se_db.hypot(*probe_se_db),
            sampling_se_db: octave.se_db,
        };
        let band = |band: &Band| ThirdOctave {
            wavenumber_per_m: wavenumber(band.band),
            level_db: band.level_db,
            se_db: band.se_db,
        };
        Self {
            octaves: octaves.filter(|(octave, _)| !octave.is_extrapolated).map(octave).collect(),
            bands: found.bands.iter().map(band).collect(),
            alpha: found.law.alpha,
            alpha_se: found.law.alpha_se,
            outer_scale_m: Some(found.law.outer_scale_m).filter(|scale| scale.is_finite()),
            lines: &found.lines,
            speed_wander: found.wander,
            friction: found.friction,
            compliance_m_n: found.compliance.map(|compliance| compliance.m_n),
            compliance_se_m_n: found.compliance.map(|compliance| compliance.se_m_n),
            force_db_per_octave: found.force_db_per_octave,
            explained: found.explained,
            beside_db: found.beside_db,
            contact_force_rms: found.lift,
            colour: &found.colour,
            recorded: &found.groups,
            roughness: found.relief.roughness,
            micro_relief_m: found.relief.micro_relief_m,
            micro_relief_octaves_db: found.relief.octaves_db.map(|db| (100.0 * db).round() / 100.0).to_vec(),
            warnings: &found.warnings,
        }
    }
}
