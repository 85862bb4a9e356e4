//! The noise of N samples side by side.

use super::cells::{Bounds, Cells, KnownCell, NEAR, cells, near_cells};
use super::gains::{footprint_weight, polynomial};
use super::rough::{Even, Rough};
use super::{
    FractalNoise, LONGEST_CELL_M, NoisePath, OCTAVES, Octave, OctaveWeights, ROTATION_RAD, ROTATIONS,
};
use crate::gradient_noise_2d::{gradient_noise, gradient_noise_in};
use crate::simd::fearless_simd::prelude::*;
use crate::simd::{Eight, Set, Sixteen, Vector};

/// Positions are kept within ± this many metres, where fixed point keeps their order.
const FARTHEST_M: f64 = 1e7;

/// An octave is slow if its cells are so many times as long as the way of the samples side by side.
/// In faster ones the samples are too often in different cells for a search to pay.
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

/// Memory that is filled anew for every N samples.
struct Room<const N: usize, V: Vector<N>> {
    lattices: [Lattice<V::Word>; ROTATIONS],
    /// Share that is left of the finest octaves.
    fades: [V::Single; OCTAVES],
    /// Gains of the octaves where the roughness is not one for all.
    gains: [V::Single; OCTAVES],
}

impl<const N: usize, V: Vector<N>> Room<N, V> {
    #[inline(always)]
    fn new(v: V) -> Self {
        let nowhere = Lattice { cells: [Cells::at(v.splat_word(0)); 2], bounds: [0.0; 4] };
        let none = [v.splat(0.0); OCTAVES];
        Self { lattices: [nowhere; ROTATIONS], fades: none, gains: none }
    }
}

/// N samples of a path in the form the octaves need, beside what is in their [`Room`].
struct Lanes<const N: usize, V: Vector<N>> {
    v: V,
    /// Number of octaves, from the coarsest, that have cells much longer than all samples together.
    slow: usize,
    samples_per_metre: V::Single,
    shortest_footprint_m: f32,
    longest_footprint_m: f32,
}

impl<const N: usize, V: Vector<N>> Lanes<N, V> {
    #[inline(always)]
    fn new(
        v: V,
        noise: &FractalNoise,
        position_m: &[[f64; 2]; N],
        footprint_m: &[f64; N],
        lattices: &mut [Lattice<V::Word>; ROTATIONS],
    ) -> Self {
        let [x, y] = v.load_points(position_m);
        let (x, y) = (within_reach(v, x), within_reach(v, y));
        for (lattice, rotation) in lattices.iter_mut().zip(&noise.rotations) {
            let [first, second] = turned(v, [x, y], rotation);
            lattice.bounds = v.bounds(first, second);
            lattice.cells = [near_cells(v, first), near_cells(v, second)];
        }
        if !v.all_reach(&lattices[0].bounds, &[-NEAR; 4]) {
            // A rare case: the fewer instructions the better.
            let rotations = lattices.iter_mut().zip(&noise.rotations).take(core::hint::black_box(ROTATIONS));
            for (lattice, rotation) in rotations {
                let [first, second] = turned(v, [x, y], rotation);
                lattice.cells = [cells(v, first), cells(v, second)];
            }
        }
        // Backwards or not a number is standing still.
        let footprint = v.max(v.load(footprint_m), v.splat(0.0));
        let (shortest_footprint_m, longest_footprint_m) = v.extremes(footprint);
        Self {
            v,
            slow: slow_octaves(noise, way_m(position_m)),
            samples_per_metre: v.splat(1.0) / (footprint + v.splat(f32::MIN_POSITIVE)),
            shortest_footprint_m,
            longest_footprint_m,
        }
    }

    /// Fate of the finest octaves: those from `alive` on are gone, those from `steady` on fade, or
    /// the finest stands in for finer ones; coarser ones are whole.
    #[inline(always)]
    fn fades(
        &self,
        noise: &FractalNoise,
        tail_boost: V::Single,
        fades: &mut [V::Single; OCTAVES],
    ) -> (usize, usize) {
        let v = self.v;
        let one = v.splat(1.0);
        let mut finer = v.splat(0.0); // footprint weight of the next finer octave
        let (mut alive, mut steady) = (OCTAVES, OCTAVES);
        let mut all_finer = false; // … is exactly 1 everywhere
        for (octave, fade) in noise.octaves.iter().zip(fades).rev() {
            let whole = octave.cell_m >= WHOLE * self.longest_footprint_m;
            if whole && all_finer {
                break;
            }
            steady -= 1;
            if octave.cell_m <= GONE * self.shortest_footprint_m {
                alive = steady;
            }
            let mut weight = one;
            if !whole {
                weight = footprint_weight(v, v.splat(octave.cell_m) * self.samples_per_metre);
            }
            *fade = weight * (one + tail_boost * (one - finer));
            finer = weight;
            all_finer = whole;
        }
        (alive, steady)
    }

