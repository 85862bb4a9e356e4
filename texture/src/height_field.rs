//! The one way the engine reads a surface: in blocks, along a contact path.
//!
//! A source is owned by the audio half and called only from it. It must not allocate, lock, wait or
//! panic, and **every sample must be a function of the path at that sample alone** (or of state that
//! is anchored to the absolute sample index), so that any split of time into blocks gives the same
//! bits. The path's positions are finite; they may be any number of periods away from the origin.

use crate::answer::{Answer, AnswerAt};
pub use crate::block::{MAX_BLOCK, bounds};
use crate::moving_picture::MovingPicture;
use crate::spline::Working;
use crate::tip_law::TipLaw;
use asperity_dsp::DesignError;
use std::any::Any;
use std::cell::RefCell;
use std::sync::Arc;

/// A force that is no touch, N: the weight of a tenth of a milligram.
pub const NO_TOUCH_N: f64 = 1e-6;

/// Where a contact is during up to [`MAX_BLOCK`] consecutive samples. All slices are equally long, but for
/// [`normal_force_n`](Self::normal_force_n), which may be empty.
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
    /// Whether [`SurfaceBlock::gradient`] is read; a source may leave it as it is otherwise.
    pub slopes: bool,
    /// Whether only heights, roughness and power are read: a [rigid](Properties::is_rigid) source may then leave the rest as it is.
    pub heights_only: bool,
    /// Radius of the sphere that rides on the surface, m; 0 is a point. A source that was not [prepared](Setup::tip_radii_m) for it is
    /// ridden by a point.
    pub tip_radius_m: f64,
    /// Places of the body that the path lies at, m, one a sample; empty where the surface is a plane of its body. A block of stuff is
    /// cut there; a sheet ignores it.
    pub at_m: &'a [[f64; 3]],
    /// The least and the greatest coordinates of the path, where they are known ([`bounds`]).
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

    /// Whether there is no sample.
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

/// What a surface is at each sample of a [`PathBlock`]; only the first `path.len()` entries count.
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
    /// How far the surface gives way over the force that presses it (the path's), m/N; 0 = rigid. It is
    /// the secant, not the slope: sand gives way by a law that is no straight line.
    pub compliance_m_n: [f64; MAX_BLOCK],
    /// The force with which it answers; only where [slopes](PathBlock::slopes) are read.
    pub answer: Answer,
    /// Relief that the source really has about each sample, where the path [asks](PathBlock::full_power_m2).
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

    /// The relief of the first `n` entries has a force law of its own, so that its slope pushes no more.
    pub fn push_no_slope(&mut self, n: usize) {
        for (i, gradient) in self.gradient.iter().enumerate().take(n) {
            self.answer.add(i, &AnswerAt { push_per_n: *gradient, ..AnswerAt::NONE }, 1.0);
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
            answer: Answer::default(),
            power: Power::default(),
            working: Working::new(),
        }
    }
}

/// The wavelengths a source represents, metres. Where it has relief the engine adds the paper's micro-noise only
/// below `shortest_m`, so that no scale is rough twice ([`SurfaceBlock::power`] tells where).
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

/// Mean square of a source's relief at wavelengths up to some millimetres about each sample of a path, m². The
/// engine's micro-relief fills in what is missing.
#[derive(Debug, Clone)]
pub struct Power {
    /// How it is given.
    pub kind: PowerKind,
    /// One value a sample, where [`PowerKind::EachSample`] says so.
    pub each_m2: [f64; MAX_BLOCK],
}

/// How [`Power`] is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PowerKind {
    /// No relief anywhere along the path.
    None,
    /// As much everywhere as leaves no room for the micro-relief; also that of a source that gives none.
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

/// What a touch is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TouchKind {
    /// A contact begins, before anything is read for it: what was kept of an earlier contact of this number is dropped.
    Begins,
    /// A contact presses on, moving or at rest: once every [`MAX_BLOCK`] samples of the absolute grid.
    #[default]
    Presses,
    /// A tip stands `depth_m` below the untouched surface: which force carries it there?
    Stands {
        /// Depth, m; below 0 above the surface.
        depth_m: f64,
    },
}

