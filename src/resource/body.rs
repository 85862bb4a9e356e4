//! A body, prepared for the audio half: its modal bank and the impulse rings that excite it.

mod place;
mod ringing;

use crate::model::click::Click;
use crate::model::modal_model::{MAX_POSITIONS, ModalModel};
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use crate::resource::bank::{Bank, ContactKey, LONGEST_CONTACT_S, SheddingLevels, first_samples};
use crate::resource::body_field::{BodyField, FIELD_INPUTS};
use crate::resource::body_rub::{BodyRub, FrictionInput};
use crate::resource::bursts::Bursts;
use crate::resource::diffuse::DiffuseSeat;
use crate::resource::impulse_ring::ImpulseRing;
use crate::resource::pickup::{Pickups, PlacedPickup};
use crate::resource::strike_point::StrikePoint;
use asperity_dsp::DesignError;
use asperity_dsp::hertz::{HertzPulse, KERNEL_LATENCY};
use asperity_dsp::masking::Ranked;
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::modal_bank::{self, GroupOptions, GroupState, LaneGains, ModalBank};
use asperity_dsp::mode::Mode;
use asperity_dsp::simd::Level;
use asperity_surface::height_field::MAX_BLOCK;
use place::Place;

/// Largest number of inputs of the bank at once: the body's positions, its places, and what rubs
/// it.
const MOST_INPUTS: usize = MAX_POSITIONS + FIELD_INPUTS + 2;
const _: () = assert!(MOST_INPUTS <= modal_bank::MAX_INPUTS);
/// Number of inputs of most bodies at once; a table for more costs as much as some samples of a
/// short block.
const FEW_INPUTS: usize = 4;

/// φ² times the mass where a mode of a body swings most: that of a string or a bar held at its
/// ends. A plate has 4, a ball about 5.
const ANTINODE: f64 = 2.0;

/// Between what a stroke sends in a sample (1e-6) and a strike (1e-2), N·s: for the order of modes
/// alone.
const TYPICAL_IMPULSE_N_S: f64 = 1e-4;

/// A body as the audio half owns it.
pub(crate) struct BodySlot {
    bank: Bank,
    /// Number of its groups that are driven at each level of modes left out.
    levels: SheddingLevels,
    places: Vec<Place>,
    /// Number of these that are the body's own; the others are takes that were made.
    positions: usize,
    /// For a body that can be touched anywhere.
    field: Option<BodyField>,
    /// For a body that can be rubbed, and the gains of its only position.
    rub: Option<Box<BodyRub>>,
    ones: Box<[LaneGains]>,
    bursts: Bursts,
    diffuse: Option<Box<DiffuseSeat>>,
    click: Option<Click>,
    /// For a body that is listened to at places of its own.
    pickups: Option<Box<Pickups>>,
    /// Gain of impacts beside strokes.
    strike_gain: f64,
    /// Part that the bank leaves out of the first samples of strikes, in the output's units, as far
    /// ahead as the places' buses.
    early: ImpulseRing<f32>,
}

/// Way of rendering a stretch.
#[derive(Clone, Copy)]
pub(crate) struct RenderArgs {
    /// Absolute index of the first sample.
    pub(crate) position: u64,
    /// Number of the [`MODE_LEVELS`] that are left out because blocks run late.
    pub(crate) mode_level: usize,
    /// False where no bus is there to hear it: then only its pickups ring.
    pub(crate) has_buses: bool,
}

