//! asperity in Godot 4: nodes that report what is touched, and audio streams that sound and
//! vibrate.
//!
//! | file | what a project does with it |
//! |---|---|
//! | [`world`] | `AsperityWorld`: opens the engine, reports contacts, plays it |
//! | [`record`] | its recordings |
//! | [`body`] | `AsperityBody`: what rings |
//! | [`surface`] | `AsperitySurface`: what is touched, also from a material's textures |
//! | [`normal_map`] | heights of a material that has normals only |
//! | [`finger`] | `AsperityFinger3D`: touches the meshes of a scene |
//! | [`tip`] | `AsperityTip3D`: a tracked fingertip, on a spring |
//! | [`haptics`] | `AsperityHaptics`: a channel on a headset's controller and a joypad |
//! | [`stream`] | `AsperityStream`: the audio buses; its playback is the renderer |
//! | [`haptic_stream`] | `AsperityHapticStream`: two haptic channels |
//!
//! The audio server calls the playbacks on a thread of its own. A playback owns what it renders
//! with, and no other code of this crate binds it.

// Godot's entry point and the audio server's buffers.
#![allow(unsafe_code)]

mod body;
mod events;
mod finger;
mod frames;
mod haptic_stream;
mod haptics;
mod normal_map;
mod picture;
mod record;
mod res_files;
mod stream;
mod surface;
mod tip;
mod triangles;
mod world;

use godot::prelude::*;

struct Asperity;

// SAFETY: the entry point is generated once, by the library that defines all of its classes.
#[gdextension]
unsafe impl ExtensionLibrary for Asperity {}
