//! Randomised events of every kind, hostile numbers, surfaces and bodies swapped and removed while
//! they sound: what the tests of the audio half live through, under the counting allocator and
//! under the real-time sanitizer.

use crate::common::{bar, grating, plate};
use asperity::live::ports::{Feed, Force, ForcePort, Pcm, PcmPort};
use asperity::{
    AudioBus, BodyId, BusId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Emphasis, Excitation,
    Impact, Material, ModalModel, ProbeId, Renderer, Residual, Scene, SurfaceId, Touching, probe_by_name,
};
use asperity_dsp::rng::Rng;

/// A body whose impacts also play a residual.
fn clicking_bar() -> ModalModel {
    let samples = (0..3000).map(|n| (0.7 * n as f32).sin() / (1.0 + n as f32)).collect();
    bar().with_residual(Some(Residual { sample_rate_hz: 48_000.0, samples }), 1.0).unwrap()
}

/// A game at random, and what it has registered.
pub struct RandomGame {
    pub scene: Scene,
    surfaces: [SurfaceId; 3],
    bodies: [BodyId; 2],
    probes: [ProbeId; 2],
    /// Ports that nobody reads, opened and closed again.
    ports: (Option<PcmPort>, Option<ForcePort>),
    pub rng: Rng,
    /// How far it has come.
    pub time_s: f64,
}

impl RandomGame {
    /// A game that is the same for the same seed, with fewer voices than fingers and a short
    /// time-out.
    pub fn new(seed: u64) -> (Self, Renderer) {
        Self::with(seed, Config::default())
    }

    /// The same in an engine of another kind.
    pub fn with(seed: u64, config: Config) -> (Self, Renderer) {
        let audio = vec![AudioBus::default(); 2];
        let config = Config { max_contacts: 6, contact_timeout_s: 0.05, audio, ..config };
        let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
        let bodies = [scene.add_body(clicking_bar()).unwrap(), scene.add_body(bar()).unwrap()];
        let surfaces = [
            scene.add_surface(grating(1e-3, 5e-5).body(bodies[0])).unwrap(),
            scene.add_surface(plate(1.0).body(bodies[1])).unwrap(),
            scene.add_surface(plate(0.0)).unwrap(),
        ];
        let probes = ["stylus", "rigid"].map(|name| scene.add_probe(probe_by_name(name).unwrap()).unwrap());
        (
            Self { scene, surfaces, bodies, probes, ports: (None, None), rng: Rng::new(seed), time_s: 0.0 },
            renderer,
        )
    }

    /// Mostly 0–1, and now and then what no game should report.
    fn number(&mut self) -> f64 {
        match self.rng.next_u32() % 40 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => 1e300,
            3 => -0.3,
            _ => self.rng.uniform(),
        }
    }

    /// Up to 4 ms on: four events, and once in a while something is swapped or removed.
    pub fn step(&mut self) {
        self.time_s += 0.004 * self.rng.uniform();
        for _ in 0..4 {
            let contact = ContactId(u64::from(self.rng.next_u32() % 12));
            let sample = ContactSample {
                uv: [self.number(), self.number()],
                velocity_m_s: (!self.rng.next_u32().is_multiple_of(5)).then(|| [0.3 * self.number(), 0.0]),
                normal_force_n: 3.0 * self.number(),
                closing_m_s: (0.1 * self.number()).abs(),
                ..ContactSample::default()
            };
            let surface = self.surfaces[self.rng.next_u32() as usize % self.surfaces.len()];
            let event = match self.rng.next_u32() % 12 {
                0 | 1 => ContactEvent::begin_with(contact, self.touching(contact, surface), sample),
                2 => ContactEvent::end(contact),
                3 => ContactEvent::Impact(Impact {
                    body: self.bodies[0],
                    other: Some(self.bodies[1]),
                    speed_m_s: 1.0,
                    mass_kg: 0.01,
                    radius_m: 0.005,
                    striker: Material::STEEL,
                    restitution: 0.7,
                    position: 0,
                    holder: Some(self.bodies[1]),
                    probe: Some(self.probes[0]),
                    ..Impact::on(self.bodies[0])
                }),
                4 => {
                    let emphasis = Emphasis { gain: Some(self.number()), importance: Some(self.number()) };
                    ContactEvent::moved_with(contact, sample, emphasis)
                }
                _ => ContactEvent::moved(contact, sample),
            };
            // Refusals are part of the game.
            let _ = self.scene.report(self.time_s, event);
        }
        self.swap();
    }

    /// A finger, a stylus that a body holds, and a stick that nobody feels.
    fn touching(&self, contact: ContactId, surface: SurfaceId) -> Touching {
        let here = Touching::on(surface);
        match contact.0 % 3 {
            0 => here.felt_by(ChannelId(0)),
            1 => here.felt_by(ChannelId(0)).probe(self.probes[0]).held_by(self.bodies[1]).gain(0.8),
            _ => here.probe(self.probes[1]),
        }
    }

    fn swap(&mut self) {
        let which = self.rng.next_u32() as usize % self.surfaces.len();
        let body = self.bodies[which % 2];
        match self.rng.next_u32() % 50 {
            0 => {
                let surface = plate(0.5).body(body).excitation(Excitation::BOTH);
                let _ = self.scene.replace_surface(self.surfaces[which], surface);
            }
            1 => {
                let removed = self.scene.remove_surface(self.surfaces[which]).is_ok();
                if removed && let Ok(id) = self.scene.add_surface(grating(2e-3, 1e-4).body(body)) {
                    self.surfaces[which] = id;
                }
            }
            2 => {
                let _ = self
                    .scene
                    .replace_body(body, asperity::Body::new(clicking_bar()).material(Material::GLASS));
            }
            3 => {
                let gain = self.rng.uniform();
                let _ = self.scene.set_haptic_gain(ChannelId(0), gain);
                let _ = self.scene.set_body_bus(body, BusId(usize::from(gain > 0.5)));
                // No source here takes it; its box goes home all the same.
                let _ = self.scene.change_surface(self.surfaces[which], gain);
            }
            4 => {
                let removed = self.scene.remove_body(self.bodies[which % 2]).is_ok();
                if removed && let Ok(id) = self.scene.add_body(bar()) {
                    self.bodies[which % 2] = id;
                }
            }
            5 => {
                let pcm = Pcm { from: Feed::Haptic(ChannelId(0)), holds_s: 0.01 };
                self.ports = (self.scene.open_port(pcm).ok(), None);
            }
            7 => {
                let gain = 2.0 * self.rng.uniform();
                let _ = self.scene.set_body_gain(body, gain);
                let _ = self.scene.set_muted(gain < 0.2);
            }
            8 if self.rng.next_u32().is_multiple_of(20) => {
                let _ = self.scene.fade_all();
            }
            6 => self.ports.1 = self.scene.open_port(Force { rate_hz: 1000.0, holds_s: 0.01 }).ok(),
            _ => {}
        }
    }
}
