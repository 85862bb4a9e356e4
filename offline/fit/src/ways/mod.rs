//! Model selection: a strike is a sum of modes in noise, a push and then a sum of modes, or
//! neither.
//!
//! *A sum of modes* ([`crate::ways::analysis`]) leaves noise from the onset on. *A push* leaves
//! noise only from where the striker lets go: while it pushes, a body does not ring freely (1 ms of
//! half-sine force fitted as ringing: 27 dB of resynthesis, 75 dB when it is left out). *Anything
//! else* is fitted from its tail ([`crate::ways::tail_to_attack`]).
//!
//! The engine strikes a body at the onset, where the modes after a push are a guess continued
//! backwards. So no contact is believed without proof:
//!
//! 1. From the onset on, modes leave more than noise, or a few of them are only the push in
//!    disguise: over when it is, or as fast as any may be ([`is_contact_artifact`]).
//! 2. From some proposed end of it on ([`crate::ways::contact`]) modes leave no more than noise.
//! 3. They are fewer, by more than those that such a late beginning cannot see ([`saves`]).
//! 4. A fit from the onset on leaves more of the sound, or 20 dB more of what follows the push; or
//!    both leave noise, and so little of it that a push is told from fast modes (40 dB). Two stones
//!    of four were fitted from 4.99 ms on, 9.8 and 9.2 dB from the onset, and 20.7 and 18.0 from
//!    it.
//!
//! Then the end is where those modes, continued backwards, first leave more than noise
//! ([`release_samples`]).

pub(crate) mod analysis;
mod contact;
mod late_lines;
mod merging;
mod one_mode;
mod ranking;
mod rounds;
mod tail_to_attack;

use crate::noise::noise_floor::NoiseFloor;
use crate::options::FitOptions;
use crate::recording::{FEWEST_SAMPLES, Recording};
use crate::search::limits::Limits;
use crate::search::sum_of_modes::may_be_sum_of_modes;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::refinement::refine;
use crate::ways::analysis::{Analysis, analyse, settle, subtract};
use crate::ways::contact::{LONGEST_S, contact_samples, release_samples};
use crate::ways::merging::{MERGED_LOSS, merge_resonances};
use crate::ways::ranking::keep_heard;
use crate::ways::tail_to_attack::analyse_from_the_tail;

/// Most modes of a sum, whatever is to be kept of them, and steps of the refit of those kept.
const MODES_OF_A_SUM: usize = 150;
const LIMITED_STEPS: usize = 12;
/// Rounds of merging before.
const LIMITED_ROUNDS: usize = 6;
/// A mode that falls by so many nepers within the contact is over when that is; where this part of
/// the modes is, they may be the push.
const OVER_NEPERS: f64 = 1.0;
const DISGUISED_SHARE: f64 = 0.25;
/// Number of modes that decay as fast as any may, to this factor.
const FASTEST: f64 = 0.95;
const FASTEST_MODES: usize = 3;
/// A push must save so many modes, and this part of them.
const SAVED_MODES: usize = 4;
const SAVED_SHARE: f64 = 0.125;
/// Most modes after a push that is looked for where those from the onset on are too many.
const MODES_OF_A_PUSH: usize = 80;
/// A mode this part of as loud as any may be cancels others, as those do that stand for a push.
/// Where there are more modes than that and fewer giants, it is a recording of many modes, and
/// another fit would take as long.
const LARGE_MODE: f64 = 0.2;
const LARGE_MODES: usize = 5;
/// Modes that leave so many times as much of what follows a push are not the body's: 20 dB.
const BY_FAR: f64 = 100.0;
/// Modes after a push that leave this little of what follows it are right, and the more that a fit
/// from the onset needs to leave as little are the push in disguise: 40 dB. Made pushes leave 57 to
/// 60 dB; stones that were no pushes, 15 to 21.
const FINE: f64 = 1e4;
/// Modes of a sum are nearer than those of the tail even if they leave 3 dB more: a resonance is
/// one of them.
const CONVERGED: f64 = 2.0;
/// An end of the contact this much earlier than where the fit began is worth a fit from there, s.
const EARLIER_S: f64 = 0.000_15;

