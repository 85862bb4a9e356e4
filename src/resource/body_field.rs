//! Strikes and contacts anywhere on a body that has shapes: each has an input of its own into the
//! modal bank, with the gains of its place.
//!
//! A contact that slides changes its gains without a step ([`Slider`]).

use crate::model::modal_model::ModalModel;
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use crate::resource::bank::{Bank, ContactKey, LONGEST_CONTACT_S};
use crate::resource::holding::{HeldModes, Holding};
use crate::resource::impulse_ring::ImpulseRing;
use crate::resource::slider::{self, Slider};
use asperity_dsp::DesignError;
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::micro_contact::Probe;
use asperity_dsp::modal_bank::{Input, LANES, LaneGains, ModeGroup, OnsetCorrection, OnsetSamples};
use asperity_dsp::mode::Mode;
use asperity_surface::height_field::MAX_BLOCK;

/// Contacts that may slide over a body at the same time, each with gains of its own; more excite it
/// where its own amplitudes belong.
pub(crate) const SLIDERS: usize = 16;
/// Strikes at different places whose pulses may overlap; one more strikes where the one that ends
/// first does.
pub(crate) const STRIKES: usize = 8;
/// Inputs that a field may have.
pub(crate) const FIELD_INPUTS: usize = STRIKES + 2 * SLIDERS;

/// The shapes of a body, as the audio half owns them.
pub(crate) struct BodyField {
    /// Motion of every point, mode after mode in the order of the bank, as a share of the amplitude
    /// that the bank was designed with.
    motion: Box<[[f32; 3]]>,
    points: usize,
    missing: Box<[OnsetSamples]>,
    holding: Holding,
    strikes: Box<[Struck]>,
    sliders: Box<[Slider]>,
    /// The one of `strikes` that was struck last.
    last_struck: usize,
    /// Largest change of a gain within a cell.
    glide: f32,
    sample_rate_hz: f64,
    /// Up to where it has been rendered.
    position: u64,
}

/// Somewhere that was struck.
struct Struck {
    gains: Box<[LaneGains]>,
    bus: ImpulseRing,
    input: [f32; MAX_BLOCK],
}

impl BodyField {
    /// For the modes of a bank: each with its number in the model and its amplitude for 1 N·s.
    pub(crate) fn new(
        model: &ModalModel,
        modes: &[(usize, Mode)],
        groups: &[ModeGroup],
        sample_rate_hz: f64,
    ) -> Result<Option<Self>, DesignError> {
        let Some(shapes) = &model.shapes else { return Ok(None) };
        let motion = modes.iter().flat_map(|(number, mode)| {
            let gain = (shapes.gains[*number] / mode.amplitude) as f32;
            shapes.phi_per_sqrt_kg[*number].iter().map(move |phi| phi.map(|x| x * gain))
        });
        let gains = || vec![LaneGains([0.0; LANES]); groups.len()].into_boxed_slice();
        let struck = || Struck {
            gains: gains(),
            bus: ImpulseRing::new(LONGEST_CONTACT_S, sample_rate_hz),
            input: [0.0; MAX_BLOCK],
        };
        let missing = modes.iter().map(|(_, mode)| OnsetSamples::of(mode, sample_rate_hz));
        let missing = missing.collect::<Result<Box<[_]>, _>>()?;
        Ok(Some(Self {
            motion: motion.collect(),
            points: shapes.points_m.len(),
            missing,
            holding: Holding::new(shapes, modes, groups, sample_rate_hz),
            strikes: (0..STRIKES).map(|_| struck()).collect(),
            sliders: (0..SLIDERS).map(|_| Slider::new(groups.len())).collect(),
            last_struck: 0,
            glide: slider::glide(sample_rate_hz),
            sample_rate_hz,
            position: 0,
        }))
    }

    /// A pulse at a place. Returns what the bank leaves out of its first samples while `driven`
    /// groups hear it.
    pub(crate) fn strike(
        &mut self,
        place: &StrikePlace,
        pulse: &HertzPulse,
        stamp: Stamp,
        driven: usize,
    ) -> OnsetCorrection {
        let free = self.strikes.iter().position(|struck| struck.bus.is_empty(self.position));
        let soonest = || (0..STRIKES).min_by_key(|&i| self.strikes[i].bus.busy_until());
        self.last_struck = free.or_else(soonest).unwrap_or(0);
        let struck = &mut self.strikes[self.last_struck];
        if free.is_some() {
            fill(&self.motion, self.points, place, &mut struck.gains);
        }
        struck.bus.deposit(pulse, stamp.sample(), stamp.fraction(), self.sample_rate_hz);
        let mut sum = OnsetSamples::NOTHING;
        let shares = struck.gains.iter().flat_map(|gains| gains.0);
        for (missing, share) in self.missing.iter().zip(shares).take(driven * LANES) {
            sum.add(missing, f64::from(share));
        }
        sum.first_samples()
    }

