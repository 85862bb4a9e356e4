//! Closed sums of damped exponentials: the entries of the Gram matrix without touching samples.
//!
//! ```text
//! S_p(w) = Σ_{n<N} n^p wⁿ ,  p = 0, 1, 2        E = w^N ,  q = 1/(1 − w)
//! S_0 = q (1 − E)
//! S_1 = q (S_0 − 1 − (N − 1) E)
//! S_2 = q (2 S_1 − S_0 + 1 − (N − 1)² E)
//! ```
//! The last two follow from summation by parts. Where |1 − w|·N is small they cancel (relative
//! error ε N/(|1 − w| N)²); there the sum is doubled instead, S(2M) from S(M), which only adds
//! terms.

use nalgebra::Complex;

type C = Complex<f64>;

/// |1 − w|·N below which the closed forms would lose more than four digits.
const CANCELLATION: f64 = 0.3;

/// `[S_0, S_1, S_2]` of `w` over `count` terms; `power` is w^count, which callers have as a
/// product.
#[must_use]
pub fn geometric_sums(w: C, power: C, count: usize) -> [C; 3] {
    let one = C::new(1.0, 0.0);
    let gap = one - w;
    let n = count as f64;
    if gap.norm_sqr() * n * n < CANCELLATION * CANCELLATION {
        return doubled(w, count);
    }
    let q = gap.inv();
    let s0 = q * (one - power);
    let s1 = q * (s0 - one - power * (n - 1.0));
    let s2 = q * (s1 * 2.0 - s0 + one - power * ((n - 1.0) * (n - 1.0)));
    [s0, s1, s2]
}

/// The sums by doubling over the bits of `count`.
fn doubled(w: C, count: usize) -> [C; 3] {
    let zero = C::new(0.0, 0.0);
    let (mut s0, mut s1, mut s2) = (zero, zero, zero);
    let mut power = C::new(1.0, 0.0);
    let mut length = 0.0;
    for bit in (0..usize::BITS - count.leading_zeros()).rev() {
        // Σ over [M, 2M): n = M + m, so n² = M² + 2Mm + m².
        let (t0, t1, t2) = (s0, s1 + s0 * length, s2 + s1 * (2.0 * length) + s0 * (length * length));
        s0 += power * t0;
        s1 += power * t1;
        s2 += power * t2;
        power *= power;
        length *= 2.0;
        if count >> bit & 1 == 1 {
            s0 += power;
            s1 += power * length;
            s2 += power * (length * length);
            power *= w;
            length += 1.0;
        }
    }
    [s0, s1, s2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direct(w: C, count: usize) -> [C; 3] {
        let mut sums = [C::new(0.0, 0.0); 3];
        for n in 0..count {
            let term = w.powu(n as u32);
            for (p, sum) in sums.iter_mut().enumerate() {
                *sum += term * (n as f64).powi(p as i32);
            }
        }
        sums
    }

    #[test]
    fn closed_sums_equal_the_sums_term_by_term() {
        for (radius, angle) in
            [(1.0, 0.0), (1.0, 1e-9), (0.999_999, 0.0), (0.9999, 1e-4), (1.0, 2e-5), (0.99, 2.0), (0.5, 3.0)]
        {
            for count in [1, 2, 7, 1000, 1337] {
                let w = C::from_polar(radius, angle);
                let sums = geometric_sums(w, w.powu(count as u32), count);
                for (closed, direct) in sums.iter().zip(direct(w, count)) {
                    let error = (closed - direct).norm() / direct.norm().max(1.0);
                    assert!(error < 1e-7, "{w} {count}: {closed} {direct}");
                }
            }
        }
    }
}
