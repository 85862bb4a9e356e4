//! Side by side: a few contacts go through a stretch together, stage by stage, so that stages in which each waits for itself run them in
//! the lanes of one vector (`dsp::micro_contact::run_side_by_side`).
//!
//! ```text
//! paths of all at once → profile of each, in order → pads of all at once → high-passes of all at once → the rest of each, in order
//! ```
//! Surfaces are asked in the order of the contacts, and what contacts do is handed on in that order: the bits are those of one after the other.

use super::between::Closeness;
use super::shared::{At, Shared, Stretch};
use super::{Lane, Pass, Scratch, Voice, VoiceBlock};
use crate::audio::seat::Seat;
use crate::link::tap::NoTap;
use asperity_dsp::actuator::{ContactOutput, Quantity};
use asperity_dsp::micro_contact::{LANES, Probe, run_side_by_side};
use asperity_dsp::trajectory::advance_side_by_side;

/// The surfaces that contacts lie on.
pub(crate) trait Seats {
    /// The one of that place.
    fn seat(&mut self, surface: usize) -> &mut Seat;
}

impl Seats for [Seat] {
    fn seat(&mut self, surface: usize) -> &mut Seat {
        &mut self[surface]
    }
}

/// All on one.
impl Seats for Seat {
    fn seat(&mut self, _surface: usize) -> &mut Seat {
        self
    }
}

/// One of them.
pub(crate) struct Member<'a, W> {
    pub(crate) voice: &'a mut Voice,
    pub(crate) output: ContactOutput,
    /// What it is to whoever renders it.
    pub(crate) who: W,
}

/// What a member did in a stretch: itself, what pressed on the touched body at a step of the absolute grid, and its block.
pub(crate) struct Done<'a, W> {
    pub(crate) voice: &'a Voice,
    pub(crate) seat: &'a Seat,
    pub(crate) pressing: Option<Probe>,
    pub(crate) out: &'a mut Box<VoiceBlock>,
    pub(crate) who: W,
}

/// The contacts that go together; empty between two stretches.
pub(crate) struct Company<'a, W> {
    members: [Option<Member<'a, W>>; LANES],
    count: usize,
}

impl<'a, W> Company<'a, W> {
    /// Nobody.
    pub(crate) fn new() -> Self {
        Self { members: [const { None }; LANES], count: 0 }
    }

    /// Whether a contact with this output may come along. One whose skin is dragged goes alone, because it needs its ground once more when
    /// the others have been shown theirs.
    pub(crate) fn has_room(&self, output: &ContactOutput) -> bool {
        let dragged = |output: &ContactOutput| output.quantity() == Quantity::Tangential;
        match &self.members[0] {
            None => true,
            Some(first) => self.count < LANES && !dragged(output) && !dragged(&first.output),
        }
    }

    /// One more comes along, if there is room.
    pub(crate) fn join(&mut self, member: Member<'a, W>) {
        if let Some(place) = self.members.get_mut(self.count) {
            *place = Some(member);
            self.count += 1;
        }
    }

