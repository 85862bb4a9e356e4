//! Bench: a small engine that renders reference motions, and what they come to.

use crate::audio::renderer::Renderer;
use crate::game::clock::Clock;
use crate::game::levels::kinds;
use crate::game::scene::Scene;
use crate::link::ring;
use crate::link::stats::Counters;
use crate::model::actuator::ActuatorSettings;
use crate::model::bus::AudioBus;
use crate::model::clock_mode::ClockMode;
use crate::model::config::Config;
use crate::model::contact_sample::ContactSample;
use crate::model::error::AddError;
use crate::model::event::{ChannelId, ContactEvent, ContactId, Impact, Touching};
use crate::model::id::BodyId;
use crate::model::level_policy::LevelPolicy;
use crate::model::levels::{BURST, FROM, PAUSE_S, SETTLED_S, STRIKE, Strike};
use crate::model::material::Material;
use crate::rate::design;
use crate::resource::probe::PreparedProbe;
use crate::trial::TRIALS;
use std::sync::Arc;

/// Rate of trials, Hz.
pub(super) const RATE_HZ: f64 = 44_100.0;
/// Steps of a game a second.
const STEPS_HZ: f64 = 60.0;

/// A stroke along a straight line.
#[derive(Clone, Copy)]
pub(super) struct Motion {
    pub(super) way: [f64; 2],
    pub(super) speed_m_s: f64,
    pub(super) force_n: f64,
    /// Share of the force by which it jumps from step to step, up and down in turn.
    pub(super) jumps: f64,
    pub(super) length_s: f64,
    /// Time after it for what rings, s.
    pub(super) pause_s: f64,
}

/// Mean squares of a stroke, once it has settled.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Power {
    pub(super) heard: f64,
    pub(super) felt: f64,
}

/// A small engine.
pub(super) struct Bench {
    pub(super) scene: Scene,
    pub(super) renderer: Renderer,
    rate_hz: f64,
    at_s: f64,
    rendered: u64,
    audio: Vec<f32>,
    haptic: Vec<Vec<f32>>,
}

impl Bench {
    /// For the scene of `config`: in SI units, with nothing behind what it plays.
    pub(super) fn new(config: &Config) -> Result<Self, AddError> {
        let plain = |channel: usize| ActuatorSettings {
            full_scale: 1.0,
            soft_start_s: 0.0,
            equalise: None,
            limit: None,
            limit_peaks: false,
            ..config.actuators[channel]
        };
        let config = Config {
            actuators: kinds(&config.actuators).into_iter().map(plain).collect(),
            audio: vec![AudioBus::default()],
            levels: LevelPolicy::AsGiven,
            clock: ClockMode::default(),
            // The device's rate is not the scene's.
            sample_rate_hz: RATE_HZ,
            oversampling: 1,
            max_contacts: 1,
            max_ports: 1,
            max_surfaces: 1,
            max_bodies: 1,
            queue_capacity: 1024,
            culling: None,
            shed_load: false,
            threads: 1,
            ..config.clone()
        };
        let (kernel, inner_hz) = (config.kernel().map_err(design)?, config.inner_rate_hz());
        let probe = PreparedProbe::new(&config.probe, &config.probe, config.integrator, inner_hz, kernel)?;
        let counters = Arc::new(Counters::new(1));
        let (to_audio, from_game) = ring::channel(config.queue_capacity);
        let (to_game, from_audio) = ring::channel(config.most_to_free());
        let renderer = Renderer::new(&config, kernel, probe, from_game, to_game, counters.clone());
        let renderer = renderer.map_err(design)?;
        let clock = Clock::new(config.clock, inner_hz);
        let scene = Scene::new(config, (kernel, TRIALS), clock, to_audio, from_audio, counters);
        Ok(Self {
            rate_hz: renderer.sample_rate_hz(),
            at_s: 0.0,
            rendered: 0,
            audio: Vec::new(),
            haptic: vec![Vec::new(); renderer.haptic_channels()],
            scene,
            renderer,
        })
    }

