//! Comparison: how often strokes on each of several surfaces are put on the right one, as a table.

use crate::abx::{self, Size};
use crate::likeness;
use asperity::files::FileError;
use asperity_pictures::borders::Borders;
use asperity_pictures::metamer::{MetamerOptions, Method, metamer};
use asperity_surface::raster::Raster;
use serde::Serialize;

/// Fewest and most strokes on a surface.
pub const STROKES: [usize; 2] = [20, 10_000];

/// Judge of strokes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Asked {
    /// A linear discriminant that misses next to nothing ([`abx`]).
    Machine,
    /// The observer with people's thresholds and difference limens ([`likeness`]).
    Observer,
}

/// Strokes over the surfaces.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// Judge of the strokes.
    pub asked: Asked,
    /// Strokes on each surface.
    pub strokes: usize,
    /// Width of a map on the surface, m.
    pub width_m: f64,
    /// Height of 1 over 0, m.
    pub relief_m: f64,
    /// Seed of the strokes.
    pub seed: u64,
}

/// Share of right answers for every pair; the diagonal is a surface against itself, stroked again.
#[derive(Debug, Clone, Serialize)]
pub struct Table {
    /// A row a surface, a column a surface: 0.5 is chance, 1 is certain.
    pub rows: Vec<Vec<f64>>,
    /// Mean over the pairs of different surfaces.
    pub mean: f64,
    /// Mean over the pairs of the first surface, which metamers are made like, and another one:
    /// what counts for them, and what the mean over all pairs hides.
    pub reference: f64,
    /// Mean of the diagonal: chance, if the judge is honest.
    pub same: f64,
}

impl Comparison {
    /// The table of maps (heights 0–1); `set` tells sets of maps apart that share a seed.
    /// `progress` is called after each map.
    ///
    /// # Errors
    /// The place of the map that the engine refuses, and why.
    pub fn table(
        &self,
        maps: &[Raster],
        set: u64,
        progress: impl FnMut(),
    ) -> Result<Table, (usize, FileError)> {
        match self.asked {
            Asked::Machine => self.told_by(maps, set, abx::strokes, abx::right_answers, progress),
            Asked::Observer => self.told_by(maps, set, likeness::percepts, likeness::right_answers, progress),
        }
    }

    /// The table by one judge: what it learnt of strokes, and its share of right answers.
    fn told_by<T>(
        &self,
        maps: &[Raster],
        set: u64,
        known: impl Fn(&Raster, bool, Size, usize, u64) -> Result<Vec<T>, FileError>,
        right_answers: impl Fn(&[T], &[T]) -> f64,
        mut progress: impl FnMut(),
    ) -> Result<Table, (usize, FileError)> {
        let mut felt: Vec<Vec<T>> = Vec::new();
        for (index, map) in maps.iter().enumerate() {
            let size = Size { texel_m: self.width_m / map.width as f64, relief_m: self.relief_m };
            let tiles = Borders::Detect.decide(map) == Borders::Periodic;
            let seed = self.seed.wrapping_mul(1000).wrapping_add(set * 100 + index as u64);
            // Twice as many: the second half is the same surface stroked again.
            felt.push(known(map, tiles, size, 2 * self.strokes, seed).map_err(|error| (index, error))?);
            progress();
        }
        let n = self.strokes;
        let cell = |i: usize, j: usize| {
            let other = if i == j { &felt[j][n..] } else { &felt[j][..n] };
            right_answers(&felt[i][..n], other)
        };
        let size = maps.len();
        let rows: Vec<Vec<f64>> = (0..size).map(|i| (0..size).map(|j| cell(i, j)).collect()).collect();
        let all: f64 = rows.iter().flatten().sum();
        let same: f64 = (0..size).map(|i| rows[i][i]).sum();
        let pairs = (size * size.saturating_sub(1)).max(1) as f64;
        let reference = rows[0][1..].iter().sum::<f64>() / size.saturating_sub(1).max(1) as f64;
        Ok(Table { rows, mean: (all - same) / pairs, reference, same: same / size as f64 })
    }
}

/// The first map and the others made to feel like it. `progress` gets the part done.
///
/// # Errors
/// The place of the map that is refused, and why.
pub fn all_like_the_first(
    maps: &[Raster],
    method: Method,
    mut progress: impl FnMut(f64),
) -> Result<Vec<Raster>, (usize, asperity_dsp::DesignError)> {
    let mut all = vec![maps[0].clone()];
    for (index, map) in maps.iter().enumerate().skip(1) {
        // Every map is spread over the same width, so that texels may differ in size.
        let scale = maps[0].width as f64 / map.width as f64;
        let settings = MetamerOptions { method, scale, ..MetamerOptions::default() };
        let made = metamer(map, &maps[0], &settings, |done| {
            progress((index as f64 - 1.0 + done) / (maps.len() - 1) as f64);
        })
        .map_err(|error| (index, error))?;
        all.push(made.image);
    }
    Ok(all)
}
