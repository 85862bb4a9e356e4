//! A worker pool that the audio thread can use: jobs go out, every thread takes the next one, all
//! come home.
//!
//! ```text
//! audio thread   jobs → waiting ─┬─ runs some itself ─┬→ home, in any order
//! helpers                        └─ run the others ───┘
//! ```
//! Jobs may go out while others are on their way: there is one wait, for the last of them.
//!
//! A job owns what it works on, so who runs it changes nothing but the time: the thread that adds
//! results up does so in an order of its own.
//!
//! *No lock.* Both queues are lock-free rings made at the start. A helper looks for work [`LOOKS`]
//! times, then sleeps; the audio thread wakes a sleeping one by `unpark`, which marks it and, if it
//! sleeps, asks the system to wake it: nobody is waited for. What no helper has taken by the time
//! that the audio thread is done with its own job it runs itself, so that a helper that wakes late
//! costs nothing. All it ever waits for is a job that a helper is in the middle of; after [`LOOKS`]
//! looks it offers its processor, in case the helper has none.

use crate::link::threads::Arc;
use crate::link::threads::atomic::Ordering::{Relaxed, SeqCst};
use crate::link::threads::atomic::{AtomicBool, fence};
use crate::link::threads::waiting::{ArrayQueue, Builder, JoinHandle, LOOKS, park, spin_loop, yield_now};
use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// Something that any thread can do.
pub(crate) trait Job: Send + 'static {
    /// Memory that each thread has for it.
    type Room: Send + 'static;

    /// Does it.
    fn run(&mut self, room: &mut Self::Room);
}

/// Threads beside the one that owns this.
pub(crate) struct Pool<J> {
    queues: Arc<Queues<J>>,
    helpers: Vec<Worker>,
    /// Jobs that were sent out and have not come home.
    out: usize,
}

struct Worker {
    thread: JoinHandle<()>,
    /// The process that has it: threads do not come along into a child of `fork`.
    process: u32,
}

struct Queues<J> {
    waiting: ArrayQueue<J>,
    done: ArrayQueue<Result<J, Box<dyn Any + Send>>>,
    ends: AtomicBool,
    /// Which helpers sleep, or are about to.
    asleep: Box<[AtomicBool]>,
}

impl<J: Job> Pool<J> {
    /// Starts a helper for each room, for at most `most` jobs at a time. Allocates.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub(crate) fn new(rooms: Vec<J::Room>, most: usize) -> io::Result<Self> {
        let queues = Arc::new(Queues {
            waiting: ArrayQueue::new(most.max(1)),
            done: ArrayQueue::new(most.max(1)),
            ends: AtomicBool::new(false),
            asleep: rooms.iter().map(|_| AtomicBool::new(false)).collect(),
        });
        let mut pool = Self { queues, helpers: Vec::with_capacity(rooms.len()), out: 0 };
        for (index, mut room) in rooms.into_iter().enumerate() {
            let queues = pool.queues.clone();
            let named = Builder::new().name(format!("asperity-{}", index + 1));
            // If one cannot be had, those there are end with the pool.
            let thread = named.spawn(move || queues.help(index, &mut room))?;
            pool.helpers.push(Worker { thread, process: std::process::id() });
        }
        Ok(pool)
    }

    /// Sends a job out; it comes [home](Self::next) done. Nobody takes more of them than there is
    /// room for: what is too many comes back.
    pub(crate) fn send(&mut self, job: J) -> Result<(), J> {
        // Nor more than the way home has room for, however many helpers have taken meanwhile.
        if self.out == self.queues.done.capacity() {
            return Err(job);
        }
        self.queues.waiting.push(job)?;
        self.out += 1;
        Ok(())
    }

    /// Wakes helpers that sleep, as many as there is work for beside this thread. To be called
    /// after some were sent: waking takes as long as a short job.
    pub(crate) fn wake(&self) {
        // Either a helper that falls asleep sees the jobs, or its mark is seen here.
        fence(SeqCst);
        let wanted = self.queues.waiting.len().saturating_sub(1);
        for (helper, asleep) in self.helpers.iter().zip(&self.queues.asleep).take(wanted) {
            if asleep.load(SeqCst) {
                helper.thread.thread().unpark();
            }
        }
    }

    /// A job that is done, on any thread; none if all are home. While none is, this thread does
    /// one of those that wait.
    pub(crate) fn next(&mut self, room: &mut J::Room) -> Option<J> {
        let mut looks = 0;
        while self.out > 0 {
            if let Some(done) = self.queues.done.pop() {
                self.out -= 1;
                // As if it had been run here.
                return Some(done.unwrap_or_else(|panic| resume_unwind(panic)));
            }
            if let Some(mut job) = self.queues.waiting.pop() {
                self.out -= 1;
                job.run(room);
                return Some(job);
            }
            look_again(&mut looks);
        }
        None
    }
}

