//! Heights from the shading of one photograph.
//!
//! A matt surface under one distant light is as bright as
//! ```text
//! R(p, q) = (−s_x p − s_y q + s_z) / √(1 + p² + q²)        p = ∂z/∂u, q = ∂z/∂v
//! ```
//! | symbol | here |
//! |---|---|
//! | s | [`Light`]: unit vector towards the light, x along u, y along v (downwards), z out of the surface |
//! | I | the image: linear brightness over that of a texel facing the light, see [`expose`] |
//! | z | [`Shape::height_px`], texels |
//!
//! Four ways to z, [`Method`]:
//!
//! *Integrable* (default for directed light). Each step moves p, q along the gradient of R until R
//! would be I, `(p, q) += (I − R) ∇R / (|∇R|² + μ)`, and projects them onto the slopes of a surface
//! ([`crate::gradient_field`]; R. T. Frankot and R. Chellappa, IEEE PAMI 10, 1988). It starts from
//! the solution for gentle slopes, which is linear (A. P. Pentland, IJCV 4, 1990).
//!
//! *Tsai–Shah* (document 004 §8.1.2; P.-S. Tsai and M. Shah, Image and Vision Computing 12, 1994),
//! Jacobi steps `Z ← Z − f/f'` with f = I − R, backward differences and `f' = (s_x + s_y)/√w + (p +
//! q)(−s_x p − s_y q + s_z)/w^1.5`, w = 1 + p² + q². Measured: the first step is an affine copy of
//! the negative image, whatever the surface; correlation with known heights stays below 0.35,
//! against 0.4–0.99 for the integrable solver. Kept because the document used it. Under frontal
//! light f' is 0 at the start; |f'| is kept above 0.01 (ours).
//!
//! *Dark is deep* (default for diffuse or frontal light): a wave of brightness is a wave of height,
//! as steep as it has contrast, [`darkness_prior`](mod@crate::darkness_prior).
//!
//! *Flat ground* (default for frontal light where there is a ground): light from the viewer's
//! direction (less than [`LEAST_SLANT_RAD`]) tells how steep a place is and not which way,
//! [`crate::flat_ground`]. Without a ground, dark is deep is used, and said.

use crate::borders::{Borders, SplitBorders};
use crate::darkness_prior::darkness_prior;
use crate::fft2::{Fft2, angular_frequency};
use crate::flat_ground::above_flat_ground;
use crate::gradient_field::{Derivative, Projection, Slopes};
use crate::light::{Light, estimate_light};
use asperity_dsp::DesignError;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// Steps of the integrable solver. Source: ours; twice as many change the correlation by < 0.01.
pub const STEPS: usize = 100;
/// μ: how much gradient counts as none. Source: ours.
const DAMPING: f64 = 0.03;
/// Steepest slope a step may take (76°).
const STEEPEST: f64 = 4.0;
/// Trust of the start in frequencies across the light, which shading does not show.
const ACROSS: f64 = 0.1;
/// Slant below which shading says nothing of direction, radians: 10°.
pub const LEAST_SLANT_RAD: f64 = 0.1745;
/// |f'| that Tsai–Shah keeps. Source: ours.
const LEAST_DERIVATIVE: f64 = 0.01;

/// Method that finds heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Slopes improved and projected, this many times.
    Integrable(usize),
    /// The document's, this many Jacobi steps.
    TsaiShah(usize),
    /// Brightness is height.
    DarkIsDeep,
    /// Relief that stands out of a flat ground under frontal light.
    FlatGround,
}

/// The surface of a photograph.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Heights in texels, mean 0.
    pub height_px: Raster,
    /// Method that found them.
    pub method: Method,
    /// The light that was used; `None` for [`Method::DarkIsDeep`], from the viewer for
    /// [`Method::FlatGround`].
    pub light: Option<Light>,
    /// Part of the image that the surface, lit by that light, does not explain: root mean square
    /// error over the image's standard deviation. `None` but for [`Method::Integrable`].
    pub unexplained: Option<f64>,
}

