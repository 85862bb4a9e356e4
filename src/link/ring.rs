//! The only way between the game thread and the audio thread: bounded lock-free rings.
//!
//! Neither end ever waits. A full ring hands the item back, so the sender decides what is lost.

use asperity_surface::exclusive::Exclusive;

/// Sending end of a ring.
#[derive(Debug)]
pub(crate) struct Sender<T>(Exclusive<rtrb::Producer<T>>);

/// Receiving end of a ring.
#[derive(Debug)]
pub(crate) struct Receiver<T>(Exclusive<rtrb::Consumer<T>>);

/// A ring that holds up to `capacity` items.
pub(crate) fn channel<T>(capacity: usize) -> (Sender<T>, Receiver<T>) {
    let (producer, consumer) = rtrb::RingBuffer::new(capacity);
    (Sender(Exclusive::new(producer)), Receiver(Exclusive::new(consumer)))
}

impl<T> Sender<T> {
    /// Sends, or hands the item back when the ring is full.
    pub(crate) fn send(&mut self, item: T) -> Result<(), T> {
        self.0.get_mut().push(item).map_err(|rtrb::PushError::Full(item)| item)
    }

    /// Number of items that are sure to fit.
    pub(crate) fn free(&mut self) -> usize {
        self.0.get_mut().slots()
    }

    /// Largest number of items that the ring holds.
    pub(crate) fn capacity(&mut self) -> usize {
        self.0.get_mut().buffer().capacity()
    }
}

impl<T> Receiver<T> {
    /// The next item, left in the ring.
    pub(crate) fn peek(&mut self) -> Option<&T> {
        self.0.get_mut().peek().ok()
    }

    /// Number of items that wait.
    #[cfg(feature = "device")]
    pub(crate) fn waiting(&mut self) -> usize {
        self.0.get_mut().slots()
    }

    /// The next item.
    pub(crate) fn receive(&mut self) -> Option<T> {
        self.0.get_mut().pop().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_ring_hands_back_what_does_not_fit() {
        let (mut sender, mut receiver) = channel(3);
        assert_eq!((sender.capacity(), sender.free(), receiver.peek()), (3, 3, None));
        assert_eq!([1, 2, 3, 4].map(|item| sender.send(item)), [Ok(()), Ok(()), Ok(()), Err(4)]);
        assert_eq!((sender.capacity(), sender.free(), receiver.peek()), (3, 0, Some(&1)));
        #[cfg(feature = "device")]
        assert_eq!(receiver.waiting(), 3);
        assert_eq!([receiver.receive(), receiver.receive()], [Some(1), Some(2)]);
        assert_eq!((sender.free(), receiver.peek()), (2, Some(&3)));
        #[cfg(feature = "device")]
        assert_eq!(receiver.waiting(), 1);
        assert_eq!([receiver.receive(), receiver.receive()], [Some(3), None]);
    }
}
