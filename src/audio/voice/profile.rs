//! Profile: heights along the path, with the micro-relief below the source's own band, as the
//! probe's tip rides them.

use crate::audio::seat::{Noise, Seat, TipNoise};
use crate::audio::shared::Shared;
use crate::resource::overlay::{BetweenQuery, Room, ShortWaves, TileCells};
use asperity_dsp::pair::Pair;
use asperity_dsp::trajectory::PathPoint;
use asperity_surface::height_field::{MAX_BLOCK, PathBlock, SurfaceBlock};

/// Request for the profile of a contact.
#[derive(Clone, Copy)]
pub(super) struct Along<'a> {
    pub(super) shared: &'a Shared,
    /// Contact, tip, first sample; slopes too, which neither sound nor feel needs.
    pub(super) block: PathBlock<'a>,
    /// Radius with which the micro-relief is ridden, m.
    pub(super) micro_radius_m: f64,
    /// Radius with which a tool's tip rides it, m, and what that samples between samples.
    pub(super) tip: Option<(f64, Option<BetweenQuery>)>,
    /// Places in the body are known, [`Profile::at_m`].
    pub(super) in_body: bool,
    /// Short waves between samples too.
    pub(super) between: Option<BetweenQuery>,
}

/// The surface under one stretch of a path.
pub(super) struct Profile {
    position_m: [[f64; 2]; MAX_BLOCK],
    velocity_m_s: [[f64; 2]; MAX_BLOCK],
    /// Places in the body, for a contact that reports them, m.
    pub(super) at_m: [[f64; 3]; MAX_BLOCK],
    footprint_m: [f64; MAX_BLOCK],
    noise_footprint_m: [f64; MAX_BLOCK],
    /// Pressing force, N.
    pub(super) force_n: [f64; MAX_BLOCK],
    pub(super) surface: SurfaceBlock,
    /// Short waves of the micro-relief, at samples and between.
    pub(super) short: ShortWaves,
    /// As a tool's tip rides it.
    pub(super) tip: TipProfile,
    /// Room for another map, and for what is read beside the path.
    pub(super) rough: SurfaceBlock,
    room: Room,
}

/// The surface as a tool's tip rides it.
pub(super) struct TipProfile {
    pub(super) height_m: [f64; MAX_BLOCK],
    pub(super) short: ShortWaves,
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
            short: ShortWaves::new(),
            tip: TipProfile { height_m: [0.0; MAX_BLOCK], short: ShortWaves::new() },
            rough: SurfaceBlock::default(),
            room: Room::new(),
        }
    }

    /// Height of each point and the force that presses there; `cells` change no bit.
    pub(super) fn run(
        &mut self,
        seat: &mut Seat,
        along: Along<'_>,
        points: &[PathPoint],
        cells: &mut TileCells,
    ) {
        let n = points.len();
        let mut bounds_m = self.lay_out(along.shared, points);
        (self.short.known, self.tip.short.known) = (false, false);
        let tip_between = along.tip.and_then(|(_, between)| between);
        if let Some(BetweenQuery { from_m, .. }) = along.between.or(tip_between) {
            // Looks lie between two places of the path, or the one before it.
            let [low_m, high_m] = bounds_m;
            bounds_m = [
                [0, 1].map(|axis| low_m[axis].min(from_m[axis])),
                [0, 1].map(|axis| high_m[axis].max(from_m[axis])),
            ];
        }
        let path = PathBlock {
            position_m: &self.position_m[..n],
            velocity_m_s: &self.velocity_m_s[..n],
            footprint_m: &self.footprint_m[..n],
            normal_force_n: &self.force_n[..n],
            at_m: if along.in_body { &self.at_m[..n] } else { &[] },
            bounds_m: Some(bounds_m),
            ..along.block
        };
        let mut noise = Noise {
            field: &along.shared.noise,
            footprint_m: &self.noise_footprint_m[..n],
            bounds_m,
            cells,
            room: &mut self.room,
            tip_radius_m: along.micro_radius_m,
            between: along.between.map(|way| (way, &mut self.short)),
            tip: along.tip.map(|(tip_radius_m, between)| TipNoise {
                tip_radius_m,
                height_m: &mut self.tip.height_m[..n],
                between: between.map(|way| (way, &mut self.tip.short)),
            }),
        };
        seat.sample(&path, &mut noise, &mut self.surface, &mut self.rough);
        if seat.is_hard() {
            return;
        }
        // A surface that gives way lies lower by as much as the force presses it in.
        let give = self.surface.compliance_m_n[..n].iter().zip(&self.force_n);
        let heights = self.surface.height_m.iter_mut().zip(&mut self.tip.height_m);
        for ((height_m, tip_height_m), (compliance_m_n, force_n)) in heights.zip(give) {
            let given_m = compliance_m_n * force_n;
            (*height_m, *tip_height_m) = (*height_m - given_m, *tip_height_m - given_m);
        }
    }

    /// Lays the points out quantity by quantity; their least and greatest coordinates.
    fn lay_out(&mut self, shared: &Shared, points: &[PathPoint]) -> [[f64; 2]; 2] {
        let mut bounds_m = [f64::INFINITY, f64::NEG_INFINITY].map(|nothing| Pair::from([nothing; 2]));
        let step_s = 1.0 / shared.sample_rate_hz;
        let widened = shared.noise_footprints();
        for (i, point) in points.iter().enumerate() {
            let [u, v] = point.velocity_m_s;
            self.position_m[i] = point.position_m;
            self.velocity_m_s[i] = point.velocity_m_s;
            self.footprint_m[i] = u * u + v * v;
            self.force_n[i] = point.normal_force_n;
            let at_m = Pair::from(point.position_m);
            bounds_m = [bounds_m[0].least(at_m), bounds_m[1].greatest(at_m)];
        }
        // On their own, because roots go side by side.
        let footprints = self.footprint_m[..points.len()].iter_mut();
        for (footprint_m, noise_m) in footprints.zip(&mut self.noise_footprint_m) {
            *footprint_m = footprint_m.sqrt() * step_s;
            *noise_m = *footprint_m * widened;
        }
        bounds_m.map(Into::into)
    }
}
