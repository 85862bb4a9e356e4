//! Contacts and bodies on several threads ([`Config::threads`](field@crate::Config::threads)).
//!
//! *What goes together.* A surface and all contacts on it are one job, because a surface may remember who touched it, and in which order: its
//! contacts are rendered one after the other as on one thread. A body that rings is a job of its own. Jobs own what they work on (boxes change
//! hands, nothing is copied), the dearest go out first, and every sum is made on the audio thread in the order of voices and bodies: the
//! bits are those of one thread, whoever ran what.
//!
//! *When.* Only where there are at least two jobs, and work enough that handing it over (about 1 µs) pays.
#![allow(clippy::vec_box, reason = "boxes change hands, what is in them does not move")]

use super::outputs::HapticChannel;
use crate::audio::body_seat::BodySeat;
use crate::audio::occupied::Occupied;
use crate::audio::pool::{Job, Pool};
use crate::audio::seat::Seat;
use crate::audio::voice::{At, Company, Member, Phase, Scratch, Shared, Voice, VoiceBlock};
use crate::prepared::body::{BodySlot, Terms};
use asperity_dsp::actuator::ContactOutput;
use asperity_dsp::micro_contact::Probe;
use asperity_texture::height_field::MAX_BLOCK;
use std::io;
use std::sync::Arc;

/// Samples of contacts below which one thread is faster: some 10 µs.
const LEAST_CONTACT_SAMPLES: usize = 128;
/// Samples of modes below which one thread is faster: some 5 µs.
const LEAST_MODE_SAMPLES: usize = 40_000;

/// One contact while it is away.
pub(super) struct VoiceShare {
    index: usize,
    voice: Box<Voice>,
    output: ContactOutput,
    pub(super) pressing: Option<Probe>,
    pub(super) out: VoiceBlock,
}

/// A surface with its contacts.
struct SurfaceShare {
    index: usize,
    at: At,
    shared: Option<Arc<Shared>>,
    seat: Seat,
    voices: Vec<Box<VoiceShare>>,
}

/// A body that rings.
struct BodyShare {
    index: usize,
    terms: Terms,
    n: usize,
    body: Option<Box<BodySlot>>,
    cost: usize,
    sound: [f32; MAX_BLOCK],
    left_out: usize,
}

/// A job of the pool.
enum Share {
    Surface(Box<SurfaceShare>),
    Body(Box<BodyShare>),
}

impl Job for Share {
    type Room = Box<Scratch>;

    fn run(&mut self, scratch: &mut Box<Scratch>) {
        match self {
            Self::Surface(share) => share.run(scratch),
            Self::Body(share) => share.run(),
        }
    }
}

impl SurfaceShare {
    fn run(&mut self, scratch: &mut Scratch) {
        let Some(shared) = &self.shared else { return };
        let mut company = Company::new();
        let mut render = |company: &mut Company<'_, _>| {
            company.render(shared, self.at, &mut self.seat, scratch, |done| {
                let (pressing, out): (&mut Option<Probe>, &mut VoiceBlock) = done.who;
                *pressing = done.pressing;
                std::mem::swap(out, done.out);
            });
        };
        for share in &mut self.voices {
            let VoiceShare { voice, output, pressing, out, .. } = &mut **share;
            if !company.has_room(output) {
                render(&mut company);
            }
            company.join(Member { voice, output: *output, who: (pressing, out) });
        }
        render(&mut company);
        // Nobody but the renderer holds it between two blocks.
        self.shared = None;
    }
}

impl BodyShare {
    fn run(&mut self) {
        let sound = &mut self.sound[..self.n];
        sound.fill(0.0);
        self.left_out = self.body.as_mut().map_or(0, |body| body.ring(self.terms, sound));
    }
}

/// The pool, and the memory of what goes out; all of it made at the start.
pub(super) struct Crew {
    pool: Pool<Share>,
    jobs: Vec<Share>,
    surfaces: Vec<Box<SurfaceShare>>,
    voices: Vec<Box<VoiceShare>>,
    bodies: Vec<Box<BodyShare>>,
    /// Contacts that were rendered in this stretch, by voice.
    rendered: Box<[Option<Box<VoiceShare>>]>,
    /// Bodies that were, in their order.
    rung: Vec<Box<BodyShare>>,
    next_rung: usize,
    /// The job of each surface that goes out, one more than its place among the jobs; 0 for none.
    job_of: Box<[usize]>,
}

