//! Pickups: what an accelerometer or a contact microphone on a body reads.

use crate::body::refused;
use crate::config::{ASP_MAX_BUSES, ASP_MAX_CHANNELS, CHUNK_FRAMES};
use crate::entry::{enter, out};
use crate::handles::{RENDERERS, SCENES, asp_renderer, asp_scene};
use crate::render::{Planes, moved, render_planes};
use crate::report::refusal;
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, Failure};
use asperity::{BodyId, ContactEvent, Pickup, PickupQuantity, RigidMotion};

/// A pickup reads m/s², with what the body does as a whole.
pub const ASP_PICKUP_ACCELERATION: u32 = 0;
/// A pickup reads m/s, of the vibration.
pub const ASP_PICKUP_VELOCITY: u32 = 1;
/// A pickup reads m, of the vibration.
pub const ASP_PICKUP_DISPLACEMENT: u32 = 2;
/// Most channels of pickups of an engine that is built or loaded here.
pub const ASP_MAX_PICKUPS: u32 = 64;

/// A pickup; `asp_pickup_init` fills it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_pickup {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// Channel that it is read on, from 0; those of one channel add up.
    pub channel: u32,
    /// ASP_PICKUP_…
    pub quantity: u32,
    /// 0.
    pub reserved: u32,
    /// Place on a body that has shapes, m in its frame, at most 1 % of its size off its surface; on
    /// another the arm of its rigid motion. NAN = none.
    pub at_m: [f64; 3],
    /// Along what it reads, in the body's frame; NAN = the outward normal.
    pub direction: [f64; 3],
    /// On a body of known mass without shapes, how much it moves with every mode, −1 to 1: 1 as
    /// where that swings most. NAN = at a place.
    pub factor: f64,
}

sized!(asp_pickup, |zeroed| Self {
    at_m: [f64::NAN; 3],
    direction: [f64::NAN; 3],
    factor: f64::NAN,
    ..zeroed
});

/// Motion of a body as a whole at an instant, in its own axes.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_motion {
    /// Acceleration of its centre, m/s².
    pub acceleration_m_s2: [f64; 3],
    /// Gravity, m/s².
    pub gravity_m_s2: [f64; 3],
    /// rad/s.
    pub angular_velocity_rad_s: [f64; 3],
    /// Centre that the acceleration belongs to, m.
    pub centre_m: [f64; 3],
}

impl asp_pickup {
    fn engines(&self) -> Result<Pickup, Failure> {
        let Some((_, quantity)) = PickupQuantity::ALL.get(self.quantity as usize) else {
            let right = "must be ASP_PICKUP_ACCELERATION, ASP_PICKUP_VELOCITY or ASP_PICKUP_DISPLACEMENT";
            let what = format!("quantity: {} is refused; {right}", self.quantity);
            return Err(Failure::new(ASP_BAD_ARGUMENT, what));
        };
        let all = |v: [f64; 3]| Some(v).filter(|v| !v.iter().all(|x| x.is_nan()));
        let mut pickup = Pickup::at_share(1.0).reading(*quantity).on_channel(self.channel as usize);
        (pickup.at_m, pickup.direction) = (all(self.at_m), all(self.direction));
        pickup.factor = Some(self.factor).filter(|factor| !factor.is_nan());
        Ok(pickup)
    }
}

/// Fills a pickup with its size and the defaults: the acceleration along the outward normal, on
/// channel 0, at a place that has to be told, or with a factor.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pickup_init(pickup: *mut asp_pickup) {
    sized::init(pickup);
}

/// Puts a pickup on a body; `asp_config.pickup_channels` says how many channels there are. What the
/// body rings rings out unread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pickup_add(scene: *mut asp_scene, body: u64, pickup: *const asp_pickup) -> i32 {
    enter(|| {
        let pickup = sized::read(pickup, "pickup")?.engines()?;
        let mut half = SCENES.hold(scene as usize)?;
        half.scene.add_pickup(BodyId::from_bits(body), pickup).map_err(|error| refused(&error))
    })
}

/// Reports at game time `time_s` how a body moves as a whole: its accelerometers read it from then
/// on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pickup_motion(
    scene: *mut asp_scene,
    time_s: f64,
    body: u64,
    motion: *const asp_motion,
) -> i32 {
    enter(|| {
        let given = *out(motion.cast_mut(), "motion")?;
        let motion = RigidMotion {
            acceleration_m_s2: given.acceleration_m_s2,
            gravity_m_s2: given.gravity_m_s2,
            angular_velocity_rad_s: given.angular_velocity_rad_s,
            centre_m: given.centre_m,
        };
        let event = ContactEvent::Motion { body: BodyId::from_bits(body), motion };
        let mut half = SCENES.hold(scene as usize)?;
        half.scene.report(time_s, event).map_err(|error| refusal(0, &error.reason))
    })
}

/// Number of a renderer's channels of pickups; they lag as sound does (`asp_signals`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pickup_channels(renderer: *mut asp_renderer, channels: *mut u32) -> i32 {
    enter(|| {
        let (channels, half) = (out(channels, "channels")?, RENDERERS.hold(renderer as usize)?);
        *channels = half.renderer.as_ref().ok_or_else(moved)?.pickup_channels() as u32;
        Ok(())
    })
}

/// `asp_render`, and what the pickups read of the same frames: channel i into `pickups[i]`, in
/// m/s², m/s or m, behind a sensor in volts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_pickup_render(
    renderer: *mut asp_renderer,
    haptic: *const *mut f32,
    haptic_channels: u32,
    audio: *const *mut f32,
    audio_buses: u32,
    pickups: *const *mut f32,
    pickup_channels: u32,
    frames: u32,
) {
    let counts = [(haptic_channels, ASP_MAX_CHANNELS), (audio_buses, ASP_MAX_BUSES)];
    let counts = counts.into_iter().chain([(pickup_channels, ASP_MAX_PICKUPS)]);
    if counts.into_iter().all(|(count, most)| count <= most) {
        let planes = [(haptic, haptic_channels), (audio, audio_buses), (pickups, pickup_channels)];
        render_planes(renderer, planes.map(|(first, count)| Planes::new(first, count)), frames);
    }
}

/// Memory of a renderer's pickups.
pub(crate) fn memory(renderer: &asperity::Renderer) -> Vec<Vec<f32>> {
    vec![vec![0.0; CHUNK_FRAMES]; renderer.pickup_channels()]
}
