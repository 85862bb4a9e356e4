//! Sound of a body, stretch by stretch: the bank driven by all that reaches it, and what stands
//! beside the bank.

use super::place::Place;
use super::{BodySlot, FEW_INPUTS, MOST_INPUTS, RenderArgs};
use crate::resource::bank::MODE_LEVELS;
use crate::resource::pickup::Heard;
use asperity_dsp::modal_bank::{self, Input, Inputs};

impl BodySlot {
    /// Adds the body's sound to `out` and returns how many groups of modes did not hear what struck
    /// it.
    pub(crate) fn render(&mut self, args: RenderArgs, out: &mut [f32]) -> usize {
        let left_out = self.ring(args, out);
        self.add_strikes(args.position, out);
        left_out
    }

    /// Modes that must be rung from `position` on; 0 where it is silent.
    pub(crate) fn modes_that_ring(&self, position: u64) -> usize {
        if self.is_silent(position) { 0 } else { modal_bank::LANES * self.bank.groups().max(1) }
    }

    /// [`modes_that_ring`](Self::modes_that_ring), and how many of them a late machine leaves out.
    pub(crate) fn modes_and_spared(&self, position: u64) -> (usize, usize) {
        let kept = modal_bank::LANES * self.levels[MODE_LEVELS - 1];
        let modes = self.modes_that_ring(position);
        (modes, modes.saturating_sub(kept))
    }

    /// [`render`](Self::render) without the first samples of strikes
    /// ([`add_strikes`](Self::add_strikes)): nearly all of the work.
    pub(crate) fn ring(&mut self, args: RenderArgs, out: &mut [f32]) -> usize {
        if self.is_silent(args.position) {
            if let Some(pickups) = &mut self.pickups {
                pickups.rest();
            }
            self.end_stretch(args.position, out.len());
            return 0;
        }
        let left_out = if self.field.is_none() && self.places.len() + 2 <= FEW_INPUTS {
            self.ring_inputs::<FEW_INPUTS>(args, out)
        } else {
            self.ring_inputs::<MOST_INPUTS>(args, out)
        };
        if let Some(diffuse) = &mut self.diffuse {
            diffuse.render(args.position, out);
        }
        left_out
    }

    /// Adds to what was [rung](Self::ring): bursts, and what the bank leaves out of the first
    /// samples of strikes.
    pub(crate) fn add_strikes(&mut self, position: u64, out: &mut [f32]) {
        self.bursts.render(position, out);
        self.begin_strikes(position, out);
    }

    /// Adds what the bank answers to at most `MOST` inputs; how many groups of modes heard nothing.
    fn ring_inputs<const MOST: usize>(&mut self, args: RenderArgs, out: &mut [f32]) -> usize {
        let n = out.len();
        if let Some(field) = &mut self.field {
            field.gather(args.position, n);
        }
        let mut inputs = [Input { impulses: &[], gains: &[] }; MOST];
        let mut count = 0;
        if let Some(field) = &self.field {
            field.inputs(args.position, n, |input| {
                inputs[count] = input;
                count += 1;
            });
        }
        // Only positions that something reaches are mixed; adding zeros would change nothing.
        self.places.iter_mut().for_each(|place| place.gather(args.position, n));
        for place in &self.places {
            if place.reached || count == 0 {
                inputs[count] = Input { impulses: &place.input[..n], gains: &place.gains };
                count += 1;
            }
        }
        let groups = self.bank.groups();
        let driven = self.levels[args.mode_level];
        if let Some(rub) = self.rub.as_deref_mut().filter(|rub| rub.rubs()) {
            // Beside another input the only position of a body needs gains too.
            let plain = inputs[..count].iter_mut().filter(|input| input.gains.is_empty());
            plain.for_each(|input| input.gains = &self.ones);
            rub.run(args.position, n, driven, &self.bank, &inputs[..count]);
        }
        if let Some(rub) = self.rub.as_deref().filter(|rub| rub.rubs()) {
            rub.inputs(n, |input| {
                inputs[count] = input;
                count += 1;
            });
        }
        if let Some(pickups) = &mut self.pickups {
            let strikes = self.field.as_ref().map_or(0, |field| field.strikes_at(args.position));
            let heard = inputs[..count].iter().enumerate().map(|(i, input)| {
                let of = |place: &&Place| std::ptr::eq(place.input.as_ptr(), input.impulses.as_ptr());
                let own = || self.places.iter().find(of).and_then(|place| place.struck.as_deref());
                let struck =
                    if i < strikes { Some(input.impulses) } else { own().map(|struck| &struck[..n]) };
                Heard { input: *input, struck }
            });
            pickups.render(args.position, n, self.strike_gain, heard);
        }
        let inputs = match inputs[..count] {
            [Input { impulses, gains: [] }] => Inputs::One(impulses),
            _ => Inputs::Placed(&inputs[..count]),
        };
        // What rubs it asks its bank how it will move.
        if args.has_buses || self.rub.as_ref().is_some_and(|rub| !rub.is_idle()) {
            self.bank.render_leading(driven, args.position, inputs, out);
        }
        self.end_stretch(args.position, n);
        groups - driven
    }

    /// The stretch has been rendered, or nothing rings in it.
    fn end_stretch(&mut self, position: u64, n: usize) {
        let retuned = self.field.as_mut().and_then(|field| field.end_stretch(position, n, &mut self.bank));
        if let Some(pickups) = &mut self.pickups
            && let Some(group) = retuned
            && let Some(modes) = self.field.as_ref().and_then(|field| field.modes_now(group))
        {
            pickups.retune(group, &modes);
        }
        let Some(rub) = &mut self.rub else { return };
        if let Some(group) = retuned
            && let Some(modes) = self.field.as_ref().and_then(|field| field.modes_now(group))
        {
            rub.retune(group, modes);
        }
        rub.end_stretch(position + n as u64);
    }

    /// Adds what the bank leaves out of the first samples of strikes.
    fn begin_strikes(&mut self, position: u64, out: &mut [f32]) {
        if !self.early.is_empty(position) {
            let mut next = self.early.drain(position);
            out.iter_mut().for_each(|y| *y += next());
        }
    }
}
