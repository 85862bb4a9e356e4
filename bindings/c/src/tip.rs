//! Tracked tips: the pose of a fingertip becomes an event that the scene takes.

use crate::body::refused;
use crate::entry::{array, enter, out};
use crate::event::{ASP_BEGIN, ASP_END, ASP_MOVE, asp_event};
use crate::handles::{SCENES, TIPS, TrackedTip, asp_scene, asp_tip};
use crate::sized::{self, Sized32};
use crate::status::{ASP_REFUSED, Failure};
use asperity::{ContactSample, SurfaceId, Tip, TipCoupling, TipStep};

/// Most surfaces of a tip.
const MAX_SURFACES: usize = 65_536;

fn refuse(error: asperity::BadValue) -> Failure {
    Failure::new(ASP_REFUSED, error)
}

impl TrackedTip {
    fn event(&self, step: TipStep, contact: u64, actuator: i32) -> asp_event {
        let event = asp_event { contact, ..asp_event::initial() };
        let sampled = |kind, sample: ContactSample| asp_event {
            kind,
            uv: sample.uv,
            velocity_m_s: sample.velocity_m_s.unwrap_or([f64::NAN; 2]),
            normal_force_n: sample.normal_force_n,
            closing_m_s: sample.closing_m_s,
            ..event
        };
        match step {
            TipStep::Free => event,
            TipStep::Begin(index, sample) => {
                asp_event { surface: self.surfaces[index].to_bits(), actuator, ..sampled(ASP_BEGIN, sample) }
            }
            TipStep::Move(_, sample) => sampled(ASP_MOVE, sample),
            TipStep::End(_) => asp_event { kind: ASP_END, ..event },
        }
    }
}

/// Makes a tracked tip over `count` surfaces that have a frame (`frame` of `asp_surface.table`); a
/// hand has one for each finger. `stiffness_n_m`: force over depth, 1 to 1e5, NAN = 200; `mass_kg`:
/// of the proxy that follows along the surface, 1e-3 to 10, NAN = 0.1; `max_force_n`: 1e-3 to 1000,
/// NAN = 5.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_tip_new(
    scene: *mut asp_scene,
    surfaces: *const u64,
    count: u32,
    stiffness_n_m: f64,
    mass_kg: f64,
    max_force_n: f64,
    tip: *mut *mut asp_tip,
) -> i32 {
    enter(|| {
        let tip = out(tip, "tip")?;
        *tip = std::ptr::null_mut();
        let ids = array(surfaces, count as usize, MAX_SURFACES, "surfaces")?;
        let surfaces: Vec<SurfaceId> = ids.iter().map(|id| SurfaceId::from_bits(*id)).collect();
        let half = SCENES.hold(scene as usize)?;
        let rectangles = half.scene.tip_surfaces(&surfaces).map_err(|error| refused(&error))?;
        let mut coupling = TipCoupling::default();
        let or_usual = |number: f64, usual: f64| if number.is_nan() { usual } else { number };
        coupling.stiffness_n_m = or_usual(stiffness_n_m, coupling.stiffness_n_m);
        coupling.mass_kg = or_usual(mass_kg, coupling.mass_kg);
        coupling.max_force_n = or_usual(max_force_n, coupling.max_force_n);
        let made = Tip::new(rectangles, coupling).map_err(refuse)?;
        *tip = TIPS.insert(TrackedTip { tip: made, surfaces })? as *mut asp_tip;
        Ok(())
    })
}

/// Moves a tip to `position_m` (x, y, z in the axes of the surfaces' body), `dt_s` after its last
/// step, and fills `event` for `asp_report`: a begin, move or end of `contact`, felt by haptic
/// channel `actuator`; of kind 0 where nothing is touched.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_tip_step(
    tip: *mut asp_tip,
    dt_s: f64,
    position_m: *const f64,
    contact: u64,
    actuator: i32,
    event: *mut asp_event,
) -> i32 {
    enter(|| {
        let position_m = array(position_m, 3, 3, "position_m")?;
        let mut held = TIPS.hold(tip as usize)?;
        let step = held.tip.step(dt_s, [position_m[0], position_m[1], position_m[2]]).map_err(refuse)?;
        sized::write(&held.event(step, contact, actuator), event, "event")
    })
}

/// Ends what a tip touches, because the game has moved the hand elsewhere: fills `event` with the
/// end of `contact`, or with kind 0. The next step starts anew.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_tip_lift(tip: *mut asp_tip, contact: u64, event: *mut asp_event) -> i32 {
    enter(|| {
        let mut held = TIPS.hold(tip as usize)?;
        let step = held.tip.lift();
        sized::write(&held.event(step, contact, -1), event, "event")
    })
}
