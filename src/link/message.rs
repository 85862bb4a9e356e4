//! Messages from the game to the audio half, and the dead resources that come home to be freed.

use crate::link::outlet::Outlet;
use crate::model::body::{Body, Sends};
use crate::model::event::ContactEvent;
use crate::model::id::{BodyId, SurfaceId};
use crate::model::pickup::RigidMotion;
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use crate::resource::body::BodySlot;
use crate::resource::clip::PlayingClip;
use crate::resource::probe::PreparedProbe;
use crate::resource::strike_point::StrikePoint;
use crate::resource::stroking::Stroking;
use crate::resource::surface::SurfaceSlot;
use asperity_dsp::hertz::HertzPulse;
use std::any::Any;
use std::sync::Arc;

/// Game thread → audio thread, in order.
pub(crate) enum Message {
    /// Activity of a contact, its time, and its place on a body that has shapes.
    Event { stamp: Stamp, epoch: u64, event: ContactEvent, place: Option<StrikePlace> },
    /// A rigid striker hits a body, and perhaps rings itself.
    Strike {
        stamp: Stamp,
        /// The clock's epoch when it was reported.
        epoch: u64,
        body: usize,
        spot: StrikePoint,
        other: Option<usize>,
        holder: Option<usize>,
        felt: Option<Felt>,
        pulse: HertzPulse,
        /// Ticket of a strike with a name; 0 = it has none.
        ticket: u32,
    },
    /// A body moves as a whole, over so many samples from what was set before; how much faster it
    /// turns, rad/s².
    Motion { stamp: Stamp, epoch: u64, slot: usize, motion: RigidMotion, alpha: [f64; 3], over: u32 },
    /// A probe for a new place.
    AddProbe { index: usize, probe: Box<PreparedProbe> },
    /// Mark that what was sent before belongs to a game time that has ended.
    Reset,
    /// A surface for a new or used place.
    SetSurface { id: SurfaceId, surface: Box<SurfaceSlot> },
    /// Parameters of a surface change while it is touched.
    ChangeSurface { slot: usize, change: Box<dyn Any + Send + Sync> },
    /// A slot falls empty; contacts on it fade.
    RemoveSurface { slot: usize },
    /// A body for a new or used place, the bus it plays on, its gain, and how strokes on its
    /// surfaces excite it from now on.
    SetBody { id: BodyId, body: Made, bus: usize, sends: Sends, gain: f64, stroking: Stroking },
    /// A body sounds on another bus from now on, and on no other.
    SetBodyBus { slot: usize, bus: usize },
    /// A body sounds on a bus beside its own from now on, so loud.
    SetBodySend { slot: usize, bus: usize, gain: f64 },
    /// A body is louder or softer from now on.
    SetBodyGain { slot: usize, gain: f64 },
    /// A clip plays on a haptic channel from its own sample on.
    PlayClip(Box<PlayingClip>),
    /// Everything that leaves sounds at this speed and pitch from now on.
    SetPitch(f64),
    /// Everything that leaves fades to nothing, or comes back.
    Mute(bool),
    /// Mark that also lets contacts wait for their next report.
    Pause(bool),
    /// Every contact ends, and everything that rings is damped.
    FadeAll,
    /// Gain of an audio bus, reached within a few milliseconds.
    SetAudioGain { bus: usize, gain: f64 },
    /// A slot falls empty; its body rings out.
    RemoveBody { slot: usize },
    /// The audio half's end of a port that was opened.
    AddOutlet(Box<dyn Outlet>),
    /// Per-user haptic gain of one channel, 0 = mute; reached within a few milliseconds.
    SetHapticGain { channel: usize, gain: f64 },
}

/// A body as the audio half takes it, and what it was made of.
pub(crate) struct Made {
    pub(crate) slot: Box<BodySlot>,
    pub(crate) of: Arc<Body>,
}

/// Who feels a strike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Felt {
    pub(crate) channel: usize,
    /// Probe of the hand that feels it; none = the engine's own.
    pub(crate) probe: Option<usize>,
}

/// Audio thread → game thread: what has to be freed.
pub(crate) enum Retired {
    Surface(Box<SurfaceSlot>),
    /// A body that has rung out.
    Body(Made),
    /// A body that was cut while it rang.
    #[expect(dead_code, reason = "it is freed with the message and never looked at")]
    Cut(Made),
    /// A port that nobody reads any more.
    #[expect(dead_code, reason = "it is freed with the message and never looked at")]
    Outlet(Box<dyn Outlet>),
    #[expect(dead_code, reason = "it is freed with the message and never looked at")]
    Change(Box<dyn Any + Send + Sync>),
    /// A clip that is over.
    #[expect(dead_code, reason = "it is freed with the message and never looked at")]
    Clip(Box<PlayingClip>),
}
