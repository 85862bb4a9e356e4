//! Views of the sand that are shown to the audio half.
//!
//! The patch around a contact shows the sand *without* the print of its own tool: the print is
//! filled up to the level around it, because it moves along with the tool and is not what the tool meets
//! next; only then is a frame's lag not heard as a 60 Hz saw. The tool's own depth is in the
//! surface's compliance.

use super::{FRAMES_PER_S, Pose, SandSimulation};
use crate::sand::patch::{PATCH, Patch};

impl SandSimulation {
    /// Writes the sand around a contact into a patch.
    pub fn write_patch(&self, contact: usize, patch: &mut Patch) {
        let Some((track, pose)) = self.tracks.get(contact).and_then(|t| Some((t, t.pose?))) else {
            self.write_overview(patch);
            return;
        };
        self.write_around(&pose, track.level_m, track.radius_m, patch);
        patch.displaced_m2 = track.displaced_m2;
    }

    /// Writes the sand that a contact lands on into a patch.
    pub fn write_landing(&self, pose: &Pose, patch: &mut Patch) {
        let (level_m, radius_m) = self.landing(pose);
        self.write_around(pose, level_m, radius_m, patch);
        patch.displaced_m2 = 0.0;
    }

    /// The sand around a pose, with its print filled up to `level_m`.
    fn write_around(&self, pose: &Pose, level_m: f64, radius_m: f64, patch: &mut Patch) {
        let cell = self.grid.cell_m();
        let heap_m = 1.6 * radius_m + 2.0 * cell;
        let travel_m = pose.velocity_m_s[0].hypot(pose.velocity_m_s[1]) / FRAMES_PER_S;
        let stride = ((6.0 * heap_m + 4.0 * travel_m) / (PATCH as f64 * cell)).ceil().clamp(1.0, 1e4);
        let spacing = stride * cell;
        // Snapped, so that one patch after the other shows the same cells.
        let first = [0, 1].map(|a| {
            let middle = pose.position_m[a] + pose.velocity_m_s[a] / FRAMES_PER_S;
            ((middle / cell - 0.5) / stride).round() - (PATCH / 2) as f64
        });
        patch.contact = pose.contact;
        patch.spacing_m = spacing;
        patch.origin_m = first.map(|f| (f * stride + 0.5) * cell);
        patch.base_m = level_m - self.depth_m;
        for j in 0..PATCH {
            for i in 0..PATCH {
                let at = [patch.origin_m[0] + i as f64 * spacing, patch.origin_m[1] + j as f64 * spacing];
                let above_level = self.cell_at(at) - level_m;
                let away = (at[0] - pose.position_m[0]).hypot(at[1] - pose.position_m[1]);
                let t = ((away - heap_m) / (0.5 * heap_m)).clamp(0.0, 1.0);
                patch.heights_m[j * PATCH + i] = (above_level * t * t * (3.0 - 2.0 * t)) as f32;
            }
        }
    }

    /// Writes all the sand, coarsely, into a patch.
    pub fn write_overview(&self, patch: &mut Patch) {
        let cell = self.grid.cell_m();
        let edge = self.grid.columns().max(self.grid.rows()) as f64 * cell;
        // One sample beyond each edge, where the spline needs neighbours.
        patch.spacing_m = edge / (PATCH - 4) as f64;
        patch.contact = usize::MAX;
        patch.origin_m = [-1.5 * patch.spacing_m; 2];
        patch.base_m = 0.0;
        patch.displaced_m2 = 0.0;
        for j in 0..PATCH {
            for i in 0..PATCH {
                let at = [i, j].map(|k| (k as f64 - 1.5) * patch.spacing_m);
                patch.heights_m[j * PATCH + i] = (self.cell_at(at) - self.depth_m) as f32;
            }
        }
    }

    /// Height of the cell at a position, of the nearest one beyond the edge, metres.
    fn cell_at(&self, position_m: [f64; 2]) -> f64 {
        let cell = |a: usize| (position_m[a] / self.grid.cell_m()).max(0.0) as usize;
        self.grid.height_m(cell(0), cell(1))
    }
}
