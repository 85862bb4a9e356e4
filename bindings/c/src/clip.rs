//! Authored clips on haptic channels.

use crate::entry::{array, enter};
use crate::handles::{SCENES, asp_scene};
use crate::status::{ASP_FULL, ASP_REFUSED, ASP_UNKNOWN, Failure};
use asperity::{ChannelId, Clip, Refusal};

/// Most samples of a clip.
pub const ASP_MAX_CLIP_SAMPLES: u32 = 1 << 26;

/// Plays a clip on a haptic channel from game time `time_s` on: `count` samples at `rate_hz`, 1 =
/// the channel's full scale, times `gain`; strokes and blows have the gain `ducking` (0 to 1)
/// meanwhile. It is added before the user's gain, the equaliser and the limiters; its ends are
/// faded over 2 ms. 32 play at once, more are dropped. The samples are copied.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments, reason = "a struct of them would have to be filled")]
pub unsafe extern "C" fn asp_play_clip(
    scene: *mut asp_scene,
    time_s: f64,
    channel: u32,
    samples: *const f32,
    count: u32,
    rate_hz: f64,
    gain: f64,
    ducking: f64,
) -> i32 {
    enter(|| {
        let samples = array(samples, count as usize, ASP_MAX_CLIP_SAMPLES as usize, "samples")?.to_vec();
        let clip = Clip { samples, rate_hz, gain, ducking };
        let channel = ChannelId(u16::try_from(channel).unwrap_or(u16::MAX));
        let mut half = SCENES.hold(scene as usize)?;
        half.scene.play_clip(time_s, channel, &clip).map_err(|reason| {
            let status = match reason {
                Refusal::QueueFull => ASP_FULL,
                Refusal::UnknownActuator { .. } => ASP_UNKNOWN,
                _ => ASP_REFUSED,
            };
            Failure::new(status, reason.to_string())
        })
    })
}