impl BodySlot {
    /// Designs the bank at the engine's inner rate; modes at or above half of the `output_rate_hz`
    /// stay silent. A body without shapes can be rubbed if its mass is known. Where machines are
    /// late its modes are left out as they are missed at this level, that of the loudest.
    pub(crate) fn new(
        model: &ModalModel,
        mass_kg: Option<f64>,
        loudest_db_spl: f64,
        (kernel, seed): (Level, u64),
        (output_rate_hz, sample_rate_hz): (f64, f64),
        pickups: &[PlacedPickup],
    ) -> Result<Self, DesignError> {
        let heard = |mode: &Mode| mode.amplitude != 0.0 && mode.frequency_hz < 0.5 * output_rate_hz;
        let numbered = model.unit_modes().enumerate().filter(|(_, (mode, _))| heard(mode));
        let modes: Vec<(usize, (Mode, [f32; MAX_POSITIONS]))> = numbered.collect();
        // The least important come last; between two levels the longest to ring come first, so that
        // the groups still awake are the first ones.
        let mut order = vec![Ranked::default(); modes.len()];
        let plain: Vec<Mode> = modes.iter().map(|(_, (mode, _))| *mode).collect();
        let levels = modal_bank::shedding_order(&plain, TYPICAL_IMPULSE_N_S, loudest_db_spl, &mut order);
        let modes: Vec<_> = order.iter().map(|ranked| modes[ranked.index]).collect();
        let unit: Vec<(usize, Mode)> = modes.iter().map(|(number, (mode, _))| (*number, *mode)).collect();
        let modes: Vec<_> = modes.into_iter().map(|(_, mode)| mode).collect();
        let plain: Vec<Mode> = unit.iter().map(|(_, mode)| *mode).collect();
        let groups = modal_bank::design_groups(&plain, sample_rate_hz, &GroupOptions::IMPULSE_RING);
        let groups = groups.collect::<Result<Box<[_]>, _>>()?;
        let states = vec![GroupState::REST; groups.len()].into();
        let count = model.position_count();
        let mixed = count > 1 || model.shapes.is_some();
        let first_samples = first_samples(&modes, count, &levels, sample_rate_hz)?;
        let places = first_samples.into_iter().enumerate().map(|(position, first_samples)| {
            let shares = modes.iter().filter(|_| mixed).map(|(_, shares)| shares[position]);
            Place::new(modal_bank::lane_gains(shares).collect(), first_samples, sample_rate_hz)
        });
        let mut places: Vec<Place> = places.collect();
        let residual = model.residual.as_ref().map(|residual| residual.below(0.5 * output_rate_hz));
        let bursts = Bursts::new(residual.as_ref(), model.impulse_n_s, sample_rate_hz);
        let strike = (model.impulse_n_s, model.residual.as_ref());
        let rates = (output_rate_hz, sample_rate_hz);
        let diffuse = model.diffuse.as_ref();
        let diffuse = diffuse.map(|diffuse| DiffuseSeat::new(diffuse, strike, kernel, seed, rates));
        let diffuse = diffuse.transpose()?.flatten();
        let early = ImpulseRing::new(LONGEST_CONTACT_S, sample_rate_hz);
        let field = BodyField::new(model, &unit, &groups, sample_rate_hz)?;
        let units: Option<Box<[f64]>> = match (&field, mass_kg) {
            (Some(field), _) => Some(field.unit_motion().into()),
            (None, Some(mass_kg)) => Some(vec![(ANTINODE / mass_kg).sqrt(); plain.len()].into()),
            (None, None) => None,
        };
        let at = |position: usize| {
            modal_bank::lane_gains(modes.iter().map(|(_, shares)| shares[position])).collect()
        };
        let positions = (0..if field.is_some() { 0 } else { count }).map(at).collect();
        let pickups = match &units {
            Some(units) if !pickups.is_empty() => {
                places.iter_mut().for_each(|place| place.struck = Some(Box::new([0.0; MAX_BLOCK])));
                let gains = |pickup: &PlacedPickup| {
                    let factor = pickup.pickup.factor.unwrap_or(0.0) as f32;
                    let mut gains = vec![LaneGains([factor; modal_bank::LANES]); groups.len()];
                    if let (Some(field), Some(place)) = (&field, &pickup.place) {
                        field.fill(place, &mut gains);
                    }
                    (*pickup, gains)
                };
                let placed: Vec<_> = pickups.iter().map(gains).collect();
                let of = (plain.as_slice(), &units[..]);
                Some(Box::new(Pickups::new(&placed, of, MOST_INPUTS, (kernel, sample_rate_hz))?))
            }
            _ => None,
        };
        let rub = units.map(|units| BodyRub::new(&plain, units, positions, kernel, sample_rate_hz));
        let rub = rub.transpose()?.map(Box::new);
        let ones = vec![LaneGains([1.0; modal_bank::LANES]); groups.len()].into();
        Ok(Self {
            bank: ModalBank::new(kernel, groups, states).in_sections(&levels),
            levels,
            positions: places.len(),
            places,
            field,
            rub,
            ones,
            bursts,
            diffuse,
            click: model.click,
            pickups,
            strike_gain: 1.0,
            early,
        })
    }

    /// Its impacts sound so much louder than mechanics says, linear; the first `positions` of its
    /// model are its own.
    pub(crate) fn struck_with(self, strike_gain: f64, positions: usize) -> Self {
        Self { strike_gain, positions, ..self }
    }

    /// The place of a strike position; one the body does not have counts as its last.
    fn place(&mut self, position: usize) -> &mut Place {
        &mut self.places[position.min(self.positions - 1)]
    }

    /// Adds an impact whose contact begins at `stamp`, while modes are left out as far as
    /// `mode_level`.
    pub(crate) fn strike(
        &mut self,
        spot: &StrikePoint,
        pulse: &HertzPulse,
        stamp: Stamp,
        mode_level: usize,
        sample_rate_hz: f64,
    ) {
        let own = pulse;
        let pulse = &HertzPulse { impulse_n_s: self.strike_gain * pulse.impulse_n_s, ..*pulse };
        let end = pulse.end_sample(stamp.sample(), sample_rate_hz);
        let driven = self.levels[mode_level];
        let anywhere = self.field.as_mut().zip(spot.place.as_ref());
        let (sample, offset) = (stamp.sample(), stamp.fraction());
        // With the modes, which sound the ring's latency later.
        let sounds = sample + KERNEL_LATENCY as u64;
        if let Some((field, place)) = anywhere {
            let missing = field.strike(place, pulse, stamp, driven);
            self.early.write(end, |early| missing.deposit(pulse, early, sample, offset, sample_rate_hz));
            if let Some(pickups) = &mut self.pickups {
                pickups.strike(field.struck_gains(), own, stamp, sample_rate_hz);
            }
        } else {
            for (position, share) in spot.shares(self.positions) {
                let of = |whole: &HertzPulse| HertzPulse { impulse_n_s: share * whole.impulse_n_s, ..*whole };
                let (place, part) = (&mut self.places[position], of(pulse));
                place.bus.deposit(&part, sample, offset, sample_rate_hz);
                let missing = place.first_samples[mode_level];
                self.early.write(end, |early| missing.deposit(&part, early, sample, offset, sample_rate_hz));
                if let Some(pickups) = &mut self.pickups {
                    pickups.strike(&place.gains, &of(own), stamp, sample_rate_hz);
                }
            }
        }
        if let Some(click) = &self.click {
            let samples = click.samples_of(pulse, sample_rate_hz);
            if samples > 0 {
                self.early.write(sounds + samples, |early| {
                    click.deposit(pulse, early, sounds, offset, sample_rate_hz);
                });
            }
        }
        // A burst is noise-like: the whole sample is near enough.
        self.bursts.strike(sounds, pulse.impulse_n_s);
        if let Some(diffuse) = &mut self.diffuse {
            diffuse.strike(pulse, spot.seed, stamp, sample_rate_hz);
        }
    }

