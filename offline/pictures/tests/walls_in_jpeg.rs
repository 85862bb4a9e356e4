//! Blank walls that a camera saved as JPEG: what the file cannot hold is not felt, and relief is.

use asperity_dsp::rng::Rng;
use asperity_pictures::from_photo::{MOST_TEXELS, PhotoOptions, surface_from_photo};
use asperity_pictures::photograph::{Photograph, load_reduced_photograph};
use asperity_surface::raster::Raster;
use image::codecs::jpeg::JpegEncoder;
use image::{Rgb, RgbImage};

const SIDE: u32 = 320;

/// A picture of noisy colours, blurred as a sensor's mosaic does, under light that falls off to one
/// side, read back from a JPEG.
fn photographed(quality: u8, noise: f64, ground: impl Fn(u32, u32) -> f64) -> Photograph {
    let mut rng = Rng::new(2_611 + u64::from(quality));
    let side = SIDE as usize + 1;
    let white: Vec<Raster> = (0..3).map(|_| Raster::from_fn(side, side, |_, _| rng.normal())).collect();
    let picture = RgbImage::from_fn(SIDE, SIDE, |x, y| {
        let (i, j) = (x as usize, y as usize);
        let light = 1.0 - 0.1 * f64::from(x) / f64::from(SIDE);
        Rgb([0, 1, 2].map(|c| {
            let w = &white[c];
            let blurred = (w.at(i, j) + w.at(i + 1, j) + w.at(i, j + 1) + w.at(i + 1, j + 1)) / 2.0;
            ((190.0 - 8.0 * c as f64 + ground(x, y)) * light + noise * blurred).round().clamp(0.0, 255.0)
                as u8
        }))
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wall.jpg");
    let file = std::fs::File::create(&path).unwrap();
    picture.write_with_encoder(JpegEncoder::new_with_quality(file, quality)).unwrap();
    load_reduced_photograph(&path, MOST_TEXELS).unwrap()
}

/// Rms of the heights, m, against their mean over 64 texels: what a stroke at 0.1 m/s feels above
/// 10 Hz.
fn felt_m(photograph: &Photograph, jpeg_divisor: f64) -> f64 {
    let options = PhotoOptions { jpeg_divisor, ..PhotoOptions::default() };
    let surface = surface_from_photo(&photograph.brightness, &options, |_| {}).unwrap();
    let heights = surface.displacement.map(|z| z * surface.relief_m);
    let mut sum = 0.0;
    for y in 0..heights.height {
        for run in heights.row(y).chunks_exact(64) {
            let mean = run.iter().sum::<f64>() / 64.0;
            sum += run.iter().map(|z| (z - mean).powi(2)).sum::<f64>();
        }
    }
    (sum / heights.values.len() as f64).sqrt()
}

#[test]
fn a_wall_in_a_jpeg_is_not_felt_at_any_quality() {
    for (quality, noise) in [(75, 0.8), (80, 2.5), (85, 1.5), (90, 3.0)] {
        let wall = photographed(quality, noise, |_, _| 0.0);
        let (felt, before) = (felt_m(&wall, wall.jpeg_divisor), felt_m(&wall, 0.0));
        println!("quality {quality}, noise {noise}: {felt:.2e} m, {before:.2e} without the divisor");
        assert!(felt < 1e-6, "quality {quality}, noise {noise}: {felt:.2e} m");
    }
}

#[test]
fn relief_in_a_jpeg_is_what_it_is_without_its_divisor() {
    let mut rng = Rng::new(9);
    let coarse = Raster::from_fn(40, 40, |_, _| 12.0 * rng.normal());
    let stones = photographed(80, 1.0, |x, y| coarse.at(x as usize / 8, y as usize / 8));
    let (corrected, untold) = (felt_m(&stones, stones.jpeg_divisor), felt_m(&stones, 0.0));
    assert!(corrected > 0.98 * untold && corrected > 1e-5, "{corrected:.2e} {untold:.2e}");
}
