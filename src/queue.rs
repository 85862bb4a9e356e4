//! The only way between the game thread and the audio thread: two bounded lock-free rings.
//!
//! Neither end ever waits. A full ring hands the item back, so the sender decides what is lost.

use crate::body::BodySlot;
use crate::clock::Stamp;
use crate::event::ContactEvent;
use crate::stroking::Stroking;
use crate::surface::SurfaceSlot;
use asperity_dsp::hertz::HertzPulse;
use asperity_texture::change::SurfaceChange;

/// Game thread → audio thread, in order.
pub(crate) enum Message {
    /// What a contact does, and when it holds.
    Event { stamp: Stamp, event: ContactEvent },
    /// A rigid striker hits a body, and perhaps rings itself.
    Strike { stamp: Stamp, body: usize, position: usize, other: Option<usize>, pulse: HertzPulse },
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

/// Sending end of a ring.
pub(crate) struct Sender<T>(rtrb::Producer<T>);

/// Receiving end of a ring.
pub(crate) struct Receiver<T>(rtrb::Consumer<T>);

/// A ring that holds up to `capacity` items.
pub(crate) fn channel<T>(capacity: usize) -> (Sender<T>, Receiver<T>) {
    let (producer, consumer) = rtrb::RingBuffer::new(capacity);
    (Sender(producer), Receiver(consumer))
}

impl<T> Sender<T> {
    /// Sends, or hands the item back when the ring is full.
    pub(crate) fn send(&mut self, item: T) -> Result<(), T> {
        self.0.push(item).map_err(|rtrb::PushError::Full(item)| item)
    }

    /// How many items are sure to fit.
    pub(crate) fn free(&self) -> usize {
        self.0.slots()
    }

    /// How many items the ring holds at most.
    pub(crate) fn capacity(&self) -> usize {
        self.0.buffer().capacity()
    }
}

impl<T> Receiver<T> {
    /// The next item, left in the ring.
    pub(crate) fn peek(&mut self) -> Option<&T> {
        self.0.peek().ok()
    }

    /// How many items wait.
    #[cfg(feature = "device")]
    pub(crate) fn waiting(&self) -> usize {
        self.0.slots()
    }

    /// The next item.
    pub(crate) fn receive(&mut self) -> Option<T> {
        self.0.pop().ok()
    }
}
