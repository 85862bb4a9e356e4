//! The audio half: applies events at their samples, runs the voices, rings the bodies, mixes.
//!
//! Everything here is infallible and free of allocation, locks, logging and clocks; all memory was
//! made by [`Config::build`](crate::Config::build). Time is cut at events and on an absolute grid
//! of [`MAX_BLOCK`] samples, never relative to the caller's blocks, so any split renders the same
//! bits.

mod clips;
mod contacts;
mod hand_over;
mod messages;
mod meter;
mod outputs;
mod pickups;
mod render;
mod render_pool;
mod tails;
pub(crate) mod tape;
mod tidy;
mod voices;

use crate::audio::blows::Blows;
use crate::audio::body_seat::BodySeat;
use crate::audio::governor::{Governor, OVERLOAD_SHARE, Work};
use crate::audio::index_set::IndexSet;
use crate::audio::outlets::Outlets;
use crate::audio::seat::Seat;
use crate::audio::shared::Shared;
use crate::audio::smoothed::Smoothed;
use crate::audio::voice::{Scratch, Voice};
use crate::link::message::{Message, Retired};
use crate::link::ring::{Receiver, Sender};
use crate::link::stats::Counters;
use crate::model::config::Config;
use crate::model::error::ConfigError;
use crate::model::inner_rate::InnerRate;
use crate::model::strike_field::StrikePlace;
use crate::resource::probe::{PreparedProbe, row_latency};
use asperity_dsp::actuator::{ContactOutput, Quantity, RELEASE_S};
use asperity_dsp::fractal_noise::FractalNoise;
use asperity_dsp::hertz::KERNEL_LATENCY;
use asperity_dsp::simd::{Isa, Level};
use asperity_dsp::trajectory::TrajectoryDesign;
use asperity_surface::height_field::MAX_BLOCK;
use clips::Clips;
use contacts::SilentContact;
use outputs::{Bus, HapticChannel, Mix};
use pickups::PickupChannel;
use render_pool::RenderPool;
use std::sync::Arc;
use tails::TAILS;
use tape::Tape;

/// The audio half of an engine.
pub struct Renderer {
    position: u64,
    /// Samples that have left.
    given: u64,
    tape: Tape,
    /// Resets of the game's time so far.
    resets: u64,
    /// Threads read it while they render; between two stretches nobody else holds it.
    shared: Arc<Shared>,
    timeout_samples: u64,
    max_contacts: usize,
    /// Boxed, so that they change hands without being copied.
    #[allow(clippy::vec_box, reason = "see above")]
    voices: Vec<Box<Voice>>,
    /// Place of each voice on a body that has shapes.
    placed: Vec<Option<StrikePlace>>,
    silent: Vec<SilentContact>,
    seats: Vec<Seat>,
    /// At the places that the game names, and behind them those that ring out.
    bodies: Vec<BodySeat>,
    /// Which of the three are in use, so that empty places cost nothing.
    voices_used: IndexSet,
    seats_used: IndexSet,
    bodies_used: IndexSet,
    channels: Vec<HapticChannel>,
    buses: Vec<Bus>,
    pickups: Vec<PickupChannel>,
    blows: Blows,
    clips: Clips,
    outlets: Outlets,
    kernel: Level,
    governor: Governor,
    /// Groups of modes left out in the present stretch.
    groups_shed: usize,
    from_game: Receiver<Message>,
    to_game: Sender<Retired>,
    counters: Arc<Counters>,
    muted: bool,
    paused: bool,
    /// On its way to silence or back.
    master: Smoothed,
    /// Other threads, where there are any.
    pool: Option<RenderPool>,
    scratch: Box<Scratch>,
    mix: Box<Mix>,
}

impl Renderer {
    pub(crate) fn new(
        config: &Config,
        kernel: Level,
        probe: PreparedProbe,
        from_game: Receiver<Message>,
        to_game: Sender<Retired>,
        counters: Arc<Counters>,
    ) -> Result<Self, ConfigError> {
        let rate = config.inner_rate_hz();
        let row_latency = row_latency(config.integrator);
        let inner = InnerRate::new(config.inner_samples(), row_latency);
        let shared = Shared {
            sample_rate_hz: rate,
            inner,
            inner_audio: InnerRate::new(config.inner_samples(), row_latency + KERNEL_LATENCY),
            slow_step: (MAX_BLOCK * config.oversampling) as u64,
            idle_path: TrajectoryDesign::new(config.path, config.path_cutoff_hz, rate, [f64::INFINITY; 2])?,
            idle_output: ContactOutput::new(Quantity::Displacement, 0.0, rate)?,
            own_probe: probe,
            probes: (0..config.max_probes).map(|_| None).collect(),
            row_latency,
            noise: FractalNoise::new(config.seed).on(kernel),
            fade: raised_cosine((RELEASE_S * rate).ceil() as usize),
        };
        let voices = config.voices();
        let bodies = config.max_bodies + TAILS;
        let sizes = (voices, config.max_surfaces, bodies);
        let pool = (config.threads > 1).then(|| RenderPool::new(config.threads, sizes, &shared)).transpose();
        let pool =
            pool.map_err(|error| ConfigError::Threads { threads: config.threads, error: error.kind() })?;
        Ok(Self {
            position: 0,
            given: 0,
            tape: Tape::new(config.actuators.len() + config.audio.len() + config.pickups.len(), 0),
            resets: 0,
            timeout_samples: (config.contact_timeout_s * rate) as u64,
            max_contacts: config.max_contacts,
            voices: (0..voices).map(|slot| Box::new(Voice::free(slot, &shared))).collect(),
            placed: vec![None; voices],
            voices_used: IndexSet::new(voices),
            seats_used: IndexSet::new(config.max_surfaces),
            bodies_used: IndexSet::new(bodies),
            silent: Vec::with_capacity(config.max_contacts),
            seats: (0..config.max_surfaces).map(|_| Seat::default()).collect(),
            bodies: (0..bodies).map(|_| BodySeat::new(rate)).collect(),
            channels: config
                .actuators
                .iter()
                .map(|settings| HapticChannel::new(settings, rate))
                .collect::<Result<_, _>>()?,
            buses: config.audio.iter().map(|bus| Bus::new(bus, rate)).collect::<Result<_, _>>()?,
            pickups: PickupChannel::all(config)?,
            blows: Blows::new(rate),
            clips: Clips::new(config.actuators.len(), rate),
            outlets: Outlets::new(config.max_ports, config.actuators.len()),
            kernel,
            governor: Governor::new(config.shed_load, rate),
            groups_shed: 0,
            from_game,
            to_game,
            counters,
            muted: false,
            paused: false,
            master: Smoothed::new(rate),
            pool,
            scratch: Scratch::new(),
            mix: Mix::new(),
            shared: Arc::new(shared),
        })
    }

