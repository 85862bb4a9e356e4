//! Output of one contact to its actuator: the motion of the pad, high-passed about its resting
//! position.

use crate::DesignError;
use crate::butterworth::{Butterworth, State};
use crate::limits::output as limits;

/// Which quantity of the pad is played.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Quantity {
    /// Displacement, m (the paper).
    Displacement,
    /// Acceleration, m/s².
    Acceleration,
    /// Drag of the skin by friction along the motion, m ([`crate::tangential`]): the place of the
    /// skin is handed in as the pad's.
    Tangential,
    /// Normal contact force, N: handed in as the pad's place.
    Force,
}

/// Time in which a contact that has ended fades, s (chosen: shorter than two 60 Hz events, and a
/// fade this long has its energy below the band of touch).
pub const RELEASE_S: f64 = 0.025;

/// Design, shared by all contacts of one actuator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactOutput {
    quantity: Quantity,
    highpass: Option<Butterworth>,
    sample_rate_hz: f64,
    through_skin: bool,
    felt_force_exponent: f64,
}

/// Memory of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactOutputState {
    /// Cutoff of the high-pass, where the design has one.
    pub highpass: State,
    velocity_m_s: f64,
}

impl ContactOutput {
    /// `highpass_hz` = 0 is off: the pad's own displacement or acceleration.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn new(quantity: Quantity, highpass_hz: f64, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let rate = DesignError::check("sample_rate_hz", sample_rate_hz, "above 0 Hz", |r| r > 0.0)?;
        limits::HIGHPASS_HZ.check("highpass_hz", highpass_hz)?;
        let highpass = if highpass_hz == 0.0 {
            None
        } else {
            let named = |e: DesignError| DesignError { field: "highpass_hz", ..e };
            Some(Butterworth::new(highpass_hz, rate).map_err(named)?)
        };
        Ok(Self { quantity, highpass, sample_rate_hz: rate, through_skin: false, felt_force_exponent: 0.0 })
    }

    /// True where an acceleration is what the skin of a finger lets through ([`super::Skin`]), and
    /// not its point's.
    #[must_use]
    pub const fn through_skin(self, through_skin: bool) -> Self {
        Self { through_skin, ..self }
    }

    /// Tests whether a contact of a probe that has skin goes through it.
    #[must_use]
    pub const fn uses_skin_filter(&self) -> bool {
        self.through_skin && matches!(self.quantity, Quantity::Acceleration)
    }

    /// Exponent n of growth of a finger's displacement with what presses, (F / 1 N)ⁿ with n from 0
    /// to 1; 0 is the pad's own motion.
    ///
    /// # Errors
    /// When n is out of range.
    pub fn growing_with_force(self, felt_force_exponent: f64) -> Result<Self, DesignError> {
        limits::FELT_FORCE_EXPONENT.check("felt_force_exponent", felt_force_exponent)?;
        Ok(Self { felt_force_exponent, ..self })
    }

    /// n of [`growing_with_force`](Self::growing_with_force) where a displacement is played,
    /// otherwise 0.
    #[must_use]
    pub const fn felt_force_exponent(&self) -> f64 {
        if matches!(self.quantity, Quantity::Displacement) { self.felt_force_exponent } else { 0.0 }
    }

    /// The high-pass, where there is one.
    #[must_use]
    pub const fn high_pass(&self) -> Option<&Butterworth> {
        self.highpass.as_ref()
    }

    /// Which quantity this design plays.
    #[must_use]
    pub const fn quantity(&self) -> Quantity {
        self.quantity
    }
}

impl ContactOutputState {
    /// A contact that begins with the pad at `pad_m`: as if it had been there for ever, so the
    /// high-passed output begins at zero.
    #[must_use]
    pub fn begin(design: &ContactOutput, pad_m: f64, pad_velocity_m_s: f64) -> Self {
        let settled = match design.quantity {
            Quantity::Displacement | Quantity::Tangential | Quantity::Force => pad_m,
            Quantity::Acceleration => 0.0,
        };
        Self { highpass: State::settled_at(settled), velocity_m_s: pad_velocity_m_s }
    }

    /// A contact that has been sliding already: its pad has risen at `slope_m_s` and bent by
    /// `bend_m_s2` for as long as the high-pass remembers, so the high-passed output begins with
    /// what a stroke there has.
    #[must_use]
    pub fn begin_sliding(
        design: &ContactOutput,
        pad_m: f64,
        pad_velocity_m_s: f64,
        slope_m_s: f64,
        bend_m_s2: f64,
    ) -> Self {
        let mut state = Self::begin(design, pad_m, pad_velocity_m_s);
        if let (Quantity::Displacement, Some(filter)) = (design.quantity, &design.highpass) {
            state.highpass = State::settled_on_trend(filter, pad_m, slope_m_s, bend_m_s2);
        }
        state
    }

    /// One sample of the pad's motion → the output quantity, SI. Acceleration is the change of
    /// velocity over the step that ends here.
    #[inline]
    pub fn tick(&mut self, design: &ContactOutput, pad_m: f64, pad_velocity_m_s: f64) -> f64 {
        let value = self.quantity(design, pad_m, pad_velocity_m_s);
        match &design.highpass {
            Some(filter) => self.highpass.tick(filter, value).high,
            None => value,
        }
    }

    /// Quantity of the pad's motion, before the high-pass: for a caller that runs the high-pass
    /// beside another ([`butterworth::Two`](crate::butterworth::Two)).
    #[inline]
    pub fn quantity(&mut self, design: &ContactOutput, pad_m: f64, pad_velocity_m_s: f64) -> f64 {
        let before_m_s = core::mem::replace(&mut self.velocity_m_s, pad_velocity_m_s);
        match design.quantity {
            Quantity::Displacement | Quantity::Tangential | Quantity::Force => pad_m,
            Quantity::Acceleration => (pad_velocity_m_s - before_m_s) * design.sample_rate_hz,
        }
    }
}
