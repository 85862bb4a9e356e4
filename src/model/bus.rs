//! An audio bus: where the sound of bodies leaves, so that a game can place each body somewhere
//! else.

/// Most buses of one engine.
pub const MAX_BUSES: usize = 64;

/// An audio bus: an index of [`Config::audio`](crate::Config::audio).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BusId(pub usize);

/// Settings of an audio bus.
///
/// ```
/// use asperity::{AudioBus, Config};
///
/// // Eight places around a listener, each kept within ±1.
/// let config = Config { audio: vec![AudioBus { gain: 0.5, limit: true, ..AudioBus::default() }; 8], ..Config::default() };
/// assert!(config.build().is_ok());
/// ```
///
/// Here a gain is 1 and nothing limits unless said; a scene file that leaves `gain` out has the
/// level policy find it, and a limiter behind. A sum of panned buses may exceed 1 where each keeps
/// within: limit after the mix.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AudioBus {
    /// Linear gain, 0–1e6.
    pub gain: f64,
    /// Keeps the output within ±1 by a peak limiter.
    pub limit: bool,
    /// Sound pressure that full scale stands for, Pa, where it is known. While a machine is
    /// late, modes are left out as they are missed at the level that follows from it; without, the
    /// loudest mode of a body is taken to be at 70 dB SPL. No sample depends on it otherwise.
    pub pascals_at_full_scale: Option<f64>,
}

impl AudioBus {
    /// Sound pressure level of a sine with this peak in a body's own units, dB; none where nobody
    /// knows what full scale is.
    pub(crate) fn db_spl(&self, peak: f64) -> Option<f64> {
        let rms_pa = peak * self.gain * self.pascals_at_full_scale? * std::f64::consts::FRAC_1_SQRT_2;
        (rms_pa > 0.0).then(|| 20.0 * libm::log10(rms_pa / 20e-6))
    }
}

impl Default for AudioBus {
    fn default() -> Self {
        Self { gain: 1.0, limit: false, pascals_at_full_scale: None }
    }
}

/// Peak level of each bus, as a meter shows it: up at once, down by 20 dB in half a second. One
/// number a bus, linear, 1 = full scale.
#[derive(Clone, Copy, PartialEq)]
pub struct BusLevels {
    pub(crate) peaks: [f32; MAX_BUSES],
    pub(crate) buses: usize,
}

impl Default for BusLevels {
    fn default() -> Self {
        Self { peaks: [0.0; MAX_BUSES], buses: 0 }
    }
}

impl std::ops::Deref for BusLevels {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.peaks[..self.buses]
    }
}

impl std::fmt::Debug for BusLevels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        (**self).fmt(f)
    }
}

impl serde::Serialize for BusLevels {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}
