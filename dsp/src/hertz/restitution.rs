//! Impact that parts slower than it met, as a sum of elastic ones.
//!
//! ```text
//! m x'' = −k x^1.5 (1 + a x'/v)        a (1 + e) = ln((1 + a) / (1 − a e))
//! F(t) ≈ Σᵢ wᵢ J/(rᵢ τ) p(t / rᵢ τ),   Σ wᵢ = 1,   all from the same onset
//! ```
//! Damping that grows with the depth (Hunt & Crossley 1975), its constant chosen so that bodies
//! part with exactly e, makes a pulse rise faster and fall slower: at e = 0.5 it peaks at a quarter
//! of its length and holds 4 dB more at 1.3/τ, 15 dB more at 2/τ, where the elastic one is 12 and
//! 31 dB down. Three elastic pulses lie on its spectrum within 1.4 dB a third octave up to 3/τ and
//! within 2.6 dB to 5/τ, and on its peak within 9 %, for e from 0.05 to 1 (below, 0.05 is taken);
//! wᵢ and rᵢ are polynomials of 1 − e by least squares
//! (`dsp/tests/independent/hertz_restitution.py`). τ is the contact time of the elastic impact.
//! Bodies that stick (e = 0) never part, and the law has no pulse for them; physics engines write 0
//! where nothing was set. The elastic shape is kept there, over half of its impulse.

use super::{HertzPulse, pulse_shape};

/// Coefficients of (1 − e)¹ … (1 − e)³ in the shares of the two shorter pulses.
const SHARES: [[f64; 3]; 2] = [[0.9181, -2.1705, 1.7291], [1.3202, -1.5629, 0.6611]];
/// Coefficients of (1 − e)⁰ … (1 − e)³ in the lengths of the three, of τ, the longest first.
const LENGTHS: [[f64; 4]; 3] =
    [[1.0, 0.0595, 0.6732, -1.6888], [0.7173, -0.8278, 0.6811, -0.3955], [0.864, -0.4987, -0.3023, 0.2976]];
/// Least restitution whose shape is known.
const LEAST: f64 = 0.05;
/// Length of the longest of them, of τ, at most.
const LONGEST: f64 = 1.04;

impl HertzPulse {
    /// Elastic pulse, of bodies that part as fast as they met.
    #[must_use]
    pub const fn elastic(impulse_n_s: f64, contact_time_s: f64) -> Self {
        Self { impulse_n_s, contact_time_s, restitution: 1.0 }
    }

    /// Elastic pulses with the same onset that it is the sum of; an elastic one is itself.
    pub fn elastic_parts(&self) -> impl Iterator<Item = Self> + use<> {
        let lost = if self.restitution > 0.0 { 1.0 - self.restitution.clamp(LEAST, 1.0) } else { 0.0 };
        let cubic = move |[a, b, c]: [f64; 3]| lost * (a + lost * (b + lost * c));
        let [first, second] = SHARES.map(cubic);
        let shares = [1.0 - first - second, first, second];
        let whole = *self;
        let part = move |(share, [one, a, b, c]): (f64, [f64; 4])| {
            let length = one + cubic([a, b, c]);
            Self::elastic(share * whole.impulse_n_s, length * whole.contact_time_s)
        };
        let count = if lost > 0.0 { shares.len() } else { 1 };
        shares.into_iter().zip(LENGTHS).take(count).map(part)
    }

    /// Time from the onset after which nothing is left of it, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        if self.restitution > 0.0 && self.restitution < 1.0 {
            LONGEST * self.contact_time_s
        } else {
            self.contact_time_s
        }
    }

    /// Force so long after the onset, N.
    #[must_use]
    pub fn force_n(&self, time_s: f64) -> f64 {
        let part =
            |part: Self| part.impulse_n_s / part.contact_time_s * pulse_shape(time_s / part.contact_time_s);
        self.elastic_parts().map(part).sum()
    }
}
