//! The alternating contact force sounds by itself, because a pad that never lifts off would be
//! silent (ours, not the document's).

use asperity_dsp::hertz::{self, FORCE_HISTORY};
use asperity_texture::height_field::MAX_BLOCK;

/// The force of a stretch behind what is remembered of the one before.
pub(in crate::audio::voice) struct ForceRun([f64; FORCE_HISTORY + MAX_BLOCK]);

impl ForceRun {
    pub(in crate::audio::voice) fn new() -> Self {
        Self([0.0; FORCE_HISTORY + MAX_BLOCK])
    }

    /// Room for the impulses of `n` samples, N·s.
    pub(in crate::audio::voice) fn samples(&mut self, n: usize) -> &mut [f64] {
        &mut self.0[FORCE_HISTORY..][..n]
    }
}

/// The impulses of the last forces, which are still on their way to the body.
#[derive(Default)]
pub(super) struct ContactForce {
    history_n_s: [f64; FORCE_HISTORY],
}

impl ContactForce {
    /// Adds the force, spread for the bank, to `out`; where nothing is there yet, it is written.
    pub(super) fn add(&mut self, run: &mut ForceRun, out: &mut [f64], something_is_there: bool) {
        let n = out.len();
        run.0[..FORCE_HISTORY].copy_from_slice(&self.history_n_s);
        let forces_n_s = &run.0[..FORCE_HISTORY + n];
        if something_is_there {
            hertz::spread_force(forces_n_s, out);
        } else {
            hertz::spread_force_alone(forces_n_s, out);
        }
        self.history_n_s.copy_from_slice(&run.0[n..n + FORCE_HISTORY]);
    }
}
