//! The source of metamers.

use super::{Found, columns};
use crate::compare::{Asked, Comparison, all_like_the_first};
use crate::exact_brownian::ExactBrownian;
use asperity_pictures::metamer::{Method, PASSES};
use asperity_surface::raster::Raster;
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::{SolidCut, SolidNoise};

const SIDE: usize = 256;

/// Five surfaces by pairs, then metamers of all to the first, then the first against itself.
pub fn told_apart() -> Result<Found, String> {
    let mut maps = Vec::new();
    for hurst in [0.3, 0.7] {
        let [heights, _] = ExactBrownian::new(SIDE, hurst).pair(5);
        maps.push(whole(Raster { width: SIDE, height: SIDE, values: heights }));
    }
    for material in [SolidMaterial::Gravel, SolidMaterial::Wood, SolidMaterial::Sand] {
        let parameters = material.parameters();
        let noise = SolidNoise::new(parameters, 5).map_err(|error| error.to_string())?;
        let height = |x: usize, y: usize| {
            noise.definition(&parameters, SolidCut::SLANTED.at([x, y].map(|n| 1.5625e-4 * n as f64)))
        };
        maps.push(whole(Raster::from_fn(SIDE, SIDE, height)));
    }
    let comparison =
        Comparison { asked: Asked::Observer, strokes: 100, width_m: 0.04, relief_m: 0.002, seed: 1 };
    let at = |(_, error): (usize, asperity::files::FileError)| error.to_string();
    let originals = comparison.table(&maps, 0, || ()).map_err(at)?;
    let made = all_like_the_first(&maps, Method::Iterated(PASSES), |_| ())
        .map_err(|(_, error)| error.to_string())?;
    let matched = comparison.table(&made, 1, || ()).map_err(at)?;
    let sentence = format!(
        "Printed are shades of grey: two of five originals stand out and most pairs of metamers lie near 0.5. Ours: originals \
         {:.2}, metamers {:.2}, a surface against itself {:.2}; our five surfaces, made and not photographed, differ more from \
         each other than those of the source, whose natural textures people partly confuse.",
        originals.mean, matched.mean, matched.same
    );
    let rows = |table: &crate::compare::Table| table.rows.concat();
    let ours = columns([
        ("originals", rows(&originals)),
        ("metamers", rows(&matched)),
        ("originals_mean", vec![originals.mean]),
        ("metamers_mean", vec![matched.mean]),
        ("same_mean", vec![matched.same]),
    ]);
    let chance = columns([("metamers_mean", vec![0.5]), ("same_mean", vec![0.5])]);
    Ok((chance, ours, sentence))
}

/// Heights from 0 to 1.
fn whole(map: Raster) -> Raster {
    let (low, high) = map.range();
    map.map(|height| (height - low) / (high - low))
}