    /// Renders them, and lets everyone go.
    pub(crate) fn render(
        &mut self,
        shared: &Shared,
        at: At,
        seats: &mut (impl Seats + ?Sized),
        scratch: &mut Scratch,
        mut done: impl FnMut(Done<'_, W>),
    ) {
        if self.count == 0 {
            return;
        }
        let At { position, n } = at;
        let mut passes = [Pass { n: 0, slides: false, coupled: false }; LANES];
        let mut pressing = [None; LANES];
        let set_out = self.set_out(shared, n, seats, &mut scratch.lanes);
        for (lane, member) in self.members.iter_mut().flatten().enumerate() {
            let Member { voice, output, .. } = member;
            let seat = seats.seat(voice.surface);
            pressing[lane] = voice.pressing_at(at, shared, seat);
            let stretch = Stretch { shared, output, position, n };
            passes[lane] = voice.approach(stretch, (false, set_out[lane]), seat, scratch, lane);
        }
        self.touch_down(n, &passes, &mut scratch.lanes);
        self.couple(shared, n, &mut passes, seats, scratch);
        for (lane, place) in self.members.iter_mut().enumerate() {
            let Some(Member { voice, output, who }) = place.take() else { continue };
            let seat = &*seats.seat(voice.surface);
            let stretch = Stretch { shared, output: &output, position, n };
            voice.finish(stretch, passes[lane], seat, scratch, lane, &mut NoTap);
            done(Done { voice, seat, pressing: pressing[lane], out: &mut scratch.out, who });
        }
        self.count = 0;
    }

    /// The points of those that move through the whole stretch; who they are. A path neither asks its surface nor is asked by one, so that it may be
    /// ahead of both.
    fn set_out(
        &mut self,
        shared: &Shared,
        n: usize,
        seats: &mut (impl Seats + ?Sized),
        lanes: &mut [Lane; LANES],
    ) -> [bool; LANES] {
        let mut gone = [false; LANES];
        if self.count < 2 {
            return gone;
        }
        let mut beside = [const { None }; LANES];
        let mut count = 0;
        for ((member, own), gone) in self.members.iter_mut().flatten().zip(lanes).zip(&mut gone) {
            let voice = &mut *member.voice;
            if let (true, Some(slot)) = (voice.sets_out(), seats.seat(voice.surface).current()) {
                beside[count] = Some(voice.path.beside(slot, &mut own.points[..n]));
                (*gone, count) = (true, count + 1);
            }
        }
        let level = shared.noise.level();
        in_one_row(beside, |all| advance_side_by_side(level, all));
        gone
    }

    /// The rows of those that slide, and the high-passes of those that have company.
    fn couple(
        &mut self,
        shared: &Shared,
        n: usize,
        passes: &mut [Pass; LANES],
        seats: &mut (impl Seats + ?Sized),
        Scratch { lanes, coupled, .. }: &mut Scratch,
    ) {
        let together = passes.iter().filter(|pass| pass.slides && pass.n == n).count() > 1;
        if together {
            coupled.clear();
        }
        let members = self.members.iter_mut().flatten().zip(passes).zip(lanes).enumerate();
        for (lane, ((Member { voice, output, .. }, pass), own)) in
            members.filter(|(_, ((_, pass), _))| pass.slides)
        {
            voice.settle(shared, *pass, own);
            if let (true, Some(slot)) = (together && pass.n == n, seats.seat(voice.surface).current()) {
                let heard = &slot.stroking.force_high_pass;
                pass.coupled = voice.ac.enter(output, heard, &own.rows[..n], lane, coupled);
            }
        }
        if together {
            coupled.run(shared.noise.level(), n);
        }
    }

    /// The pads of those that slide: those whose ground is known at the quarters by themselves, because their samples are two steps.
    fn touch_down(&mut self, n: usize, passes: &[Pass; LANES], lanes: &mut [Lane; LANES]) {
        let (mut beside, mut in_steps) = ([const { None }; LANES], [const { None }; LANES]);
        let (mut count, mut stepping) = (0, 0);
        for ((member, pass), lane) in self.members.iter_mut().zip(passes).zip(lanes) {
            let Some(Member { voice, .. }) = member.as_mut().filter(|_| pass.slides) else { continue };
            if pass.n != n {
                // It fades away in the middle of the stretch.
                lane.press(&mut voice.pad, pass.n);
                continue;
            }
            let ground = lane.looks.ground(n, &lane.bends);
            let (height_m, force_n) = (&lane.height_m[..n], &lane.force_n[..n]);
            let one = Some(voice.pad.beside(height_m, force_n, ground, &mut lane.rows[..n]));
            if lane.looks == Closeness::Quarters {
                (in_steps[stepping], stepping) = (one, stepping + 1);
            } else {
                (beside[count], count) = (one, count + 1);
            }
        }
        in_one_row(beside, |all| run_side_by_side(all));
        in_one_row(in_steps, |all| run_side_by_side(all));
    }
}

/// Those that are there, without gaps: the first so many of them.
fn in_one_row<T>(all: [Option<T>; LANES], run: impl FnOnce(&mut [T])) {
    match all {
        [Some(a), Some(b), Some(c), Some(d)] => run(&mut [a, b, c, d]),
        [Some(a), Some(b), Some(c), None] => run(&mut [a, b, c]),
        [Some(a), Some(b), ..] => run(&mut [a, b]),
        [Some(a), ..] => run(&mut [a]),
        [None, ..] => {}
    }
}
