//! Ringing of a solved body: its modes as they are heard when it is struck at one place.
//!
//! A strike of 1 N·s at p along n̂ gives mode m the velocity φ_m(p)·n̂, of which its gain is heard;
//! material damping and, where it is given, what the air takes let it decay.

use crate::body::SolvedBody;
use asperity_dsp::damping::Damping;
use std::f64::consts::{FRAC_PI_2, TAU};

/// One mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ringing {
    /// Which of the body's modes it is.
    pub mode: usize,
    /// Sound of its velocity.
    pub gain: f64,
    /// Damped frequency, Hz.
    pub frequency_hz: f64,
    /// Decay rate, 1/s.
    pub decay_per_s: f64,
    /// Amplitude under a strike of 1 N·s at `struck_point`.
    pub amplitude: f64,
    /// Phase, rad: heard is the velocity, which begins at its peak.
    pub phase_rad: f64,
}

/// The modes that swing, struck at a point of the surface; `air` gives of a mode and its frequency
/// in Hz the gain and what the air adds to its decay, 1/s. Those damped so much that they do not
/// swing any more are left out and reported.
pub fn ringing(
    body: &mut SolvedBody,
    damping: &Damping,
    struck_point: usize,
    air: impl Fn(usize, f64) -> (f64, f64),
) -> Vec<Ringing> {
    let mut modes = Vec::with_capacity(body.frequency_hz.len());
    for (mode, hz) in body.frequency_hz.iter().enumerate() {
        let (gain, loss_per_s) = air(mode, *hz);
        let (omega, decay_per_s) = (TAU * hz, damping.decay_per_s(*hz) + loss_per_s);
        if decay_per_s >= omega {
            continue;
        }
        modes.push(Ringing {
            mode,
            gain,
            frequency_hz: (omega * omega - decay_per_s * decay_per_s).sqrt() / TAU,
            decay_per_s,
            amplitude: gain * body.field.along_normal(mode, struck_point),
            phase_rad: FRAC_PI_2,
        });
    }
    let lost = body.frequency_hz.len() - modes.len();
    if lost > 0 {
        body.remarks.push(format!("{lost} modes are damped so much that they do not swing; left out"));
    }
    modes
}
