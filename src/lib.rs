//! **asperity** turns touch into signal.
//!
//! A game or VR physics step reports sparse [contact events](ContactEvent); a [`Renderer`] turns
//! them, at audio rate and in hard real time, into what a finger feels (haptic channels) and what
//! the object sounds like (modal audio), from the displacement and roughness maps the scene already
//! has.
//!
//! ```text
//! game thread                         audio thread
//! Scene::report ──► queue ──► path ─► profile ─► micro-contact ─┬─► actuator stage ─► haptic channels
//!                                                               └─► impulses ─► modal bank ─► audio buses
//! ```
//!
//! ```
//! use asperity::surface::height_map::HeightMap;
//! use asperity::{
//!     ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Extent, ModalModel, Mode, Surface,
//! };
//!
//! let Engine { mut scene, mut renderer, .. } = Config::live(48_000.0).build()?;
//!
//! // What is there: a body that rings, and a plate on it that is touched.
//! let mode = Mode { frequency_hz: 812.0, decay_per_s: 12.0, amplitude: 0.3, phase_rad: 0.0 };
//! let body = scene.add_body(ModalModel::new(vec![mode], 0.01)?)?;
//! let extent = Extent { width_m: 0.14, height_m: 0.14, relief_m: 0.0 };
//! let plate = scene.add_surface(Surface::new(HeightMap::flat(extent, 0.8)?, 0.14, 0.14)?.body(body))?;
//!
//! // Every physics step, on the game thread.
//! let sample =
//!     ContactSample { uv: [0.3, 0.5], velocity_m_s: Some([0.1, 0.0]), normal_force_n: 0.6, closing_m_s: 0.02, ..ContactSample::default() };
//! scene.report(0.0, ContactEvent::begin(ContactId(1), plate, ChannelId(0), sample))?;
//!
//! // Every audio callback, on the audio thread.
//! let (mut haptic, mut audio) = ([0.0f32; 256], [0.0f32; 256]);
//! renderer.render(&mut [&mut haptic], &mut [&mut audio]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where to begin
//!
//! | you have | begin with |
//! |---|---|
//! | a game loop | [`Config::live`], [`Scene::report`], [`Renderer::render`] |
//! | a scene file | [`Engine::open`] |
//! | a recorded contact log | [`offline::render`] |
//! | displacement and roughness maps | [`Surface::from_maps`], [`Surface::from_displacement`] |
//! | nothing recorded yet | [`Body::stock`], [`Material::PRESETS`], [`Surface::flat`] |
//! | a surface of your own | [`surface::height_field::HeightField`] |
//! | several bodies at several places | [`Config::audio`], [`Body::bus`] |
//! | a pen, a nail, a shoe sole | [`PROBE_PRESETS`], [`Scene::add_probe`], [`Touching`] |
//! | collisions of a physics engine | [`Impact::from_impulse`]; the crate `asperity-rapier` |
//! | a sound card | [`live`] |
//! | silence, too much | [`Scene::why_silent`], [`Scene::why_clipped`] |
//! | levels | [`LevelPolicy`] |
//!
//! # Crates
//!
//! | crate | holds |
//! |---|---|
//! | [`dsp`] | kernels: what happens to one sample |
//! | [`surface`] | surfaces: sources sampled in real time |
//! | `asperity-pictures` | surfaces from photographs and normal maps, metamers |
//! | `asperity` | scenes, events, the two halves, files, offline renders, sound cards |
//! | `asperity-fit`, `asperity-shape` | a recorded hit, a mesh becomes modes |
//! | `asperity-ports` | clips for phones, headsets and pads |
//! | `asperity-rapier` | contacts of a physics engine as events |
//! | `asperity-cli` | the program |
//!
//! # Features
//!
//! | feature | brings |
//! |---|---|
//! | `device`, `jack`, `pulseaudio` | sound cards through cpal |
//! | `brownian` | Brownian surfaces, which need an FFT when they are made |
//! | `exr` | EXR maps |
//! | `more-pictures` | WebP, TIFF, TGA and BMP maps |

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
pub mod load;
mod make;
mod model;
pub mod offline;
mod opaque;
pub mod parameters;
mod rate;
mod resource;
mod trial;

