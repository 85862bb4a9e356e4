//! Output stage: the haptic channels with their actuators, and the audio buses.

use super::Renderer;
use super::meter::Meter;
use crate::audio::body_seat::BodySeat;
use crate::audio::smoothed::Smoothed;
use crate::model::actuator::{ACCELERATION_BAND_HZ, ActuatorSettings};
use crate::model::bus::AudioBus;
use crate::model::inner_rate::InnerRate;
use crate::resource::body::RenderArgs;
use crate::resource::impulse_ring::ImpulseRing;
use asperity_dsp::DesignError;
use asperity_dsp::actuator::{
    self, ChannelControl, ChannelOptions, ChannelState, ContactOutput, PeakLimiter, PeakLimiterState,
    Quantity,
};
use asperity_dsp::butterworth::{self, Butterworth};
use asperity_dsp::limits::output as limits;
use asperity_surface::height_field::MAX_BLOCK;
use std::sync::atomic::Ordering::Relaxed;

/// Ceiling of the limiters: full scale.
const CEILING: f64 = 1.0;

/// An actuator: what its contacts add up to, and the stage that drives it.
pub(super) struct HapticChannel {
    pub(super) output: ContactOutput,
    design: actuator::Channel,
    pub(super) control: ChannelControl,
    state: ChannelState,
    /// Twice one filter: fourth order, −6 dB at its cutoff (Linkwitz and Riley).
    low_pass: Option<(Butterworth, [butterworth::State; 2])>,
    limiter: Option<(PeakLimiter, PeakLimiterState)>,
    /// Sum of the contacts, m or m/s²; the stretch before where nothing was added yet.
    sum: [f64; MAX_BLOCK],
    added: bool,
}

/// An audio bus: the sound of the bodies that play on it.
pub(super) struct Bus {
    gain: f64,
    /// On its way to the gain.
    smoothed: Smoothed,
    limiter: Option<(PeakLimiter, PeakLimiterState)>,
    meter: Meter,
    /// Sum of the bodies.
    sum: [f32; MAX_BLOCK],
    /// Number of its first samples that may not be zero.
    added: usize,
    /// Rest of bodies that were cut.
    endings: ImpulseRing<f32>,
}

impl HapticChannel {
    pub(super) fn new(settings: &ActuatorSettings, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let options = ChannelOptions {
            quantity: settings.output,
            full_scale: settings.full_scale,
            soft_start_s: settings.soft_start_s,
            equalise: settings.equalise,
            limit: settings.limit,
        };
        Ok(Self {
            output: ContactOutput::new(settings.output, settings.highpass_hz, sample_rate_hz)?
                .through_skin(settings.lowpass_hz.is_none())
                .growing_with_force(settings.felt_force_exponent)?,
            design: actuator::Channel::new(&options, sample_rate_hz)?,
            control: ChannelControl::default(),
            state: ChannelState::default(),
            low_pass: low_pass(settings, sample_rate_hz)?,
            limiter: limiter(settings.limit_peaks, sample_rate_hz)?,
            sum: [0.0; MAX_BLOCK],
            added: false,
        })
    }

    /// Adds a contact's samples to those of the stretch.
    pub(super) fn add(&mut self, samples: &[f64]) {
        let sum = self.sum.iter_mut().zip(samples);
        if std::mem::replace(&mut self.added, true) {
            sum.for_each(|(sum, x)| *sum += x);
        } else {
            // As if it were added to 0.
            sum.for_each(|(sum, x)| *sum = 0.0 + x);
        }
    }

    /// The sum of `n` samples and the design of what is added.
    pub(super) fn begun(&mut self, n: usize) -> (&mut [f64], &ContactOutput) {
        if !std::mem::replace(&mut self.added, true) {
            self.sum[..n].fill(0.0);
        }
        (&mut self.sum[..n], &self.output)
    }

    /// True where means of inner samples leave, and not some of them.
    fn averages(&self, inner: InnerRate) -> bool {
        inner.every > 1 && matches!(self.output.quantity(), Quantity::Acceleration | Quantity::Force)
    }

