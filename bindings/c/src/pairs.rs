//! Pairs of colliders: what strikes, slides, rolls and rests, from the arrays of any simulator.

use crate::body::refused;
use crate::entry::{array, enter, out};
use crate::handles::{PAIRS, SCENES, Simulated, asp_pairs, asp_scene};
use crate::material;
use crate::report::refusal;
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, Failure};
use asperity::{BodyId, ChannelId, Material, SurfaceId, UvMapping};
use asperity_pairs::{Collider, Contact, Form, Mat3, Motion, Placed, Probes, Thing, Vec3, World};

/// Form of a collider that does not roll.
pub const ASP_FORM_FLAT: u32 = 0;
/// Sphere.
pub const ASP_FORM_SPHERE: u32 = 1;
/// Capsule along its own z.
pub const ASP_FORM_CAPSULE: u32 = 2;
/// Cylinder along its own z.
pub const ASP_FORM_CYLINDER: u32 = 3;
/// Most colliders of a world.
pub const ASP_MAX_COLLIDERS: u32 = 65536;

/// A collider for its whole life; `asp_collider_init` fills it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_collider {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// Material: ASP_MATERIAL_…
    pub material: u32,
    /// ASP_FORM_…
    pub form: u32,
    /// The haptic channel that feels it; −1 = nobody.
    pub actuator: i32,
    /// Body that it rings as; 0 = none.
    pub body: u64,
    /// Surface that others scrape on it; 0 = none.
    pub surface: u64,
    /// Width and height of that surface, m.
    pub surface_m: [f64; 2],
    /// Mass, kg; INFINITY for what nothing moves.
    pub mass_kg: f64,
    /// Radius of a sphere or a capsule, m.
    pub radius_m: f64,
}

sized!(asp_collider, |zeroed| Self { actuator: -1, surface_m: [1.0; 2], mass_kg: f64::INFINITY, ..zeroed });

/// Place and motion of a collider after a step.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_placed {
    /// Origin of its own space, m.
    pub place_m: [f64; 3],
    /// Turn from its own space to the world's, row by row.
    pub rotation: [f64; 9],
    /// Velocity of that origin, m/s.
    pub velocity_m_s: [f64; 3],
    /// rad/s.
    pub angular_velocity_rad_s: [f64; 3],
}

/// A point at which two colliders press.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_touch {
    /// The two, by the order in which they were added.
    pub colliders: [u32; 2],
    /// Place, m.
    pub point_m: [f64; 3],
    /// Direction from the first to the second.
    pub normal: [f64; 3],
    /// Along the normal, N.
    pub force_n: f64,
    /// Rebound over approach speed, 0 to 1.
    pub restitution: f64,
}

fn refuse(what: impl Into<String>) -> Failure {
    Failure::new(ASP_BAD_ARGUMENT, what.into())
}

fn space(v: [f64; 3]) -> Vec3 {
    Vec3::from_array(v.map(|x| x as f32))
}

impl asp_collider {
    fn engines(&self) -> Result<Collider, Failure> {
        let form = match self.form {
            ASP_FORM_FLAT => Form::Flat,
            ASP_FORM_SPHERE => Form::Sphere(self.radius_m),
            ASP_FORM_CAPSULE => Form::Capsule(self.radius_m),
            ASP_FORM_CYLINDER => Form::Cylinder,
            other => return Err(refuse(format!("form: {other} is refused; must be ASP_FORM_…"))),
        };
        if !(self.mass_kg > 0.0 && self.radius_m >= 0.0 && self.surface_m.iter().all(|m| *m > 0.0)) {
            return Err(refuse("mass_kg, radius_m, surface_m: are refused; must be above 0"));
        }
        let thing = Thing {
            material: material::material(self.material)?.unwrap_or(Material::PLA),
            body: Some(self.body).filter(|id| *id != 0).map(BodyId::from_bits),
            surface: Some(self.surface).filter(|id| *id != 0).map(SurfaceId::from_bits),
            actuator: u16::try_from(self.actuator).ok().map(ChannelId),
            probe: None,
        };
        let mapping = thing.surface.map(|_| UvMapping::ByNormal { span_m: self.surface_m });
        let mobility_per_kg = (1.0 / self.mass_kg) as f32;
        Ok(Collider { thing, mobility_per_kg, form, radius_m: None, mapping })
    }
}

impl asp_placed {
    fn engines(&self) -> Placed {
        let place_m = space(self.place_m);
        let motion = Motion {
            linear_m_s: space(self.velocity_m_s),
            angular_rad_s: space(self.angular_velocity_rad_s),
            centre_m: place_m,
        };
        // Rows are columns of the transposed matrix.
        let turn = Mat3::from_cols_array(&self.rotation.map(|x| x as f32)).transpose();
        Placed { place_m, turn, motion }
    }

