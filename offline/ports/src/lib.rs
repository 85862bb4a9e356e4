//! From a vibration to what hardware plays, and back.
//!
//! A phone, a headset, a pad plays no 44.1 kHz displacement: it wants points of an envelope, two
//! motor levels, or a waveform at a rate of its own. Everything here is a pure function; the engine
//! does not depend on it.
//!
//! | file | what |
//! |---|---|
//! | [`reduction`] | samples → [`clip::Clip`]: the closed loop through the device's own renderer |
//! | [`score`] | how far what is left lies from what was |
//! | [`felt`] | the detection threshold that both weigh by |
//! | [`oscillator`] | a clip → samples, as a device plays it |
//! | [`device`], [`acf`] | what a port has to know of the hardware |
//! | [`haptic_file`] | `.haptic` 1.0 |
//! | [`ahap`] | AHAP of Core Haptics |
//! | [`hjif`], [`keyframes`] | `.hjif` of ISO/IEC 23090-31: one curve that keeps the waveform |
//! | [`android`] | waveform and envelopes of Android's vibrator |
//! | [`xr`] | parametric frames of OpenXR |
//! | [`dualsense`] | four channels by cable, packets by air |
//! | [`rumble`] | two motor levels |
//! | [`resample`] | another rate, not a sample late |
//!
//! Nothing here has been felt by anybody: what was checked, and by whom, stands in `docs/ports.md`.

pub mod acf;
pub mod ahap;
mod ahap_reader;
pub mod android;
pub mod clip;
pub mod device;
pub mod dualsense;
mod error;
pub mod felt;
pub mod haptic_file;
pub mod hjif;
mod json5_text;
pub mod keyframes;
mod nodes;
pub mod oscillator;
mod profile_file;
pub mod reduction;
pub mod resample;
pub mod rumble;
pub mod score;
mod thinning;
mod tone_track;
mod track;
mod wave_track;
pub mod xr;

pub use clip::{AmplitudePoint, Clip, Emphasis, FrequencyPoint, Read};
pub use device::Device;
pub use error::PortError;
