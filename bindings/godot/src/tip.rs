//! `AsperityTip3D`: a tracked fingertip that presses and strokes.

use crate::body::AsperityBody;
use crate::events;
use crate::world::AsperityWorld;
use asperity::{ChannelId, ContactEvent, SurfaceId, Tip, TipCoupling, TipStep};
use godot::classes::INode3D;
use godot::prelude::*;

/// The tip of a tracked finger, one a finger, a child of an `XRController3D` or of a hand's joint.
/// A proxy stays on the surface, on a spring: how deep it is in the body presses, how it moves
/// strokes. The surface's `table` says where it lies in the axes of its `AsperityBody`: `frame = {
/// origin_m = […], u_axis = […], v_axis = […] }`, out of the body along u × v.
#[derive(GodotClass)]
#[class(init, base = Node3D)]
pub struct AsperityTip3D {
    /// Body that is touched.
    #[export]
    body: Option<Gd<AsperityBody>>,
    /// Ids of further surfaces, in the same axes.
    #[export]
    surfaces: PackedInt64Array,
    /// Force over depth, N/m.
    #[export]
    #[init(val = 200.0)]
    stiffness_n_m: f64,
    /// Mass of the proxy, kg; it lags by 2 √(mass/stiffness).
    #[export]
    #[init(val = 0.1)]
    mass_kg: f64,
    /// Most force, N.
    #[export]
    #[init(val = 5.0)]
    max_force_n: f64,
    /// The haptic channel that feels it; -1: none.
    #[export]
    channel: i64,
    /// True where the tracker knows it: false lifts it.
    #[export]
    #[init(val = true)]
    tracked: bool,
    tip: Option<Tip>,
    ids: Vec<SurfaceId>,
    world: Option<Gd<AsperityWorld>>,
    /// Which of the world's engines it touches in.
    build: u64,
    force_n: f64,
    /// Sentence that was told last.
    refused: String,
    base: Base<Node3D>,
}

#[godot_api]
impl INode3D for AsperityTip3D {
    fn physics_process(&mut self, delta: f64) {
        if let Err(why) = self.follow(delta)
            && why != self.refused
        {
            godot_error!("AsperityTip3D: {why}");
            self.refused = why;
        }
    }

    fn exit_tree(&mut self) {
        self.lift();
    }
}

#[godot_api]
impl AsperityTip3D {
    /// Force into the surface, N; 0 where it touches nothing.
    #[func]
    fn normal_force_n(&self) -> f64 {
        self.force_n
    }
}

impl AsperityTip3D {
    fn follow(&mut self, delta: f64) -> Result<(), String> {
        let body = self.body.clone().filter(|body| self.tracked && body.is_instance_valid());
        let Some(body) = body.filter(|body| body.is_inside_tree() && body.bind().surface_id() != 0) else {
            self.lift();
            return Ok(());
        };
        let Some(world) = body.bind().world() else { return Ok(()) };
        let further = self.surfaces.as_slice().iter().copied();
        let ids = std::iter::once(body.bind().surface_id()).chain(further);
        let ids: Vec<_> = ids.map(|id| SurfaceId::from_bits(id as u64)).collect();
        let rectangles = world.bind().rectangles(&ids)?;
        let builds = world.bind().builds();
        let is_known = self.tip.as_ref().is_some_and(|tip| tip.surfaces() == rectangles);
        if !is_known || self.ids != ids || self.build != builds {
            self.lift();
            let mut coupling = TipCoupling::default();
            coupling.stiffness_n_m = self.stiffness_n_m;
            coupling.mass_kg = self.mass_kg;
            coupling.max_force_n = self.max_force_n;
            self.tip = Some(Tip::new(rectangles, coupling).map_err(|error| error.to_string())?);
            (self.ids, self.world, self.build) = (ids, Some(world), builds);
        }
        let frame = body.get_global_transform().orthonormalized().affine_inverse();
        let at = frame * self.base().get_global_position();
        let Some(tip) = &mut self.tip else { return Ok(()) };
        let step = tip.step(delta, [at.x, at.y, at.z].map(f64::from)).map_err(|error| error.to_string())?;
        self.report(step)
    }

    fn lift(&mut self) {
        let step = self.tip.take().map(|mut tip| tip.lift()).unwrap_or_default();
        // A contact of an engine that is gone has ended with it: that is no refusal.
        let _ = self.report(step);
    }

    fn report(&mut self, step: TipStep) -> Result<(), String> {
        self.force_n = match step {
            TipStep::Begin(_, sample) | TipStep::Move(_, sample) => sample.normal_force_n,
            TipStep::Free | TipStep::End(_) => 0.0,
        };
        // Nodes' instance ids are positive.
        let contact = events::contact(self.base().instance_id().to_i64() & i64::MAX)?;
        let event = match step {
            TipStep::Begin(index, sample) => {
                let touching = events::touching(self.ids[index].to_bits() as i64, self.channel, 0)?;
                Some(ContactEvent::begin_with(contact, touching, sample))
            }
            other => other.event(&self.ids, contact, ChannelId(0)),
        };
        let world = self.world.as_mut().filter(|world| world.is_instance_valid());
        if let (Some(event), Some(world)) = (event, world)
            && world.bind().builds() == self.build
        {
            world.bind_mut().report("AsperityTip3D", || Ok(event));
        }
        Ok(())
    }
}
