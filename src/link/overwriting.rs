//! Overwriting ring: one writer that never waits, one reader that comes when it likes.
//!
//! A reader that is late loses the oldest, and gets the number. Every word is an atomic, so that a
//! word that is overwritten while it is read is no data race but an old or a new word; which of
//! them may be new shows the writer's claim:
//!
//! ```text
//! writer: claim n words → write them → publish         reader: copy what is published → look at the claim
//! ```
//!
//! What was copied from before *claim − capacity* counts as lost (a sequence lock; Boehm, "Can
//! seqlocks get along with programming language memory models?", 2012, §4).
//!
//! A claim is released and acquired like a publication: a reader that skips to what a claim leaves
//! has also seen every publication before it, so that the reader never stands beyond what is
//! published. `tests/models` tries it under every order that a processor may choose.

use crate::link::threads::Arc;
use crate::link::threads::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering, fence};

#[derive(Debug)]
struct Ring {
    words: Box<[AtomicU32]>,
    claimed: AtomicU64,
    published: AtomicU64,
    closed: AtomicBool,
}

impl Ring {
    fn at(&self, index: u64) -> &AtomicU32 {
        &self.words[index as usize & (self.words.len() - 1)]
    }
}

/// Writing end, for the audio half.
#[derive(Debug)]
pub struct Writer {
    ring: Arc<Ring>,
    at: u64,
}

/// Reading end, for any one other thread. Dropping it closes the ring.
#[derive(Debug)]
pub struct Reader {
    ring: Arc<Ring>,
    at: u64,
    lost: u64,
}

/// A ring of at least `records` records of `words` words each.
pub fn ring(records: usize, words: usize) -> (Writer, Reader) {
    // Records divide the ring only if their length is a power of two as well.
    let capacity = (records.max(1) * words.next_power_of_two()).next_power_of_two();
    let ring = Arc::new(Ring {
        words: (0..capacity).map(|_| AtomicU32::new(0)).collect(),
        claimed: AtomicU64::new(0),
        published: AtomicU64::new(0),
        closed: AtomicBool::new(false),
    });
    (Writer { ring: ring.clone(), at: 0 }, Reader { ring, at: 0, lost: 0 })
}

impl Writer {
    /// Writes whole records; the oldest give way. What is longer than the ring passes through it
    /// piece by piece.
    pub fn write(&mut self, mut words: impl ExactSizeIterator<Item = u32>) {
        while words.len() > 0 {
            let end = self.at + words.len().min(self.ring.words.len()) as u64;
            self.ring.claimed.store(end, Ordering::Release);
            // Whoever reads one of the words that follow reads this claim or a later one after it.
            fence(Ordering::Release);
            for (index, word) in (self.at..end).zip(&mut words) {
                self.ring.at(index).store(word, Ordering::Relaxed);
            }
            self.ring.published.store(end, Ordering::Release);
            self.at = end;
        }
    }

    /// Tests whether the reader has gone.
    pub fn is_closed(&self) -> bool {
        self.ring.closed.load(Ordering::Relaxed)
    }
}

impl Reader {
    /// Copies the oldest words that are left; returns how many.
    pub fn read(&mut self, out: &mut [u32]) -> usize {
        let capacity = self.ring.words.len() as u64;
        let published = self.ring.published.load(Ordering::Acquire);
        self.skip_to(published.saturating_sub(capacity));
        let mut count = (published - self.at).min(out.len() as u64) as usize;
        for (index, word) in (self.at..).zip(&mut out[..count]) {
            *word = self.ring.at(index).load(Ordering::Relaxed);
        }
        fence(Ordering::Acquire);
        let first = self.at;
        self.skip_to(self.ring.claimed.load(Ordering::Acquire).saturating_sub(capacity));
        let gone = (self.at - first).min(count as u64) as usize;
        out.copy_within(gone..count, 0);
        count -= gone;
        self.at += count as u64;
        count
    }

