//! The operations of [`super::GradientNoise3d::at`] on 8 (AVX2) or 16 (AVX-512) points at once, in
//! the same order, so that the bits are the same.
#![allow(unsafe_code)]

mod point;

use super::{EDGES, MIX, PRIME, Points, ROOT_15, WHOLE};
use crate::simd::{Level, Token};
use core::arch::x86_64::*;

/// Evaluates as many of the first points as fill vectors; returns their number.
pub(super) fn run(level: Level, seed: u32, points: &mut Points<'_>) -> usize {
    let len = points.x.len();
    match level.token() {
        Token::Portable(_) => 0,
        // SAFETY: the token stands for AVX2 and FMA, and all slices of `Points` are equally long,
        // so that whole vectors of points can be read and written.
        Token::Avx2(_) => unsafe {
            avx2::run(seed, points, len & !7);
            len & !7
        },
        // SAFETY: the token stands for AVX-512F; as above.
        Token::Avx512(_) => unsafe {
            avx512::run(seed, points, len & !15);
            len & !15
        },
    }
}

/// One point with its eight corners in the lanes of AVX2, where there is AVX2.
#[inline]
pub(super) fn single(level: Level, seed: u32, [x, y, z]: [f64; 3]) -> Option<super::Noise3> {
    match level.token() {
        Token::Portable(_) => None,
        // SAFETY: either token stands for AVX2 and FMA.
        Token::Avx2(_) | Token::Avx512(_) => Some(unsafe { point::single(seed, x, y, z) }),
    }
}

/// The kernel, written once over the vector operations of the module it is expanded in.
///
/// Gradients have twice their length here, because that takes one byte of a float, and so has all
/// that comes of them; the slopes of the blend have half of theirs. Halved in the end, it is the
/// same bits.
macro_rules! kernel {
    ($feature:literal, $lanes:literal) => {
        /// Blend weight and half its slope, as `blend`.
        #[inline]
        #[target_feature(enable = $feature)]
        fn blend(t: Float) -> (Float, Float) {
            let c = sub(t, splat(0.5));
            let c2 = mul(c, c);
            let curve = fma(c2, fma(splat(6.0), c2, splat(-5.0)), splat(1.875));
            let root = fma(c2, splat(ROOT_15), splat(-0.25 * ROOT_15));
            (fma(c, curve, splat(0.5)), mul(root, root))
        }

        #[inline]
        #[target_feature(enable = $feature)]
        fn lerp(a: Float, difference: Float, weight: Float) -> Float {
            fma(weight, difference, a)
        }

        /// From one to another.
        #[inline]
        #[target_feature(enable = $feature)]
        fn between(near: Float, far: Float, weight: Float) -> Float {
            fma(weight, sub(far, near), near)
        }

        /// Value and slopes from where a point lies in its cell and its eight gradients.
        macro_rules! blended {
            ($fx:ident, $fy:ident, $fz:ident, $gradient:expr) => {{
                let (half, one) = (splat(0.5), splat(1.0));
                let ((sx, tx), (sy, ty), (sz, tz)) = (blend($fx), blend($fy), blend($fz));
                let (dx, dy, dz) = ([$fx, sub($fx, one)], [$fy, sub($fy, one)], [$fz, sub($fz, one)]);
                let none = splat(0.0);
                // Along x and y, near and far along z: components of the gradient, value, slopes.
                let mut planes = [(none, none, none, none, none, none); 2];
                for (c, plane) in planes.iter_mut().enumerate() {
                    let mut rows = [(none, none, none, none, none); 2];
                    for (b, row) in rows.iter_mut().enumerate() {
                        let corner = 2 * b + 4 * c;
                        let g: [Gradient; 2] = [$gradient(corner), $gradient(corner + 1)];
                        let mut dot = [none; 2];
                        for a in 0..2 {
                            dot[a] = fma(g[a].z, dz[c], fma(g[a].y, dy[b], mul(g[a].x, dx[a])));
                        }
                        let difference = sub(dot[1], dot[0]);
                        *row = (
                            between(g[0].x, g[1].x, sx),
                            between(g[0].y, g[1].y, sx),
                            between(g[0].z, g[1].z, sx),
                            lerp(dot[0], difference, sx),
                            difference,
                        );
                    }
                    let [near, far] = rows;
                    let difference = sub(far.3, near.3);
                    *plane = (
                        between(near.0, far.0, sy),
                        between(near.1, far.1, sy),
                        between(near.2, far.2, sy),
                        lerp(near.3, difference, sy),
                        between(near.4, far.4, sy),
                        difference,
                    );
                }
                let [near, far] = planes;
                let (gx, gy, gz) =
                    (between(near.0, far.0, sz), between(near.1, far.1, sz), between(near.2, far.2, sz));
                let nx = between(near.4, far.4, sz);
                let ny = between(near.5, far.5, sz);
                let nz = sub(far.3, near.3);
                let low = near.3;
                [
                    mul(half, lerp(low, nz, sz)),
                    fma(tx, nx, mul(half, gx)),
                    fma(ty, ny, mul(half, gy)),
                    fma(tz, nz, mul(half, gz)),
                ]
            }};
        }

        /// # Safety
        /// `whole` must be a multiple of the lane count and no longer than the slices.
        #[target_feature(enable = $feature)]
        pub(super) unsafe fn run(seed: u32, points: &mut Points<'_>, whole: usize) {
            for start in (0..whole).step_by($lanes) {
                // SAFETY: `start + lanes` ≤ `whole` ≤ length of every slice.
                let ((ix, fx), (iy, fy), (iz, fz)) = unsafe {
                    (
                        split(points.x.as_ptr().add(start)),
                        split(points.y.as_ptr().add(start)),
                        split(points.z.as_ptr().add(start)),
                    )
                };
                let x0 = imul(ix, isplat(PRIME[0]));
                let x = [x0, iadd(x0, isplat(PRIME[0]))];
                let y0 = imul(iy, isplat(PRIME[1]));
                let y = [y0, iadd(y0, isplat(PRIME[1]))];
                let z0 = imul(iz, isplat(PRIME[2]));
                let z = [xor(z0, isplat(seed)), xor(iadd(z0, isplat(PRIME[2])), isplat(seed))];
                let hashed =
                    |corner: usize| gradient(xor(x[corner & 1], xor(y[corner >> 1 & 1], z[corner >> 2])));
                let [value, dx, dy, dz] = blended!(fx, fy, fz, hashed);
                // SAFETY: as for the loads.
                unsafe {
                    store(points.value.as_mut_ptr().add(start), value);
                    store(points.dx.as_mut_ptr().add(start), dx);
                    store(points.dy.as_mut_ptr().add(start), dy);
                    store(points.dz.as_mut_ptr().add(start), dz);
                }
            }
        }
    };
}

