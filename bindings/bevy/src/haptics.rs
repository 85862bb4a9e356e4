//! Devices that are felt: a haptic channel on the motors of a gamepad, and as frames for the
//! controller of a headset.

use crate::touch::Touch;
use asperity::ChannelId;
use asperity::live::ports::{Feed, FrameCounts, HeadsetFrame, HeadsetFrames, HeadsetFramesPort};
use asperity::live::ports::{Levels, LevelsPort, PointSettings, PortKind, Tone};
use bevy_ecs::prelude::*;
use bevy_input::gamepad::{GamepadRumbleIntensity, GamepadRumbleRequest};
use bevy_time::{Real, Time};
use std::time::Duration;

/// Level below which a motor stands.
const FLOOR: f32 = 1.0 / 256.0;
/// Time between two requests, s.
const REQUESTED_S: f64 = 0.03;
/// Length of a request: more than a slow frame of the game.
const LASTS: Duration = Duration::from_millis(100);
/// Span that a late frame of the game still finds, s.
const HOLDS_S: f64 = 0.5;

/// The entity is a gamepad whose two motors turn with a haptic channel, by
/// [`GamepadRumbleRequest`]s some 30 times a second. They replace what else rumbles there.
#[derive(Component, Debug)]
pub struct TouchRumble {
    full_scale: f64,
    channel: u16,
    port: Option<LevelsPort>,
    turned_s: f64,
    turns: bool,
}

impl TouchRumble {
    /// The motors follow a channel, fully at samples of 1; the heavy one has what is below 100 Hz.
    #[must_use]
    pub fn of(channel: u16) -> Self {
        Self { full_scale: 1.0, channel, port: None, turned_s: f64::NEG_INFINITY, turns: false }
    }

    /// They turn fully at samples of this value.
    #[must_use]
    pub fn fully_at(mut self, full_scale: f64) -> Self {
        self.full_scale = full_scale;
        self
    }
}

/// The entity is the controller of a headset: its frames are for `xrApplyHapticFeedback`, by the
/// system that calls OpenXR.
#[derive(Component, Debug)]
pub struct TouchHeadset {
    kind: HeadsetFrames,
    port: Option<HeadsetFramesPort>,
    frames: Vec<HeadsetFrame>,
}

impl TouchHeadset {
    /// Frames of a channel whose full scale is 1, for a controller that plays 55 to 200 Hz and
    /// wants a first frame of 50 ms.
    #[must_use]
    pub fn of(channel: u16) -> Self {
        let settings = PointSettings { rate_hz: 100.0, band_hz: [55.0, 200.0], tone: Tone::Drawn };
        let from = Feed::Haptic(ChannelId(channel));
        Self::with(HeadsetFrames { from, settings, full_scale: 1.0, first_frame_s: 0.05, holds_s: HOLDS_S })
    }

    /// Frames as the runtime wants them.
    #[must_use]
    pub fn with(kind: HeadsetFrames) -> Self {
        Self { kind, port: None, frames: Vec::new() }
    }

    /// Frames to hand over before the app's next frame, in this order; made in `PostUpdate`.
    #[must_use]
    pub fn frames(&self) -> &[HeadsetFrame] {
        &self.frames
    }

    /// The runtime has refused a frame, lost its focus or begun another session: the next frame is
    /// the first of a stream.
    pub fn restart(&mut self) {
        if let Some(port) = &mut self.port {
            port.restart();
        }
    }

    /// Number of points by what became of them.
    #[must_use]
    pub fn counts(&self) -> FrameCounts {
        self.port.as_ref().map(HeadsetFramesPort::counts).unwrap_or_default()
    }
}

fn opened<K: PortKind>(touch: Option<ResMut<Touch>>, entity: Entity, kind: K) -> Option<K::Port> {
    let mut touch = touch?;
    let port = touch.scene().open_port(kind);
    port.inspect_err(|error| touch.refused(entity, error)).ok()
}

pub(crate) fn rumble_came(
    on: On<Insert, TouchRumble>,
    mut pads: Query<&mut TouchRumble>,
    touch: Option<ResMut<Touch>>,
) {
    let Ok(mut pad) = pads.get_mut(on.entity) else { return };
    let from = Feed::Haptic(ChannelId(pad.channel));
    pad.port = opened(touch, on.entity, Levels { from, rate_hz: 60.0, holds_s: HOLDS_S });
}

pub(crate) fn headset_came(
    on: On<Insert, TouchHeadset>,
    mut headsets: Query<&mut TouchHeadset>,
    touch: Option<ResMut<Touch>>,
) {
    let Ok(mut headset) = headsets.get_mut(on.entity) else { return };
    headset.port = opened(touch, on.entity, headset.kind);
}

/// A motor that nobody drives any more stands.
pub(crate) fn rumble_went(on: On<Remove, TouchRumble>, mut out: MessageWriter<GamepadRumbleRequest>) {
    out.write(GamepadRumbleRequest::Stop { gamepad: on.entity });
}

/// In `PostUpdate`.
pub(crate) fn rumble(
    mut pads: Query<(Entity, &mut TouchRumble)>,
    time: Res<Time<Real>>,
    mut out: MessageWriter<GamepadRumbleRequest>,
) {
    let now_s = time.elapsed_secs_f64();
    for (gamepad, mut pad) in &mut pads {
        let full_scale = pad.full_scale;
        let Some(port) = &mut pad.port else { continue };
        let [strong_motor, weak_motor] =
            port.newest().map(|level| (level / full_scale).clamp(0.0, 1.0) as f32);
        let is_felt = strong_motor.max(weak_motor) >= FLOOR;
        if now_s - pad.turned_s < REQUESTED_S || !(is_felt || pad.turns) {
            continue;
        }
        (pad.turned_s, pad.turns) = (now_s, is_felt);
        // Rumbles add up: the one before goes first.
        out.write(GamepadRumbleRequest::Stop { gamepad });
        if is_felt {
            let intensity = GamepadRumbleIntensity { strong_motor, weak_motor };
            out.write(GamepadRumbleRequest::Add { duration: LASTS, intensity, gamepad });
        }
    }
}

/// In `PostUpdate`.
pub(crate) fn frames(mut headsets: Query<&mut TouchHeadset>, time: Res<Time<Real>>) {
    for mut headset in &mut headsets {
        let TouchHeadset { port: Some(port), frames, .. } = &mut *headset else { continue };
        *frames = std::iter::from_fn(|| port.read(time.elapsed_secs_f64())).collect();
    }
}
