//! Rolling: what reaches a body that rolls over the ground instead of sliding, and what it sends.
//!
//! ```text
//! ride       ẏ = ω_d (x − y),  ω_d = 2π v / λ_d
//! dilation   a(λ_d) (2π/λ_d)² r = 0.63      a(λ) = rms (λ / 1 mm)^((α−1)/2)
//! force      f → f + (M/m − 1) L_M f → L_p … L a low-pass of second order, critically damped
//! mass       ω_M = √(k/M),  M = F/g
//! patch      1.55 v / λ_p,  2π a_p / λ_p = (4/π)^(1/3),  a_p² = (3 F r / 4 E*)^(2/3) + 2 r rms
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | x, y | height of the ground, and of the path that the rolling body follows | m |
//! | f | force of a point that rides so, and what becomes of it in a patch of points under the whole body | N |
//! | m, k | mass and stiffness with which the point was reckoned | |
//! | v | speed of the place of contact over the surface | m/s |
//! | r | [`Rolling::radius_m`] | of the body that rolls |
//! | rms, α | [`Rolling::rms_at_1mm_m`], [`Rolling::alpha`] | the ground: rms of the octave about 1 mm, spectral exponent |
//! | F, E* | [`Rolling::normal_force_n`], [`Rolling::modulus_pa`] | |
//!
//! A sliding body sends edges and asperities of its own through the ground, each as sharp as a tip;
//! a rolling one is laid down on it: its surface meets the ground without a relative speed, from
//! above, and only as a whole ball.
//!
//! - It reaches no valley sharper than itself: λ_d, the law of [`crate::fractal_noise`]'s dilation,
//!   below which the amplitudes of octaves fall by one power of λ more, as behind a first-order
//!   low-pass.
//! - Asperities enter and leave its patch of contact one after the other: λ_p, where the measured
//!   filter of a wheel's patch, 1/(1 + π/4 (k a)³), is at −3 dB (P. J. Remington 1976; D. J.
//!   Thompson, "Railway noise and vibration", 2009 §5.4; **recalled**). Its fall lies between first
//!   and second order, within 2 dB of the second down to a seventh of λ_p. On rough ground the
//!   patch is wider than Hertz': asperities touch as far out as the gap under the ball is no wider
//!   than they are high (J. A. Greenwood, J. H. Tripp 1967, **recalled**).
//! - Where a tip gives way by itself, a ball is rigid: all of its mass M follows the ground, up to
//!   its resonance on the contact. A body that rolls free presses with its weight.
//!
//! Direction as published: rolling is heard through more of a low-pass than sliding (K. van den
//! Doel, P. G. Kry, D. K. Pai, "FoleyAutomatic", 2001, **recalled**). Trapezoidal, so that ω may
//! change from sample to sample.

use core::f64::consts::PI;

/// Curvature of the octave that a ball just follows, times its radius.
const FOLLOWED_CURVATURE: f64 = 0.63;
/// Wavelength at which the law of amplitudes is pinned, m.
const PINNED_M: f64 = 1e-3;
/// Wavelengths between which the law is used, m.
const WAVELENGTH_M: (f64, f64) = (1e-6, 1.0);

/// Pair of what rolls and what it rolls on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rolling {
    /// Radius of the body that rolls, m.
    pub radius_m: f64,
    /// Pressing force, N.
    pub normal_force_n: f64,
    /// E/(1 − ν²) of the ground, Pa.
    pub modulus_pa: f64,
    /// Rms of the ground's octave about 1 mm, m.
    pub rms_at_1mm_m: f64,
    /// Exponent of its spectrum, 1 to 2.5.
    pub alpha: f64,
}

impl Rolling {
    /// λ_d and λ_p, m: what is shorter is not followed.
    #[must_use]
    pub fn wavelengths_m(&self) -> [f64; 2] {
        let rising = 0.5 * (self.alpha - 1.0);
        let curved = 4.0 * PI * PI * self.radius_m * self.rms_at_1mm_m / FOLLOWED_CURVATURE;
        let dilation_m = libm::pow(curved * libm::pow(PINNED_M, -rising), 1.0 / (2.0 - rising));
        let hertz_m = libm::cbrt(0.75 * self.normal_force_n * self.radius_m / self.modulus_pa);
        let patch_m = libm::sqrt(hertz_m * hertz_m + 2.0 * self.radius_m * self.rms_at_1mm_m);
        let patch_m = 2.0 * PI * patch_m / libm::cbrt(4.0 / PI);
        // In this order what is no number is the shortest.
        [dilation_m, patch_m].map(|wavelength_m| wavelength_m.max(WAVELENGTH_M.0).min(WAVELENGTH_M.1))
    }
}

/// Highest corner over the rate: up to it the path is a mean of what it has ridden, and never
/// beyond it.
const HIGHEST: f64 = 0.25;

