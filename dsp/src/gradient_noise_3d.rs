//! Three-dimensional gradient noise with its exact gradient, one octave: what solid noise adds up.
//!
//! ```text
//! n(p) = Σ_c w_c(f) · g_c · (f − c)         f = p − ⌊p⌋,  c ∈ {0,1}³,  w_c = Π s(f_a) or 1 − s(f_a)
//! ∇n  = Σ_c w_c g_c + Σ_c ∇w_c (g_c · (f − c))          s(t) = t³ (t (6t − 15) + 10)
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | p | positions in lattice cells, `f64`: a cell index of 32 bits and a fraction rounded to `f32` |
//! | g_c | one of the 12 vectors to the edges of a cube, (±1, ±1, 0) and its permutations, all equally likely |
//! | n, ∇n | [`Noise3::value`], [`Noise3::gradient`] (per cell) |
//!
//! Source: the solid-noise paper takes its noise from libnoise, which is K. Perlin's of 1985; the
//! twelve gradients and the quintic blend are those of K. Perlin, "Improving Noise" (2002), because
//! the cubic blend's jump of curvature at cell borders is felt as a click per cell. What we
//! changed: lattice hashing needs no table (three odd multipliers, exclusive or, one mixing
//! multiplication), so that a batch runs in vector registers; the gradient is delivered with the
//! value.
//!
//! Properties, all tested: exactly zero at lattice points; range ±1 and rms 0.27; a traverse has
//! half of its power density left at 0.59 cycles per cell and 90 % of its energy below 0.66. Every
//! path of evaluation (one point, portable batch, AVX2, AVX-512) performs the same `f32` operations
//! in the same order, fused multiply–adds included, so that all give the same bits on every machine
//! (a processor without that instruction computes it in software, several times slower).
//!
//! Cells are numbered with 32 bits: after 2³² of them (170 km at 0.04 mm) the noise repeats. Beyond
//! 2⁵¹ cells, numbers in `f64` have no fraction left to speak of.

use crate::rng::hash_u32;
use crate::simd::Level;

#[cfg(target_arch = "x86_64")]
mod simd;

const PRIME: [u32; 3] = [0x9E37_79B1, 0x85EB_CA77, 0xC2B2_AE3D];
const MIX: u32 = 0x27D4_EB2F;

/// The edge vectors, each beside its opposite.
const EDGES: [[f32; 3]; 12] = [
    [1.0, 1.0, 0.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, 1.0],
];

/// Noise at one point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise3 {
    /// Value, about −1 to 1.
    pub value: f32,
    /// Derivatives along the three axes, per cell.
    pub gradient: [f32; 3],
}

/// Noise along a path, one slice a quantity; see [`GradientNoise3d::batch`].
#[derive(Debug)]
pub struct Noise3Batch<'a> {
    /// Values.
    pub value: &'a mut [f32],
    /// Derivatives along the first axis, per cell.
    pub dx: &'a mut [f32],
    /// Derivatives along the second axis, per cell.
    pub dy: &'a mut [f32],
    /// Derivatives along the third axis, per cell.
    pub dz: &'a mut [f32],
}

/// A noise lattice: a seed, and how batches are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GradientNoise3d {
    seed: u32,
    level: Level,
}