    /// Adds what one contact sends during the present stretch to where it is.
    pub(crate) fn touch_at(&mut self, owner: ContactKey, spot: &StrikePoint, impulse_n_s: &[f64]) {
        let anywhere = self.field.as_mut().zip(spot.place.as_ref());
        if !anywhere.is_some_and(|(field, place)| field.touch(owner, place, impulse_n_s)) {
            self.touch(spot.position, impulse_n_s, 1.0);
        } else if let Some(diffuse) = &mut self.diffuse {
            diffuse.touch(impulse_n_s, 1.0);
        }
    }

    /// A contact presses at its place during the coming cell of the grid.
    pub(crate) fn press(&mut self, owner: ContactKey, place: &StrikePlace, probe: &Probe) {
        if let Some(field) = &mut self.field {
            field.press(owner, place, probe);
        }
    }

    /// A contact rubs during the present stretch; false where another one does, or none can.
    pub(crate) fn rub(&mut self, asked: &FrictionInput<'_>) -> bool {
        let field = self.field.as_ref();
        self.rub.as_mut().is_some_and(|rub| rub.ask(asked, field))
    }

    /// Adds what one contact sends during the present stretch.
    pub(crate) fn touch(&mut self, position: usize, impulse_n_s: &[f64], sign: f64) {
        let place = self.place(position);
        place.touched = true;
        for (sum, x) in place.contacts_n_s.iter_mut().zip(impulse_n_s) {
            *sum += sign * x;
        }
        if let Some(diffuse) = &mut self.diffuse {
            diffuse.touch(impulse_n_s, sign);
        }
    }

    /// As it was made; nothing rings, and nothing is on its way.
    pub(crate) fn rested(mut self: Box<Self>) -> Box<Self> {
        self.rest();
        self
    }

    /// Its pickups.
    pub(crate) fn pickups(&mut self) -> Option<&mut Pickups> {
        self.pickups.as_deref_mut()
    }

    /// Silences all that rings.
    fn rest(&mut self) {
        self.bank.silence();
        if let Some(field) = &mut self.field {
            field.silence();
        }
        if let Some(rub) = &mut self.rub {
            rub.silence();
        }
        self.bursts.silence();
        if let Some(pickups) = &mut self.pickups {
            pickups.silence();
        }
        if let Some(diffuse) = &mut self.diffuse {
            diffuse.rest();
        }
    }

    /// Silences all that rings and all that is on its way.
    pub(crate) fn silence(&mut self) {
        self.rest();
        for place in &mut self.places {
            place.bus.clear();
            place.contacts_n_s.fill(0.0);
            place.touched = false;
        }
        self.early.clear();
        if let Some(diffuse) = &mut self.diffuse {
            diffuse.silence();
        }
    }

    /// Level of its ringing: the root of the sum of its modes' squared amplitudes; infinite where
    /// what has struck it has not sounded yet.
    pub(crate) fn loudness(&self, position: u64) -> f32 {
        let waits = !self.places.iter().all(|place| place.is_silent(position));
        let waits = waits || self.field.as_ref().is_some_and(|field| !field.is_silent(position));
        let bands = self.diffuse.as_ref().map_or(0.0, |diffuse| diffuse.energy(position));
        if waits { f32::INFINITY } else { (self.bank.energy() + bands).sqrt() }
    }

    /// Tests whether nothing rings and nothing is coming.
    pub(crate) fn is_silent(&self, position: u64) -> bool {
        self.bank.active_groups() == 0
            && self.bursts.is_silent(position)
            && self.early.is_empty(position)
            && self.places.iter().all(|place| place.is_silent(position))
            && self.field.as_ref().is_none_or(|field| field.is_silent(position))
            && self.rub.as_ref().is_none_or(|rub| rub.is_idle())
            && self.pickups.as_ref().is_none_or(|pickups| pickups.is_silent(position))
            && self.diffuse.as_ref().is_none_or(|diffuse| diffuse.is_silent(position))
    }
}
