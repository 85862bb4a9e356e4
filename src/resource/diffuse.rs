//! Diffuse bands of one body: what reaches them, and their sound.

use crate::model::diffuse::Diffuse;
use crate::model::residual::Residual;
use crate::model::stamp::Stamp;
use crate::resource::bank::LONGEST_CONTACT_S;
use crate::resource::impulse_ring::ImpulseRing;
use asperity_dsp::DesignError;
use asperity_dsp::diffuse::{
    BANDS, DiffuseBand, DiffuseBank, DiffuseGroup, DiffuseInput, DiffusePart, DiffuseState, RISE_A_BURST,
};
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::simd::Level;
use asperity_surface::height_field::MAX_BLOCK;

/// Rise time without a burst, s: nothing rises then.
const NO_RISE_S: f64 = 0.01;

/// The bands of one body, and the impulses on their way to them.
pub(crate) struct DiffuseSeat {
    bank: DiffuseBank<Box<[DiffuseGroup]>, Box<[DiffuseState]>>,
    /// Strikes, and whether they play a burst.
    bus: ImpulseRing,
    bursts: bool,
    /// Impulses of contacts during the present stretch.
    contacts_n_s: [f64; MAX_BLOCK],
    touched: bool,
}

impl DiffuseSeat {
    /// The bands below half of the `output_rate_hz`, at the engine's inner rate; none without any.
    pub(crate) fn new(
        diffuse: &Diffuse,
        (impulse_n_s, burst): (f64, Option<&Residual>),
        kernel: Level,
        seed: u64,
        (output_rate_hz, sample_rate_hz): (f64, f64),
    ) -> Result<Option<Box<Self>>, DesignError> {
        let per_square = (impulse_n_s * impulse_n_s).recip();
        let part = |part: &DiffusePart| DiffusePart { energy: per_square * part.energy, ..*part };
        let heard = diffuse.bands.iter().filter(|band| band.centre_hz < 0.5 * output_rate_hz);
        let bands = heard.map(|band| {
            let parts = std::array::from_fn(|i| band.parts.get(i).map(part).unwrap_or_default());
            DiffuseBand { centre_hz: band.centre_hz, width_hz: band.width_hz, parts }
        });
        let bands: Vec<DiffuseBand> = bands.collect();
        if bands.is_empty() {
            return Ok(None);
        }
        let rise_s = burst.map_or(NO_RISE_S, |burst| (RISE_A_BURST * burst.seconds()).max(1e-3));
        let groups = bands.chunks(BANDS).zip(seed..);
        let groups = groups.map(|(bands, seed)| DiffuseGroup::new(bands, rise_s, seed, sample_rate_hz));
        let groups = groups.collect::<Result<Box<[_]>, _>>()?;
        let states = vec![DiffuseState::REST; groups.len()].into();
        Ok(Some(Box::new(Self {
            bank: DiffuseBank::new(kernel, groups, states),
            bus: ImpulseRing::new(LONGEST_CONTACT_S, sample_rate_hz),
            bursts: burst.is_some(),
            contacts_n_s: [0.0; MAX_BLOCK],
            touched: false,
        })))
    }

    /// Adds an impact whose contact begins at `stamp`.
    pub(crate) fn strike(&mut self, pulse: &HertzPulse, seed: u32, stamp: Stamp, sample_rate_hz: f64) {
        self.bank.wake_with(seed);
        self.bus.deposit(pulse, stamp.sample(), stamp.fraction(), sample_rate_hz);
    }

    /// Adds what one contact sends during the present stretch.
    pub(crate) fn touch(&mut self, impulse_n_s: &[f64], sign: f64) {
        self.touched = true;
        for (sum, x) in self.contacts_n_s.iter_mut().zip(impulse_n_s) {
            *sum += sign * x;
        }
    }

    /// Adds the sound of the next samples to `out`.
    pub(crate) fn render(&mut self, position: u64, out: &mut [f32]) {
        if self.is_silent(position) {
            return;
        }
        let n = out.len();
        let (mut all, mut strikes) = ([0.0_f32; MAX_BLOCK], [0.0_f32; MAX_BLOCK]);
        let struck = !self.bus.is_empty(position);
        if struck {
            self.bus.take(position, &mut strikes[..n]);
        }
        if std::mem::take(&mut self.touched) {
            let contacts = self.contacts_n_s.iter_mut().zip(&mut all).take(n);
            contacts.for_each(|(contact, x)| *x = std::mem::take(contact) as f32);
        }
        all.iter_mut().zip(&strikes).take(n).for_each(|(x, strike)| *x += strike);
        let rising = if self.bursts { &strikes[..n] } else { &[] };
        self.bank.render(DiffuseInput { all: &all[..n], rising }, out);
    }

    /// Sum of the bands' squared amplitudes; infinite while something is on its way.
    pub(crate) fn energy(&self, position: u64) -> f32 {
        if self.bus.is_empty(position) && !self.touched { self.bank.energy() } else { f32::INFINITY }
    }

    /// Tests whether nothing sounds and nothing is coming.
    pub(crate) fn is_silent(&self, position: u64) -> bool {
        self.bank.is_at_rest() && !self.touched && self.bus.is_empty(position)
    }

    /// Puts what sounds to rest.
    pub(crate) fn rest(&mut self) {
        self.bank.silence();
    }

    /// Puts what sounds to rest, and drops what is on its way.
    pub(crate) fn silence(&mut self) {
        self.rest();
        self.bus.clear();
        self.contacts_n_s.fill(0.0);
        self.touched = false;
    }
}
