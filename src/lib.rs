//! **asperity** turns touch into signal.
//!
//! A game or VR physics step reports sparse [contact events](ContactEvent); a [`Renderer`] turns them,
//! at audio rate and in hard real time, into what a finger feels (haptic channels) and what the object
//! sounds like (modal audio), from the displacement and roughness maps the scene already has.
//!
//! ```text
//! game thread                         audio thread
//! Scene::report ──► queue ──► path ─► profile ─► micro-contact ─┬─► actuator stage ─► haptic channels
//!                                                               └─► impulses ─► modal bank ─► audio
//! ```

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod actuator_preset;
mod bad_value;
mod body;
pub mod channel_map;
mod clock;
mod config;
pub mod contact_log;
#[cfg(feature = "device")]
pub mod device;
pub mod drift;
mod error;
mod event;
mod governor;
mod inner_rate;
mod material;
mod modal_model;
pub mod null_sink;
mod occupied;
pub mod offline;
mod queue;
mod recording;
mod renderer;
pub mod residual;
mod scene;
mod seat;
mod silence;
mod stats;
mod stroking;
mod surface;
mod tap;
mod uv_triangle;
mod voice;

pub use actuator_preset::{ActuatorPreset, PresetError};
pub use bad_value::BadValue;
pub use clock::ClockMode;
pub use config::{ActuatorSettings, AudioSettings, Config, DeviceProfile, Quantity};
pub use error::{AddError, ConfigError, Refusal, ReportError};
pub use event::{
    Actuator, BodyId, ContactEvent, ContactId, ContactSample, Impact, MAX_FORCE_N, MAX_SPEED_M_S, MAX_UV,
    SurfaceId,
};
pub use material::Material;
pub use modal_model::{MAX_POSITIONS, ModalModel, ModalModelError};
pub use renderer::Renderer;
pub use residual::Residual;
pub use scene::Scene;
pub use silence::SilentBecause;
pub use stats::Stats;
pub use surface::{
    DEFAULT_MICRO_RELIEF_M, DEFAULT_ROUGHNESS, EXCITER_MATERIAL, EXCITER_RADIUS_M, Excitation, Roughness,
    Surface, SurfaceError,
};
pub use tap::{ContactBlock, NoTap, Tap};
pub use uv_triangle::UvTriangle;

pub use asperity_dsp::micro_contact::{Integrator, Probe};
pub use asperity_dsp::modal_bank::Culling;
pub use asperity_dsp::mode::Mode;
pub use asperity_dsp::trajectory::PathMode;
/// Sources of surfaces, and maps.
pub use asperity_texture as texture;
pub use asperity_texture::height_map::Extent;
pub use asperity_texture::wrap::Wrap;
