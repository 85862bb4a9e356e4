//! From rapier's contact pairs to contact events.
//!
//! | what asperity wants | where rapier has it | the trap |
//! |---|---|---|
//! | landing, lift-off | impulse of the pair: 0 → positive → 0 | `Started` comes up to 2 cm early, and a low bounce has neither event |
//! | closing speed | velocity before the step, plus gravity's share | after the step it is the rebound |
//! | normal force | Σ impulse / step over `solver_manifolds()` | the impulses of `manifolds()` are 0 on a mesh |
//! | contact point | impulse-weighted mean of the points on the mesh's side | with `contact_recycling` it stands still; a plain mean jumps |
//! | uv | triangle and barycentric weights | points belong to the step's start, velocities to its end |

use crate::mesh::UvMesh;
use asperity::{Actuator, BodyId, ContactEvent, ContactId, ContactSample, Impact, Material, SurfaceId};
use rapier3d::prelude::*;

/// Slower landings are rest, not impacts, m/s.
const QUIET_LANDING_M_S: f32 = 0.02;
/// Impacts of one body closer together are the solver's, s.
const REFRACTORY_S: f64 = 0.03;
/// Share by which the integrated point is pulled to the reported one in each step.
const PULL: f32 = 0.3;
/// Beyond this the reported point is right, m.
const TELEPORT_M: f32 = 0.01;

/// What a body does to the mesh it touches.
pub enum Touch {
    /// It strikes: each landing is an impact.
    Strikes { radius_m: f64, material: Material },
    /// It slides, and this actuator feels it.
    Slides { actuator: Actuator },
}

/// A body whose contacts are reported.
pub struct Toucher {
    pub id: ContactId,
    pub body: RigidBodyHandle,
    pub collider: ColliderHandle,
    pub touch: Touch,
    point: Option<Vector>,
    closing_m_s: f32,
    last_impact_s: f64,
}

/// The mesh and what it is to asperity.
pub struct Ground {
    pub collider: ColliderHandle,
    pub mesh: UvMesh,
    pub surface: SurfaceId,
    pub body: BodyId,
}

/// One contact as the solver left it, in the mesh's space.
struct Solved {
    point: Vector,
    force_n: f32,
}

impl Toucher {
    pub fn new(id: u64, (body, collider): (RigidBodyHandle, ColliderHandle), touch: Touch) -> Self {
        let last_impact_s = f64::NEG_INFINITY;
        Self { id: ContactId(id), body, collider, touch, point: None, closing_m_s: 0.0, last_impact_s }
    }

    /// Before the step: how fast it approaches.
    pub fn before_step(&mut self, world: &PhysicsWorld) {
        let step_s = world.integration_parameters.dt;
        let falling = world.bodies[self.body].linvel() + world.gravity * step_s;
        self.closing_m_s = (-falling.y).max(0.0);
    }

    /// After the step: what happened.
    pub fn after_step(&mut self, world: &PhysicsWorld, ground: &Ground, time_s: f64) -> Option<ContactEvent> {
        let Some(solved) = solved(world, ground.collider, self.collider) else {
            let was = self.point.take();
            return (was.is_some() && self.slides()).then(|| ContactEvent::end(self.id));
        };
        let shape = world.colliders[ground.collider].shape().as_trimesh()?;
        let velocity = world.bodies[self.body].velocity_at_point(solved.point);
        let landed = self.point.is_none();
        let point = self.follow(&solved, velocity * world.integration_parameters.dt);
        let triangle = ground.mesh.triangle_at(shape, point)?;
        match self.touch {
            Touch::Strikes { radius_m, material } => {
                let rested = time_s - self.last_impact_s >= REFRACTORY_S;
                (landed && rested && self.closing_m_s > QUIET_LANDING_M_S).then(|| {
                    self.last_impact_s = time_s;
                    ContactEvent::Impact(Impact {
                        speed_m_s: f64::from(self.closing_m_s),
                        mass_kg: f64::from(world.bodies[self.body].mass()),
                        radius_m,
                        striker: material,
                        restitution: f64::from(world.colliders[self.collider].restitution()),
                        ..Impact::on(ground.body)
                    })
                })
            }
            Touch::Slides { actuator } => {
                let sample = ContactSample {
                    closing_m_s: if landed { f64::from(self.closing_m_s) } else { 0.0 },
                    ..triangle.sample(point, velocity, f64::from(solved.force_n))
                };
                Some(if landed {
                    ContactEvent::begin(self.id, ground.surface, actuator, sample)
                } else {
                    ContactEvent::moved(self.id, sample)
                })
            }
        }
    }

    fn slides(&self) -> bool {
        matches!(self.touch, Touch::Slides { .. })
    }

    /// The slip is integrated and pulled gently to where the solver says, because its point belongs to
    /// the start of the step and jumps as points come and go.
    fn follow(&mut self, solved: &Solved, slip: Vector) -> Vector {
        let point = match self.point {
            Some(point) if (solved.point - point).length() < TELEPORT_M => {
                let moved = point + slip;
                moved + (solved.point + slip - moved) * PULL
            }
            _ => solved.point,
        };
        self.point = Some(point);
        point
    }
}

/// The impulse-weighted contact of a pair; `None` when nothing presses. The mesh does not move here, so
/// its space is the world's.
fn solved(world: &PhysicsWorld, mesh: ColliderHandle, other: ColliderHandle) -> Option<Solved> {
    let pair = world.contact_pair(mesh, other)?;
    let mesh_is_first = pair.collider1 == mesh;
    let (mut point, mut impulse) = (Vector::ZERO, 0.0);
    for contact in pair.solver_manifolds().iter().flat_map(|manifold| &manifold.points) {
        let local = if mesh_is_first { contact.local_p1 } else { contact.local_p2 };
        point += local * contact.data.impulse;
        impulse += contact.data.impulse;
    }
    (impulse > 0.0)
        .then(|| Solved { point: point / impulse, force_n: impulse / world.integration_parameters.dt })
}