/// A touch of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Touch {
    /// What it is.
    pub kind: TouchKind,
    /// The contact's slot, as in [`PathBlock::contact`].
    pub contact: usize,
    /// Absolute index of the sample it belongs to.
    pub sample: u64,
    /// Position on the surface, metres.
    pub position_m: [f64; 2],
    /// Tangential velocity, m/s.
    pub velocity_m_s: [f64; 2],
    /// Force pressing the contact onto the surface, N.
    pub normal_force_n: f64,
}

/// What a touch stirs up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reaction {
    /// Rate of small impacts among the surface's grains, 1/s; 0 for surfaces that do not give way.
    pub grain_rate_per_s: f64,
    /// Mean momentum of one such impact, N·s.
    pub grain_impulse_n_s: f64,
    /// The ground under the contact is changing, whether it moves or not: a contact that rests must be computed.
    pub stirs: bool,
    /// The force that carries a tip where it [stands](TouchKind::Stands), N, 0 above the ground; none where the ground is hard.
    pub carries_n: Option<f64>,
}

impl Reaction {
    /// Adds a weighted reaction; grains keep their total momentum a second.
    #[must_use]
    pub fn plus(self, part: Self, weight: f64) -> Self {
        let weighted_rate = weight.abs() * part.grain_rate_per_s;
        let rate = self.grain_rate_per_s + weighted_rate;
        let momentum =
            self.grain_rate_per_s * self.grain_impulse_n_s + weighted_rate * part.grain_impulse_n_s;
        let carried_n = part.carries_n.map(|n| self.carries_n.unwrap_or(0.0) + weight * n);
        Self {
            grain_rate_per_s: rate,
            grain_impulse_n_s: if rate > 0.0 { momentum / rate } else { 0.0 },
            stirs: self.stirs || part.stirs,
            carries_n: carried_n.or(self.carries_n),
        }
    }
}

/// What lies beyond one tile of a source: what texture coordinates that wrap mean on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Beyond {
    /// The same again, or relief that does not belong to places: a jump by a tile is no movement. Positions run on beyond the tile, so a source
    /// whose period does not divide it goes on smoothly and is another place in the next lap.
    Same,
    /// The same mirrored: a jump by two tiles is no movement.
    Mirrored,
    /// More of its kind, unlike the tile: the engine makes a tile of it ([`crate::tiled`]), blended where it meets itself.
    Fresh,
    /// Its edge: a jump across is a jump. Who runs on beyond it without wrapping goes on.
    Edge,
}

/// What never changes of a source.
#[derive(Debug, Clone)]
pub struct Properties {
    /// The wavelengths it represents: every one that it can be steered to.
    pub band: WavelengthBand,
    /// How far from zero its heights can be, metres; 0 if it cannot tell.
    pub reach_m: f64,
    /// What lies beyond a tile.
    pub beyond: Beyond,
    /// Whether it is hard everywhere, and [`HeightField::sample`] fills every entry of a block besides slopes that are not read: friction,
    /// roughness, compliance and answer too. The engine then fills nothing before it and lets nothing give way.
    pub is_rigid: bool,
    /// Whether its samples depend on nothing but their places, so that it may be read beside the path as well: under a ball that stands
    /// in soft ground ([`crate::footprint`]), and about a contact for how the ground bends ([`hollow_m`]).
    pub is_stateless: bool,
    /// The law by which it carries a tip, for a device's own thread; none where it is hard.
    pub tip_law: Option<TipLaw>,
    /// Its picture, if it is one that changes.
    pub picture: Option<Arc<MovingPicture>>,
}

impl Properties {
    /// A source of these wavelengths that repeats, or whose relief does not belong to places.
    #[must_use]
    pub fn of(band: WavelengthBand) -> Self {
        Self {
            band,
            reach_m: 0.0,
            beyond: Beyond::Same,
            is_rigid: false,
            is_stateless: false,
            tip_law: None,
            picture: None,
        }
    }

