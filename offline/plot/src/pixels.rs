//! Pictures as PNG bytes.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

fn encode(
    bytes: &[u8],
    width: usize,
    height: usize,
    colour: ExtendedColorType,
    filter: FilterType,
) -> Vec<u8> {
    let mut png = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Fast, filter);
    let size = (u32::try_from(width).unwrap_or(0), u32::try_from(height).unwrap_or(0));
    match encoder.write_image(bytes, size.0, size.1, colour) {
        Ok(()) => png,
        Err(_) => Vec::new(),
    }
}

/// A 16-bit grey picture, top row first.
#[must_use]
pub fn png16(width: usize, height: usize, grey: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = grey.iter().flat_map(|grey| grey.to_ne_bytes()).collect();
    encode(&bytes, width, height, ExtendedColorType::L16, FilterType::Up)
}

/// An 8-bit grey picture, top row first.
#[must_use]
pub fn png8(width: usize, height: usize, grey: &[u8]) -> Vec<u8> {
    encode(grey, width, height, ExtendedColorType::L8, FilterType::Up)
}

/// A colour picture, top row first; the few flat colours of a plot pack best without a filter.
#[must_use]
pub fn png_rgb(width: usize, height: usize, rgb: &[u8]) -> Vec<u8> {
    encode(rgb, width, height, ExtendedColorType::Rgb8, FilterType::NoFilter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_bits_survive_the_file() {
        let grey: Vec<u16> = (0..64).map(|i| i * 1021).collect();
        let back = image::load_from_memory(&png16(8, 8, &grey)).unwrap().to_luma16();
        assert_eq!(back.into_raw(), grey);
    }
}
