//! Contacts and bodies on several threads ([`Config::threads`](field@crate::Config::threads)).
//!
//! *What goes together.* A surface and all contacts on it are one job, because a surface may
//! remember who touched it, and in which order: its contacts are rendered one after the other as on
//! one thread. A body that rings is a job of its own. Jobs own what they work on (boxes change
//! hands, nothing is copied), the dearest go out first, and every sum is made on the audio thread
//! in the order of voices and bodies: the bits are those of one thread, wherever each ran.
//!
//! *No waiting between the two.* The audio thread takes contacts as they come home, in their order,
//! and sends a body out as soon as the last contact that touches it has been added up: others ring
//! while it adds up the rest and drives the actuators.
//!
//! ```text
//! audio thread   surfaces → …a surface… │ contacts 1, 2, 3 … in order → bodies │ actuators │ …a body… │ bodies in order → buses
//! helpers                 …surfaces…                       …surfaces, bodies…
//! ```
//!
//! *When.* Only where there are at least two jobs, and work enough that handing it over (about 1
//! µs) pays.
#![allow(clippy::vec_box, reason = "boxes change hands, what is in them does not move")]

use super::outputs::HapticChannel;
use crate::audio::body_seat::BodySeat;
use crate::audio::index_set::IndexSet;
use crate::audio::pool::{Job, Pool};
use crate::audio::seat::Seat;
use crate::audio::shared::{SampleRange, Segment, Shared};
use crate::audio::voice::{Scratch, Voice, VoiceBlock, VoiceState};
use crate::link::tap::NoTap;
use crate::resource::body::{BodySlot, RenderArgs};
use asperity_dsp::actuator::ContactOutput;
use asperity_dsp::micro_contact::Probe;
use asperity_surface::height_field::MAX_BLOCK;
use std::io;
use std::sync::Arc;

/// Samples of contacts below which one thread is faster: some 10 µs.
const LEAST_CONTACT_SAMPLES: usize = 128;
/// Samples of modes below which one thread is faster: some 5 µs.
const LEAST_MODE_SAMPLES: usize = 40_000;

/// One contact while it is away.
pub(super) struct VoiceTask {
    index: usize,
    voice: Box<Voice>,
    output: ContactOutput,
    pub(super) pressing: Option<Probe>,
    pub(super) out: Box<VoiceBlock>,
}

/// A surface with its contacts.
struct SurfaceTask {
    index: usize,
    at: SampleRange,
    shared: Option<Arc<Shared>>,
    seat: Seat,
    voices: Vec<Box<VoiceTask>>,
}

/// A body that rings.
struct BodyTask {
    index: usize,
    args: RenderArgs,
    n: usize,
    body: Option<Box<BodySlot>>,
    cost: usize,
    sound: [f32; MAX_BLOCK],
    left_out: usize,
}

/// A job of the pool.
enum Task {
    Surface(Box<SurfaceTask>),
    Body(Box<BodyTask>),
}

impl Job for Task {
    type Room = Box<Scratch>;

    fn run(&mut self, scratch: &mut Box<Scratch>) {
        match self {
            Self::Surface(share) => share.run(scratch),
            Self::Body(share) => share.run(),
        }
    }
}

impl SurfaceTask {
    fn run(&mut self, scratch: &mut Scratch) {
        let Some(shared) = &self.shared else { return };
        for share in &mut self.voices {
            let VoiceTask { voice, output, pressing, out, .. } = &mut **share;
            let stretch = Segment { shared, output, position: self.at.position, n: self.at.n };
            *pressing = voice.render(stretch, &mut self.seat, scratch, &mut NoTap);
            std::mem::swap(out, &mut scratch.out);
        }
        // Between two blocks the renderer alone holds it.
        self.shared = None;
    }
}

impl BodyTask {
    fn run(&mut self) {
        let sound = &mut self.sound[..self.n];
        sound.fill(0.0);
        self.left_out = self.body.as_mut().map_or(0, |body| body.ring(self.args, sound));
    }
}

/// The pool, and the memory of what goes out; all of it made at the start.
pub(super) struct RenderPool {
    pool: Pool<Task>,
    jobs: Vec<Task>,
    surfaces: Vec<Box<SurfaceTask>>,
    voices: Vec<Box<VoiceTask>>,
    bodies: Vec<Box<BodyTask>>,
    /// Contacts that are away, or have been and are not asked for yet, by voice; and those of them
    /// that are back.
    away: Box<[bool]>,
    rendered: Box<[Option<Box<VoiceTask>>]>,
    /// One more than the last voice that touches a body in this stretch, by body; 0 for none.
    last_to_touch: Box<[usize]>,
    /// True where bodies go out in this stretch as soon as nobody touches them any more.
    sends_bodies: bool,
    /// Bodies that were rung, in their order.
    rung: Vec<Box<BodyTask>>,
    next_rung: usize,
    /// The job of each surface that goes out, one more than its place among the jobs; 0 for none.
    job_of: Box<[usize]>,
}

