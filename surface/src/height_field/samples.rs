//! Samples of a path and of the surface along it: blocks that go into a source and come out of it.

use crate::block::MAX_BLOCK;
use crate::force_output::{ForceAt, ForceOutput};
use crate::spline::Working;

/// Path of a contact during up to [`MAX_BLOCK`] consecutive samples. All slices are equally long,
/// but for [`normal_force_n`](Self::normal_force_n), which may be empty.
#[derive(Debug, Clone, Copy)]
pub struct PathBlock<'a> {
    /// Position on the surface along its u and v axes, metres; (0, 0) is the top left corner of a
    /// map and v grows downwards. Not wrapped.
    pub position_m: &'a [[f64; 2]],
    /// Tangential velocity along u and v, m/s.
    pub velocity_m_s: &'a [[f64; 2]],
    /// Distance travelled between two samples, metres: wavelengths below twice this alias.
    pub footprint_m: &'a [f64],
    /// Force pressing the contact onto the surface, N; empty where nothing presses.
    pub normal_force_n: &'a [f64],
    /// Absolute index of the first sample.
    pub first_sample: u64,
    /// Which contact this is (its slot in the engine), so that a source can keep state per contact.
    pub contact: usize,
    /// True where [`SurfaceBlock::gradient`] is read; a source may leave it as it is otherwise.
    pub slopes: bool,
    /// True where only heights, roughness and power are read: a
    /// [rigid](super::Properties::is_rigid) source may then leave the rest as it is.
    pub heights_only: bool,
    /// True where nothing but heights is read, no roughness either.
    pub bare: bool,
    /// Radius of the sphere that rides on the surface, m; 0 is a point. A source that was not
    /// [prepared](super::Setup::tip_radii_m) for it is ridden by a point.
    pub tip_radius_m: f64,
    /// Places of the body that the path lies at, m, one a sample; empty where the surface is a
    /// plane of its body. A block of stuff is cut there; a sheet ignores it.
    pub at_m: &'a [[f64; 3]],
    /// The least and the greatest coordinates of the path, where they are known
    /// ([`bounds`](super::bounds)).
    pub bounds_m: Option<[[f64; 2]; 2]>,
    /// Asks for [`SurfaceBlock::power`]: a mean square above which more makes no difference, m².
    pub full_power_m2: Option<f64>,
}

impl Default for PathBlock<'_> {
    /// No sample, a point, and only heights and slopes are asked for.
    fn default() -> Self {
        Self {
            position_m: &[],
            velocity_m_s: &[],
            footprint_m: &[],
            normal_force_n: &[],
            first_sample: 0,
            contact: 0,
            slopes: false,
            heights_only: false,
            bare: false,
            tip_radius_m: 0.0,
            at_m: &[],
            bounds_m: None,
            full_power_m2: None,
        }
    }
}

impl PathBlock<'_> {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position_m.len()
    }

    /// Tests whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position_m.is_empty()
    }

    /// Force at a sample, N.
    #[must_use]
    pub fn pressed_n(&self, index: usize) -> f64 {
        self.normal_force_n.get(index).copied().unwrap_or(0.0)
    }
}

/// Surface at each sample of a [`PathBlock`]; only the first `path.len()` entries count.
#[derive(Debug, Clone)]
pub struct SurfaceBlock {
    /// Height, metres, positive out of the surface.
    pub height_m: [f64; MAX_BLOCK],
    /// Slope of the height along u and v, m/m.
    pub gradient: [[f64; 2]; MAX_BLOCK],
    /// Perceptual roughness R of the roughness map, 0–1 (Hasti §III-C).
    pub roughness: [f64; MAX_BLOCK],
    /// Coulomb friction coefficient.
    pub friction: [f64; MAX_BLOCK],
    /// Compliance of the surface over the force that presses it (the path's), m/N; 0 = rigid. It is
    /// the secant, not the slope: sand gives way by a law that is no straight line.
    pub compliance_m_n: [f64; MAX_BLOCK],
    /// The force with which it answers; only where [slopes](PathBlock::slopes) are read.
    pub answer: ForceOutput,
    /// Relief that the source really has about each sample, where the path
    /// [asks](PathBlock::full_power_m2).
    pub power: Power,
    /// Working memory of maps, uninitialised between blocks.
    pub(crate) working: Working,
}

