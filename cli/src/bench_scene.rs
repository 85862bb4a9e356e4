//! Scenes made in memory for measuring: fingers that stroke plates whose bodies ring.

use crate::error::CliError;
use asperity::{
    ChannelId, Config, ContactEvent, ContactId, ContactSample, Extent, Material, ModalModel, Mode, Renderer,
    Scene, Surface, SurfaceId, Wrap,
};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::f64::consts::PI;
use std::time::Instant;

/// Events a second and finger, as games report them.
const EVENT_RATE_HZ: f64 = 60.0;

/// Scene to be measured.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Fingers stroking at once.
    pub contacts: usize,
    /// Bodies, each under its share of the fingers.
    pub bodies: usize,
    /// Modes of each body.
    pub modes_per_body: usize,
    /// Lifts the fingers after a tenth of a second, so that everything rings out.
    pub lift: bool,
}

/// A scene under load, rendered block by block.
pub struct Bench {
    scene: Scene,
    renderer: Renderer,
    surfaces: Vec<SurfaceId>,
    load: Load,
    rate_hz: f64,
    next_event: u64,
    event: u64,
}

/// Modes between 100 Hz and 12 kHz with T60 of 0.2–2 s.
pub fn modes(count: usize) -> ModalModel {
    let modes = (0..count)
        .map(|index| {
            let part = (index as f64 + 0.5) / count as f64;
            Mode {
                frequency_hz: 100.0 * 120f64.powf(part),
                decay_per_s: 6.9 / (2.0 * 0.1f64.powf(part)),
                amplitude: 0.3 / (1.0 + index as f64).sqrt(),
                phase_rad: 0.0,
            }
        })
        .collect();
    ModalModel { source: "made for measuring".to_owned(), impulse_n_s: 0.01, modes, ..ModalModel::silent() }
}

/// Waves on a map, smooth on one half and matte on the other.
pub fn plate() -> Option<HeightMap> {
    let waves = Raster::from_fn(512, 512, |x, y| {
        let (u, v) = (x as f64 / 512.0, y as f64 / 512.0);
        0.5 + 0.25 * (2.0 * PI * 40.0 * u).sin() + 0.25 * (2.0 * PI * 23.0 * (u + v)).cos()
    });
    let rough = Raster::from_fn(256, 256, |x, _| if x < 128 { 0.2 } else { 0.8 });
    let extent = Extent { width_m: 0.14, height_m: 0.14, relief_m: 2e-4 };
    HeightMap::new(&waves, extent, Wrap::Repeat).ok()?.with_roughness_map(&rough).ok()
}

/// Reports to a renderer that it is late until its governor is at this level.
pub fn be_late(renderer: &mut Renderer, level: usize) {
    // Its own work takes most of its time; then it is late once for each level.
    (0..31).for_each(|_| renderer.report_load(0.7));
    (0..level).for_each(|_| renderer.report_load(0.9));
}

impl Bench {
    /// Builds the scene.
    ///
    /// # Errors
    /// Only if the engine refuses what it should accept.
    pub fn new(load: Load, config: Config) -> Result<Self, CliError> {
        Self::of(load, config, &modes(load.modes_per_body))
    }

    /// Measurement with bodies of these modes; without any, where `load` has none.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of(load: Load, config: Config, model: &ModalModel) -> Result<Self, CliError> {
        let refused = || CliError::new("scene", "cannot be built", "please report it");
        Self::built(load, config, model).ok_or_else(refused)
    }

    fn built(load: Load, config: Config, model: &ModalModel) -> Option<Self> {
        let rate_hz = config.sample_rate_hz;
        let asperity::Engine { mut scene, renderer, .. } = config.build().ok()?;
        let map = plate()?;
        let mut surfaces = Vec::new();
        for _ in 0..load.bodies.max(1) {
            let surface = Surface::new(map.clone(), 0.14, 0.14).ok()?;
            let surface = if load.modes_per_body > 0 {
                surface.body(
                    scene.add_body(asperity::Body::new(model.clone()).material(Material::CERAMIC)).ok()?,
                )
            } else {
                surface
            };
            surfaces.push(scene.add_surface(surface).ok()?);
        }
        Some(Self { scene, renderer, surfaces, load, rate_hz, next_event: 0, event: 0 })
    }

    /// Renders `audio.len()` samples and returns how long the audio half took, s.
    pub fn block(&mut self, haptic: &mut [f32], audio: &mut [f32]) -> f64 {
        self.blocks(1, haptic, audio)
    }

    /// Measurement of some blocks in a row, of which the last stays: reading the clock takes as
    /// long as a stage of a short one.
    pub fn blocks(&mut self, count: usize, haptic: &mut [f32], audio: &mut [f32]) -> f64 {
        while self.next_event < self.renderer.position() + (count * audio.len()) as u64 {
            self.report();
            self.event += 1;
            self.next_event = (self.event as f64 / EVENT_RATE_HZ * self.rate_hz).ceil() as u64;
        }
        let began = Instant::now();
        for _ in 0..count {
            self.renderer.render(&mut [haptic], &mut [audio]);
        }
        began.elapsed().as_secs_f64()
    }

    /// The machine is so late that its governor goes to this level.
    pub fn be_late(&mut self, level: usize) {
        be_late(&mut self.renderer, level);
    }

    /// Reports of every finger since the last report.
    fn report(&mut self) {
        let t = self.event as f64 / EVENT_RATE_HZ;
        let lift = self.load.lift && t > 0.1;
        if self.load.lift && t > 0.1 + 1.5 / EVENT_RATE_HZ {
            return;
        }
        for contact in 0..self.load.contacts {
            let id = ContactId(contact as u64);
            let phase = contact as f64 * 0.37;
            let speed_m_s = 0.1 + 0.002 * contact as f64;
            let sample = ContactSample {
                uv: [(phase + speed_m_s * t) / 0.14, 0.3 + phase],
                velocity_m_s: Some([speed_m_s, 0.0]),
                normal_force_n: 0.5,
                closing_m_s: 0.0,
                ..ContactSample::default()
            };
            let event = match (self.event, lift) {
                (_, true) => ContactEvent::end(id),
                (0, _) => {
                    let surface = self.surfaces[contact % self.surfaces.len()];
                    ContactEvent::begin(id, surface, ChannelId(0), sample)
                }
                _ => ContactEvent::moved(id, sample),
            };
            // The queue holds thousands of events and is emptied with every block.
            let _ = self.scene.report(t, event);
        }
    }
}
