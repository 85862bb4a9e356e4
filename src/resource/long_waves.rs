//! Long waves under a map that has none of its own.
//!
//! ```text
//! w(λ) = L · 3.5 µm/(m/s²) · (λ / 1 mm)^0.85 · (1 + (λ/20 mm)²)^(−0.68)       λ above the map's strongest octave
//! L²   = Σ (min(a(λ), 0.63 λ² / 4π² r) G(v/λ))²        G(f) = (2πf)² / |1 − (f/f₀)² + j f/(Q f₀)|
//! ```
//! Scanned and made textures hold one scale of a millimetre or so and nothing above it, where real
//! ground goes on: a tool's vibration then moves with the speed as its one line does, and grows too
//! little. L: acceleration, m/s², with which a tool on such springs (f₀ 71 Hz, Q 0.52, a ball of
//! 1.6 mm, 0.12 m/s) answers the map; w: a ground of profile exponent 2.45 to 3 that is flat beyond
//! 30 mm and shakes it as strongly. A map whose strongest octave is its longest keeps what it has.
//!
//! Price: up to three slow octaves a sample, and a finger's displacement channel grows by 1 to 8 dB
//! at 0.03 to 0.3 m/s, which is why they are off unless a surface asks. Gain, a stylus over five
//! maps of one scale: its centroid grows as v^0.37 and not v^0.46 (`docs/lab/feel.md`).

use crate::model::surface::Surface;
use asperity_dsp::fractal_noise::{LONGEST_CELL_M, OCTAVES};
use asperity_dsp::gradient_noise_2d::PEAK_WAVELENGTH_CELLS;
use asperity_surface::height_field::{MAX_BLOCK, PathBlock, Properties, SurfaceBlock};
use std::f64::consts::PI;

/// Places at which each octave of a map is read.
const PLACES: usize = 512;
/// Rms of the octave about 1 mm for an acceleration of 1 m/s², m.
const PER_M_S2: f64 = 3.5e-6;
/// Exponent of its growth with the wavelength, and where that ends, m.
const GROWTH: f64 = 0.85;
const FLAT_BEYOND_M: f64 = 0.02;
/// Decline beyond.
const DECLINE: f64 = 0.68;
/// The tool: resonance, Hz, its quality, the radius of its ball, m, its speed, m/s.
const TOOL_HZ: f64 = 71.0;
const QUALITY: f64 = 0.52;
const BALL_M: f64 = 1.6e-3;
const SPEED_M_S: f64 = 0.12;
/// Shares of an octave's power in its own differences and in those of the next coarser octave, the
/// second and all further: the mean of sin⁸(π λ₀/2λ) over an octave of λ₀.
const SHARES: [f64; 4] = [0.71, 0.08, 0.36, 0.27];
/// Curvature of an octave that a ball just follows, times its radius (`dsp::fractal_noise`).
const FOLLOWED: f64 = 0.63;

/// Wavelengths of the octaves, m, the coarsest first.
fn wavelength_m(octave: usize) -> f64 {
    PEAK_WAVELENGTH_CELLS * LONGEST_CELL_M / f64::from(1u32 << octave)
}

/// Rms of the long waves that lie under a surface, m, octave by octave; zeros where it has its own,
/// or is no ground that could have them.
pub(crate) fn under(surface: &mut Surface, properties: &Properties) -> [f64; OCTAVES] {
    let none = [0.0; OCTAVES];
    let band = properties.band;
    let is_ground =
        properties.is_stateless && band.shortest_m.is_finite() && band.longest_m >= LONGEST_CELL_M;
    if !surface.long_waves || surface.micro_relief_m == 0.0 || !is_ground {
        return none;
    }
    let has = |octave: &usize| wavelength_m(*octave) >= band.shortest_m;
    let differences: Vec<f64> =
        (0..OCTAVES).take_while(has).map(|octave| mean_square_m2(surface, octave)).collect();
    waves_m(&octaves_m(&differences))
}

/// Rms of the octaves of which the differences have these mean squares, m: what finer waves have in
/// the differences of a coarser octave is taken off, from the finest on.
fn octaves_m(mean_squares_m2: &[f64]) -> Vec<f64> {
    let count = mean_squares_m2.len();
    let mut powers_m2 = vec![0.0; count];
    for octave in (0..count).rev() {
        let share = |finer: usize| SHARES[(finer - octave).min(SHARES.len() - 1)];
        let finer_m2: f64 = (octave + 1..count).map(|finer| share(finer) * powers_m2[finer]).sum();
        powers_m2[octave] = f64::max(0.0, mean_squares_m2[octave] - finer_m2) / SHARES[0];
    }
    powers_m2.into_iter().map(f64::sqrt).collect()
}

