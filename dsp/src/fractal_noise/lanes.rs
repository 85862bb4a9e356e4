//! The noise of N samples side by side.

use super::cells::{Bounds, Cells, KnownCell, cells};
use super::gains::{Gains, footprint_weight, gains, polynomial, within_0_1};
use super::{
    FractalNoise, LONGEST_CELL_M, NoisePath, OCTAVES, Octave, OctaveWeights, ROTATION_RAD, ROTATIONS,
};
use crate::gradient_noise_2d::{Corners, corners, gradient_noise};
use crate::simd::Vector;

/// Positions are kept within ± this many metres, where fixed point keeps their order.
const FARTHEST_M: f64 = 1e7;

/// An octave is slow if its cells are so many times as long as the way of the samples side by side. In
/// faster ones the samples are too often in different cells for a search to pay.
const SLOW: f32 = 2.5;

/// Samples a cell at which an octave's weight is surely 0 everywhere, and 1, whatever the rounding.
const GONE: f32 = 1.999;
const WHOLE: f32 = 4.001;

/// Positions on the lattices of one orientation, in cells of the coarsest octave.
#[derive(Clone, Copy)]
struct Lattice<W> {
    cells: [Cells<W>; 2],
    bounds: Bounds,
}

/// What the roughness of N samples says, kept until it is another.
#[derive(Clone, Copy)]
struct Rough<F, const W: usize> {
    roughness: F,
    gains: Gains<F>,
    /// Weights of the octaves, by set.
    weights: [[F; OCTAVES]; W],
}

impl<F: Copy, const W: usize> Rough<F, W> {
    /// Plain loops: what goes through `map` is compiled without the instruction set, a call for each operation.
    #[inline(always)]
    fn new<const N: usize, V: Vector<N, Single = F>>(v: V, sets: &[&OctaveWeights; W], roughness: F) -> Self {
        let within = within_0_1(v, roughness);
        let mut weights = [[v.splat(0.0); OCTAVES]; W];
        for (weights, set) in weights.iter_mut().zip(sets) {
            for (weight, c) in weights.iter_mut().zip(&set.of) {
                *weight = polynomial(v, within, c);
            }
        }
        Self { roughness, gains: gains(v, roughness), weights }
    }
}

/// N samples of a path in the form the octaves need.
struct Lanes<const N: usize, V: Vector<N>> {
    v: V,
    lattices: [Lattice<V::Word>; ROTATIONS],
    /// So many octaves, from the coarsest, have cells much longer than all samples together.
    slow: usize,
    gains: Gains<V::Single>,
    samples_per_metre: V::Single,
    shortest_footprint_m: f32,
    longest_footprint_m: f32,
}

impl<const N: usize, V: Vector<N>> Lanes<N, V> {
    #[inline(always)]
    fn new<const W: usize>(
        v: V,
        noise: &FractalNoise,
        position_m: &[[f64; 2]; N],
        footprint_m: &[f64; N],
        roughness: &[f64; N],
        sets: &[&OctaveWeights; W],
        rough: &mut Rough<V::Single, W>,
    ) -> Self {
        let [x, y] = v.load_points(position_m);
        let (x, y) = (within_reach(v, x), within_reach(v, y));
        let mut lattices = [Lattice { cells: [cells(v, x); 2], bounds: [0.0; 4] }; ROTATIONS];
        for (lattice, [cosine, sine]) in lattices.iter_mut().zip(noise.rotations) {
            let (cosine, sine) = (v.splat_double(cosine), v.splat_double(sine));
            let first = v.sub_double(v.mul_double(cosine, x), v.mul_double(sine, y));
            let second = v.add_double(v.mul_double(sine, x), v.mul_double(cosine, y));
            lattice.cells = [cells(v, first), cells(v, second)];
            lattice.bounds = v.bounds(first, second);
        }
        // Backwards or not a number is standing still.
        let footprint = v.max(v.load(footprint_m), v.splat(0.0));
        let (shortest_footprint_m, longest_footprint_m) = v.extremes(footprint);
        let roughness = v.load(roughness);
        if !v.equal(roughness, rough.roughness) {
            *rough = Rough::new(v, sets, roughness);
        }
        let slow = slow_octaves(noise, way_m(position_m));
        Self {
            v,
            lattices,
            slow,
            gains: rough.gains,
            samples_per_metre: v.div(v.splat(1.0), v.add(footprint, v.splat(f32::MIN_POSITIVE))),
            shortest_footprint_m,
            longest_footprint_m,
        }
    }