impl<J: Job> Queues<J> {
    /// Loop of a helper.
    fn help(&self, index: usize, room: &mut J::Room) {
        let mut looks = 0;
        while !self.ends.load(Relaxed) {
            if let Some(job) = self.waiting.pop() {
                looks = 0;
                self.finish(job, room);
            } else if looks < LOOKS {
                looks += 1;
                spin_loop();
            } else {
                self.sleep(index);
                looks = 0;
            }
        }
    }

    fn finish(&self, mut job: J, room: &mut J::Room) {
        let done = catch_unwind(AssertUnwindSafe(|| job.run(room))).map(|()| job);
        // There is room for all that were sent out.
        let _ = self.done.push(done);
    }

    fn sleep(&self, index: usize) {
        self.asleep[index].store(true, SeqCst);
        fence(SeqCst);
        if self.waiting.is_empty() && !self.ends.load(SeqCst) {
            park();
        }
        self.asleep[index].store(false, SeqCst);
    }
}

/// Waits a moment for a helper that is in the middle of a job.
fn look_again(looks: &mut u32) {
    if *looks < LOOKS {
        *looks += 1;
        spin_loop();
    } else {
        yield_now();
    }
}

impl<J> Drop for Pool<J> {
    fn drop(&mut self) {
        self.queues.ends.store(true, SeqCst);
        for Worker { thread, process } in self.helpers.drain(..) {
            if process != std::process::id() {
                // Nothing is there to wait for or to let go.
                std::mem::forget(thread);
                continue;
            }
            thread.thread().unpark();
            // It does not panic: what its jobs throw is caught and handed over.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Count {
        from: u64,
        sum: u64,
        fails: bool,
    }

    impl Job for Count {
        type Room = u64;

        fn run(&mut self, room: &mut u64) {
            assert!(!self.fails, "a job fails");
            self.sum = (self.from..self.from + 1000).sum();
            *room += 1;
        }
    }

    fn jobs(count: u64) -> Vec<Count> {
        (0..count).map(|from| Count { from, sum: 0, fails: false }).collect()
    }

    /// Sends jobs out while others come home, as the crew does.
    fn run(pool: &mut Pool<Count>, jobs: Vec<Count>, room: &mut u64) -> Vec<Count> {
        let mut home = Vec::new();
        for mut job in jobs {
            while let Err(back) = pool.send(job) {
                job = back;
                home.extend(pool.next(room));
            }
            pool.wake();
        }
        while let Some(job) = pool.next(room) {
            home.push(job);
        }
        home
    }

    #[test]
    fn all_jobs_come_home_done_however_often_helpers_slept() {
        for helpers in [0, 1, 2, 7] {
            let mut pool = Pool::new(vec![0; helpers], 16).unwrap();
            let mut room = 0;
            for round in 0..300_u64 {
                let count = round % 21;
                let mut jobs = run(&mut pool, jobs(count), &mut room);
                jobs.sort_by_key(|job| job.from);
                assert_eq!(jobs.len() as u64, count, "{helpers} helpers, round {round}");
                for (from, job) in (0..).zip(&jobs) {
                    assert_eq!((job.from, job.sum), (from, (from..from + 1000).sum()));
                }
                if round % 50 == 0 {
                    std::thread::sleep(std::time::Duration::from_millis(2));
                }
            }
        }
    }

    #[test]
    fn a_panicking_job_panics_at_home_and_its_helpers_end() {
        let mut pool = Pool::new(vec![0, 0], 16).unwrap();
        let mut failing = jobs(8);
        failing[0].fails = true;
        let outcome = catch_unwind(AssertUnwindSafe(|| run(&mut pool, failing, &mut 0)));
        assert!(outcome.is_err());
        drop(pool);
    }
}