    /// Gains of the newest strike.
    pub(crate) fn struck_gains(&self) -> &[LaneGains] {
        &self.strikes[self.last_struck].gains
    }

    /// Number of leading inputs that are strikes.
    pub(crate) fn strikes_at(&self, position: u64) -> usize {
        self.strikes.iter().filter(|struck| !struck.bus.is_empty(position)).count()
    }

    /// Adds what a contact sends at its place during the present stretch; false where every slider
    /// is taken.
    pub(crate) fn touch(&mut self, owner: ContactKey, place: &StrikePlace, impulse_n_s: &[f64]) -> bool {
        let known = self.sliders.iter().position(|slider| slider.owner == Some(owner));
        // One that has not been touched for a cell is free.
        let idle = |slider: &Slider| {
            !slider.touched
                && (slider.owner.is_none() || slider.touched_at + 2 * MAX_BLOCK as u64 <= self.position)
        };
        let Some(index) = known.or_else(|| self.sliders.iter().position(idle)) else { return false };
        let slider = &mut self.sliders[index];
        slider.be_at(owner, place, |gains| fill(&self.motion, self.points, place, gains));
        slider.add(impulse_n_s);
        true
    }

    /// A contact presses here during the coming cell.
    pub(crate) fn press(&mut self, owner: ContactKey, place: &StrikePlace, probe: &Probe) {
        let share = |mode: usize| place.motion(&self.motion[mode * self.points..][..self.points]);
        self.holding.press(owner, place, probe, share);
    }

    /// Tests whether nothing is on its way from `position` on.
    pub(crate) fn is_silent(&self, position: u64) -> bool {
        self.strikes.iter().all(|struck| struck.bus.is_empty(position))
            && self.sliders.iter().all(Slider::is_silent)
    }

    /// Drops what is on its way.
    pub(crate) fn silence(&mut self) {
        self.strikes.iter_mut().for_each(|struck| struck.bus.clear());
        self.sliders.iter_mut().for_each(Slider::silence);
    }

    /// Takes the impulses of the next `n` samples.
    pub(crate) fn gather(&mut self, position: u64, n: usize) {
        for struck in self.strikes.iter_mut().filter(|struck| !struck.bus.is_empty(position)) {
            struck.input[..n].fill(0.0);
            struck.bus.take(position, &mut struck.input[..n]);
        }
        let first = position as usize % MAX_BLOCK;
        let sliding = self.sliders.iter_mut().filter(|slider| slider.touched);
        sliding.for_each(|slider| slider.gather(first, n));
    }

    /// Hands over the inputs that were gathered; only what something reaches is mixed.
    pub(crate) fn inputs<'a>(&'a self, position: u64, n: usize, mut add: impl FnMut(Input<'a>)) {
        for struck in self.strikes.iter().filter(|struck| !struck.bus.is_empty(position)) {
            add(Input { impulses: &struck.input[..n], gains: &struck.gains });
        }
        for slider in self.sliders.iter().filter(|slider| slider.touched) {
            slider.inputs(n, &mut add);
        }
    }

    /// The stretch has been rendered, or nothing rings in it; at the end of a cell gains go on. A
    /// group of the bank whose modes have changed, if one has.
    pub(crate) fn end_stretch(&mut self, position: u64, n: usize, bank: &mut Bank) -> Option<usize> {
        self.position = position + n as u64;
        let at_grid = self.position.is_multiple_of(MAX_BLOCK as u64);
        let retuned = if at_grid { self.holding.go_on(bank) } else { None };
        for slider in &mut self.sliders {
            slider.end_stretch(self.position, self.glide);
        }
        retuned
    }

    /// The modes of a group as they are held at present.
    pub(crate) fn modes_now(&self, group: usize) -> Option<HeldModes> {
        self.holding.modes_now(group)
    }

    /// The gains of a place.
    pub(crate) fn fill(&self, place: &StrikePlace, gains: &mut [LaneGains]) {
        fill(&self.motion, self.points, place, gains);
    }

    /// Motion of each mode where its gain is 1, kg^−½.
    pub(crate) fn unit_motion(&self) -> &[f64] {
        self.holding.unit_motion()
    }
}