    /// Sums of all octaves, from the finest to the coarsest of each set of weights; every octave is worked out once for all sets.
    #[inline(always)]
    fn sums<const W: usize>(
        &self,
        noise: &FractalNoise,
        weights: &[[V::Single; OCTAVES]; W],
        coarsest: &[usize; W],
        last: &mut [KnownCell; OCTAVES],
    ) -> [V::Single; W] {
        let v = self.v;
        let one = v.splat(1.0);
        let mut sums = [v.splat(0.0); W];
        let mut end = OCTAVES;
        for coarsest in coarsest {
            end = end.min(*coarsest);
        }
        let mut gain = self.gains.finest;
        let mut finer = v.splat(0.0); // footprint weight of the next finer octave
        let mut all_finer = false; // … is exactly 1 everywhere
        let mut i = OCTAVES;
        // The finest octaves: some fade, one stands in for finer ones, cells change every few samples.
        while i > end {
            let cell_m = noise.octaves[i - 1].cell_m;
            let whole = cell_m >= WHOLE * self.longest_footprint_m;
            if whole && all_finer && i <= self.slow {
                break;
            }
            i -= 1;
            let gone = cell_m <= GONE * self.shortest_footprint_m;
            let mut weight = one;
            if !whole {
                weight = footprint_weight(v, v.mul(v.splat(cell_m), self.samples_per_metre));
            }
            if !gone {
                let fades = !(whole && all_finer);
                let mut fade = one;
                if fades {
                    let boost = v.add(one, v.mul(self.gains.tail_boost, v.sub(one, finer)));
                    fade = v.mul(weight, boost);
                }
                let value = if i < self.slow {
                    self.slow_octave(noise, i, &mut last[i])
                } else {
                    self.octave(noise, i)
                };
                for ((sum, weights), coarsest) in sums.iter_mut().zip(weights).zip(coarsest) {
                    if i >= *coarsest {
                        let scale = if fades { v.mul(weights[i], fade) } else { weights[i] };
                        *sum = v.add(*sum, v.mul(v.mul(gain, scale), value));
                    }
                }
            }
            gain = v.mul(gain, self.gains.coarser);
            finer = weight;
            all_finer = whole;
        }
        while i > end {
            i -= 1;
            let value = self.slow_octave(noise, i, &mut last[i]);
            for ((sum, weights), coarsest) in sums.iter_mut().zip(weights).zip(coarsest) {
                if i >= *coarsest {
                    *sum = v.add(*sum, v.mul(v.mul(gain, weights[i]), value));
                }
            }
            gain = v.mul(gain, self.gains.coarser);
        }
        sums
    }

    /// One octave at every sample.
    #[inline(always)]
    fn octave(&self, noise: &FractalNoise, i: usize) -> V::Single {
        let from_centre = self.places(noise, i);
        gradient_noise(self.v, &self.corners(noise, i, from_centre), from_centre)
    }

    /// The same bits for an octave whose cells are long: while all samples are in the cell that was last
    /// found, nothing is hashed.
    #[inline(always)]
    fn slow_octave(&self, noise: &FractalNoise, i: usize, last: &mut KnownCell) -> V::Single {
        let v = self.v;
        let lattice = &self.lattices[noise.octaves[i].rotation as usize];
        let from_centre = self.places(noise, i);
        if last.contains(v, &lattice.bounds) {
            return gradient_noise(v, &last.corners(v), from_centre);
        }
        let corners = self.corners(noise, i, from_centre);
        last.follow(v, i as u32, &lattice.cells, from_centre, &corners);
        gradient_noise(v, &corners, from_centre)
    }

    /// Places in the cells of an octave, by axis.
    #[inline(always)]
    fn places(&self, noise: &FractalNoise, i: usize) -> [V::Word; 2] {
        let [x, y] = &self.lattices[noise.octaves[i].rotation as usize].cells;
        let Octave { offset, index, .. } = noise.octaves[i];
        [x.place(self.v, index, offset[0]), y.place(self.v, index, offset[1])]
    }

