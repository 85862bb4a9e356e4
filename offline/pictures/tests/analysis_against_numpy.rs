//! The analysis against figures computed from the definitions by `independent/analysis.py` (numpy).

use asperity_pictures::fractal_dimension::{cube_dimensions, probability_dimension, transects};
use asperity_pictures::symmetry::feature_matrix;
use asperity_surface::raster::Raster;

/// The script's picture: whole numbers, so that both sides see the same bits.
fn picture() -> Raster {
    Raster::from_fn(96, 64, |x, y| ((7 * x * x + 13 * x * y + 5 * y * y + 3 * x) % 257 + 4 * x) as f64)
}

#[test]
fn the_feature_matrix_is_that_of_numpy() {
    let matrix = feature_matrix(&picture());
    for (dx, dy, expected) in [
        (0, 0, 0.0),
        (1, 0, 10_882.965_953_947_369),
        (-17, 5, 15_221.464_492_598_156),
        (48, 32, 48_754.522_135_416_664),
        (-48, 11, 48_117.689_072_327_04),
        (3, -32, 11_259.333_333_333_334),
    ] {
        let found = matrix.at(dx, dy);
        assert!((found - expected).abs() < 1e-7, "({dx}, {dy}): {found} against {expected}");
    }
}

#[test]
fn the_dimensions_are_those_of_numpy() {
    let cubes = cube_dimensions(&picture()).unwrap();
    assert!((cubes.box_counting - 2.510_429_538_193_963).abs() < 1e-12);
    assert!((cubes.information - 2.504_174_355_288_199_6).abs() < 1e-12);
    assert!((cubes.correlation - 2.500_594_827_894_526).abs() < 1e-12);
    // Compared in single precision here, in double there.
    let probability = probability_dimension(&picture()).unwrap();
    assert!((probability - 2.898_896_366_359_560_6).abs() < 1e-4, "{probability}");
    let madogram = transects(&picture()).unwrap().madogram_dimension;
    assert!((madogram - 3.013_633_487_291_295_8).abs() < 1e-12, "{madogram}");
}
