//! `asperity play SCENE.toml`: a scene and its contact log through the sound card, in real time.
//!
//! Needs the cargo feature `device` (or `jack`, `pulseaudio`); without it the verb is there and
//! says so. `--tune` needs `web`, and plays unheard where there is no sound card.

#[cfg(feature = "device")]
mod session;
#[cfg(feature = "web")]
mod tune;
#[cfg(any(feature = "device", test))]
mod watch;

use crate::error::CliError;
use clap::Args;
use std::path::PathBuf;

/// Play a scene and its contact log through the sound card
#[derive(Debug, Args)]
pub struct Options {
    /// Scene file
    #[arg(value_name = "SCENE.toml", required_unless_present_any = ["list_devices", "channels"])]
    pub scene: Option<PathBuf>,
    /// List the devices, one a line, the id first
    #[arg(long)]
    pub list_devices: bool,
    /// Device by the id that --list-devices prints
    #[arg(long, value_name = "ID")]
    pub device: Option<String>,
    /// Host: alsa, jack, pulseaudio, wasapi or coreaudio, as far as they were built in
    #[arg(long, value_name = "NAME")]
    pub host: Option<String>,
    /// A second device for the actuators; its clock is followed by a small resampler
    #[arg(long, value_name = "ID")]
    pub haptic_device: Option<String>,
    /// Channels of the device: audio=0,1 haptic=2,3 or dualsense
    #[arg(long, value_name = "MAP", num_args = 1..=2)]
    pub channels: Vec<String>,
    /// Frames a callback to ask for; the device may decide otherwise
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub block: Option<u32>,
    /// Apply what changes in SCENE.toml while it plays
    #[arg(long)]
    pub watch: bool,
    /// Turn the scene's numbers on a page while it plays, and write them back
    #[arg(long, conflicts_with_all = ["watch", "list_devices", "json"])]
    pub tune: bool,
    /// Port of that page on the loopback address; 0 = one that is free
    #[arg(long, value_name = "N", default_value_t = 0, requires = "tune")]
    pub port: u16,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// When an input is bad, a named device is not there, or it is lost and does not come back.
pub fn run(options: &Options) -> Result<(), CliError> {
    if options.tune { tune(options) } else { play(options) }
}

#[cfg(feature = "web")]
use tune::run as tune;

#[cfg(not(feature = "web"))]
fn tune(_options: &Options) -> Result<(), CliError> {
    Err(CliError::new(
        "play --tune",
        "this program was built without the page",
        "build it with `cargo build --release -p asperity-cli --features web` (and device, to hear it)",
    ))
}

#[cfg(feature = "device")]
fn play(options: &Options) -> Result<(), CliError> {
    if options.list_devices { session::list(options) } else { session::run(options) }
}

/// Refusal of a program that was built without sound card support: names the feature to build with.
#[cfg(not(feature = "device"))]
fn play(_options: &Options) -> Result<(), CliError> {
    Err(CliError::new(
        "play",
        "this program was built without sound card support",
        "build it with `cargo build --release -p asperity-cli --features device` (or jack, or pulseaudio)",
    ))
}