/// Heights by the recommended method: with the given light, or the one found in the image, or dark
/// is deep when there is none in it or it comes from the viewer's direction. `progress` gets the
/// fraction done.
///
/// # Errors
/// As [`shape_by`].
pub fn shape_from_shading(
    image: &Raster,
    light: Option<Light>,
    progress: impl FnMut(f64),
) -> Result<Shape, DesignError> {
    check(image)?;
    match light.or_else(|| estimate_light(image)) {
        Some(light) if light.slant_rad() >= LEAST_SLANT_RAD => {
            shape_by(Method::Integrable(STEPS), image, light, progress)
        }
        _ => shape_by(Method::DarkIsDeep, image, Light::OVERHEAD, progress),
    }
}

/// Heights by one method. The image is linear brightness in any unit; `light` does not matter to
/// [`Method::DarkIsDeep`] and [`Method::FlatGround`].
///
/// # Errors
/// When the image is smaller than 8 × 8 or holds numbers that are not finite, the integrable solver
/// is to use light from the viewer's direction, or there is no flat ground.
pub fn shape_by(
    method: Method,
    image: &Raster,
    light: Light,
    progress: impl FnMut(f64),
) -> Result<Shape, DesignError> {
    check(image)?;
    if matches!(method, Method::Integrable(_)) {
        let range = "at least 0.1745 rad (10°): light from the viewer's direction shows no slope's direction";
        DesignError::check("light slant", light.slant_rad(), range, |slant| slant >= LEAST_SLANT_RAD)?;
    }
    let (height_px, unexplained) = match method {
        Method::DarkIsDeep => (darkness_prior(image), None),
        Method::FlatGround => (on_flat_ground(image)?, None),
        Method::TsaiShah(steps) => (tsai_shah(&expose(image, light), light, steps), None),
        Method::Integrable(steps) => {
            let (height_px, unexplained) = integrable(&expose(image, light), light, steps, progress);
            (height_px, Some(unexplained))
        }
    };
    let mean = height_px.mean();
    let light = match method {
        Method::DarkIsDeep => None,
        Method::FlatGround => Some(Light::OVERHEAD),
        _ => Some(light),
    };
    Ok(Shape { height_px: height_px.map(|z| z - mean), method, light, unexplained })
}

fn on_flat_ground(image: &Raster) -> Result<Raster, DesignError> {
    let expected = "at least 0.1 of the image, connected, and nothing brighter than it: without a flat ground frontal light gives no heights";
    above_flat_ground(image).map_err(|share| DesignError { field: "flat ground", value: share, expected })
}

fn check(image: &Raster) -> Result<(), DesignError> {
    let smaller = image.width.min(image.height) as f64;
    DesignError::check("image side", smaller, "at least 8 texels", |n| n >= 8.0)?;
    match image.values.iter().copied().find(|v| !v.is_finite()) {
        Some(value) => Err(DesignError { field: "image", value, expected: "finite at every texel" }),
        None => Ok(()),
    }
}

/// The image in units of R: on gentle slopes that lean all ways alike, the mean of R is s_z. An
/// image without any light in it is left as it is.
#[must_use]
pub fn expose(image: &Raster, light: Light) -> Raster {
    let mean = image.mean();
    if mean <= 0.0 {
        return image.clone();
    }
    image.map(|v| v * light.direction()[2] / mean)
}

/// R and its derivatives by p and q.
fn reflectance([sx, sy, sz]: [f64; 3], p: f64, q: f64) -> (f64, f64, f64) {
    let w = 1.0 + p * p + q * q;
    let root = w.sqrt();
    let facing = -sx * p - sy * q + sz;
    let curved = facing / (w * root);
    (facing / root, -sx / root - curved * p, -sy / root - curved * q)
}

