//! Exact regime maps with located events.
//!
//! A sample whose two ends lie in one regime costs one map. Otherwise the sample is walked in a
//! binary tree: a piece that ends in the other regime is halved, down to a tick; the tick in which
//! skin and surface meet or part is taken whole and the force it had too much or too little,
//! k_m·g linear in time over the part ρ of the tick after the event, is given back as
//! Δv = k_m |g| ρ / 2m_s and Δx = Δv ρ / 3 (error of fourth order in ω_c ρ). No root is searched and
//! no exponential computed at run time; every node of the tree is visited at most once, so a sample
//! costs at most 2·64 − 1 = 127 maps.
//!
//! The profile over a step is the Catmull-Rom cubic through four heights, hence one sample of
//! latency; the force is the mean of both ends.

use super::flow::{MAX_LEVEL, Regime};
use super::guard::{CleanBlock, rescue};
use super::{ContactSample, ContactState, MicroContact, Onset, Probe};

/// ω_c·(tick) that events are located to, radians.
const TICK_PHASE: f64 = 0.07;
/// Longest pressed map, radians: a longer one could leave and come back unseen.
const PRESSED_PHASE: f64 = 1.0;

/// Coefficients of the scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ExactEvent {
    /// Free, pressed.
    regimes: [Regime; 2],
    /// Coarsest level of each regime.
    coarsest: [usize; 2],
    /// Level of a tick.
    finest: usize,
    step_s: f64,
    /// k_m/m_s, 1/s².
    stiffness_per_mass: f64,
    /// m_s/h and m_f/h, kg/s.
    mass_rate: [f64; 2],
}

/// What one step came to.
struct Step {
    y: [f64; 4],
    touched: bool,
    onset: Option<Onset>,
}

impl ExactEvent {
    pub fn new(probe: &Probe, step_s: f64) -> Self {
        let phase = probe.contact_rate_per_s() * step_s;
        let level_for = |limit: f64| libm::ceil(libm::log2((phase / limit).max(1.0))) as usize;
        Self {
            regimes: [
                Regime::new(probe, 0.0, step_s),
                Regime::new(probe, probe.contact_stiffness_n_m, step_s),
            ],
            coarsest: [0, level_for(PRESSED_PHASE).min(MAX_LEVEL)],
            finest: level_for(TICK_PHASE).clamp(3, MAX_LEVEL),
            step_s,
            stiffness_per_mass: probe.contact_stiffness_n_m / probe.pad_mass_kg,
            mass_rate: [probe.pad_mass_kg / step_s, probe.finger_mass_kg / step_s],
        }
    }

    /// Runs one clean block; row n describes input n − 1.
    #[inline(always)]
    pub fn run(
        &self,
        design: &MicroContact,
        state: &mut ContactState,
        block: &CleanBlock,
        out: &mut [ContactSample],
    ) {
        let [mut h0, mut h1, mut h2] = state.heights_m;
        let [mut f1, mut f2] = state.forces_n;
        let mut y = state.y;
        for ((out, &h3), &f3) in out.iter_mut().zip(&block.height_m).zip(&block.force_n) {
            let c = catmull_rom(h1 - h0, h2 - h1, h3 - h2);
            let force = 0.5 * (f1 + f2);
            let pressed = usize::from(y[0] < 0.0);
            let next = self.regimes[pressed].maps[0].apply(y, c, force);
            let smooth = self.coarsest[pressed] == 0 && usize::from(next[0] < 0.0) == pressed;
            let step = if smooth {
                Step { y: next, touched: pressed == 1, onset: None }
            } else {
                self.walk(y, c, force)
            };
            let contact_force_n = if step.touched {
                let momentum =
                    self.mass_rate[0] * (step.y[2] - y[2]) + self.mass_rate[1] * (step.y[3] - y[3]);
                (force + momentum).max(0.0)
            } else {
                0.0
            };
            y = step.y;
            if !(y[0] <= design.leash_m && y[0] >= -design.max_penetration_m)
                && rescue(design, &mut y, step.y[0], f2)
            {
                state.resets = state.resets.saturating_add(1);
            }
            let pad_m = h2 + y[0];
            *out = ContactSample {
                height_m: h2,
                normal_force_n: f2,
                pad_m,
                pad_velocity_m_s: y[2],
                finger_m: pad_m - y[1],
                contact_force_n,
                onset: step.onset,
            };
            (h0, h1, h2) = (h1, h2, h3);
            (f1, f2) = (f2, f3);
        }
        state.heights_m = [h0, h1, h2];
        state.forces_n = [f1, f2];
        state.y = y;
        state.gap_m = y[0];
    }

    /// One sample with events, piece by piece.
    #[cold]
    #[inline(never)]
    fn walk(&self, mut y: [f64; 4], mut c: [f64; 3], force_n: f64) -> Step {
        let ticks = 1_usize << self.finest;
        let (mut now, mut level) = (0, 0);
        let (mut touched, mut onset) = (false, None);
        while now < ticks {
            let pressed = usize::from(y[0] < 0.0);
            level = level.max(self.coarsest[pressed].min(self.finest));
            let mut next = self.regimes[pressed].maps[level].apply(y, c, force_n);
            let event = usize::from(next[0] < 0.0) != pressed;
            if event && level < self.finest {
                level += 1;
                continue;
            }
            let size = 1.0 / (1_usize << level) as f64;
            if event {
                let at = self.split(y[0], &mut next, size);
                if pressed == 0 {
                    let touch = Onset {
                        offset: (now as f64 / ticks as f64 + at * size).min(1.0),
                        closing_m_s: at_least_zero(y[0] - next[0]) / (size * self.step_s),
                    };
                    onset = harder(onset, touch);
                }
            }
            touched |= pressed == 1 || event;
            y = next;
            c = [c[0] + size * (2.0 * c[1] + 3.0 * size * c[2]), c[1] + 3.0 * size * c[2], c[2]];
            now += ticks >> level;
            while level > 0 && now % (ticks >> (level - 1)) == 0 {
                level -= 1;
            }
        }
        Step { y, touched, onset }
    }

    /// Corrects a tick that ended in the other regime; returns where in the tick the event lies.
    #[inline(always)]
    fn split(&self, before: f64, next: &mut [f64; 4], size: f64) -> f64 {
        let past = next[0].abs();
        let at = before.abs() / (before.abs() + past).max(f64::MIN_POSITIVE);
        let rest_s = (1.0 - at) * size * self.step_s;
        let kick = 0.5 * self.stiffness_per_mass * past * rest_s;
        let shift = kick * rest_s * (1.0 / 3.0);
        next[0] += shift;
        next[1] += shift;
        next[2] += kick;
        at
    }
}

/// Coefficients of the cubic between the middle two of four heights, from the three differences.
#[inline(always)]
fn catmull_rom(before: f64, inside: f64, after: f64) -> [f64; 3] {
    [0.5 * (before + inside), (1.5 * inside - before) - 0.5 * after, 0.5 * (before + after) - inside]
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
