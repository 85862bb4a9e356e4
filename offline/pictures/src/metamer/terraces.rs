//! Terraces: surfaces of a few heights, whose texels move by a whole step or not at all, and the
//! smooth ground under them.
//!
//! ```text
//! z ← min(max(B_h z, l), u)        h = half the shorter side/8, … , 4, 2, 1 texels
//! ```
//! | symbol | here |
//! |---|---|
//! | z | the ground, at first the terraces themselves |
//! | B_h | three running means of 2h + 1 texels along each side |
//! | l, u | half-way to the next heights below and above the texel's own |
//!
//! Cut to the heights again the ground is the terraces, but for texels half-way between two. It has
//! slopes, which passes turn little by little, where of large plateaus a texel moves by a whole
//! step or not at all, so that an original's many small islands stay.

use asperity_surface::raster::Raster;
use asperity_surface::wrap::Wrap;

/// Most heights of terraces; a surface of more has slopes. Source: ours.
const MOST_HEIGHTS: usize = 64;
/// The shorter side over the first h.
const FIRST: usize = 8;
/// Number of times that each h smooths.
const EACH: usize = 3;

/// The different heights of a surface from low to high, if they are 2 to [`MOST_HEIGHTS`].
pub(super) fn heights_of_terraces(surface: &Raster) -> Option<Vec<f64>> {
    let mut heights: Vec<f64> = Vec::new();
    for &height in &surface.values {
        let at = heights.partition_point(|known| *known < height);
        if heights.get(at).is_none_or(|known| *known > height) {
            if heights.len() == MOST_HEIGHTS {
                return None;
            }
            heights.insert(at, height);
        }
    }
    (heights.len() > 1).then_some(heights)
}

/// The ground under a surface of a few heights; `None` where there are more, or one.
pub(super) fn ground_under(terraces: &Raster, wrap: Wrap) -> Option<Raster> {
    let heights = heights_of_terraces(terraces)?;
    let (first, last) = (*heights.first()?, *heights.last()?);
    let halves: Vec<f64> = heights.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let (lowest, highest) = (2.0 * first - halves.first()?, 2.0 * last - halves.last()?);
    let bounds = |height: f64| {
        let step = halves.partition_point(|half| *half <= height);
        let below = step.checked_sub(1).and_then(|step| halves.get(step));
        [below.copied().unwrap_or(lowest), halves.get(step).copied().unwrap_or(highest)]
    };
    let mut ground = terraces.clone();
    let mut half = terraces.width.min(terraces.height) / FIRST;
    while half > 0 {
        for _ in 0..EACH {
            smooth(&mut ground, half, wrap);
            for (z, &height) in ground.values.iter_mut().zip(&terraces.values) {
                let [low, high] = bounds(height);
                *z = z.clamp(low, high);
            }
        }
        half /= 2;
    }
    Some(ground)
}

/// Three running means along each side.
fn smooth(ground: &mut Raster, half: usize, wrap: Wrap) {
    for _ in 0..2 {
        let mut row = vec![0.0; ground.width];
        for values in ground.values.chunks_exact_mut(ground.width) {
            for _ in 0..3 {
                row.copy_from_slice(values);
                running_mean(&row, values, half, wrap);
            }
        }
        *ground = ground.transposed();
    }
}

fn running_mean(from: &[f64], to: &mut [f64], half: usize, wrap: Wrap) {
    let at = |i: i64| from[wrap.index(i, from.len())];
    let half = half as i64;
    let share = 1.0 / (2 * half + 1) as f64;
    let mut sum: f64 = (-half..=half).map(at).sum();
    for (i, to) in (0..).zip(to) {
        *to = share * sum;
        sum += at(i + half + 1) - at(i - half);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn few_heights_are_terraces_and_slopes_and_flats_are_none() {
        let of = |heights: usize| Raster::from_fn(32, 32, |x, y| ((x * 32 + y) % heights) as f64);
        for heights in [2, 3, 64] {
            assert_eq!(heights_of_terraces(&of(heights)).unwrap().len(), heights);
        }
        for heights in [1, 65, 1024] {
            assert_eq!(heights_of_terraces(&of(heights)), None);
            assert_eq!(ground_under(&of(heights), Wrap::Clamp), None);
        }
    }

    #[test]
    fn the_ground_is_smooth_and_within_half_a_step_of_its_terraces() {
        let wave = Raster::from_fn(96, 64, |x, y| {
            (TAU * x as f64 / 96.0).sin() + (TAU * (y as f64 / 64.0 + 0.1)).cos()
        });
        let cut = |z: &Raster| z.map(|z| (2.0 * z).round() / 2.0);
        let terraces = cut(&wave);
        let off = |z: &Raster| {
            let squares = z.values.iter().zip(&wave.values).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>() / z.values.len() as f64
        };
        let steepest = |z: &Raster| {
            let steps = z
                .values
                .chunks_exact(96)
                .flat_map(|row| row.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
            steps.fold(0.0, f64::max)
        };
        for wrap in [Wrap::Repeat, Wrap::Clamp] {
            let ground = ground_under(&terraces, wrap).unwrap();
            assert!(off(&ground) < off(&terraces));
            let (made, before) = (steepest(&ground), steepest(&terraces));
            assert!(made < 0.8 * before, "{wrap:?}: {made} of {before}");
            let farthest = ground.values.iter().zip(&terraces.values).map(|(a, b)| (a - b).abs());
            assert!(farthest.fold(0.0, f64::max) < 0.25 + 1e-12, "half a step");
        }
    }
}