/// The low-pass at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RollingFilter {
    /// Gain of the integrator over 1 + itself.
    step: f64,
}

impl RollingFilter {
    /// At a speed, m/s, over ground of which waves shorter than this are not followed.
    #[must_use]
    pub fn new(speed_m_s: f64, wavelength_m: f64, sample_rate_hz: f64) -> Self {
        let gain = libm::tan(PI * (speed_m_s / wavelength_m / sample_rate_hz).min(HIGHEST));
        Self { step: gain / (1.0 + gain) }
    }
}

/// Memory of one low-pass: where the body rides, or what it sends.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RollingState {
    held: f64,
}

impl RollingState {
    /// It rests on this height, m, or sends this.
    #[must_use]
    pub const fn at(held: f64) -> Self {
        Self { held }
    }

    /// One sample: height of the ground → of the body's path, or force of a point → of the patch.
    #[inline]
    pub fn tick(&mut self, filter: &RollingFilter, x: f64) -> f64 {
        let step = filter.step * (x - self.held);
        let y = self.held + step;
        self.held = y + step;
        y
    }
}

/// Force that a rolling body sends of the force of a point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RollingForce {
    mass_gain: f64,
    mass: RollingFilter,
    patch: RollingFilter,
}

/// Memory of one [`RollingForce`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RollingForceState {
    mass: [RollingState; 2],
    patch: [RollingState; 2],
}

/// Corner of each of two equal first-order low-passes over where both together are at −3 dB.
const PAIR: f64 = 1.553_773_974;
/// The patch's low-pass is nowhere slower, Hz: a patch that rests sends the force of its points.
const SLOWEST_HZ: f64 = 20.0;

impl RollingForce {
    /// At a speed, m/s; `mass_ratio` is M/m and `resonance_hz` that of M on its contact.
    #[must_use]
    pub fn new(
        (speed_m_s, patch_m): (f64, f64),
        (mass_ratio, resonance_hz): (f64, f64),
        sample_rate_hz: f64,
    ) -> Self {
        let at = |frequency_hz: f64| RollingFilter::new(frequency_hz, 1.0, sample_rate_hz);
        Self {
            mass_gain: (mass_ratio - 1.0).max(0.0),
            mass: at(resonance_hz),
            patch: at((PAIR * speed_m_s / patch_m).max(SLOWEST_HZ)),
        }
    }
}

