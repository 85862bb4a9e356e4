//! The simulation's end of the hand-over, on a thread that may take its time.

use super::law::SandLaw;
use super::patch::Patch;
use super::simulation::{FRAMES_PER_S, Pose, SandSimulation};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Takes poses and sends patches; [`SandWorker::frame`] is to be called 60 times a second.
pub struct SandWorker {
    pub(super) simulation: SandSimulation,
    pub(super) poses: rtrb::Consumer<Pose>,
    pub(super) laws: rtrb::Consumer<SandLaw>,
    pub(super) patches: rtrb::Producer<Box<Patch>>,
    pub(super) back: rtrb::Consumer<Box<Patch>>,
    pub(super) spare: Vec<Box<Patch>>,
    pub(super) touched: Vec<bool>,
    pub(super) frames: u64,
}

impl SandWorker {
    /// Takes the poses, runs a frame, sends patches.
    pub fn frame(&mut self) {
        self.touched.fill(false);
        while let Ok(law) = self.laws.pop() {
            self.simulation.set_law(law);
        }
        while let Ok(pose) = self.poses.pop() {
            if let Some(touched) = self.touched.get_mut(pose.contact) {
                *touched = true;
            }
            self.simulation.tell(pose);
        }
        while let Ok(patch) = self.back.pop() {
            self.spare.push(patch);
        }
        self.simulation.frame();
        for contact in 0..self.touched.len() {
            if self.touched[contact] {
                self.send(|simulation, patch| simulation.write_patch(contact, patch));
            }
        }
        if self.frames.is_multiple_of(8) {
            self.send(SandSimulation::write_overview);
        }
        self.frames += 1;
    }

    /// Sends a patch, or none when all are under way.
    fn send(&mut self, write: impl FnOnce(&SandSimulation, &mut Patch)) {
        if let Some(mut patch) = self.spare.pop() {
            write(&self.simulation, &mut patch);
            if let Err(rtrb::PushError::Full(patch)) = self.patches.push(patch) {
                self.spare.push(patch);
            }
        }
    }

    /// Shapes the sand before it is touched.
    pub fn shape(&mut self, height_m: impl FnMut(usize, usize) -> f64) {
        self.simulation.shape(height_m);
    }

    /// The simulation.
    #[must_use]
    pub fn simulation(&self) -> &SandSimulation {
        &self.simulation
    }

    /// Runs frames on a thread of its own until it is stopped.
    #[must_use]
    pub fn spawn(mut self) -> SandThread {
        let stop = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&stop);
        let handle = std::thread::spawn(move || {
            let period = Duration::from_secs_f64(1.0 / FRAMES_PER_S);
            let mut due = Instant::now();
            while !seen.load(Ordering::Relaxed) {
                self.frame();
                due += period;
                match due.checked_duration_since(Instant::now()) {
                    Some(rest) => std::thread::sleep(rest),
                    // Late: the next frame counts from now, none is made up for.
                    None => due = Instant::now(),
                }
            }
            self.simulation
        });
        SandThread { stop, handle }
    }
}

/// A running simulation.
pub struct SandThread {
    stop: Arc<AtomicBool>,
    handle: std::thread::JoinHandle<SandSimulation>,
}

impl SandThread {
    /// Stops it and gives the sand back; `None` if the thread has died.
    pub fn stop(self) -> Option<SandSimulation> {
        self.stop.store(true, Ordering::Relaxed);
        self.handle.join().ok()
    }
}
