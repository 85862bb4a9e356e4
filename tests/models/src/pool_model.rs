//! The pool: jobs go out and all come home, however helpers sleep and wake; it ends whenever it is
//! asked to.

use crate::pool::{Job, Pool};
use crate::schedules;

struct Double(u32);

impl Job for Double {
    type Room = u32;

    fn run(&mut self, room: &mut u32) {
        self.0 *= 2;
        *room += 1;
    }
}

/// Rounds of jobs as the crew sends them: all out, helpers woken, home in any order.
fn rounds(helpers: usize, rounds: &[u32]) {
    let mut pool = Pool::new(vec![0; helpers], 4).unwrap();
    let mut room = 0;
    for jobs in rounds {
        for job in 0..*jobs {
            assert!(pool.send(Double(job + 1)).is_ok());
        }
        pool.wake();
        let mut home: Vec<u32> = std::iter::from_fn(|| pool.next(&mut room)).map(|job| job.0).collect();
        home.sort_unstable();
        assert_eq!(home, (1..=*jobs).map(|job| 2 * job).collect::<Vec<_>>());
    }
}

#[test]
fn a_block_rendered_by_several_threads_is_whole_and_ends_with_them() {
    let one = schedules(3, || rounds(1, &[2]));
    let two = schedules(2, || rounds(2, &[3]));
    println!("{one} and {two} schedules");
    assert!(one >= 1000 && two >= 1000, "{one} and {two} schedules");
}

/// Jobs for which the way home has no room yet, while a helper takes those that wait.
#[test]
fn more_jobs_than_there_is_room_for_all_come_home() {
    let count = schedules(3, || {
        let mut pool = Pool::new(vec![0], 1).unwrap();
        let (mut room, mut home) = (0, 0);
        for number in 1..=2 {
            let mut job = Double(number);
            while let Err(back) = pool.send(job) {
                job = back;
                home += pool.next(&mut room).map_or(0, |done| done.0);
            }
            pool.wake();
        }
        while let Some(done) = pool.next(&mut room) {
            home += done.0;
        }
        assert_eq!(home, 6);
    });
    println!("{count} schedules");
    assert!(count >= 500, "{count} schedules");
}
