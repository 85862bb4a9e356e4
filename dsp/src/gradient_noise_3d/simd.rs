//! The operations of [`super::GradientNoise3d::at`] on 8 (AVX2) or 16 (AVX-512) points at once, in
//! the same order and without fused multiply–add, so that the bits are the same.
#![allow(unsafe_code)]

use super::{MIX, PRIME, Points};

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

/// Evaluates the first multiple of 8 points; returns their number.
pub(super) fn run_avx2(seed: u32, points: &mut Points<'_>) -> usize {
    let whole = points.x.len() & !7;
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2 (checked above; the check is a cached load), and all slices
        // of `Points` are equally long, so that `whole` points can be read and written.
        unsafe { avx2::run(seed, points, whole) };
        whole
    } else {
        0
    }
}

/// Evaluates the first multiple of 16 points; returns their number.
pub(super) fn run_avx512(seed: u32, points: &mut Points<'_>) -> usize {
    let whole = points.x.len() & !15;
    if std::arch::is_x86_feature_detected!("avx512f") {
        // SAFETY: the processor has AVX-512F (checked above; the check is a cached load), and all
        // slices of `Points` are equally long, so that `whole` points can be read and written.
        unsafe { avx512::run(seed, points, whole) };
        whole
    } else {
        0
    }
}

/// The kernel, written once over the vector operations of the module it is expanded in.
macro_rules! kernel {
    ($feature:literal, $lanes:literal) => {
        /// Blend weight and its slope, as `blend` and `blend_slope`.
        #[inline]
        #[target_feature(enable = $feature)]
        fn blend(t: Float) -> (Float, Float) {
            let c = sub(t, splat(0.5));
            let c2 = mul(c, c);
            let curve = add(mul(c2, sub(mul(splat(6.0), c2), splat(5.0))), splat(1.875));
            let rest = sub(c2, splat(0.25));
            (add(mul(c, curve), splat(0.5)), mul(splat(30.0), mul(rest, rest)))
        }

        #[inline]
        #[target_feature(enable = $feature)]
        fn lerp(a: Float, difference: Float, weight: Float) -> Float {
            add(a, mul(weight, difference))
        }

        /// # Safety
        /// `whole` must be a multiple of the lane count and no longer than the slices.
        #[target_feature(enable = $feature)]
        pub(super) unsafe fn run(seed: u32, points: &mut Points<'_>, whole: usize) {
            let one = splat(1.0);
            for start in (0..whole).step_by($lanes) {
                // SAFETY: `start + lanes` ≤ `whole` ≤ length of every slice.
                let ((ix, fx), (iy, fy), (iz, fz)) = unsafe {
                    (
                        split(points.x.as_ptr().add(start)),
                        split(points.y.as_ptr().add(start)),
                        split(points.z.as_ptr().add(start)),
                    )
                };
                let ((sx, tx), (sy, ty), (sz, tz)) = (blend(fx), blend(fy), blend(fz));
                let x0 = imul(ix, isplat(PRIME[0]));
                let x = [x0, iadd(x0, isplat(PRIME[0]))];
                let y0 = imul(iy, isplat(PRIME[1]));
                let y = [y0, iadd(y0, isplat(PRIME[1]))];
                let z0 = imul(iz, isplat(PRIME[2]));
                let z = [xor(z0, isplat(seed)), xor(iadd(z0, isplat(PRIME[2])), isplat(seed))];
                let (dx, dy, dz) = ([fx, sub(fx, one)], [fy, sub(fy, one)], [fz, sub(fz, one)]);
                let (wx, wy, wz) = ([sub(one, sx), sx], [sub(one, sy), sy], [sub(one, sz), sz]);

                let mut dot = [splat(0.0); 8];
                let (mut gx, mut gy, mut gz) = (splat(0.0), splat(0.0), splat(0.0));
                for c in 0..2 {
                    for b in 0..2 {
                        let (lattice_yz, weight_yz) = (xor(y[b], z[c]), mul(wy[b], wz[c]));
                        for a in 0..2 {
                            let g = gradient(xor(x[a], lattice_yz));
                            dot[a + 2 * b + 4 * c] =
                                add(add(mul(g.0, dx[a]), mul(g.1, dy[b])), mul(g.2, dz[c]));
                            let weight = mul(wx[a], weight_yz);
                            gx = add(gx, mul(weight, g.0));
                            gy = add(gy, mul(weight, g.1));
                            gz = add(gz, mul(weight, g.2));
                        }
                    }
                }
                let (x00, x10) = (sub(dot[1], dot[0]), sub(dot[3], dot[2]));
                let (x01, x11) = (sub(dot[5], dot[4]), sub(dot[7], dot[6]));
                let (v00, v10) = (lerp(dot[0], x00, sx), lerp(dot[2], x10, sx));
                let (v01, v11) = (lerp(dot[4], x01, sx), lerp(dot[6], x11, sx));
                let (y0, y1) = (sub(v10, v00), sub(v11, v01));
                let (low, high) = (lerp(v00, y0, sy), lerp(v01, y1, sy));
                let (x0, x1) = (lerp(x00, sub(x10, x00), sy), lerp(x01, sub(x11, x01), sy));
                let nx = lerp(x0, sub(x1, x0), sz);
                let ny = lerp(y0, sub(y1, y0), sz);
                let nz = sub(high, low);
                // SAFETY: as for the loads.
                unsafe {
                    store(points.value.as_mut_ptr().add(start), lerp(low, nz, sz));
                    store(points.dx.as_mut_ptr().add(start), add(gx, mul(tx, nx)));
                    store(points.dy.as_mut_ptr().add(start), add(gy, mul(ty, ny)));
                    store(points.dz.as_mut_ptr().add(start), add(gz, mul(tz, nz)));
                }
            }
        }
    };
}

