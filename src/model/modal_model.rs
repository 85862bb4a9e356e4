//! The modes of a body.
//!
//! y(t) = Σ amplitude · e^(−decay_per_s · t) · sin(2π · frequency_hz · t + phase_rad) is the
//! response to an impulse of `impulse_n_s`; the engine scales linearly, so an impulse J sounds as y
//! · J / `impulse_n_s` (Hasti §III-D).

use crate::model::click::Click;
use crate::model::diffuse::Diffuse;
use crate::model::material::Material;
use crate::model::mode_shapes::{ModeShapes, Unit};
use crate::model::residual::Residual;
use crate::model::rising::rising;
use asperity_dsp::modal_bank::{self, Culling};
use asperity_dsp::mode::Mode;
use std::path::PathBuf;
use std::sync::Arc;

/// Most modes a body may have.
pub const MAX_MODES: usize = 65_536;

/// Validated modes of one body.
///
/// ```
/// use asperity::{ModalModel, Mode};
///
/// // What a strike of 0.01 N·s was answered with.
/// let mode = Mode { frequency_hz: 812.0, decay_per_s: 12.0, amplitude: 0.3, phase_rad: 0.0 };
/// let tile = ModalModel::new(vec![mode], 0.01)?;
/// assert_eq!(ModalModel::parse(&tile.to_json())?, tile);
/// # Ok::<(), asperity::ModalModelError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ModalModel {
    /// Recording or source of the modes; free text.
    pub source: String,
    /// The strike that `modes` is the answer to, N·s.
    pub impulse_n_s: f64,
    /// The modes, in any order.
    pub modes: Vec<Mode>,
    /// Amplitudes when the body is struck elsewhere: strike position 1, 2, … (at most
    /// [`MAX_POSITIONS`] − 1), each with one amplitude for every mode. Position 0 is `modes`
    /// itself.
    pub positions: Vec<Vec<f64>>,
    /// True where the positions are takes: the same blow again and again, as
    /// [`Body::variation`](crate::Body::variation) plays them.
    pub takes: bool,
    /// Part of the strike besides modes, played at every impact.
    pub residual: Option<Residual>,
    /// Bands of noise between and above the modes, played by impacts and strokes.
    pub diffuse: Option<Diffuse>,
    /// Motion of the surface in each mode: such a body can be struck and stroked anywhere.
    pub shapes: Option<Arc<ModeShapes>>,
    /// Unit of amplitudes and residual.
    pub unit: Unit,
    /// Sound of a blow because it pushes the body as a whole.
    pub click: Option<Click>,
}

/// Most strike positions a body may have, the first included.
pub const MAX_POSITIONS: usize = 16;

/// Why a modes file was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModalModelError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({source}); give a readable modes file", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        source: std::io::Error,
    },
    /// The file is not JSON of this shape.
    #[error("{}: {message}; must be JSON with format \"asperity.modes\", version 1, 2 or 3 and a list \"modes\"", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Fault, and its place.
        message: String,
    },
    /// A number that no body can have.
    #[error("{field}: {value:?} is refused; must be {expected}")]
    BadValue {
        /// Which field of which mode.
        field: String,
        /// Its value.
        value: f64,
        /// Accepted values.
        expected: &'static str,
    },
}

impl ModalModel {
    /// A model from modes that are the answer to an impulse of `impulse_n_s`.
    ///
    /// # Errors
    /// When a mode grows, has no frequency, or a number is not finite.
    pub fn new(modes: Vec<Mode>, impulse_n_s: f64) -> Result<Self, ModalModelError> {
        let model = Self { impulse_n_s, modes, ..Self::silent() };
        model.check()?;
        Ok(model)
    }

    /// No mode at all: for a body that is never heard, or not yet.
    #[must_use]
    pub fn silent() -> Self {
        Self {
            source: String::new(),
            impulse_n_s: 1.0,
            modes: Vec::new(),
            positions: Vec::new(),
            takes: false,
            residual: None,
            diffuse: None,
            shapes: None,
            unit: Unit::Relative,
            click: None,
        }
    }

    /// Model of which every answer is `gain` times as strong.
    ///
    /// # Errors
    /// When an amplitude leaves ±1e9.
    pub fn with_gain(mut self, gain: f64) -> Result<Self, ModalModelError> {
        self.modes.iter_mut().for_each(|mode| mode.amplitude *= gain);
        self.positions.iter_mut().flatten().for_each(|amplitude| *amplitude *= gain);
        if let Some(shapes) = &mut self.shapes {
            Arc::make_mut(shapes).gains.iter_mut().for_each(|g| *g *= gain);
        }
        if let Some(residual) = &mut self.residual {
            residual.samples.iter_mut().for_each(|x| *x = (f64::from(*x) * gain) as f32);
        }
        if let Some(diffuse) = &mut self.diffuse {
            diffuse.scale(gain);
        }
        if let Some(click) = &mut self.click {
            click.gain *= gain;
        }
        self.check()?;
        Ok(self)
    }

