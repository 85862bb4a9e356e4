//! The micro-relief over a surface's own relief (Hasti §III-C): a tile of it, so that a lap comes
//! back to the same place.
//!
//! ```text
//! h(x) = cos(πw/2) n(x) + sin(πw/2) n(x − W)      x: place within the tile;  w: as in the texture's `tiled`
//! ```
//! Where the surface's own relief is at home, from its texels up, the noise is added below it only;
//! where there is none, all of it, whatever the map's resolution:
//!
//! ```text
//! n(x) = n_below(x) + c (n_all(x) − n_below(x))      c: 1 where the source has no relief, 0 from 2 rms on
//! ```
//! n_below holds [long waves](super::long_waves) too, under a map of relief without any.
//!
//! The noise never repeats by itself. Near the end of the tile it turns into that of its beginning,
//! at constant power: sine and cosine, because the two are unrelated.
//!
//! Places within a tile and their weights are those of the texture's `tiled`. It is no
//! `HeightField` among the sources: it adds to the heights that the source below it gave, by that
//! source's roughness and power at each sample, and is asked between samples too. As a source it
//! would need both through the trait, where no other source has a use for them.

use asperity_dsp::fractal_noise::{
    FractalNoise, LONGEST_CELL_M, NoiseCells, NoisePath, OCTAVES, OctaveWeights, Relief, growth,
};
use asperity_surface::height_field::MAX_BLOCK;
use asperity_surface::tiled::{TileAxis, TilePosition};
use std::f64::consts::FRAC_PI_2;

/// Layout of the noise on a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Overlay {
    axes: [TileAxis; 2],
    /// The noise is added only below this wavelength, m.
    longest_m: f64,
    rms_m: f64,
    /// Rms at an [`ORDINARY`] roughness.
    ordinary_m: f64,
    outer_scale_m: f64,
    gains_db: [f64; OCTAVES],
    /// Rms of the long waves under the source, m.
    waves_m: [f64; OCTAVES],
    /// For tips that have ridden here, and which rides now.
    tips: [Tip; TIPS],
    now: usize,
    /// Room for the next tip's weights.
    next: usize,
}

/// Tips whose weights are kept; one more takes the place of the oldest, and its weights are worked
/// out when it comes back.
const TIPS: usize = 8;
/// Roughness whose relief says how much room the noise needs: the middle of the scale.
const ORDINARY: f64 = 0.5;

/// Weights of the octaves for one tip.
#[derive(Debug, Clone, Copy)]
struct Tip {
    radius_m: f64,
    /// Below the source's own band, and everywhere.
    below: OctaveWeights,
    all: OctaveWeights,
}

/// The four copies of a tile that can meet in its corner: how many tiles back along u and v.
const COPIES: [[usize; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

/// Memory that the overlay works in; it holds nothing between two paths.
pub(crate) struct Room {
    shares: [f64; MAX_BLOCK],
    parts_m: [[f64; MAX_BLOCK]; 2],
    way_m: [[f64; 2]; MAX_BLOCK],
    lap: Lap,
}

/// Places between samples, as shares of the way from the sample before each: midway, at the first
/// quarter, at the third.
const WAYS: [f64; 3] = [0.5, 0.25, 0.75];

/// Request for the short waves of the micro-noise between samples.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BetweenQuery {
    /// The coarsest octave that counts among them.
    pub(crate) octave: usize,
    /// At the quarters too, and not midway only.
    pub(crate) quarters: bool,
    /// Place before the first sample.
    pub(crate) from_m: [f64; 2],
}

/// The short waves of the micro-noise, m.
pub(crate) struct ShortWaves {
    pub(crate) at_m: [f64; MAX_BLOCK],
    /// Between the sample before and each, midway and at the quarters.
    pub(crate) between_m: [[f64; MAX_BLOCK]; WAYS.len()],
    /// False where the surface had no answer, as while it becomes another.
    pub(crate) known: bool,
}

impl ShortWaves {
    pub(crate) const fn new() -> Self {
        Self { at_m: [0.0; MAX_BLOCK], between_m: [[0.0; MAX_BLOCK]; WAYS.len()], known: false }
    }
}

/// A path over the surface, and what is known of all of it.
pub(crate) struct NoiseQuery<'a> {
    pub(crate) path: NoisePath<'a>,
    /// Its least and greatest coordinates, those midway between samples included.
    pub(crate) bounds_m: [[f64; 2]; 2],
    /// The share of the noise's long waves, where it is the same everywhere (1 where the source has
    /// no relief, 0 where that [fills](Overlay::fills_m2) it); otherwise it follows from
    /// `power_m2`.
    pub(crate) share: Option<f64>,
    /// Relief that the source really has at each sample, m².
    pub(crate) power_m2: &'a [f64],
}

