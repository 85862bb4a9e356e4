//! Channel map: which device channel carries which signal, and interleaving.

use crate::audio::renderer::Renderer;
use crate::link::ring::Sender;
use crate::model::bus::MAX_BUSES;

/// Longest stretch rendered at once, frames; longer callbacks are split, so no memory depends on
/// what a device promised about its block size.
const CHUNK_FRAMES: usize = 512;

/// Device channels of each audio bus and of each actuator, counted from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelMap {
    /// Channels of each audio bus, in order. Buses beyond these play on the channels of the first,
    /// so that none is lost.
    pub audio: Vec<Vec<usize>>,
    /// Channel of each actuator, in order.
    pub haptic: Vec<usize>,
}

/// Why a channel map was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("channels: \"{text}\": {problem}; give for example audio=0,1 haptic=2,3, or dualsense")]
pub struct ChannelMapError {
    text: String,
    problem: &'static str,
}

impl ChannelMap {
    /// The four USB channels of a `DualSense` controller at 48 kHz: speaker left and right,
    /// actuator left and right. Source: user reports of the USB descriptors; over Bluetooth there
    /// is no such device.
    #[must_use]
    pub fn dualsense() -> Self {
        Self { audio: vec![vec![0, 1]], haptic: vec![2, 3] }
    }

    /// Audio on the first two channels, the actuators on those that follow.
    #[must_use]
    pub fn stereo_then_haptics(actuators: usize) -> Self {
        Self { audio: vec![vec![0, 1]], haptic: (2..2 + actuators).collect() }
    }

    /// Reads `audio=0,1 haptic=2,3` (either part may be missing) or `dualsense`. A further
    /// `audio=…` is the next bus's.
    ///
    /// # Errors
    /// When a part is unknown, a channel is no number below 256, or two signals share a channel.
    pub fn parse(text: &str) -> Result<Self, ChannelMapError> {
        // On one line, however many the text has.
        let plain = || text.split_whitespace().collect::<Vec<_>>().join(" ");
        let refuse = |problem| ChannelMapError { text: plain(), problem };
        if text.trim() == "dualsense" {
            return Ok(Self::dualsense());
        }
        let mut map = Self { audio: Vec::new(), haptic: Vec::new() };
        for part in text.split_whitespace() {
            let (name, list) = part.split_once('=').ok_or_else(|| refuse("a part has no \"=\""))?;
            let number = |channel: &str| channel.parse::<u8>().map(usize::from);
            let channels = list.split(',').map(number).collect::<Result<Vec<_>, _>>();
            let channels = channels.map_err(|_| refuse("a channel is no number from 0 to 255"))?;
            match name {
                "audio" => map.audio.push(channels),
                "haptic" => map.haptic.extend(channels),
                _ => return Err(refuse("only audio and haptic can be mapped")),
            }
        }
        let mut all: Vec<_> = map.audio.iter().flatten().chain(&map.haptic).collect();
        if all.is_empty() {
            return Err(refuse("nothing is mapped"));
        }
        all.sort_unstable();
        if all.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(refuse("two signals share a channel"));
        }
        Ok(map)
    }

    /// Number of channels that a device must have.
    #[must_use]
    pub fn width(&self) -> usize {
        self.audio.iter().flatten().chain(&self.haptic).max().map_or(0, |last| last + 1)
    }
}

/// A renderer behind an interleaved callback of any size. Nothing in [`fill`](Self::fill)
/// allocates.
#[derive(Debug)]
pub struct Interleaver {
    renderer: Renderer,
    map: ChannelMap,
    audio: Vec<Vec<f32>>,
    haptic: Vec<Vec<f32>>,
    /// Rings that take the actuators when they play on a device of their own.
    tee: Vec<Sender<f32>>,
}

impl Interleaver {
    /// Puts a renderer behind a map; actuators beyond the map are rendered and not heard.
    #[must_use]
    pub fn new(renderer: Renderer, map: ChannelMap) -> Self {
        let haptic = vec![vec![0.0; CHUNK_FRAMES]; renderer.haptic_channels()];
        let audio = vec![vec![0.0; CHUNK_FRAMES]; renderer.audio_buses()];
        Self { renderer, map, audio, haptic, tee: Vec::new() }
    }