/// The gains of a place.
fn fill(motion: &[[f32; 3]], points: usize, place: &StrikePlace, gains: &mut [LaneGains]) {
    let lanes = gains.iter_mut().flat_map(|gains| gains.0.iter_mut());
    for (gain, phi) in lanes.zip(motion.chunks_exact(points)) {
        *gain = place.motion(phi);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::mode_shapes::{ModeShapes, Unit};
    use crate::model::strike_field::StrikeField;
    use asperity_dsp::modal_bank::{GroupOptions, GroupState, ModalBank, design_groups};
    use asperity_dsp::simd::Level;
    use std::f64::consts::PI;

    const RATE_HZ: f64 = 44_100.0;
    const SIDE_M: f64 = 0.4;

    /// Modes 1 to 6 of a strip held at its ends.
    fn strip() -> ModalModel {
        let stations = 100;
        let point = |i: usize| [SIDE_M * (i / 2) as f64 / stations as f64, 0.01 * (i % 2) as f64, 0.0];
        let points_m: Vec<[f64; 3]> = (0..2 * (stations + 1)).map(point).collect();
        let quads = (0..stations as u32).map(|i| 2 * i);
        let triangles = quads.flat_map(|a| [[a, a + 2, a + 3], [a, a + 3, a + 1]]).collect();
        let shape = |m: usize, p: &[f64; 3]| ((m + 1) as f64 * PI * p[0] / SIDE_M).sin();
        let phi = |m: usize| points_m.iter().map(|p| [0.0, 0.0, shape(m, p) as f32]).collect();
        let shapes = ModeShapes {
            gains: vec![1.0; 6],
            phi_per_sqrt_kg: (0..6).map(phi).collect(),
            points_m: points_m.clone(),
            triangles,
            struck_point: 21,
        };
        let mode = |m: usize| Mode {
            frequency_hz: 100.0 * (m + 1) as f64,
            decay_per_s: 3.0,
            amplitude: 0.3,
            phase_rad: 0.0,
        };
        let model = ModalModel::new((0..6).map(mode).collect(), 1.0).unwrap();
        model.with_shapes(shapes, Unit::Relative).unwrap()
    }

    #[test]
    fn gains_of_a_sliding_contact_arrive_without_a_step() {
        let model = strip();
        let places = StrikeField::new(model.shapes.clone().unwrap());
        // As the bank is designed: each at its amplitude where it swings most, so that the greatest
        // gain is 1.
        let modes: Vec<(usize, Mode)> = model.unit_modes().map(|(mode, _)| mode).enumerate().collect();
        let groups = design_groups(&model.modes, RATE_HZ, &GroupOptions::IMPULSE_RING);
        let groups: Box<[ModeGroup]> = groups.collect::<Result<_, _>>().unwrap();
        let mut field = BodyField::new(&model, &modes, &groups, RATE_HZ).unwrap().unwrap();
        let states: Box<[GroupState]> = vec![GroupState::REST; groups.len()].into();
        let mut bank: Bank = ModalBank::new(Level::PORTABLE, groups, states);
        let (mut last, mut worst, mut place) = ([None; 6], 0.0_f32, None);
        for cell in 0..800_u64 {
            let position = cell * MAX_BLOCK as u64;
            let t = position as f64 / RATE_HZ;
            // Reports 60 times a second, at 0.3 m/s; it stops in the end.
            let reported_s = (60.0 * t).floor() / 60.0;
            place = places.place([0.02 + 0.3 * reported_s.min(1.0), 0.005, 0.0], None).or(place);
            assert!(field.touch((3, 0), &place.unwrap(), &[1e-6; MAX_BLOCK]));
            field.gather(position, MAX_BLOCK);
            for i in 0..MAX_BLOCK {
                let mut heard = [0.0; 6];
                field.inputs(position, MAX_BLOCK, |input| {
                    for (heard, gain) in heard.iter_mut().zip(&input.gains[0].0) {
                        *heard += 1e6 * input.impulses[i] * gain;
                    }
                });
                for (last, heard) in last.iter_mut().zip(heard) {
                    if let Some(before) = last.replace(heard) {
                        worst = worst.max((heard - before).abs());
                    }
                }
            }
            field.end_stretch(position, MAX_BLOCK, &mut bank);
        }
        // Against the greatest gain, which is 1.
        let worst_db = 20.0 * worst.log10();
        println!("{worst_db:.1} dB");
        assert!(worst_db <= -60.0, "{worst_db} dB");
        let wanted = places.amplitudes(&place.unwrap());
        for (m, wanted) in wanted.into_iter().enumerate() {
            // A gain of 1 is the most that any point of the mesh swings by.
            let most = (0..=100).map(|i| ((m + 1) as f64 * PI * f64::from(i) / 100.0).sin().abs());
            let there = f64::from(last[m].unwrap()) * most.fold(0.0, f64::max);
            assert!((there - wanted).abs() < 1e-4, "mode {m}: {there} of {wanted}");
        }
    }
}
