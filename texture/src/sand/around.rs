//! The sand around a contact, as a patch shows it: without the print of the contact's own tool, which is filled up to the level around it,
//! because it moves along with the tool and is not what the tool meets next.

use super::patch::{PATCH, Patch};
use super::pose::{FRAMES_PER_S, Pose};

/// Points of the circle on which the level is looked for.
const POINTS: usize = 32;

/// A contact in the sand.
pub(super) struct Around<'a> {
    pub(super) pose: &'a Pose,
    /// Radius of its print, metres.
    pub(super) radius_m: f64,
    pub(super) cell_m: f64,
    /// Depth of the untouched bed, metres.
    pub(super) depth_m: f64,
}

impl Around<'_> {
    /// Writes a patch of sand whose cells lie at `cell_at(position)` above the bottom, metres, with the print filled up to `level_m`.
    pub(super) fn write(&self, level_m: f64, cell_at: impl Fn([f64; 2]) -> f64, patch: &mut Patch) {
        let Self { pose, radius_m, cell_m: cell, depth_m } = *self;
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
        patch.base_m = level_m - depth_m;
        patch.displaced_m2 = 0.0;
        for j in 0..PATCH {
            for i in 0..PATCH {
                let at = [patch.origin_m[0] + i as f64 * spacing, patch.origin_m[1] + j as f64 * spacing];
                let above_level = cell_at(at) - level_m;
                let away = (at[0] - pose.position_m[0]).hypot(at[1] - pose.position_m[1]);
                let t = ((away - heap_m) / (0.5 * heap_m)).clamp(0.0, 1.0);
                patch.heights_m[j * PATCH + i] = (above_level * t * t * (3.0 - 2.0 * t)) as f32;
            }
        }
    }
}

/// Median height on a circle outside the heap, metres: the level of what is not yet disturbed, because a
/// groove through the middle takes up less than half of the circle. (A mean sinks with the tool's own
/// groove: a finger that stops and settles back a little then digs 4 to 9 % too deep.)
pub(super) fn level_around(
    cell_m: f64,
    at: [f64; 2],
    radius_m: f64,
    height_at: impl Fn([f64; 2]) -> f64,
) -> f64 {
    let ring = 1.6 * radius_m + 2.0 * cell_m;
    let mut heights: [f64; POINTS] = core::array::from_fn(|n| {
        let (s, c) = (core::f64::consts::TAU * n as f64 / POINTS as f64).sin_cos();
        height_at([at[0] + ring * c, at[1] + ring * s])
    });
    heights.sort_unstable_by(f64::total_cmp);
    0.5 * (heights[POINTS / 2 - 1] + heights[POINTS / 2])
}