    /// Body `size` times as large, of `material`: every mode lower by `size`, and its decay as much
    /// longer or shorter as the material's damping says of its new frequency. Amplitudes stay; a
    /// residual is of the size it was recorded at, and is left out.
    ///
    /// ```
    /// use asperity::{Material, Stock};
    ///
    /// let bar = Stock::Bar.modes(&Material::STEEL, 0.2)?;
    /// let larger = bar.clone().scaled(2.0, &Material::STEEL)?;
    /// assert!((larger.modes[0].frequency_hz / bar.modes[0].frequency_hz - 0.5).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the size is not a finite number above 0, or a mode leaves the range of frequencies.
    pub fn scaled(mut self, size: f64, material: &Material) -> Result<Self, ModalModelError> {
        if !(size.is_finite() && size > 0.0) {
            let (field, expected) = ("size".into(), "a finite factor above 0");
            return Err(ModalModelError::BadValue { field, value: size, expected });
        }
        let damping = material.damping();
        for mode in &mut self.modes {
            let own_per_s = damping.decay_per_s(mode.frequency_hz);
            mode.frequency_hz /= size;
            if own_per_s > 0.0 {
                mode.decay_per_s *= damping.decay_per_s(mode.frequency_hz) / own_per_s;
            }
        }
        if let Some(shapes) = &mut self.shapes {
            Arc::make_mut(shapes).scale(size);
        }
        self.residual = None;
        if let Some(diffuse) = &mut self.diffuse {
            diffuse.resize(size, damping);
        }
        if let Some(click) = &mut self.click {
            let larger = size * size * size;
            (click.volume_m3, click.mass_kg) = (click.volume_m3 * larger, click.mass_kg * larger);
        }
        self.check()?;
        Ok(self)
    }

    /// Model with more strike positions: one amplitude for every mode in each list.
    ///
    /// # Errors
    /// When a list is not as long as the modes, a number is not finite, or there are too many.
    pub fn with_positions(mut self, positions: Vec<Vec<f64>>) -> Result<Self, ModalModelError> {
        self.positions = positions;
        self.check()?;
        Ok(self)
    }

    /// Model with what a strike has besides its modes; `gain` scales it, 0 leaves it out.
    ///
    /// # Errors
    /// When the burst is longer than [`LONGEST_S`](crate::model::residual::LONGEST_S) or holds no
    /// finite numbers.
    pub fn with_residual(mut self, residual: Option<Residual>, gain: f64) -> Result<Self, ModalModelError> {
        self.residual = residual.filter(|_| gain != 0.0).map(|mut residual| {
            residual.samples.iter_mut().for_each(|x| *x = (f64::from(*x) * gain) as f32);
            residual
        });
        self.check()?;
        Ok(self)
    }

    /// Model with the motion of its surface, in the order of its modes: it can be struck anywhere.
    ///
    /// # Errors
    /// When the shapes do not fit the modes or each other.
    pub fn with_shapes(
        mut self,
        shapes: impl Into<Arc<ModeShapes>>,
        unit: Unit,
    ) -> Result<Self, ModalModelError> {
        let shapes = shapes.into();
        let misfit = |message| ModalModelError::Malformed { path: "shapes".into(), message };
        shapes.check(self.modes.len()).map_err(misfit)?;
        (self.shapes, self.unit) = (Some(shapes), unit);
        self.check()?;
        Ok(self)
    }

    /// Number of strike positions, the first included.
    #[must_use]
    pub fn position_count(&self) -> usize {
        1 + self.positions.len()
    }

    /// The model without the modes that nobody can hear at `sample_rate_hz`, wherever it is struck.
    #[must_use]
    pub fn audible(&self, sample_rate_hz: f64, culling: &Culling) -> Self {
        let mut keep = vec![false; self.modes.len()];
        let mut audible = vec![false; self.modes.len()];
        // Slow decays first: maskers come before what they mask.
        let order = rising(&self.modes.iter().map(|mode| mode.decay_per_s).collect::<Vec<_>>());
        let positions = (0..self.position_count()).map(|position| self.modes_at(position).collect());
        for at in positions.chain(self.shapes.is_some().then(|| self.modes_anywhere())) {
            let at: Vec<Mode> = at;
            let sorted: Vec<_> = order.iter().map(|&i| at[i]).collect();
            modal_bank::audible(&sorted, sample_rate_hz, culling, &mut audible);
            order.iter().zip(&audible).for_each(|(&i, audible)| keep[i] |= audible);
        }
        let kept = |i: &usize| keep[*i];
        Self {
            modes: (0..self.modes.len()).filter(kept).map(|i| self.modes[i]).collect(),
            positions: self
                .positions
                .iter()
                .map(|amplitudes| (0..amplitudes.len()).filter(kept).map(|i| amplitudes[i]).collect())
                .collect(),
            takes: self.takes,
            source: self.source.clone(),
            impulse_n_s: self.impulse_n_s,
            residual: self.residual.clone(),
            diffuse: self.diffuse.clone(),
            shapes: self.shapes.as_ref().map(|shapes| Arc::new(shapes.kept(&keep))),
            unit: self.unit,
            click: self.click,
        }
    }

