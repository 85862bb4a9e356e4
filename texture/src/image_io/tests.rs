//! Pictures as telephones, old programs and scanners write them.

use super::*;
use image::{ExtendedColorType, GrayImage, ImageEncoder};

/// Darker to the right, a bright first row.
fn shaded() -> GrayImage {
    GrayImage::from_fn(32, 16, |x, y| image::Luma([if y == 0 { 250 } else { 200 - 6 * x as u8 }]))
}

#[test]
fn a_telephone_picture_is_turned_as_its_exif_says() {
    let folder = tempfile::tempdir().unwrap();
    let plain = folder.path().join("plain.jpg");
    let turned = folder.path().join("turned.jpg");
    for (path, orientation) in [(&plain, 1_u8), (&turned, 6)] {
        // TIFF, little endian, one entry: tag 0x0112, type 3 (short), count 1.
        let mut exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0".to_vec();
        exif.extend([orientation, 0, 0, 0, 0, 0, 0, 0]);
        let mut file = BufWriter::new(File::create(path).unwrap());
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 95);
        encoder.set_exif_metadata(exif).unwrap();
        encoder.encode(shaded().as_raw(), 32, 16, ExtendedColorType::L8).unwrap();
    }
    let (plain, turned) = (
        load_channel(plain, Channel::Luma).unwrap().raster,
        load_channel(turned, Channel::Luma).unwrap().raster,
    );
    assert_eq!((turned.width, turned.height), (plain.height, plain.width));
    // Tag 6: a quarter turn clockwise; the first row becomes the last column.
    for (x, y) in [(0, 0), (5, 3), (31, 15)] {
        assert_eq!(turned.at(15 - y, x), plain.at(x, y));
    }
}

#[test]
fn a_gif_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.gif");
    shaded().save(&path).unwrap_or_else(|_| DynamicImage::from(shaded()).to_rgb8().save(&path).unwrap());
    let picture = load_channel(&path, Channel::Luma).unwrap().raster;
    assert!((picture.at(4, 4) - 176.0 / 255.0).abs() < 0.03, "{}", picture.at(4, 4));
}

#[cfg(feature = "offline")]
#[test]
fn a_photographs_colour_is_known_at_8_and_16_bits_and_grey_has_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let colour = |image: DynamicImage| {
        image.save(&path).unwrap();
        let (picture, colour) = load_photograph(&path).unwrap();
        assert_eq!(picture, load_channel(&path, Channel::Luma).unwrap());
        colour
    };
    assert_eq!(colour(DynamicImage::from(shaded())), 0.0);
    let red = image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([(x * 9) as u8, (y * 5) as u8, 40]));
    let narrow = colour(DynamicImage::from(red.clone()));
    let wide = colour(DynamicImage::from(DynamicImage::from(red).to_rgb16()));
    assert!(narrow > 0.5 && (wide / narrow - 1.0).abs() < 1e-6, "{narrow} {wide}");
}
