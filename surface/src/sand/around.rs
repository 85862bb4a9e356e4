//! The sand around a contact, as a patch shows it: without the print of the contact's own tool,
//! which is filled up to the level around it, because it moves along with the tool and is not what
//! the tool meets next.
//!
//! ```text
//! h(x) = g(x) + w(a) (b(x) − g(x))         a: how far from the tool's way, w: 0 on it, 1 beyond the heap
//! g(x) = min(level(s), sand(x) + d(F))     s: how far along it
//! b(x) = max(sand(x), g(x))                heaps beside the way stay what they are
//! ```
//! A tool that meets untouched sand stands d(F) below its level; in a furrow that is as deep
//! already it stands on the bottom, and in a deeper one deeper: sand that was pressed once carries
//! at once.
//!
//! The way is as long as a tool comes while a patch is in use, ahead and behind: at 0.5 m/s a tool
//! is 8 mm further on a frame later, where a circle about its old place would show it its own bow
//! wave ahead, and its own furrow if it has turned back.

use super::patch::{PATCH, Patch};
use super::pose::{FRAMES_PER_S, Pose};
use crate::moving_picture::MovingPicture;

/// Points of the circle on which the level is looked for.
const POINTS: usize = 32;
/// For how many frames a patch is in use: it waits for one, fades in for one, and is there until
/// the next has faded in.
const FRAMES_IN_USE: f64 = 3.0;
/// Places on a way where its level is looked for, behind the tool, at it and ahead.
const POSTS: usize = 9;

/// A contact in the sand.
pub(super) struct Around<'a> {
    pub(super) pose: &'a Pose,
    /// Radius of its print, metres.
    pub(super) radius_m: f64,
    pub(super) cell_m: f64,
    /// Depth of the untouched bed, metres.
    pub(super) depth_m: f64,
    /// Depth of the tool in untouched sand, metres.
    pub(super) sinks_m: f64,
}

/// The way of a tool while a patch is in use.
struct Way {
    middle_m: [f64; 2],
    direction: [f64; 2],
    /// Behind and ahead.
    half_m: f64,
    /// Metres above the bottom, from behind to ahead.
    levels_m: [f64; POSTS],
}

impl Way {
    /// Through a tool that stands at `level_m`.
    fn of(pose: &Pose, level_m: f64, level_at: impl Fn([f64; 2]) -> f64) -> Self {
        let [u, v] = pose.velocity_m_s;
        let speed_m_s = libm::hypot(u, v);
        let direction = if speed_m_s > 0.0 { [u / speed_m_s, v / speed_m_s] } else { [0.0; 2] };
        let half_m = FRAMES_IN_USE * speed_m_s / FRAMES_PER_S;
        let mut way = Self { middle_m: pose.position_m, direction, half_m, levels_m: [level_m; POSTS] };
        if half_m > 0.0 {
            let here_m = level_at(pose.position_m);
            for (post, way_level_m) in way.levels_m.iter_mut().enumerate() {
                let along_m = half_m * (2.0 * post as f64 / (POSTS - 1) as f64 - 1.0);
                let at = [0, 1].map(|a| pose.position_m[a] + along_m * direction[a]);
                *way_level_m += level_at(at) - here_m;
            }
        }
        way
    }

    /// Level at the nearest place of the way, and the distance from it, metres.
    fn nearest(&self, at: [f64; 2]) -> (f64, f64) {
        let off = [0, 1].map(|a| at[a] - self.middle_m[a]);
        let along_m =
            (off[0] * self.direction[0] + off[1] * self.direction[1]).clamp(-self.half_m, self.half_m);
        let away_m = libm::hypot(off[0] - along_m * self.direction[0], off[1] - along_m * self.direction[1]);
        if self.half_m == 0.0 {
            return (self.levels_m[0], away_m);
        }
        let post = 0.5 * (along_m / self.half_m + 1.0) * (POSTS - 1) as f64;
        let first = (post as usize).min(POSTS - 2);
        let share = post - first as f64;
        (self.levels_m[first] * (1.0 - share) + self.levels_m[first + 1] * share, away_m)
    }
}

impl Around<'_> {
    /// Writes a patch of sand whose cells lie at `cell_at(position)` and whose level around a place
    /// is `level_at(position)`, both metres above the bottom, with the print filled up to
    /// `level_m`.
    pub(super) fn write(
        &self,
        level_m: f64,
        cell_at: impl Fn([f64; 2]) -> f64,
        level_at: impl Fn([f64; 2]) -> f64,
        patch: &mut Patch,
    ) {
        let Self { pose, radius_m, cell_m: cell, depth_m, sinks_m } = *self;
        let heap_m = 1.6 * radius_m + 2.0 * cell;
        let way = Way::of(pose, level_m, level_at);
        let stride = ((6.0 * heap_m + 2.0 * way.half_m) / (PATCH as f64 * cell)).ceil().clamp(1.0, 1e4);
        let spacing = stride * cell;
        // Snapped, so that one patch after the other shows the same cells.
        let first = pose.position_m.map(|m| ((m / cell - 0.5) / stride).round() - (PATCH / 2) as f64);
        patch.contact = pose.contact;
        patch.spacing_m = spacing;
        patch.origin_m = first.map(|f| (f * stride + 0.5) * cell);
        patch.base_m = level_m - depth_m;
        patch.displaced_m2 = 0.0;
        for j in 0..PATCH {
            for i in 0..PATCH {
                let at = [patch.origin_m[0] + i as f64 * spacing, patch.origin_m[1] + j as f64 * spacing];
                let (way_level_m, away_m) = way.nearest(at);
                let t = ((away_m - heap_m) / (0.5 * heap_m)).clamp(0.0, 1.0);
                let sand_m = cell_at(at);
                let filled_m = way_level_m.min(sand_m + sinks_m);
                let beside_m = sand_m + (way_level_m - sand_m).clamp(0.0, sinks_m);
                let shown_m = filled_m + (beside_m - filled_m) * t * t * (3.0 - 2.0 * t);
                patch.heights_m[j * PATCH + i] = (shown_m - level_m) as f32;
            }
        }
    }
}

/// Median height on a circle outside the heap, metres: the level of what is not yet disturbed,
/// because a groove through the middle takes up less than half of the circle. (A mean sinks with
/// the tool's own groove: a finger that stops and settles back a little then digs 4 to 9 % too
/// deep.)
pub(super) fn level_around(
    cell_m: f64,
    at: [f64; 2],
    radius_m: f64,
    height_at: impl Fn([f64; 2]) -> f64,
) -> f64 {
    let ring = 1.6 * radius_m + 2.0 * cell_m;
    let mut heights: [f64; POINTS] = core::array::from_fn(|n| {
        let (s, c) = libm::sincos(core::f64::consts::TAU * n as f64 / POINTS as f64);
        height_at([at[0] + ring * c, at[1] + ring * s])
    });
    heights.sort_unstable_by(f64::total_cmp);
    0.5 * (heights[POINTS / 2 - 1] + heights[POINTS / 2])
}

/// Level of the sand around a place as the simulation showed it last, metres above the bottom; none
/// before it ran.
pub(super) fn seen_level_m(picture: &MovingPicture, position_m: [f64; 2], radius_m: f64) -> Option<f64> {
    let here_m = picture.height_at(position_m)?;
    let height_at = |at| picture.height_at(at).unwrap_or(here_m);
    Some(level_around(picture.cell_m(), position_m, radius_m, height_at))
}
