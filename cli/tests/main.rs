//! The program's black-box tests in one program, but for the one that is empty where the page is
//! in.

mod actuators;
mod brownian_force;
mod chaotic;
mod damping_from_recordings;
mod demo;
mod device;
mod export;
mod fit;
mod from_stroke;
mod full_disk;
mod haptic;
mod hostile;
mod house;
mod import;
mod inputs_are_kept;
mod likeness_and_shaders;
mod limits;
mod losses;
#[path = "support/maps.rs"]
mod maps;
mod modes;
mod path_estimate;
mod perceptual_order;
mod refused_pictures;
mod render;
mod report;
mod scorecard;
mod sounds;
mod sources;
mod stock_bodies;
mod study;
mod support;
#[path = "../../offline/pictures/tests/surfaces/mod.rs"]
mod surfaces;
mod textures;
mod trace;
mod usage;
