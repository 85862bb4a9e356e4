//! Fingers that stroke bodies of many modes, one each.
#![allow(dead_code)]

use super::common::{self, grating};
use asperity::{
    Body, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Material, ModalModel, Mode,
    Renderer, Scene, SurfaceId,
};

pub fn modes(count: usize) -> ModalModel {
    let mode = |i: usize| {
        let part = (i as f64 + 0.5) / count as f64;
        Mode {
            frequency_hz: 100.0 * 120f64.powf(part),
            decay_per_s: 3.0 + 30.0 * part,
            amplitude: 0.3 / (1.0 + i as f64).sqrt(),
            phase_rad: 0.0,
        }
    };
    ModalModel::new((0..count).map(mode).collect(), 0.01).unwrap()
}

/// Fingers that stroke bodies, one each.
pub struct Strokes {
    pub scene: Scene,
    pub renderer: Renderer,
    surfaces: Vec<SurfaceId>,
    reports: u32,
}

impl Strokes {
    pub fn new(bodies: usize, modes_each: usize, threads: usize) -> Self {
        let config = Config { threads, ..Config::default() };
        let Engine { mut scene, renderer, .. } = config.build().unwrap();
        let surfaces = (0..bodies)
            .map(|_| {
                let body = scene.add_body(Body::new(modes(modes_each)).material(Material::CERAMIC)).unwrap();
                scene.add_surface(grating(2e-3, 2e-5).body(body)).unwrap()
            })
            .collect();
        Self { scene, renderer, surfaces, reports: 0 }
    }

    /// Reports what is due before a sample, then renders a block.
    pub fn block(&mut self, haptic: &mut [f32], audio: &mut [f32]) {
        let until_s = (self.renderer.position() + haptic.len() as u64) as f64 / 44_100.0;
        while f64::from(self.reports) / 60.0 < until_s {
            let t = f64::from(self.reports) / 60.0;
            for (i, surface) in self.surfaces.iter().enumerate() {
                let id = ContactId(i as u64);
                let speed_m_s = 0.05 + 0.01 * i as f64;
                let sample = ContactSample::new([0.1 + (speed_m_s * t / common::SIDE_M) % 0.8, 0.5], 0.6)
                    .sliding([speed_m_s, 0.0]);
                let event = match self.reports {
                    0 => ContactEvent::begin(id, *surface, ChannelId(0), sample),
                    // Some lift for a while, and what they struck rings out.
                    n if n % 40 == 20 + i as u32 % 3 && i % 2 == 0 => ContactEvent::end(id),
                    n if n % 40 == 30 => ContactEvent::begin(id, *surface, ChannelId(0), sample),
                    _ => ContactEvent::moved(id, sample),
                };
                // Moves of those that have lifted are nobody's.
                let _ = self.scene.report(t, event);
            }
            self.reports += 1;
        }
        self.renderer.render(&mut [haptic], &mut [audio]);
    }

    pub fn render(&mut self, samples: usize, mut frames: impl FnMut() -> usize) -> [Vec<f32>; 2] {
        let (mut haptic, mut audio) = (vec![0.0; samples], vec![0.0; samples]);
        let mut at = 0;
        while at < samples {
            let n = frames().min(samples - at);
            self.block(&mut haptic[at..at + n], &mut audio[at..at + n]);
            at += n;
        }
        [haptic, audio]
    }
}
