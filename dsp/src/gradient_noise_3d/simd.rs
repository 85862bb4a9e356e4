//! The operations of [`super::GradientNoise3d::at`] on 8 (AVX2) or 16 (AVX-512) points at once, in
//! the same order, so that the bits are the same.
#![allow(unsafe_code)]

use super::{MIX, PRIME, Points};

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

/// Evaluates the first multiple of 8 points; returns their number.
pub(super) fn run_avx2(seed: u32, points: &mut Points<'_>) -> usize {
    let whole = points.x.len() & !7;
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has AVX2 and FMA (checked above; the check is a cached load), and all slices
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

/// One point with its eight corners in the lanes of AVX2; call only when the kernel was detected.
#[inline]
pub(super) fn single(seed: u32, x: f64, y: f64, z: f64) -> super::Noise3 {
    // SAFETY: `GradientNoise3d` holds a vector kernel only when the processor has it, and every
    // processor with AVX-512F has AVX2 and FMA.
    unsafe { avx2::single(seed, x, y, z) }
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
            let curve = fma(c2, fma(splat(6.0), c2, splat(-5.0)), splat(1.875));
            let rest = sub(c2, splat(0.25));
            (fma(c, curve, splat(0.5)), mul(splat(30.0), mul(rest, rest)))
        }

        #[inline]
        #[target_feature(enable = $feature)]
        fn lerp(a: Float, difference: Float, weight: Float) -> Float {
            fma(weight, difference, a)
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
                let mut sums = [(splat(0.0), splat(0.0), splat(0.0)); 4];
                for (bc, sum) in sums.iter_mut().enumerate() {
                    let (b, c) = (bc & 1, bc >> 1);
                    let (lattice_yz, weight_yz) = (xor(y[b], z[c]), mul(wy[b], wz[c]));
                    let g = [gradient(xor(x[0], lattice_yz)), gradient(xor(x[1], lattice_yz))];
                    for a in 0..2 {
                        let Gradient { x: gx, y: gy, z: gz, sign } = g[a];
                        dot[2 * bc + a] = flip(fma(gz, dz[c], fma(gy, dy[b], mul(gx, dx[a]))), sign);
                    }
                    let w = [flip(mul(wx[0], weight_yz), g[0].sign), flip(mul(wx[1], weight_yz), g[1].sign)];
                    *sum = (
                        fma(w[1], g[1].x, mul(w[0], g[0].x)),
                        fma(w[1], g[1].y, mul(w[0], g[0].y)),
                        fma(w[1], g[1].z, mul(w[0], g[0].z)),
                    );
                }
                let [s0, s1, s2, s3] = sums;
                let gx = add(add(s0.0, s1.0), add(s2.0, s3.0));
                let gy = add(add(s0.1, s1.1), add(s2.1, s3.1));
                let gz = add(add(s0.2, s1.2), add(s2.2, s3.2));
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
                    store(points.dx.as_mut_ptr().add(start), fma(tx, nx, gx));
                    store(points.dy.as_mut_ptr().add(start), fma(ty, ny, gy));
                    store(points.dz.as_mut_ptr().add(start), fma(tz, nz, gz));
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
        /// The first of a pair of opposite gradients, and a sign bit for the second.
        #[derive(Clone, Copy)]
        struct Gradient {
            x: Float,
            y: Float,
            z: Float,
            sign: Float,
        }
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

    operations! { "avx2,fma", __m256, __m256i,
        add(a: Float, b: Float) -> Float = _mm256_add_ps;
        sub(a: Float, b: Float) -> Float = _mm256_sub_ps;
        mul(a: Float, b: Float) -> Float = _mm256_mul_ps;
        fma(a: Float, b: Float, c: Float) -> Float = _mm256_fmadd_ps;
        flip(a: Float, sign: Float) -> Float = _mm256_xor_ps;
        splat(a: f32) -> Float = _mm256_set1_ps;
        iadd(a: Int, b: Int) -> Int = _mm256_add_epi32;
        imul(a: Int, b: Int) -> Int = _mm256_mullo_epi32;
        xor(a: Int, b: Int) -> Int = _mm256_xor_si256;
    }
    kernel!("avx2,fma", 8);

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn isplat(a: u32) -> Int {
        _mm256_set1_epi32(a as i32)
    }

    /// # Safety
    /// Eight positions must be readable from `from`.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
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
    #[target_feature(enable = "avx2,fma")]
    unsafe fn store(to: *mut f32, value: Float) {
        // SAFETY: the caller's promise.
        unsafe { _mm256_storeu_ps(to, value) }
    }

    /// `PAIRS` from registers and the sign of `gradient_index(lattice)`.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn gradient(lattice: Int) -> Gradient {
        let index = _mm256_mulhi_epu16(imul(lattice, isplat(MIX)), isplat(12 << 16));
        let pair = _mm256_srli_epi32::<17>(index);
        let x = _mm256_setr_ps(1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0);
        let y = _mm256_setr_ps(1.0, -1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0);
        let z = _mm256_setr_ps(0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0, 0.0);
        Gradient {
            x: _mm256_permutevar8x32_ps(x, pair),
            y: _mm256_permutevar8x32_ps(y, pair),
            z: _mm256_permutevar8x32_ps(z, pair),
            sign: _mm256_castsi256_ps(_mm256_slli_epi32::<15>(index)),
        }
    }

    /// One point, its eight corners in the eight lanes (lowest bit: x). The position comes in three
    /// registers: one 32-byte load of values just stored would wait for the stores to reach the cache.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn single(seed: u32, x: f64, y: f64, z: f64) -> super::super::Noise3 {
        let position = _mm256_setr_pd(x, y, z, 0.0);
        let floor = _mm256_floor_pd(position);
        let t = _mm256_cvtpd_ps(_mm256_sub_pd(position, floor));
        let prime = _mm_setr_epi32(PRIME[0] as i32, PRIME[1] as i32, PRIME[2] as i32, 0);
        let cell = _mm_mullo_epi32(_mm256_cvttpd_epi32(floor), prime);
        let cell = _mm256_set_m128i(cell, cell);
        let far_x = _mm256_setr_epi32(0, -1, 0, -1, 0, -1, 0, -1);
        let far_y = _mm256_setr_epi32(0, 0, -1, -1, 0, 0, -1, -1);
        let far_z = _mm256_setr_epi32(0, 0, 0, 0, -1, -1, -1, -1);
        let step = |far: Int, a: usize| _mm256_and_si256(far, isplat(PRIME[a]));
        let x = iadd(_mm256_shuffle_epi32::<0x00>(cell), step(far_x, 0));
        let y = iadd(_mm256_shuffle_epi32::<0x55>(cell), step(far_y, 1));
        let z = xor(iadd(_mm256_shuffle_epi32::<0xAA>(cell), step(far_z, 2)), isplat(seed));
        let g = gradient(xor(x, xor(y, z)));

        // Blend weights of the three axes side by side.
        let c = _mm_sub_ps(t, _mm_set1_ps(0.5));
        let c2 = _mm_mul_ps(c, c);
        let curve = _mm_fmadd_ps(_mm_set1_ps(6.0), c2, _mm_set1_ps(-5.0));
        let curve = _mm_fmadd_ps(c2, curve, _mm_set1_ps(1.875));
        let s = _mm_fmadd_ps(c, curve, _mm_set1_ps(0.5));
        let rest = _mm_sub_ps(c2, _mm_set1_ps(0.25));
        let slope = _mm_mul_ps(_mm_set1_ps(30.0), _mm_mul_ps(rest, rest));

        let (t2, s2) = (_mm256_set_m128(t, t), _mm256_set_m128(s, s));
        let near = sub(splat(1.0), s2);
        let pick = |near: Float, s: Float, far: Int| _mm256_blendv_ps(near, s, _mm256_castsi256_ps(far));
        let wx = pick(_mm256_permute_ps::<0x00>(near), _mm256_permute_ps::<0x00>(s2), far_x);
        let wy = pick(_mm256_permute_ps::<0x55>(near), _mm256_permute_ps::<0x55>(s2), far_y);
        let wz = pick(_mm256_permute_ps::<0xAA>(near), _mm256_permute_ps::<0xAA>(s2), far_z);
        let offset = |t: Float, far: Int| sub(t, _mm256_and_ps(_mm256_castsi256_ps(far), splat(1.0)));
        let dx = offset(_mm256_permute_ps::<0x00>(t2), far_x);
        let dy = offset(_mm256_permute_ps::<0x55>(t2), far_y);
        let dz = offset(_mm256_permute_ps::<0xAA>(t2), far_z);
        let dot = flip(fma(g.z, dz, fma(g.y, dy, mul(g.x, dx))), g.sign);
        let w = flip(mul(wx, mul(wy, wz)), g.sign);

        // Sums over the corners: along x (into the even lanes), then y (within a half), then z.
        let odd_w = _mm256_movehdup_ps(w);
        let pair = |g: Float| fma(odd_w, _mm256_movehdup_ps(g), mul(w, g));
        let (px, py, pz) = (pair(g.x), pair(g.y), pair(g.z));
        let xy = _mm256_shuffle_ps::<0b10_00_10_00>(px, py);
        let zz = _mm256_shuffle_ps::<0b10_00_10_00>(pz, pz);
        let sum = _mm256_hadd_ps(xy, zz);
        let sum = _mm_add_ps(_mm256_castps256_ps128(sum), _mm256_extractf128_ps::<1>(sum));

        let (low, high) = (_mm256_castps256_ps128(dot), _mm256_extractf128_ps::<1>(dot));
        let even = _mm_shuffle_ps::<0b10_00_10_00>(low, high);
        let odd = _mm_shuffle_ps::<0b11_01_11_01>(low, high);
        let along_x = _mm_sub_ps(odd, even);
        let v = _mm_fmadd_ps(_mm_shuffle_ps::<0x00>(s, s), along_x, even);
        // Values and x-slopes, near and far along y.
        let near_y = _mm_shuffle_ps::<0b10_00_10_00>(v, along_x);
        let far_y = _mm_shuffle_ps::<0b11_01_11_01>(v, along_x);
        let difference = _mm_sub_ps(far_y, near_y);
        let at_y = _mm_fmadd_ps(_mm_shuffle_ps::<0x55>(s, s), difference, near_y);
        // Value, x-slope and y-slope, near and far along z.
        let near_z = _mm_shuffle_ps::<0b00_00_10_00>(at_y, difference);
        let far_z = _mm_shuffle_ps::<0b01_01_11_01>(at_y, difference);
        let rise = _mm_sub_ps(far_z, near_z);
        let at_z = _mm_fmadd_ps(_mm_shuffle_ps::<0xAA>(s, s), rise, near_z);
        let slopes = _mm_shuffle_ps::<0b00_00_10_01>(at_z, rise);
        let total = _mm_fmadd_ps(slope, slopes, sum);
        let mut gradient = [0.0_f32; 4];
        // SAFETY: four floats are writable.
        unsafe { _mm_storeu_ps(gradient.as_mut_ptr(), total) };
        super::super::Noise3 { value: _mm_cvtss_f32(at_z), gradient: [gradient[0], gradient[1], gradient[2]] }
    }
}

