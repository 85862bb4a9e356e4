//! `--mesh`: where on a body with mode shapes the merged strikes were made, as a check of one
//! against the other.

use crate::error::CliError;
use asperity::{ModalModel, ModeShapes};
use asperity_fit::after::places::{LEAST_MODES, Shape, places};
use asperity_fit::after::strikes::Merged;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Below this the places explain too little to be believed.
const DOUBTFUL: f64 = 0.5;

/// Figures of a strike's place for `--json`.
#[derive(Debug, Serialize)]
pub struct PlacesReport {
    /// Share of the difference between the strikes that their places explain; 1 = all.
    pub r_squared: f64,
    /// Measured over computed frequencies.
    pub frequency_factor: f64,
    /// Modes of the recordings that were found among the shapes.
    pub modes: usize,
    /// Each recording's.
    pub strikes: Vec<StrikeReport>,
    /// Each of these modes' gain.
    pub gains: Vec<GainReport>,
}

/// One strike.
#[derive(Debug, Serialize)]
pub struct StrikeReport {
    pub recording: PathBuf,
    /// Nearest point of the mesh, in the body's frame.
    pub at_m: [f64; 3],
    /// Strength, relative to the first.
    pub level: f64,
}

/// One mode.
#[derive(Debug, Serialize)]
pub struct GainReport {
    pub frequency_hz: f64,
    pub computed_hz: f64,
    /// Amplitude in the recordings for each kg^−½ of motion across the surface.
    pub gain: f64,
}

impl PlacesReport {
    /// Assigns the strikes, in the order of the recordings, to points of the body in a modes file
    /// with shapes.
    ///
    /// # Errors
    /// When the file is none or has no shapes, or too few of its modes are in the recordings.
    pub fn new(path: &Path, merged: &Merged, recordings: &[&Path]) -> Result<Self, CliError> {
        let model = ModalModel::load(path).map_err(CliError::from_error)?;
        let Some(body) = &model.shapes else {
            let right = "must be of version 2 with shapes, as `asperity modes` writes it";
            return Err(CliError::file(path, "has no mode shapes", right));
        };
        let across = across(body);
        let shapes: Vec<Shape<'_>> = model
            .modes
            .iter()
            .zip(&across)
            .map(|(mode, across)| Shape { frequency_hz: mode.frequency_hz, across })
            .collect();
        let Some(found) = places(merged, &shapes) else {
            let wrong = format!("fewer than {LEAST_MODES} of its modes are in the recordings");
            return Err(CliError::file(path, wrong, "must be the body that was struck, in its material"));
        };
        let strikes = recordings.iter().zip(&found.points).zip(&found.levels);
        let strikes = strikes.map(|((recording, point), level)| StrikeReport {
            recording: recording.to_path_buf(),
            at_m: body.points_m[*point],
            level: *level,
        });
        let gains = found.modes.iter().map(|(measured, shape, gain)| GainReport {
            frequency_hz: merged.strikes[0][*measured].frequency_hz,
            computed_hz: model.modes[*shape].frequency_hz,
            gain: *gain,
        });
        Ok(Self {
            r_squared: found.r_squared,
            frequency_factor: found.frequency_factor,
            modes: found.modes.len(),
            strikes: strikes.collect(),
            gains: gains.collect(),
        })
    }

    /// Lines for people.
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self
            .strikes
            .iter()
            .map(|strike| {
                let [x, y, z] = strike.at_m.map(|x| 1e3 * x);
                format!("{}: struck at {x:.1}, {y:.1}, {z:.1} mm", strike.recording.display())
            })
            .collect();
        lines.push(format!(
            "these places explain {:.0} % of the difference between the strikes ({} modes, measured {:.3} times as high as computed)",
            1e2 * self.r_squared, self.modes, self.frequency_factor
        ));
        if self.r_squared < DOUBTFUL {
            lines.push(
                "warning: --mesh: its shapes do not explain the recordings; is it the body that was struck?"
                    .into(),
            );
        }
        lines
    }
}

/// For each mode the motion of every point across the surface.
fn across(shapes: &ModeShapes) -> Vec<Vec<f64>> {
    let normals = normals(shapes);
    let dot = |motion: &[f32; 3], normal: &[f64; 3]| -> f64 {
        motion.iter().zip(normal).map(|(a, b)| f64::from(*a) * b).sum()
    };
    let of = |motion: &Vec<[f32; 3]>| motion.iter().zip(&normals).map(|(m, n)| dot(m, n)).collect();
    shapes.phi_per_sqrt_kg.iter().map(of).collect()
}

/// The surface's normal at every point: of the triangles around it, larger ones counting more.
fn normals(shapes: &ModeShapes) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; shapes.points_m.len()];
    for triangle in &shapes.triangles {
        let [a, b, c] = triangle.map(|corner| shapes.points_m[corner as usize]);
        let [u, v] = [b, c].map(|point| [0, 1, 2].map(|axis| point[axis] - a[axis]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for corner in triangle {
            let normal: &mut [f64; 3] = &mut normals[*corner as usize];
            normal.iter_mut().zip(cross).for_each(|(sum, x)| *sum += x);
        }
    }
    for normal in &mut normals {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        normal.iter_mut().for_each(|x| *x /= length);
    }
    normals
}