pub use asperity_dsp::limits;
pub use audio::renderer::Renderer;
pub use engine::Engine;
pub use files::actuator_profile::{ActuatorPreset, PresetError};
pub use files::shapes_file::{load_shapes, parse_shapes};
pub use files::shapes_sidecar::{shapes_from_bytes, shapes_to_bytes, shapes_to_file};
pub use game::clipping::ClipReason;
pub use game::contradiction::{Contradiction, Likely};
pub use game::scene::Scene;
pub use game::silence::SilenceReason;
pub use game::tip::{HITCH_S, JUMP_M_S, Tip, TipCoupling, TipStep, TipSurface};
pub use link::stats::Stats;
pub use link::tap::{ContactBlock, NoTap, Tap};
pub use model::actuator::{ActuatorSettings, DeviceProfile, FELT_FORCE_EXPONENT, Quantity};
pub use model::bad_value::BadValue;
pub use model::body::Body;
pub use model::bus::{AudioBus, BusId, BusLevels, MAX_BUSES};
pub use model::click::Click;
pub use model::clip::Clip;
pub use model::clock_mode::ClockMode;
pub use model::config::Config;
pub use model::diffuse::{Diffuse, DiffuseBand, DiffusePart};
pub use model::error::{AddError, ConfigError, PickupProblem, Refusal, ReportError};
pub use model::event::{
    ChannelId, ContactEvent, ContactId, ContactSample, Emphasis, Impact, MAX_FORCE_N, MAX_SPEED_M_S, MAX_UV,
    Touching,
};
pub use model::excitation::{Excitation, Exciter};
pub use model::frame::SurfaceFrame;
pub use model::id::{BodyId, ProbeId, SurfaceId};
pub use model::level_policy::LevelPolicy;
pub use model::material::{Material, MaterialPreset};
pub use model::modal_model::{MAX_POSITIONS, ModalModel, ModalModelError};
pub use model::mode_shapes::{ModeShapes, Unit as ShapeUnit};
pub use model::pickup::{Pickup, PickupQuantity, RigidMotion};
pub use model::preset::Preset;
pub use model::probe::{PROBE_PRESETS, THING_PROBE, probe_by_name, thing_with_face};
pub use model::residual::{LONGEST_S as LONGEST_RESIDUAL_S, Residual};
pub use model::stock::Stock;
pub use model::strike_field::{StrikeField, StrikePlace};
pub use model::surface::{
    DEFAULT_MICRO_RELIEF_M, DEFAULT_ROUGHNESS, DEFAULT_STICK_SLIP, EXCITER_MATERIAL, EXCITER_RADIUS_M,
    Roughness, Surface, SurfaceError,
};
pub use model::uv_mapping::{UvMapping, UvPlace};
pub use model::uv_triangle::UvTriangle;
pub use rate::{AtRate, RateError};

/// Kernels: what happens to one sample.
pub use asperity_dsp as dsp;
pub use asperity_dsp::DesignError;
pub use asperity_dsp::hertz::Elastic;
/// Contents of [`ContactBlock::contact_samples`]: the pad at one sample.
pub use asperity_dsp::micro_contact::ContactSample as PadSample;
pub use asperity_dsp::micro_contact::{HeardTip, Integrator, Probe};
pub use asperity_dsp::modal_bank::Culling;
pub use asperity_dsp::mode::Mode;
pub use asperity_dsp::sensor::SensorProfile;
pub use asperity_dsp::simd::Isa;
pub use asperity_dsp::stick_slip::Friction;
pub use asperity_dsp::trajectory::PathMode;
/// Sources of surfaces, and maps.
pub use asperity_surface as surface;
pub use asperity_surface::height_map::Extent;
pub use asperity_surface::tip_law::TipLaw;
pub use asperity_surface::wrap::Wrap;