    /// Number of haptic channels.
    #[must_use]
    pub fn haptic_channels(&self) -> usize {
        self.channels.len()
    }

    /// Number of audio buses.
    #[must_use]
    pub fn audio_buses(&self) -> usize {
        self.buses.len()
    }

    /// The instruction set of the kernels whose last bits depend on it
    /// ([`Config::kernel`](field@Config::kernel)).
    #[must_use]
    pub fn kernel(&self) -> Isa {
        self.kernel.isa()
    }

    /// Rate of every output, Hz.
    #[must_use]
    pub fn sample_rate_hz(&self) -> f64 {
        self.shared.sample_rate_hz / self.shared.inner.every as f64
    }

    /// Rate inside, Hz.
    pub(crate) fn inner_rate_hz(&self) -> f64 {
        self.shared.sample_rate_hz
    }

    /// Samples by which haptic outputs lag behind the stamps of their events, besides the delay of
    /// the path filter: the look-ahead of the contact model. Sound lags by
    /// [`audio_latency_samples`](Self::audio_latency_samples).
    #[must_use]
    pub fn latency_samples(&self) -> usize {
        self.shared.inner.lag(self.shared.row_latency)
    }

    /// Samples by which the audio buses lag behind the stamps of their events: two inner samples
    /// more than [`latency_samples`](Self::latency_samples), 45 µs at 44.1 kHz, the middle of the
    /// kernel that spreads pulses over samples ([`KERNEL_LATENCY`]). From four inner samples a
    /// sample on, nothing of it is left.
    #[must_use]
    pub fn audio_latency_samples(&self) -> usize {
        self.shared.inner_audio.lag(self.shared.row_latency + KERNEL_LATENCY)
    }

    /// Index of the next sample to be rendered.
    #[must_use]
    #[expect(clippy::misnamed_getters, reason = "outside, samples are counted as they leave")]
    pub fn position(&self) -> u64 {
        self.given
    }

    /// Index of the next sample in the game's time: it falls behind [`position`](Self::position)
    /// where pitch bends down.
    pub(crate) fn game_position(&self) -> u64 {
        self.position / self.shared.inner.every as u64
    }

    /// Samples that surely leave before `ahead` more are rendered in the game's time.
    pub(crate) fn frames_within(&self, ahead: usize) -> usize {
        if !self.tape.runs() {
            return ahead;
        }
        let fits = |frames: &usize| self.tape.most_written(*frames) <= ahead;
        let guess = (ahead as f64 / self.tape.scale().max(1.0)) as usize;
        [guess, guess.saturating_sub(64)].into_iter().find(fits).unwrap_or(0)
    }

    /// Reports which share of its time budget the last block took (1 = all of it); the
    /// device measures it, because nothing in here reads a clock. Shown in
    /// [`Stats::load`](crate::Stats::load). When blocks run late, the least audible work is left
    /// out ([`Config::shed_load`](crate::Config::shed_load)).
    pub fn report_load(&mut self, load: f32) {
        self.counters.set_load(load);
        let work = if load > OVERLOAD_SHARE { self.work() } else { Work::default() };
        self.governor.update(load, self.position, work);
        for _ in self.contact_limit()..self.sounding_count() {
            Counters::add(&self.counters.shed, 1);
            self.silence_least();
        }
    }

    /// Work of the last block.
    fn work(&self) -> Work {
        let bodies = self.bodies_used.iter().map(|index| self.bodies[index].modes_and_spared(self.position));
        let (modes, spared) = bodies.fold((0, 0), |sum, body| (sum.0 + body.0, sum.1 + body.1));
        Work { contacts: self.sounding_count(), modes, spared }
    }

    /// Changes what all voices need.
    fn change_shared(&mut self, change: impl FnOnce(&mut Shared)) {
        // Every job has given its share of it back before it came home, so this is always the only
        // one.
        if let Some(shared) = Arc::get_mut(&mut self.shared) {
            change(shared);
        }
    }

    /// Number of contacts that may sound at present.
    fn contact_limit(&self) -> usize {
        self.governor.contacts(self.max_contacts)
    }
}

/// A rise from 0 to 1 in `steps` steps, without step or corner.
fn raised_cosine(steps: usize) -> Box<[f64]> {
    let at = |step: usize| 0.5 - 0.5 * libm::cos(std::f64::consts::PI * step as f64 / steps as f64);
    (0..=steps).map(at).collect()
}

crate::opaque::debug_by_name!(Renderer);
