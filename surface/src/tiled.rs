//! A tile cut from a source that never repeats: texture coordinates that wrap come back to the same
//! place.
//!
//! ```text
//! h(x) = (1 − w) n(x) + w n(x − W)      x: place within the tile, 0 to W
//! w    = 6t⁵ − 15t⁴ + 10t³              t = (x − (W − b)) / b, 0 to 1 in the last b of the tile
//! ```
//! along u and along v. At the end of the tile the relief is that of its beginning, with slope and
//! curvature, so there is no seam to be felt. b is the longest wavelength of the source, at most a
//! quarter of the tile. The weights add up to 1 in height, so whatever does repeat (a map in a sum)
//! stays what it is; uncorrelated relief is 3 dB lower in the middle of the blend.

use crate::combine::Source;
use crate::height_field::{
    Extension, HeightField, MAX_BLOCK, Part, PathBlock, PowerKind, Properties, Shares, SurfaceBlock, Touch,
};

/// A place in a tile, and how much of it is already the next tile's beginning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TilePosition {
    /// Within the tile along one axis, m.
    pub at_m: f64,
    /// Share of the relief one tile back, 0 to 1.
    pub weight: f64,
    /// Its slope, 1/m.
    pub slope_per_m: f64,
}

/// Distance to a tile's edge, against all lengths at hand, within which rounding might have a say:
/// far more than it has.
const EDGE: f64 = 1e-12;

/// One axis of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileAxis {
    /// Its length, m; ∞ for none.
    pub length_m: f64,
    /// Length of the blend at its end, m.
    pub blend_m: f64,
}

impl TileAxis {
    /// A tile of a relief whose longest wavelength is given, m.
    #[must_use]
    pub fn new(length_m: f64, longest_m: f64) -> Self {
        Self { length_m, blend_m: longest_m.min(0.25 * length_m) }
    }

    /// Place in its tile of a place on the unwrapped surface.
    #[inline]
    #[must_use]
    pub fn place(&self, position_m: f64) -> TilePosition {
        if !self.length_m.is_finite() {
            return TilePosition { at_m: position_m, ..TilePosition::default() };
        }
        self.inside(position_m - self.length_m * floor(position_m / self.length_m))
    }

    /// [`Self::place`], to the bit, of one of many places in a row: `turn` is the number of the
    /// tile that the one before lay in.
    #[inline]
    #[must_use]
    pub fn place_after(&self, position_m: f64, turn: &mut f64) -> TilePosition {
        if !self.length_m.is_finite() {
            return TilePosition { at_m: position_m, ..TilePosition::default() };
        }
        let at_m = position_m - self.length_m * *turn;
        // Well inside a tile no rounding makes it another one.
        let edge_m = EDGE * (self.length_m + position_m.abs());
        if at_m > edge_m && at_m < self.length_m - edge_m {
            return self.inside(at_m);
        }
        *turn = floor(position_m / self.length_m);
        self.inside(position_m - self.length_m * *turn)
    }

    /// Beginning of the tile that all places from `low_m` to `high_m` lie in, well inside and
    /// before its blend: each is then [at](TilePosition::at_m) its distance from there, to the bit.
    /// `None` where they may lie otherwise.
    #[must_use]
    pub fn begin_of_all_m(&self, low_m: f64, high_m: f64) -> Option<f64> {
        if !self.length_m.is_finite() {
            return Some(0.0);
        }
        let begin_m = self.length_m * floor(low_m / self.length_m);
        let far_m = if low_m.abs() < high_m.abs() { high_m.abs() } else { low_m.abs() };
        let edge_m = EDGE * (self.length_m + far_m);
        let (low_m, high_m) = (low_m - begin_m, high_m - begin_m);
        let before_blend = high_m < self.length_m - self.blend_m;
        (low_m > edge_m && high_m < self.length_m - edge_m && before_blend).then_some(begin_m)
    }

    #[inline]
    fn inside(&self, at_m: f64) -> TilePosition {
        if at_m <= self.length_m - self.blend_m {
            return TilePosition { at_m, ..TilePosition::default() };
        }
        let t = ((at_m - (self.length_m - self.blend_m)) / self.blend_m).clamp(0.0, 1.0);
        let weight = t * t * t * (10.0 + t * (6.0 * t - 15.0));
        let slope_per_m = 30.0 * t * t * (1.0 - t) * (1.0 - t) / self.blend_m;
        TilePosition { at_m, weight, slope_per_m }
    }
}

/// Largest whole number not above x. `f64::floor` is a library call on plain x86-64.
#[inline]
pub(crate) fn floor(x: f64) -> f64 {
    // Beyond 2⁵¹ a number has no fraction worth a tile, and a cast may not hold it.
    let has_fraction = x.abs() < 2_251_799_813_685_248.0;
    if !has_fraction {
        return x.floor();
    }
    // To the nearest whole number; 1.5 · 2⁵².
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let whole = (x + ROUND) - ROUND;
    if whole > x {
        whole - 1.0
    } else if whole == x {
        // A zero keeps its sign.
        x
    } else {
        whole
    }
}

