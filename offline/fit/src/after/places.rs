//! Places of strikes: which points of a body with known shapes several recorded strikes of it were
//! made at, and how well that explains them.
//!
//! ```text
//! x[s][k] ≈ c_s g_k φ_k(p_s)        c_0 = 1        minimise Σ_k w_k Σ_s (x[s][k] − c_s g_k φ_k(p_s))²,   w_k = 1 / Σ_s x[s][k]²
//! R² = 1 − Σ_k w_k Σ_s (x − c g φ)² / Σ_k w_k Σ_s (x − mean_s x)²
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | x | signed amplitudes of the modes that all strikes have in common ([`Merged`]) |
//! | φ_k(p) | motion of a point across the surface in the shape of that mode |
//! | g_k | how loud a mode is in the recordings: one gain a mode |
//! | c_s | how hard strike s was, against the first |
//!
//! Measured modes are those shapes whose frequencies they lie nearest to, after one common factor
//! (a body's Young's modulus and density are never known as well as its shape). From some hundred
//! points as the first strike's place gains follow, from gains the other places, and so on in
//! turns; the best beginning counts. Every mode weighs the same, however loud. R² is against what a
//! body would do that sounds alike everywhere; a mirrored place of a symmetric body explains the
//! same, and the first of them is told. It is a check of the shapes against the recordings and
//! changes nothing in either.

use super::strikes::Merged;

/// Largest distance of a measured frequency from a shape's after the common factor.
const NEAR: f64 = 0.02;
/// The common factor of frequencies lies within so much either way.
const FACTOR: f64 = 1.3;
/// Fewer modes say nothing about a place.
pub const LEAST_MODES: usize = 3;
/// Most points that are tried as the first strike's place.
const BEGINNINGS: usize = 400;
/// Turns of gains and places.
const TURNS: usize = 12;

/// One mode's shape.
#[derive(Debug, Clone, Copy)]
pub struct Shape<'a> {
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Motion across the surface at every point; all shapes have as many.
    pub across: &'a [f64],
}

/// Places of strikes.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// The point of each strike.
    pub points: Vec<usize>,
    /// Strength of each, against the first; below 0 where the recording is turned round.
    pub levels: Vec<f64>,
    /// For each mode that was found among the shapes: which measured one, which shape, and its
    /// gain.
    pub modes: Vec<(usize, usize, f64)>,
    /// Measured over computed frequencies.
    pub frequency_factor: f64,
    /// Share of the difference between the strikes that their places explain; 1 = all, 0 or less =
    /// nothing.
    pub r_squared: f64,
}