impl RenderPool {
    /// For so many threads, the audio thread among them. Allocates.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub(super) fn new(
        threads: usize,
        (voices, surfaces, bodies): (usize, usize, usize),
        shared: &Shared,
    ) -> io::Result<Self> {
        let rooms = (1..threads).map(|_| Scratch::new()).collect();
        let at_once = voices.min(surfaces);
        let surface_share = |_| {
            let voices = Vec::with_capacity(voices);
            let at = SampleRange { position: 0, n: 0 };
            Box::new(SurfaceTask { index: 0, at, shared: None, seat: Seat::default(), voices })
        };
        let voice_share = |_| {
            Box::new(VoiceTask {
                index: 0,
                voice: Box::new(Voice::placeholder(shared)),
                output: shared.idle_output,
                pressing: None,
                out: Box::new(VoiceBlock::new()),
            })
        };
        let body_share = |_| {
            Box::new(BodyTask {
                index: 0,
                args: RenderArgs { position: 0, mode_level: 0, has_buses: true },
                n: 0,
                body: None,
                cost: 0,
                sound: [0.0; MAX_BLOCK],
                left_out: 0,
            })
        };
        let most = at_once + bodies;
        Ok(Self {
            pool: Pool::new(rooms, most)?,
            jobs: Vec::with_capacity(most),
            surfaces: (0..at_once).map(surface_share).collect(),
            voices: (0..voices).map(voice_share).collect(),
            bodies: (0..bodies).map(body_share).collect(),
            away: vec![false; voices].into(),
            rendered: (0..voices).map(|_| None).collect(),
            last_to_touch: vec![0; bodies].into(),
            sends_bodies: false,
            rung: Vec::with_capacity(bodies),
            next_rung: 0,
            job_of: vec![0; surfaces].into(),
        })
    }

    /// Sends the contacts of a stretch out, if sharing them pays, and whether it did; what they do
    /// waits for [`take_voice`](Self::take_voice).
    pub(super) fn send_contacts(
        &mut self,
        at: SampleRange,
        shared: &Arc<Shared>,
        (voices, used): (&mut [Box<Voice>], &IndexSet),
        seats: &mut [Seat],
        channels: &[HapticChannel],
    ) -> bool {
        self.sends_bodies = false;
        if !pays(at, voices, used) {
            return false;
        }
        self.last_to_touch.fill(0);
        for index in used.iter() {
            if voices[index].phase == VoiceState::Free {
                continue;
            }
            let Some(mut share) = self.voices.pop() else { break };
            let place = voices[index].surface;
            let channel = voices[index].role.actuator.map(|channel| &channels[channel]);
            share.index = index;
            share.output = channel.map_or(shared.idle_output, |channel| channel.output);
            std::mem::swap(&mut share.voice, &mut voices[index]);
            self.away[index] = true;
            if self.job_of[place] == 0 {
                self.jobs.extend(self.surfaces.pop().map(|mut surface| {
                    (surface.index, surface.at, surface.shared) = (place, at, Some(shared.clone()));
                    std::mem::swap(&mut surface.seat, &mut seats[place]);
                    Task::Surface(surface)
                }));
                self.job_of[place] = self.jobs.len();
            }
            if let Some(Task::Surface(surface)) = self.jobs.get_mut(self.job_of[place] - 1) {
                touched(&share.voice, &surface.seat).for_each(|body| self.last_to_touch[body] = index + 1);
                surface.voices.push(share);
            }
        }
        self.send_all();
        self.pool.wake();
        true
    }

    /// Result of a contact in this stretch, if it was shared, as soon as it is back.
    pub(super) fn take_voice(
        &mut self,
        index: usize,
        voices: &mut [Box<Voice>],
        seats: &mut [Seat],
        scratch: &mut Box<Scratch>,
    ) -> Option<Box<VoiceTask>> {
        if !std::mem::take(&mut self.away[index]) {
            return None;
        }
        while self.rendered[index].is_none() {
            match self.pool.next(scratch)? {
                Task::Surface(mut surface) => {
                    std::mem::swap(&mut surface.seat, &mut seats[surface.index]);
                    self.job_of[surface.index] = 0;
                    while let Some(mut share) = surface.voices.pop() {
                        std::mem::swap(&mut share.voice, &mut voices[share.index]);
                        let index = share.index;
                        self.rendered[index] = Some(share);
                    }
                    self.surfaces.push(surface);
                }
                Task::Body(body) => self.keep_rung(body),
            }
        }
        self.rendered[index].take()
    }

    /// Keeps the memory for the next contact.
    pub(super) fn put_back(&mut self, share: Box<VoiceTask>) {
        self.voices.push(share);
    }

    /// While contacts are away: sends out the bodies that nobody touches, if sharing bodies pays;
    /// the others go as they [are left](Self::leave_bodies).
    pub(super) fn send_bodies(
        &mut self,
        args: RenderArgs,
        n: usize,
        bodies: &mut [BodySeat],
        used: &IndexSet,
    ) {
        self.sends_bodies = bodies_pay(args, n, bodies, used);
        for index in used.iter() {
            if self.sends_bodies && self.last_to_touch[index] == 0 {
                self.send_body(index, args, n, &mut bodies[index]);
            }
        }
    }

    /// Notes that a contact's result has been added up: bodies that it touched last go out.
    pub(super) fn leave_bodies(
        &mut self,
        voice: usize,
        (touching, seat): (&Voice, &Seat),
        (args, n): (RenderArgs, usize),
        bodies: &mut [BodySeat],
    ) {
        for body in touched(touching, seat) {
            if self.sends_bodies && self.last_to_touch[body] == voice + 1 {
                // It may hold what it touches.
                self.last_to_touch[body] = 0;
                self.send_body(body, args, n, &mut bodies[body]);
                self.pool.wake();
            }
        }
    }

    fn send_body(&mut self, index: usize, args: RenderArgs, n: usize, body: &mut BodySeat) {
        let cost = body.modes_that_ring(args.position);
        if cost == 0 {
            return;
        }
        let Some(mut share) = self.bodies.pop() else { return };
        (share.index, share.args, share.n, share.cost) = (index, args, n, cost);
        share.body = body.lend();
        self.jobs.push(Task::Body(share));
        self.send_all();
    }

    /// Rings the bodies of a stretch, if sharing them pays; what they sound like waits for
    /// [`take_body`](Self::take_body).
    pub(super) fn ring_bodies(
        &mut self,
        args: RenderArgs,
        n: usize,
        (bodies, used): (&mut [BodySeat], &IndexSet),
        scratch: &mut Box<Scratch>,
    ) {
        self.next_rung = 0;
        if !std::mem::take(&mut self.sends_bodies) && bodies_pay(args, n, bodies, used) {
            for index in used.iter() {
                self.send_body(index, args, n, &mut bodies[index]);
            }
            self.pool.wake();
        }
        while let Some(job) = self.pool.next(scratch) {
            if let Task::Body(share) = job {
                self.keep_rung(share);
            }
        }
        for share in &mut self.rung {
            bodies[share.index].take_back(share.body.take());
        }
    }

    /// Keeps a body that was rung in its place among the others.
    fn keep_rung(&mut self, share: Box<BodyTask>) {
        let place = self.rung.partition_point(|other| other.index < share.index);
        self.rung.insert(place, share);
    }

    /// Sends the jobs out, the dearest first.
    fn send_all(&mut self) {
        let cost = |job: &Task| match job {
            Task::Surface(surface) => (surface.voices.len(), usize::MAX - surface.index),
            Task::Body(_) => (0, 0),
        };
        while let Some(dearest) = (0..self.jobs.len()).max_by_key(|job| cost(&self.jobs[*job])) {
            let job = self.jobs.swap_remove(dearest);
            // There is room for all that there can be.
            if let Err(job) = self.pool.send(job) {
                self.jobs.push(job);
                return;
            }
        }
    }

    /// Sound of a body in this stretch but for the first samples of its strikes, and the number of
    /// groups that were not driven, if it was shared. Bodies are asked for in their order.
    pub(super) fn take_body(&mut self, index: usize) -> Option<(&[f32], usize)> {
        let share = self.rung.get(self.next_rung).filter(|share| share.index == index)?;
        self.next_rung += 1;
        Some((&share.sound[..share.n], share.left_out))
    }

    /// Keeps the memory for the next bodies.
    pub(super) fn put_bodies_back(&mut self) {
        self.bodies.append(&mut self.rung);
    }
}

