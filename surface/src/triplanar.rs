//! Places on a surface for bodies that have no uv of their own: three planar projections, and one
//! path among them.
//!
//! ```text
//! plane x: uv = (y, z)    plane y: uv = (z, x)    plane z: uv = (x, y)        body coordinates, m
//! w_i = (|n_i| − δ)₊^k / Σ                       weights from the surface's normal n
//! ```
//! Source: the texture-analysis thesis §4.2.3.1 (planar multiple projection: a triangle belongs to
//! the plane its normal is nearest to, sign left aside), which names its own fault: the texture
//! jumps where the plane changes. What we changed:
//!
//! - [`planes`] gives all three places with weights that fade from one to the next, for those who
//!   read heights three times and add them.
//! - [`TriplanarPath`] gives one place, for contact events, which have one. It keeps its plane
//!   until another is clearly nearer ([`HOLD`]), so that a normal that trembles at 45° does not
//!   switch at every report, and goes on *from where it is* on the new plane: an offset takes up
//!   the difference. So uv never jumps along a contact's path, at the price that the far side of an
//!   edge feels another part of the surface when it is reached another way. Blended heights have no
//!   such price but cost three readings and flatten the relief by up to √3 where three planes meet.
//!
//! A plane sees a slanted surface shortened: by up to 1/√2 across an edge, 1/√3 at a corner, and a
//! little more while a plane is held. The offset of [`TriplanarPath`] does not undo that.

use asperity_dsp::DesignError;

/// Normal components up to this share of the largest have no weight, so that flat faces read one
/// plane.
pub const DELTA: f64 = 0.3;

/// Exponent k of the weights: higher is a narrower fade.
pub const SHARPNESS: i32 = 4;

/// Another plane is taken when its normal component exceeds that of the current one by this factor:
/// 5° past the diagonal.
pub const HOLD: f64 = 1.2;

/// A planar projection of a point of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// The axis the plane is perpendicular to: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Place on the plane, in widths and heights of the surface.
    pub uv: [f64; 2],
    /// Its share of a blend, 0–1; the three add up to 1.
    pub weight: f64,
}

/// The three projections of a point with the surface normal `normal` (any length, any sign; without
/// a direction all three count alike), on a surface of `size_m` = (width, height).
///
/// ```
/// use asperity_surface::triplanar::planes;
///
/// // The top of a crate, 0.1 m of texture a repeat: only the plane z counts.
/// let seen = planes([0.25, 0.1, 0.4], [0.0, 0.0, 1.0], [0.1, 0.1]);
/// assert_eq!(seen.map(|plane| plane.weight), [0.0, 0.0, 1.0]);
/// assert_eq!(seen[2].uv, [2.5, 1.0]);
/// ```
#[must_use]
pub fn planes(position_m: [f64; 3], normal: [f64; 3], size_m: [f64; 2]) -> [Plane; 3] {
    let along = normal.map(f64::abs);
    let largest = along.into_iter().fold(0.0, f64::max);
    let usable = largest > 0.0 && largest.is_finite();
    let raw = along.map(|n| if usable { (n / largest - DELTA).max(0.0).powi(SHARPNESS) } else { 1.0 });
    let sum: f64 = raw.iter().sum();
    [0, 1, 2].map(|axis| Plane { axis, uv: projected(axis, position_m, size_m), weight: raw[axis] / sum })
}

/// Place on the plane across `axis`.
fn projected(axis: usize, vector: [f64; 3], size_m: [f64; 2]) -> [f64; 2] {
    [vector[(axis + 1) % 3] / size_m[0], vector[(axis + 2) % 3] / size_m[1]]
}

/// Place and movement of a contact on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Place, in widths and heights of the surface, as contact events have it; not wrapped.
    pub uv: [f64; 2],
    /// Tangential velocity along u and v, m/s.
    pub velocity_m_s: [f64; 2],
}

/// The path of one contact over a body without uv. Keep one a contact; begin a new one with each
/// touch.
///
/// ```
/// use asperity_surface::triplanar::TriplanarPath;
///
/// // A finger slides off the top of a crate and down its side: uv goes on without a jump.
/// let mut path = TriplanarPath::new([0.1, 0.1])?;
/// let top = path.at([0.5, 0.2, 0.4], [0.1, 0.0, 0.0], [0.0, 0.0, 1.0]);
/// let side = path.at([0.5, 0.2, 0.4], [0.0, 0.0, -0.1], [1.0, 0.0, 0.0]);
/// assert_eq!(top.uv, side.uv);
/// assert_eq!(side.velocity_m_s, [0.0, -0.1]);
/// # Ok::<(), asperity_dsp::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TriplanarPath {
    size_m: [f64; 2],
    plane: Option<usize>,
    /// Offset added to the plane's own uv.
    offset: [f64; 2],
}

impl TriplanarPath {
    /// A path on a surface of (width, height) `size_m`, each above 0.
    ///
    /// # Errors
    /// When a size is not above 0 or not finite.
    pub fn new(size_m: [f64; 2]) -> Result<Self, DesignError> {
        for (field, size) in ["width_m", "height_m"].into_iter().zip(size_m) {
            DesignError::check(field, size, "above 0", |s| s > 0.0 && s.is_finite())?;
        }
        Ok(Self { size_m, plane: None, offset: [0.0; 2] })
    }

    /// The plane the path is on, once it has begun: 0, 1, 2 for x, y, z.
    #[must_use]
    pub fn plane(&self) -> Option<usize> {
        self.plane
    }

    /// The next point of the path: position and velocity in body coordinates (m, m/s) and the
    /// surface normal there (any length, any sign). Where the plane changes, the step since the
    /// last point is made on the old one.
    pub fn at(&mut self, position_m: [f64; 3], velocity_m_s: [f64; 3], normal: [f64; 3]) -> SurfacePoint {
        let nearest = self.nearest(normal);
        let held = *self.plane.get_or_insert(nearest);
        if nearest != held {
            let (old, new) =
                (projected(held, position_m, self.size_m), projected(nearest, position_m, self.size_m));
            self.offset = [0, 1].map(|k| self.offset[k] + old[k] - new[k]);
            self.plane = Some(nearest);
        }
        let own = projected(nearest, position_m, self.size_m);
        SurfacePoint {
            uv: [0, 1].map(|k| own[k] + self.offset[k]),
            velocity_m_s: projected(nearest, velocity_m_s, [1.0; 2]),
        }
    }

    /// The plane for a normal: the current one until another is clearly nearer.
    fn nearest(&self, normal: [f64; 3]) -> usize {
        let along = |axis: usize| {
            let favour = if self.plane == Some(axis) { HOLD } else { 1.0 };
            favour * normal[axis].abs()
        };
        // A normal without a direction, or a number that is none, leaves the plane as it is.
        let start = self.plane.unwrap_or(2);
        (0..3).fold(start, |best, axis| if along(axis) > along(best) { axis } else { best })
    }
}
