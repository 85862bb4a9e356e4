//! Shape of the elastic Hertz pulse as a polynomial, and that polynomial under the cubic kernel.

/// Coefficients of w¹ … w⁵ in p(u) = Σ c w^j, w = 4u(1 − u), area 1; least squares against the
/// integrated equation (`tests/independent/hertz_pulse.py`): 3e-4 off in L2, 8.1e-4 of the peak at
/// most.
const C: [f64; 5] = [0.191_499_142_6, 2.086_713_228_2, -1.531_633_332_1, 1.514_399_229_6, -0.421_699_986_2];

const fn binomial(n: usize, k: usize) -> f64 {
    let (mut b, mut i) = (1.0, 0);
    while i < k {
        b = b * (n - i) as f64 / (i + 1) as f64;
        i += 1;
    }
    b
}

/// n! / m!
const fn falling(n: usize, m: usize) -> f64 {
    let (mut f, mut i) = (1.0, m + 1);
    while i <= n {
        f *= i as f64;
        i += 1;
    }
    f
}

/// Powers of u in p: entry m is the coefficient of u^(m+1).
const fn powers_of_u() -> [f64; 10] {
    let mut out = [0.0; 10];
    let mut j = 1;
    while j <= 5 {
        // w^j = 4^j u^j (1 − u)^j
        let (mut scale, mut i) = (C[j - 1], 0);
        while i < j {
            scale *= 4.0;
            i += 1;
        }
        let mut k = 0;
        while k <= j {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            out[j + k - 1] += sign * scale * binomial(j, k);
            k += 1;
        }
        j += 1;
    }
    out
}

/// Fourfold integral of p from 0: P(u) = u⁵ Σ `FOURFOLD[m]` u^m for u in 0..1.
const FOURFOLD: [f64; 10] = {
    let mut out = powers_of_u();
    let mut m = 0;
    while m < 10 {
        out[m] /= falling(m + 5, m + 1);
        m += 1;
    }
    out
};

/// Even powers of x = 2u − 1 in p, w = 1 − x².
pub(crate) const CENTRED: [f64; 6] = {
    let mut out = [0.0; 6];
    let mut j = 1;
    while j <= 5 {
        let mut k = 0;
        while k <= j {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            out[k] += sign * C[j - 1] * binomial(j, k);
            k += 1;
        }
        j += 1;
    }
    out
};

/// Variance of p as a density over u: Σ ∫ (x/2)² `CENTRED` x^(2i) dx / 2.
const VARIANCE: f64 = {
    let (mut v, mut i) = (0.0, 0);
    while i < 6 {
        v += CENTRED[i] / (4.0 * (2 * i + 3) as f64);
        i += 1;
    }
    v
};

/// κ_j 4^j (2i)! / (2i − 2j)! CENTRED[i], stored at [j][i − j]: the even derivatives that the cubic
/// kernel adds to a polynomial, (sinh(s/2)/(s/2))⁴ = Σ κ_j s^(2j), κ_j = (2 · 4^(j+2) − 8) / (2j +
/// 4)!.
const SMOOTHED: [[f64; 6]; 6] = {
    let mut out = [[0.0; 6]; 6];
    let (mut j, mut four_to_j) = (0, 1.0);
    while j < 6 {
        let kappa = (32.0 * four_to_j - 8.0) / falling(2 * j + 4, 0);
        let mut i = j;
        while i < 6 {
            out[j][i - j] = kappa * four_to_j * falling(2 * i, 2 * i - 2 * j) * CENTRED[i];
            i += 1;
        }
        four_to_j *= 4.0;
        j += 1;
    }
    out
};

/// p(u), area 1 over u in 0..1; zero outside.
#[must_use]
pub fn pulse_shape(u: f64) -> f64 {
    if !(0.0..=1.0).contains(&u) {
        return 0.0;
    }
    let w = 4.0 * u * (1.0 - u);
    w * (C[0] + w * (C[1] + w * (C[2] + w * (C[3] + w * C[4]))))
}

/// P(u) for u in 0..1.
#[inline]
pub(super) fn fourfold(u: f64) -> f64 {
    let c = &FOURFOLD;
    let u2 = u * u;
    let u4 = u2 * u2;
    let low = (c[0] + c[1] * u) + (c[2] + c[3] * u) * u2;
    let high = (c[4] + c[5] * u) + (c[6] + c[7] * u) * u2;
    u4 * u * (low + u4 * (high + u4 * (c[8] + c[9] * u)))
}

/// P(u) for u ≥ 1, where only the moments of p are left.
#[inline]
pub(super) fn fourfold_after(u: f64) -> f64 {
    let x = u - 0.5;
    x * (x * x + 3.0 * VARIANCE) * (1.0 / 6.0)
}

/// p under the cubic kernel, for places at least two samples inside the pulse.
#[derive(Clone, Copy)]
pub(super) struct Smoothed([f64; 6]);

impl Smoothed {
    /// `step` is the sample step over the contact time.
    #[inline]
    pub fn new(step: f64) -> Self {
        let s2 = step * step;
        let mut a = CENTRED;
        let mut power = 1.0;
        for (j, row) in SMOOTHED.iter().enumerate().skip(1) {
            power *= s2;
            for (a, term) in a.iter_mut().zip(&row[..6 - j]) {
                *a += power * term;
            }
        }
        Self(a)
    }

    #[inline]
    pub fn at(&self, u: f64) -> f64 {
        let x = 2.0 * u - 1.0;
        let t = x * x;
        let t2 = t * t;
        let a = &self.0;
        (a[0] + a[1] * t) + t2 * ((a[2] + a[3] * t) + t2 * (a[4] + a[5] * t))
    }
}