    /// The gradients about those places.
    #[inline(always)]
    fn corners(&self, noise: &FractalNoise, i: usize, from_centre: [V::Word; 2]) -> Corners<V::Word> {
        let v = self.v;
        let [x, y] = &self.lattices[noise.octaves[i].rotation as usize].cells;
        let Octave { offset, key, .. } = noise.octaves[i];
        let column = x.index(v, i as u32, offset[0], from_centre[0]);
        let row = y.index(v, i as u32, offset[1], from_centre[1]);
        corners(v, column, row, key)
    }
}

/// About how far it is from the first to the last sample.
#[inline(always)]
fn way_m<const N: usize>(position_m: &[[f64; 2]; N]) -> f32 {
    let ([x, y], [u, v]) = (position_m[0], position_m[N - 1]);
    ((u - x).abs() + (v - y).abs()) as f32
}

/// How many octaves, from the coarsest, have cells so long that samples along this way are mostly in one.
#[inline(always)]
fn slow_octaves(noise: &FractalNoise, way_m: f32) -> usize {
    let mut slow = OCTAVES;
    while slow > 0 && noise.octaves[slow - 1].cell_m < SLOW * way_m {
        slow -= 1;
    }
    slow
}

/// The nearest number within [`FARTHEST_M`], for a NaN its lower end.
#[inline(always)]
fn within_reach<const N: usize, V: Vector<N>>(v: V, x: V::Double) -> V::Double {
    v.min_double(v.max_double(x, v.splat_double(-FARTHEST_M)), v.splat_double(FARTHEST_M))
}

/// Adds the noise along a path to the heights of each set of weights, N samples at a time.
#[inline(always)]
pub(super) fn add<const N: usize, const W: usize, V: Vector<N>>(
    v: V,
    noise: &FractalNoise,
    path: &NoisePath<'_>,
    roughness: &[f64],
    sets: &[&OctaveWeights; W],
    heights_m: &mut [&mut [f64]; W],
    known: &mut [KnownCell; OCTAVES],
) {
    let n = heights_m.iter().map(|heights_m| heights_m.len()).fold(path.position_m.len(), usize::min);
    if n == 0 {
        return;
    }
    let (mut positions_left, mut footprints_left, mut roughness_left) = ([[0.0; 2]; N], [0.0; N], [0.0; N]);
    let mut coarsest = [OCTAVES; W];
    for (coarsest, weights) in coarsest.iter_mut().zip(sets) {
        *coarsest = weights.coarsest;
    }
    let mut rough = Rough::new(v, sets, v.load(from(roughness, 0, &mut roughness_left)));
    let mut start = 0;
    while start < n {
        let position_m = from(path.position_m, start, &mut positions_left);
        let footprint_m = from(path.footprint_m, start, &mut footprints_left);
        let roughness = from(roughness, start, &mut roughness_left);
        let lanes = Lanes::new(v, noise, position_m, footprint_m, roughness, sets, &mut rough);
        let sums = lanes.sums(noise, &rough.weights, &coarsest, known);
        for (sum, heights_m) in sums.into_iter().zip(heights_m.iter_mut()) {
            let heights_m = heights_m.get_mut(start..).unwrap_or_default();
            if let Some(heights_m) = heights_m.first_chunk_mut() {
                v.add_to(sum, heights_m);
                continue;
            }
            let mut out = padded(heights_m, 0.0);
            v.add_to(sum, &mut out);
            for (height, out) in heights_m.iter_mut().zip(out) {
                *height = out;
            }
        }
        start += N;
    }
}

/// N values from `start` on; where fewer are left, in `left`, [`padded`].
#[inline(always)]
fn from<'a, T: Copy, const N: usize>(values: &'a [T], start: usize, left: &'a mut [T; N]) -> &'a [T; N] {
    let values = values.get(start..).unwrap_or_default();
    match values.first_chunk() {
        Some(chunk) => chunk,
        None => {
            *left = padded(values, left[0]);
            left
        }
    }
}

/// Fewer than N values, and the last of them again and again: spare lanes make no work of their own.
#[inline(always)]
fn padded<T: Copy, const N: usize>(values: &[T], none: T) -> [T; N] {
    let mut out = [values.last().copied().unwrap_or(none); N];
    for (out, value) in out.iter_mut().zip(values) {
        *out = *value;
    }
    out
}

/// Cosine and sine of each orientation, per metre in cells of the coarsest octave.
pub(super) fn rotations() -> [[f64; 2]; ROTATIONS] {
    ROTATION_RAD.map(|angle| [libm::cos(angle) / LONGEST_CELL_M, libm::sin(angle) / LONGEST_CELL_M])
}
