//! Ports: what a running engine hands to other threads than the sound card's, opened and closed
//! while it runs.
//!
//! | kind | gives | for |
//! |---|---|---|
//! | [`Pcm`] | the samples of a haptic channel or an audio bus | a controller, a recorder, a level meter |
//! | [`Force`] | the 3-D force, contact by contact and summed for each hand | a force-feedback device |
//! | [`Points`] | an amplitude and a frequency some hundred times a second | a phone, a headset |
//! | [`HeadsetFrames`] | those points as OpenXR's parametric frames | the controllers of a headset |
//! | [`Levels`] | how hard a heavy and a light motor turn | a pad that rumbles |
//! | [`Picture`] | the heights of a surface that changes | a program that draws it |
//!
//! [`Scene::open_port`](crate::Scene::open_port) gives the reading end, which may go to any one
//! thread and be read at any pace: nothing waits for it, and a late reader loses the oldest
//! and gets the number. Dropping it closes the port. A kind is one file: what is wanted as plain
//! data, the end on the audio half ([`Outlet`]), the reading end.
//!
//! ```
//! use asperity::live::ports::{Feed, Pcm};
//! use asperity::{ChannelId, Config, Engine};
//!
//! let Engine { mut scene, mut renderer, .. } = Config::live(48_000.0).build()?;
//! let mut port = scene.open_port(Pcm { from: Feed::Haptic(ChannelId(0)), holds_s: 0.1 })?;
//! let (mut haptic, mut audio) = ([0.0; 64], [0.0; 64]);
//! renderer.render(&mut [&mut haptic], &mut [&mut audio]);
//! let mut felt = [0.0; 256];
//! assert_eq!((port.read(&mut felt), port.lost()), (64, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod feed;
mod force;
mod force_rows;
mod headset_frames;
mod levels;
mod pcm;
mod picture;
mod points;

pub use crate::link::outlet::{Opened, Outlet, PortKind, PortSetup};
pub use feed::Feed;
pub use force::{Force, ForcePort};
pub use force_rows::{ForceRow, ForceRows, LAG_TICKS, Of};
pub use headset_frames::{
    FrameCounts, FramePoint, FrameStage, HeadsetFrame, HeadsetFrames, HeadsetFramesPort,
};
pub use levels::{Levels, LevelsPort};
pub use pcm::{Pcm, PcmPort};
pub use picture::{Picture, PicturePort};
pub use points::{Point, PointSettings, Points, PointsPort, Tone};
