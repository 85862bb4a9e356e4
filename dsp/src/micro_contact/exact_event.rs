//! Exact regime maps with located events.
//!
//! A sample whose two ends lie in one regime costs one map. Where its ground bends a pad can land
//! and leave, or leave and land, within it: it is asked midway too, and at the quarters where those
//! are known (that alone is worth 4–20 dB on a hopping pad, each time). Otherwise the sample is
//! walked in a binary tree: a piece that ends in the other regime is halved, down to a tick; the
//! tick in which skin and surface meet or part is taken whole, and the force it had too much or too
//! little, k_m·g with g a parabola over the part ρ of the tick after the event, is given back as
//! its integrals Δv = (k_m/m_s) ρ (4g − ġρ)/6 and Δx = (k_m/m_s) ρ² (3g − ġρ)/12 (g, ġ at the end
//! of the tick): an undamped finger bouncing for 10 s gains less than 1e-6 of its energy to 5e6
//! N/m. No exponential is computed at run time; every node of the tree is visited at most once, so
//! a sample costs at most 2·64 − 1 = 127 maps.
//!
//! The profile over a step is the Catmull-Rom cubic through four heights, hence one sample of
//! latency, and what is known to bend beside it ([`SubSampleProfile`]); the force is the mean of
//! both ends.

use super::flow::{MAX_LEVEL, Regime};
use super::guard::{CleanBlock, MAX_PENETRATION_M, rescue};
use super::quad::{F64x4, Unfused};
use super::quartic_correction::{QuarticCorrection, SubSampleProfile};
use super::{ContactSample, ContactState, MicroContact, Onset, Probe};
use crate::simd::{Level, at_level};
use fearless_simd::{SimdBase, f64x4};

/// ω_c·(tick) that events are located to, radians.
const TICK_PHASE: f64 = 0.07;
/// Longest pressed map, radians: a longer one could leave and come back unseen.
const PRESSED_PHASE: f64 = 1.0;

/// Kinds of [`SubSampleProfile`], for what is compiled for each. Ground that bends can meet a pad
/// and leave it within a sample: it is looked at wherever it is known, in pieces of 2⁻¹ of a sample
/// or of 2⁻².
pub(super) const AT_SAMPLES: u8 = 0;
pub(super) const MIDWAY: u8 = 1;
pub(super) const QUARTERS: u8 = 2;

/// The profile of a sample as it is walked along.
#[derive(Clone, Copy)]
pub(super) struct Profile {
    pub(super) c: [f64; 4],
    /// From midway on, where that is another polynomial.
    pub(super) later: Option<[f64; 4]>,
    /// Its pieces are of this level or finer.
    pub(super) least: usize,
}

/// Coefficients of the scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ExactEvent {
    /// Free, pressed.
    pub(super) regimes: [Regime; 2],
    /// Coarsest level of each regime.
    pub(super) coarsest: [usize; 2],
    /// Level of a tick.
    finest: usize,
    step_s: f64,
    /// k_m/m_s, 1/s².
    stiffness_per_mass: f64,
    /// m_s/h and m_f/h, kg/s.
    pub(super) mass_rate: [f64; 2],
}

/// Result of one step.
pub(super) struct Step {
    pub(super) y: [f64; 4],
    pub(super) touched: bool,
    pub(super) onset: Option<Onset>,
    /// Maps it took; the tests hold the promise of the module with it.
    #[cfg_attr(not(test), expect(dead_code))]
    maps: u32,
}

/// Moment at which skin and surface meet or part.
struct Event {
    /// Place in its tick, 0…1.
    at: f64,
    /// Speed at which the gap closes there, m/s.
    closing_m_s: f64,
}

impl ExactEvent {
    pub fn new(probe: &Probe, step_s: f64) -> Self {
        Self::beside(Regime::new(probe, 0.0, step_s), probe, step_s)
    }

    /// The scheme of a probe whose free regime is known: it is that of any contact stiffness.
    pub fn beside(free: Regime, probe: &Probe, step_s: f64) -> Self {
        let phase = probe.contact_rate_per_s() * step_s;
        let level_for = |limit: f64| libm::ceil(libm::log2((phase / limit).max(1.0))) as usize;
        Self {
            regimes: [free, Regime::new(probe, probe.contact_stiffness_n_m, step_s)],
            coarsest: [0, level_for(PRESSED_PHASE).min(MAX_LEVEL)],
            finest: level_for(TICK_PHASE).clamp(3, MAX_LEVEL),
            step_s,
            stiffness_per_mass: probe.contact_stiffness_n_m / probe.pad_mass_kg,
            mass_rate: [probe.pad_mass_kg / step_s, probe.finger_mass_kg / step_s],
        }
    }

