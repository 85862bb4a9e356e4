#![doc = include_str!("../README.md")]
//!
//! # The map of this crate
//!
//! | file | holds |
//! |---|---|
//! | `plugin` | the plugin, the order of its systems |
//! | `touch` | the game's half as a resource; which entity is which body and surface |
//! | `component` | what entities are: bodies, surfaces, probes, things of a physics engine |
//! | `tip` | a tracked fingertip, on a spring |
//! | `haptics` | a haptic channel on a gamepad and a headset's controller |
//! | `in_step` | observers that keep the scene as the components say |
//! | `event` | messages: contacts in, refusals out |
//! | `output` | where the sound goes |
//! | `null` | the output nobody hears, paced by the app's own time |
//! | `rapier`, `avian` | contacts of a physics engine |
//! | `seedling` | a node of the Firewheel graph |

#[cfg(feature = "avian")]
pub mod avian;
mod component;
mod event;
mod haptics;
mod in_step;
mod null;
mod output;
mod plugin;
#[cfg(feature = "rapier")]
pub mod rapier;
#[cfg(feature = "seedling")]
pub mod seedling;
mod tip;
mod touch;

pub use asperity;
pub use component::{TouchBody, TouchProbe, TouchSurface, TouchThing};
pub use event::{TouchError, TouchEvent};
pub use haptics::{TouchHeadset, TouchRumble};
pub use null::NullOutput;
pub use output::Output;
pub use plugin::{AsperityPlugin, TouchSystems};
pub use tip::TouchTip;
pub use touch::Touch;
