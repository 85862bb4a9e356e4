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
mod render_pool;
mod tails;
pub(crate) mod tape;
mod voices;

use crate::audio::blows::Blows;
use crate::audio::body_seat::BodySeat;
use crate::audio::governor::{Governor, OVERLOAD_SHARE, Work};
use crate::audio::index_set::IndexSet;
use crate::audio::outlets::Outlets;
use crate::audio::seat::Seat;
use crate::audio::shared::Shared;
use crate::audio::smoothed::Smoothed;
use crate::audio::voice::{Scratch, Voice, VoiceState};
use crate::link::message::{Message, Retired};
use crate::link::ring::{Receiver, Sender};
use crate::link::stats::Counters;
use crate::link::tap::{NoTap, Tap};
use crate::model::config::Config;
use crate::model::error::ConfigError;
use crate::model::id::SurfaceId;
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
use outputs::{Bus, HapticChannel, Mix, clear_beyond};
use pickups::PickupChannel;
use render_pool::RenderPool;
use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
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
    crew: Option<RenderPool>,
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
        let crew = (config.threads > 1).then(|| RenderPool::new(config.threads, sizes, &shared)).transpose();
        let crew =
            crew.map_err(|error| ConfigError::Threads { threads: config.threads, error: error.kind() })?;
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
            crew,
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

    /// Tells the engine which share of its time budget the last block took (1 = all of it); the
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

    /// Renders the next samples: one slice a channel, all equally long (if they are not, the
    /// shortest counts and the rest is silent). Haptic channel i goes into haptic slice i, audio
    /// bus i into audio slice i, both in the order of the config.
    ///
    /// ```
    /// use asperity::{ActuatorSettings, AudioBus, Config, Engine};
    ///
    /// let config = Config {
    ///     actuators: vec![ActuatorSettings::default(); 3],
    ///     audio: vec![AudioBus::default(); 2],
    ///     ..Config::default()
    /// };
    /// let Engine { mut renderer, .. } = config.build()?;
    /// let (mut haptic, mut audio) = ([[0.0f32; 128]; 3], [[0.0f32; 128]; 2]);
    /// renderer.render(&mut haptic.each_mut().map(|c| &mut c[..]), &mut audio.each_mut().map(|c| &mut c[..]));
    /// # Ok::<(), asperity::ConfigError>(())
    /// ```
    pub fn render(&mut self, haptic: &mut [&mut [f32]], audio: &mut [&mut [f32]]) {
        self.render_tapped(haptic, audio, &mut NoTap);
    }

    /// [`render`](Self::render), and what the [pickups](crate::Pickup) read: channel i of
    /// [`Config::pickups`](field@crate::Config::pickups) into slice i. They lag as the audio does
    /// ([`audio_latency_samples`](Self::audio_latency_samples)).
    pub fn render_with_pickups(
        &mut self,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
    ) {
        self.render_all(haptic, audio, pickups, &mut NoTap);
    }

    /// [`render`](Self::render), with a view into every contact.
    pub fn render_tapped<T: Tap>(
        &mut self,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        tap: &mut T,
    ) {
        self.render_all(haptic, audio, &mut [], tap);
    }

    pub(crate) fn render_all<T: Tap>(
        &mut self,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
        tap: &mut T,
    ) {
        let frames = shortest(haptic).min(shortest(audio)).min(shortest(pickups));
        let frames = if frames == usize::MAX { 0 } else { frames };
        self.clear_what_nobody_writes(frames, haptic, audio);
        clear_beyond(pickups, |index| if index < self.pickups.len() { frames } else { 0 });
        let split = [self.channels.len(), self.channels.len() + self.buses.len()];
        let mut done = 0;
        while done < frames {
            let wanted = if self.tape.runs() { self.tape.missing() } else { frames - done };
            if wanted > 0 {
                let ran = self.tape.runs();
                let n = self.render_on(done, wanted.min(frames - done), haptic, audio, pickups, tap);
                self.tape.write((done, n), haptic, audio, pickups, split, ran);
                done += if ran { 0 } else { n };
            } else {
                self.tape.read(done, haptic, audio, pickups, split);
                done += 1;
            }
        }
        self.given += frames as u64;
        self.counters.position.store(self.position, Relaxed);
    }

    /// Renders `frames` samples in the game's time, into the outputs from `at` on; as many as were
    /// rendered, fewer where the tape begins to run.
    fn render_on<T: Tap>(
        &mut self,
        at: usize,
        frames: usize,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
        pickups: &mut [&mut [f32]],
        tap: &mut T,
    ) -> usize {
        let every = self.shared.inner.every;
        let (mut done, end, ran) = (at * every, (at + frames) * every, self.tape.runs());
        while done < end {
            self.apply_due();
            if self.tape.runs() && !ran && done.is_multiple_of(every) {
                break;
            }
            let n = self.stretch(end - done);
            self.render_contacts(n, tap);
            if self.outlets.are_open() {
                let shown = (self.position + n as u64).saturating_sub(self.shared.row_latency as u64);
                self.outlets.shown(shown / self.shared.inner.every as u64);
            }
            self.render_master(n);
            self.render_haptics(done, n, haptic);
            self.render_bodies(done, n, audio);
            self.render_pickups(done, n, pickups);
            done += n;
            self.position += n as u64;
            if self.position.is_multiple_of(MAX_BLOCK as u64) {
                self.tidy();
            }
        }
        done / every - at
    }

    /// Results of the surfaces' sources, at the end of a render.
    pub(crate) fn finish(&mut self) -> Vec<(SurfaceId, Box<dyn Any>)> {
        let position = self.position;
        let named = self.seats.iter_mut().filter_map(|seat| Some((seat.id()?, seat)));
        named
            .flat_map(|(id, seat)| seat.finish(position).into_iter().map(move |result| (id, result)))
            .collect()
    }

    /// Once every [`MAX_BLOCK`] samples: contacts that lapsed, modes that rang out, memory to free.
    fn tidy(&mut self) {
        self.show_levels();
        self.outlets.tidy(&mut self.to_game);
        self.clips.tidy(self.position, &mut self.to_game);
        self.voices_used.retain(|voice| self.voices[voice].phase != VoiceState::Free);
        for at in 0..self.voices_used.len() {
            let index = self.voices_used.at(at);
            let voice = &self.voices[index];
            let lapsed = self.position.saturating_sub(voice.refreshed) > self.timeout_samples;
            if voice.phase == VoiceState::Sounding && lapsed {
                Counters::add(&self.counters.lapsed, 1);
                self.silence(index, false);
            }
        }
        self.seats_used.retain(|index| {
            let sounds = |voice: usize| self.voices[voice].phase != VoiceState::Free;
            let in_use = || self.voices_used.iter().any(|v| self.voices[v].surface == index && sounds(v));
            self.seats[index].tidy(self.position, in_use, &mut self.to_game);
            !self.seats[index].is_empty()
        });
        self.bodies_used.retain(|index| {
            self.bodies[index].tidy(self.position, &mut self.to_game);
            !self.bodies[index].is_empty()
        });
        let sounding = self.sounding_count() as u64;
        Counters::add(&self.counters.shed, self.groups_shed as u64);
        self.counters.contacts.store(sounding, Relaxed);
    }
}

/// A rise from 0 to 1 in `steps` steps, without step or corner.
fn raised_cosine(steps: usize) -> Box<[f64]> {
    let at = |step: usize| 0.5 - 0.5 * libm::cos(std::f64::consts::PI * step as f64 / steps as f64);
    (0..=steps).map(at).collect()
}

/// Length of the shortest channel; `usize::MAX` when there is none.
fn shortest(channels: &[&mut [f32]]) -> usize {
    channels.iter().map(|channel| channel.len()).min().unwrap_or(usize::MAX)
}

crate::opaque::debug_by_name!(Renderer);