/// Place of a path in its lap of the tile, and what meets there.
struct Lap {
    /// Beginning of the lap that all of it lies in, if it is one.
    begin_m: [Option<f64>; 2],
    position_m: [[f64; 2]; MAX_BLOCK],
    places: [[TilePosition; 2]; MAX_BLOCK],
    gains: [[[f64; 2]; 2]; MAX_BLOCK],
    parts_m: [[f64; MAX_BLOCK]; MOST_SETS],
}

/// Sets of weights that a lap is worked out for at a time.
const MOST_SETS: usize = 3;

impl Room {
    pub(crate) const fn new() -> Self {
        let none = [0.0; MAX_BLOCK];
        let nowhere = TilePosition { at_m: 0.0, weight: 0.0, slope_per_m: 0.0 };
        let lap = Lap {
            begin_m: [None; 2],
            position_m: [[0.0; 2]; MAX_BLOCK],
            places: [[nowhere; 2]; MAX_BLOCK],
            gains: [[[1.0; 2]; 2]; MAX_BLOCK],
            parts_m: [none; MOST_SETS],
        };
        Self { shares: none, parts_m: [none; 2], way_m: [[0.0; 2]; MAX_BLOCK], lap }
    }
}

/// The cells that a contact was last in on each copy of the tile.
pub(crate) type TileCells = [NoiseCells; COPIES.len()];

impl Overlay {
    /// The overlay of a surface that is the same after `period_m`, ∞ for never.
    pub(crate) fn new(
        period_m: [f64; 2],
        longest_m: f64,
        (rms_m, outer_scale_m, gains_db): (f64, f64, [f64; OCTAVES]),
        waves_m: [f64; OCTAVES],
    ) -> Self {
        let axes = period_m.map(|length_m| TileAxis::new(length_m, LONGEST_CELL_M));
        let nobody = OctaveWeights::pinned(0.0, f64::INFINITY);
        let tips = [Tip { radius_m: f64::NAN, below: nobody, all: nobody }; TIPS];
        let ordinary_m = rms_m * growth(ORDINARY);
        let mut overlay = Self {
            axes,
            longest_m,
            rms_m,
            ordinary_m,
            outer_scale_m,
            gains_db,
            waves_m,
            tips,
            now: 0,
            next: 0,
        };
        overlay.tune(0.0);
        overlay
    }

    /// Sets the radius of the sphere that rides on what is added from here on, m; 0 is a point.
    pub(crate) fn tune(&mut self, radius_m: f64) {
        if self.tips[self.now].radius_m == radius_m {
            return;
        }
        if let Some(known) = self.tips.iter().position(|tip| tip.radius_m == radius_m) {
            self.now = known;
            return;
        }
        let weights = |longest_wavelength_m| {
            OctaveWeights::new(&Relief {
                rms_at_1mm_m: self.rms_m,
                outer_scale_m: self.outer_scale_m,
                tip_radius_m: radius_m,
                longest_wavelength_m,
            })
            .with_gains_db(&self.gains_db)
        };
        let below = weights(self.longest_m);
        let below = if self.waves_m == [0.0; OCTAVES] {
            below
        } else {
            below.with(&OctaveWeights::constant(&self.waves_m))
        };
        self.tips[self.next] = Tip { radius_m, below, all: weights(f64::INFINITY) };
        self.now = self.next;
        self.next = (self.next + 1) % TIPS;
    }