/// A source that never repeats, made to repeat.
pub struct Tiled {
    source: [Source; 1],
    axes: [TileAxis; 2],
    part: SurfaceBlock,
}

impl Tiled {
    /// A tile of `tile_m` along u and v; ∞ leaves an axis as it is.
    #[must_use]
    pub fn new(source: Source, tile_m: [f64; 2]) -> Self {
        let longest_m = source.properties(tile_m).band.longest_m.max(1e-6);
        let axes = tile_m.map(|length_m| TileAxis::new(length_m, longest_m));
        Self { source: [source], axes, part: SurfaceBlock::default() }
    }

    fn places(&self, position_m: [f64; 2]) -> [TilePosition; 2] {
        [self.axes[0].place(position_m[0]), self.axes[1].place(position_m[1])]
    }

    /// Place where a copy of the tile is read.
    fn back(&self, places: &[TilePosition; 2], copy: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| places[axis].at_m - if copy[axis] == 1 { self.axes[axis].length_m } else { 0.0 })
    }
}

/// The four copies of a tile that can meet in its corner: how many tiles back along u and v.
const COPIES: [[usize; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

/// Share of one copy, and its slope.
fn share(places: &[TilePosition; 2], copy: [usize; 2]) -> (f64, [f64; 2]) {
    let [u, v] = [0, 1].map(|axis| {
        let TilePosition { weight, slope_per_m, .. } = places[axis];
        if copy[axis] == 1 { (weight, slope_per_m) } else { (1.0 - weight, -slope_per_m) }
    });
    (u.0 * v.0, [u.1 * v.0, u.0 * v.1])
}

impl HeightField for Tiled {
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        let own = self.source[0].properties(tile_m);
        Properties { extension: Extension::Same, is_rigid: false, ..own }
    }

    fn parts(&mut self) -> &mut [Part] {
        &mut self.source
    }

    /// Every copy that meets there is touched.
    fn shares(&mut self, touch: &Touch) -> Shares {
        let places = self.places(touch.position_m);
        let mut shares = Shares::default();
        for (to, copy) in shares.iter_mut().zip(COPIES) {
            let (weight, _) = share(&places, copy);
            let position_m = self.back(&places, copy);
            *to = (weight > 0.0).then_some((0, Touch { position_m, ..*touch }, weight));
        }
        shares
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        if !path.at_m.is_empty() {
            // Places of a body need no tiles.
            return self.source[0].sample(path, out);
        }
        let mut places = [[TilePosition::default(); 2]; MAX_BLOCK];
        let mut position_m = [[0.0; 2]; MAX_BLOCK];
        for i in 0..n {
            places[i] = self.places(path.position_m[i]);
            position_m[i] = places[i].map(|place| place.at_m);
        }
        self.source[0].sample(&PathBlock { position_m: &position_m[..n], bounds_m: None, ..*path }, out);
        let blended = |axis: usize| places[..n].iter().any(|place| place[axis].weight > 0.0);
        let meets = [blended(0), blended(1)];
        if meets == [false; 2] {
            return;
        }
        let here = out.clone();
        out.clear(n);
        out.power.kind = PowerKind::EachSample;
        out.power.each_m2[..n].fill(0.0);
        for copy in COPIES {
            if (copy[0] == 1 && !meets[0]) || (copy[1] == 1 && !meets[1]) {
                continue;
            }
            let part = if copy == [0, 0] {
                &here
            } else {
                for i in 0..n {
                    position_m[i] = self.back(&places[i], copy);
                }
                let back = PathBlock { position_m: &position_m[..n], bounds_m: None, ..*path };
                self.source[0].sample(&back, &mut self.part);
                &self.part
            };
            for (i, places) in places[..n].iter().enumerate() {
                let (weight, slope) = share(places, copy);
                out.height_m[i] += weight * part.height_m[i];
                let [u, v] = part.gradient[i];
                out.gradient[i][0] += weight * u + slope[0] * part.height_m[i];
                out.gradient[i][1] += weight * v + slope[1] * part.height_m[i];
                out.roughness[i] += weight * part.roughness[i];
                out.friction[i] += weight * part.friction[i];
                out.compliance_m_n[i] += weight * part.compliance_m_n[i];
                if weight > 0.0 {
                    out.power.each_m2[i] += weight * part.power.at(i);
                }
                if !part.answer.is_empty() {
                    let mut answer = part.answer.at(i);
                    // The slope of the blend is none of the texture's.
                    let blend = slope.map(|s| s * part.height_m[i]);
                    answer.push_per_n = [0, 1].map(|a| weight * answer.push_per_n[a] + blend[a]);
                    answer.force_n = answer.force_n.map(|f| weight * f);
                    out.answer.add(i, &answer, 1.0);
                }
            }
        }
    }
}

crate::opaque::debug_by_name!(Tiled);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid_materials::SolidMaterial;
    use crate::solid_noise::SolidNoise;

    fn at(source: &mut dyn HeightField, position_m: &[[f64; 2]]) -> (Vec<f64>, Vec<[f64; 2]>) {
        let mut out = SurfaceBlock::default();
        let (mut heights, mut slopes) = (Vec::new(), Vec::new());
        for position_m in position_m.chunks(MAX_BLOCK) {
            let n = position_m.len();
            source.sample(
                &PathBlock {
                    position_m,
                    velocity_m_s: &[[0.1, 0.0]; MAX_BLOCK][..n],
                    footprint_m: &[2e-6; MAX_BLOCK][..n],
                    normal_force_n: &[],
                    first_sample: 0,
                    contact: 0,
                    slopes: true,
                    ..PathBlock::default()
                },
                &mut out,
            );
            heights.extend_from_slice(&out.height_m[..n]);
            slopes.extend_from_slice(&out.gradient[..n]);
        }
        (heights, slopes)
    }

    #[test]
    fn places_in_a_row_are_those_of_each_alone_to_the_bit() {
        for axis in
            [TileAxis::new(0.14, 0.016), TileAxis::new(1.0 / 3.0, 0.1), TileAxis::new(f64::INFINITY, 0.1)]
        {
            let mut turn = 0.0;
            let way = (0..40_000).map(|n| -0.8 + 5.3e-5 * f64::from(n));
            let edges = (-9..9).flat_map(|n| {
                let edge = f64::from(n) * axis.length_m;
                [edge.next_down(), edge, edge.next_up(), -edge, 1e9 * edge]
            });
            for x in way.chain(edges).chain([f64::NAN, 1e300, 0.07, -0.0, f64::INFINITY, 0.01]) {
                let (after, alone) = (axis.place_after(x, &mut turn), axis.place(x));
                let bits = |p: TilePosition| [p.at_m, p.weight, p.slope_per_m].map(f64::to_bits);
                assert!(
                    bits(after) == bits(alone) || x.is_nan() || x.is_infinite(),
                    "{x}: {after:?} {alone:?}"
                );
                assert_eq!(after.at_m.is_nan(), alone.at_m.is_nan());
                for other in [x, x + 1e-4, x - 3e-3] {
                    let (low, high) = (x.min(other), x.max(other));
                    if let Some(begin) = axis.begin_of_all_m(low, high) {
                        for x in [low, 0.5 * (low + high), high] {
                            let at_m = x - begin;
                            assert_eq!(
                                bits(axis.place(x)),
                                bits(TilePosition { at_m, ..TilePosition::default() }),
                                "{x}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn whole_numbers_below_are_those_of_the_library_to_the_bit() {
        let some =
            [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 0.999_999_999_999_999_9, -1e-300, 7.25, -7.25, 1e15, -1e15];
        let wild = [2e15, 2.3e15, 4.6e15, -4.6e15, 1e300, f64::INFINITY, f64::NEG_INFINITY];
        for x in some.into_iter().chain(wild).chain((0..2000).map(|n| 0.37 * f64::from(n) - 370.0)) {
            assert_eq!(floor(x).to_bits(), x.floor().to_bits(), "{x}");
        }
        assert!(floor(f64::NAN).is_nan());
    }

    #[test]
    fn a_material_that_never_repeats_has_no_seam_after_a_tile() {
        let tile_m = [0.1, 0.07];
        for material in SolidMaterial::SEVEN {
            let noise = || SolidNoise::new(material.parameters(), 3).unwrap();
            let mut tiled = Tiled::new(Box::new(noise()), tile_m);
            // Obliquely over both seams in steps of 2 µm.
            let line = |offset: [f64; 2]| -> Vec<[f64; 2]> {
                (0..20_000)
                    .map(|i| {
                        let way = 2e-6 * f64::from(i);
                        [0.09 + 0.8 * way + offset[0], 0.055 + 0.6 * way + offset[1]]
                    })
                    .collect()
            };
            let (heights, slopes) = at(&mut tiled, &line([0.0; 2]));
            let (again, _) = at(&mut tiled, &line([3.0 * tile_m[0], -2.0 * tile_m[1]]));
            let rms = (heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64).sqrt();
            for (a, b) in heights.iter().zip(&again) {
                assert!((a - b).abs() < 1e-12, "{}: {a} and {b}", material.name());
            }
            let (plain, _) = at(&mut noise(), &line([0.0; 2]));
            let step = |h: &[f64]| h.windows(2).map(|h| (h[1] - h[0]).abs()).fold(0.0, f64::max);
            assert!(step(&heights) < 3.0 * step(&plain) + 1e-9, "{}: a seam", material.name());
            for (i, slope) in slopes.iter().enumerate().skip(1).take(19_998) {
                let measured = (heights[i + 1] - heights[i - 1]) / 4e-6;
                let expected = 0.8 * slope[0] + 0.6 * slope[1];
                assert!((measured - expected).abs() < 1e-2 * (1.0 + rms / 1e-6), "{}", material.name());
            }
        }
    }
}