impl RollingForceState {
    /// One sample of the force of a point, or of its impulse → of the rolling body's.
    #[inline]
    pub fn tick(&mut self, design: &RollingForce, x: f64) -> f64 {
        let pass = |states: &mut [RollingState; 2], filter: &RollingFilter, x: f64| {
            let [first, second] = states;
            second.tick(filter, first.tick(filter, x))
        };
        let heavy = x + design.mass_gain * pass(&mut self.mass, &design.mass, x);
        pass(&mut self.patch, &design.patch, heavy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    const RATE_HZ: f64 = 44_100.0;
    const MARBLE: Rolling =
        Rolling { radius_m: 8e-3, normal_force_n: 1.0, modulus_pa: 7e10, rms_at_1mm_m: 9e-6, alpha: 1.75 };

    #[test]
    fn a_wave_of_the_limit_is_followed_by_half_its_power() {
        let [wavelength_m, _] = MARBLE.wavelengths_m();
        for speed_m_s in [0.03, 0.2, 1.0] {
            let filter = RollingFilter::new(speed_m_s, wavelength_m, RATE_HZ);
            for waves in [0.25, 1.0, 4.0] {
                let gain = 1.0 / libm::hypot(1.0, waves);
                let (mut state, mut re, mut im) = (RollingState::default(), 0.0, 0.0);
                let turn = 2.0 * PI * waves * speed_m_s / wavelength_m / RATE_HZ;
                let periods = libm::floor(44_100.0 * turn / (2.0 * PI));
                let n = (periods * 2.0 * PI / turn) as u32;
                for i in 0..44_100 + n {
                    let y = state.tick(&filter, libm::sin(turn * f64::from(i)));
                    if i >= 44_100 {
                        (re, im) = (
                            re + y * libm::sin(turn * f64::from(i)),
                            im + y * libm::cos(turn * f64::from(i)),
                        );
                    }
                }
                let found = 2.0 * libm::hypot(re, im) / f64::from(n);
                assert!((found / gain - 1.0).abs() < 0.02, "{speed_m_s} m/s, {waves}: {found} for {gain}");
            }
        }
    }

    #[test]
    fn larger_balls_softer_ground_more_force_and_rougher_ground_follow_less() {
        let sum_m = |marble: &Rolling| marble.wavelengths_m().iter().sum::<f64>();
        let base_m = sum_m(&MARBLE);
        let others = [
            Rolling { radius_m: 3e-2, ..MARBLE },
            Rolling { normal_force_n: 100.0, ..MARBLE },
            Rolling { modulus_pa: 1e7, ..MARBLE },
            Rolling { rms_at_1mm_m: 3e-5, ..MARBLE },
        ];
        assert!(others.iter().all(|other| sum_m(other) > base_m));
        // The dilation alone: a(λ) (2π/λ)² r = 0.63.
        let limit_m = MARBLE.wavelengths_m()[0];
        let amplitude_m = 9e-6 * libm::pow(limit_m / 1e-3, 0.375);
        let curvature_per_m = amplitude_m * (2.0 * PI / limit_m) * (2.0 * PI / limit_m);
        assert!((curvature_per_m * 8e-3 / 0.63 - 1.0).abs() < 1e-9);
        // The patch alone: 46.2 µm of Hertz' circle under 1 N, λ = 2π a (π/4)^(1/3).
        let smooth = Rolling { rms_at_1mm_m: 0.0, ..MARBLE };
        let circle_m = libm::cbrt(0.75 * 8e-3 / 7e10);
        assert!(
            (smooth.wavelengths_m()[1] / (2.0 * PI * circle_m * libm::cbrt(PI / 4.0)) - 1.0).abs() < 1e-9
        );
    }

    #[test]
    fn friction_stays_within_what_it_has_ridden_at_any_speed() {
        let mut rng = Rng::new(11);
        let mut state = RollingState::at(0.5);
        for _ in 0..4000 {
            let filter = RollingFilter::new(10.0 * rng.uniform(), 1e-4 + 1e-2 * rng.uniform(), RATE_HZ);
            for _ in 0..16 {
                let y = state.tick(&filter, rng.uniform());
                assert!((-1e-12..=1.0 + 1e-12).contains(&y), "{y}");
            }
        }
        let still = RollingFilter::new(0.0, 1e-3, RATE_HZ);
        assert_eq!(state.tick(&still, 7.0), state.tick(&still, -7.0));
        for bad in [f64::NAN, f64::INFINITY, 0.0] {
            let odd = Rolling { rms_at_1mm_m: bad, modulus_pa: bad, ..MARBLE }.wavelengths_m();
            assert!(odd.iter().all(|odd| odd.is_finite() && *odd > 0.0), "{odd:?}");
        }
    }

    #[test]
    fn a_slow_force_meets_the_mass_and_a_fast_one_the_patch() {
        let force = RollingForce::new((0.5, 1e-3), (20.0, 50.0), RATE_HZ);
        let gain = |frequency_hz: f64| {
            let (mut state, mut re, mut im) = (RollingForceState::default(), 0.0, 0.0);
            for n in 0..88_200 {
                let turn = 2.0 * PI * frequency_hz * f64::from(n) / RATE_HZ;
                let y = state.tick(&force, libm::sin(turn));
                if n >= 44_100 {
                    (re, im) = (re + y * libm::sin(turn), im + y * libm::cos(turn));
                }
            }
            libm::hypot(re, im) / 22_050.0
        };
        assert!((gain(2.0) / 20.0 - 1.0).abs() < 0.01);
        // 0.5 m/s over 1 mm: −3 dB at 500 Hz, where of the mass 19/(1 + i 10)² is left beside 1.
        let (re, im) = (1.0 + 19.0 * -99.0 / 10_201.0, 19.0 * -20.0 / 10_201.0);
        assert!((gain(500.0) / (0.5f64.sqrt() * libm::hypot(re, im)) - 1.0).abs() < 0.01, "{}", gain(500.0));
        // Momentum stays: what a light body sends in all, it sends rolling too.
        let light = RollingForce::new((0.5, 1e-3), (0.5, 50.0), RATE_HZ);
        let mut state = RollingForceState::default();
        let sum: f64 = (0..44_100).map(|n| state.tick(&light, f64::from(u8::from(n == 0)))).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    }

    #[test]
    fn it_is_what_scipy_s_bilinear_filter_gives() {
        // scipy.signal.lfilter(*bilinear([1], [1/w, 1], 44100)), w pre-warped to 100 Hz, of an
        // impulse.
        let filter = RollingFilter::new(0.1, 1e-3, RATE_HZ);
        let mut state = RollingState::default();

        for (n, theirs) in SCIPY.into_iter().enumerate() {
            let ours = state.tick(&filter, f64::from(u8::from(n == 0)));
            assert!((ours - theirs).abs() < 1e-12, "{n}: {ours} for {theirs}");
        }
    }

    const SCIPY: [f64; 5] = [
        7.073522215301396e-03,
        1.404697499754207e-02,
        1.384825181813627e-02,
        1.365233998437892e-02,
        1.345919972403822e-02,
    ];
}
