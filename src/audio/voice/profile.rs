//! Profile: heights along the path, with the micro-relief below the source's own band, as the
//! probe's tip rides them.

use super::shared::Shared;
use crate::audio::seat::{Noise, Seat};
use crate::prepared::overlay::{Look, NoiseBetween, Room, TileCells};
use asperity_dsp::pair::Pair;
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::{MAX_BLOCK, PathBlock, SurfaceBlock};

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
    /// Look between samples.
    pub(super) between: Option<FromThere>,
}

/// Short waves of the micro-relief are looked at between samples, from the place of the sample
/// before the first.
#[derive(Debug, Clone, Copy)]
pub(super) struct FromThere {
    /// The coarsest octave that is.
    pub(super) octave: usize,
    /// At the quarters too, and not midway only.
    pub(super) quarters: bool,
    pub(super) from_m: [f64; 2],
}

/// Places of the look on the way from one sample to the next.
const WAYS: [f64; 3] = [0.5, 0.25, 0.75];

/// Short waves of the micro-relief, m: at samples, and between the sample before and each: midway,
/// in the first half, in the second.
pub(super) struct Seen {
    position_m: [[[f64; 2]; MAX_BLOCK]; WAYS.len()],
    pub(super) at_m: [f64; MAX_BLOCK],
    pub(super) between_m: [[f64; MAX_BLOCK]; WAYS.len()],
    /// False where the surface could not tell, as while it becomes another.
    pub(super) seen: bool,
}

impl Seen {
    /// Lays out where it is looked on the way to these places.
    fn look(&mut self, there: FromThere, position_m: &[[f64; 2]]) -> NoiseBetween<'_> {
        let FromThere { octave, quarters, from_m } = there;
        self.seen = false;
        let n = position_m.len();
        let looks = if quarters { WAYS.len() } else { 1 };
        for (share, place_m) in WAYS.into_iter().zip(&mut self.position_m).take(looks) {
            let mut before_m = from_m;
            for ([x, y], at_m) in place_m.iter_mut().zip(position_m) {
                *x = before_m[0] + share * (at_m[0] - before_m[0]);
                *y = before_m[1] + share * (at_m[1] - before_m[1]);
                before_m = *at_m;
            }
        }
        let mut places = self.position_m.iter().zip(&mut self.between_m).take(looks);
        let look = |_| {
            places.next().map(|(position_m, height_m)| Look {
                position_m: &position_m[..n],
                height_m: &mut height_m[..n],
            })
        };
        NoiseBetween {
            octave,
            looks: [(); WAYS.len()].map(look),
            at_m: &mut self.at_m[..n],
            seen: &mut self.seen,
        }
    }
}

/// The surface under one stretch of a path.
pub(super) struct Profile {
    position_m: [[f64; 2]; MAX_BLOCK],
    velocity_m_s: [[f64; 2]; MAX_BLOCK],
    /// Places in the body, for a contact that tells them, m.
    pub(super) at_m: [[f64; 3]; MAX_BLOCK],
    footprint_m: [f64; MAX_BLOCK],
    noise_footprint_m: [f64; MAX_BLOCK],
    /// Pressing force, N.
    pub(super) force_n: [f64; MAX_BLOCK],
    /// Ground that lies there.
    pub(super) surface: SurfaceBlock,
    /// Heights between samples.
    pub(super) seen: Seen,
    /// Room for another map, and for what is read beside the path.
    pub(super) rough: SurfaceBlock,
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
            seen: Seen {
                position_m: [[[0.0; 2]; MAX_BLOCK]; WAYS.len()],
                at_m: [0.0; MAX_BLOCK],
                between_m: [[0.0; MAX_BLOCK]; WAYS.len()],
                seen: false,
            },
            rough: SurfaceBlock::default(),
            room: Room::new(),
        }
    }

    /// Height of each point and the force that presses there. `cells` are those of the contact:
    /// they change no bit.
    pub(super) fn run(
        &mut self,
        seat: &mut Seat,
        along: Along<'_>,
        points: &[PathPoint],
        cells: &mut TileCells,
    ) {
        let n = points.len();
        let mut bounds_m = self.lay_out(along.shared, points);
        let path = PathBlock {
            position_m: &self.position_m[..n],
            velocity_m_s: &self.velocity_m_s[..n],
            footprint_m: &self.footprint_m[..n],
            normal_force_n: &self.force_n[..n],
            first_sample: along.position,
            contact: along.contact,
            slopes: along.slopes,
            tip_radius_m: along.tip_radius_m,
            at_m: if along.in_body { &self.at_m[..n] } else { &[] },
            ..PathBlock::default()
        };
        let between = along.between.map(|there| {
            // All that is looked at lies between two places of the path or the one before it.
            let ([low_m, high_m], from_m) = (bounds_m, there.from_m);
            bounds_m = [
                [0, 1].map(|axis| low_m[axis].min(from_m[axis])),
                [0, 1].map(|axis| high_m[axis].max(from_m[axis])),
            ];
            self.seen.look(there, &self.position_m[..n])
        });
        let mut noise = Noise {
            field: &along.shared.noise,
            footprint_m: &self.noise_footprint_m[..n],
            bounds_m,
            cells,
            room: &mut self.room,
            between,
        };
        let path = PathBlock { bounds_m: Some(bounds_m), ..path };
        seat.sample(&path, &mut noise, &mut self.surface, &mut self.rough);
        if seat.is_hard() {
            return;
        }
        // A surface that gives way lies lower by as much as the force presses it in.
        let surface = &mut self.surface;
        let give = surface.compliance_m_n[..n].iter().zip(&self.force_n);
        for (height_m, (compliance_m_n, force_n)) in surface.height_m.iter_mut().zip(give) {
            *height_m -= compliance_m_n * force_n;
        }
    }

    /// The points, quantity by quantity, and how wide a sample of each is; their least and greatest
    /// coordinates.
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