impl SurfaceBlock {
    /// Makes the first `n` entries a flat, smooth, frictionless, rigid surface.
    pub fn clear(&mut self, n: usize) {
        let n = n.min(MAX_BLOCK);
        self.height_m[..n].fill(0.0);
        self.gradient[..n].fill([0.0; 2]);
        self.roughness[..n].fill(0.0);
        self.friction[..n].fill(0.0);
        self.compliance_m_n[..n].fill(0.0);
        self.answer.clear();
        self.power.kind = PowerKind::Full;
    }

    /// The relief of the first `n` entries has a force law of its own, so that its slope pushes no
    /// more.
    pub fn clear_gradient_force(&mut self, n: usize) {
        for (i, gradient) in self.gradient.iter().enumerate().take(n) {
            self.answer.add(i, &ForceAt { push_per_n: *gradient, ..ForceAt::NONE }, 1.0);
        }
    }
}

impl Default for SurfaceBlock {
    fn default() -> Self {
        Self {
            height_m: [0.0; MAX_BLOCK],
            gradient: [[0.0; 2]; MAX_BLOCK],
            roughness: [0.0; MAX_BLOCK],
            friction: [0.0; MAX_BLOCK],
            compliance_m_n: [0.0; MAX_BLOCK],
            answer: ForceOutput::default(),
            power: Power::default(),
            working: Working::new(),
        }
    }
}

/// The wavelengths a source represents, metres. Where it has relief the engine adds the paper's
/// micro-noise only below `shortest_m`, so that no scale is rough twice ([`SurfaceBlock::power`]
/// says where).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WavelengthBand {
    /// Shortest wavelength in the source; `f64::INFINITY` for a source without any relief.
    pub shortest_m: f64,
    /// Longest wavelength in the source.
    pub longest_m: f64,
}

impl WavelengthBand {
    /// A source without relief: the micro-noise fills every wavelength.
    pub const EMPTY: Self = Self { shortest_m: f64::INFINITY, longest_m: 0.0 };

    /// The band that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            shortest_m: self.shortest_m.min(other.shortest_m),
            longest_m: self.longest_m.max(other.longest_m),
        }
    }
}

/// Mean square of a source's relief at wavelengths up to some millimetres about each sample of a
/// path, m². The engine's micro-relief fills in what is missing.
#[derive(Debug, Clone)]
pub struct Power {
    /// Form in which it is given.
    pub kind: PowerKind,
    /// One value a sample, where [`PowerKind::EachSample`] says so.
    pub each_m2: [f64; MAX_BLOCK],
}

/// Kinds of [`Power`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PowerKind {
    /// No relief anywhere along the path.
    None,
    /// As much everywhere as leaves no room for the micro-relief; also that of a source that gives
    /// none.
    Full,
    /// In [`Power::each_m2`].
    EachSample,
}

impl Default for Power {
    fn default() -> Self {
        Self { kind: PowerKind::Full, each_m2: [0.0; MAX_BLOCK] }
    }
}

impl Power {
    /// The value of one sample.
    #[must_use]
    pub fn at(&self, index: usize) -> f64 {
        match self.kind {
            PowerKind::None => 0.0,
            PowerKind::Full => f64::INFINITY,
            PowerKind::EachSample => self.each_m2[index],
        }
    }

    /// Adds that of another part over `n` samples.
    pub fn add(&mut self, other: &Self, n: usize) {
        match (self.kind, other.kind) {
            (_, PowerKind::None) | (PowerKind::Full, _) => {}
            (_, PowerKind::Full) => self.kind = PowerKind::Full,
            (PowerKind::None, PowerKind::EachSample) => {
                self.kind = PowerKind::EachSample;
                self.each_m2[..n].copy_from_slice(&other.each_m2[..n]);
            }
            (PowerKind::EachSample, PowerKind::EachSample) => {
                let sums = self.each_m2[..n].iter_mut().zip(&other.each_m2);
                sums.for_each(|(sum, part)| *sum += part);
            }
        }
    }
}
