//! A surface's place on the audio half, where one surface can follow another without a click.
//!
//! A replaced surface is crossfaded, height by height, over [`CHANGE_S`] of absolute samples; the
//! old one then goes home to be freed. A surface that is removed stays until the contacts on it
//! have faded.

use crate::link::message::Retired;
use crate::link::ring::Sender;
use crate::model::id::{BodyId, SurfaceId};
use crate::model::surface::{DEFAULT_ROUGHNESS, Roughness};
use crate::resource::overlay::{BetweenQuery, NoiseQuery, Room, ShortWaves, TileCells};
use crate::resource::stroking::Stroking;
use crate::resource::surface::SurfaceSlot;

use asperity_dsp::fractal_noise::{FractalNoise, InterpolationError, NoisePath, OCTAVES};
use asperity_surface::height_field::{
    Finish, HeightField, MAX_BLOCK, PathBlock, PowerKind, Reaction, SurfaceBlock, Touch, local_concavity_m,
};
use asperity_surface::height_map::FRICTION;
use std::any::Any;

/// Time in which one surface becomes another, s.
pub(crate) const CHANGE_S: f64 = 0.02;

/// One surface's place.
#[derive(Default)]
pub(crate) struct Seat {
    current: Option<Box<SurfaceSlot>>,
    previous: Option<Box<SurfaceSlot>>,
    /// The newest replacement that came while another was still fading in.
    waiting: Option<Box<SurfaceSlot>>,
    change_began: u64,
    change_samples: f64,
    removed: bool,
    /// The name of what is here.
    id: Option<SurfaceId>,
}

/// The micro-noise along a path.
pub(crate) struct Noise<'a> {
    pub(crate) field: &'a FractalNoise,
    /// As the path's, or wider where octaves are left out.
    pub(crate) footprint_m: &'a [f64],
    /// The least and the greatest coordinates of the path, those midway included.
    pub(crate) bounds_m: [[f64; 2]; 2],
    /// Last place of the contact.
    pub(crate) cells: &'a mut TileCells,
    pub(crate) room: &'a mut Room,
    /// Radius of the sphere that rides it, m.
    pub(crate) tip_radius_m: f64,
    /// Its short waves by themselves, where they are wanted.
    pub(crate) between: Option<(BetweenQuery, &'a mut ShortWaves)>,
    /// The heights once more, as a tool's tip rides them.
    pub(crate) tip: Option<TipNoise<'a>>,
}

/// Heights with the micro-noise as another sphere rides it.
pub(crate) struct TipNoise<'a> {
    pub(crate) tip_radius_m: f64,
    pub(crate) height_m: &'a mut [f64],
    pub(crate) between: Option<(BetweenQuery, &'a mut ShortWaves)>,
}

/// Consequence of setting a surface for the contacts on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Change {
    /// Contacts go on; heights crossfade.
    Crossfade,
    /// The new surface has another size, so positions on the old mean nothing: contacts must fade.
    Restart,
}

impl Seat {
    /// The surface that contacts are on.
    pub(crate) fn current(&self) -> Option<&SurfaceSlot> {
        self.current.as_deref()
    }

    /// Puts a surface here. A replacement that is itself replaced before its turn goes home at
    /// once; the caller makes sure that `home` has room for it.
    pub(crate) fn set(
        &mut self,
        id: SurfaceId,
        surface: Box<SurfaceSlot>,
        position: u64,
        sample_rate_hz: f64,
        home: &mut Sender<Retired>,
    ) -> Change {
        self.id = Some(id);
        self.removed = false;
        self.change_samples = CHANGE_S * sample_rate_hz;
        let Some(current) = &self.current else {
            self.current = Some(surface);
            return Change::Crossfade;
        };
        let same_size = current.surface.width_m == surface.surface.width_m
            && current.surface.height_m == surface.surface.height_m;
        if self.previous.is_some() {
            if let Some(superseded) = self.waiting.replace(surface) {
                // There is room: see above. Were there none, the surface would be freed here.
                let _ = home.send(Retired::Surface(superseded));
            }
        } else {
            self.start_change(surface, position);
        }
        if same_size { Change::Crossfade } else { Change::Restart }
    }

