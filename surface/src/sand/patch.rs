//! A patch of sand for the audio half: 64 × 64 heights around a contact.
//!
//! Read with a cubic B-spline that smooths instead of interpolating: heights, slopes and curvatures
//! are continuous, and what is finer than a cell is the grains' business.

/// Samples along an edge of a patch.
pub const PATCH: usize = 64;

/// Heights around a contact, or (coarsely) of all the sand.
#[derive(Debug, Clone)]
pub struct Patch {
    /// The contact it belongs to.
    pub contact: usize,
    /// Position of the first height, metres.
    pub origin_m: [f64; 2],
    /// Distance between two heights, metres.
    pub spacing_m: f64,
    /// Height that all heights are relative to, metres above the untouched surface.
    pub base_m: f64,
    /// Heights, rows first, metres above `base_m`.
    pub heights_m: [f32; PATCH * PATCH],
    /// Sand the contact displaces, m³ a metre of its way.
    pub displaced_m2: f64,
}

impl Patch {
    /// Untouched sand.
    #[must_use]
    pub fn flat() -> Self {
        Self {
            contact: usize::MAX,
            origin_m: [0.0; 2],
            spacing_m: 1.0,
            base_m: 0.0,
            heights_m: [0.0; PATCH * PATCH],
            displaced_m2: 0.0,
        }
    }

    /// Tests whether it shows the very heights that another shows.
    #[must_use]
    pub fn shows(&self, other: &Self) -> bool {
        self.origin_m == other.origin_m
            && self.spacing_m == other.spacing_m
            && self.base_m == other.base_m
            && self.heights_m == other.heights_m
    }

    /// Height above the untouched surface and slope at a position; level beyond the edge.
    #[must_use]
    pub fn at(&self, position_m: [f64; 2]) -> (f64, [f64; 2]) {
        let axis = |a: usize| {
            let t = (position_m[a] - self.origin_m[a]) / self.spacing_m;
            let inside = t.clamp(1.0, (PATCH - 2) as f64 - 1e-9);
            let slope = if t == inside { 1.0 / self.spacing_m } else { 0.0 };
            (inside as usize - 1, inside - inside.floor(), slope)
        };
        let ((x0, fx, sx), (y0, fy, sy)) = (axis(0), axis(1));
        let ((wx, dx), (wy, dy)) = (spline(fx), spline(fy));
        let (mut height, mut along_u, mut along_v) = (0.0, 0.0, 0.0);
        for j in 0..4 {
            let row = &self.heights_m[(y0 + j) * PATCH + x0..][..4];
            let (mut value, mut slope) = (0.0, 0.0);
            for i in 0..4 {
                value += wx[i] * f64::from(row[i]);
                slope += dx[i] * f64::from(row[i]);
            }
            height += wy[j] * value;
            along_u += wy[j] * slope;
            along_v += dy[j] * value;
        }
        (self.base_m + height, [along_u * sx, along_v * sy])
    }
}

/// Weights and slopes of the cubic B-spline.
#[inline]
fn spline(f: f64) -> ([f64; 4], [f64; 4]) {
    let g = 1.0 - f;
    let (f2, g2) = (f * f, g * g);
    (
        [
            g2 * g / 6.0,
            (4.0 - 6.0 * f2 + 3.0 * f2 * f) / 6.0,
            (4.0 - 6.0 * g2 + 3.0 * g2 * g) / 6.0,
            f2 * f / 6.0,
        ],
        [-0.5 * g2, 1.5 * f2 - 2.0 * f, 2.0 * g - 1.5 * g2, 0.5 * f2],
    )
}