    /// The samples of a stretch as long as `out`.
    pub(super) fn run(&mut self, out: &mut [f32]) {
        if !std::mem::take(&mut self.added) {
            self.sum[..out.len()].fill(0.0);
        }
        if let Some((filter, [first, second])) = &mut self.low_pass {
            for x in &mut self.sum[..out.len()] {
                *x = second.tick(filter, first.tick(filter, *x).low).low;
            }
        }
        self.state.run(&self.design, &self.control, &self.sum[..out.len()], out);
        if let Some((design, state)) = &mut self.limiter {
            state.run(design, out);
        }
    }
}

impl Bus {
    pub(super) fn new(settings: &AudioBus, sample_rate_hz: f64) -> Result<Self, DesignError> {
        Ok(Self {
            gain: settings.gain,
            smoothed: Smoothed::settled(settings.gain, sample_rate_hz),
            limiter: limiter(settings.limit, sample_rate_hz)?,
            meter: Meter::new(sample_rate_hz),
            sum: [0.0; MAX_BLOCK],
            added: 0,
            endings: ImpulseRing::new(2.0 * MAX_BLOCK as f64 / sample_rate_hz, sample_rate_hz),
        })
    }

    /// Goes to another gain.
    pub(super) fn set_gain(&mut self, gain: f64) {
        self.gain = gain;
    }

    /// Empties it for the stretch of `n` samples that begins, but for what was cut.
    fn begin(&mut self, position: u64, n: usize) {
        let added = std::mem::take(&mut self.added);
        if added > 0 {
            self.sum[..added].fill(0.0);
        }
        if !self.endings.is_empty(position) {
            let mut next = self.endings.drain(position);
            self.sum[..n].iter_mut().for_each(|sum| *sum = next());
            self.added = n;
        }
    }

    /// Adds to a sample that comes within two blocks.
    pub(super) fn end_with(&mut self, sample: u64, x: f32) {
        self.endings.write(sample + 1, |values| {
            let mask = values.len() - 1;
            values[sample as usize & mask] += x;
        });
    }

    /// The `n` samples of the present stretch, for a body to add to.
    fn slice(&mut self, n: usize) -> &mut [f32] {
        self.added = self.added.max(n);
        &mut self.sum[..n]
    }

    /// Samples of the present stretch that leave, as long as `out`.
    fn finish(&mut self, master: Option<&[f32]>, out: &mut [f32]) {
        if self.added == 0 && self.limiter.is_none() && self.smoothed.settled_at(self.gain) {
            return out.fill(0.0);
        }
        let sum = &self.sum[..out.len()];
        if self.smoothed.settled_at(self.gain) {
            let gain = self.gain as f32;
            out.iter_mut().zip(sum).for_each(|(out, x)| *out = *x * gain);
        } else {
            out.copy_from_slice(sum);
            fade(&mut self.smoothed, self.gain, out);
        }
        if let Some((design, state)) = &mut self.limiter {
            state.run(design, out);
        }
        if let Some(master) = master {
            weigh(out, master);
        }
        self.meter.watch(out);
    }
}

impl Renderer {
    /// Silence where nothing is written: beyond the block's end, in idle outputs, and under means.
    pub(super) fn clear_what_nobody_writes(
        &self,
        frames: usize,
        haptic: &mut [&mut [f32]],
        audio: &mut [&mut [f32]],
    ) {
        let inner = self.shared.inner;
        let plays = |index: usize| self.channels.get(index).is_some_and(|channel| !channel.averages(inner));
        clear_beyond(haptic, |index| if plays(index) { frames } else { 0 });
        clear_beyond(audio, |index| if index < self.buses.len() { frames } else { 0 });
    }

    /// The gain of all that leaves, where it is not 1.
    pub(super) fn render_master(&mut self, n: usize) {
        let target = if self.muted || self.paused { 0.0 } else { 1.0 };
        self.mix.mastered = target != 1.0 || !self.master.settled_at(1.0);
        if self.mix.mastered {
            self.mix.master[..n].iter_mut().for_each(|gain| *gain = self.master.tick(target) as f32);
        }
    }

