//! The seven solid-noise materials are told apart by what the finger feels: nearest centroid over
//! third-octave spectra of the haptic channel, on strokes that were not used for the centroids. The
//! example `seven_materials_blind` asks about many more strokes and pieces.

#[path = "common/materials.rs"]
mod materials;

use asperity::surface::solid_materials::SolidMaterial;
use asperity_dsp::rng::Rng;

const STROKES: usize = 10;

#[test]
fn held_out_strokes_are_named_by_their_nearest_centroid() {
    let mut rng = Rng::new(11);
    let centroids = materials::centroids(STROKES, 1, &mut rng);
    let confusions = materials::confusions(&centroids, STROKES, 1, &mut rng);
    for (row, material) in confusions.iter().zip(SolidMaterial::SEVEN) {
        println!("{:>12} {row:?}", material.name());
    }
    let share = materials::score(&confusions);
    assert!(share >= 0.95, "{share}");
}