/// Short names for vector operations, so that the kernel reads as the formula.
macro_rules! operations {
    ($feature:literal, $float:ty, $int:ty, $($name:ident($($arg:ident: $kind:ty),*) -> $out:ty = $op:ident;)*) => {
        type Float = $float;
        type Int = $int;
        $(
            #[inline]
            #[target_feature(enable = $feature)]
            fn $name($($arg: $kind),*) -> $out {
                $op($($arg),*)
            }
        )*
    };
}

mod avx2 {
    use super::*;

    operations! { "avx2", __m256, __m256i,
        add(a: Float, b: Float) -> Float = _mm256_add_ps;
        sub(a: Float, b: Float) -> Float = _mm256_sub_ps;
        mul(a: Float, b: Float) -> Float = _mm256_mul_ps;
        splat(a: f32) -> Float = _mm256_set1_ps;
        iadd(a: Int, b: Int) -> Int = _mm256_add_epi32;
        imul(a: Int, b: Int) -> Int = _mm256_mullo_epi32;
        xor(a: Int, b: Int) -> Int = _mm256_xor_si256;
    }
    kernel!("avx2", 8);

    #[inline]
    #[target_feature(enable = "avx2")]
    fn isplat(a: u32) -> Int {
        _mm256_set1_epi32(a as i32)
    }

    /// # Safety
    /// Eight positions must be readable from `from`.
    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn split(from: *const f64) -> (Int, Float) {
        // SAFETY: the caller's promise.
        let (a, b) = unsafe { (_mm256_loadu_pd(from), _mm256_loadu_pd(from.add(4))) };
        let (fa, fb) = (_mm256_floor_pd(a), _mm256_floor_pd(b));
        let cells = _mm256_set_m128i(_mm256_cvttpd_epi32(fb), _mm256_cvttpd_epi32(fa));
        let (a, b) = (_mm256_cvtpd_ps(_mm256_sub_pd(a, fa)), _mm256_cvtpd_ps(_mm256_sub_pd(b, fb)));
        (cells, _mm256_set_m128(b, a))
    }

    /// # Safety
    /// Eight values must be writable at `to`.
    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn store(to: *mut f32, value: Float) {
        // SAFETY: the caller's promise.
        unsafe { _mm256_storeu_ps(to, value) }
    }

    /// `GRADIENTS[gradient_index(lattice)]`: the even entry of the pair from a register, its sign
    /// from the lowest bit of the index.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn gradient(lattice: Int) -> (Float, Float, Float) {
        let mixed = imul(xor(lattice, _mm256_srli_epi32::<15>(lattice)), isplat(MIX));
        let index = _mm256_mulhi_epu16(mixed, isplat(12 << 16));
        let pair = _mm256_srli_epi32::<17>(index);
        let sign = _mm256_castsi256_ps(_mm256_slli_epi32::<15>(index));
        let x = _mm256_setr_ps(1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0);
        let y = _mm256_setr_ps(1.0, -1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0);
        let z = _mm256_setr_ps(0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0, 0.0);
        (
            _mm256_xor_ps(_mm256_permutevar8x32_ps(x, pair), sign),
            _mm256_xor_ps(_mm256_permutevar8x32_ps(y, pair), sign),
            _mm256_xor_ps(_mm256_permutevar8x32_ps(z, pair), sign),
        )
    }
}

mod avx512 {
    use super::*;

    operations! { "avx512f", __m512, __m512i,
        add(a: Float, b: Float) -> Float = _mm512_add_ps;
        sub(a: Float, b: Float) -> Float = _mm512_sub_ps;
        mul(a: Float, b: Float) -> Float = _mm512_mul_ps;
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
        let fa = _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a);
        let fb = _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(b);
        let cells =
            _mm512_inserti64x4::<1>(_mm512_castsi256_si512(_mm512_cvttpd_epi32(fa)), _mm512_cvttpd_epi32(fb));
        let a = _mm512_castpd256_pd512(_mm256_castps_pd(_mm512_cvtpd_ps(_mm512_sub_pd(a, fa))));
        let b = _mm256_castps_pd(_mm512_cvtpd_ps(_mm512_sub_pd(b, fb)));
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

    /// `GRADIENTS[gradient_index(lattice)]`, one register a component.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn gradient(lattice: Int) -> (Float, Float, Float) {
        let mixed = imul(xor(lattice, _mm512_srli_epi32::<15>(lattice)), isplat(MIX));
        let index = _mm512_srli_epi32::<16>(imul(_mm512_srli_epi32::<16>(mixed), isplat(12)));
        let (o, n, l, m) = (0.0, -0.0, 1.0, -1.0);
        let x = _mm512_setr_ps(l, m, l, m, l, m, l, m, o, n, o, n, o, o, o, o);
        let y = _mm512_setr_ps(l, m, m, l, o, n, o, n, l, m, l, m, o, o, o, o);
        let z = _mm512_setr_ps(o, n, o, n, l, m, m, l, l, m, m, l, o, o, o, o);
        (_mm512_permutexvar_ps(index, x), _mm512_permutexvar_ps(index, y), _mm512_permutexvar_ps(index, z))
    }
}
