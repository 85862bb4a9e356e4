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

mod audio;
mod engine;
pub mod files;
mod game;
mod link;
pub mod live;
mod model;
pub mod offline;
mod prepared;

pub use asperity_dsp::limits;
pub use audio::renderer::Renderer;
pub use audio::tap::{ContactBlock, NoTap, Tap};
pub use engine::Engine;
pub use files::actuator_profile::{ActuatorPreset, PresetError};
pub use game::scene::Scene;
pub use game::silence::SilentBecause;
pub use link::stats::Stats;
pub use model::actuator::{ActuatorSettings, DeviceProfile, Quantity};
pub use model::bad_value::BadValue;
pub use model::bus::AudioSettings;
pub use model::clock_mode::ClockMode;
pub use model::config::Config;
pub use model::error::{AddError, ConfigError, Refusal, ReportError};
pub use model::event::{
    Actuator, BodyId, ContactEvent, ContactId, ContactSample, Impact, MAX_FORCE_N, MAX_SPEED_M_S, MAX_UV,
    SurfaceId,
};
pub use model::material::Material;
pub use model::modal_model::{MAX_POSITIONS, ModalModel, ModalModelError};
pub use model::residual::{LONGEST_S as LONGEST_RESIDUAL_S, Residual};
pub use model::surface::{
    DEFAULT_MICRO_RELIEF_M, DEFAULT_ROUGHNESS, EXCITER_MATERIAL, EXCITER_RADIUS_M, Excitation, Roughness,
    Surface, SurfaceError,
};
pub use model::uv_triangle::UvTriangle;

pub use asperity_dsp::micro_contact::{Integrator, Probe};
pub use asperity_dsp::modal_bank::Culling;
pub use asperity_dsp::mode::Mode;
pub use asperity_dsp::trajectory::PathMode;
/// Sources of surfaces, and maps.
pub use asperity_texture as texture;
pub use asperity_texture::height_map::Extent;
pub use asperity_texture::wrap::Wrap;