/// Material for the fit of one strike: the sound from its onset on, and what was asked for.
pub(crate) struct Sound<'a> {
    pub(crate) samples: &'a [f64],
    pub(crate) recording: &'a Recording,
    pub(crate) options: &'a FitOptions,
}

impl Sound<'_> {
    /// Modes from the onset on, or from the end of a contact that is proven; and the samples until
    /// there.
    pub(crate) fn analysed(&self, progress: &mut dyn FnMut(f64)) -> (usize, Analysis) {
        let limits = self.limits(0);
        if !may_be_sum_of_modes(self.samples, &limits) {
            return (0, analyse_from_the_tail(self.samples, &limits, progress));
        }
        let whole = analysed_as_sum(self.samples, &limits, progress);
        // A sum of more modes than may be kept is none of those.
        let right = whole.explained && !whole.capped;
        if whole.explained && !self.is_contact_artifact(&whole, self.proposed()[0]) {
            return (0, if right { whole } else { self.better_fit(whole, &limits, progress) });
        }
        if let Some(pushed) = self.pushed(&whole, progress) {
            // Of two that leave noise, fewer modes are the body's where the noise is low enough to
            // tell.
            let proven = right && self.fine(&pushed);
            let struck = if right { whole } else { self.better_fit(whole, &limits, progress) };
            return if proven || self.worse_from_the_onset(&struck, &pushed) { pushed } else { (0, struck) };
        }
        (0, if right { whole } else { self.better_fit(whole, &limits, progress) })
    }

    /// Is true of a push whose modes leave so little of what follows it that those it saves are its
    /// own.
    fn fine(&self, (offset, pushed): &(usize, Analysis)) -> bool {
        energy(&self.samples[*offset..]) > FINE * energy(&pushed.residual)
    }

    /// Is true where modes from the onset on explain less than those of a push do: of all the
    /// sound, or by far of what follows the push.
    fn worse_from_the_onset(&self, struck: &Analysis, (offset, pushed): &(usize, Analysis)) -> bool {
        let early: Vec<Partial> = pushed.partials.iter().map(|p| p.moved(-(*offset as f64))).collect();
        let (left, pushed) = (subtract(self.samples, &struck.partials), subtract(self.samples, &early));
        energy(&left) > energy(&pushed) || energy(&left[*offset..]) > BY_FAR * energy(&pushed[*offset..])
    }

    /// Better one of `whole` and a fit from the tail, neither of which is right: the one that
    /// leaves less.
    fn better_fit(&self, whole: Analysis, limits: &Limits, progress: &mut dyn FnMut(f64)) -> Analysis {
        let staged = analyse_from_the_tail(self.samples, limits, progress);
        let left = |analysis: &Analysis| energy(&analysis.residual);
        let allowed = match (whole.explained, whole.capped) {
            (true, _) => CONVERGED,
            (false, true) => 0.0,
            (false, false) => 1.0,
        };
        if left(&whole) < allowed * left(&staged) { whole } else { staged }
    }

    /// The modes of what follows the first `offset` samples, whatever it is.
    pub(crate) fn analysed_from(&self, offset: usize, progress: &mut dyn FnMut(f64)) -> Analysis {
        let (segment, limits) = (&self.samples[offset..], self.limits(offset));
        if may_be_sum_of_modes(segment, &limits) {
            let whole = analysed_as_sum(segment, &limits, progress);
            if whole.explained {
                return whole;
            }
        }
        analyse_from_the_tail(segment, &limits, progress)
    }

    fn limits(&self, offset: usize) -> Limits {
        Limits::of(&self.samples[offset..], offset, self.recording, self.options)
    }

    /// Times at which the striker may let go, samples from the onset: as the recurrence has it, and
    /// as late as any may.
    fn proposed(&self) -> [usize; 2] {
        let rate = self.recording.sample_rate_hz;
        let noise = NoiseFloor::estimate(self.samples, rate, self.recording.quantum.powi(2) / 12.0);
        let contact = contact_samples(self.samples, rate, noise.mean_variance());
        [contact, (LONGEST_S * rate) as usize]
            .map(|contact| if contact + FEWEST_SAMPLES <= self.samples.len() { contact } else { 0 })
    }

    /// Tests whether modes of a fit from the onset may be a push of `contact` samples in disguise.
    fn is_contact_artifact(&self, whole: &Analysis, contact: usize) -> bool {
        let fastest = FASTEST * self.options.fastest_decay_per_s / self.recording.sample_rate_hz;
        let over = whole.partials.iter().filter(|p| p.delta * contact as f64 > OVER_NEPERS).count();
        let at_the_bound = whole.partials.iter().filter(|p| p.delta > fastest).count();
        over as f64 >= (DISGUISED_SHARE * whole.partials.len() as f64).max(1.0)
            || at_the_bound >= FASTEST_MODES
    }

    /// The push and its modes, if there is proof of one that `whole` needs more modes for.
    fn pushed(&self, whole: &Analysis, progress: &mut dyn FnMut(f64)) -> Option<(usize, Analysis)> {
        let proven = |offset: usize, progress: &mut dyn FnMut(f64)| {
            let (segment, limits) = (&self.samples[offset..], self.limits(offset));
            let sum = if whole.capped {
                // A push of few modes, or a recording, of which a fit of many is long.
                let few = Limits { max_partials: MODES_OF_A_PUSH.min(limits.max_partials), ..limits };
                settled(segment, &few, progress)
            } else {
                analysed_as_sum(segment, &limits, progress)
            };
            (sum.explained && (!whole.explained || saves(whole, &sum))).then_some((offset, sum))
        };
        let mut contacts = self.proposed().to_vec();
        contacts.retain(|&contact| contact > 0);
        let giant = LARGE_MODE * self.limits(0).bounds.amplitude_high;
        let giants = whole.partials.iter().filter(|p| p.c.norm() > giant).count();
        if whole.partials.len() > MODES_OF_A_PUSH && giants < LARGE_MODES {
            return None;
        }
        if whole.capped {
            contacts.truncate(1);
        }
        let rate = self.recording.sample_rate_hz;
        let (late, late_sum) = contacts.into_iter().find_map(|contact| proven(contact, progress))?;
        let release =
            release_samples(self.samples, late, &late_sum.partials, late_sum.noise.mean_variance(), rate);
        let earlier = late - release.min(late);
        if (earlier as f64) < EARLIER_S * rate {
            return Some((late, late_sum));
        }
        if release == 0 {
            return None;
        }
        proven(release, progress).or(Some((late, late_sum)))
    }
}

