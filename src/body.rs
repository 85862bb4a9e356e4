//! A body that rings: its modal bank and the impulse bus that excites it.

use crate::modal_model::ModalModel;
use crate::queue::{Dead, Sender};
use crate::voice::pulse_end;
use asperity_dsp::DesignError;
use asperity_dsp::hertz::{self, HertzPulse};
use asperity_dsp::modal_bank::{self, Awake, GroupOptions, GroupState, Kernel, ModeGroup};
use asperity_texture::height_field::MAX_BLOCK;

/// Samples of impulse that a body's bus can hold ahead: the longest impact that is rendered whole is
/// 85 ms at 96 kHz.
const BUS_SAMPLES: usize = 8192;

/// A body as the audio half owns it.
pub(crate) struct BodySlot {
    groups: Vec<ModeGroup>,
    states: Vec<GroupState>,
    awake: Awake,
    bus: Vec<f64>,
    bus_busy_until: u64,
}

impl BodySlot {
    /// Designs the bank at the engine's rate; modes at or above Nyquist stay silent.
    pub(crate) fn new(model: &ModalModel, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let mut modes: Vec<_> = model.unit_modes().filter(|m| m.amplitude != 0.0).collect();
        // Slow decays first, so that the groups still awake are always a prefix.
        modal_bank::sort_by_decay(&mut modes);
        let options = GroupOptions::IMPULSE_RING;
        let groups = modes
            .chunks(modal_bank::LANES)
            .map(|chunk| modal_bank::design_group(chunk, sample_rate_hz, &options))
            .collect::<Result<Vec<_>, _>>()?;
        let states = vec![GroupState::default(); groups.len()];
        Ok(Self { groups, states, awake: Awake::default(), bus: vec![0.0; BUS_SAMPLES], bus_busy_until: 0 })
    }

    /// Adds an impact whose contact begins at `sample`.
    pub(crate) fn strike(&mut self, pulse: &HertzPulse, sample: u64, sample_rate_hz: f64) {
        pulse.deposit(&mut self.bus, sample, 0.0, sample_rate_hz);
        self.bus_busy_until = self.bus_busy_until.max(pulse_end(pulse, sample, sample_rate_hz));
    }

    /// Whether nothing rings and nothing is coming.
    pub(crate) fn is_silent(&self, position: u64) -> bool {
        self.awake.groups() == 0 && self.bus_busy_until <= position
    }

    /// Adds the body's sound to `out`. `contacts_n_s` is what touching contacts send at each sample,
    /// and `touched` whether any contact touches.
    pub(crate) fn render(
        &mut self,
        kernel: Kernel,
        position: u64,
        contacts_n_s: &[f64],
        touched: bool,
        out: &mut [f32],
    ) {
        if !touched && self.is_silent(position) {
            return;
        }
        let mut input = [0.0f32; MAX_BLOCK];
        let input = &mut input[..out.len()];
        // The bus is empty beyond the last impact.
        if self.bus_busy_until > position {
            hertz::take(&mut self.bus, position, input);
        }
        for (x, contact) in input.iter_mut().zip(contacts_n_s) {
            *x += *contact as f32;
        }
        let (groups, states) = (&self.groups, &mut self.states);
        self.awake.render(kernel, position, groups, states, input, out, modal_bank::SLEEP_AMPLITUDE);
    }
}

/// A body's place on the audio half. A replaced or removed body rings on without input and fades.
#[derive(Default)]
pub(crate) struct BodySeat {
    current: Option<Box<BodySlot>>,
    leaving: [Option<Leaving>; LEAVING],
    input: Input,
}

/// Replacements of one body that may still be fading at the same time; more wait in the queue.
const LEAVING: usize = 4;
/// How many samples a body that leaves takes to fade.
const LEAVING_SAMPLES: u32 = 4096;

struct Leaving {
    body: Box<BodySlot>,
    left: u32,
}

/// What contacts send to the body during the present stretch.
struct Input {
    impulse_n_s: [f64; MAX_BLOCK],
    touched: bool,
}

impl Default for Input {
    fn default() -> Self {
        Self { impulse_n_s: [0.0; MAX_BLOCK], touched: false }
    }
}

impl BodySeat {
    /// Whether the body can be replaced now.
    pub(crate) fn can_change(&self) -> bool {
        self.leaving.iter().any(Option::is_none)
    }

    /// Whether nothing is here and nothing fades.
    pub(crate) fn is_empty(&self) -> bool {
        self.current.is_none() && self.leaving.iter().all(Option::is_none)
    }

    /// Puts a body here; the one before it rings out.
    pub(crate) fn set(&mut self, body: Box<BodySlot>) {
        self.remove();
        self.current = Some(body);
    }

    /// Lets the body ring out.
    pub(crate) fn remove(&mut self) {
        if let Some(place) = self.leaving.iter_mut().find(|place| place.is_none()) {
            *place = self.current.take().map(|body| Leaving { body, left: LEAVING_SAMPLES });
        }
    }

    /// Adds an impact whose contact begins at `sample`.
    pub(crate) fn strike(&mut self, pulse: &HertzPulse, sample: u64, sample_rate_hz: f64) {
        if let Some(body) = &mut self.current {
            body.strike(pulse, sample, sample_rate_hz);
        }
    }

    /// Adds what one contact sends.
    pub(crate) fn touch(&mut self, impulse_n_s: &[f64]) {
        self.input.touched = true;
        for (sum, x) in self.input.impulse_n_s.iter_mut().zip(impulse_n_s) {
            *sum += x;
        }
    }

    /// Adds the sound of the next `out.len()` samples to `out`.
    pub(crate) fn render(&mut self, kernel: Kernel, position: u64, out: &mut [f32]) {
        let n = out.len();
        if let Some(body) = &mut self.current {
            let input = &self.input;
            body.render(kernel, position, &input.impulse_n_s[..n], input.touched, out);
        }
        if self.input.touched {
            self.input = Input::default();
        }
        for leaving in self.leaving.iter_mut().flatten() {
            let mut tail = [0.0f32; MAX_BLOCK];
            leaving.body.render(kernel, position, &[0.0; MAX_BLOCK][..n], false, &mut tail[..n]);
            for (sum, x) in out.iter_mut().zip(&tail) {
                leaving.left = leaving.left.saturating_sub(1);
                *sum += x * (leaving.left as f32 / LEAVING_SAMPLES as f32);
            }
        }
    }

    /// Sends bodies that have left home.
    pub(crate) fn tidy(&mut self, position: u64, home: &mut Sender<Dead>) {
        for place in &mut self.leaving {
            let gone = place.as_ref().is_some_and(|l| l.left == 0 || l.body.is_silent(position));
            if let Some(Leaving { body, left }) = gone.then(|| place.take()).flatten() {
                if let Err(Dead::Body(body)) = home.send(Dead::Body(body)) {
                    *place = Some(Leaving { body, left });
                }
            }
        }
    }
}
