//! Channels of pickups: what those of all bodies read, through their sensors.

use super::Renderer;
use crate::model::config::Config;
use asperity_dsp::DesignError;
use asperity_dsp::sensor::{Converter, SensorFilter, SensorFilterState, SensorProfile};
use asperity_surface::height_field::MAX_BLOCK;

/// A channel.
pub(super) struct PickupChannel {
    sum: [f32; MAX_BLOCK],
    sensor: Option<Box<Sensor>>,
}

/// A sensor: its filters at the rate inside, its converter at that of the outputs.
struct Sensor {
    filter: SensorFilter,
    state: SensorFilterState,
    converter: Converter,
}

impl PickupChannel {
    /// The channels of a config.
    pub(super) fn all(config: &Config) -> Result<Vec<Self>, DesignError> {
        let sensor = |(index, profile): (usize, &SensorProfile)| {
            // Each channel has noise of its own.
            let seed = config.seed.wrapping_add((index as u64) << 32);
            Ok(Box::new(Sensor {
                filter: SensorFilter::new(profile, config.inner_rate_hz())?,
                state: SensorFilterState::default(),
                converter: Converter::new(profile, seed, config.sample_rate_hz),
            }))
        };
        let channel = |(index, profile): (usize, &Option<SensorProfile>)| {
            let sensor = profile.as_ref().map(|profile| sensor((index, profile))).transpose()?;
            Ok(Self { sum: [0.0; MAX_BLOCK], sensor })
        };
        config.pickups.iter().enumerate().map(channel).collect()
    }
}

impl Renderer {
    /// Number of channels of pickups.
    #[must_use]
    pub fn pickup_channels(&self) -> usize {
        self.pickups.len()
    }

    /// Writes what the pickups read in `n` inner samples, from `at` on in the outputs.
    pub(super) fn render_pickups(&mut self, at: usize, n: usize, out: &mut [&mut [f32]]) {
        if self.pickups.is_empty() {
            return;
        }
        self.pickups.iter_mut().for_each(|channel| channel.sum[..n].fill(0.0));
        for index in self.bodies_used.iter() {
            let Some(pickups) = self.bodies[index].pickups() else { continue };
            for slot in pickups.slots() {
                slot.add_to(&mut self.pickups[slot.channel].sum[..n]);
            }
        }
        let inner = self.shared.inner_audio;
        for (index, channel) in self.pickups.iter_mut().enumerate() {
            let block = &mut channel.sum[..n];
            if let Some(sensor) = &mut channel.sensor {
                sensor.state.run(&sensor.filter, block);
                let leaving = (self.position..).zip(block.iter_mut());
                for (_, x) in leaving.filter(|(sample, _)| inner.leaves(*sample)) {
                    *x = sensor.converter.tick(*x);
                }
            }
            self.outlets.pickup(index, inner, self.position, block);
            if let Some(out) = out.get_mut(index) {
                inner.pick(at, block, out);
            }
        }
    }
}