    /// Adds the relief along a path to `height_m`; all slices are equally long, at most
    /// [`MAX_BLOCK`].
    pub(crate) fn add(
        &self,
        field: &FractalNoise,
        NoiseQuery { path, bounds_m: [low_m, high_m], share, power_m2 }: &NoiseQuery<'_>,
        roughness: &[f64],
        height_m: &mut [f64],
        (cells, own): (&mut TileCells, &mut Room),
        between: Option<(BetweenQuery, &mut ShortWaves)>,
    ) {
        let Tip { below, all: whole, .. } = &self.tips[self.now];
        let Room { shares, parts_m, way_m, lap } = own;
        let [along_u, along_v] = &self.axes;
        lap.begin_m =
            [along_u.begin_of_all_m(low_m[0], high_m[0]), along_v.begin_of_all_m(low_m[1], high_m[1])];
        let n = height_m.len().min(MAX_BLOCK);
        let short = between.map(|(BetweenQuery { octave, quarters, from_m }, short)| {
            let weights = self.short_waves().from_octave(octave);
            let looks = if quarters { WAYS.len() } else { 1 };
            for (share, part_m) in WAYS.into_iter().zip(&mut short.between_m).take(looks) {
                let mut before_m = from_m;
                for ([x, y], at_m) in way_m.iter_mut().zip(path.position_m) {
                    *x = before_m[0] + share * (at_m[0] - before_m[0]);
                    *y = before_m[1] + share * (at_m[1] - before_m[1]);
                    before_m = *at_m;
                }
                let there = NoisePath { position_m: &way_m[..n], ..*path };
                let part_m = &mut part_m[..n];
                part_m.fill(0.0);
                self.add_tile(field, &there, roughness, &[&weights], [part_m], (&mut *cells, &mut *lap));
            }
            short.known = true;
            let at_m = &mut short.at_m[..n];
            at_m.fill(0.0);
            (weights, at_m)
        });
        let cells = (cells, lap);
        let shares = &mut shares[..if share.is_none() { n } else { 0 }];
        for (share, power_m2) in shares.iter_mut().zip(*power_m2) {
            *share = room(*power_m2, self.ordinary_m);
        }
        let everywhere = |wanted: f64| {
            share.map_or_else(|| shares.iter().all(|own| *own == wanted), |share| share == wanted)
        };
        if let Some(weights) = [(1.0, whole), (0.0, below)].into_iter().find(|(share, _)| everywhere(*share))
        {
            let weights = weights.1;
            return match short {
                Some((short, at_m)) => {
                    self.add_tile(field, path, roughness, &[weights, &short], [height_m, at_m], cells);
                }
                None => self.add_tile(field, path, roughness, &[weights], [height_m], cells),
            };
        }
        let [below_m, all_m] = parts_m.each_mut().map(|part_m| &mut part_m[..n]);
        below_m.fill(0.0);
        all_m.fill(0.0);
        match short {
            Some((short, at_m)) => {
                let into_m = [&mut *below_m, &mut *all_m, at_m];
                self.add_tile(field, path, roughness, &[below, whole, &short], into_m, cells);
            }
            None => {
                let into_m = [&mut *below_m, &mut *all_m];
                self.add_tile(field, path, roughness, &[below, whole], into_m, cells);
            }
        }
        for ((height_m, share), (below_m, all_m)) in
            height_m.iter_mut().zip(shares).zip(below_m.iter().zip(&*all_m))
        {
            *height_m += (1.0 - *share) * below_m + *share * all_m;
        }
    }

    /// Weights of the octaves that are there whatever room a source's own relief leaves: those
    /// below its band.
    pub(crate) fn short_waves(&self) -> &OctaveWeights {
        let Tip { below, all, .. } = &self.tips[self.now];
        if self.depends_on_source_relief() { below } else { all }
    }

    /// Power of a source's relief that leaves no room for the noise's long waves, m².
    pub(crate) fn fills_m2(&self) -> f64 {
        fills_m2(self.ordinary_m)
    }

    /// Tests whether the source's own relief matters.
    pub(crate) fn depends_on_source_relief(&self) -> bool {
        self.longest_m.is_finite()
    }

