//! Normal map, recognised among pictures: its pixels are unit vectors that point out of the
//! surface.
//!
//! ```text
//! n = 2 (r, g, b) − 1,   |n| = 1,   n_z > 0
//! ```
//!
//! Colours of a photograph lie all over the cube; a picture of which nearly all pixels lie near
//! that half sphere is a normal map.

use super::{Picture, Samples};

/// Largest deviation of a stored vector's length from 1: what 8 bits and JPEG leave.
const LENGTH: f64 = 0.15;
/// Smallest component out of the surface.
const OUTWARD: f64 = 0.1;
/// Factor by which the mean of all must point further out of the surface than along it. A light
/// grey, stored as three equal colours, points along all three
const UPRIGHT: f64 = 2.0;
/// Part of the pixels that must be such vectors.
const MOST: f64 = 0.95;
/// Pixels that are looked at.
const LOOKED_AT: usize = 4096;

/// Tests whether the picture's pixels are normals.
pub(super) fn is_normal_map(picture: &Picture) -> bool {
    let pixels = picture.width * picture.height;
    if picture.channels < 3 || pixels < 16 {
        return false;
    }
    let step = pixels.div_ceil(LOOKED_AT);
    let looked_at = (0..pixels).step_by(step);
    let (mut normals, mut sum) = (0, [0.0; 3]);
    for pixel in looked_at.clone() {
        let vector = vector(picture, pixel);
        normals += usize::from(is_normal(vector));
        sum.iter_mut().zip(vector).for_each(|(sum, x)| *sum += x);
    }
    let points_outward = sum[2] >= UPRIGHT * sum[0].abs().max(sum[1].abs());
    points_outward && normals as f64 >= MOST * looked_at.count() as f64
}

fn is_normal([x, y, z]: [f64; 3]) -> bool {
    let length = (x * x + y * y + z * z).sqrt();
    (length - 1.0).abs() <= LENGTH && z >= OUTWARD
}

/// Red, green and blue of a pixel as −1…1; floating point pictures hold such numbers or 0…1, and
/// are taken as the latter.
fn vector(picture: &Picture, pixel: usize) -> [f64; 3] {
    let first = pixel * picture.channels;
    [0, 1, 2].map(|channel| {
        let value = match &picture.samples {
            Samples::U8(samples) => f64::from(samples[first + channel]) / 255.0,
            Samples::U16(samples) => f64::from(samples[first + channel]) / 65_535.0,
            Samples::F32(samples) => f64::from(samples[first + channel]),
        };
        2.0 * value - 1.0
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Channel, Problem};
    use super::*;
    use asperity_dsp::rng::Rng;

    /// A picture of 64 × 64 pixels.
    fn picture(pixel: impl Fn(usize, usize) -> [f64; 3]) -> Picture {
        let bytes =
            (0..64 * 64).flat_map(|at| pixel(at % 64, at / 64)).map(|value| (255.0 * value).round() as u8);
        Picture::new(64, 64, Samples::U8(bytes.collect())).unwrap()
    }

    fn normals(steepness: f64) -> Picture {
        picture(|x, y| {
            let [p, q] = [(0.7 * x as f64).sin(), (0.4 * y as f64).cos()].map(|slope| steepness * slope);
            let length = (1.0 + p * p + q * q).sqrt();
            [-p / length, -q / length, 1.0 / length].map(|n| 0.5 + 0.5 * n)
        })
    }

    #[test]
    fn a_normal_map_is_no_map_of_heights_however_steep() {
        for steepness in [0.0, 0.05, 0.5, 2.0] {
            assert!(
                matches!(normals(steepness).map(Channel::Luma), Err(Problem::IsNormalMap)),
                "{steepness}"
            );
            assert!(normals(steepness).map(Channel::R).is_ok(), "a channel that is named is meant");
        }
    }

    #[test]
    fn greys_colours_and_noise_are_heights() {
        let grey = picture(|x, y| [((x * y) % 64) as f64 / 63.0; 3]);
        let light = picture(|x, y| [0.75 + 0.05 * (((x + y) % 8) as f64 / 7.0); 3]);
        let mut rng = Rng::new(3);
        let noise: Vec<u8> = (0..3 * 64 * 64).map(|_| (256.0 * rng.uniform()) as u8).collect();
        let noise = Picture::new(64, 64, Samples::U8(noise)).unwrap();
        let sky = picture(|_, y| [0.35 + y as f64 / 200.0, 0.55 + y as f64 / 300.0, 0.9]);
        let bricks = picture(|x, y| if (x / 16 + y / 8) % 5 == 0 { [0.7; 3] } else { [0.6, 0.3, 0.22] });
        for colours in [grey, light, noise, sky, bricks] {
            assert!(colours.map(Channel::Luma).is_ok());
        }
    }
}
