//! Normal maps of known slopes, as people have them, and how far heights are from the truth.

#![allow(dead_code)] // Each test binary uses some of them.

use asperity_pictures::fft2::{Fft2, angular_frequency};
use asperity_pictures::gradient_field::Slopes;
use asperity_pictures::normal_map::Green;
use asperity_surface::raster::Raster;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{self, FilterType};
use image::{ImageBuffer, Luma, RgbImage};
use std::f64::consts::{PI, TAU};

/// An 8-bit normal map with the slopes of a surface, as red, green and blue.
pub fn normal_map(field: &Slopes, green: Green) -> [Raster; 3] {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let level = |n: f64| ((n * 0.5 + 0.5) * 255.0).round() / 255.0;
    let channel = |which: usize| {
        Raster::from_fn(w, h, |x, y| {
            let (p, q) = (field.along_u.at(x, y), field.along_v.at(x, y));
            let up = 1.0 / (1.0 + p * p + q * q).sqrt();
            let side = if green == Green::DirectX { -q } else { q };
            level([-p * up, side * up, up][which])
        })
    };
    [channel(0), channel(1), channel(2)]
}

/// Root mean square error over the root mean square of the truth, both about their means.
pub fn relative_error(made: &Raster, truth: &Raster) -> f64 {
    let mean = truth.mean();
    let error: f64 = made.values.iter().zip(&truth.values).map(|(a, b)| (a - (b - mean)).powi(2)).sum();
    (error / truth.values.iter().map(|b| (b - mean).powi(2)).sum::<f64>()).sqrt()
}

fn picture([red, green, blue]: &[Raster; 3]) -> RgbImage {
    let level = |raster: &Raster, place: usize| (255.0 * raster.values[place]).round() as u8;
    RgbImage::from_fn(red.width as u32, red.height as u32, |x, y| {
        let place = y as usize * red.width + x as usize;
        image::Rgb([level(red, place), level(green, place), level(blue, place)])
    })
}

fn channels(picture: &RgbImage) -> [Raster; 3] {
    let (w, h) = picture.dimensions();
    [0, 1, 2].map(|c| {
        Raster::from_fn(w as usize, h as usize, |x, y| {
            f64::from(picture.get_pixel(x as u32, y as u32)[c]) / 255.0
        })
    })
}

/// The map at half its size, each side.
pub fn halved(map: &[Raster; 3], filter: FilterType) -> [Raster; 3] {
    let picture = picture(map);
    let (w, h) = picture.dimensions();
    channels(&imageops::resize(&picture, w / 2, h / 2, filter))
}

/// The map as JPEG keeps it: with `half_colours`, two of its three colours at half the size, as
/// most programs do.
pub fn as_jpeg(map: &[Raster; 3], quality: u8, half_colours: bool) -> [Raster; 3] {
    let mut picture = picture(map);
    if half_colours {
        halve_colours(&mut picture);
    }
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode(&picture, picture.width(), picture.height(), image::ExtendedColorType::Rgb8)
        .expect("a JPEG");
    channels(&image::load_from_memory(&bytes).expect("a picture").to_rgb8())
}

/// Means of two by two texels take the place of both differences of colours from grey.
fn halve_colours(picture: &mut RgbImage) {
    let grey =
        |p: &image::Rgb<u8>| 0.299 * f64::from(p[0]) + 0.587 * f64::from(p[1]) + 0.114 * f64::from(p[2]);
    for y in (0..picture.height() - 1).step_by(2) {
        for x in (0..picture.width() - 1).step_by(2) {
            let places = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            let texels = places.map(|(x, y)| *picture.get_pixel(x, y));
            let mean =
                [0, 1, 2].map(|c| 0.25 * texels.iter().map(|t| f64::from(t[c]) - grey(t)).sum::<f64>());
            for ((x, y), texel) in places.into_iter().zip(texels) {
                let level = |c: usize| (grey(&texel) + mean[c]).round().clamp(0.0, 255.0) as u8;
                picture.put_pixel(x, y, image::Rgb([0, 1, 2].map(level)));
            }
        }
    }
}

/// A rectangle of a map or of heights.
pub fn cut(raster: &Raster, [x, y]: [usize; 2], [width, height]: [usize; 2]) -> Raster {
    Raster::from_fn(width, height, |u, v| raster.at(x + u, y + v))
}

/// Heights at half the size: means of two by two, in the new texels.
pub fn halved_heights(heights: &Raster) -> Raster {
    Raster::from_fn(heights.width / 2, heights.height / 2, |x, y| {
        let at = |i: usize, j: usize| heights.at(2 * x + i, 2 * y + j);
        0.125 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
    })
}

/// Heights at half the size by the filter that halved their normals, in the new texels.
pub fn halved_heights_by(heights: &Raster, filter: FilterType) -> Raster {
    let (w, h) = (heights.width as u32, heights.height as u32);
    let values = heights.values.iter().map(|&z| z as f32).collect();
    let picture =
        ImageBuffer::<Luma<f32>, Vec<f32>>::from_raw(w, h, values).expect("as many values as texels");
    let small = imageops::resize(&picture, w / 2, h / 2, filter);
    let values = small.into_raw().into_iter().map(|z| 0.5 * f64::from(z)).collect();
    Raster { width: heights.width / 2, height: heights.height / 2, values }
}

/// Power of the made heights over the true ones' in each third of the spectrum; of maps that do not
/// tile without their slant and under a window.
pub fn thirds(made: &Raster, truth: &Raster, tiles: bool) -> [f64; 3] {
    let (w, h) = (truth.width, truth.height);
    let mut fft = Fft2::new(w, h);
    let mut power = |heights: &Raster| {
        let levelled = if tiles { heights.clone() } else { windowed(&without_slant(heights)) };
        let spectrum = fft.spectrum(&levelled.values);
        let mut thirds = [0.0; 3];
        for (place, value) in spectrum.iter().enumerate().skip(1) {
            let omega = angular_frequency(place / h, w).hypot(angular_frequency(place % h, h));
            thirds[((3.0 * omega / PI) as usize).min(2)] += value.norm_sqr();
        }
        thirds
    };
    let (made, truth) = (power(made), power(truth));
    [0, 1, 2].map(|i| made[i] / truth[i])
}

/// What is left of heights without the plane nearest to them.
pub fn without_slant(heights: &Raster) -> Raster {
    let (w, h) = (heights.width, heights.height);
    let place = |i: usize, n: usize| i as f64 - 0.5 * (n - 1) as f64;
    let slope = |along: &dyn Fn(usize, usize) -> f64| {
        let (mut both, mut square) = (0.0, 0.0);
        for y in 0..h {
            for x in 0..w {
                both += along(x, y) * heights.at(x, y);
                square += along(x, y) * along(x, y);
            }
        }
        both / square
    };
    let (along_u, along_v) = (slope(&|x, _| place(x, w)), slope(&|_, y| place(y, h)));
    let mean = heights.mean();
    Raster::from_fn(w, h, |x, y| heights.at(x, y) - mean - along_u * place(x, w) - along_v * place(y, h))
}

fn windowed(heights: &Raster) -> Raster {
    let hann = |i: usize, n: usize| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos();
    Raster::from_fn(heights.width, heights.height, |x, y| {
        heights.at(x, y) * hann(x, heights.width) * hann(y, heights.height)
    })
}
