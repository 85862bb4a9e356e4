//! What crosses: messages from the game to the audio half, and what comes home to be freed.

use crate::model::event::ContactEvent;
use crate::model::stamp::Stamp;
use crate::prepared::body::BodySlot;
use crate::prepared::stroking::Stroking;
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::hertz::HertzPulse;
use asperity_texture::change::SurfaceChange;

/// Game thread → audio thread, in order.
pub(crate) enum Message {
    /// What a contact does, and when it holds.
    Event { stamp: Stamp, event: ContactEvent },
    /// A rigid striker hits a body, and perhaps rings itself.
    Strike { stamp: Stamp, body: usize, position: usize, other: Option<usize>, pulse: HertzPulse },
    /// What was sent before belongs to a game time that has ended.
    Reset,
    /// A surface for a new or used slot.
    SetSurface { slot: usize, surface: Box<SurfaceSlot> },
    /// Parameters of a surface change while it is touched.
    ChangeSurface { slot: usize, change: SurfaceChange },
    /// A slot falls empty; contacts on it fade.
    RemoveSurface { slot: usize },
    /// A body for a new or used slot, and how strokes on its surfaces excite it from now on.
    SetBody { slot: usize, body: Box<BodySlot>, stroking: Stroking },
    /// A slot falls empty; the body rings out unheard from now on.
    RemoveBody { slot: usize },
    /// Per-user haptic gain of one channel, 0 = mute; reached within a few milliseconds.
    SetHapticGain { channel: usize, gain: f64 },
}

/// Audio thread → game thread: what has to be freed.
pub(crate) enum Dead {
    Surface(Box<SurfaceSlot>),
    Body(Box<BodySlot>),
}
