//! Shared parts of the audio half: the designs that no voice owns, and the stretch of samples at
//! hand.

use crate::model::inner_rate::InnerRate;
use crate::resource::probe::PreparedProbe;
use asperity_dsp::actuator::ContactOutput;
use asperity_dsp::fractal_noise::FractalNoise;
use asperity_dsp::trajectory::TrajectoryDesign;
use asperity_surface::height_field::MAX_BLOCK;

/// The overlay fades as if it were sampled at this rate, Hz, so that it is the same relief at every
/// rate: its finest octave is whole where its cells pass at 11 kHz and gone where they pass at 22
/// kHz. Above 18 kHz next to nothing is left.
const OVERLAY_RATE_HZ: f64 = 44_100.0;

/// Designs that every voice needs and none owns.
pub(crate) struct Shared {
    pub(crate) idle_path: TrajectoryDesign,
    pub(crate) idle_output: ContactOutput,
    /// Inside; which of these samples leave says `inner`.
    pub(crate) sample_rate_hz: f64,
    pub(crate) inner: InnerRate,
    /// Lag of what the bodies sound like, which is more.
    pub(crate) inner_audio: InnerRate,
    /// Steps in which slow things are worked out, inner samples: as long in time however much the
    /// engine oversamples.
    pub(crate) slow_step: u64,
    /// The engine's own probe, and those that were added.
    pub(crate) own_probe: PreparedProbe,
    pub(crate) probes: Vec<Option<Box<PreparedProbe>>>,
    /// By how many samples the rows of every probe lag behind its inputs.
    pub(crate) row_latency: usize,
    pub(crate) noise: FractalNoise,
    /// The rise of a fade, 0 to 1.
    pub(crate) fade: Box<[f64]>,
}

impl Shared {
    /// The probe of a place; the engine's own for none.
    pub(crate) fn probe(&self, place: Option<usize>) -> &PreparedProbe {
        let added = place.and_then(|place| self.probes.get(place)?.as_deref());
        added.unwrap_or(&self.own_probe)
    }

    /// Factor of a sample's way by which the micro-relief widens or narrows it, so that it is the
    /// same relief at every rate.
    pub(crate) fn noise_footprints(&self) -> f64 {
        self.sample_rate_hz / OVERLAY_RATE_HZ
    }

    /// Time in which a contact fades.
    pub(crate) fn fade_samples(&self) -> u32 {
        self.fade.len().saturating_sub(1) as u32
    }
}

/// The samples at hand. A stretch lies within one cell of the absolute grid of [`MAX_BLOCK`]
/// samples.
#[derive(Clone, Copy)]
pub(crate) struct Segment<'a> {
    pub(crate) shared: &'a Shared,
    /// Output of the contact's actuator.
    pub(crate) output: &'a ContactOutput,
    /// Absolute index of the first sample.
    pub(crate) position: u64,
    /// Number.
    pub(crate) n: usize,
}

impl Segment<'_> {
    /// Tests whether it begins at a step of the absolute grid.
    pub(crate) fn is_on_grid(self) -> bool {
        self.position.is_multiple_of(MAX_BLOCK as u64)
    }
}

/// The samples at hand, for the thread that renders voices.
#[derive(Clone, Copy)]
pub(crate) struct SampleRange {
    /// Absolute index of the first sample.
    pub(crate) position: u64,
    /// Number.
    pub(crate) n: usize,
}

impl SampleRange {
    /// Tests whether they begin at a step of the absolute grid.
    pub(crate) fn is_on_grid(self) -> bool {
        self.position.is_multiple_of(MAX_BLOCK as u64)
    }
}
