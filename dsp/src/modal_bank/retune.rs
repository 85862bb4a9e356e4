//! Changing a ringing group's modes without a jump and without energy from nowhere.
//!
//! With z = (y cos θ − R (y − d)) / sin θ + i y, a free step is z ← R e^(iθ) z, and the output is
//! Im(C z) with C from the output gains. On a change the *output's* complex amplitude C z is kept: the
//! sound goes on at the same level and phase, with the new frequency and decay from the next sample.
//! Kept as they are, the bare states (y, d) gain 58 dB when the frequency jumps by 1.5 every 64 samples.

use super::LANES;
use super::design::{GroupState, ModeGroup, StoredPole};

/// The pole and the output phasor that a lane's coefficients stand for.
struct Lane {
    pole: StoredPole,
    /// Output = `of_y` · Im z + `of_q` · Re z.
    of_y: f64,
    of_q: f64,
}

impl Lane {
    fn read(group: &ModeGroup, lane: usize) -> Option<Self> {
        let pole = StoredPole::read(group.r2[lane], group.m[lane])?;
        let (out_y, out_d) = (f64::from(group.out_y[lane]), f64::from(group.out_d[lane]));
        let of_y = out_y - out_d * pole.cos_less_radius / pole.radius;
        let of_q = out_d * pole.sin / pole.radius;
        (of_y * of_y + of_q * of_q > 0.0).then_some(Self { pole, of_y, of_q })
    }
}

/// Carries `state` from the coefficients `old` to `new`, lane by lane. A lane that is silent before or
/// after comes to rest.
pub fn retune(old: &ModeGroup, new: &ModeGroup, state: &mut GroupState) {
    for lane in 0..LANES {
        let (y, d) = match (Lane::read(old, lane), Lane::read(new, lane)) {
            (Some(from), Some(to)) => carry(&from, &to, f64::from(state.y[lane]), f64::from(state.d[lane])),
            _ => (0.0, 0.0),
        };
        state.y[lane] = y as f32;
        state.d[lane] = d as f32;
    }
}

fn carry(from: &Lane, to: &Lane, y: f64, d: f64) -> (f64, f64) {
    let q = (y * from.pole.cos_less_radius + from.pole.radius * d) / from.pole.sin;
    // The output's phasor: its imaginary part is heard now, its real part a quarter period later.
    let (re, im) = (from.of_y * q - from.of_q * y, from.of_y * y + from.of_q * q);
    let norm = to.of_y * to.of_y + to.of_q * to.of_q;
    let y = (to.of_y * im - to.of_q * re) / norm;
    let q = (to.of_y * re + to.of_q * im) / norm;
    (y, (q * to.pole.sin - y * to.pole.cos_less_radius) / to.pole.radius)
}