impl GradientNoise3d {
    /// A lattice that depends on all 64 bits of the seed.
    ///
    /// ```
    /// use asperity_dsp::gradient_noise_3d::GradientNoise3d;
    ///
    /// // Zero at the corners of its cells, with a slope there.
    /// let noise = GradientNoise3d::new(7).at([2.0, -3.0, 5.0]);
    /// assert!(noise.value == 0.0 && noise.gradient != [0.0; 3]);
    /// ```
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let seed = hash_u32(seed as u32) ^ hash_u32((seed >> 32) as u32).rotate_left(16);
        Self { seed, level: Level::detect() }
    }

    /// Lattice evaluated with other instructions; the bits stay.
    #[must_use]
    pub fn on(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// The 32 bits that enter the hash of every lattice point.
    #[must_use]
    pub fn seed(&self) -> u32 {
        self.seed
    }

    /// Instructions that evaluate batches.
    #[must_use]
    pub fn level(&self) -> Level {
        self.level
    }

    /// Value and gradient at one point, given in cells.
    #[inline]
    #[must_use]
    pub fn at(&self, cells: [f64; 3]) -> Noise3 {
        #[cfg(target_arch = "x86_64")]
        if let Some(noise) = simd::single(self.level, self.seed, cells) {
            return noise;
        }
        self.portable(cells)
    }

    /// The definition: eight corners one after another.
    fn portable(&self, cells: [f64; 3]) -> Noise3 {
        let ((ix, fx), (iy, fy), (iz, fz)) = (split(cells[0]), split(cells[1]), split(cells[2]));
        let ((sx, tx), (sy, ty), (sz, tz)) = (blend(fx), blend(fy), blend(fz));
        let (x0, y0, z0) = (ix.wrapping_mul(PRIME[0]), iy.wrapping_mul(PRIME[1]), iz.wrapping_mul(PRIME[2]));
        let x = [x0, x0.wrapping_add(PRIME[0])];
        let y = [y0, y0.wrapping_add(PRIME[1])];
        let z = [z0 ^ self.seed, z0.wrapping_add(PRIME[2]) ^ self.seed];
        let (dx, dy, dz) = ([fx, fx - 1.0], [fy, fy - 1.0], [fz, fz - 1.0]);

        let edge: [&[f32; 3]; 8] =
            core::array::from_fn(|c| gradient(x[c & 1] ^ (y[(c >> 1) & 1] ^ z[c >> 2])));
        let dot: [f32; 8] = core::array::from_fn(|c| {
            let (a, b, c, g) = (c & 1, (c >> 1) & 1, c >> 2, edge[c]);
            fma(g[2], dz[c], fma(g[1], dy[b], g[0] * dx[a]))
        });
        // The gradients are blended like the values.
        let sum: [f32; 3] = core::array::from_fn(|i| {
            let along_x = |c: usize| fma(sx, edge[c + 1][i] - edge[c][i], edge[c][i]);
            let along_y = |near: f32, far: f32| fma(sy, far - near, near);
            let (low, high) = (along_y(along_x(0), along_x(2)), along_y(along_x(4), along_x(6)));
            fma(sz, high - low, low)
        });
        let along_x = [dot[1] - dot[0], dot[3] - dot[2], dot[5] - dot[4], dot[7] - dot[6]];
        let v: [f32; 4] = core::array::from_fn(|i| fma(sx, along_x[i], dot[2 * i]));
        let along_y = [v[1] - v[0], v[3] - v[2]];
        let (low, high) = (fma(sy, along_y[0], v[0]), fma(sy, along_y[1], v[2]));
        let x_near = fma(sy, along_x[1] - along_x[0], along_x[0]);
        let x_far = fma(sy, along_x[3] - along_x[2], along_x[2]);
        let nx = fma(sz, x_far - x_near, x_near);
        let ny = fma(sz, along_y[1] - along_y[0], along_y[0]);
        let nz = high - low;
        Noise3 {
            value: fma(sz, nz, low),
            gradient: [fma(tx, nx, sum[0]), fma(ty, ny, sum[1]), fma(tz, nz, sum[2])],
        }
    }

    /// Value and gradient at many points, given in cells, one slice an axis. As many points are
    /// evaluated as the shortest slice has entries.
    pub fn batch(&self, x: &[f64], y: &[f64], z: &[f64], out: &mut Noise3Batch<'_>) {
        let n = [x.len(), y.len(), z.len(), out.value.len(), out.dx.len(), out.dy.len(), out.dz.len()]
            .into_iter()
            .fold(usize::MAX, usize::min);
        #[cfg_attr(not(target_arch = "x86_64"), allow(unused_mut))] // Vectors of points are x86 only.
        let mut points = Points {
            x: &x[..n],
            y: &y[..n],
            z: &z[..n],
            value: &mut out.value[..n],
            dx: &mut out.dx[..n],
            dy: &mut out.dy[..n],
            dz: &mut out.dz[..n],
        };
        #[cfg(target_arch = "x86_64")]
        let done = simd::run(self.level, self.seed, &mut points);
        #[cfg(not(target_arch = "x86_64"))]
        let done = 0;
        for i in done..n {
            let noise = self.at([points.x[i], points.y[i], points.z[i]]);
            points.value[i] = noise.value;
            [points.dx[i], points.dy[i], points.dz[i]] = noise.gradient;
        }
    }
}

/// Equally long slices of one batch.
struct Points<'a> {
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
    value: &'a mut [f32],
    dx: &'a mut [f32],
    dy: &'a mut [f32],
    dz: &'a mut [f32],
}

/// Added to a number, leaves its whole part, rounded to nearest and even, in the low 32 bits.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Cell index and fraction. On a border between cells either of them does: the fraction is 0 or 1.
#[inline]
fn split(x: f64) -> (u32, f32) {
    let whole = (x - 0.5) + WHOLE;
    (whole.to_bits() as u32, (x - (whole - WHOLE)) as f32)
}

/// The gradient of a lattice point.
#[inline]
fn gradient(lattice: u32) -> &'static [f32; 3] {
    let index = ((lattice.wrapping_mul(MIX) >> 16) * 12) >> 16;
    &EDGES[index as usize]
}

/// √15, and a quarter of it: 30 (c² − ¼)² = 2 (√15 c² − √15/4)².
const ROOT_15: f32 = 3.872_983_3;

/// Quintic blend about the middle of the cell, ½ + c (15/8 − c² (5 − 6 c²)), and its slope 30 (c² −
/// ¼)²: exact at both ends, and eight times closer to the true curve in `f32` than the usual form,
/// whose 10 − 9 cancels.
#[inline]
fn blend(t: f32) -> (f32, f32) {
    let c = t - 0.5;
    let c2 = c * c;
    let curve = fma(c2, fma(6.0, c2, -5.0), 1.875);
    let root = fma(c2, ROOT_15, -0.25 * ROOT_15);
    (fma(c, curve, 0.5), 2.0 * (root * root))
}

/// a · b + c, rounded once.
#[inline]
fn fma(a: f32, b: f32, c: f32) -> f32 {
    #[cfg(any(feature = "std", test))]
    return a.mul_add(b, c);
    #[cfg(not(any(feature = "std", test)))]
    return libm::fmaf(a, b, c);
}