    /// Most by which peak limiters of channels and buses have turned down, dB; 0 for not at all.
    #[must_use]
    pub fn limiter_db(&self) -> f64 {
        let [heard_db, felt_db] = self.limiters_db();
        heard_db.max(felt_db)
    }

    /// Most by which limiters of buses, and of channels, have turned down, dB.
    fn limiters_db(&self) -> [f64; 2] {
        let buses = self.buses.iter().filter_map(|bus| bus.limiter.as_ref());
        let channels = self.channels.iter().filter_map(|channel| channel.limiter.as_ref());
        let deepest_db = |gain: f32| (-20.0 * libm::log10(f64::from(gain))).max(0.0);
        [
            deepest_db(buses.map(|(_, state)| state.deepest()).fold(1.0, f32::min)),
            deepest_db(channels.map(|(_, state)| state.deepest()).fold(1.0, f32::min)),
        ]
    }

    /// Writes what the actuators play of `n` inner samples, from `at` on in the outputs.
    pub(super) fn render_haptics(&mut self, at: usize, n: usize, haptic: &mut [&mut [f32]]) {
        let inner = self.shared.inner;
        for (index, channel) in self.channels.iter_mut().enumerate() {
            let averages = channel.averages(inner);
            let Mix { haptic: own, master, mastered, .. } = &mut *self.mix;
            let mut out = haptic.get_mut(index);
            let block = place(inner, (at, n), &mut out, own);
            self.clips.mix(index, self.position, n, channel);
            channel.run(block);
            if *mastered {
                weigh(block, master);
            }
            if averages {
                self.outlets.haptic_means(index, inner, self.position, block);
            } else {
                self.outlets.haptic(index, inner, self.position, block);
            }
            if let Some(out) = out.filter(|_| inner.every > 1) {
                if averages {
                    inner.average(at, &own[..n], out);
                } else {
                    inner.pick(at, &own[..n], out);
                }
            }
        }
    }

    /// Way of rendering bodies from a sample on.
    pub(super) fn body_args(&self, position: u64) -> RenderArgs {
        RenderArgs { position, mode_level: self.governor.mode_level(), has_buses: !self.buses.is_empty() }
    }

    /// Writes the sound of the bodies, bus by bus.
    pub(super) fn render_bodies(&mut self, at: usize, n: usize, audio: &mut [&mut [f32]]) {
        self.buses.iter_mut().for_each(|bus| bus.begin(self.position, n));
        let args = self.body_args(self.position);
        if let Some(pool) = &mut self.pool {
            pool.ring_bodies(args, n, (&mut self.bodies, &self.bodies_used), &mut self.scratch);
        }
        let mut shed = 0;
        for index in self.bodies_used.iter() {
            let rung = self.pool.as_mut().and_then(|pool| pool.take_body(index));
            let body = &mut self.bodies[index];
            if args.has_buses && body.is_plain() {
                shed += body.render(args, rung, self.buses[body.bus()].slice(n));
            } else {
                shed += render_moving(args, rung, body, &mut self.buses, &mut self.mix.body[..n]);
            }
        }
        if let Some(pool) = &mut self.pool {
            pool.put_bodies_back();
        }
        self.groups_shed = shed;
        let inner = self.shared.inner_audio;
        for (index, bus) in self.buses.iter_mut().enumerate() {
            let Mix { body: own, master, mastered, .. } = &mut *self.mix;
            let mut out = audio.get_mut(index);
            let sound = place(inner, (at, n), &mut out, own);
            bus.finish(mastered.then_some(&master[..n]), sound);
            self.outlets.bus(index, inner, self.position, sound);
            if let Some(out) = out.filter(|_| inner.every > 1) {
                inner.pick(at, &own[..n], out);
            }
        }
    }

    /// Reports to the game how loud each bus is.
    pub(super) fn show_levels(&mut self) {
        let limiters_db = self.limiters_db().map(|db| db as u64);
        self.counters.limiter_db.store(limiters_db[0].max(limiters_db[1]), Relaxed);
        self.counters.limiters_db.iter().zip(limiters_db).for_each(|(cell, db)| cell.store(db, Relaxed));
        for (cell, bus) in self.counters.bus_peak_bits.iter().zip(&mut self.buses) {
            bus.meter.settle();
            cell.store(bus.meter.peak().to_bits(), Relaxed);
        }
    }
}