fn energy(samples: &[f64]) -> f64 {
    samples.iter().map(|x| x * x).sum()
}

/// Tests whether a fit from the end of a push on needs so many modes less than one from the onset
/// that there was a push. A late beginning alone hides a few fast modes.
fn saves(whole: &Analysis, pushed: &Analysis) -> bool {
    let most = whole.partials.len();
    pushed.partials.len() + SAVED_MODES.max((SAVED_SHARE * most as f64) as usize) <= most
}

/// As a sum of modes, converged if it is one.
fn settled(segment: &[f64], limits: &Limits, progress: &mut dyn FnMut(f64)) -> Analysis {
    let mut sum = analyse(segment, limits, progress);
    if sum.explained {
        settle(&mut sum, segment, limits);
    }
    sum
}

/// As a sum of modes; of more than may be kept those are kept that are heard best, and refitted.
fn analysed_as_sum(segment: &[f64], limits: &Limits, progress: &mut dyn FnMut(f64)) -> Analysis {
    let most = limits.max_partials;
    // A limit is one of what is kept: a sum of modes is recognised by all of them.
    let all = Limits { max_partials: most.max(MODES_OF_A_SUM), ..*limits };
    let mut sum = analyse(segment, &all, progress);
    // What is cut far need not have converged before.
    if sum.explained && !limits.far_more_than_kept(sum.partials.len()) {
        settle(&mut sum, segment, &all);
    }
    if sum.explained && sum.partials.len() > most {
        // What is one resonance takes one place.
        for _ in 0..LIMITED_ROUNDS {
            if merge_resonances(segment, &mut sum.partials, &limits.bounds, MERGED_LOSS) == 0 {
                break;
            }
            refine(segment, &mut sum.partials, &limits.bounds, LIMITED_STEPS);
        }
        keep_heard(&mut sum.partials, segment.len(), most, limits.rate_hz);
        refine(segment, &mut sum.partials, &limits.bounds, LIMITED_STEPS);
        sum.residual = subtract(segment, &sum.partials);
        sum.capped = true;
    }
    sum
}
