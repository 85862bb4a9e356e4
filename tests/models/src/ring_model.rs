//! The overwriting ring: one thread writes, one reads, in every order.

use crate::overwriting::{Reader, ring};
use crate::schedules;
use loom::thread;

/// Reads once; says what came and checks that the reader never stands beyond what was published.
fn look(reader: &mut Reader, out: &mut Vec<u32>) {
    let mut words = [0; 8];
    let count = reader.read(&mut words);
    out.extend(&words[..count]);
    assert!(reader.waiting() <= 64);
}

/// Every record that comes is whole, later than the one before, and what did not come is counted.
fn race(records: usize, words: usize, writes: u32, looks: usize) {
    let (mut writer, mut reader) = ring(records, words);
    let writing = thread::spawn(move || {
        for n in 1..=writes {
            writer.write((0..words as u32).map(|part| 16 * n + part));
        }
    });
    let mut seen = Vec::new();
    for _ in 0..looks {
        look(&mut reader, &mut seen);
    }
    writing.join().unwrap();
    look(&mut reader, &mut seen);
    for record in seen.chunks_exact(words) {
        assert!(record.iter().zip(0..).all(|(word, part)| *word == record[0] + part), "torn: {seen:?}");
    }
    assert!(seen.chunks_exact(words).is_sorted_by(|a, b| a[0] < b[0]), "out of order: {seen:?}");
    assert_eq!(seen.len() as u64 + reader.lost(), u64::from(writes) * words as u64);
}

#[test]
fn a_port_read_while_written_gives_whole_records() {
    let of_one = schedules(2, || race(2, 1, 5, 2));
    let of_two = schedules(2, || race(2, 2, 4, 2));
    println!("{of_one} and {of_two} schedules");
    assert!(of_one >= 1000 && of_two >= 1000, "{of_one} and {of_two} schedules");
}

/// Every word is a piece of its own here: a claim is a whole ring ahead of what was published.
#[test]
fn a_port_read_during_a_longer_block_stays_within_the_published() {
    let count = schedules(3, || {
        let (mut writer, mut reader) = ring(1, 1);
        let writing = thread::spawn(move || writer.write(1..6));
        let mut seen = Vec::new();
        for _ in 0..3 {
            look(&mut reader, &mut seen);
        }
        writing.join().unwrap();
        look(&mut reader, &mut seen);
        assert!(seen.is_sorted_by(|a, b| a < b), "out of order: {seen:?}");
        assert_eq!(seen.len() as u64 + reader.lost(), 5);
    });
    println!("{count} schedules");
    assert!(count >= 1000, "{count} schedules");
}

#[test]
fn a_port_without_a_reader_reports_so_and_is_left_alone() {
    schedules(3, || {
        let (mut writer, reader) = ring(2, 1);
        let reading = thread::spawn(move || drop(reader));
        writer.write(1..4);
        reading.join().unwrap();
        assert!(writer.is_closed());
    });
}