    /// The modes as they answer a strike at a position.
    pub(crate) fn modes_at(&self, position: usize) -> impl Iterator<Item = Mode> + '_ {
        let elsewhere = position.checked_sub(1).and_then(|i| self.positions.get(i));
        self.modes.iter().enumerate().map(move |(i, mode)| {
            let amplitude = elsewhere.and_then(|a| a.get(i)).copied().unwrap_or(mode.amplitude);
            Mode { amplitude, ..*mode }
        })
    }

    /// The modes, each as it answers where it swings most.
    fn modes_anywhere(&self) -> Vec<Mode> {
        let most = |(i, mode): (usize, &Mode)| Mode { amplitude: self.most_anywhere(i), ..*mode };
        self.modes.iter().enumerate().map(most).collect()
    }

    /// Response of a mode to an impulse of `impulse_n_s` where it swings most; 0 without shapes.
    fn most_anywhere(&self, mode: usize) -> f64 {
        let Some(shapes) = &self.shapes else { return 0.0 };
        let square = |phi: &[f32; 3]| phi.iter().map(|x| f64::from(x * x)).sum::<f64>();
        let most = shapes.phi_per_sqrt_kg[mode].iter().map(square).fold(0.0, f64::max).sqrt();
        self.impulse_n_s * shapes.gains[mode] * most
    }

    /// The modes for an impulse of 1 N·s, each at the position where it answers most, and its share
    /// of that (−1 to 1) at every position.
    pub(crate) fn unit_modes(&self) -> impl Iterator<Item = (Mode, [f32; MAX_POSITIONS])> + '_ {
        (0..self.modes.len()).map(|i| {
            let mode = self.modes[i];
            let at = |p: usize| if p == 0 { mode.amplitude } else { self.positions[p - 1][i] };
            let places =
                (0..self.position_count()).map(at).chain(self.shapes.as_ref().map(|_| self.most_anywhere(i)));
            let most = places.max_by(|a, b| a.abs().total_cmp(&b.abs()));
            let most = most.unwrap_or(mode.amplitude);
            let share =
                |p| if p < self.position_count() && most != 0.0 { (at(p) / most) as f32 } else { 0.0 };
            (Mode { amplitude: most / self.impulse_n_s, ..mode }, std::array::from_fn(share))
        })
    }

    pub(crate) fn check(&self) -> Result<(), ModalModelError> {
        let refuse =
            |field: String, value: f64, expected| ModalModelError::BadValue { field, value, expected };
        let in_range = |value: f64, low: f64, high: f64| value >= low && value <= high;
        if !in_range(self.impulse_n_s, 1e-12, 1e6) {
            return Err(refuse("impulse_n_s".into(), self.impulse_n_s, "1e-12–1e6 N·s"));
        }
        if self.modes.len() > MAX_MODES {
            return Err(refuse("modes".into(), self.modes.len() as f64, "at most 65536 modes"));
        }
        if self.positions.len() >= MAX_POSITIONS {
            return Err(refuse("positions".into(), self.positions.len() as f64, "at most 15 lists"));
        }
        for (p, amplitudes) in self.positions.iter().enumerate() {
            if amplitudes.len() != self.modes.len() {
                let expected = "as many amplitudes as there are modes";
                return Err(refuse(format!("positions[{p}]"), amplitudes.len() as f64, expected));
            }
            if let Some(bad) = amplitudes.iter().find(|a| !in_range(**a, -1e9, 1e9)) {
                return Err(refuse(format!("positions[{p}]"), *bad, "finite, within ±1e9"));
            }
        }
        if let Some(Err((field, value, expected))) = self.click.as_ref().map(Click::check) {
            return Err(refuse(field.into(), value, expected));
        }
        if let Some(Err((field, value, expected))) = self.diffuse.as_ref().map(Diffuse::check) {
            return Err(refuse(field, value, expected));
        }
        if let Some(Err((field, value, expected))) = self.residual.as_ref().map(Residual::check) {
            return Err(refuse(field.into(), value, expected));
        }
        for (i, mode) in self.modes.iter().enumerate() {
            if !in_range(mode.frequency_hz, 1e-3, 1e7) {
                return Err(refuse(format!("modes[{i}].frequency_hz"), mode.frequency_hz, "1e-3–1e7 Hz"));
            }
            if !in_range(mode.decay_per_s, 0.0, 1e7) {
                return Err(refuse(format!("modes[{i}].decay_per_s"), mode.decay_per_s, "0–1e7 1/s"));
            }
            if !in_range(mode.amplitude, -1e9, 1e9) {
                return Err(refuse(format!("modes[{i}].amplitude"), mode.amplitude, "finite, within ±1e9"));
            }
            if !in_range(mode.phase_rad, -1e3, 1e3) {
                return Err(refuse(
                    format!("modes[{i}].phase_rad"),
                    mode.phase_rad,
                    "finite, within ±1e3 rad",
                ));
            }
        }
        Ok(())
    }
}