    /// Fills an interleaved buffer of `channels` channels; what no signal is mapped to is silent.
    pub fn fill(&mut self, out: &mut [f32], channels: usize) {
        out.fill(0.0);
        if channels == 0 {
            return;
        }
        for chunk in out.chunks_mut(CHUNK_FRAMES * channels) {
            let frames = chunk.len() / channels;
            self.render(frames);
            let mut put = |channel: usize, signal: &[f32]| {
                if channel < channels {
                    for (frame, x) in chunk.chunks_exact_mut(channels).zip(signal) {
                        frame[channel] += *x;
                    }
                }
            };
            for (bus, signal) in self.audio.iter().enumerate() {
                for channel in self.map.audio.get(bus).or(self.map.audio.first()).into_iter().flatten() {
                    put(*channel, signal);
                }
            }
            for (channel, signal) in self.map.haptic.iter().zip(&self.haptic) {
                put(*channel, signal);
            }
            for (ring, signal) in self.tee.iter_mut().zip(&self.haptic) {
                for x in &signal[..frames] {
                    // A full ring means that the other device stands still; the sample is lost.
                    let _ = ring.send(*x);
                }
            }
        }
    }

    fn render(&mut self, frames: usize) {
        // Slices of slices without allocation: signals are rendered into fixed arrays.
        let mut haptic: [&mut [f32]; MAX_ACTUATORS] = std::array::from_fn(|_| &mut [][..]);
        let mut audio: [&mut [f32]; MAX_BUSES] = std::array::from_fn(|_| &mut [][..]);
        let (channels, buses) = (self.haptic.len().min(MAX_ACTUATORS), self.audio.len().min(MAX_BUSES));
        for (slice, channel) in haptic.iter_mut().zip(&mut self.haptic) {
            *slice = &mut channel[..frames];
        }
        for (slice, bus) in audio.iter_mut().zip(&mut self.audio) {
            *slice = &mut bus[..frames];
        }
        self.renderer.render(&mut haptic[..channels], &mut audio[..buses]);
    }

    #[cfg(feature = "device")]
    pub(crate) fn tee_haptics(&mut self, rings: Vec<Sender<f32>>) {
        self.tee = rings;
    }

    /// Gives the renderer back, for a device at another rate
    /// ([`Scene::at_rate`](crate::Scene::at_rate)).
    #[must_use]
    pub fn into_renderer(self) -> Renderer {
        self.renderer
    }

    /// The renderer inside.
    pub fn renderer(&mut self) -> &mut Renderer {
        &mut self.renderer
    }

    /// The map.
    #[must_use]
    pub fn map(&self) -> &ChannelMap {
        &self.map
    }
}

/// Most actuators a device can carry.
const MAX_ACTUATORS: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::config::Config;

    #[test]
    fn maps_are_read_as_the_command_line_spells_them() {
        let map = ChannelMap::parse("audio=0,1 haptic=2,3").unwrap();
        assert_eq!(map, ChannelMap::dualsense());
        assert_eq!(ChannelMap::parse("dualsense").unwrap(), map);
        assert_eq!(map.width(), 4);
        assert_eq!(ChannelMap::parse("haptic=5").unwrap().width(), 6);
    }

    #[test]
    fn impossible_maps_are_refused_with_an_example() {
        for text in ["", "audio", "audio=x", "video=1", "audio=0 haptic=0", "audio=300", "audio=1\n,\nx"] {
            let message = ChannelMap::parse(text).unwrap_err().to_string();
            assert!(message.contains("audio=0,1 haptic=2,3") && message.lines().count() == 1, "{message}");
        }
    }

    #[test]
    fn any_callback_size_gives_the_same_samples() {
        let fill = |sizes: &[usize]| {
            let crate::engine::Engine { mut scene, renderer, .. } = Config::default().build().unwrap();
            let mode = asperity_dsp::mode::Mode {
                frequency_hz: 500.0,
                decay_per_s: 5.0,
                amplitude: 1.0,
                phase_rad: 0.0,
            };
            let body = scene
                .add_body(crate::model::modal_model::ModalModel::new(vec![mode], 0.01).unwrap())
                .unwrap();
            let impact =
                crate::model::event::Impact { body, mass_kg: 0.01, ..crate::model::event::Impact::on(body) };
            scene.report(0.01, crate::model::event::ContactEvent::Impact(impact)).unwrap();
            let mut device = Interleaver::new(renderer, ChannelMap::parse("audio=2 haptic=0").unwrap());
            let mut out = vec![0.0; 3 * 6000];
            let mut rest = &mut out[..];
            for size in sizes.iter().cycle() {
                let (now, later) = rest.split_at_mut((3 * size).min(rest.len()));
                device.fill(now, 3);
                rest = later;
                if rest.is_empty() {
                    break;
                }
            }
            out
        };
        let reference = fill(&[6000]);
        assert!(reference.chunks(3).any(|frame| frame[2] != 0.0));
        assert!(reference.chunks(3).all(|frame| frame[1] == 0.0));
        assert!(fill(&[1, 264, 512, 85, 170, 2]) == reference);
    }
}