    /// Those of two sources of which either may be met at a place.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            band: self.band.union(other.band),
            reach_m: self.reach_m.max(other.reach_m),
            beyond: self.beyond.max(other.beyond),
            is_rigid: false,
            is_stateless: self.is_stateless && other.is_stateless,
            tip_law: self.tip_law.or(other.tip_law),
            picture: self.picture.or(other.picture),
        }
    }
}

/// Asks a source, as a [change](HeightField::set), for what it has become: at the end of a render it puts its results in here.
#[derive(Debug, Default)]
pub struct Finish(pub RefCell<Vec<Box<dyn Any>>>);

/// The engine that a source is prepared for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup<'a> {
    /// Rate of the samples that [`PathBlock::first_sample`] counts, Hz.
    pub sample_rate_hz: f64,
    /// Contacts are numbered below this.
    pub voices: usize,
    /// Radii of the spheres that will ride on it, m.
    pub tip_radii_m: &'a [f64],
}

impl Default for Setup<'_> {
    /// 44.1 kHz, the 96 voices of a default engine, and points.
    fn default() -> Self {
        Self { sample_rate_hz: 44_100.0, voices: 96, tip_radii_m: &[] }
    }
}

/// A part of a combination.
pub type Part = Box<dyn HeightField>;

/// How the parts of a combination share a touch: up to [`MOST_SHARES`] of a part, the touch as that part gets it, and its weight in the reaction.
pub type Shares = [Option<(usize, Touch, f64)>; MOST_SHARES];
/// Parts, or copies of a part, that a touch can reach.
pub const MOST_SHARES: usize = 8;

/// A surface that can be sampled in real time.
///
/// A source of one's own is [`properties`](Self::properties) and [`sample`](Self::sample), and as much of [`prepare`](Self::prepare),
/// [`touch`](Self::touch) and [`set`](Self::set) as it needs. A change while it is touched comes by `set`, at a sample that is known, or through a
/// handle of its own (an atomic, a ring), which takes effect wherever the audio thread happens to be: a game steered so does not replay to the bit.
/// Positions are metres from uv (0, 0) and run on beyond the surface; where texture coordinates wrap, heights must be the same again after the
/// surface's width and height, or [`Properties::beyond`] says that they are not.
///
/// A combination of other sources gives its [`parts`](Self::parts) instead, and [`shares`](Self::shares) where they do not all get
/// every touch as it is: preparing, touching and changing are then forwarded here, once for all combinations.
///
/// ```
/// use asperity_texture::height_field::{HeightField, PathBlock, Properties, SurfaceBlock, WavelengthBand};
///
/// /// A corrugated sheet along u.
/// struct Corrugated {
///     amplitude_m: f64,
///     wavelength_m: f64,
/// }
///
/// impl HeightField for Corrugated {
///     fn properties(&self, _tile_m: [f64; 2]) -> Properties {
///         let (shortest_m, longest_m) = (self.wavelength_m, self.wavelength_m);
///         Properties::of(WavelengthBand { shortest_m, longest_m })
///     }
///
///     fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
///         out.clear(path.len());
///         // A cleared surface is as smooth as can be and without friction; this one is a little rough.
///         out.roughness[..path.len()].fill(0.4);
///         out.friction[..path.len()].fill(0.5);
///         for (i, [u_m, _]) in path.position_m.iter().enumerate() {
///             let turn = std::f64::consts::TAU / self.wavelength_m;
///             out.height_m[i] = self.amplitude_m * (turn * u_m).sin();
///             out.gradient[i] = [self.amplitude_m * turn * (turn * u_m).cos(), 0.0];
///         }
///     }
/// }
///
/// let mut sheet = Corrugated { amplitude_m: 1e-4, wavelength_m: 4e-3 };
/// let mut out = SurfaceBlock::default();
/// let path = PathBlock {
///     position_m: &[[1e-3, 0.0]],
///     velocity_m_s: &[[0.1, 0.0]],
///     footprint_m: &[2e-6],
///     normal_force_n: &[0.5],
///     first_sample: 0,
///     contact: 0,
///     slopes: true,
///     ..PathBlock::default()
/// };
/// sheet.sample(&path, &mut out);
/// assert!((out.height_m[0] - 1e-4).abs() < 1e-12);
/// ```
pub trait HeightField: Send + Sync {
    /// Its properties on a surface of which one tile is `tile_m` along u and v. Read when the surface is added, not again.
    fn properties(&self, tile_m: [f64; 2]) -> Properties;

