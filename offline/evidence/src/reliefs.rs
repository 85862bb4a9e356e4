//! The six reliefs of the thesis' first experiment (§8.3): spheres, ovals and quads, 6 or 8 a row.
//!
//! Their pictures are printed, not their files: shapes and heights are read from the pictures.

/// Shapes of the elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Segments of spheres.
    Spheres,
    /// Segments of ovals, every second row moved by half.
    Ovals,
    /// Blocks with a rounded edge.
    Quads,
}

/// Every shape.
pub const SHAPES: [Shape; 3] = [Shape::Spheres, Shape::Ovals, Shape::Quads];

/// A relief of so many texels a side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relief {
    /// Its elements.
    pub shape: Shape,
    /// Elements a row.
    pub across: f64,
    /// Texels a side.
    pub size: usize,
}

impl Relief {
    fn period(&self) -> f64 {
        self.size as f64 / self.across
    }

    /// Height of a row of elements, texels: 55 ovals on the area of 36 squares, 85 on that of 64,
    /// are ten rows.
    fn row(&self) -> f64 {
        let ovals = if self.across < 7.0 { 0.6 } else { 0.8 };
        self.period() * if self.shape == Shape::Ovals { ovals } else { 1.0 }
    }

    /// Height of a texel, in texels.
    #[must_use]
    pub fn height(&self, x: usize, y: usize) -> f64 {
        let (period, row) = (self.period(), self.row());
        let down = (y as f64 + 0.5) / row;
        let shift = if self.shape == Shape::Ovals && down.floor() as i64 % 2 == 1 { 0.5 } else { 0.0 };
        let along = (x as f64 + 0.5) / period + shift;
        let (u, v) = ((along - along.floor() - 0.5) * period, (down - down.floor() - 0.5) * row);
        match self.shape {
            Shape::Spheres => cap(u.hypot(v), 0.45 * period),
            Shape::Ovals => cap((u * row / period).hypot(v), 0.45 * row),
            Shape::Quads => bevel(square_distance(u, v, 0.42 * period, 0.1 * period), 0.42 * period),
        }
    }

    /// Translations that leave it as it is, texels.
    #[must_use]
    pub fn translations(&self) -> [[f64; 2]; 2] {
        let (period, row) = (self.period(), self.row());
        match self.shape {
            Shape::Ovals => [[period, 0.0], [0.5 * period, row]],
            _ => [[period, 0.0], [0.0, period]],
        }
    }
}

/// Distance of the rounded square's own shape from its centre: `half` on its border.
#[must_use]
pub fn square_distance(x: f64, y: f64, half: f64, radius: f64) -> f64 {
    let (u, v) = (x.abs() - (half - radius), y.abs() - (half - radius));
    let outside = u.max(0.0).hypot(v.max(0.0)) + u.max(v).min(0.0);
    half + outside - radius
}

/// A segment of a sphere: 0 beyond `radius`.
fn cap(r: f64, radius: f64) -> f64 {
    let full = 1.2 * radius;
    let above = |r: f64| (full * full - r * r).sqrt() - (full * full - radius * radius).sqrt();
    if r < radius { above(r) } else { 0.0 }
}

/// A block with a rounded edge.
fn bevel(distance: f64, half: f64) -> f64 {
    let width = 0.15 * half;
    let inside = ((half - distance) / width).clamp(0.0, 1.0);
    2.0 * width * (1.0 - (1.0 - inside) * (1.0 - inside)).sqrt()
}