/// Waves above the strongest of a map's octaves.
fn waves_m(of_map: &[f64]) -> [f64; OCTAVES] {
    let strongest = (0..of_map.len()).max_by(|a, b| of_map[*a].total_cmp(&of_map[*b])).unwrap_or(0);
    let power =
        of_map.iter().enumerate().map(|(octave, rms_m)| felt_m_s2(wavelength_m(octave), *rms_m).powi(2));
    let level_m_s2 = power.sum::<f64>().sqrt();
    std::array::from_fn(|octave| {
        if octave >= strongest {
            return 0.0;
        }
        let (lambda_m, beyond) = (wavelength_m(octave), wavelength_m(octave) / FLAT_BEYOND_M);
        let rising = PER_M_S2 * libm::pow(lambda_m / 1e-3, GROWTH);
        level_m_s2 * rising * libm::pow(1.0 + beyond * beyond, -DECLINE)
    })
}

/// Acceleration of the tool over an octave, m/s².
fn felt_m_s2(wavelength_m: f64, rms_m: f64) -> f64 {
    let followed_m = FOLLOWED * wavelength_m * wavelength_m / (4.0 * PI * PI * BALL_M);
    let frequency_hz = SPEED_M_S / wavelength_m;
    let (x, omega) = (frequency_hz / TOOL_HZ, 2.0 * PI * frequency_hz);
    rms_m.min(followed_m) * omega * omega / libm::hypot(1.0 - x * x, x / QUALITY)
}

/// Mean square of the fourth differences that a wave of an octave fills, m², along u and v, as of
/// the local relief (`surface::local_relief`).
fn mean_square_m2(surface: &mut Surface, octave: usize) -> f64 {
    const TAPS: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
    let half_m = 0.5 * wavelength_m(octave);
    let mut out = SurfaceBlock::default();
    let mut sum = 0.0;
    for place in 0..PLACES {
        // Places of Roberts' sequence, which leaves no gaps and no rows.
        let n = place as f64 + 1.0;
        // All lags of the octave, so that no line fills a coarser one.
        let lag_m = half_m * libm::exp2((n * 0.618_033_988_749_894_9).fract() - 0.5);
        let mut at_m = [[0.0; 2]; TAPS.len()];
        for (tap, at_m) in at_m.iter_mut().enumerate() {
            *at_m = [
                (n * 0.754_877_666_246_692_7).fract() * surface.width_m,
                (n * 0.569_840_290_998_053_2).fract() * surface.height_m,
            ];
            at_m[place % 2] += (tap as f64 - 2.0) * lag_m;
        }
        let path = PathBlock {
            position_m: &at_m,
            velocity_m_s: &[[0.0; 2]; TAPS.len()],
            footprint_m: &[0.0; TAPS.len()],
            heights_only: true,
            ..PathBlock::default()
        };
        surface.source.sample(&path, &mut out);
        let difference: f64 =
            TAPS.iter().zip(&out.height_m).map(|(tap, height_m)| tap * height_m / 16.0).sum();
        sum += difference * difference;
    }
    const { assert!(TAPS.len() <= MAX_BLOCK, "places of one difference fit a block") };
    sum / PLACES as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Extent;
    use asperity_surface::height_map::HeightMap;
    use asperity_surface::raster::Raster;
    use asperity_surface::wrap::Wrap;

    const SIDE_M: f64 = 0.06;

    /// Waves of this length and amplitude both ways.
    fn map(wavelength_m: f64, peak_m: f64) -> Surface {
        let wave = |i: usize| (2.0 * PI * i as f64 / 1024.0 * (SIDE_M / wavelength_m).round()).sin();
        let raster = Raster::from_fn(1024, 1024, |x, y| 0.5 * (wave(x) + wave(y)));
        let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: peak_m };
        let map = HeightMap::new(&raster, extent, Wrap::Repeat).unwrap();
        Surface::from_map(map).unwrap().long_waves(true)
    }

    fn waves(mut surface: Surface) -> [f64; OCTAVES] {
        let properties = surface.properties();
        under(&mut surface, &properties)
    }

    #[test]
    fn waves_lie_above_a_maps_scale_as_strong_as_felt() {
        let weak = waves(map(1e-3, 1e-6));
        assert!(weak[..5].iter().all(|rms_m| *rms_m > 0.0) && weak[5..] == [0.0; 7], "{weak:?}");
        let strong = waves(map(1e-3, 2e-6));
        assert!((strong[3] / weak[3] - 2.0).abs() < 1e-6, "{strong:?}");
        // One that a ball cannot follow shakes it no more.
        let [large, larger] = [1e-3, 2e-3].map(|peak_m| waves(map(1e-3, peak_m))[3]);
        assert!(larger < 1.8 * large && large < 100.0 * weak[3], "{large} m, {larger} m");
    }

    #[test]
    fn what_has_long_waves_or_wants_none_gets_none() {
        let none = [0.0; OCTAVES];
        assert_eq!(waves(map(0.03, 1e-4)), none);
        assert_eq!(waves(map(1e-3, 1e-4).long_waves(false)), none);
        assert_eq!(waves(map(1e-3, 1e-4).micro_relief_m(0.0)), none);
        assert_eq!(waves(Surface::flat(0.1, 0.1).unwrap().long_waves(true)), none);
    }
}
