//! Actuator stage: from the pad's motion in SI units to the samples of one haptic channel.
//!
//! ```text
//! a contact:  pad_m, pad_velocity_m_s → displacement or acceleration → high-pass ─┐
//! a channel:  Σ contacts / full_scale → equaliser → user gain, soft start, mute → limiter → f32
//! ```
//!
//! | step | here |
//! |---|---|
//! | high-pass about the start of the contact | [`ContactOutput`] |
//! | what a fingertip's skin and tissue let through, of an acceleration | [`Skin`] |
//! | device model and its parameters | [`DeviceProfile`], [`DeviceModel`] |
//! | inverse of the device | [`Equaliser`] |
//! | excursion, heat and drive | [`Protection`] |
//! | gains, and all of it in order | [`Channel`] |
//! | peaks of the audio bus | [`PeakLimiter`] |
//!
//! Source: Hasti §III-C streams the pad displacement to the actuator as it is, and §V names the
//! missing compensation of the actuator's response as a limit. We add it. Nothing here looks ahead:
//! latency 0, but for the equaliser's own group delay ([`Channel::group_delay_s`], 0.4 ms for the
//! LRA).

mod channel;
mod contact;
mod device;
mod equaliser;
mod limiter;
mod skin;

pub use channel::{Channel, ChannelControl, ChannelOptions, ChannelState, GAIN_RAMP_S};
pub use contact::{ContactOutput, ContactOutputState, Quantity, RELEASE_S};
pub use device::{DeviceModel, DeviceProfile, DeviceState};
pub use equaliser::{EDGE, Equaliser, EqualiserState};
pub use limiter::{PeakLimiter, PeakLimiterState, Protection, ProtectionState, RELEASE_TIME_S};
pub use skin::{SLIDING_M_S, Skin, SkinState, TISSUE_MASS_KG};
