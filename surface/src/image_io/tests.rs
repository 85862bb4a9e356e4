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
fn a_file_of_another_kind_is_refused_with_its_name_and_converter() {
    for (bytes, kind, instead) in [
        (&b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"[..], "Radiance HDR", "EXR"),
        (b"\xabKTX 20\xbb\r\n\x1a\n", "KTX2", "PNG"),
        (b"DDS |\0\0\0", "DDS", "PNG"),
        (b"8BPS\0\x01", "PSD", "flatten"),
        (b"\xff\x0a\xfa\x1f", "JPEG XL", "PNG"),
        (b"\0\0\x01\0\x01\0", "ICO", "PNG"),
        (b"\0\0\0\x20ftypavif", "AVIF", "PNG"),
        (b"\0\0\0\x18ftypheic", "HEIC", "PNG"),
        (b"<!DOCTYPE html>", "a web page", "download"),
    ] {
        let error = read_channel(bytes, Channel::Luma).unwrap_err();
        let (right, text) = (matches!(error, Problem::OtherFormat { .. }), error.to_string());
        assert!(right && text.contains(kind) && text.contains(instead), "{text}");
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

#[cfg(feature = "more-pictures")]
mod of_more_formats {
    use super::*;
    use image::ImageFormat;

    fn in_format(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_map_of_an_asset_site_is_read_whatever_its_format() {
        let grey = DynamicImage::from(shaded());
        let colour = DynamicImage::from(grey.to_rgb8());
        for (image, format) in [
            (&colour, ImageFormat::WebP),
            (&grey, ImageFormat::Tiff),
            (&colour, ImageFormat::Tga),
            (&grey, ImageFormat::Tga),
            (&colour, ImageFormat::Bmp),
        ] {
            let read = read_channel(&in_format(image, format), Channel::Luma).unwrap();
            assert_eq!(
                read.raster,
                read_channel(&in_format(&grey, ImageFormat::Png), Channel::Luma).unwrap().raster
            );
        }
    }

    #[test]
    fn sixteen_bits_of_a_tiff_are_kept() {
        let deep = image::ImageBuffer::from_fn(9, 5, |x, y| image::Luma([(7000 * x + y) as u16]));
        let bytes = in_format(&DynamicImage::ImageLuma16(deep), ImageFormat::Tiff);
        let read = read_channel(&bytes, Channel::Luma).unwrap().raster;
        assert_eq!(read.at(3, 2), 21_002.0 / 65_535.0);
    }

    #[test]
    fn the_floats_of_a_terrain_program_are_metres() {
        let metres: Vec<f32> = (0..6 * 4).map(|i| 0.25 * i as f32 - 2.0).collect();
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = ::tiff::encoder::TiffEncoder::new(&mut bytes).unwrap();
        encoder.write_image::<::tiff::encoder::colortype::Gray32Float>(6, 4, &metres).unwrap();
        let read = read_channel(bytes.get_ref(), Channel::Luma).unwrap();
        assert!(read.raster.values.iter().zip(&metres).all(|(a, b)| *a == f64::from(*b)));
        assert_eq!(read.step, 0.0);
    }

    #[test]
    fn text_and_stubs_are_no_tga() {
        for bytes in [
            &b"# height map of the wall, 512 x 512\n"[..],
            &[0; 18],
            &[0; 5],
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        ] {
            assert!(matches!(read_channel(bytes, Channel::Luma), Err(Problem::UnknownFormat)), "{bytes:?}");
        }
    }
}

#[cfg(feature = "exr")]
mod of_exr {
    use super::*;
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, IntegerBounds, Layer, LayerAttributes,
        WritableImage,
    };

    /// A file of parts with these channels, each value 100 × its place in the part + the texel.
    fn file(parts: &[(&str, &[&str])]) -> Vec<u8> {
        let layers = parts.iter().map(|(name, channels)| {
            let channels = channels.iter().enumerate().map(|(at, name)| {
                let values = (0..12).map(|texel| 100.0 * at as f32 + texel as f32 - 3.5).collect();
                AnyChannel::new(*name, FlatSamples::F32(values))
            });
            let channels = AnyChannels::sort(channels.collect());
            Layer::new((4, 3), LayerAttributes::named(*name), Encoding::FAST_LOSSLESS, channels)
        });
        let layers: Vec<Layer<AnyChannels<FlatSamples>>> = layers.collect();
        let mut bytes = Cursor::new(Vec::new());
        let image = Image::from_layers(
            ::exr::meta::header::ImageAttributes::new(IntegerBounds::new((0, 0), (4, 3))),
            layers.into_iter().collect::<::exr::image::Layers<_>>(),
        );
        image.write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn first(bytes: &[u8], channel: Channel) -> f64 {
        read_channel(bytes, channel).unwrap().raster.values[0]
    }

    #[test]
    fn one_channel_is_a_map_whatever_it_is_called() {
        for name in ["Y", "R", "V", "Z", "displacement.R", "Depth.Z", "height"] {
            let bytes = file(&[("part", &[name])]);
            assert_eq!(first(&bytes, Channel::Luma), -3.5, "{name}");
            assert!(matches!(read_channel(&bytes, Channel::A), Err(Problem::NoAlpha)));
        }
    }

    #[test]
    fn colours_and_vectors_are_in_order_and_alpha_is_alpha() {
        let bytes = file(&[("", &["R", "G", "B", "A"])]);
        let found = [Channel::R, Channel::G, Channel::B, Channel::A].map(|channel| first(&bytes, channel));
        assert_eq!(found, [-3.5, 96.5, 196.5, 296.5]);
        assert_eq!(first(&file(&[("n", &["Normal.X", "Normal.Y", "Normal.Z"])]), Channel::B), 196.5);
        assert_eq!(first(&file(&[("", &["Y", "A"])]), Channel::A), 96.5);
    }

    #[test]
    fn the_picture_beside_layers_is_read_and_several_layers_are_told() {
        assert_eq!(first(&file(&[("", &["depth.Z", "R", "G", "B"])]), Channel::R), 96.5);
        let error =
            read_channel(&file(&[("a", &["R", "G", "B"]), ("b", &["Z"])]), Channel::Luma).unwrap_err();
        assert!(error.to_string().contains("several layers (a, b)"), "{error}");
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = file(&[("part", &["Y"])]);
        for length in 0..whole.len() {
            assert!(read_channel(&whole[..length], Channel::Luma).is_err(), "{length}");
        }
    }
}
