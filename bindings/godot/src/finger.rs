//! `AsperityFinger3D`: touches the meshes of a scene.

use crate::body::AsperityBody;
use crate::events::Rolling;
use crate::triangles::Triangles;
use crate::world::AsperityWorld;
use godot::classes::{INode3D, Mesh, MeshInstance3D, PhysicsRayQueryParameters3D};
use godot::prelude::*;

/// A finger tip: every physics tick it casts a ray along its own -Y, and reports what it touches: the collider's `AsperityBody`, at the
/// texture coordinates of the collider's `MeshInstance3D`.
#[derive(GodotClass)]
#[class(init, base = Node3D)]
pub struct AsperityFinger3D {
    /// How far the ray goes, m.
    #[export]
    #[init(val = 0.1)]
    reach_m: f64,
    /// How hard it presses, N.
    #[export]
    #[init(val = 0.5)]
    force_n: f64,
    /// The haptic channel that feels it; -1: none.
    #[export]
    channel: i64,
    /// Physics layers that it touches.
    #[export(flags_3d_physics)]
    #[init(val = 1)]
    collision_mask: u32,
    /// Whether it touches at all: false lifts it.
    #[export]
    #[init(val = true)]
    pressing: bool,
    /// The surface that is touched, and by which world; 0: none.
    touched: i64,
    world: Option<Gd<AsperityWorld>>,
    /// Which of the world's engines it touches in.
    build: u64,
    mesh: Option<Gd<Mesh>>,
    triangles: Triangles,
    base: Base<Node3D>,
}

#[godot_api]
impl INode3D for AsperityFinger3D {
    fn physics_process(&mut self, _delta: f64) {
        let Some(world) = self.living_world() else { return };
        match self.hit() {
            Some((surface, uv)) => self.touch(world, surface, uv),
            None => self.lift(),
        }
    }

    fn exit_tree(&mut self) {
        self.lift();
        self.world = None;
    }
}

#[godot_api]
impl AsperityFinger3D {
    /// Whether it touches something.
    #[func]
    fn is_touching(&self) -> bool {
        self.touched != 0
    }
}

impl AsperityFinger3D {
    fn contact(&self) -> i64 {
        // Instance ids have their highest bit set for reference-counted objects only; nodes stay positive.
        self.base().instance_id().to_i64() & i64::MAX
    }

    /// The world it touches in: the one that it knows, or, where that was freed, the tree's next one.
    fn living_world(&mut self) -> Option<Gd<AsperityWorld>> {
        // Asked before it is cloned: a freed one cannot be.
        if self.world.as_ref().is_some_and(|world| !world.is_instance_valid()) {
            self.world = None;
            // What it touched went along.
            self.touched = 0;
        }
        if self.world.is_none() {
            self.world = AsperityWorld::of(&self.base().get_tree());
        }
        self.world.clone()
    }

    fn touch(&mut self, mut world: Gd<AsperityWorld>, surface: i64, uv: Vector2) {
        let contact = self.contact();
        let builds = world.bind().builds();
        if self.build != builds {
            // Of an engine that is gone nothing is left to be lifted from.
            (self.touched, self.build) = (0, builds);
        }
        let Rolling { slip_m_s, radius_m } = Rolling::NONE;
        if self.touched == surface
            && world.bind_mut().report_move(contact, uv, self.force_n, slip_m_s, radius_m)
        {
            return;
        }
        self.lift();
        let (force_n, channel) = (self.force_n, self.channel);
        if world.bind_mut().report_begin(contact, surface, uv, force_n, channel, slip_m_s, radius_m) {
            self.touched = surface;
        }
    }

    fn lift(&mut self) {
        if std::mem::take(&mut self.touched) == 0 {
            return;
        }
        let contact = self.contact();
        if let Some(world) = self.world.as_mut().filter(|world| world.is_instance_valid())
            && world.bind().builds() == self.build
        {
            world.bind_mut().report_end(contact);
        }
    }

    /// The surface under the finger, and where.
    fn hit(&mut self) -> Option<(i64, Vector2)> {
        if !self.pressing {
            return None;
        }
        let frame = self.base().get_global_transform();
        let to = frame * Vector3::new(0.0, -self.reach_m as f32, 0.0);
        let mut space = self.base().get_world_3d()?.get_direct_space_state()?;
        let mut query = PhysicsRayQueryParameters3D::create(frame.origin, to)?;
        query.set_collision_mask(self.collision_mask);
        let hit = space.intersect_ray(&query);
        let collider = hit.get("collider")?.try_to::<Gd<Node>>().ok()?;
        let point = hit.get("position")?.try_to::<Vector3>().ok()?;
        let mut touched = None;
        let mut drawn = None;
        for child in collider.get_children().iter_shared() {
            let child = match child.try_cast::<AsperityBody>() {
                Ok(body) => {
                    touched = Some(body);
                    continue;
                }
                Err(child) => child,
            };
            drawn = child.try_cast::<MeshInstance3D>().ok().or(drawn);
        }
        let (touched, drawn) = (touched?, drawn?);
        let surface = touched.bind().surface_id();
        if surface == 0 {
            return None;
        }
        let mesh = drawn.get_mesh()?;
        if self.mesh.as_ref() != Some(&mesh) {
            self.triangles = Triangles::of(&mesh);
            self.mesh = Some(mesh);
        }
        let local = drawn.get_global_transform().affine_inverse() * point;
        let uv = self.triangles.uv_at(local)?;
        Some((surface, touched.bind().on_maps(uv)))
    }
}
