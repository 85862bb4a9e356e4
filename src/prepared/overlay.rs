//! The micro-relief over a surface's own relief (Hasti §III-C): a tile of it, so that a lap comes back to the same
//! place.
//!
//! ```text
//! h(x) = cos(πw/2) n(x) + sin(πw/2) n(x − W)      x: place within the tile;  w: as in the texture's `tiled`
//! ```
//! Where the surface's own relief is at home, from its texels up, the noise is added below it only; where there is
//! none, all of it, whatever the map's resolution:
//!
//! ```text
//! n(x) = n_below(x) + c (n_all(x) − n_below(x))      c: 1 where the source has no relief, 0 from 2 rms on
//! ```
//! The noise never repeats by itself. Near the end of the tile it turns into that of its beginning, at constant
//! power: sine and cosine, because the two are unrelated.

use asperity_dsp::fractal_noise::{FractalNoise, LONGEST_CELL_M, NoisePath};
use asperity_texture::height_field::MAX_BLOCK;
use asperity_texture::tiled::{Place, TileAxis};
use std::f64::consts::FRAC_PI_2;

/// How a surface lays the noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Overlay {
    axes: [TileAxis; 2],
    /// The noise is added only below this wavelength, m.
    longest_m: f64,
}

/// The four copies of a tile that can meet in its corner: how many tiles back along u and v.
const COPIES: [[usize; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

impl Overlay {
    /// The overlay of a surface that is the same after `period_m`, ∞ for never.
    pub(crate) fn new(period_m: [f64; 2], longest_m: f64) -> Self {
        Self { axes: period_m.map(|length_m| TileAxis::new(length_m, LONGEST_CELL_M)), longest_m }
    }

    /// Adds the relief along a path to `height_m`; all slices are equally long, at most [`MAX_BLOCK`].
    /// `local_power_m2` is what relief the source really has at each sample.
    pub(crate) fn add(
        &self,
        field: &FractalNoise,
        path: &NoisePath<'_>,
        roughness: &[f64],
        rms_m: f64,
        local_power_m2: &[f64],
        height_m: &mut [f64],
    ) {
        let all = |power_m2: &f64| room(*power_m2, rms_m);
        if self.longest_m.is_infinite() || local_power_m2.iter().all(|power| all(power) == 1.0) {
            return self.add_below(field, path, roughness, (rms_m, f64::INFINITY), height_m);
        }
        if local_power_m2.iter().all(|power| all(power) == 0.0) {
            return self.add_below(field, path, roughness, (rms_m, self.longest_m), height_m);
        }
        let (mut below_m, mut all_m) = ([0.0; MAX_BLOCK], [0.0; MAX_BLOCK]);
        let n = height_m.len().min(MAX_BLOCK);
        self.add_below(field, path, roughness, (rms_m, self.longest_m), &mut below_m[..n]);
        self.add_below(field, path, roughness, (rms_m, f64::INFINITY), &mut all_m[..n]);
        for (i, height_m) in height_m.iter_mut().enumerate() {
            let share = all(&local_power_m2[i]);
            *height_m += (1.0 - share) * below_m[i] + share * all_m[i];
        }
    }

    /// Whether the source's own relief matters.
    pub(crate) fn minds_relief(&self) -> bool {
        self.longest_m.is_finite()
    }

    /// Adds the tile's noise below a wavelength.
    fn add_below(
        &self,
        field: &FractalNoise,
        path: &NoisePath<'_>,
        roughness: &[f64],
        (rms_m, longest_m): (f64, f64),
        height_m: &mut [f64],
    ) {
        let n = height_m.len().min(MAX_BLOCK);
        let mut places = [[Place::default(); 2]; MAX_BLOCK];
        let mut position_m = [[0.0; 2]; MAX_BLOCK];
        let mut meets = [false; 2];
        for (path_m, (places, position_m)) in
            path.position_m.iter().zip(places.iter_mut().zip(&mut position_m)).take(n)
        {
            *places = [self.axes[0].place(path_m[0]), self.axes[1].place(path_m[1])];
            *position_m = places.map(|place| place.at_m);
            meets = [meets[0] || places[0].weight > 0.0, meets[1] || places[1].weight > 0.0];
        }
        if meets == [false; 2] {
            let path = NoisePath { position_m: &position_m[..n], ..*path };
            return field.add(&path, roughness, rms_m, longest_m, height_m);
        }
        for copy in COPIES.into_iter().filter(|copy| (0..2).all(|axis| copy[axis] == 0 || meets[axis])) {
            for (position_m, places) in position_m[..n].iter_mut().zip(&places) {
                *position_m = [0, 1].map(|axis: usize| {
                    let back_m = if copy[axis] == 1 { self.axes[axis].length_m } else { 0.0 };
                    places[axis].at_m - back_m
                });
            }
            let mut part_m = [0.0; MAX_BLOCK];
            let path = NoisePath { position_m: &position_m[..n], ..*path };
            field.add(&path, roughness, rms_m, longest_m, &mut part_m[..n]);
            for ((height_m, part_m), places) in height_m.iter_mut().zip(&part_m).zip(&places) {
                *height_m += gain(places, copy) * part_m;
            }
        }
    }
}

/// Share of the noise's long waves that there is room for beside a source's own relief.
fn room(power_m2: f64, rms_m: f64) -> f64 {
    let room = (1.0 - power_m2 / (4.0 * rms_m * rms_m)).clamp(0.0, 1.0);
    room * room * (3.0 - 2.0 * room)
}

/// Gain of one copy.
fn gain(places: &[Place; 2], copy: [usize; 2]) -> f64 {
    let along = |axis: usize| match (copy[axis], places[axis].weight) {
        (0, 0.0) => 1.0,
        (0, weight) => (FRAC_PI_2 * weight).cos(),
        (_, weight) => (FRAC_PI_2 * weight).sin(),
    };
    along(0) * along(1)
}
