//! The simulation's end of the hand-over, on a thread that may take its time.

use super::law::SandLaw;
use super::patch::Patch;
use super::simulation::{FRAMES_PER_S, Pose, SandSimulation};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The worker's ends of the rings.
pub(super) struct Far {
    pub(super) poses: rtrb::Consumer<Pose>,
    pub(super) laws: rtrb::Consumer<SandLaw>,
    pub(super) patches: rtrb::Producer<Box<Patch>>,
    pub(super) back: rtrb::Consumer<Box<Patch>>,
    pub(super) spare: Vec<Box<Patch>>,
    /// One a contact.
    pub(super) touched: Vec<bool>,
}

/// Place where the game thread leaves the ends of new rings, when an engine takes the surface.
pub(super) type NewEnds = Arc<Mutex<Option<Far>>>;

/// Takes poses and sends patches; [`SandWorker::frame`] is to be called 60 times a second.
pub struct SandWorker {
    pub(super) simulation: SandSimulation,
    pub(super) far: Far,
    pub(super) line: NewEnds,
    pub(super) frames: u64,
}

impl SandWorker {
    /// Takes the poses, runs a frame, sends patches.
    pub fn frame(&mut self) {
        if let Some(far) = self.line.lock().unwrap_or_else(PoisonError::into_inner).take() {
            self.simulation.make_room(far.touched.len());
            self.far = far;
        }
        let far = &mut self.far;
        far.touched.fill(false);
        while let Ok(law) = far.laws.pop() {
            self.simulation.set_law(law);
        }
        while let Ok(pose) = far.poses.pop() {
            if let Some(touched) = far.touched.get_mut(pose.contact) {
                *touched = true;
            }
            self.simulation.set_pose(pose);
        }
        while let Ok(patch) = far.back.pop() {
            far.spare.push(patch);
        }
        self.simulation.frame();
        for contact in 0..self.far.touched.len() {
            if self.far.touched[contact] {
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
        if let Some(mut patch) = self.far.spare.pop() {
            write(&self.simulation, &mut patch);
            if let Err(rtrb::PushError::Full(patch)) = self.far.patches.push(patch) {
                self.far.spare.push(patch);
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

crate::opaque::debug_by_name!(SandWorker, SandThread);
