//! Second-order Butterworth filter, low-pass and high-pass from the same state.
//!
//! ```text
//! H_lp(s) = ω² / (s² + √2 ω s + ω²)      H_hp(s) = s² / (s² + √2 ω s + ω²)      ω = 2π cutoff_hz
//! ```
//! discretised by the trapezoidal rule with the cutoff prewarped, g = tan(π cutoff/rate), and run
//! as a state-variable filter in `f64`:
//!
//! | symbol | here | |
//! |---|---|---|
//! | v₁ | [`Output::band`] | ω⁻¹ · d(low)/dt |
//! | v₂ | [`Output::low`] | the smoothed position |
//! | x − √2 v₁ − v₂ | [`Output::high`] | what the actuator stage keeps |
//!
//! Source: Hasti §III-C asks for "a 2nd-order Butterworth low-pass filter (−3 dB cutoff at 30 Hz)".
//! Why this form: at 30 Hz and 44.1 kHz a direct-form biquad in `f32` settles 2–7 texels of a 1024
//! map beside its input; this form in `f64` settles on it to rounding. The group delay at 0 Hz is
//! √2/ω = 7.5 ms at 30 Hz.

use crate::DesignError;
use crate::pair::Pair;
use core::f64::consts::{PI, SQRT_2};

/// Coefficients of one filter; shared by every channel and contact at the same rate.
///
/// ```
/// use asperity_dsp::butterworth::{Butterworth, State};
///
/// let filter = Butterworth::new(30.0, 44_100.0)?;
/// let mut state = State::settled_at(0.0);
/// let after_a_second = (0..44_100).map(|_| state.tick(&filter, 1.0)).last().unwrap();
/// assert!((after_a_second.low - 1.0).abs() < 1e-9 && after_a_second.high.abs() < 1e-9);
/// # Ok::<(), asperity_dsp::DesignError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Butterworth {
    pub(crate) a1: f64,
    pub(crate) a2: f64,
    pub(crate) a3: f64,
    /// Coefficients that move the state: 2 a₁ − 1, 2 a₂, 2 a₃. Written so, a sample waits for its
    /// predecessor half as long as when the state is mirrored about the output.
    pub(crate) band_to_band: f64,
    pub(crate) cross: f64,
    pub(crate) input_to_low: f64,
    angular_cutoff_per_s: f64,
}

/// Memory of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    pub(crate) band: f64,
    pub(crate) low: f64,
}

/// The three responses to one input sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Output {
    /// Low-pass response.
    pub low: f64,
    /// Band-pass response: the time derivative of `low`, divided by 2π · cutoff.
    pub band: f64,
    /// High-pass response.
    pub high: f64,
}

impl Butterworth {
    /// Designs the filter.
    ///
    /// ```
    /// use asperity_dsp::butterworth::{Butterworth, State};
    ///
    /// // 30 Hz at 44.1 kHz: slow signals come out 7.5 ms later.
    /// let filter = Butterworth::new(30.0, 44_100.0)?;
    /// assert!((filter.group_delay_s() - 7.5e-3).abs() < 1e-5);
    /// let mut state = State::settled_at(1.0);
    /// assert!((state.tick(&filter, 1.0).low - 1.0).abs() < 1e-12);
    /// # Ok::<(), asperity_dsp::DesignError>(())
    /// ```
    ///
    /// # Errors
    /// When `sample_rate_hz` is not positive or `cutoff_hz` is not inside (0, 0.49 · rate).
    pub fn new(cutoff_hz: f64, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let rate = DesignError::check("sample_rate_hz", sample_rate_hz, "above 0 Hz", |r| r > 0.0)?;
        let cutoff = DesignError::check(
            "cutoff_hz",
            cutoff_hz,
            "above 0 Hz and below 0.49 of the sample rate",
            |c| c > 0.0 && c < 0.49 * rate,
        )?;
        let g = libm::tan(PI * cutoff / rate);
        let a1 = 1.0 / (1.0 + g * (g + SQRT_2));
        let (a2, a3) = (g * a1, g * g * a1);
        Ok(Self {
            a1,
            a2,
            a3,
            band_to_band: 2.0 * a1 - 1.0,
            cross: 2.0 * a2,
            input_to_low: 2.0 * a3,
            angular_cutoff_per_s: 2.0 * PI * cutoff,
        })
    }

    /// 2π · cutoff: turns [`Output::band`] into units per second.
    pub fn angular_cutoff_per_s(&self) -> f64 {
        self.angular_cutoff_per_s
    }

    /// Delay of slow signals, seconds.
    pub fn group_delay_s(&self) -> f64 {
        SQRT_2 / self.angular_cutoff_per_s
    }
}