    /// The scheme between two that differ in the contact's stiffness.
    pub fn interpolate(&mut self, softer: &Self, harder: &Self, share: f64, rest_m_n: [f64; 2]) {
        self.regimes[0] = softer.regimes[0];
        self.regimes[1].interpolate(&softer.regimes[1], &harder.regimes[1], share, rest_m_n);
        (self.coarsest, self.finest) = (harder.coarsest, harder.finest);
        (self.step_s, self.mass_rate) = (softer.step_s, softer.mass_rate);
        self.stiffness_per_mass =
            softer.stiffness_per_mass + share * (harder.stiffness_per_mass - softer.stiffness_per_mass);
    }

    /// Runs one clean block; row n describes input n − 1, and so does what is known of the ground:
    /// it ends at that input.
    #[inline(always)]
    pub fn run<Q: F64x4>(
        &self,
        quad: Q,
        design: &MicroContact,
        state: &mut ContactState,
        (block, ground): (&CleanBlock, SubSampleProfile<'_>),
        out: &mut [ContactSample],
    ) {
        match ground {
            SubSampleProfile::AtSamples => self.run_on::<Q, AT_SAMPLES>(quad, design, state, block, &[], out),
            SubSampleProfile::Midway(quartic_correction) => {
                self.run_on::<Q, MIDWAY>(quad, design, state, block, quartic_correction, out)
            }
            SubSampleProfile::Quarters(halves) => {
                self.run_on::<Q, QUARTERS>(quad, design, state, block, halves.as_flattened(), out);
            }
        }
    }

    /// Steps on one kind of ground: a bend a sample, or two.
    #[inline(always)]
    fn run_on<Q: F64x4, const KIND: u8>(
        &self,
        quad: Q,
        design: &MicroContact,
        state: &mut ContactState,
        block: &CleanBlock,
        quartic_correction: &[QuarticCorrection],
        out: &mut [ContactSample],
    ) {
        let [mut h0, mut h1, mut h2] = state.heights_m;
        let [mut f1, mut f2] = state.forces_n;
        let mut y = quad.load(&state.y);
        // Changes with events only, so that no map waits for a comparison.
        let mut pressed = state.y[0] < 0.0;
        for (n, ((out, &h3), &f3)) in out.iter_mut().zip(&block.height_m).zip(&block.force_n).enumerate() {
            let [c1, c2, c3] = catmull_rom(h1 - h0, h2 - h1, h3 - h2);
            let force = 0.5 * (f1 + f2);
            let which = usize::from(pressed);
            let maps = &self.regimes[which].maps;
            let bend = |half: usize| quartic_correction.get(half).copied().unwrap_or_default();
            let (mut c, mut later) = ([c1, c2, c3, 0.0], None);
            let (next, mut stays) = match KIND {
                MIDWAY => {
                    let [b1, b2, b3, b4] = bend(n);
                    c = [c1 + b1, c2 + b2, c3 + b3, b4];
                    let gap_m = maps[1].apply(y, c, force).first();
                    (maps[0].apply(y, c, force), (gap_m < 0.0) == pressed && self.coarsest[which] == 0)
                }
                QUARTERS => {
                    let ([a1, a2, a3, a4], [b1, b2, b3, b4]) = (bend(2 * n), bend(2 * n + 1));
                    c = [c1 + a1, c2 + a2, c3 + a3, a4];
                    let [l1, l2, l3] = from_midway([c1, c2, c3]);
                    let end = [l1 + b1, l2 + b2, l3 + b3, b4];
                    later = Some(end);
                    let middle = maps[1].apply(y, c, force);
                    let (early, late) = (maps[2].apply(y, c, force), maps[2].apply(middle, end, force));
                    let touches = |at: Q| at.first() < 0.0;
                    let alike = (touches(middle) == pressed) & (touches(early) == pressed);
                    let alike = alike & (touches(late) == pressed);
                    (maps[1].apply(middle, end, force), alike && self.coarsest[which] <= 1)
                }
                _ => (maps[0].apply_cubic(y, [c1, c2, c3], force), self.coarsest[which] == 0),
            };
            stays &= (next.first() < 0.0) == pressed;
            let before = y.array();
            let (mut touched, mut onset) = (pressed, None);
            if stays {
                y = next;
            } else {
                let profile = Profile { c, later, least: usize::from(KIND) };
                let step = self.walk(design.level, before, &profile, force);
                (touched, onset) = (step.touched, step.onset);
                y = quad.load(&step.y);
                pressed = y.first() < 0.0;
            }
            let after = y.array();
            let momentum =
                self.mass_rate[0] * (after[2] - before[2]) + self.mass_rate[1] * (after[3] - before[3]);
            let contact_force_n = if touched { at_least_zero(force + momentum) } else { 0.0 };
            if !(y.first() <= design.leash_m && y.first() >= -MAX_PENETRATION_M) {
                let mut lost = after;
                if rescue(design, &mut lost, after[0], f2, state.rise_m_s.max(0.0)) {
                    state.resets = state.resets.saturating_add(1);
                }
                y = quad.load(&lost);
                pressed = lost[0] < 0.0;
            }
            let [gap_m, stretch_m, pad_velocity_m_s, _] = y.array();
            let pad_m = h2 + gap_m;
            *out = ContactSample {
                height_m: h2,
                normal_force_n: f2,
                pad_m,
                pad_velocity_m_s,
                finger_m: pad_m - stretch_m,
                contact_force_n,
                onset,
            };
            (h0, h1, h2) = (h1, h2, h3);
            (f1, f2) = (f2, f3);
        }
        state.heights_m = [h0, h1, h2];
        state.forces_n = [f1, f2];
        state.y = y.array();
        state.gap_m = y.first();
    }

    /// One sample with events, piece by piece. Products and sums round apart on every level.
    #[cold]
    #[inline(never)]
    pub(super) fn walk(&self, level: Level, y: [f64; 4], profile: &Profile, force_n: f64) -> Step {
        at_level!(level.at_most_256_bits(), s => {
            let zero: f64x4<_> = SimdBase::splat(s, 0.0);
            self.walk_in(Unfused(zero), y, profile, force_n)
        })
    }

    #[inline(always)]
    fn walk_in<Q: F64x4>(&self, quad: Q, mut y: [f64; 4], profile: &Profile, force_n: f64) -> Step {
        let Profile { mut c, later, least } = *profile;
        let ticks = 1_usize << self.finest;
        let (mut now, mut level) = (0, 0);
        let (mut touched, mut onset, mut maps) = (false, None, 0);
        while now < ticks {
            let pressed = usize::from(y[0] < 0.0);
            level = level.max(self.coarsest[pressed].max(least).min(self.finest));
            let mut next = self.regimes[pressed].maps[level].apply(quad.load(&y), c, force_n).array();
            maps += 1;
            let event = usize::from(next[0] < 0.0) != pressed;
            if event && level < self.finest {
                level += 1;
                continue;
            }
            let size = 1.0 / (1_usize << level) as f64;
            let end = at_end(c, size);
            if event {
                let event = self.split(quad, y[0], &mut next, end[0] / self.step_s, size * self.step_s);
                if pressed == 0 {
                    let touch = Onset {
                        offset: (now as f64 / ticks as f64 + event.at * size).clamp(0.0, 1.0),
                        closing_m_s: event.closing_m_s,
                    };
                    onset = harder(onset, touch);
                }
            }
            touched |= pressed == 1 || event;
            y = next;
            c = end;
            now += ticks >> level;
            if now == ticks / 2 {
                c = later.unwrap_or(c);
            }
            while level > 0 && now % (ticks >> (level - 1)) == 0 {
                level -= 1;
            }
        }
        Step { y, touched, onset, maps }
    }

    /// Corrects a tick of `tick_s` that ended in the other regime; `slope_m_s` is the profile's at
    /// its end.
    #[inline(always)]
    fn split<Q: F64x4>(
        &self,
        quad: Q,
        before: f64,
        next: &mut [f64; 4],
        slope_m_s: f64,
        tick_s: f64,
    ) -> Event {
        // Penetration at the end, its rate and its bend, with the sign turned so that it ends
        // positive.
        let sign = if next[0] < 0.0 { 1.0 } else { -1.0 };
        let (past, past_before) = (-sign * next[0], -sign * before);
        let rate = sign * (slope_m_s - next[2]);
        let bend = 2.0 * (past_before - past + rate * tick_s) / (tick_s * tick_s);
        // Time from the event to the end: the parabola's root in the tick. It ends positive and
        // begins negative, so there is one.
        let falls = quad.root(at_least_zero(rate * rate - 2.0 * bend * past));
        let rest_s = (2.0 * past / (rate + falls).max(f64::MIN_POSITIVE)).clamp(0.0, tick_s);
        let kick = rest_s * (4.0 * past - rate * rest_s) * (1.0 / 6.0) * self.stiffness_per_mass;
        let shift = rest_s * rest_s * (3.0 * past - rate * rest_s) * (1.0 / 12.0) * self.stiffness_per_mass;
        next[0] += shift;
        next[1] += shift;
        next[2] += kick;
        // The speed at the event itself: a mean over the tick would jump from tick to tick, by 4 %
        // where the ground rises steeply.
        Event { at: 1.0 - rest_s / tick_s, closing_m_s: falls }
    }
}

/// Coefficients of the cubic between the middle two of four heights, from the three differences.
#[inline(always)]
fn catmull_rom(before: f64, inside: f64, after: f64) -> [f64; 3] {
    [0.5 * (before + inside), (1.5 * inside - before) - 0.5 * after, 0.5 * (before + after) - inside]
}

/// The coefficients of a profile seen from `size` of a sample later.
#[inline(always)]
pub(super) fn at_end(c: [f64; 4], size: f64) -> [f64; 4] {
    let [c1, c2, c3, c4] = c;
    let (cubic, fourth) = (3.0 * size * c3, size * size * c4);
    [c1 + size * (2.0 * c2 + (cubic + 4.0 * fourth)), c2 + (cubic + 6.0 * fourth), c3 + 4.0 * size * c4, c4]
}

/// The coefficients of a cubic seen from the middle of its sample.
#[inline(always)]
pub(super) fn from_midway([c1, c2, c3]: [f64; 3]) -> [f64; 3] {
    [c1 + (c2 + 0.75 * c3), c2 + 1.5 * c3, c3]
}

fn at_least_zero(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}

fn harder(known: Option<Onset>, new: Onset) -> Option<Onset> {
    match known {
        Some(known) if known.closing_m_s >= new.closing_m_s => Some(known),
        _ => Some(new),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn plain(c: [f64; 4]) -> Profile {
        Profile { c, later: None, least: 0 }
    }

    /// Ground that rises as c t² meets a pad at rest g above it with 2 √(c g), wherever the ticks
    /// lie.
    #[test]
    fn a_collision_takes_the_ground_speed_of_its_instant() {
        let step_s = 1.0 / 44.1e3;
        let exact = ExactEvent::new(&Probe::default(), step_s);
        let rise_m = 1e-5;
        for share in 1..1000 {
            let gap_m = rise_m * f64::from(share) / 1000.0;
            let met = exact
                .walk(Level::detect(), [gap_m, 0.0, 0.0, 0.0], &plain([0.0, rise_m, 0.0, 0.0]), 0.0)
                .onset
                .unwrap();
            let (at, closing_m_s) = (libm::sqrt(gap_m / rise_m), 2.0 * libm::sqrt(rise_m * gap_m) / step_s);
            assert!((met.offset - at).abs() < 1e-6, "{gap_m}: at {} and not {at}", met.offset);
            let off = met.closing_m_s / closing_m_s - 1.0;
            assert!(off.abs() < 1e-6, "{gap_m}: {} m/s and not {closing_m_s}", met.closing_m_s);
        }
    }

    #[test]
    fn no_sample_takes_more_than_127_maps_however_wild_it_is() {
        let mut rng = Rng::new(11);
        let mut worst = 0;
        for stiffness in [1e3, 5e4, 1e6, 5e6, 1e9] {
            for rate_hz in [8e3, 44.1e3, 192e3] {
                let probe =
                    Probe { contact_stiffness_n_m: stiffness, pad_damping_n_s_m: 0.0, ..Probe::default() };
                let exact = ExactEvent::new(&probe, 1.0 / rate_hz);
                for _ in 0..4000 {
                    let size = 1e-6 * libm::exp2(20.0 * rng.uniform() - 10.0);
                    let c = [(); 4].map(|()| rng.normal() * size);
                    let speed = size * rate_hz * rng.normal();
                    let y = [rng.normal() * size * 0.3, 0.0, speed, 0.0];
                    let profile = Profile { c, later: Some(c.map(|c| -c)), least: usize::from(QUARTERS) };
                    let step = exact.walk(Level::detect(), y, &profile, 0.5);
                    assert!(step.y.iter().all(|y| y.is_finite()));
                    worst = worst.max(step.maps);
                }
            }
        }
        assert!(worst <= 127, "{worst} maps");
        assert!(worst > 10, "the inputs were not wild: {worst} maps");
    }

    #[test]
    fn the_cubic_passes_through_its_heights_with_their_slopes() {
        let [c1, c2, c3] = catmull_rom(1.0, 3.0, 5.0);
        assert_eq!(c1 + c2 + c3, 3.0);
        assert_eq!((c1, c1 + 2.0 * c2 + 3.0 * c3), (2.0, 4.0));
    }
}