    /// Sums of all octaves, from the finest to the coarsest of each set of weights; every octave is
    /// worked out once for all sets.
    #[inline(always)]
    fn sums<const W: usize>(
        &self,
        noise: &FractalNoise,
        (rough, even): (&Rough<V::Single>, &Even<W>),
        sets: &[&OctaveWeights; W],
        (last, room): (&mut [KnownCell; OCTAVES], &mut Room<N, V>),
    ) -> [V::Single; W] {
        let v = self.v;
        let Room { lattices, fades, gains } = room;
        let (alive, steady) = self.fades(noise, rough.gains.tail_boost, fades);
        // Octaves below this one have a plain number for each set.
        let plain = if rough.even { steady } else { 0 };
        if !rough.even {
            let mut gain = rough.gains.finest;
            for gains in gains.iter_mut().rev() {
                *gains = gain;
                gain = gain * rough.gains.coarser;
            }
        }
        let mut sums = [v.splat(0.0); W];
        let (mut coarsest, mut end) = ([OCTAVES; W], OCTAVES);
        let mut present = 0;
        for (coarsest, set) in coarsest.iter_mut().zip(sets) {
            *coarsest = set.coarsest;
            end = end.min(set.coarsest);
            present |= set.present;
        }
        for i in (end..alive).rev() {
            if present >> i & 1 == 0 {
                continue;
            }
            let octave = &noise.octaves[i];
            let lattice = &lattices[octave.rotation as usize];
            let value = self.octave(octave, lattice, i < self.slow, &mut last[i]);
            for (w, sum) in sums.iter_mut().enumerate() {
                if W > 1 && i < coarsest[w] {
                    continue;
                }
                let mut scale = v.splat(even.scales[w][i]);
                if i >= plain {
                    let (mut gain, mut weight) = (v.splat(even.gains[i]), v.splat(even.weights[w][i]));
                    if !rough.even {
                        (gain, weight) = (gains[i], polynomial(v, rough.lanes, &sets[w].of[i]));
                    }
                    if i >= steady {
                        weight = weight * fades[i];
                    }
                    scale = gain * weight;
                }
                *sum = *sum + scale * value;
            }
        }
        sums
    }

    /// One octave at every sample. Where its cells are long, nothing is hashed while all samples
    /// are in the cell that was last found; the bits are the same.
    #[inline(always)]
    fn octave(
        &self,
        octave: &Octave,
        lattice: &Lattice<V::Word>,
        slow: bool,
        last: &mut KnownCell,
    ) -> V::Single {
        let v = self.v;
        let (i, offset) = (octave.index, &octave.offset);
        let Lattice { cells: [x, y], bounds } = lattice;
        let from_centre = [x.place(v, i, offset[0]), y.place(v, i, offset[1])];
        if slow && (last.contains(v, bounds) || last.follow(octave, [x.last(v), y.last(v)], bounds)) {
            return gradient_noise_in(v, &last.corners, from_centre);
        }
        let column = x.index(v, i, offset[0], from_centre[0]);
        let row = y.index(v, i, offset[1], from_centre[1]);
        gradient_noise(v, [column, row], octave.key, from_centre)
    }
}

/// About how far it is from the first to the last sample.
#[inline(always)]
fn way_m<const N: usize>(position_m: &[[f64; 2]; N]) -> f32 {
    let ([x, y], [u, v]) = (position_m[0], position_m[N - 1]);
    ((u - x).abs() + (v - y).abs()) as f32
}

/// Number of octaves, from the coarsest, that have cells so long that samples along this way are
/// mostly in one.
#[inline(always)]
fn slow_octaves(noise: &FractalNoise, way_m: f32) -> usize {
    let mut slow = OCTAVES;
    while slow > 0 && noise.octaves[slow - 1].cell_m < SLOW * way_m {
        slow -= 1;
    }
    slow
}