    /// Adds the tile's noise, weighed by each set of weights to heights of its own.
    fn add_tile<const W: usize>(
        &self,
        field: &FractalNoise,
        path: &NoisePath<'_>,
        roughness: &[f64],
        weights: &[&OctaveWeights; W],
        mut heights_m: [&mut [f64]; W],
        (cells, lap): (&mut TileCells, &mut Lap),
    ) {
        const { assert!(W <= MOST_SETS, "each set has memory of its own") };
        let Lap { begin_m, position_m, places, gains, parts_m } = lap;
        let walked_m = path.position_m;
        let n = walked_m.len().min(MAX_BLOCK);
        if let [Some(begin_u_m), Some(begin_v_m)] = *begin_m {
            for (at_m, [u_m, v_m]) in position_m.iter_mut().zip(walked_m) {
                *at_m = [u_m - begin_u_m, v_m - begin_v_m];
            }
            let path = NoisePath { position_m: &position_m[..n], ..*path };
            return field.add_each(&path, roughness, weights, &mut heights_m, &mut cells[0]);
        }
        let places = &mut places[..n];
        let mut meets = [false; 2];
        let mut turns = [0.0; 2];
        for ((place, at_m), path_m) in places.iter_mut().zip(&mut *position_m).zip(walked_m) {
            // One after the other: what goes through `map` is a call for each axis.
            let [u, v] = &self.axes;
            *place = [u.place_after(path_m[0], &mut turns[0]), v.place_after(path_m[1], &mut turns[1])];
            *at_m = [place[0].at_m, place[1].at_m];
            meets = [meets[0] | (place[0].weight > 0.0), meets[1] | (place[1].weight > 0.0)];
        }
        if meets == [false; 2] {
            let path = NoisePath { position_m: &position_m[..n], ..*path };
            return field.add_each(&path, roughness, weights, &mut heights_m, &mut cells[0]);
        }
        let gains = &mut gains[..n];
        gains_along(places, gains);
        for (copy, cells) in COPIES.into_iter().zip(cells) {
            if (0..2).any(|axis| copy[axis] == 1 && !meets[axis]) {
                continue;
            }
            let back_m = [0, 1].map(|axis| if copy[axis] == 1 { self.axes[axis].length_m } else { 0.0 });
            for (at_m, place) in position_m.iter_mut().zip(&*places) {
                *at_m = [place[0].at_m - back_m[0], place[1].at_m - back_m[1]];
            }
            let path = NoisePath { position_m: &position_m[..n], ..*path };
            let mut parts_m = parts_m.iter_mut().map(|part_m| &mut part_m[..n]);
            let mut into_m: [&mut [f64]; W] = std::array::from_fn(|_| parts_m.next().unwrap_or_default());
            into_m.iter_mut().for_each(|part_m| part_m.fill(0.0));
            field.add_each(&path, roughness, weights, &mut into_m, cells);
            for (height_m, part_m) in heights_m.iter_mut().zip(&into_m) {
                for ((height_m, part_m), gains) in height_m.iter_mut().zip(&**part_m).zip(&*gains) {
                    *height_m += gains[0][copy[0]] * gains[1][copy[1]] * part_m;
                }
            }
        }
    }
}

/// Power of a source's relief that leaves no room, m².
fn fills_m2(rms_m: f64) -> f64 {
    4.0 * rms_m * rms_m
}

/// Share of the noise's long waves that there is room for beside a source's own relief.
fn room(power_m2: f64, rms_m: f64) -> f64 {
    let room = (1.0 - power_m2 / fills_m2(rms_m)).clamp(0.0, 1.0);
    room * room * (3.0 - 2.0 * room)
}

/// Gains along u and v, each of the tile and of the one before: worked out once for all copies, and
/// anew only where the place differs.
fn gains_along(places: &[[TilePosition; 2]], gains: &mut [[[f64; 2]; 2]]) {
    let mut last = [(0.0, [1.0, 0.0]); 2];
    for (gains, places) in gains.iter_mut().zip(places) {
        for ((gain, (known, last)), place) in gains.iter_mut().zip(&mut last).zip(places) {
            if place.weight != *known {
                (*known, *last) = (place.weight, gains_at(place.weight));
            }
            *gain = *last;
        }
    }
}

fn gains_at(weight: f64) -> [f64; 2] {
    if weight == 0.0 {
        return [1.0, 0.0];
    }
    let (sine, cosine) = (libm::sin(FRAC_PI_2 * weight), libm::cos(FRAC_PI_2 * weight));
    [cosine, sine]
}
