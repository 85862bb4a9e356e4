//! Normal maps of known slopes, and how far heights are from the truth.

use asperity_texture::gradient_field::Slopes;
use asperity_texture::normal_map::Green;
use asperity_texture::raster::Raster;

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
