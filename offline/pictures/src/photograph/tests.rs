//! A photograph's colour share at both depths.

use super::*;
use asperity_surface::image_io::{Channel, load_channel};
use image::{DynamicImage, GrayImage};

/// Darker to the right, a bright first row.
fn shaded() -> GrayImage {
    GrayImage::from_fn(32, 16, |x, y| image::Luma([if y == 0 { 250 } else { 200 - 6 * x as u8 }]))
}

#[test]
fn a_photographs_colour_is_known_at_8_and_16_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let colour = |image: DynamicImage| {
        image.save(&path).unwrap();
        let photograph = load_reduced_photograph(&path, usize::MAX).unwrap();
        assert_eq!(photograph.brightness, load_channel(&path, Channel::Luma).unwrap().raster);
        photograph.colour
    };
    assert_eq!(colour(DynamicImage::from(shaded())), 0.0);
    let red = image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([(x * 9) as u8, (y * 5) as u8, 40]));
    let narrow = colour(DynamicImage::from(red.clone()));
    let wide = colour(DynamicImage::from(DynamicImage::from(red).to_rgb16()));
    assert!(narrow > 0.5 && (wide / narrow - 1.0).abs() < 1e-6, "{narrow} {wide}");
}
