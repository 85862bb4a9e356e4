//! The only way between the game thread and the audio thread: bounded lock-free rings.
//!
//! Neither end ever waits. A full ring hands the item back, so the sender decides what is lost.

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