    /// Fills the first `path.len()` entries of `out`.
    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock);

    /// Gets ready for an engine, before it is sampled, and again when that engine's rate changes; it may allocate. A source that keeps
    /// time or remembers its contacts must take both from here: no contact touches, and samples are counted anew.
    ///
    /// # Errors
    /// When the source cannot serve such an engine; the message names the field.
    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        prepare_parts(self.parts(), setup)
    }

    /// Answers a touch.
    fn touch(&mut self, touch: &Touch) -> Reaction {
        touch_parts(self, touch)
    }

    /// Changes the source at an absolute sample, counted at [`Setup::sample_rate_hz`] as [`PathBlock::first_sample`] is, without a click;
    /// returns whether the change was meant for this source and acceptable. That nothing clicks is the source's to keep: a new pitch carries
    /// on the phase of each contact ([`PathBlock::contact`]). A change is any plain value that the source finds by its type: parameters, a factor.
    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        set_parts(self.parts(), change, sample)
    }

    /// The parts of a combination.
    fn parts(&mut self) -> &mut [Part] {
        &mut []
    }

    /// The shares of a combination's parts in a touch; a contact that begins does so in each of them. Each part has the whole touch, unless
    /// this says otherwise.
    fn shares(&mut self, touch: &Touch) -> Shares {
        let count = self.parts().len();
        std::array::from_fn(|part| (part < count).then_some((part, *touch, 1.0)))
    }
}

/// Prepares all parts of a combination.
///
/// # Errors
/// That of the first part that cannot serve the engine.
pub fn prepare_parts(parts: &mut [Part], setup: &Setup<'_>) -> Result<(), DesignError> {
    parts.iter_mut().try_for_each(|part| part.prepare(setup))
}

/// Hands a change to all parts of a combination; returns whether one took it.
pub fn set_parts(parts: &mut [Part], change: &dyn Any, sample: u64) -> bool {
    parts.iter_mut().fold(false, |taken, part| part.set(change, sample) | taken)
}

/// Hands a touch to the parts of a combination as they share it; the sum of their reactions.
pub fn touch_parts(combination: &mut (impl HeightField + ?Sized), touch: &Touch) -> Reaction {
    let shares = combination.shares(touch);
    let parts = combination.parts();
    shares.into_iter().flatten().fold(Reaction::default(), |sum, (part, touch, weight)| {
        match parts.get_mut(part) {
            Some(part) => sum.plus(part.touch(&touch), weight),
            None => sum,
        }
    })
}

/// How much higher the ground lies on the mean of four points `reach_m` away, along u and v, than where it is touched by a tip of this
/// radius, m: above 0 in a hollow, below 0 on a crest. The ground is blurred to an eighth of the reach. Only of a
/// [stateless](Properties::is_stateless) source; `room` is overwritten.
pub fn hollow_m(
    source: &mut (impl HeightField + ?Sized),
    touch: &Touch,
    (reach_m, tip_radius_m): (f64, f64),
    room: &mut SurfaceBlock,
) -> f64 {
    let [u_m, v_m] = touch.position_m;
    let position_m =
        [[u_m, v_m], [u_m - reach_m, v_m], [u_m + reach_m, v_m], [u_m, v_m - reach_m], [u_m, v_m + reach_m]];
    let path = PathBlock {
        position_m: &position_m,
        velocity_m_s: &[[0.0; 2]; 5],
        footprint_m: &[0.125 * reach_m; 5],
        first_sample: touch.sample,
        contact: touch.contact,
        heights_only: true,
        tip_radius_m,
        ..PathBlock::default()
    };
    source.sample(&path, room);
    0.25 * room.height_m[1..5].iter().sum::<f64>() - room.height_m[0]
}