    /// The name of what is here.
    pub(crate) fn id(&self) -> Option<SurfaceId> {
        self.id
    }

    /// Takes away what is here, or comes here, under its name; nothing if it was removed.
    pub(crate) fn take(&mut self) -> Option<(SurfaceId, Box<SurfaceSlot>)> {
        let surface = self.waiting.take().or(self.current.take()).filter(|_| !self.removed)?;
        Some((self.id?, surface))
    }

    /// No contact may begin here any more.
    pub(crate) fn remove(&mut self) {
        self.removed = true;
    }

    /// Tests whether contacts may begin here.
    pub(crate) fn is_open(&self) -> bool {
        self.current.is_some() && !self.removed
    }

    /// Tests whether no surface is here, none fades and none waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.current.is_none() && self.previous.is_none() && self.waiting.is_none()
    }

    fn start_change(&mut self, surface: Box<SurfaceSlot>, position: u64) {
        self.previous = self.current.replace(surface);
        self.change_began = position;
    }

    /// Sends home what nobody needs any more; called on the absolute sample grid.
    pub(crate) fn tidy(&mut self, position: u64, in_use: impl Fn() -> bool, home: &mut Sender<Retired>) {
        let faded = (position.saturating_sub(self.change_began)) as f64 >= self.change_samples;
        if faded
            && self.previous.is_some()
            && retire(&mut self.previous, home)
            && let Some(next) = self.waiting.take()
        {
            self.start_change(next, position);
        }
        if self.removed && self.current.is_some() && !in_use() {
            retire(&mut self.waiting, home);
            retire(&mut self.previous, home);
            retire(&mut self.current, home);
        }
    }

    /// Heights, slopes and roughness along a path, with the micro-noise.
    pub(crate) fn sample(
        &mut self,
        path: &PathBlock<'_>,
        noise: &mut Noise<'_>,
        out: &mut SurfaceBlock,
        rough: &mut SurfaceBlock,
    ) {
        if self.previous.is_some() {
            // Two surfaces at once are known at samples only.
            noise.between = None;
            noise.tip.iter_mut().for_each(|tip| tip.between = None);
        }
        let all = path.slopes || self.previous.is_some();
        let Some(current) = &mut self.current else { return };
        current.sample(path, all, noise, out, rough);
        let Some(previous) = &mut self.previous else { return };
        let mut old = SurfaceBlock::default();
        let mut new_tip_m = [0.0; MAX_BLOCK];
        if let Some(tip) = &noise.tip {
            new_tip_m[..path.len()].copy_from_slice(tip.height_m);
        }
        previous.sample(path, all, noise, &mut old, rough);
        let weight_at = |i: usize| {
            let age = (path.first_sample + i as u64).saturating_sub(self.change_began) as f64;
            smoothstep((age / self.change_samples).min(1.0))
        };
        if let Some(tip) = &mut noise.tip {
            for (i, (height_m, new_m)) in tip.height_m.iter_mut().zip(new_tip_m).enumerate() {
                *height_m += weight_at(i) * (new_m - *height_m);
            }
        }
        for i in 0..path.len() {
            let weight = weight_at(i);
            let blend = |new: &mut f64, old: f64| *new = old + weight * (*new - old);
            blend(&mut out.height_m[i], old.height_m[i]);
            blend(&mut out.gradient[i][0], old.gradient[i][0]);
            blend(&mut out.gradient[i][1], old.gradient[i][1]);
            blend(&mut out.roughness[i], old.roughness[i]);
            blend(&mut out.friction[i], old.friction[i]);
            blend(&mut out.compliance_m_n[i], old.compliance_m_n[i]);
            out.answer.mix(i, weight, &old.answer, 1.0 - weight);
        }
    }

    /// Strokes excite `body` in another way from now on.
    pub(crate) fn body_changed(&mut self, body: BodyId, stroking: &Stroking) {
        for slot in [&mut self.current, &mut self.waiting].into_iter().flatten() {
            if slot.surface.body == Some(body) {
                slot.stroking = *stroking;
            }
        }
    }

    /// Tests whether what is here gives way nowhere, or is known to.
    pub(crate) fn is_hard(&self) -> bool {
        let hard = |slot: &SurfaceSlot| slot.surface.compliance_m_n == 0.0 && slot.properties.is_rigid;
        self.current.as_deref().is_none_or(hard) && self.previous.as_deref().is_none_or(hard)
    }

    /// Changes parameters of the source; returns whether it took the change.
    pub(crate) fn change(&mut self, change: &dyn Any, sample: u64) -> bool {
        self.source().is_some_and(|source| source.set(change, sample))
    }

    /// Source of heights.
    pub(crate) fn source(&mut self) -> Option<&mut (dyn HeightField + '_)> {
        match &mut self.current {
            Some(slot) => Some(&mut *slot.surface.source),
            None => None,
        }
    }

    /// The force at which the surface carries a tip below a place, N.
    pub(crate) fn support_force_n(&mut self, uv: [f64; 2], depth_m: f64) -> f64 {
        let Some(slot) = &mut self.current else { return 0.0 };
        let position_m = [uv[0] * slot.surface.width_m, uv[1] * slot.surface.height_m];
        slot.surface.support_force_n(position_m, depth_m).unwrap_or(0.0)
    }

    /// Results of the source, at the end of a render.
    pub(crate) fn finish(&mut self, sample: u64) -> Vec<Box<dyn Any>> {
        let finish = Finish::default();
        self.change(&finish, sample);
        finish.0.into_inner()
    }

    /// Height of the ground about a contact over that under it, m, for a tip that rides on it.
    pub(crate) fn local_concavity_m(
        &mut self,
        touch: &Touch,
        (reach_m, tip_radius_m): (f64, f64),
        room: &mut SurfaceBlock,
    ) -> f64 {
        match self.current.as_deref_mut().filter(|slot| slot.properties.is_stateless) {
            Some(slot) => local_concavity_m(&mut *slot.surface.source, touch, (reach_m, tip_radius_m), room),
            None => 0.0,
        }
    }

    /// Error of cubics through samples a footprint apart on the micro-relief, and what has to be
    /// looked at so that no more than `left_m` is missed; the other footprint is that by which
    /// octaves fade. While the surface becomes another there is none.
    pub(crate) fn missed(
        &mut self,
        roughness: f64,
        footprints_m: [f64; 2],
        left_m: f64,
        tip_radius_m: f64,
    ) -> InterpolationError {
        match (&mut self.current, &self.previous) {
            (Some(slot), None) if slot.surface.micro_relief_m > 0.0 => {
                slot.overlay.tune(tip_radius_m);
                slot.overlay.short_waves().missed(roughness, footprints_m, left_m)
            }
            _ => InterpolationError { all_m: 0.0, octave: OCTAVES },
        }
    }

    /// Mean square of the relief that the source really has about a place, m²; of one that does not
    /// tell, a ninth of the square of its reach.
    pub(crate) fn power_m2(&mut self, touch: &Touch, room: &mut SurfaceBlock) -> f64 {
        let Some(slot) = &mut self.current else { return 0.0 };
        let path = PathBlock {
            position_m: &[touch.position_m],
            velocity_m_s: &[touch.velocity_m_s],
            footprint_m: &[0.0],
            first_sample: touch.sample,
            contact: touch.contact,
            heights_only: true,
            full_power_m2: Some(f64::INFINITY),
            ..PathBlock::default()
        };
        room.power.kind = PowerKind::Full;
        slot.surface.source.sample(&path, room);
        let (power_m2, reach_m) = (room.power.at(0), slot.properties.reach_m / 3.0);
        if power_m2.is_finite() { power_m2 } else { reach_m * reach_m }
    }

    /// Touches the surface.
    pub(crate) fn touch(&mut self, touch: &Touch) -> Reaction {
        self.source().map_or_else(Reaction::default, |source| source.touch(touch))
    }
}

