//! Damped-sinusoid test: whether a segment is a sum of modes in noise, before anything is fitted.
//!
//! Noise and a mode leave the singular values of a band's Hankel matrix apart: one value a mode
//! stands over the noise's edge ([`crate::search::model_order`]). What a real recording has besides
//! (a room, beats, decays that are no exponentials, a thousand modes of a plate) lifts all of them.
//! In the dozen strongest bands of the longest level, on average,
//!
//! | | values over the edge |
//! |---|---|
//! | sums of 10–120 modes, 20–60 dB, pushed or struck | 1.8–4.5 |
//! | recordings | 11–40 |
//! | sums of 10–60 modes in 0.15–0.4 s | 1.4–6.2 |
//! | recordings as short | 18–40 |
//!
//! The edge follows noise that is steep over frequency, as it is in the quiet end: rumble under
//! four modes had 18 values over a smooth one. Where nothing rings ([`crate::proof::ringing`])
//! there is no sum but the empty one, and no other fit either.
//!
//! A wrong *yes* costs time only, for the fit is held against the noise afterwards.

use crate::noise::noise_floor::NoiseFloor;
use crate::proof::ringing::anything_rings;
use crate::search::candidates::Search;
use crate::search::limits::Limits;
use crate::search::sub_band::Level;

/// Most values over the edge in the bands of a sum of modes.
const MOST_VALUES: f64 = 6.0;
/// Threshold where the longest level is short: its bands are so wide that a sum of many modes has
/// more in each.
const MOST_VALUES_SHORT: f64 = 12.0;
const LONG_DECIMATION: usize = 128;
/// A longest level shorter than this says nothing.
const LEAST_DECIMATION: usize = 32;
/// Number of the strongest bands that are looked at.
const BANDS: usize = 12;

/// Tests whether `segment` may be a sum of modes in noise.
#[must_use]
pub fn may_be_sum_of_modes(segment: &[f64], limits: &Limits) -> bool {
    let Some(&longest) = Level::ladder(segment.len()).first() else { return true };
    if longest.decimation < LEAST_DECIMATION {
        return true;
    }
    let band = (limits.bounds.omega_low, limits.bounds.omega_high);
    if !anything_rings(segment, band, limits.least_noise) {
        return true;
    }
    let most = if longest.decimation < LONG_DECIMATION { MOST_VALUES_SHORT } else { MOST_VALUES };
    let end = &segment[segment.len() / 2..];
    let noise = NoiseFloor::estimate(segment, limits.rate_hz, limits.least_noise).following(end);
    Search::thorough(limits, &noise).mean_order(longest, segment, BANDS) <= most
}
