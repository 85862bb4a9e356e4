//! Levels: gains, mute, pause, and an end to everything.

use crate::body::refused;
use crate::entry::{enter, out};
use crate::handles::{SCENES, asp_scene};
use crate::status::{ASP_BAD_ARGUMENT, ASP_UNKNOWN, Failure};
use asperity::{AddError, BodyId, BusId, ChannelId, Scene};

/// Metres, or metres a second squared, at sample value 1.0 of a haptic channel; of: the channel.
pub const ASP_LEVEL_FULL_SCALE: u32 = 1;
/// Linear gain of an audio bus; of: the bus.
pub const ASP_LEVEL_BUS_GAIN: u32 = 2;
/// Linear gain of impacts beside strokes; of: the body's id.
pub const ASP_LEVEL_STRIKE_GAIN: u32 = 3;

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
        half.scene.set_haptic_gain(ChannelId(channel), gain).map_err(|error| refused(&error))
    })
}

/// The gain of an audio bus, 0 to 1e6.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_bus_gain(scene: *mut asp_scene, bus: u32, gain: f64) -> i32 {
    set(scene, |scene| scene.set_audio_gain(BusId(bus as usize), gain))
}

/// All that is felt and heard fades within 20 ms (not 0), or comes back (0); everything goes on
/// meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_muted(scene: *mut asp_scene, muted: u32) -> i32 {
    set(scene, |scene| scene.set_muted(muted != 0))
}

/// The game stands still (not 0): contacts wait, however long. Or it goes on (0).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_paused(scene: *mut asp_scene, paused: u32) -> i32 {
    set(scene, |scene| if paused == 0 { scene.resume() } else { scene.pause() })
}

/// Every contact ends and what rings is damped within a tenth of a second: for a cut, a menu, the
/// end of a level.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_fade_all(scene: *mut asp_scene) -> i32 {
    set(scene, Scene::fade_all)
}

/// A level in use, whether the program, the scene file or the level policy has said it: ASP_LEVEL_…
/// `of` says of what.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_get_level(scene: *mut asp_scene, kind: u32, of: u64, level: *mut f64) -> i32 {
    enter(|| {
        let level = out(level, "level")?;
        let half = SCENES.hold(scene as usize)?;
        let (config, place) = (half.scene.config(), usize::try_from(of).unwrap_or(usize::MAX));
        let unknown = |what: &str, count: usize| {
            Failure::new(ASP_UNKNOWN, format!("of: {of} is no {what} of this scene; must be below {count}"))
        };
        *level = match kind {
            ASP_LEVEL_FULL_SCALE => {
                let settings = config.actuators.get(place);
                settings.ok_or_else(|| unknown("haptic channel", config.actuators.len()))?.full_scale
            }
            ASP_LEVEL_BUS_GAIN => {
                config.audio.get(place).ok_or_else(|| unknown("audio bus", config.audio.len()))?.gain
            }
            ASP_LEVEL_STRIKE_GAIN => {
                half.scene.strike_gain_of(BodyId::from_bits(of)).map_err(|error| refused(&error))?
            }
            other => {
                let right = "must be ASP_LEVEL_FULL_SCALE, ASP_LEVEL_BUS_GAIN or ASP_LEVEL_STRIKE_GAIN";
                return Err(Failure::new(ASP_BAD_ARGUMENT, format!("kind: {other} is refused; {right}")));
            }
        };
        Ok(())
    })
}
