//! The cut of a surface through the block of noise.

/// The plane in which a surface cuts the block of noise: position = origin + u · u_axis + v · v_axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidCut {
    /// Where (0, 0) of the surface lies in the block, metres.
    pub origin_m: [f64; 3],
    /// Direction of u, a unit vector.
    pub u_axis: [f64; 3],
    /// Direction of v, a unit vector perpendicular to `u_axis`.
    pub v_axis: [f64; 3],
}

impl SolidCut {
    /// Along the lattice, through its origin: the document's own use with the tool in the plane z = 0.
    pub const LATTICE: Self = Self { origin_m: [0.0; 3], u_axis: [1.0, 0.0, 0.0], v_axis: [0.0, 1.0, 0.0] };

    /// At a slant to all lattice axes, so that no straight stroke meets the lattice at regular
    /// intervals: the rotation by 0.62, −0.49 and 0.37 rad about z, y and x. The default.
    pub const SLANTED: Self = Self {
        origin_m: [0.0; 3],
        u_axis: [0.718_111_705_228_247_4, 0.512_666_414_149_871_2, 0.470_625_888_171_158],
        v_axis: [-0.680_225_349_253_427_1, 0.659_917_333_115_655_6, 0.319_065_177_803_187_8],
    };

    /// The point of the block under a point of the surface, metres.
    #[inline]
    #[must_use]
    pub fn at(&self, position_m: [f64; 2]) -> [f64; 3] {
        let [u, v] = position_m;
        core::array::from_fn(|a| self.origin_m[a] + u * self.u_axis[a] + v * self.v_axis[a])
    }
}