/// Renders a body that sounds on several buses, goes from one to another, or to another gain, or to
/// rest.
#[cold]
#[inline(never)]
fn render_moving(
    args: RenderArgs,
    rung: Option<(&[f32], usize)>,
    body: &mut BodySeat,
    buses: &mut [Bus],
    sound: &mut [f32],
) -> usize {
    sound.fill(0.0);
    let shed = body.render(args, rung, sound);
    body.scale(sound);
    body.spread(sound, |bus, i, x| {
        if let Some(bus) = buses.get_mut(bus) {
            bus.slice(sound.len())[i] += x;
        }
    });
    shed
}

/// Applies a gain that goes elsewhere.
#[cold]
#[inline(never)]
fn fade(smoothed: &mut Smoothed, to: f64, block: &mut [f32]) {
    block.iter_mut().for_each(|x| *x *= smoothed.tick(to) as f32);
}

/// Applies the gain of all that leaves, while there is one.
#[cold]
#[inline(never)]
fn weigh(block: &mut [f32], master: &[f32]) {
    block.iter_mut().zip(master).for_each(|(x, gain)| *x *= gain);
}

/// Silence in each output from a sample of its own on.
pub(super) fn clear_beyond(outputs: &mut [&mut [f32]], written: impl Fn(usize) -> usize) {
    for (index, out) in outputs.iter_mut().enumerate() {
        // Mostly nothing is left, which would still cost a call.
        if let Some(rest) = out.get_mut(written(index)..).filter(|rest| !rest.is_empty()) {
            rest.fill(0.0);
        }
    }
}

/// Place of `n` inner samples of which the first has place `at` in the output: into it, where all
/// of them leave.
fn place<'a>(
    inner: InnerRate,
    (at, n): (usize, usize),
    out: &'a mut Option<&mut &mut [f32]>,
    own: &'a mut [f32; MAX_BLOCK],
) -> &'a mut [f32] {
    match out {
        Some(out) if inner.every == 1 => &mut out[at..at + n],
        _ => &mut own[..n],
    }
}

/// The low-pass of a channel, where it has one.
fn low_pass(
    settings: &ActuatorSettings,
    sample_rate_hz: f64,
) -> Result<Option<(Butterworth, [butterworth::State; 2])>, DesignError> {
    let usual_hz = if settings.output == Quantity::Acceleration { ACCELERATION_BAND_HZ } else { 0.0 };
    let cutoff_hz = settings.lowpass_hz.unwrap_or(usual_hz);
    limits::LOWPASS_HZ.check("lowpass_hz", cutoff_hz)?;
    // Above a third of the rate there is nothing left to take away.
    if cutoff_hz == 0.0 || cutoff_hz > 0.33 * sample_rate_hz {
        return Ok(None);
    }
    let named = |error: DesignError| DesignError { field: "lowpass_hz", ..error };
    let filter = Butterworth::new(cutoff_hz, sample_rate_hz).map_err(named)?;
    Ok(Some((filter, [butterworth::State::default(); 2])))
}

/// A limiter to full scale, where one is wanted.
fn limiter(
    wanted: bool,
    sample_rate_hz: f64,
) -> Result<Option<(PeakLimiter, PeakLimiterState)>, DesignError> {
    let design = wanted.then(|| PeakLimiter::new(CEILING, sample_rate_hz)).transpose()?;
    Ok(design.map(|design| (design, PeakLimiterState::default())))
}

/// One stretch of each kind of output.
pub(super) struct Mix {
    /// One body, while it moves from bus to bus.
    pub(super) body: [f32; MAX_BLOCK],
    pub(super) haptic: [f32; MAX_BLOCK],
    /// Gain of all that leaves, and whether it is another than 1.
    master: [f32; MAX_BLOCK],
    mastered: bool,
}

impl Mix {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self {
            body: [0.0; MAX_BLOCK],
            haptic: [0.0; MAX_BLOCK],
            master: [1.0; MAX_BLOCK],
            mastered: false,
        })
    }
}