    fn skip_to(&mut self, oldest: u64) {
        if oldest > self.at {
            self.lost += oldest - self.at;
            self.at = oldest;
        }
    }

    /// Number of words that wait.
    pub fn waiting(&self) -> u64 {
        let capacity = self.ring.words.len() as u64;
        (self.ring.published.load(Ordering::Acquire) - self.at).min(capacity)
    }

    /// Words that were overwritten before they were read.
    pub fn lost(&self) -> u64 {
        self.lost
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.ring.closed.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(reader: &mut Reader, most: usize) -> Vec<u32> {
        let mut out = vec![0; most];
        let count = reader.read(&mut out);
        out.truncate(count);
        out
    }

    #[test]
    fn what_is_read_in_time_is_whole_and_in_order() {
        let (mut writer, mut reader) = ring(8, 1);
        writer.write([1, 2, 3].into_iter());
        assert_eq!(read(&mut reader, 2), [1, 2]);
        writer.write(4..10);
        assert_eq!((reader.waiting(), read(&mut reader, 100)), (7, vec![3, 4, 5, 6, 7, 8, 9]));
        assert_eq!((reader.lost(), read(&mut reader, 1)), (0, vec![]));
    }

    #[test]
    fn a_late_reader_loses_the_oldest_and_is_told_how_many() {
        let (mut writer, mut reader) = ring(8, 1);
        (0..21).for_each(|word| writer.write([word].into_iter()));
        assert_eq!(read(&mut reader, 3), [13, 14, 15]);
        assert_eq!(reader.lost(), 13);
        assert_eq!(read(&mut reader, 100), [16, 17, 18, 19, 20]);
        assert!(!writer.is_closed());
        drop(reader);
        assert!(writer.is_closed());
    }

    #[test]
    fn a_port_for_any_number_of_records_holds_at_least_as_many() {
        for records in 1..10 {
            let (mut writer, mut reader) = ring(records, 2);
            writer.write(0..2 * records as u32);
            assert_eq!(read(&mut reader, 100), Vec::from_iter(0..2 * records as u32));
            assert_eq!(reader.lost(), 0, "{records}");
        }
    }

    #[test]
    fn a_block_longer_than_a_port_leaves_its_newest_samples() {
        let (mut writer, mut reader) = ring(8, 1);
        writer.write(0..21);
        assert_eq!((reader.waiting(), read(&mut reader, 100)), (8, (13..21).collect()));
        assert_eq!((reader.lost(), reader.waiting()), (13, 0));
    }

    /// A reader that races a writer many times faster: every record is whole, in order, and none is
    /// unaccounted for.
    #[test]
    fn a_race_tears_no_record_and_loses_none_in_silence() {
        race(64, 400_000);
        // A ring so small that the writer laps the reader within a look.
        race(8, 400_000);
    }

    /// Miri takes its time over every step.
    fn race(records: usize, writes: u64) {
        let writes = if cfg!(miri) { 300 } else { writes };
        let (mut writer, mut reader) = ring(records, 4);
        let writing = std::thread::spawn(move || {
            for n in 0..writes as u32 {
                writer.write([n, !n, n ^ 0x5555_5555, n.rotate_left(7)].into_iter());
            }
        });
        let (mut seen, mut last) = (0u64, None);
        while seen + reader.lost() / 4 < writes {
            let mut out = [0; 4 * 16];
            let words = reader.read(&mut out);
            assert_eq!(words % 4, 0);
            for record in out[..words].chunks_exact(4) {
                let n = record[0];
                assert_eq!(record[1..], [!n, n ^ 0x5555_5555, n.rotate_left(7)]);
                assert!(last.is_none_or(|last| n > last));
                last = Some(n);
                seen += 1;
            }
        }
        assert_eq!((seen + reader.lost() / 4, reader.lost() % 4), (writes, 0));
        writing.join().unwrap();
    }
}
