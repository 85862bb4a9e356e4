//! Pickups of a body, as the audio half owns them: the body's modes once more for each, with what
//! reaches the body as inputs, sounding as the motion of the pickup's place.
//!
//! A mode of unit motion φ̂ moves a place with share s by s φ̂² / ω · e^(−dt) sin ωt m for 1 N·s on
//! an input of gain 1 (`dsp::modal_bank`; [`GroupOptions::derivative`] makes velocity and
//! acceleration of it), in `f64` ([`PhasorGroup`]): a measurement. Levels of what is heard do not
//! count: gains of strikes are taken back.

use crate::model::pickup::{Pickup, PickupQuantity, RigidMotion};
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use crate::resource::bank::LONGEST_CONTACT_S;
use crate::resource::holding::HeldModes;
use crate::resource::impulse_ring::ImpulseRing;
use asperity_dsp::DesignError;
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::modal_bank::{
    GRID_SAMPLES, GroupOptions, Input, LANES, LaneGains, LaneSums, MAX_INPUTS, OnsetSamples, PhasorGroup,
    PhasorState, total,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::simd::Level;
use asperity_surface::height_field::MAX_BLOCK;

/// Amplitude below which a mode of a pickup rests, m: a thousandth of an atom's width at 1 kHz is
/// 1e-5 m/s².
const REST_M: f64 = 1e-16;
/// ω of a mode whose displacement is so small, rad/s.
const TYPICAL_OMEGA_RAD_S: f64 = 1e4;

/// A pickup whose place has been found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlacedPickup {
    pub(crate) pickup: Pickup,
    /// On a body that has shapes.
    pub(crate) place: Option<StrikePlace>,
}

/// The pickups of one body.
pub(crate) struct Pickups {
    all: Box<[PickupSlot]>,
    /// Impulses of strikes without the gain that they are heard with.
    plain: Box<[[f32; MAX_BLOCK]]>,
    kernel: Level,
}

/// One pickup.
pub(crate) struct PickupSlot {
    pub(crate) channel: usize,
    options: GroupOptions,
    /// s φ̂² of each mode: the speed of the place after 1 N·s on an input of gain 1, m/s.
    speed_m_s: Box<[f64]>,
    groups: Box<[(PhasorGroup, PhasorState)]>,
    /// Amplitude below which its modes rest.
    rest: f64,
    missing: Box<[OnsetSamples]>,
    early: ImpulseRing<f32>,
    out: [f32; MAX_BLOCK],
    /// True where `out` has anything of the present stretch.
    sounds: bool,
    rigid: Rigid,
    sample_rate_hz: f64,
}

/// Reading of the body's own motion: a straight line from report to report.
struct Rigid {
    at_m: [f64; 3],
    direction: [f64; 3],
    reads: bool,
    now: f64,
    step: f64,
    left: u32,
}

/// Input of the body's bank, and what of it is a strike with the gain that it is heard with.
pub(crate) struct Heard<'a> {
    pub(crate) input: Input<'a>,
    pub(crate) struck: Option<&'a [f32]>,
}

impl Pickups {
    /// For the modes of a bank in their order, the motion of each where its gain is 1, and the
    /// gains of each place.
    pub(crate) fn new(
        placed: &[(PlacedPickup, Vec<LaneGains>)],
        (modes, units): (&[Mode], &[f64]),
        most_inputs: usize,
        (kernel, sample_rate_hz): (Level, f64),
    ) -> Result<Self, DesignError> {
        let slot = |(placed, gains): &(PlacedPickup, Vec<LaneGains>)| {
            PickupSlot::new(placed, gains, (modes, units), sample_rate_hz)
        };
        let all = placed.iter().map(slot).collect::<Result<_, _>>()?;
        Ok(Self { all, plain: vec![[0.0; MAX_BLOCK]; most_inputs].into(), kernel })
    }

    pub(crate) fn slots(&mut self) -> &mut [PickupSlot] {
        &mut self.all
    }

