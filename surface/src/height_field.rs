//! Trait by which the engine reads a surface: in blocks, along a contact path.
//!
//! A source is owned by the audio half and called only from it. It must not allocate, lock, wait or
//! panic, and **every sample must be a function of the path at that sample alone** (or of state
//! that is anchored to the absolute sample index), so that any split of time into blocks gives the
//! same bits. The path's positions are finite; they may be any number of periods away from the
//! origin.

mod samples;
mod touch;

pub use crate::block::{MAX_BLOCK, bounds};
use crate::moving_picture::MovingPicture;
use crate::tip_law::TipLaw;
use asperity_dsp::DesignError;
pub use samples::{PathBlock, Power, PowerKind, SurfaceBlock, WavelengthBand};
use std::any::Any;
use std::cell::RefCell;
use std::sync::Arc;
pub use touch::{Reaction, Touch, TouchKind};

/// A force that is no touch, N: the weight of a tenth of a milligram.
pub const NO_TOUCH_N: f64 = 1e-6;

/// Continuation of a source beyond one tile: what texture coordinates that wrap mean on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Extension {
    /// Repeated, or relief that does not belong to places: a jump by a tile is no movement.
    /// Positions run on beyond the tile, so a source whose period does not divide it goes on
    /// smoothly and is another place in the next lap.
    Same,
    /// Mirrored: a jump by two tiles is no movement.
    Mirrored,
    /// More of its kind, unlike the tile: the engine makes a tile of it ([`crate::tiled`]), blended
    /// where it meets itself.
    Fresh,
    /// Its edge: a jump across is a jump. Who runs on beyond it without wrapping goes on.
    Edge,
}

/// Constants of a source.
#[derive(Debug, Clone)]
pub struct Properties {
    /// The wavelengths it represents: every one that it can be steered to.
    pub band: WavelengthBand,
    /// Largest distance of its heights from zero, metres; 0 if that is unknown.
    pub reach_m: f64,
    /// Continuation beyond a tile.
    pub extension: Extension,
    /// True where it is hard everywhere, and [`HeightField::sample`] fills every entry of a block
    /// besides slopes that are not read: friction, roughness, compliance and answer too. The engine
    /// then fills nothing before it and lets nothing give way.
    pub is_rigid: bool,
    /// True where its samples depend on nothing but their places, so that it may be read beside the
    /// path as well: under a ball that stands in soft ground ([`crate::footprint`]), and about a
    /// contact for how the ground bends ([`local_concavity_m`]).
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
            extension: Extension::Same,
            is_rigid: false,
            is_stateless: false,
            tip_law: None,
            picture: None,
        }
    }

    /// Properties of two sources of which either may be met at a place.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            band: self.band.union(other.band),
            reach_m: self.reach_m.max(other.reach_m),
            extension: self.extension.max(other.extension),
            is_rigid: false,
            is_stateless: self.is_stateless && other.is_stateless,
            tip_law: self.tip_law.or(other.tip_law),
            picture: self.picture.or(other.picture),
        }
    }
}

/// Asks a source, as a [change](HeightField::set), for what it has become: at the end of a render
/// it puts its results in here.
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

/// Shares of the parts of a combination in a touch: up to [`MOST_SHARES`] of a part, the touch as
/// that part gets it, and its weight in the reaction.
pub type Shares = [Option<(usize, Touch, f64)>; MOST_SHARES];
/// Parts, or copies of a part, that a touch can reach.
pub const MOST_SHARES: usize = 8;

/// A surface that can be sampled in real time.
///
/// A source of one's own is [`properties`](Self::properties) and [`sample`](Self::sample), and as
/// much of [`prepare`](Self::prepare), [`touch`](Self::touch) and [`set`](Self::set) as it needs. A
/// change while it is touched comes by `set`, at a sample that is known, or through a handle of its
/// own (an atomic, a ring), which takes effect wherever the audio thread happens to be: a game
/// steered so does not replay to the bit. Positions are metres from uv (0, 0) and run on beyond the
/// surface; where texture coordinates wrap, heights must be the same again after the surface's
/// width and height, or [`Properties::extension`] says that they are not.
///
/// A combination of other sources gives its [`parts`](Self::parts) instead, and
/// [`shares`](Self::shares) where they do not all get every touch as it is: preparing, touching and
/// changing are then forwarded here, once for all combinations.
///
/// ```
/// use asperity_surface::height_field::{HeightField, PathBlock, Properties, SurfaceBlock, WavelengthBand};
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
    /// Its properties on a surface of which one tile is `tile_m` along u and v. Read when the
    /// surface is added, not again.
    fn properties(&self, tile_m: [f64; 2]) -> Properties;

    /// Fills the first `path.len()` entries of `out`.
    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock);

    /// Gets ready for an engine, before it is sampled, and again when that engine's rate changes;
    /// it may allocate. A source that keeps time or remembers its contacts must take both from
    /// here: no contact touches, and samples are counted anew.
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

    /// Changes the source at an absolute sample, counted at [`Setup::sample_rate_hz`] as
    /// [`PathBlock::first_sample`] is, without a click; returns whether the change was meant for
    /// this source and acceptable. That nothing clicks is the source's to keep: a new pitch carries
    /// on the phase of each contact ([`PathBlock::contact`]). A change is any plain value that the
    /// source finds by its type: parameters, a factor.
    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        set_parts(self.parts(), change, sample)
    }

    /// The parts of a combination.
    fn parts(&mut self) -> &mut [Part] {
        &mut []
    }

    /// The shares of a combination's parts in a touch; a contact that begins does so in each of
    /// them. Each part has the whole touch, unless this says otherwise.
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

/// Height of the ground in the mean of four points `reach_m` away, along u and v, over that where
/// it is touched by a tip of this radius, m: above 0 in a hollow, below 0 on a crest. The ground is
/// blurred to an eighth of the reach. Only of a [stateless](Properties::is_stateless) source;
/// `room` is overwritten.
pub fn local_concavity_m(
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
        bare: true,
        tip_radius_m,
        ..PathBlock::default()
    };
    source.sample(&path, room);
    0.25 * room.height_m[1..5].iter().sum::<f64>() - room.height_m[0]
}
