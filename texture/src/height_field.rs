//! The one way the engine reads a surface: in blocks, along a contact path.
//!
//! A source is owned by the audio half and called only from it. It must not allocate, lock, wait or
//! panic, and **every sample must be a function of the path at that sample alone** (or of state that
//! is anchored to the absolute sample index), so that any split of time into blocks gives the same
//! bits. The path's positions are finite; they may be any number of periods away from the origin.

use crate::answer::{Answer, AnswerAt};
pub use crate::block::{MAX_BLOCK, bounds};
use crate::height_map::Working;
use asperity_dsp::DesignError;
use std::any::Any;

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
    /// Whether anybody will look at [`SurfaceBlock::gradient`]; a source may leave it as it is otherwise.
    pub slopes: bool,
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
    /// The force with which it answers; only where somebody looks at [slopes](PathBlock::slopes).
    pub answer: Answer,
    /// In which maps are worked out: memory that is at hand anyway, and that nobody clears.
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
    }
}

impl SurfaceBlock {
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
            working: Working::new(),
        }
    }
}

/// The wavelengths a source represents, metres. Where it has relief the engine adds the paper's micro-noise only
/// below `shortest_m`, so that no scale is rough twice ([`HeightField::add_local_power`] tells where).
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

/// How a contact presses on the surface, told to the source once every [`MAX_BLOCK`] samples on the
/// absolute sample grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// The contact's slot, as in [`PathBlock::contact`].
    pub contact: usize,
    /// Absolute index of the sample this describes.
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
    /// What lies under the contact is changing, whether it moves or not: a contact that rests must look.
    pub stirs: bool,
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

/// What a source says of its relief along a path ([`HeightField::local_power`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LocalPower {
    /// It has none.
    Nothing,
    /// It has as much everywhere as leaves no room for the micro-noise.
    Full,
    /// So much as was written for each place.
    Told,
}

/// What an engine tells a source when it takes it, on the game thread: nothing of it is the user's to know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Rate of the samples that [`PathBlock::first_sample`] counts, Hz.
    pub sample_rate_hz: f64,
    /// Contacts are numbered below this.
    pub voices: usize,
}

impl Default for Setup {
    /// What every source is made for until an engine takes it: 44.1 kHz and the 96 voices of a default engine.
    fn default() -> Self {
        Self { sample_rate_hz: 44_100.0, voices: 96 }
    }
}

/// A surface that can be sampled in real time.
///
/// A source of one's own is these two methods. What changes while it is touched comes by [`change`](Self::change), at a sample that is known, or through a
/// handle of its own (an atomic, a ring), which takes effect wherever the audio thread happens to be: a game steered so does not replay to the bit. Positions
/// are metres from uv (0, 0) and run on beyond the surface; where texture coordinates wrap, heights must be the same again after the surface's
/// width and height, or [`beyond`](Self::beyond) says that they are not:
///
/// ```
/// use asperity_texture::height_field::{HeightField, PathBlock, SurfaceBlock, WavelengthBand};
///
/// /// A corrugated sheet along u.
/// struct Corrugated {
///     amplitude_m: f64,
///     wavelength_m: f64,
/// }
///
/// impl HeightField for Corrugated {
///     fn band(&self) -> WavelengthBand {
///         WavelengthBand { shortest_m: self.wavelength_m, longest_m: self.wavelength_m }
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
/// };
/// sheet.sample(&path, &mut out);
/// assert!((out.height_m[0] - 1e-4).abs() < 1e-12);
/// ```
pub trait HeightField: Send + Sync {
    /// The wavelengths this source represents. Asked when the surface is added, not again: it covers every wavelength that the source can be
    /// steered to.
    fn band(&self) -> WavelengthBand;

    /// Gets ready for an engine, before it is sampled, and again when that engine's rate changes; it may allocate. A source made of
    /// others hands this on. What keeps time or remembers its contacts must take both from here: no contact touches, and
    /// samples are counted anew.
    ///
    /// # Errors
    /// When the source cannot serve such an engine; the message names the field.
    fn prepare(&mut self, _setup: &Setup) -> Result<(), DesignError> {
        Ok(())
    }

    /// Gets ready to be ridden by a sphere of this radius, m; it may allocate. A source made of others hands this on. One that
    /// leaves it out is ridden by a point.
    fn prepare_tip(&mut self, _radius_m: f64) {}

    /// What is sampled from here on is what a sphere of this radius rides on, m; 0 is a point. A radius that was never
    /// prepared is a point too.
    fn ride(&mut self, _radius_m: f64) {}

    /// Whether its samples depend on nothing but their places, so that it may be read beside the path as well: what lies under a ball that stands
    /// in soft ground ([`crate::footprint`]). A source made of others hands this on.
    fn is_read_beside(&self) -> bool {
        false
    }

    /// How far from zero its heights can be, metres; 0 if the source cannot tell.
    fn reach_m(&self) -> f64 {
        0.0
    }

    /// Adds the mean square of the relief that the source really has about each place, at wavelengths up to some
    /// millimetres, m². The engine's micro-noise fills in what is missing. A source that does not know has relief
    /// everywhere in its [`band`](Self::band).
    fn add_local_power(&self, _position_m: &[[f64; 2]], power_m2: &mut [f64]) {
        power_m2.fill(f64::INFINITY);
    }