impl State {
    /// The state of a filter that has seen `value` for ever: the low-pass gives `value`, the
    /// high-pass gives zero.
    pub fn settled_at(value: f64) -> Self {
        Self { band: 0.0, low: value }
    }

    /// The state of a filter that has followed a straight line for ever, the line being at `value`
    /// at the first sample: the low-pass gives the line, one group delay late, from that sample on.
    pub fn settled_on_ramp(filter: &Butterworth, value: f64, rise_per_sample: f64) -> Self {
        let g = filter.a2 / filter.a1;
        let band = rise_per_sample / (2.0 * g);
        Self { band, low: value - band * (g + SQRT_2) }
    }

    /// The state of a filter whose input is at `value`, has risen by `slope_per_s` and bent by
    /// `bend_per_s2` for ever: the high-pass then gives the bend over ω² and nothing else. For
    /// cutoffs far below the rate.
    #[must_use]
    pub fn settled_on_trend(filter: &Butterworth, value: f64, slope_per_s: f64, bend_per_s2: f64) -> Self {
        let w = filter.angular_cutoff_per_s;
        let band = (slope_per_s - SQRT_2 * bend_per_s2 / w) / w;
        Self { band, low: value - SQRT_2 * band - bend_per_s2 / (w * w) }
    }

    /// Filters one sample.
    #[inline]
    pub fn tick(&mut self, filter: &Butterworth, input: f64) -> Output {
        let v3 = input - self.low;
        let band = filter.a1 * self.band + filter.a2 * v3;
        let low = (self.low + filter.a2 * self.band) + filter.a3 * v3;
        let before = self.band;
        self.band = filter.band_to_band * before + filter.cross * v3;
        self.low = (self.low + filter.cross * before) + filter.input_to_low * v3;
        Output { low, band, high: input - SQRT_2 * band - low }
    }

    /// Tests whether nothing is left in it that is larger than `least`, in the input's unit.
    #[must_use]
    pub fn is_within(&self, least: f64) -> bool {
        self.band.abs() < least && self.low.abs() < least
    }

    /// Moves the whole state by `offset`, as when a path wraps round: nothing else changes.
    pub fn shift(&mut self, offset: f64) {
        self.low += offset;
    }
}

/// Two filters that run side by side, each as [`Butterworth`] does: alone a filter waits for itself
/// most of the time.
#[derive(Debug, Clone, Copy)]
pub struct Two {
    a1: Pair,
    a2: Pair,
    a3: Pair,
    band_to_band: Pair,
    cross: Pair,
    input_to_low: Pair,
    root_two: Pair,
    band: Pair,
    low: Pair,
}

/// The responses of two filters side by side.
#[derive(Debug, Clone, Copy)]
pub struct Outputs {
    /// Low-pass responses.
    pub low: Pair,
    /// Band-pass responses.
    pub band: Pair,
    /// High-pass responses.
    pub high: Pair,
}

impl Two {
    /// Filters and where they stand.
    #[inline]
    pub fn new([a, b]: [&Butterworth; 2], [of_a, of_b]: [State; 2]) -> Self {
        Self {
            a1: [a.a1, b.a1].into(),
            a2: [a.a2, b.a2].into(),
            a3: [a.a3, b.a3].into(),
            band_to_band: [a.band_to_band, b.band_to_band].into(),
            cross: [a.cross, b.cross].into(),
            input_to_low: [a.input_to_low, b.input_to_low].into(),
            root_two: [SQRT_2; 2].into(),
            band: [of_a.band, of_b.band].into(),
            low: [of_a.low, of_b.low].into(),
        }
    }

    /// States of the two.
    #[inline]
    pub fn states(&self) -> [State; 2] {
        let ([band_a, band_b], [low_a, low_b]): ([f64; 2], [f64; 2]) = (self.band.into(), self.low.into());
        [State { band: band_a, low: low_a }, State { band: band_b, low: low_b }]
    }