/// Short names for vector operations, so that the kernel reads as the formula.
macro_rules! operations {
    ($feature:literal, $float:ty, $int:ty, $($name:ident($($arg:ident: $kind:ty),*) -> $out:ty = $op:ident;)*) => {
        pub(super) type Float = $float;
        pub(super) type Int = $int;
        /// A gradient, doubled.
        #[derive(Clone, Copy)]
        pub(super) struct Gradient {
            pub x: Float,
            pub y: Float,
            pub z: Float,
        }
        $(
            #[inline]
            #[target_feature(enable = $feature)]
            pub(super) fn $name($($arg: $kind),*) -> $out {
                $op($($arg),*)
            }
        )*
    };
}

mod avx2 {
    use super::*;

    operations! { "avx2,fma", __m256, __m256i,
        sub(a: Float, b: Float) -> Float = _mm256_sub_ps;
        mul(a: Float, b: Float) -> Float = _mm256_mul_ps;
        fma(a: Float, b: Float, c: Float) -> Float = _mm256_fmadd_ps;
        splat(a: f32) -> Float = _mm256_set1_ps;
        iadd(a: Int, b: Int) -> Int = _mm256_add_epi32;
        imul(a: Int, b: Int) -> Int = _mm256_mullo_epi32;
        xor(a: Int, b: Int) -> Int = _mm256_xor_si256;
    }
    kernel!("avx2,fma", 8);

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn isplat(a: u32) -> Int {
        _mm256_set1_epi32(a as i32)
    }