    /// What [`add_local_power`](Self::add_local_power) adds to nothing, of a path that lies between the corners of `bounds_m`, least and greatest [u, v]
    /// ([`bounds`]). A source that sees at once that it is 0 at every place, or `fills_m2` and more, may say so and leave `power_m2` as it is.
    fn local_power(
        &self,
        position_m: &[[f64; 2]],
        _bounds_m: [[f64; 2]; 2],
        _fills_m2: f64,
        power_m2: &mut [f64],
    ) -> LocalPower {
        power_m2.fill(0.0);
        self.add_local_power(position_m, power_m2);
        LocalPower::Told
    }

    /// Whether it is hard everywhere, and [`sample`](Self::sample) fills every entry of a block besides slopes that nobody looks at: friction, roughness,
    /// compliance and answer too. Nobody then fills them before it or lets it give way.
    fn is_hard_and_told(&self) -> bool {
        false
    }

    /// How much higher the ground lies on the mean of four points `reach_m` away, along u and v, than where it is touched, m: above 0
    /// in a hollow, below 0 on a crest. A source that does not know is flat; one whose samples depend on nothing but their places has
    /// [`hollow_by_samples_m`].
    fn hollow_m(&mut self, _touch: &Touch, _reach_m: f64) -> f64 {
        0.0
    }

    /// What lies beyond a tile of `tile_m` along u and v.
    fn beyond(&self, _tile_m: [f64; 2]) -> Beyond {
        Beyond::Same
    }

    /// The places of a body that the path of the next [`sample`](Self::sample) lies at, m, one a sample; none: the surface is a plane of
    /// its body. What is cut from a block of stuff is cut there; a source that is a sheet need not mind. A source made of others hands this
    /// on.
    fn lie_at(&mut self, _at_m: &[[f64; 3]]) {}

    /// The force at which the surface carries a tip that stands `depth_m` below the untouched surface, N, 0 above it; none where it is hard.
    fn carries_n(&mut self, _position_m: [f64; 2], _depth_m: f64) -> Option<f64> {
        None
    }

    /// Fills the first `path.len()` entries of `out`.
    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock);

    /// [`sample`](Self::sample) of a path that lies between the corners of `bounds_m`, least and greatest [u, v] ([`bounds`]), where nobody looks at more
    /// than heights and roughness: a source that [is hard and told](Self::is_hard_and_told) may leave the rest as it is.
    fn sample_heights(&mut self, path: &PathBlock<'_>, _bounds_m: [[f64; 2]; 2], out: &mut SurfaceBlock) {
        self.sample(path, out);
    }

    /// Tells the source that a contact begins where it is touched, before anything is read for it: what
    /// was kept of an earlier contact of this number is forgotten.
    fn land(&mut self, _touch: &Touch) {}

    /// Tells the source how it is touched, whether the contact moves or rests.
    fn react(&mut self, _touch: &Touch) -> Reaction {
        Reaction::default()
    }

    /// Changes the source at an absolute sample, counted at [`Setup::sample_rate_hz`] as [`PathBlock::first_sample`] is, without a click;
    /// tells whether the change was meant for this source and acceptable. That nothing clicks is the source's to keep: a new pitch carries on the
    /// phase of each contact ([`PathBlock::contact`]). A change is any plain value that the source knows by its type: parameters, a factor.
    /// A source made of others hands on what it does not know.
    fn change(&mut self, _change: &dyn Any, _sample: u64) -> bool {
        false
    }

    /// Shows the source, and those that it is made of, to whoever knows their types: after a render, sand is asked for its figures. A
    /// source that has nothing to say shows nothing.
    fn visit(&mut self, _see: &mut dyn FnMut(&mut dyn Any)) {}
}

/// [`HeightField::hollow_m`] from five samples, blurred to an eighth of the reach.
pub fn hollow_by_samples_m(source: &mut (impl HeightField + ?Sized), touch: &Touch, reach_m: f64) -> f64 {
    hollow_between_m(touch, reach_m, |path| {
        let mut out = SurfaceBlock::default();
        source.sample(path, &mut out);
        std::array::from_fn(|i| out.height_m[i])
    })
}

/// The same, given the heights along a path of five places.
pub(crate) fn hollow_between_m(
    touch: &Touch,
    reach_m: f64,
    heights_m: impl FnOnce(&PathBlock<'_>) -> [f64; 5],
) -> f64 {
    let [u_m, v_m] = touch.position_m;
    let position_m =
        [[u_m, v_m], [u_m - reach_m, v_m], [u_m + reach_m, v_m], [u_m, v_m - reach_m], [u_m, v_m + reach_m]];
    let [here_m, about_m @ ..] = heights_m(&PathBlock {
        position_m: &position_m,
        velocity_m_s: &[[0.0; 2]; 5],
        footprint_m: &[0.125 * reach_m; 5],
        normal_force_n: &[],
        first_sample: touch.sample,
        contact: touch.contact,
        slopes: false,
    });
    0.25 * about_m.iter().sum::<f64>() - here_m
}
