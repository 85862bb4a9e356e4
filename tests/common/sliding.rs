//! A contact that slides while something is changed under it.
#![allow(dead_code)]

use crate::common::{SIDE_M, grating, peak};
use crate::steps::largest_step;
use asperity::{
    ActuatorSettings, BodyId, ChannelId, Config, ContactEvent, ContactId, ContactSample, ModalModel, Mode,
    Renderer, Scene, Surface, SurfaceId,
};

/// Modes low enough for their own ringing not to look like steps.
pub fn low_body() -> ModalModel {
    let mode = |frequency_hz, amplitude| Mode { frequency_hz, decay_per_s: 8.0, amplitude, phase_rad: 0.0 };
    ModalModel::new(vec![mode(180.0, 0.3), mode(310.0, 0.2), mode(470.0, 0.1)], 0.01).unwrap()
}

/// A contact of the game, and what came of it so far.
pub struct Stroke {
    pub scene: Scene,
    renderer: Renderer,
    pub surface: SurfaceId,
    pub body: BodyId,
    reported: u64,
    pub haptic: Vec<f32>,
    pub audio: Vec<f32>,
}

const SPEED_M_S: f64 = 0.1;

impl Stroke {
    /// On a grating.
    pub fn begin(full_scale: f64) -> Self {
        Self::on(grating(2e-3, 2e-5), full_scale)
    }

    /// On any surface.
    pub fn on(surface: Surface, full_scale: f64) -> Self {
        let actuators = vec![ActuatorSettings { full_scale, ..ActuatorSettings::default() }];
        let asperity::Engine { mut scene, renderer, .. } =
            Config { actuators, ..Config::default() }.build().unwrap();
        let body = scene.add_body(low_body()).unwrap();
        let surface = scene.add_surface(surface.body(body)).unwrap();
        let mut stroke =
            Self { scene, renderer, surface, body, reported: 0, haptic: Vec::new(), audio: Vec::new() };
        let event = ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample_at(0.0));
        stroke.scene.report(0.0, event).unwrap();
        stroke
    }

    /// Slides on; the game reports at 60 Hz.
    pub fn slide(&mut self, seconds: f64) {
        let end = self.audio.len() + (seconds * 44_100.0) as usize;
        while self.audio.len() < end {
            let time_s = self.reported as f64 / 60.0;
            if time_s * 44_100.0 <= (self.audio.len() + 64) as f64 {
                self.scene.report(time_s, ContactEvent::moved(ContactId(1), sample_at(time_s))).unwrap();
                self.reported += 1;
            }
            let (mut h, mut a) = ([0.0f32; 64], [0.0f32; 64]);
            self.renderer.render(&mut [&mut h], &mut [&mut a]);
            self.haptic.extend(h);
            self.audio.extend(a);
        }
    }

    /// Largest step of what was rendered from `from_s` on, in dB of the signal's peak: haptics,
    /// audio.
    pub fn steps_db(&self, from_s: f64) -> [f64; 2] {
        let from = (from_s * 44_100.0) as usize;
        [&self.haptic, &self.audio].map(|x| 20.0 * (largest_step(&x[from..]) / peak(&x[from..])).log10())
    }
}

fn sample_at(time_s: f64) -> ContactSample {
    ContactSample {
        uv: [0.1 + SPEED_M_S * time_s / SIDE_M, 0.5],
        velocity_m_s: Some([SPEED_M_S, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
        ..ContactSample::default()
    }
}

/// No step above −60 dB of the peak, felt or heard.
pub fn assert_no_step(stroke: &Stroke, from_s: f64, what: &str) {
    let [felt, heard] = stroke.steps_db(from_s);
    eprintln!("{what}: largest step felt {felt:.1} dB, heard {heard:.1} dB of the peak");
    assert!(felt < -60.0 && heard < -60.0, "{what}: felt {felt} dB, heard {heard} dB");
}
