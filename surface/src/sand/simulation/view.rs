//! Views of the sand that are shown to the audio half.
//!
//! The patch around a contact shows the sand *without* the print of its own tool: the print is
//! filled up to the level around it, because it moves along with the tool and is not what the tool
//! meets next; only then is a frame's lag not heard as a 60 Hz saw. The tool's own depth is in the
//! surface's compliance.

use super::{Pose, SandSimulation};
use crate::sand::around::Around;
use crate::sand::patch::{PATCH, Patch};

impl SandSimulation {
    /// Writes the sand around a contact into a patch.
    pub fn write_patch(&self, contact: usize, patch: &mut Patch) {
        let Some((track, pose)) = self.tracks.get(contact).and_then(|t| Some((t, t.pose?))) else {
            self.write_overview(patch);
            return;
        };
        let level_at = |at| self.level_m(at, track.radius_m);
        self.around(&pose, track.radius_m).write(track.level_m, |at| self.cell_at(at), level_at, patch);
        patch.displaced_m2 = track.displaced_m2;
    }

    /// Writes the sand that a contact lands on into a patch.
    pub fn write_landing(&self, pose: &Pose, patch: &mut Patch) {
        let (level_m, radius_m) = self.landing(pose);
        let level_at = |at| self.level_m(at, radius_m);
        self.around(pose, radius_m).write(level_m, |at| self.cell_at(at), level_at, patch);
    }

    fn around<'a>(&self, pose: &'a Pose, radius_m: f64) -> Around<'a> {
        let sinks_m = self.law.depth_m(pose.normal_force_n);
        Around { pose, radius_m, cell_m: self.grid.cell_m(), depth_m: self.depth_m, sinks_m }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sand::SandDesign;

    #[test]
    fn an_overview_of_untouched_sand_is_flat_at_zero() {
        let sand = SandSimulation::new(&SandDesign::default()).unwrap();
        let mut patch = Patch::flat();
        sand.write_overview(&mut patch);
        assert!(patch.heights_m.iter().all(|height_m| height_m.abs() < 1e-6));
    }
}
