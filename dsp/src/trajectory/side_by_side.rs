//! Paths side by side: the filters of four contacts in the lanes of one vector, each path with the bits it has alone.
//!
//! What a path's filters are given ([`Trajectory::inputs`]) is made contact by contact; then three vectors, u, v and force, go through the
//! operations of [`State::tick`] in their order, of which each waits for the one before. Paths that rest, that estimate their motion, or that would
//! pass the grid on which stillness is looked for go alone.

use super::{PathMode, PathPoint, STILL_GRID, Trajectory, TrajectoryDesign};
use crate::butterworth::{Butterworth, State};
use crate::simd::{Level, Set, at_level};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

/// How many go side by side.
const LANES: usize = 4;
/// Samples of a stretch at most.
const LONGEST: usize = STILL_GRID as usize;

/// One of several paths.
pub struct Beside<'a> {
    /// Its design.
    pub design: TrajectoryDesign,
    /// The path.
    pub path: &'a mut Trajectory,
    /// Its next points.
    pub out: &'a mut [PathPoint],
}

/// Makes the next points of several paths; each gets those of [`Trajectory::advance`], to the bit.
pub fn advance_side_by_side(level: Level, paths: &mut [Beside<'_>]) {
    if !go_together(paths) {
        for Beside { design, path, out } in paths {
            path.advance(design, out);
        }
        return;
    }
    let mut last = [[[0.0; 3]; 2]; LANES];
    for Beside { design, path, out } in &mut *paths {
        path.inputs(design, out);
    }
    at_level!(level.at_most_256_bits(), s => filter(s, paths, &mut last));
    for (Beside { design, path, out }, [input, low]) in paths.iter_mut().zip(last) {
        path.come_to(design, (&input, low), out, None);
    }
}

/// Whether two to four paths are all on their way, for equally long within their grids.
fn go_together(paths: &[Beside<'_>]) -> bool {
    let n = paths.first().map_or(0, |first| first.out.len());
    let fits = |Beside { design, path, out }: &Beside<'_>| {
        !path.still
            && design.mode != PathMode::BandLimited
            && out.len() == n
            && (path.sample % STILL_GRID) as usize + n <= LONGEST
    };
    n > 0 && (2..=LANES).contains(&paths.len()) && paths.iter().all(fits)
}

/// A number of each contact.
#[inline(always)]
fn each<S: Simd>(s: S, paths: &[Beside<'_>], of: impl Fn(&Beside<'_>) -> f64) -> f64x4<S> {
    let mut lanes = [0.0; LANES];
    for (lane, path) in lanes.iter_mut().zip(paths) {
        *lane = of(path);
    }
    f64x4::load_array(s, lanes)
}

/// One filter of each contact.
#[derive(Clone, Copy)]
struct Filters<S: Simd> {
    a: [f64x4<S>; 3],
    band_to_band: f64x4<S>,
    cross: f64x4<S>,
    input_to_low: f64x4<S>,
}

/// Where one filter of each contact stands.
#[derive(Clone, Copy)]
struct States<S: Simd> {
    band: f64x4<S>,
    low: f64x4<S>,
}

impl<S: Simd> States<S> {
    #[inline(always)]
    fn of(s: S, paths: &[Beside<'_>], state: impl Fn(&Trajectory) -> State) -> Self {
        Self {
            band: each(s, paths, |beside| state(beside.path).band),
            low: each(s, paths, |beside| state(beside.path).low),
        }
    }

    /// Band and low response; [`State::tick`].
    #[inline(always)]
    fn tick(&mut self, filters: &Filters<S>, input: f64x4<S>) -> [f64x4<S>; 2] {
        let [a1, a2, a3] = filters.a;
        let v3 = input - self.low;
        let band = a1 * self.band + a2 * v3;
        let low = (self.low + a2 * self.band) + a3 * v3;
        let before = self.band;
        self.band = filters.band_to_band * before + filters.cross * v3;
        self.low = (self.low + filters.cross * before) + filters.input_to_low * v3;
        [band, low]
    }

    #[inline(always)]
    fn states(self) -> [State; LANES] {
        let (band, low) = (self.band.to_array(), self.low.to_array());
        core::array::from_fn(|lane| State { band: band[lane], low: low[lane] })
    }
}

/// Runs the filters over the inputs in the points' places; the last input and low response of each go to `ends`.
#[inline(always)]
fn filter<S: Set>(s: S, paths: &mut [Beside<'_>], ends: &mut [[[f64; 3]; 2]; LANES]) {
    let number = |of: fn(&Butterworth) -> f64| each(s, paths, |beside| of(&beside.design.filter));
    let filters = Filters {
        a: [number(|f| f.a1), number(|f| f.a2), number(|f| f.a3)],
        band_to_band: number(|f| f.band_to_band),
        cross: number(|f| f.cross),
        input_to_low: number(|f| f.input_to_low),
    };
    let origin = [0, 1].map(|axis| each(s, paths, |beside| beside.path.origin_m[axis]));
    let to_speed = each(s, paths, |beside| beside.design.band_to_speed);
    let mut axes = [0, 1].map(|axis| States::of(s, paths, |path| path.axes[axis]));
    let mut pressing = States::of(s, paths, |path| path.force);
    let n = paths[0].out.len();
    let mut last = [[f64x4::splat(s, 0.0); 3]; 2];
    for i in 0..n {
        let input = |of: fn(&PathPoint) -> f64| each(s, paths, |beside| beside.out.get(i).map_or(0.0, of));
        let input =
            [input(|at| at.position_m[0]), input(|at| at.position_m[1]), input(|at| at.normal_force_n)];
        let [[u_band, u_low], [v_band, v_low]] =
            [axes[0].tick(&filters, input[0]), axes[1].tick(&filters, input[1])];
        let [_, force_low] = pressing.tick(&filters, input[2]);
        last = [input, [u_low, v_low, force_low]];
        let points =
            s.transpose([origin[0] + u_low, origin[1] + v_low, u_band * to_speed, v_band * to_speed]);
        let force_n = force_low.to_array();
        for ((beside, point), force_n) in paths.iter_mut().zip(points).zip(force_n) {
            if let Some(out) = beside.out.get_mut(i) {
                let [u_m, v_m, u_m_s, v_m_s] = point.to_array();
                *out = PathPoint {
                    position_m: [u_m, v_m],
                    velocity_m_s: [u_m_s, v_m_s],
                    normal_force_n: force_n.max(0.0),
                };
            }
        }
    }
    let (axes, pressing) = (axes.map(States::states), pressing.states());
    let last = last.map(|numbers| numbers.map(f64x4::to_array));
    for (lane, beside) in paths.iter_mut().enumerate() {
        beside.path.axes = [axes[0][lane], axes[1][lane]];
        beside.path.force = pressing[lane];
        ends[lane] = last.map(|numbers| numbers.map(|number| number[lane]));
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::PathEvent;
    use super::*;
    use crate::rng::Rng;
    use std::{vec, vec::Vec};

    #[test]
    fn paths_of_four_contacts_have_the_bits_of_each_alone_wherever_blocks_are_cut() {
        let mut rng = Rng::new(31);
        let modes = [PathMode::Extrapolate, PathMode::Hermite, PathMode::Hold, PathMode::BandLimited];
        for level in Level::available() {
            for only in [LANES, 1] {
                let designs: Vec<TrajectoryDesign> = (0..LANES)
                    .map(|i| {
                        let cutoff_hz = 20.0 + 20.0 * rng.uniform();
                        TrajectoryDesign::new(modes[i % only], cutoff_hz, 44_100.0, [0.14, f64::INFINITY])
                            .unwrap()
                    })
                    .collect();
                let mut report = |sample: u64| PathEvent {
                    sample,
                    fraction: rng.uniform(),
                    position_m: [0.14 * rng.uniform(), 0.002 * rng.uniform()],
                    velocity_m_s: (rng.uniform() < 0.7).then(|| [0.0, 0.1 * rng.normal()]),
                    normal_force_n: rng.uniform(),
                };
                let mut alone: Vec<Trajectory> =
                    designs.iter().map(|design| Trajectory::begin(design, &report(0))).collect();
                let mut beside = alone.clone();
                let mut cuts = Rng::new(7);
                let (mut at, mut rested) = (0, 0);
                while at < 30_000 {
                    // Never beyond the grid, as the engine's stretches; for a while nobody reports, and they come to rest.
                    let n = (1 + (70.0 * cuts.uniform()) as u64).min(64 - at % 64);
                    for (i, design) in designs.iter().enumerate() {
                        if cuts.uniform() < 0.03 && !(8_000..26_000).contains(&at) {
                            let event = report(at);
                            alone[i].moved(design, &event);
                            beside[i].moved(design, &event);
                        }
                    }
                    rested += alone.iter().filter(|path| path.is_still()).count();
                    let mut expected = vec![[PathPoint::default(); LONGEST]; LANES];
                    let mut points = expected.clone();
                    for ((path, design), out) in alone.iter_mut().zip(&designs).zip(&mut expected) {
                        path.advance(design, &mut out[..n as usize]);
                    }
                    let count = 1 + (4.0 * cuts.uniform()) as usize;
                    let mut paths: Vec<Beside<'_>> = beside
                        .iter_mut()
                        .zip(&designs)
                        .zip(&mut points)
                        .map(|((path, design), out)| Beside {
                            design: *design,
                            path,
                            out: &mut out[..n as usize],
                        })
                        .collect();
                    let (first, others) = paths.split_at_mut(count.min(LANES));
                    advance_side_by_side(level, first);
                    advance_side_by_side(level, others);
                    assert_eq!((&points, &beside), (&expected, &alone), "{level:?}, sample {at}");
                    at += n;
                }
                assert!(rested > 0, "nobody came to rest");
            }
        }
    }
}
