//! A game that reports in ticks of 60 Hz: a wooden block, and a plate on it.

use super::plate;
use asperity::{
    Body, BodyId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Material, Renderer,
    Scene, Stock, SurfaceId,
};

/// Length of a tick, s.
pub const TICK_S: f64 = 1.0 / 60.0;

pub struct Game {
    pub scene: Scene,
    pub renderer: Renderer,
    pub block: BodyId,
    pub surface: SurfaceId,
    pub tick: u32,
}

impl Game {
    pub fn new(config: Config) -> Self {
        let Engine { mut scene, renderer, .. } = config.build().unwrap();
        let block = scene.add_body(block()).unwrap();
        let surface = scene.add_surface(plate(0.8).body(block)).unwrap();
        Self { scene, renderer, block, surface, tick: 0 }
    }

    pub fn now_s(&self) -> f64 {
        f64::from(self.tick) * TICK_S
    }

    pub fn report(&mut self, event: ContactEvent) {
        self.scene.report(self.now_s(), event).unwrap();
    }

    /// A report of a contact that the first actuator feels.
    pub fn touch(&mut self, contact: u64, sample: ContactSample, begins: bool) {
        let event = if begins {
            ContactEvent::begin(ContactId(contact), self.surface, ChannelId(0), sample)
        } else {
            ContactEvent::moved(ContactId(contact), sample)
        };
        self.report(event);
    }
}

pub fn block() -> Body {
    Body::stock(Stock::Block, Material::WOOD, 0.1).unwrap()
}
