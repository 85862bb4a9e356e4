//! `AsperityFinger3D`: touches the meshes of a scene.

use crate::body::AsperityBody;
use crate::events::{NO_VELOCITY, Rolling};
use crate::triangles::{Triangles, on_side, side};
use crate::world::AsperityWorld;
use godot::classes::{INode3D, Mesh, MeshInstance3D, PhysicsRayQueryParameters3D};
use godot::prelude::*;

/// A finger tip: every physics tick it casts a ray along its own -Y, and reports what it touches:
/// the collider's `AsperityBody`, at the texture coordinates of the collider's `MeshInstance3D`; of
/// one that has none, on the side that its normal is nearest to, in metres.
#[derive(GodotClass)]
#[class(init, base = Node3D)]
pub struct AsperityFinger3D {
    /// Length of the ray, m.
    #[export]
    #[init(val = 0.1)]
    reach_m: f64,
    /// Pressing force, N.
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
    /// True where it touches: false lifts it.
    #[export]
    #[init(val = true)]
    pressing: bool,
    /// The surface that is touched, and by which world; 0: none.
    touched: i64,
    world: Option<Gd<AsperityWorld>>,
    /// Which of the world's engines it touches in.
    build: u64,
    /// Place a tick ago in the space of what it touched, m.
    last: Option<(i64, Vector3)>,
    /// The side that it is on of what has no texture coordinates.
    side: Option<usize>,
    mesh: Option<Gd<Mesh>>,
    triangles: Triangles,
    base: Base<Node3D>,
}

#[godot_api]
impl INode3D for AsperityFinger3D {
    fn physics_process(&mut self, delta: f64) {
        let Some(world) = self.living_world() else { return };
        match self.hit() {
            Some(hit) => self.touch(world, &hit, delta),
            None => {
                self.last = None;
                self.lift();
            }
        }
    }

    fn exit_tree(&mut self) {
        self.lift();
        self.world = None;
    }
}

#[godot_api]
impl AsperityFinger3D {
    /// Tests whether it touches something.
    #[func]
    fn is_touching(&self) -> bool {
        self.touched != 0
    }
}

impl AsperityFinger3D {
    fn contact(&self) -> i64 {
        // Instance ids have their highest bit set for reference-counted objects only; nodes stay
        // positive.
        self.base().instance_id().to_i64() & i64::MAX
    }

    /// The world it touches in: the one that it knows, or, where that was freed, the tree's next
    /// one.
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

    fn touch(&mut self, mut world: Gd<AsperityWorld>, hit: &Hit, delta: f64) {
        let Hit { surface, uv, place, axes } = *hit;
        let contact = self.contact();
        let before = self.last.replace((surface, place)).filter(|(touched, _)| *touched == surface);
        // Over what it touches, from where it was a tick ago.
        let along = before.filter(|_| delta > 0.0).map(|(_, last)| (place - last) / delta as f32);
        let velocity_m_s = along.map_or(NO_VELOCITY, |v| Vector2::new(v.dot(axes[0]), v.dot(axes[1])));
        let builds = world.bind().builds();
        if self.build != builds {
            // Of an engine that is gone nothing is left to be lifted from.
            (self.touched, self.build) = (0, builds);
        }
        let Rolling { slip_m_s, radius_m } = Rolling::NONE;
        if self.touched == surface
            && world.bind_mut().report_move(contact, uv, self.force_n, slip_m_s, radius_m, velocity_m_s)
        {
            return;
        }
        self.lift();
        let (force_n, channel) = (self.force_n, self.channel);
        let begun = world.bind_mut().report_begin(
            contact,
            surface,
            uv,
            force_n,
            channel,
            slip_m_s,
            radius_m,
            velocity_m_s,
            0,
        );
        if begun {
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
    fn hit(&mut self) -> Option<Hit> {
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
        let touched = touched?;
        let surface = touched.bind().surface_id();
        if surface == 0 {
            return None;
        }
        if let Some(drawn) = drawn
            && let Some(hit) = self.on_mesh(&drawn, &touched, surface, point)
        {
            return Some(hit);
        }
        let normal = hit.get("normal")?.try_to::<Vector3>().ok()?;
        let frame = collider.try_cast::<Node3D>().ok()?.get_global_transform().orthonormalized();
        let place = frame.affine_inverse() * point;
        let held = side(frame.basis.transposed() * normal, self.side);
        self.side = Some(held);
        let uv = touched.bind().in_spans(on_side(place, held));
        let axes = [0, 1].map(|k| on_side_axis(held, k));
        Some(Hit { surface, uv, place, axes })
    }

    /// On a mesh that has texture coordinates.
    fn on_mesh(
        &mut self,
        drawn: &Gd<MeshInstance3D>,
        touched: &Gd<AsperityBody>,
        surface: i64,
        point: Vector3,
    ) -> Option<Hit> {
        let mesh = drawn.get_mesh()?;
        if self.mesh.as_ref() != Some(&mesh) {
            self.triangles = Triangles::of(&mesh);
            self.mesh = Some(mesh);
        }
        let frame = drawn.get_global_transform();
        let (uv, axes) = self.triangles.uv_at(frame.affine_inverse() * point)?;
        // In metres: a mesh that is drawn larger is touched over longer ways.
        let scale = frame.basis.get_scale();
        let place = (frame.affine_inverse() * point) * scale;
        let axes = axes.map(|axis| (axis * scale).try_normalized().unwrap_or(Vector3::ZERO));
        Some(Hit { surface, uv: touched.bind().on_maps(uv), place, axes })
    }
}

/// Surface under the finger, its place, and how u and v run there in the space of what is
/// touched, of length 1.
#[derive(Clone, Copy)]
struct Hit {
    surface: i64,
    uv: Vector2,
    place: Vector3,
    axes: [Vector3; 2],
}

/// The direction of u (0) or v (1) on a side.
fn on_side_axis(side: usize, along: usize) -> Vector3 {
    let unit = [Vector3::RIGHT, Vector3::UP, Vector3::BACK];
    let of = |axis: Vector3| if along == 0 { on_side(axis, side).x } else { on_side(axis, side).y };
    unit.into_iter().find(|axis| of(*axis) != 0.0).unwrap_or(Vector3::ZERO)
}
