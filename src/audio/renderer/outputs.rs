//! What leaves the engine: the haptic channels with their actuator stage, and the audio bus.

use super::Renderer;
use crate::model::actuator::ActuatorSettings;
use crate::model::bus::AudioSettings;
use crate::prepared::body::Terms;
use asperity_dsp::DesignError;
use asperity_dsp::actuator::{
    self, ChannelControl, ChannelOptions, ChannelState, ContactOutput, PeakLimiter, PeakLimiterState,
    Quantity,
};
use asperity_texture::height_field::MAX_BLOCK;

/// Where limiters hold the peaks: full scale.
const CEILING: f64 = 1.0;

/// An actuator: what its contacts add up to, and the stage that drives it.
pub(super) struct HapticChannel {
    pub(super) output: ContactOutput,
    design: actuator::Channel,
    pub(super) control: ChannelControl,
    state: ChannelState,
    limiter: Option<(PeakLimiter, PeakLimiterState)>,
    /// Sum of the contacts, m or m/s².
    pub(super) sum: [f64; MAX_BLOCK],
}

/// The mono sound of all bodies.
pub(super) struct AudioBus {
    gain: f32,
    limiter: Option<(PeakLimiter, PeakLimiterState)>,
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
            output: ContactOutput::new(settings.output, settings.highpass_hz, sample_rate_hz)?,
            design: actuator::Channel::new(&options, sample_rate_hz)?,
            control: ChannelControl::default(),
            state: ChannelState::default(),
            limiter: limiter(settings.limit_peaks, sample_rate_hz)?,
            sum: [0.0; MAX_BLOCK],
        })
    }

    /// The samples of a stretch as long as `out`.
    pub(super) fn run(&mut self, out: &mut [f32]) {
        self.state.run(&self.design, &self.control, &self.sum[..out.len()], out);
        if let Some((design, state)) = &mut self.limiter {
            state.run(design, out);
        }
    }
}

impl AudioBus {
    pub(super) fn new(settings: &AudioSettings, sample_rate_hz: f64) -> Result<Self, DesignError> {
        Ok(Self { gain: settings.gain as f32, limiter: limiter(settings.limit, sample_rate_hz)? })
    }

    pub(super) fn finish(&mut self, mix: &mut [f32]) {
        for x in mix.iter_mut() {
            *x *= self.gain;
        }
        if let Some((design, state)) = &mut self.limiter {
            state.run(design, mix);
        }
    }
}

impl Renderer {
    /// Writes what the actuators play of `n` inner samples, from `at` on in the outputs.
    pub(super) fn render_haptics(&mut self, at: usize, n: usize, haptic: &mut [&mut [f32]]) {
        let inner = self.shared.inner;
        for (index, channel) in self.channels.iter_mut().enumerate() {
            let block = &mut self.mix.haptic[..n];
            channel.run(block);
            if let Some(out) = haptic.get_mut(index) {
                match channel.output.quantity() {
                    Quantity::Acceleration if inner.every > 1 => inner.average(at, block, out),
                    _ => inner.pick(at, block, out),
                }
            }
        }
    }

    /// The same of what the bodies sound like.
    pub(super) fn render_bodies(&mut self, at: usize, n: usize, audio: &mut [&mut [f32]]) {
        let mix = &mut self.mix.audio[..n];
        mix.fill(0.0);
        let terms =
            Terms { kernel: self.kernel, position: self.position, mode_level: self.governor.mode_level() };
        let mut shed = 0;
        for body in self.bodies_used.iter() {
            shed += self.bodies[body].render(terms, mix);
        }
        self.groups_shed = shed;
        self.audio.finish(mix);
        for out in audio {
            self.shared.inner.pick(at, mix, out);
        }
    }
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
    pub(super) audio: [f32; MAX_BLOCK],
    pub(super) haptic: [f32; MAX_BLOCK],
}

impl Mix {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self { audio: [0.0; MAX_BLOCK], haptic: [0.0; MAX_BLOCK] })
    }
}