    /// Renders up to a time.
    fn run_to(&mut self, time_s: f64) {
        let end = (time_s * self.rate_hz).round() as u64;
        let frames = end.saturating_sub(self.rendered) as usize;
        self.audio.resize(frames, 0.0);
        self.haptic.iter_mut().for_each(|channel| channel.resize(frames, 0.0));
        let mut haptic: Vec<&mut [f32]> = self.haptic.iter_mut().map(|channel| &mut channel[..]).collect();
        self.renderer.render(&mut haptic, &mut [&mut self.audio[..]]);
        self.rendered += frames as u64;
    }

    /// Reports what happens now. What the scene refuses makes no sound, and has no level.
    fn report(&mut self, after_s: f64, event: ContactEvent) {
        if let Err(refused) = self.scene.report(self.at_s + after_s, event) {
            debug_assert!(false, "a reference motion is refused: {refused}");
        }
    }

    /// A stroke over a surface of this size, felt by a channel of the bench.
    pub(super) fn stroke(
        &mut self,
        touching: Touching,
        channel: usize,
        size_m: [f64; 2],
        motion: &Motion,
    ) -> Power {
        let velocity_m_s = motion.way.map(|share| share * motion.speed_m_s);
        let sample = |step: u32, t: f64| {
            let uv = [0, 1].map(|axis| FROM[axis] + velocity_m_s[axis] * t / size_m[axis]);
            let jump = if step.is_multiple_of(2) { motion.jumps } else { -motion.jumps };
            ContactSample::new(uv, motion.force_n * (1.0 + jump)).sliding(velocity_m_s)
        };
        let contact = ContactId(0);
        let touching = touching.felt_by(ChannelId(channel as u16));
        let (mut power, mut frames) = (Power::default(), 0);
        for step in 0..(motion.length_s * STEPS_HZ) as u32 {
            let t = f64::from(step) / STEPS_HZ;
            let begin = || ContactEvent::begin_with(contact, touching, sample(step, t));
            let event = if step == 0 { begin() } else { ContactEvent::moved(contact, sample(step, t)) };
            self.report(t, event);
            self.run_to(self.at_s + (t + 1.0 / STEPS_HZ).min(motion.length_s));
            if t >= SETTLED_S {
                power.heard += square(&self.audio);
                power.felt += square(&self.haptic[channel]);
                frames += self.audio.len();
            }
        }
        self.run_to(self.at_s + motion.length_s);
        self.report(motion.length_s, ContactEvent::end(contact));
        self.at_s += motion.length_s + motion.pause_s;
        self.run_to(self.at_s);
        let mean = |sum: f64| if sum.is_finite() { sum / frames.max(1) as f64 } else { 0.0 };
        Power { heard: mean(power.heard), felt: mean(power.felt) }
    }

    /// Peaks of one reference strike, and of a burst of them.
    pub(super) fn strikes(&mut self, body: BodyId) -> [f64; 2] {
        [1, BURST.0].map(|count| {
            let mut most = 0.0;
            for strike in 0..count {
                let after_s = f64::from(strike) * BURST.1;
                self.report(after_s, ContactEvent::Impact(reference_strike(body)));
                self.run_to(self.at_s + after_s + BURST.1);
                most = f64::max(most, peak(&self.audio));
            }
            self.at_s += f64::from(count) * BURST.1 + PAUSE_S;
            self.run_to(self.at_s);
            f64::max(most, peak(&self.audio))
        })
    }
}

/// The reference strike of the level policy.
pub(super) fn reference_strike(body: BodyId) -> Impact {
    let Strike { speed_m_s, mass_kg, radius_m } = STRIKE;
    Impact { speed_m_s, mass_kg, radius_m, striker: Material::STEEL, restitution: 1.0, ..Impact::on(body) }
}

fn square(samples: &[f32]) -> f64 {
    samples.iter().map(|x| f64::from(*x).powi(2)).sum()
}

fn peak(samples: &[f32]) -> f64 {
    samples.iter().fold(0.0, |peak, x| f64::max(peak, f64::from(x.abs())))
}
