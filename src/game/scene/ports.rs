//! Opening ports.

use super::Scene;
use crate::link::message::Message;
use crate::link::outlet::{Opened, PortKind, PortSetup};
use crate::model::error::AddError;
use crate::model::id::SurfaceId;

impl Scene {
    /// Opens a port and gives its reading end, for any one thread; the kinds are in
    /// [`live::ports`](crate::live::ports). It shows what leaves from the next block on, until its
    /// reading end is dropped.
    ///
    /// # Errors
    /// When what is wanted does not exist, a number is outside its range, all
    /// [`max_ports`](crate::Config::max_ports) are open, or the queue is full.
    pub fn open_port<K: PortKind>(&mut self, kind: K) -> Result<K::Port, AddError> {
        self.collect();
        let setup = PortSetup {
            sample_rate_hz: self.config.sample_rate_hz,
            haptic_channels: self.config.actuators.len(),
            audio_buses: self.config.audio.len(),
            pickup_channels: self.config.pickups.len(),
            voices: self.config.voices(),
            picture: &|surface: SurfaceId| self.surfaces.get(surface.0)?.picture.clone(),
        };
        let Opened { outlet, port } = kind.open(&setup)?;
        if let Some(outlet) = outlet {
            let capacity = self.config.max_ports;
            if self.open_ports >= capacity {
                return Err(AddError::Full { kind: "ports", capacity });
            }
            self.send(Message::AddOutlet(outlet))?;
            self.open_ports += 1;
        }
        Ok(port)
    }
}