    fn is_finite(&self) -> bool {
        let all = self.place_m.iter().chain(&self.rotation).chain(&self.velocity_m_s);
        all.chain(&self.angular_velocity_rad_s).all(|x| x.is_finite())
    }
}

/// Fills a collider with its size and the defaults: it rings as nothing, has no surface, and
/// nothing moves it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_collider_init(collider: *mut asp_collider) {
    sized::init(collider);
}

/// Makes an empty world of pairs for a scene, before its surfaces are added: what touches them
/// rides them with probes of its own.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pairs_new(scene: *mut asp_scene, pairs: *mut *mut asp_pairs) -> i32 {
    enter(|| {
        let pairs = out(pairs, "pairs")?;
        *pairs = std::ptr::null_mut();
        let mut half = SCENES.hold(scene as usize)?;
        let probes = Probes::add(&mut half.scene).map_err(|error| refused(&error))?;
        let simulated = Simulated { world: World::default(), probes, colliders: Vec::new(), last_s: None };
        *pairs = PAIRS.insert(simulated)? as *mut asp_pairs;
        Ok(())
    })
}

/// Adds a collider; `index` is its number in `asp_touch` and its place among `asp_placed`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pairs_add(
    pairs: *mut asp_pairs,
    collider: *const asp_collider,
    index: *mut u32,
) -> i32 {
    enter(|| {
        let (collider, index) = (sized::read(collider, "collider")?.engines()?, out(index, "index")?);
        let mut held = PAIRS.hold(pairs as usize)?;
        if held.colliders.len() >= ASP_MAX_COLLIDERS as usize {
            return Err(refuse(format!("collider: {ASP_MAX_COLLIDERS} are there already; add no more")));
        }
        *index = held.colliders.len() as u32;
        held.colliders.push(Some(collider));
        Ok(())
    })
}

/// Takes a step of a simulator and reports to the scene, at game time `time_s`, what strikes,
/// slides, rolls, rests and leaves: `placed` has an entry for each collider, `touches` one for each
/// point of contact. Times grow; a step that is refused for its numbers was not taken. `events`
/// (may be NULL) is how many were accepted, and the first refusal by the scene is the status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pairs_step(
    pairs: *mut asp_pairs,
    scene: *mut asp_scene,
    time_s: f64,
    step_s: f64,
    placed: *const asp_placed,
    touches: *const asp_touch,
    count: u32,
    events: *mut u32,
) -> i32 {
    enter(|| {
        let mut none = 0;
        let taken = if events.is_null() { &mut none } else { out(events, "events")? };
        *taken = 0;
        let mut held = PAIRS.hold(pairs as usize)?;
        let Simulated { world, probes, colliders, last_s } = &mut *held;
        let most = ASP_MAX_COLLIDERS as usize;
        let placed = array(placed, colliders.len(), most, "placed")?;
        let touches = array(touches, count as usize, most, "touches")?;
        if !(time_s.is_finite() && last_s.is_none_or(|last_s| time_s > last_s)) {
            return Err(refuse(format!("time_s: {time_s} is refused; must grow from step to step")));
        }
        if !(step_s > 0.0 && step_s.is_finite()) {
            return Err(refuse(format!("step_s: {step_s} is refused; must be above 0")));
        }
        if let Some(at) = placed.iter().position(|placed| !placed.is_finite()) {
            return Err(refuse(format!("placed {at}: is not finite; must be numbers")));
        }
        let is_known = |touch: &asp_touch| {
            let all = touch.point_m.iter().chain(&touch.normal).chain([&touch.force_n, &touch.restitution]);
            touch.colliders.iter().all(|index| (*index as usize) < placed.len())
                && all.into_iter().all(|x| x.is_finite())
        };
        if let Some(at) = touches.iter().position(|touch| !is_known(touch)) {
            let right = "must name two colliders and have numbers that are finite";
            return Err(refuse(format!("touch {at}: is refused; {right}")));
        }
        let placed: Vec<Placed> = placed.iter().map(asp_placed::engines).collect();
        let contact = |touch: &asp_touch| Contact {
            colliders: touch.colliders,
            point_m: space(touch.point_m),
            normal: space(touch.normal),
            force_n: touch.force_n as f32,
            restitution: touch.restitution as f32,
        };
        let mut contacts: Vec<Contact> = touches.iter().map(contact).collect();
        let mut half = SCENES.hold(scene as usize)?;
        *last_s = Some(time_s);
        let mut reported = Vec::new();
        world.step((colliders, &placed), &mut contacts, (*probes, step_s as f32), &mut reported);
        let mut first = None;
        for (at, event) in (0..).zip(reported) {
            match half.scene.report(time_s, event) {
                Ok(()) => *taken += 1,
                Err(error) => drop(first.get_or_insert_with(|| refusal(at, &error.reason))),
            }
        }
        first.map_or(Ok(()), Err)
    })
}
