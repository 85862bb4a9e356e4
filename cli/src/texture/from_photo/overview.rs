//! The overview picture of a photograph: picture, parts and heights side by side.

use asperity_pictures::from_photo::PhotoSurface;
use asperity_pictures::light::Light;
use asperity_surface::raster::Raster;

/// Largest side of a panel, texels.
const PANEL: usize = 512;

/// Photo, symmetric part, residual; displacement, displacement lit from above left, roughness.
pub(super) fn overview(picture: &Raster, surface: &PhotoSurface) -> Raster {
    let panels = [
        small(&stretched(picture)),
        small(&stretched(&surface.symmetric)),
        small(&surface.residual.map(|v| (v + 0.5).clamp(0.0, 1.0))),
        small(&surface.displacement),
        lit(&small(&surface.shape.height_px), surface.shape.height_px.width),
        small(&surface.roughness),
    ];
    let (w, h) = (panels[0].width, panels[0].height);
    let gap = 6;
    Raster::from_fn(3 * w + 2 * gap, 2 * h + gap, |x, y| {
        let (column, row) = (x / (w + gap), y / (h + gap));
        let (x, y) = (x % (w + gap), y % (h + gap));
        if x < w && y < h { panels[row * 3 + column].at(x, y) } else { 1.0 }
    })
}

fn stretched(raster: &Raster) -> Raster {
    let (low, high) = raster.range();
    raster.map(|v| if high > low { (v - low) / (high - low) } else { 0.5 })
}

/// Every n-th texel's mean, so that no side is above [`PANEL`].
fn small(raster: &Raster) -> Raster {
    let step = raster.width.max(raster.height).div_ceil(PANEL);
    Raster::from_fn(raster.width / step, raster.height / step, |x, y| {
        let cell = (0..step * step).map(|i| raster.at(x * step + i % step, y * step + i / step));
        cell.sum::<f64>() / (step * step) as f64
    })
}

/// Heights (texels of a picture `full` wide) under a light from above left.
fn lit(height: &Raster, full: usize) -> Raster {
    let texel = full as f64 / height.width as f64;
    let [sx, sy, sz] = Light::ABOVE_LEFT.direction();
    Raster::from_fn(height.width, height.height, |x, y| {
        let (left, up) = (x.saturating_sub(1), y.saturating_sub(1));
        let (right, down) = ((x + 1).min(height.width - 1), (y + 1).min(height.height - 1));
        let p = (height.at(right, y) - height.at(left, y)) / ((right - left) as f64 * texel);
        let q = (height.at(x, down) - height.at(x, up)) / ((down - up) as f64 * texel);
        ((sz - sx * p - sy * q) / (1.0 + p * p + q * q).sqrt()).clamp(0.0, 1.0)
    })
}
