//! One point with its eight corners in the lanes of AVX2: the same operations, the same bits.
#![allow(unsafe_code)]

use super::avx2::*;
use super::{PRIME, ROOT_15, WHOLE};
use crate::gradient_noise_3d::Noise3;

use core::arch::x86_64::*;

/// One point, its eight corners in the eight lanes (lowest bit: x). The position comes in three
/// registers: one 32-byte load of values just stored would wait for the stores to reach the cache.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn single(seed: u32, x: f64, y: f64, z: f64) -> Noise3 {
    let position = _mm256_setr_pd(x, y, z, 0.0);
    let whole = _mm256_add_pd(_mm256_sub_pd(position, _mm256_set1_pd(0.5)), _mm256_set1_pd(WHOLE));
    let rest = _mm256_sub_pd(position, _mm256_sub_pd(whole, _mm256_set1_pd(WHOLE)));
    let t = _mm256_cvtpd_ps(rest);
    let prime = _mm_setr_epi32(PRIME[0] as i32, PRIME[1] as i32, PRIME[2] as i32, 0);
    let (low, high) = (_mm256_castpd256_pd128(whole), _mm256_extractf128_pd::<1>(whole));
    let cell = _mm_shuffle_ps::<0b10_00_10_00>(_mm_castpd_ps(low), _mm_castpd_ps(high));
    let cell = _mm_mullo_epi32(_mm_castps_si128(cell), prime);
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
    let root = _mm_fmadd_ps(c2, _mm_set1_ps(ROOT_15), _mm_set1_ps(-0.25 * ROOT_15));
    let slope = _mm_mul_ps(root, root);

    let t2 = _mm256_set_m128(t, t);
    let offset = |t: Float, far: Int| sub(t, _mm256_and_ps(_mm256_castsi256_ps(far), splat(1.0)));
    let dx = offset(_mm256_permute_ps::<0x00>(t2), far_x);
    let dy = offset(_mm256_permute_ps::<0x55>(t2), far_y);
    let dz = offset(_mm256_permute_ps::<0xAA>(t2), far_z);
    let dot = fma(g.z, dz, fma(g.y, dy, mul(g.x, dx)));

    // Along x, two quantities a register: near cells are the even lanes, far ones the odd.
    let sx = _mm256_broadcastss_ps(s);
    let near = |a: Float, b: Float| _mm256_shuffle_ps::<0b10_00_10_00>(a, b);
    let far = |a: Float, b: Float| _mm256_shuffle_ps::<0b11_01_11_01>(a, b);
    let (near_vx, near_yz) = (near(dot, g.x), near(g.y, g.z));
    let slope_vx = sub(far(dot, g.x), near_vx);
    let (vx, yz) = (fma(sx, slope_vx, near_vx), fma(sx, sub(far(g.y, g.z), near_yz), near_yz));
    // Along y: the value and its gradients' components side by side; the slope along x beside them.
    let sy = _mm256_broadcastss_ps(_mm_permute_ps::<0x55>(s));
    let near_y = near(vx, yz);
    let slope_y = sub(far(vx, yz), near_y);
    let at_y = fma(sy, slope_y, near_y);
    let slope_x = fma(sy, sub(_mm256_movehdup_ps(slope_vx), slope_vx), slope_vx);
    // Along z: the halves of the registers.
    let sz = _mm_permute_ps::<0xAA>(s);
    let along_z = |low: __m128, high: __m128| {
        let slope = _mm_sub_ps(high, low);
        (_mm_fmadd_ps(sz, slope, low), slope)
    };
    let halves = |a: Float| (_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
    let (low, high) = halves(at_y);
    let (all, slope_z) = along_z(low, high);
    let (low, high) = halves(_mm256_unpacklo_ps(slope_x, slope_y));
    let (slopes, _) = along_z(low, high);
    // The value and its gradient; the slopes one lane further than those of the blend.
    let slopes = _mm_movelh_ps(slopes, slope_z);
    let parts = _mm_mul_ps(all, _mm_set1_ps(0.5));
    let gradients = _mm_permute_ps::<0b00_11_10_01>(parts);
    let total = _mm_fmadd_ps(slope, slopes, gradients);
    let mut gradient = [0.0_f32; 4];
    // SAFETY: four floats are writable.
    unsafe { _mm_storeu_ps(gradient.as_mut_ptr(), total) };
    Noise3 { value: _mm_cvtss_f32(parts), gradient: [gradient[0], gradient[1], gradient[2]] }
}
