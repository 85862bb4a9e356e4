//! Profile: heights along the path, with the micro-relief below the source's own band, as the probe's tip rides them.

use super::shared::Shared;
use crate::audio::seat::{Noise, Seat};
use crate::prepared::overlay::{Room, TileCells};
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::{MAX_BLOCK, PathBlock, SurfaceBlock};

/// The overlay fades as if it were sampled at this rate, Hz, so that it is the same relief at every rate: its finest octave is
/// whole where its cells pass at 11 kHz and gone where they pass at 22 kHz. Above 18 kHz next to nothing is left.
const OVERLAY_RATE_HZ: f64 = 44_100.0;

/// Whose profile it is, and what of it is wanted.
#[derive(Clone, Copy)]
pub(super) struct Along<'a> {
    pub(super) shared: &'a Shared,
    /// Radius of the probe's tip, m.
    pub(super) tip_radius_m: f64,
    /// Which contact asks.
    pub(super) contact: usize,
    /// Absolute index of the first sample.
    pub(super) position: u64,
    /// Slopes too: neither sound nor feel needs them.
    pub(super) slopes: bool,
    /// The path lies at places of the body, [`Profile::at_m`].
    pub(super) in_body: bool,
}

/// The surface under one stretch of a path.
pub(super) struct Profile {
    position_m: [[f64; 2]; MAX_BLOCK],
    velocity_m_s: [[f64; 2]; MAX_BLOCK],
    /// Places in the body, for a contact that tells them, m.
    pub(super) at_m: [[f64; 3]; MAX_BLOCK],
    footprint_m: [f64; MAX_BLOCK],
    noise_footprint_m: [f64; MAX_BLOCK],
    /// What presses, N.
    pub(super) force_n: [f64; MAX_BLOCK],
    /// What lies there.
    pub(super) surface: SurfaceBlock,
    rough: SurfaceBlock,
    room: Room,
}

impl Profile {
    pub(super) fn new() -> Self {
        Self {
            position_m: [[0.0; 2]; MAX_BLOCK],
            velocity_m_s: [[0.0; 2]; MAX_BLOCK],
            at_m: [[0.0; 3]; MAX_BLOCK],
            footprint_m: [0.0; MAX_BLOCK],
            noise_footprint_m: [0.0; MAX_BLOCK],
            force_n: [0.0; MAX_BLOCK],
            surface: SurfaceBlock::default(),
            rough: SurfaceBlock::default(),
            room: Room::new(),
        }
    }

    /// Height of each point and the force that presses there. `cells` are those of the contact: they change no bit.
    pub(super) fn run(
        &mut self,
        seat: &mut Seat,
        along: Along<'_>,
        points: &[PathPoint],
        cells: &mut TileCells,
    ) {
        let n = points.len();
        self.lay_out(along.shared, points);
        let path = PathBlock {
            position_m: &self.position_m[..n],
            velocity_m_s: &self.velocity_m_s[..n],
            footprint_m: &self.footprint_m[..n],
            normal_force_n: &self.force_n[..n],
            first_sample: along.position,
            contact: along.contact,
            slopes: along.slopes,
        };
        let mut noise = Noise {
            field: &along.shared.noise,
            footprint_m: &self.noise_footprint_m[..n],
            tip_radius_m: along.tip_radius_m,
            cells,
            room: &mut self.room,
        };
        if along.in_body {
            seat.lie_at(&self.at_m[..n]);
        }
        seat.sample(&path, &mut noise, &mut self.surface, &mut self.rough);
        // A surface that gives way lies lower by as much as the force presses it in.
        let surface = &mut self.surface;
        let give = surface.compliance_m_n[..n].iter().zip(&self.force_n);
        for (height_m, (compliance_m_n, force_n)) in surface.height_m.iter_mut().zip(give) {
            *height_m -= compliance_m_n * force_n;
        }
    }

    /// The points, quantity by quantity, and how wide a sample of each is.
    fn lay_out(&mut self, shared: &Shared, points: &[PathPoint]) {
        let step_s = 1.0 / shared.sample_rate_hz;
        let samples_of_overlay = (shared.sample_rate_hz / OVERLAY_RATE_HZ).max(1.0);
        let widened = samples_of_overlay * f64::from(1u32 << shared.noise_octaves_gone);
        for (i, point) in points.iter().enumerate() {
            let [u, v] = point.velocity_m_s;
            self.position_m[i] = point.position_m;
            self.velocity_m_s[i] = point.velocity_m_s;
            self.footprint_m[i] = u * u + v * v;
            self.force_n[i] = point.normal_force_n;
        }
        // On their own, because roots go side by side.
        let footprints = self.footprint_m[..points.len()].iter_mut();
        for (footprint_m, noise_m) in footprints.zip(&mut self.noise_footprint_m) {
            *footprint_m = footprint_m.sqrt() * step_s;
            // A footprint twice as wide hides the finest octave that is left.
            *noise_m = *footprint_m * widened;
        }
    }
}