/// Places along the axes of a lattice, cells of the coarsest octave.
#[inline(always)]
fn turned<const N: usize, V: Vector<N>>(v: V, [x, y]: [V::Double; 2], rotation: &[f64; 2]) -> [V::Double; 2] {
    let (cosine, sine) = (v.splat_double(rotation[0]), v.splat_double(rotation[1]));
    [
        v.sub_double(v.mul_double(cosine, x), v.mul_double(sine, y)),
        v.add_double(v.mul_double(sine, x), v.mul_double(cosine, y)),
    ]
}

/// The nearest number within [`FARTHEST_M`], for a NaN its lower end.
#[inline(always)]
fn within_reach<const N: usize, V: Vector<N>>(v: V, x: V::Double) -> V::Double {
    v.min_double(v.max_double(x, v.splat_double(-FARTHEST_M)), v.splat_double(FARTHEST_M))
}

/// [`add`] on a set of instructions: sixteen samples at a time where its vectors hold eight or
/// more, so that what a known cell and an octave say is spread over the lanes once for two of them.
#[inline(always)]
pub(super) fn add_on<const W: usize, S: Set>(
    s: S,
    noise: &FractalNoise,
    path: &NoisePath<'_>,
    roughness: &[f64],
    sets: &[&OctaveWeights; W],
    heights_m: &mut [&mut [f64]; W],
    known: &mut [KnownCell; OCTAVES],
) {
    if S::f32s::LEN >= 8 {
        add::<16, W, _>(Sixteen(s), noise, path, roughness, sets, heights_m, known);
    } else {
        add::<8, W, _>(Eight(s), noise, path, roughness, sets, heights_m, known);
    }
}

/// Adds the noise along a path to the heights of each set of weights, N samples at a time.
#[inline(always)]
fn add<const N: usize, const W: usize, V: Vector<N>>(
    v: V,
    noise: &FractalNoise,
    path: &NoisePath<'_>,
    roughness: &[f64],
    sets: &[&OctaveWeights; W],
    heights_m: &mut [&mut [f64]; W],
    known: &mut [KnownCell; OCTAVES],
) {
    let n = heights_m.iter().map(|heights_m| heights_m.len()).fold(path.position_m.len(), usize::min);
    let (positions, footprints) = (path.position_m.as_chunks().0, path.footprint_m.as_chunks().0);
    let roughnesses = roughness.as_chunks().0;
    let whole = positions.len().min(footprints.len()).min(roughnesses.len());
    let (positions, footprints, roughnesses) =
        (&positions[..whole], &footprints[..whole], &roughnesses[..whole]);
    let mut left = Left { position_m: [[0.0; 2]; N], footprint_m: [0.0; N], roughness: [0.0; N] };
    let mut even = Even::UNKNOWN;
    let mut room = Room::new(v);
    for chunk in 0..n.div_ceil(N) {
        let (position_m, footprint_m, roughness) = if chunk < whole {
            (&positions[chunk], &footprints[chunk], &roughnesses[chunk])
        } else {
            left.fill(path, roughness, chunk * N);
            (&left.position_m, &left.footprint_m, &left.roughness)
        };
        let rough = Rough::new(v, sets, roughness, &mut even);
        let lanes = Lanes::new(v, noise, position_m, footprint_m, &mut room.lattices);
        let sums = lanes.sums(noise, (&rough, &even), sets, (known, &mut room));
        for (sum, heights_m) in sums.into_iter().zip(heights_m.iter_mut()) {
            let heights_m = heights_m.get_mut(chunk * N..).unwrap_or_default();
            if let Some(heights_m) = heights_m.first_chunk_mut() {
                v.add_to(sum, heights_m);
                continue;
            }
            let mut out = padded(heights_m, 0, 0.0);
            v.add_to(sum, &mut out);
            for (height, out) in heights_m.iter_mut().zip(out) {
                *height = out;
            }
        }
    }
}

/// The last samples of a path, fewer than a vector holds.
struct Left<const N: usize> {
    position_m: [[f64; 2]; N],
    footprint_m: [f64; N],
    roughness: [f64; N],
}

impl<const N: usize> Left<N> {
    #[cold]
    fn fill(&mut self, path: &NoisePath<'_>, roughness: &[f64], start: usize) {
        self.position_m = padded(path.position_m, start, self.position_m[0]);
        self.footprint_m = padded(path.footprint_m, start, self.footprint_m[0]);
        self.roughness = padded(roughness, start, self.roughness[0]);
    }
}

/// The values from `start` on, and after fewer than N the last of them again and again: spare lanes
/// make no work of their own.
#[inline(always)]
fn padded<T: Copy, const N: usize>(values: &[T], start: usize, none: T) -> [T; N] {
    let values = values.get(start..).unwrap_or_default();
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