/// Finds the places of merged strikes on a body with these shapes. None where fewer than
/// [`LEAST_MODES`] modes are found among the shapes, or there are fewer than two strikes.
#[must_use]
pub fn places(merged: &Merged, shapes: &[Shape<'_>]) -> Option<Places> {
    let first = merged.strikes.first().filter(|_| merged.strikes.len() > 1)?;
    let measured_hz: Vec<f64> = first.iter().map(|mode| mode.frequency_hz).collect();
    let (frequency_factor, pairs) = matched(&measured_hz, shapes);
    if pairs.len() < LEAST_MODES {
        return None;
    }
    let mut amplitudes = vec![first.iter().map(|mode| mode.amplitude).collect::<Vec<f64>>()];
    amplitudes.extend(merged.positions());
    let problem = Problem::new(&amplitudes, &pairs, shapes);
    let points = shapes[pairs[0].1].across.len().max(1);
    let solved = (0..points).step_by(points.div_ceil(BEGINNINGS)).filter_map(|point| problem.solve(point));
    let best = solved.min_by(|a, b| a.lost.total_cmp(&b.lost))?;
    let modes = pairs.iter().zip(&best.gains).map(|((measured, shape), gain)| (*measured, *shape, *gain));
    Some(Places {
        modes: modes.collect(),
        points: best.points,
        levels: best.levels,
        frequency_factor,
        r_squared: 1.0 - best.lost / problem.total.max(f64::MIN_POSITIVE),
    })
}

/// The common factor under which most measured frequencies lie next to a shape's, nearest of all,
/// and the pairs.
fn matched(measured_hz: &[f64], shapes: &[Shape<'_>]) -> (f64, Vec<(usize, usize)>) {
    let steps = 400;
    let factor = |step: i32| FACTOR.powf(f64::from(step) / f64::from(steps));
    let all = (-steps..=steps).map(|step| {
        let pairs = pairs(measured_hz, shapes, factor(step));
        let off: f64 = pairs.iter().map(|(_, _, off)| off / NEAR).sum();
        (pairs.len() as f64 - off, factor(step), pairs)
    });
    let best = all.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or((1.0, Vec::new()), |(_, factor, pairs)| {
        (factor, pairs.into_iter().map(|(measured, shape, _)| (measured, shape)).collect())
    })
}

/// Measured modes with the shape that is nearest to each, where each is the other's nearest, and
/// how far they are apart.
fn pairs(measured_hz: &[f64], shapes: &[Shape<'_>], factor: f64) -> Vec<(usize, usize, f64)> {
    let off = |measured: usize, shape: usize| {
        (measured_hz[measured] / (factor * shapes[shape].frequency_hz) - 1.0).abs()
    };
    let nearest_shape =
        |measured: usize| (0..shapes.len()).min_by(|a, b| off(measured, *a).total_cmp(&off(measured, *b)));
    let nearest_measured =
        |shape: usize| (0..measured_hz.len()).min_by(|a, b| off(*a, shape).total_cmp(&off(*b, shape)));
    let of = |measured: usize| {
        let shape = nearest_shape(measured)?;
        let mutual = nearest_measured(shape) == Some(measured) && off(measured, shape) < NEAR;
        mutual.then(|| (measured, shape, off(measured, shape)))
    };
    (0..measured_hz.len()).filter_map(of).collect()
}

/// Amplitudes `[strike][mode]` of unit weight, and motions `[mode][point]`.
struct Problem<'a> {
    amplitudes: Vec<Vec<f64>>,
    across: Vec<&'a [f64]>,
    /// Part that no place explains.
    total: f64,
}

struct Solved {
    points: Vec<usize>,
    levels: Vec<f64>,
    gains: Vec<f64>,
    lost: f64,
}

impl<'a> Problem<'a> {
    fn new(amplitudes: &[Vec<f64>], pairs: &[(usize, usize)], shapes: &[Shape<'a>]) -> Self {
        let size =
            |k: usize| amplitudes.iter().map(|strike| strike[k].powi(2)).sum::<f64>().sqrt().max(1e-300);
        let amplitudes: Vec<Vec<f64>> = amplitudes
            .iter()
            .map(|strike| pairs.iter().map(|(k, _)| strike[*k] / size(*k)).collect())
            .collect();
        let mean =
            |k: usize| amplitudes.iter().map(|strike| strike[k]).sum::<f64>() / amplitudes.len() as f64;
        let total =
            (0..pairs.len()).map(|k| amplitudes.iter().map(|s| (s[k] - mean(k)).powi(2)).sum::<f64>()).sum();
        Self { across: pairs.iter().map(|(_, shape)| shapes[*shape].across).collect(), amplitudes, total }
    }

    /// Turns of places and gains, from a first strike at `point`. None where some mode does not
    /// move there.
    fn solve(&self, point: usize) -> Option<Solved> {
        let largest = |k: usize| self.across[k].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let mut gains = Vec::new();
        for (k, across) in self.across.iter().enumerate() {
            if across[point].abs() < 1e-3 * largest(k) {
                return None;
            }
            gains.push(self.amplitudes[0][k] / across[point]);
        }
        let mut solved = Solved { points: vec![point], levels: vec![1.0], gains, lost: f64::INFINITY };
        for _ in 0..TURNS {
            let before = solved.lost;
            let first = usize::from(before.is_infinite());
            let at: Vec<(usize, f64)> =
                (first..self.amplitudes.len()).map(|strike| self.nearest(&solved.gains, strike)).collect();
            if first == 0 {
                (solved.points, solved.levels) = (Vec::new(), Vec::new());
            }
            solved.points.extend(at.iter().map(|(point, _)| *point));
            solved.levels.extend(at.iter().map(|(_, level)| *level));
            self.regain(&mut solved);
            if solved.lost > before * (1.0 - 1e-6) {
                break;
            }
        }
        Some(solved)
    }

    /// The point, and how hard it was struck, that explains a strike best.
    fn nearest(&self, gains: &[f64], strike: usize) -> (usize, f64) {
        let amplitudes = &self.amplitudes[strike];
        let of = |point: usize| {
            let (mut both, mut own) = (0.0, 0.0);
            for ((x, gain), across) in amplitudes.iter().zip(gains).zip(&self.across) {
                let wanted = gain * across[point];
                (both, own) = (both + x * wanted, own + wanted * wanted);
            }
            // The first strike's level is what gains are counted in.
            let level = if strike == 0 || own == 0.0 { 1.0 } else { both / own };
            (level * level * own - 2.0 * level * both, point, level)
        };
        let all = (0..self.across[0].len()).map(of);
        all.min_by(|a, b| a.0.total_cmp(&b.0)).map_or((0, 1.0), |(_, point, level)| (point, level))
    }

    /// The gains that explain the places best, and what is lost then.
    fn regain(&self, solved: &mut Solved) {
        solved.lost = 0.0;
        for (k, gain) in solved.gains.iter_mut().enumerate() {
            let strikes = solved.points.iter().zip(&solved.levels).zip(&self.amplitudes);
            let pairs: Vec<[f64; 2]> = strikes
                .map(|((point, level), amplitudes)| [amplitudes[k], level * self.across[k][*point]])
                .collect();
            let both: f64 = pairs.iter().map(|[x, y]| x * y).sum();
            let own: f64 = pairs.iter().map(|[_, y]| y * y).sum();
            *gain = if own > 0.0 { both / own } else { 0.0 };
            solved.lost += pairs.iter().map(|[x, y]| (x - *gain * y).powi(2)).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::mode::Mode;
    use asperity_dsp::rng::Rng;
    use core::f64::consts::{FRAC_PI_2, PI};

    const SIDE: [usize; 2] = [24, 18];

    /// A plate held at its edges: 12 shapes on a grid without the edges.
    fn plate() -> Vec<(f64, Vec<f64>)> {
        let at = |n: usize| [(n % SIDE[0] + 1) as f64 / 25.0, (n / SIDE[0] + 1) as f64 / 19.0];
        let orders = (1..=4).flat_map(|a| (1..=3).map(move |b| [f64::from(a), f64::from(b)]));
        orders
            .map(|[a, b]| {
                let across = (0..SIDE[0] * SIDE[1]).map(at);
                let across = across.map(|[x, y]| (a * PI * x).sin() * (b * PI * y).sin()).collect();
                (90.0 * (a * a + 1.78 * b * b), across)
            })
            .collect()
    }

    fn shapes(plate: &[(f64, Vec<f64>)]) -> Vec<Shape<'_>> {
        plate.iter().map(|(frequency_hz, across)| Shape { frequency_hz: *frequency_hz, across }).collect()
    }

    /// Strikes of it, heard through a gain a mode, `noise` of each amplitude wrong.
    fn struck(plate: &[(f64, Vec<f64>)], points: &[usize], noise: f64, rng: &mut Rng) -> Merged {
        let gains: Vec<f64> = plate.iter().map(|_| rng.normal().exp()).collect();
        let strike = |point: &usize| {
            let hard = 0.5 + rng.uniform();
            let mode = |((hz, across), gain): (&(f64, Vec<f64>), &f64)| {
                let x = hard * gain * across[*point] * (1.0 + noise * rng.normal());
                // Turned round is half a turn on; the computed body is 3 % too soft.
                let phase_rad = if x < 0.0 { -FRAC_PI_2 } else { FRAC_PI_2 };
                Mode { frequency_hz: 1.03 * hz, decay_per_s: 5.0, amplitude: x.abs(), phase_rad }
            };
            plate.iter().zip(&gains).map(mode).collect()
        };
        let strikes: Vec<Vec<Mode>> = points.iter().map(strike).collect();
        Merged { seen: vec![points.len(); plate.len()], strikes }
    }

    /// Distance in cells to a place or one of its mirror images.
    fn off(found: usize, wanted: usize) -> f64 {
        let folded = |n: usize, side: usize| n.min(side - 1 - n) as f64;
        let at = |n: usize| [folded(n % SIDE[0], SIDE[0]), folded(n / SIDE[0], SIDE[1])];
        let (a, b) = (at(found), at(wanted));
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    #[test]
    fn strikes_on_a_plate_are_located_and_other_shapes_explain_little() {
        let (plate, mut rng) = (plate(), Rng::new(30));
        let (mut least, mut most) = (1.0_f64, f64::NEG_INFINITY);
        for _ in 0..6 {
            let points: Vec<usize> = (0..5)
                .map(|_| {
                    2 + (20.0 * rng.uniform()) as usize + SIDE[0] * (2 + (14.0 * rng.uniform()) as usize)
                })
                .collect();
            let merged = struck(&plate, &points, 0.02, &mut rng);
            let found = places(&merged, &shapes(&plate)).unwrap();
            assert!((found.frequency_factor - 1.03).abs() < 0.01 && found.modes.len() == 12);
            let worst =
                found.points.iter().zip(&points).fold(0.0_f64, |worst, (a, b)| worst.max(off(*a, *b)));
            println!("worst {worst:.1} cells, R² {:.4}", found.r_squared);
            assert!(worst <= 2.0, "{:?} for {points:?}", found.points);
            least = least.min(found.r_squared);
            // Frequencies as they are, shapes of any other mode.
            let mut other = plate.clone();
            for k in 0..12 {
                other[k].1.clone_from(&plate[(5 * k + 7) % 12].1);
            }
            most = most.max(places(&merged, &shapes(&other)).unwrap().r_squared);
        }
        println!("R² {least:.4} at least; of other shapes {most:.4} at most");
        assert!(least > 0.98 && most < 0.8, "{least} {most}");
    }

    #[test]
    fn one_strike_and_shapes_of_other_pitches_have_no_places() {
        let (plate, mut rng) = (plate(), Rng::new(1));
        assert_eq!(places(&struck(&plate, &[40], 0.0, &mut rng), &shapes(&plate)), None);
        let high: Vec<(f64, Vec<f64>)> =
            plate.iter().map(|(hz, across)| (40.0 * hz, across.clone())).collect();
        assert_eq!(places(&struck(&plate, &[40, 90], 0.0, &mut rng), &shapes(&high)), None);
    }
}