    /// # Safety
    /// Eight positions must be readable from `from`.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn split(from: *const f64) -> (Int, Float) {
        // SAFETY: the caller's promise.
        let (a, b) = unsafe { (_mm256_loadu_pd(from), _mm256_loadu_pd(from.add(4))) };
        let whole = |x| _mm256_add_pd(_mm256_sub_pd(x, _mm256_set1_pd(0.5)), _mm256_set1_pd(WHOLE));
        let rest = |x, whole| _mm256_sub_pd(x, _mm256_sub_pd(whole, _mm256_set1_pd(WHOLE)));
        let (wa, wb) = (whole(a), whole(b));
        let low = _mm256_shuffle_ps::<0b10_00_10_00>(_mm256_castpd_ps(wa), _mm256_castpd_ps(wb));
        let cells = _mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_castps_si256(low));
        let (a, b) = (_mm256_cvtpd_ps(rest(a, wa)), _mm256_cvtpd_ps(rest(b, wb)));
        (cells, _mm256_set_m128(b, a))
    }

    /// # Safety
    /// Eight values must be writable at `to`.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn store(to: *mut f32, value: Float) {
        // SAFETY: the caller's promise.
        unsafe { _mm256_storeu_ps(to, value) }
    }

    /// The highest byte of 2 and of −2 for each component of `EDGES`; all other bytes of theirs are
    /// 0.
    const BYTES: [[i8; 16]; 3] = {
        let mut bytes = [[0; 16]; 3];
        let mut edge = 0;
        while edge < 12 {
            let mut axis = 0;
            while axis < 3 {
                bytes[axis][edge] = (EDGES[edge][axis] * 2.0).to_bits().to_be_bytes()[0] as i8;
                axis += 1;
            }
            edge += 1;
        }
        bytes
    };

    /// Twice `EDGES[index]`: the index is brought to the highest byte of a lane, where the shuffle
    /// reads it; indices above 127, in the other bytes, give 0.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn gradient(lattice: Int) -> Gradient {
        let index = _mm256_mulhi_epu16(imul(lattice, isplat(MIX)), isplat((12 << 8) << 16));
        let index = _mm256_or_si256(index, isplat(0x0080_8080));
        let pick = |axis: usize| {
            // SAFETY: sixteen bytes are readable.
            let bytes = unsafe { _mm_loadu_si128(BYTES[axis].as_ptr().cast()) };
            _mm256_castsi256_ps(_mm256_shuffle_epi8(_mm256_broadcastsi128_si256(bytes), index))
        };
        Gradient { x: pick(0), y: pick(1), z: pick(2) }
    }
}

mod avx512 {
    use super::*;

    operations! { "avx512f", __m512, __m512i,
        sub(a: Float, b: Float) -> Float = _mm512_sub_ps;
        mul(a: Float, b: Float) -> Float = _mm512_mul_ps;
        fma(a: Float, b: Float, c: Float) -> Float = _mm512_fmadd_ps;
        splat(a: f32) -> Float = _mm512_set1_ps;
        iadd(a: Int, b: Int) -> Int = _mm512_add_epi32;
        imul(a: Int, b: Int) -> Int = _mm512_mullo_epi32;
        xor(a: Int, b: Int) -> Int = _mm512_xor_si512;
    }
    kernel!("avx512f", 16);

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn isplat(a: u32) -> Int {
        _mm512_set1_epi32(a as i32)
    }

    /// # Safety
    /// Sixteen positions must be readable from `from`.
    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn split(from: *const f64) -> (Int, Float) {
        // SAFETY: the caller's promise.
        let (a, b) = unsafe { (_mm512_loadu_pd(from), _mm512_loadu_pd(from.add(8))) };
        let whole = |x| _mm512_add_pd(_mm512_sub_pd(x, _mm512_set1_pd(0.5)), _mm512_set1_pd(WHOLE));
        let rest = |x, whole| _mm512_sub_pd(x, _mm512_sub_pd(whole, _mm512_set1_pd(WHOLE)));
        let (wa, wb) = (whole(a), whole(b));
        let low = |whole| _mm512_castsi256_si512(_mm512_cvtepi64_epi32(_mm512_castpd_si512(whole)));
        let cells = _mm512_inserti64x4::<1>(low(wa), _mm512_castsi512_si256(low(wb)));
        let a = _mm512_castpd256_pd512(_mm256_castps_pd(_mm512_cvtpd_ps(rest(a, wa))));
        let b = _mm256_castps_pd(_mm512_cvtpd_ps(rest(b, wb)));
        (cells, _mm512_castpd_ps(_mm512_insertf64x4::<1>(a, b)))
    }

    /// # Safety
    /// Sixteen values must be writable at `to`.
    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn store(to: *mut f32, value: Float) {
        // SAFETY: the caller's promise.
        unsafe { _mm512_storeu_ps(to, value) }
    }

    /// One component of twice `EDGES`.
    const fn doubled(axis: usize) -> [f32; 16] {
        let mut all = [0.0; 16];
        let mut edge = 0;
        while edge < 12 {
            all[edge] = 2.0 * EDGES[edge][axis];
            edge += 1;
        }
        all
    }
    const DOUBLED: [[f32; 16]; 3] = [doubled(0), doubled(1), doubled(2)];

    /// Twice `EDGES[index]`, from registers.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn gradient(lattice: Int) -> Gradient {
        let mixed = imul(lattice, isplat(MIX));
        let index = _mm512_srli_epi32::<16>(imul(_mm512_srli_epi32::<16>(mixed), isplat(12)));
        let pick = |axis: usize| {
            // SAFETY: sixteen floats are readable.
            let table = unsafe { _mm512_loadu_ps(DOUBLED[axis].as_ptr()) };
            _mm512_permutexvar_ps(index, table)
        };
        Gradient { x: pick(0), y: pick(1), z: pick(2) }
    }
}