/// The bodies that a contact sends anything to: the one it touches, and the one that it is part of.
fn touched(voice: &Voice, seat: &Seat) -> impl Iterator<Item = usize> + use<> {
    let under = seat.current().and_then(|slot| slot.surface.body);
    under.into_iter().chain(voice.role.holder).map(|body| body.index())
}

/// Tests whether at least two bodies ring, and are work enough.
fn bodies_pay(args: RenderArgs, n: usize, bodies: &[BodySeat], used: &IndexSet) -> bool {
    let costs = used.iter().map(|index| bodies[index].modes_that_ring(args.position));
    let (ringing, modes) =
        costs.fold((0, 0), |(ringing, all), modes| (ringing + usize::from(modes > 0), all + modes));
    // While modes are left out a body sounds twice, by those that hear and those that do not:
    // its sums are made in its own order.
    ringing >= 2 && modes * n >= LEAST_MODE_SAMPLES && args.mode_level == 0
}

/// Tests whether contacts lie on at least two surfaces, and are work enough.
fn pays(at: SampleRange, voices: &[Box<Voice>], used: &IndexSet) -> bool {
    let mut working = used.iter().map(|index| &voices[index]).filter(|voice| voice.works());
    let Some(first) = working.next() else { return false };
    let (mut count, mut elsewhere) = (1, false);
    for voice in working {
        count += 1;
        elsewhere |= voice.surface != first.surface;
    }
    elsewhere && count * at.n >= LEAST_CONTACT_SAMPLES
}