    pub(crate) fn is_silent(&self, position: u64) -> bool {
        self.all.iter().all(|slot| slot.is_at_rest() && slot.early.is_empty(position))
    }

    pub(crate) fn silence(&mut self) {
        for slot in &mut self.all {
            slot.groups.iter_mut().for_each(|(_, state)| *state = PhasorState::default());
            slot.early.clear();
        }
    }

    /// A strike where the inputs have these gains (none: 1).
    pub(crate) fn strike(
        &mut self,
        gains: &[LaneGains],
        pulse: &HertzPulse,
        stamp: Stamp,
        sample_rate_hz: f64,
    ) {
        let (sample, offset) = (stamp.sample(), stamp.fraction());
        let end = pulse.end_sample(sample, sample_rate_hz);
        for slot in &mut self.all {
            let mut sum = OnsetSamples::NOTHING;
            for (index, missing) in slot.missing.iter().enumerate() {
                let share = gains.get(index / LANES).map_or(1.0, |gains| gains.0[index % LANES]);
                sum.add(missing, f64::from(share));
            }
            let missing = sum.first_samples();
            slot.early.write(end, |early| missing.deposit(pulse, early, sample, offset, sample_rate_hz));
        }
    }

    /// Nothing rings in the coming stretch.
    pub(crate) fn rest(&mut self) {
        self.all.iter_mut().for_each(|slot| slot.sounds = false);
    }

    /// Reads `n` samples from `position` on; strikes are heard `strike_gain` times as strong as
    /// they are.
    pub(crate) fn render<'a>(
        &mut self,
        position: u64,
        n: usize,
        strike_gain: f64,
        heard: impl Iterator<Item = Heard<'a>>,
    ) {
        let Self { all, plain, kernel } = self;
        let back = if strike_gain == 0.0 { 0.0 } else { (1.0 / strike_gain - 1.0) as f32 };
        let mut inputs = [Input { impulses: &[], gains: &[] }; MAX_INPUTS];
        let mut count = 0;
        for (Heard { input, struck }, plain) in heard.zip(plain.iter_mut()) {
            inputs[count] = match struck.filter(|_| back != 0.0) {
                Some(struck) => {
                    let both = input.impulses[..n].iter().zip(&struck[..n]);
                    plain.iter_mut().zip(both).for_each(|(to, (x, struck))| *to = x + back * struck);
                    Input { impulses: &plain[..n], ..input }
                }
                None => input,
            };
            count += 1;
        }
        for slot in all {
            slot.ring(*kernel, position, &inputs[..count], n);
            let out = &mut slot.out[..n];
            if !slot.early.is_empty(position) {
                let mut next = slot.early.drain(position);
                out.iter_mut().for_each(|y| *y += next());
            }
            slot.sounds = true;
        }
    }

    /// A group of the body has other modes from now on.
    pub(crate) fn retune(&mut self, group: usize, held: &HeldModes) {
        for slot in &mut self.all {
            let mut modes = held.modes;
            let speeds = slot.speed_m_s.get(group * LANES..).unwrap_or_default();
            modes.iter_mut().zip(speeds).for_each(|(mode, speed)| *mode = moving(mode, *speed));
            // Modes that could be designed once always can.
            let designed = PhasorGroup::new(&modes[..held.count], slot.sample_rate_hz, &slot.options);
            if let (Ok(designed), Some((coefficients, _))) = (designed, slot.groups.get_mut(group)) {
                *coefficients = designed;
            }
        }
    }

    /// The body moves so as a whole, `over` samples from now.
    pub(crate) fn moves(&mut self, motion: &RigidMotion, alpha: [f64; 3], over: u32) {
        let reading = self.all.iter_mut().map(|slot| &mut slot.rigid).filter(|rigid| rigid.reads);
        for rigid in reading {
            let to = motion.read(rigid.at_m, rigid.direction, alpha);
            rigid.step = (to - rigid.now) / f64::from(over.max(1));
            rigid.left = over.max(1);
        }
    }
}

