//! Scenes that are timed: the bench, the example and the tests of cost build the same ones.
#![allow(dead_code)]

use asperity::{
    ActuatorSettings, ChannelId, Config, ContactEvent, ContactId, ContactSample, Extent, ModalModel, Mode,
    Renderer, Scene, Surface, SurfaceId, Wrap,
};
use asperity_dsp::rng::Rng;
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;

/// Side of the surfaces, m.
pub const SIDE_M: f64 = 0.14;
/// Texels along a side of the maps.
pub const TEXELS: usize = 1024;
/// How often contacts are reported, Hz.
const REPORT_HZ: f64 = 60.0;

/// What a scene consists of.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Contacts, each with a surface, a body and an actuator of its own.
    pub contacts: usize,
    /// Modes of each body.
    pub modes: usize,
    /// Speed of the strokes, m/s.
    pub speed_m_s: f64,
}

/// A scene that runs, with its clock and its outputs.
pub struct Running {
    pub scene: Scene,
    pub renderer: Renderer,
    plan: Plan,
    frames: usize,
    haptic: Vec<Vec<f32>>,
    audio: Vec<f32>,
    surfaces: Vec<SurfaceId>,
    reported: u64,
}

/// A body of `modes` modes spread from 200 Hz to 16 kHz, decaying in 0.1–1 s.
pub fn body(modes: usize, seed: u64) -> ModalModel {
    let mut rng = Rng::new(seed);
    let modes = (0..modes).map(|_| {
        let frequency_hz = 200.0 * 80f64.powf(rng.uniform());
        let decay_per_s = 7.0 + 0.004 * frequency_hz;
        Mode { frequency_hz, decay_per_s, amplitude: 0.1 + rng.uniform(), phase_rad: 0.0 }
    });
    ModalModel::new(modes.collect(), 0.01).expect("modes of this bench are valid")
}

/// Bumps 0.5–3 mm apart: a map that is rough at every texel of [`TEXELS`]².
pub fn raster(seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let waves: Vec<_> = (0..8)
        .map(|_| {
            let cycles = [(rng.uniform() * 200.0).round(), (rng.uniform() * 200.0).round()];
            (cycles, std::f64::consts::TAU * rng.uniform())
        })
        .collect();
    let values = (0..TEXELS * TEXELS).map(|i| {
        let at =
            [(i % TEXELS) as f64, (i / TEXELS) as f64].map(|t| std::f64::consts::TAU * t / TEXELS as f64);
        let wave = |([u, v], phase): &([f64; 2], f64)| (u * at[0] + v * at[1] + phase).sin();
        0.5 + waves.iter().map(wave).sum::<f64>() / 16.0
    });
    Raster { width: TEXELS, height: TEXELS, values: values.collect() }
}

/// A displacement map and a roughness map of [`TEXELS`]² each, `relief_m` high, and the
/// micro-noise.
pub fn map(relief_m: f64) -> HeightMap {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m };
    HeightMap::new(&raster(3), extent, Wrap::Repeat)
        .and_then(|map| map.with_roughness_map(&raster(5)))
        .expect("maps of this bench are valid")
}

/// The surface on [`map`].
pub fn surface(map: &HeightMap) -> Surface {
    Surface::new(map.clone(), SIDE_M, SIDE_M).expect("a size of this bench is valid")
}

impl Running {
    /// Builds the scene and lets every contact begin.
    pub fn new(config: Config, plan: Plan, frames: usize) -> Self {
        let config = Config {
            actuators: vec![ActuatorSettings::default(); plan.contacts.max(1)],
            max_contacts: plan.contacts.max(64),
            ..config
        };
        let asperity::Engine { mut scene, mut renderer, .. } =
            config.build().expect("the config of a bench is valid");
        let map = map(1e-4);
        let mut surfaces = Vec::new();
        for i in 0..plan.contacts {
            let body = scene.add_body(body(plan.modes, i as u64)).expect("there is room");
            surfaces.push(scene.add_surface(surface(&map).body(body)).expect("there is room"));
        }
        let haptic = vec![vec![0.0; frames]; renderer.haptic_channels()];
        let audio = vec![0.0; frames];
        let mut running = Self {
            scene,
            renderer: {
                renderer.render(&mut [], &mut []);
                renderer
            },
            plan,
            frames,
            haptic,
            audio,
            surfaces,
            reported: 0,
        };
        running.report(true);
        running
    }

    fn sample(&self, contact: usize, time_s: f64) -> ContactSample {
        let (sine, cosine) = (0.3 + contact as f64).sin_cos();
        let [u, v] = [self.plan.speed_m_s * cosine, self.plan.speed_m_s * sine];
        ContactSample {
            uv: [(0.1 * contact as f64) + u * time_s / SIDE_M, 0.05 * contact as f64 + v * time_s / SIDE_M],
            velocity_m_s: Some([u, v]),
            normal_force_n: 0.5,
            closing_m_s: 0.0,
            ..ContactSample::default()
        }
    }

    fn report(&mut self, first: bool) {
        let time_s = self.reported as f64 / REPORT_HZ;
        for (i, surface) in self.surfaces.iter().enumerate() {
            let (contact, sample) = (ContactId(i as u64), self.sample(i, time_s));
            let event = if first {
                ContactEvent::begin(contact, *surface, ChannelId(i as u16), sample)
            } else {
                ContactEvent::moved(contact, sample)
            };
            self.scene.report(time_s, event).expect("an event of this bench is valid");
        }
        self.reported += 1;
    }

    /// Lets every contact end.
    pub fn lift(&mut self) {
        let time_s = self.reported as f64 / REPORT_HZ;
        for i in 0..self.plan.contacts {
            self.scene
                .report(time_s, ContactEvent::end(ContactId(i as u64)))
                .expect("a contact that is there");
        }
    }

    /// Reports what is due before the next block; not part of what is timed.
    pub fn step(&mut self) {
        let now_s = self.renderer.position() as f64 / self.renderer.sample_rate_hz();
        if now_s >= (self.reported as f64 - 0.5) / REPORT_HZ {
            self.report(false);
        }
    }

    /// Renders one block.
    pub fn block(&mut self) {
        // At most 64 channels in these scenes; no allocation while the clock runs.
        let mut haptic = self.haptic.iter_mut().map(|channel| &mut channel[..self.frames]);
        let mut channels: [&mut [f32]; 64] = std::array::from_fn(|_| haptic.next().unwrap_or_default());
        let count = self.plan.contacts.clamp(1, 64);
        self.renderer.render(&mut channels[..count], &mut [&mut self.audio[..]]);
    }

    /// The audio of the last block.
    pub fn audio(&self) -> &[f32] {
        &self.audio
    }
}