/// The integrable solver; also returns what the surface does not explain of the image.
fn integrable(image: &Raster, light: Light, steps: usize, mut progress: impl FnMut(f64)) -> (Raster, f64) {
    let image = SplitBorders::of(image, Borders::Detect).periodic;
    let (w, h) = (image.width, image.height);
    let s = light.direction();
    let mut projection = Projection::new(w, h, Derivative::Exact);
    let mut field = crate::gradient_field::slopes(&gentle_start(&image, s), Derivative::Exact);
    let mut brightness = 1.0;
    for step in 0..steps {
        // The best brightness of a facing texel for the surface so far.
        let (mut product, mut square) = (0.0, 0.0);
        let both = field.along_u.values.iter_mut().zip(&mut field.along_v.values);
        for ((p, q), &seen) in both.zip(&image.values) {
            let (r, by_p, by_q) = reflectance(s, *p, *q);
            let lit = r.max(0.0);
            product += seen * lit;
            square += lit * lit;
            let move_by = (seen / brightness - lit) / (by_p * by_p + by_q * by_q + DAMPING);
            (*p, *q) = (*p + move_by * by_p, *q + move_by * by_q);
            let steep = p.hypot(*q) / STEEPEST;
            if steep > 1.0 {
                (*p, *q) = (*p / steep, *q / steep);
            }
        }
        if square > 0.0 && product > 0.0 {
            brightness = product / square;
        }
        projection.project(&mut field);
        progress((step + 1) as f64 / steps as f64);
    }
    let unexplained = unexplained(&image, &field, s, brightness);
    (projection.heights(&field), unexplained)
}

/// The surface of R ≈ s_z − s_x p − s_y q: Z = −(I − mean I) / (i s·ω), damped where s·ω is small.
fn gentle_start(image: &Raster, [sx, sy, _]: [f64; 3]) -> Raster {
    let (w, h) = (image.width, image.height);
    let mut fft = Fft2::new(w, h);
    let mut spectrum = fft.spectrum(&image.values);
    let tilt = sx.hypot(sy);
    for (place, value) in spectrum.iter_mut().enumerate() {
        let (wx, wy) = (angular_frequency(place / h, w), angular_frequency(place % h, h));
        let along = sx * wx + sy * wy;
        let across = ACROSS * tilt * wx.hypot(wy);
        let square = along * along + across * across;
        *value *= if square > 0.0 { Complex64::new(0.0, along / square) } else { Complex64::default() };
    }
    fft.image(&mut spectrum)
}

fn unexplained(image: &Raster, field: &Slopes, s: [f64; 3], brightness: f64) -> f64 {
    let mean = image.mean();
    let (mut error, mut variance) = (0.0, 0.0);
    let both = field.along_u.values.iter().zip(&field.along_v.values);
    for ((&p, &q), &seen) in both.zip(&image.values) {
        error += (seen - brightness * reflectance(s, p, q).0.max(0.0)).powi(2);
        variance += (seen - mean).powi(2);
    }
    if variance > 0.0 { (error / variance).sqrt() } else { 0.0 }
}

/// The document's solver.
fn tsai_shah(image: &Raster, light: Light, steps: usize) -> Raster {
    let (w, h) = (image.width, image.height);
    let s = light.direction();
    let mut surface = Raster::constant(w, h, 0.0);
    for _ in 0..steps {
        let before = surface.clone();
        for y in 0..h {
            for x in 0..w {
                let z = before.at(x, y);
                let p = if x > 0 { z - before.at(x - 1, y) } else { 0.0 };
                let q = if y > 0 { z - before.at(x, y - 1) } else { 0.0 };
                let (r, by_p, by_q) = reflectance(s, p, q);
                // f' = −(R_p + R_q): both slopes grow with the texel's own height.
                let slope = -(by_p + by_q);
                let slope = slope.abs().max(LEAST_DERIVATIVE).copysign(slope);
                surface.values[y * w + x] = z - (image.at(x, y) - r) / slope;
            }
        }
    }
    surface
}