fn retire(seat: &mut Option<Box<SurfaceSlot>>, home: &mut Sender<Retired>) -> bool {
    match seat.take().map(|surface| home.send(Retired::Surface(surface))) {
        None | Some(Ok(())) => true,
        Some(Err(Retired::Surface(surface))) => {
            *seat = Some(surface);
            false
        }
        Some(Err(_)) => false,
    }
}

/// 0 → 1 with no slope and no curvature at either end.
fn smoothstep(x: f64) -> f64 {
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

impl SurfaceSlot {
    /// Without `all` nobody looks at slopes, friction and answer.
    fn sample(
        &mut self,
        path: &PathBlock<'_>,
        all: bool,
        noise: &mut Noise<'_>,
        out: &mut SurfaceBlock,
        rough: &mut SurfaceBlock,
    ) {
        let n = path.len();
        let surface = &mut self.surface;
        // An entry that a source does not fill stays as the surface says.
        let hard = self.properties.is_rigid;
        if !hard {
            out.friction[..n].fill(FRICTION);
            out.roughness[..n].fill(DEFAULT_ROUGHNESS);
            out.compliance_m_n[..n].fill(0.0);
            out.answer.clear();
            out.power.kind = PowerKind::Full;
        }
        let fills = surface.micro_relief_m > 0.0 && self.overlay.depends_on_source_relief();
        let path = &PathBlock {
            heights_only: hard && !all && surface.compliance_m_n == 0.0,
            full_power_m2: fills.then(|| self.overlay.fills_m2()),
            ..*path
        };
        if surface.compliance_m_n > 0.0 && path.tip_radius_m > 0.0 {
            surface.sample_under(path, out);
        } else {
            surface.source.sample(path, out);
        }
        match &mut surface.roughness {
            Roughness::FromSource => {}
            Roughness::Constant(r) => out.roughness[..n].fill(*r),
            Roughness::Map(map) => {
                let drawn = PathBlock { tip_radius_m: 0.0, heights_only: true, full_power_m2: None, ..*path };
                map.sample(&drawn, rough);
                for (r, mapped) in out.roughness[..n].iter_mut().zip(&rough.height_m) {
                    *r = mapped.clamp(0.0, 1.0);
                }
            }
        }
        if let Some(friction) = surface.friction {
            out.friction[..n].fill(friction);
        }
        if surface.compliance_m_n > 0.0 {
            out.compliance_m_n[..n].fill(surface.compliance_m_n);
        }
        if let Some(tip) = &mut noise.tip {
            tip.height_m.copy_from_slice(&out.height_m[..n]);
        }
        if surface.micro_relief_m > 0.0 {
            let bounds_m = noise.bounds_m;
            // Mostly it is the same all along the path, and known without a look at each place.
            let share = match out.power.kind {
                _ if !fills => Some(1.0),
                PowerKind::None => Some(1.0),
                PowerKind::Full => Some(0.0),
                PowerKind::EachSample => None,
            };
            let along = NoisePath { position_m: path.position_m, footprint_m: noise.footprint_m };
            let query = NoiseQuery { path: along, bounds_m, share, power_m2: &out.power.each_m2[..n] };
            let (roughness, overlay) = (&out.roughness[..n], &mut self.overlay);
            let mut ride = |tip_radius_m, height_m: &mut [f64], between: &mut Option<(_, &mut _)>| {
                overlay.tune(tip_radius_m);
                let room = (&mut *noise.cells, &mut *noise.room);
                let between = between.as_mut().map(|(way, short)| (*way, &mut **short));
                overlay.add(noise.field, &query, roughness, height_m, room, between);
            };
            ride(noise.tip_radius_m, &mut out.height_m[..n], &mut noise.between);
            if let Some(TipNoise { tip_radius_m, height_m, between }) = &mut noise.tip {
                ride(*tip_radius_m, height_m, between);
            }
        }
    }
}
