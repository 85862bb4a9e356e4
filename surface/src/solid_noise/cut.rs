//! The cut of a surface through the block of noise.

/// The plane in which a surface cuts the block of noise: position = origin + u · u_axis + v ·
/// v_axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidCut {
    /// Place of the surface's (0, 0) in the block, metres.
    pub origin_m: [f64; 3],
    /// Direction of u, a unit vector.
    pub u_axis: [f64; 3],
    /// Direction of v, a unit vector perpendicular to `u_axis`.
    pub v_axis: [f64; 3],
}

impl SolidCut {
    /// Along the lattice, through its origin: the document's own use with the tool in the plane z =
    /// 0.
    pub const LATTICE: Self = Self { origin_m: [0.0; 3], u_axis: [1.0, 0.0, 0.0], v_axis: [0.0, 1.0, 0.0] };

    /// At a slant to all lattice axes, so that no straight stroke meets the lattice at regular
    /// intervals: the rotation by 0.62, −0.49 and 0.37 rad about z, y and x. The default.
    pub const SLANTED: Self = Self {
        origin_m: [0.0; 3],
        u_axis: [0.718_111_705_228_247_4, 0.512_666_414_149_871_2, 0.470_625_888_171_158],
        v_axis: [-0.680_225_349_253_427_1, 0.659_917_333_115_655_6, 0.319_065_177_803_187_8],
    };

    /// The cut of a plane of a body into the block that the body is made of: the block lies in the
    /// body as [`Self::SLANTED`] lies in it, so that faces along the body's axes do not meet the
    /// lattice along its own, and every face of a body is cut from the same block.
    ///
    /// `u_axis` and `v_axis` are unit vectors at a right angle.
    #[must_use]
    pub fn of_body(origin_m: [f64; 3], u_axis: [f64; 3], v_axis: [f64; 3]) -> Self {
        Self {
            origin_m: Self::in_body(origin_m),
            u_axis: Self::in_body(u_axis),
            v_axis: Self::in_body(v_axis),
        }
    }

    /// The point of the block at a place of the body that is made of it, or a direction of the
    /// block along one of the body, metres.
    #[inline]
    #[must_use]
    pub fn in_body(place_m: [f64; 3]) -> [f64; 3] {
        let Self { u_axis: x, v_axis: y, .. } = Self::SLANTED;
        let z = Self::SLANTED.normal();
        core::array::from_fn(|a| place_m[0] * x[a] + place_m[1] * y[a] + place_m[2] * z[a])
    }

    /// The unit vector that stands on the surface, u × v.
    #[inline]
    #[must_use]
    pub fn normal(&self) -> [f64; 3] {
        let (u, v) = (self.u_axis, self.v_axis);
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    }

    /// The point of the block under a point of the surface, metres.
    #[inline]
    #[must_use]
    pub fn at(&self, position_m: [f64; 2]) -> [f64; 3] {
        let [u, v] = position_m;
        core::array::from_fn(|a| self.origin_m[a] + u * self.u_axis[a] + v * self.v_axis[a])
    }
}
