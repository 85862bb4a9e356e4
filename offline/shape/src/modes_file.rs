//! The modes file of a solved body: format version 2, with shapes.

use crate::SolvedBody;
use crate::ringing::{Ringing, ringing};
use crate::surface_field::SurfaceField;
use asperity::files::FileError;
use asperity::{ModeShapes, ShapeUnit, shapes_to_file};
use asperity_dsp::damping::Damping;
use asperity_dsp::radiation::{EquivalentSphere, Surface};
use serde::Serialize;
use std::path::Path;

/// Contents of the file.
#[derive(Debug, Serialize)]
pub struct ModesFile {
    format: &'static str,
    version: u32,
    source: String,
    impulse_n_s: f64,
    unit: ShapeUnit,
    damping: FileDamping,
    /// The modes as the default place excites them.
    pub modes: Vec<FileMode>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shapes: Option<ModeShapes>,
    /// Name of the file that holds the shapes instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    shapes_beside: Option<String>,
}

#[derive(Debug, Serialize)]
struct FileDamping {
    alpha_per_s: f64,
    eta: f64,
    beta_s: f64,
}

/// One mode.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct FileMode {
    /// Damped frequency, Hz.
    pub frequency_hz: f64,
    /// Decay rate, 1/s.
    pub decay_per_s: f64,
    /// Amplitude under a strike of 1 N·s.
    pub amplitude: f64,
    /// Phase, rad.
    pub phase_rad: f64,
}

impl FileMode {
    fn of(&Ringing { frequency_hz, decay_per_s, amplitude, phase_rad, .. }: &Ringing) -> Self {
        Self { frequency_hz, decay_per_s, amplitude, phase_rad }
    }
}

/// Six digits: shapes are good to three.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

impl ModesFile {
    /// A body with its damping, and with `radiation` in pascals at 1 m; modes that do not swing any
    /// more are left out and reported.
    ///
    /// # Errors
    /// When no mode is left that rings.
    pub fn new(
        body: &mut SolvedBody,
        damping: &Damping,
        radiation: bool,
        source: &Path,
    ) -> Result<Self, FileError> {
        let struck_point = body.field.lively_point().unwrap_or(0);
        let ringing = {
            let field = body.field.clone();
            let air = radiation.then(|| Air::around(&field)).flatten();
            ringing(body, damping, struck_point, |mode, hz| match &air {
                Some(air) => air.gain_and_loss(&field, mode, hz),
                None => (field.gains[mode], 0.0),
            })
        };
        let modes: Vec<FileMode> = ringing.iter().map(FileMode::of).collect();
        if modes.is_empty() {
            let right = "ask for higher modes, or give a stiffer or less damped material";
            return Err(FileError::file(source, "has no mode there that rings", right));
        }
        let field = &body.field;
        let shapes = ModeShapes {
            points_m: field
                .points
                .iter()
                .map(|p| p.map(|x| f64::from(x as f32)))
                .map(|p| p.map(rounded))
                .collect(),
            triangles: field.triangles.clone(),
            gains: ringing.iter().map(|one| one.gain).collect(),
            phi_per_sqrt_kg: ringing
                .iter()
                .map(|one| field.shapes[one.mode].iter().map(|s| s.map(|x| rounded(x) as f32)).collect())
                .collect(),
            struck_point,
        };
        let Damping { alpha_per_s, eta, beta_s } = *damping;
        Ok(Self {
            format: asperity::files::modes_file::FORMAT,
            version: 2,
            source: source.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default(),
            impulse_n_s: 1.0,
            unit: if radiation { ShapeUnit::PascalsAtOneMetre } else { ShapeUnit::Relative },
            damping: FileDamping { alpha_per_s, eta, beta_s },
            modes,
            shapes: Some(shapes),
            shapes_beside: None,
        })
    }

    /// Moves the shapes into a file of that name; its bytes.
    #[must_use = "the file names what was never written"]
    pub fn put_shapes_beside(&mut self, name: String) -> Option<Vec<u8>> {
        let bytes = shapes_to_file(&self.shapes.take()?, &name);
        self.shapes_beside = Some(name);
        Some(bytes)
    }
}

/// The air about a body.
struct Air<'a> {
    surface: Surface<'a>,
    sphere: EquivalentSphere,
}

impl<'a> Air<'a> {
    fn around(field: &'a SurfaceField) -> Option<Self> {
        let surface = Surface { points_m: &field.points, triangles: &field.triangles };
        Some(Self { surface, sphere: EquivalentSphere::of(&surface)? })
    }

    /// Pascals at 1 m for a mode's velocity, and what radiation adds to its decay, 1/s.
    fn gain_and_loss(&self, field: &SurfaceField, mode: usize, hz: f64) -> (f64, f64) {
        let multipoles = self.sphere.multipoles(&self.surface, |point| field.shapes[mode][point]);
        (self.sphere.pressure_pa_s_m(&multipoles, hz), self.sphere.loss_per_s(&multipoles, hz))
    }
}
