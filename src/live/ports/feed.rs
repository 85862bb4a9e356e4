//! Feed: which signal of the engine a port listens to.

use crate::link::outlet::PortSetup;
use crate::model::error::AddError;
use crate::model::event::ChannelId;

/// Which signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feed {
    /// Samples that drive an actuator.
    Haptic(ChannelId),
    /// Samples of a bus.
    Bus(usize),
    /// Samples of a channel of pickups.
    Pickup(usize),
}

impl Feed {
    /// # Errors
    /// When the engine has no such signal.
    pub(super) fn check(self, setup: &PortSetup<'_>) -> Result<(), AddError> {
        match self {
            Self::Haptic(ChannelId(channel)) if usize::from(channel) >= setup.haptic_channels => {
                Err(AddError::Unknown("actuator"))
            }
            Self::Bus(bus) if bus >= setup.audio_buses => {
                Err(AddError::UnknownBus { bus, buses: setup.audio_buses })
            }
            Self::Pickup(channel) if channel >= setup.pickup_channels => Err(AddError::Unknown("pickup")),
            Self::Haptic(_) | Self::Bus(_) | Self::Pickup(_) => Ok(()),
        }
    }
}