/// A mode that moves a place so fast after 1 N·s.
fn moving(mode: &Mode, speed_m_s: f64) -> Mode {
    let amplitude = speed_m_s / (std::f64::consts::TAU * mode.frequency_hz);
    Mode { amplitude, phase_rad: 0.0, ..*mode }
}

impl PickupSlot {
    fn new(
        PlacedPickup { pickup, place }: &PlacedPickup,
        gains: &[LaneGains],
        (modes, units): (&[Mode], &[f64]),
        sample_rate_hz: f64,
    ) -> Result<Self, DesignError> {
        let derivative = pickup.quantity.derivative();
        let options = GroupOptions { derivative, ..GroupOptions::IMPULSE_RING };
        let shares = gains.iter().flat_map(|gains| gains.0);
        let speed_m_s: Box<[f64]> =
            shares.zip(units).map(|(share, unit)| f64::from(share) * unit * unit).collect();
        let modes: Vec<Mode> =
            modes.iter().zip(&speed_m_s).map(|(mode, speed)| moving(mode, *speed)).collect();
        let missing = modes.iter().map(|mode| OnsetSamples::of_derivative(mode, derivative, sample_rate_hz));
        let missing = missing.collect::<Result<_, _>>()?;
        let group = |modes: &[Mode]| {
            PhasorGroup::new(modes, sample_rate_hz, &options).map(|group| (group, PhasorState::default()))
        };
        let groups = modes.chunks(LANES).map(group).collect::<Result<_, _>>()?;
        let outward = place.map_or([0.0, 0.0, 1.0], |place| place.direction.map(f64::from));
        let direction = if place.is_some() { outward } else { unit(pickup.direction.unwrap_or(outward)) };
        Ok(Self {
            channel: pickup.channel,
            options,
            speed_m_s,
            groups,
            rest: REST_M * TYPICAL_OMEGA_RAD_S.powi(i32::from(derivative)),
            missing,
            early: ImpulseRing::new(LONGEST_CONTACT_S, sample_rate_hz),
            out: [0.0; MAX_BLOCK],
            sounds: false,
            rigid: Rigid {
                at_m: pickup.at_m.unwrap_or_default(),
                direction,
                reads: pickup.quantity == PickupQuantity::Acceleration,
                now: 0.0,
                step: 0.0,
                left: 0,
            },
            sample_rate_hz,
        })
    }

    fn is_at_rest(&self) -> bool {
        self.groups.iter().all(|(_, state)| state.is_at_rest())
    }

    /// Reads what the modes answer to the inputs of the next `n` samples.
    fn ring(&mut self, kernel: Level, position: u64, inputs: &[Input<'_>], n: usize) {
        let mut sums = [LaneSums::default(); MAX_BLOCK];
        let struck = inputs.iter().any(|input| input.impulses[..n].iter().any(|u| *u != 0.0));
        let at_grid = (position + n as u64).is_multiple_of(GRID_SAMPLES);
        for (index, (group, state)) in self.groups.iter_mut().enumerate() {
            if !struck && state.is_at_rest() {
                continue;
            }
            group.run(kernel, index, state, inputs, &mut sums[..n]);
            if at_grid {
                group.settle(state, self.rest);
            }
        }
        self.out.iter_mut().zip(&sums[..n]).for_each(|(out, parts)| *out = total(parts) as f32);
    }

    /// Adds what it reads of a stretch.
    pub(crate) fn add_to(&mut self, sum: &mut [f32]) {
        if self.sounds {
            sum.iter_mut().zip(&self.out).for_each(|(sum, x)| *sum += x);
        }
        let rigid = &mut self.rigid;
        if rigid.left == 0 && rigid.now == 0.0 {
            return;
        }
        for sum in sum {
            if rigid.left > 0 {
                rigid.left -= 1;
                rigid.now += rigid.step;
            }
            *sum += rigid.now as f32;
        }
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}