mod avx512 {
    use super::*;

    operations! { "avx512f", __m512, __m512i,
        add(a: Float, b: Float) -> Float = _mm512_add_ps;
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

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn flip(a: Float, sign: Float) -> Float {
        _mm512_castsi512_ps(xor(_mm512_castps_si512(a), _mm512_castps_si512(sign)))
    }

    /// `PAIRS` from registers and the sign of `gradient_index(lattice)`.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn gradient(lattice: Int) -> Gradient {
        let mixed = imul(lattice, isplat(MIX));
        let index = imul(_mm512_srli_epi32::<16>(mixed), isplat(12));
        let pair = _mm512_srli_epi32::<17>(index);
        let (o, l, m) = (0.0, 1.0, -1.0);
        let x = _mm512_setr_ps(l, l, l, l, o, o, o, o, o, o, o, o, o, o, o, o);
        let y = _mm512_setr_ps(l, m, o, o, l, l, o, o, o, o, o, o, o, o, o, o);
        let z = _mm512_setr_ps(o, o, l, m, l, m, o, o, o, o, o, o, o, o, o, o);
        let sign = _mm512_and_si512(_mm512_slli_epi32::<15>(index), isplat(1 << 31));
        Gradient {
            x: _mm512_permutexvar_ps(pair, x),
            y: _mm512_permutexvar_ps(pair, y),
            z: _mm512_permutexvar_ps(pair, z),
            sign: _mm512_castsi512_ps(sign),
        }
    }
}