    /// Filters one sample each: the same bits as [`State::tick`].
    #[inline(always)]
    pub fn tick(&mut self, input: Pair) -> Outputs {
        let v3 = input - self.low;
        let band = self.a1 * self.band + self.a2 * v3;
        let low = (self.low + self.a2 * self.band) + self.a3 * v3;
        let before = self.band;
        self.band = self.band_to_band * before + self.cross * v3;
        self.low = (self.low + self.cross * before) + self.input_to_low * v3;
        Outputs { low, band, high: input - self.root_two * band - low }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain_db(cutoff_hz: f64, rate_hz: f64, tone_hz: f64, high: bool) -> f64 {
        let filter = Butterworth::new(cutoff_hz, rate_hz).unwrap();
        let mut state = State::default();
        let periods = 400.0;
        let samples = (rate_hz / tone_hz * periods) as usize;
        let (mut re, mut im, mut count) = (0.0, 0.0, 0.0);
        for n in 0..samples {
            let phase = 2.0 * PI * tone_hz * n as f64 / rate_hz;
            let out = state.tick(&filter, phase.sin());
            if n >= samples / 2 {
                let y = if high { out.high } else { out.low };
                re += y * phase.cos();
                im += y * phase.sin();
                count += 0.5;
            }
        }
        20.0 * ((re * re + im * im).sqrt() / count).log10()
    }

    #[test]
    fn gain_at_the_cutoff_is_minus_3_db_at_every_rate() {
        for rate_hz in [8_000.0, 22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0] {
            for high in [false, true] {
                let db = gain_db(30.0, rate_hz, 30.0, high);
                assert!((db + 3.0103).abs() < 0.01, "{rate_hz} Hz: {db} dB");
            }
        }
    }

    // scipy.signal.butter(2, 30, fs=44100), freqz at 60 and 120 Hz.
    #[test]
    fn attenuation_above_the_cutoff_agrees_with_scipy() {
        assert!((gain_db(30.0, 44_100.0, 60.0, false) + 12.304_7).abs() < 0.01);
        assert!((gain_db(30.0, 44_100.0, 120.0, false) + 24.099_3).abs() < 0.01);
    }

    #[test]
    fn a_held_value_is_reproduced_to_rounding() {
        let filter = Butterworth::new(30.0, 44_100.0).unwrap();
        let mut state = State::default();
        let mut low = 0.0;
        for _ in 0..44_100 {
            low = state.tick(&filter, 0.7).low;
        }
        assert!((low - 0.7).abs() < 1e-12, "settled at {low}");
    }

    #[test]
    fn a_settled_state_gives_its_value_at_once() {
        let filter = Butterworth::new(30.0, 44_100.0).unwrap();
        let out = State::settled_at(0.3).tick(&filter, 0.3);
        assert_eq!((out.low, out.band, out.high), (0.3, 0.0, 0.0));
    }

    #[test]
    fn a_state_settled_on_a_ramp_lags_by_one_group_delay() {
        let (rate, slope) = (44_100.0, 0.1);
        let filter = Butterworth::new(30.0, rate).unwrap();
        let mut state = State::settled_on_ramp(&filter, 0.5, slope / rate);
        for n in 0..2000 {
            let line = 0.5 + slope * f64::from(n) / rate;
            let out = state.tick(&filter, line);
            assert!((line - out.low - slope * filter.group_delay_s()).abs() < 1e-8, "sample {n}");
            assert!((out.band * filter.angular_cutoff_per_s() / slope - 1.0).abs() < 1e-5, "sample {n}");
        }
    }

    #[test]
    fn a_state_settled_on_a_trend_passes_its_bend_and_nothing_else() {
        let rate = 44_100.0;
        let filter = Butterworth::new(10.0, rate).unwrap();
        let (value, slope, bend) = (2e-3, -0.03, 0.7);
        let mut state = State::settled_on_trend(&filter, value, slope, bend);
        let passed = bend / filter.angular_cutoff_per_s().powi(2);
        for n in 0..2000 {
            let t = f64::from(n) / rate;
            let out = state.tick(&filter, value + slope * t + 0.5 * bend * t * t);
            assert!((out.high / passed - 1.0).abs() < 5e-3, "sample {n}: {} of {passed}", out.high);
        }
    }

    #[test]
    fn two_filters_side_by_side_give_the_bits_of_each_alone() {
        let mut rng = crate::rng::Rng::new(11);
        let filters = [30.0, 900.0].map(|cutoff_hz| Butterworth::new(cutoff_hz, 44_100.0).unwrap());
        let mut alone = [State::settled_at(0.25), State::default()];
        let mut two = Two::new([&filters[0], &filters[1]], alone);
        for _ in 0..5000 {
            let input = [rng.uniform() - 0.5, 1e3 * rng.uniform()];
            let together = two.tick(input.into());
            let (low, band, high): ([f64; 2], [f64; 2], [f64; 2]) =
                (together.low.into(), together.band.into(), together.high.into());
            for i in 0..2 {
                let expected = alone[i].tick(&filters[i], input[i]);
                assert_eq!(Output { low: low[i], band: band[i], high: high[i] }, expected);
            }
        }
        assert_eq!(two.states(), alone);
    }

    #[test]
    fn impossible_designs_are_refused_by_name() {
        assert_eq!(Butterworth::new(f64::NAN, 44_100.0).unwrap_err().field, "cutoff_hz");
        assert_eq!(Butterworth::new(30_000.0, 44_100.0).unwrap_err().field, "cutoff_hz");
        assert_eq!(Butterworth::new(30.0, -1.0).unwrap_err().field, "sample_rate_hz");
    }
}
