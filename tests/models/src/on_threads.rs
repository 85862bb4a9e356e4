//! The ring between game and audio on two threads: all that is sent arrives, in order, and what
//! was written before is seen.

use crate::link::ring::channel;
use std::thread;

#[test]
fn boxes_sent_across_arrive_whole_and_in_order() {
    let (mut sender, mut receiver) = channel::<Box<[u64; 4]>>(8);
    assert_eq!((sender.capacity(), sender.free()), (8, 8));
    let sending = thread::spawn(move || {
        for n in 0..5_000 {
            let mut item = Box::new([n; 4]);
            while let Err(back) = sender.send(item) {
                item = back;
                thread::yield_now();
            }
        }
    });
    for n in 0..5_000 {
        while receiver.peek().is_none() {
            thread::yield_now();
        }
        assert_eq!(receiver.receive(), Some(Box::new([n; 4])));
    }
    sending.join().unwrap();
    assert_eq!(receiver.receive(), None);
}