impl Crew {
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
            let at = At { position: 0, n: 0 };
            Box::new(SurfaceShare { index: 0, at, shared: None, seat: Seat::default(), voices })
        };
        let voice_share = |_| {
            Box::new(VoiceShare {
                index: 0,
                voice: Box::new(Voice::stand_in(shared)),
                output: shared.idle_output,
                pressing: None,
                out: VoiceBlock::new(),
            })
        };
        let body_share = |_| {
            Box::new(BodyShare {
                index: 0,
                terms: Terms { position: 0, mode_level: 0 },
                n: 0,
                body: None,
                cost: 0,
                sound: [0.0; MAX_BLOCK],
                left_out: 0,
            })
        };
        let most = at_once.max(bodies);
        Ok(Self {
            pool: Pool::new(rooms, most)?,
            jobs: Vec::with_capacity(most),
            surfaces: (0..at_once).map(surface_share).collect(),
            voices: (0..voices).map(voice_share).collect(),
            bodies: (0..bodies).map(body_share).collect(),
            rendered: (0..voices).map(|_| None).collect(),
            rung: Vec::with_capacity(bodies),
            next_rung: 0,
            job_of: vec![0; surfaces].into(),
        })
    }

    /// Renders the contacts of a stretch, if sharing them pays, and whether it did; what they do waits for [`take_voice`](Self::take_voice).
    pub(super) fn render_contacts(
        &mut self,
        at: At,
        shared: &Arc<Shared>,
        (voices, used): (&mut [Box<Voice>], &Occupied),
        seats: &mut [Seat],
        channels: &[HapticChannel],
        scratch: &mut Box<Scratch>,
    ) -> bool {
        if !pays(at, voices, used) {
            return false;
        }
        for index in used.iter() {
            if voices[index].phase == Phase::Free {
                continue;
            }
            let Some(mut share) = self.voices.pop() else { break };
            let place = voices[index].surface;
            let channel = voices[index].role.actuator.map(|channel| &channels[channel]);
            share.index = index;
            share.output = channel.map_or(shared.idle_output, |channel| channel.output);
            std::mem::swap(&mut share.voice, &mut voices[index]);
            if self.job_of[place] == 0 {
                self.jobs.extend(self.surfaces.pop().map(|mut surface| {
                    (surface.index, surface.at, surface.shared) = (place, at, Some(shared.clone()));
                    std::mem::swap(&mut surface.seat, &mut seats[place]);
                    Share::Surface(surface)
                }));
                self.job_of[place] = self.jobs.len();
            }
            if let Some(Share::Surface(surface)) = self.jobs.get_mut(self.job_of[place] - 1) {
                surface.voices.push(share);
            }
        }
        // The dearest last: it goes out first.
        self.jobs.sort_unstable_by_key(|job| match job {
            Share::Surface(surface) => (surface.voices.len(), usize::MAX - surface.index),
            Share::Body(_) => (0, 0),
        });
        self.pool.run(&mut self.jobs, scratch);
        while let Some(job) = self.jobs.pop() {
            let Share::Surface(mut surface) = job else { continue };
            std::mem::swap(&mut surface.seat, &mut seats[surface.index]);
            self.job_of[surface.index] = 0;
            while let Some(mut share) = surface.voices.pop() {
                std::mem::swap(&mut share.voice, &mut voices[share.index]);
                let index = share.index;
                self.rendered[index] = Some(share);
            }
            self.surfaces.push(surface);
        }
        true
    }

    /// What a contact did in this stretch, if it was shared.
    pub(super) fn take_voice(&mut self, index: usize) -> Option<Box<VoiceShare>> {
        self.rendered[index].take()
    }

    /// Keeps the memory for the next contact.
    pub(super) fn put_back(&mut self, share: Box<VoiceShare>) {
        self.voices.push(share);
    }

    /// Rings the bodies of a stretch, if sharing them pays; what they sound like waits for [`take_body`](Self::take_body).
    pub(super) fn ring_bodies(
        &mut self,
        terms: Terms,
        n: usize,
        (bodies, used): (&mut [BodySeat], &Occupied),
        scratch: &mut Box<Scratch>,
    ) {
        self.next_rung = 0;
        let costs = used.iter().map(|index| bodies[index].modes_that_ring(terms.position));
        let (ringing, modes) =
            costs.fold((0, 0), |(ringing, all), modes| (ringing + usize::from(modes > 0), all + modes));
        // Where modes are left out a body sounds twice, by those that hear and those that do not: its sums are made in its own order.
        if ringing < 2 || modes * n < LEAST_MODE_SAMPLES || terms.mode_level > 0 {
            return;
        }
        for index in used.iter() {
            let cost = bodies[index].modes_that_ring(terms.position);
            if cost == 0 {
                continue;
            }
            let Some(mut share) = self.bodies.pop() else { break };
            (share.index, share.terms, share.n, share.cost) = (index, terms, n, cost);
            share.body = bodies[index].lend();
            self.jobs.push(Share::Body(share));
        }
        self.jobs.sort_unstable_by_key(|job| match job {
            Share::Body(body) => (body.cost, usize::MAX - body.index),
            Share::Surface(_) => (0, 0),
        });
        self.pool.run(&mut self.jobs, scratch);
        while let Some(job) = self.jobs.pop() {
            let Share::Body(mut share) = job else { continue };
            bodies[share.index].take_back(share.body.take());
            self.rung.push(share);
        }
        self.rung.sort_unstable_by_key(|share| share.index);
    }

    /// What a body sounded like in this stretch but for the first samples of its strikes, and how many groups heard nothing, if it was
    /// shared. Bodies are asked for in their order.
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

/// Whether contacts lie on at least two surfaces, and are work enough.
fn pays(at: At, voices: &[Box<Voice>], used: &Occupied) -> bool {
    let mut awake = used.iter().map(|index| &voices[index]).filter(|voice| voice.works());
    let Some(first) = awake.next() else { return false };
    let (mut count, mut elsewhere) = (1, false);
    for voice in awake {
        count += 1;
        elsewhere |= voice.surface != first.surface;
    }
    elsewhere && count * at.n >= LEAST_CONTACT_SAMPLES
}
