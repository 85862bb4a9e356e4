//! Levels: gains, mute, pause, and an end to everything.

use crate::body::refused;
use crate::entry::enter;
use crate::handles::{SCENES, asp_scene};
use crate::status::{ASP_UNKNOWN, Failure};
use asperity::{Actuator, AddError, Scene};

fn set(scene: *mut asp_scene, set: impl FnOnce(&mut Scene) -> Result<(), AddError>) -> i32 {
    enter(|| set(&mut SCENES.hold(scene as usize)?.scene).map_err(|error| refused(&error)))
}

/// The user's gain of a haptic channel, 0 (mute) to 10.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_haptic_gain(scene: *mut asp_scene, channel: u32, gain: f64) -> i32 {
    enter(|| {
        let channel = u16::try_from(channel).map_err(|_| {
            let what = format!("channel: {channel} is not in this scene");
            Failure::new(ASP_UNKNOWN, format!("{what}; must be below the number of haptic channels"))
        })?;
        let mut half = SCENES.hold(scene as usize)?;
        half.scene.set_haptic_gain(Actuator(channel), gain).map_err(|error| refused(&error))
    })
}

/// The gain of an audio bus, 0 to 1e6.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_bus_gain(scene: *mut asp_scene, bus: u32, gain: f64) -> i32 {
    set(scene, |scene| scene.set_audio_gain(bus as usize, gain))
}

/// All that is felt and heard fades within 20 ms (not 0), or comes back (0); everything goes on meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_muted(scene: *mut asp_scene, muted: u32) -> i32 {
    set(scene, |scene| scene.set_muted(muted != 0))
}

/// The game stands still (not 0): contacts wait, however long. Or it goes on (0).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_paused(scene: *mut asp_scene, paused: u32) -> i32 {
    set(scene, |scene| if paused == 0 { scene.resume() } else { scene.pause() })
}

/// Every contact ends and what rings is damped within a tenth of a second: for a cut, a menu, the end of a level.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_fade_all(scene: *mut asp_scene) -> i32 {
    set(scene, Scene::fade_all)
}
