//! Recorded sweep of an actuator → its profile, with the error of each number.
//!
//! ```text
//! acceleration / drive = D₀/Q · s² ω₀² / (s² + ω₀/Q s + ω₀²) · e^(−sτ)
//! ```
//! The model is fitted to the samples themselves (output error, Gauss–Newton with damping, after a
//! search over ω₀, Q and τ on the cross spectrum): samples that were cut off at the recorder's full
//! scale are left out, the rest of a clipped sweep counts. Standard errors are the larger of those
//! for white noise and those whose residual may be correlated over two periods of the resonance.
//!
//! `band_hz` is where the recording proves the model: from the resonance outwards in twelfths of an
//! octave as long as the residual, its own uncertainty added, stays within [`MISFIT_DB`], the drive
//! is there, and the felt motion is within [`DEEPEST_DB`] of that at resonance.

use asperity_dsp::actuator::DeviceProfile;
use bands::Bands;
use record::{Fit, Record};
use std::f64::consts::FRAC_1_SQRT_2;

mod bands;
mod record;

/// Largest misfit inside the band, dB.
pub const MISFIT_DB: f64 = 1.0;
/// Felt motion at the edges of the band over that at resonance, dB at least: beyond it an inverse
/// asks for more than devices give (chosen).
pub const DEEPEST_DB: f64 = -30.0;
/// Least ratio of the band's edges.
pub const NARROWEST: f64 = 1.3;
/// Three standard errors of Q; of the resonance; of the resonance where Q > 10. Shares.
const TOLERATED: [f64; 3] = [0.05, 0.01, 0.003];
/// Samples at the very extreme from which on they were cut off there.
const PLATEAU: usize = 8;
/// Drive that may be held and time constant of the coil: a sweep shows neither (assumed).
const RATED_DRIVE: f64 = FRAC_1_SQRT_2;
const THERMAL_TIME_S: f64 = 5.0;

/// Drive and acceleration of one sweep, recorded together.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Samples a second.
    pub rate_hz: f64,
    /// Drive, within ±1.
    pub drive: Vec<f64>,
    /// Felt acceleration, m/s².
    pub acceleration_m_s2: Vec<f64>,
}

/// Profile of an actuator, and how well it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Its numbers.
    pub profile: DeviceProfile,
    /// Standard error of each, in its unit; infinite where it is assumed.
    pub error: DeviceProfile,
    /// Lag of the acceleration's channel, s.
    pub lag_s: f64,
    /// Share of the samples that were cut off and left out.
    pub cut_off: f64,
}

/// Reason for which a sweep gives no profile: what is wrong; what would be right.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what}; {right}")]
pub struct SweepError {
    /// Fault.
    pub what: String,
    /// Remedy.
    pub right: &'static str,
}

fn refused<T>(what: impl Into<String>, right: &'static str) -> Result<T, SweepError> {
    Err(SweepError { what: what.into(), right })
}

/// Profile from a sweep.
///
/// # Errors
/// When the sweep is too short, too noisy or clipped too much for the tolerances (resonance ± 1 %,
/// ± 0.3 % where Q > 10; Q ± 5 %), does not cross the resonance, or follows no single resonance.
pub fn measure(sweep: &Sweep) -> Result<Measured, SweepError> {
    check(sweep)?;
    let record = Record::new(sweep);
    let bands = Bands::new(&record);
    let (mut fit, mut kept) = (bands.search(&record), not_cut_off(&sweep.acceleration_m_s2));
    for _ in 0..6 {
        fit = record.refine(fit, &kept);
        if !leave_out_soft_tops(&record.model(&fit)[0], &sweep.acceleration_m_s2, &mut kept) {
            break;
        }
    }
    let spread = record.spread(&fit, &kept);
    known_well_enough(&fit, &spread)?;
    let [below_hz, above_hz] = bands.proved(&record, &fit, &kept)?;
    let moved_m = record.felt_m(&fit);
    let step = 2f64.powf(1.0 / 12.0) - 1.0;
    let [lost, all] = [kept.iter().filter(|is_kept| !**is_kept).count(), kept.len()];
    Ok(Measured {
        profile: DeviceProfile {
            resonance_hz: fit.resonance_hz,
            quality: fit.quality,
            felt_at_resonance_m: fit.felt_m.abs(),
            excursion_m: moved_m,
            band_hz: [below_hz, above_hz],
            rated_drive: RATED_DRIVE,
            thermal_time_s: THERMAL_TIME_S,
        },
        error: DeviceProfile {
            resonance_hz: fit.resonance_hz * spread[0],
            quality: fit.quality * spread[1],
            felt_at_resonance_m: fit.felt_m.abs() * spread[3],
            excursion_m: moved_m * spread[3],
            band_hz: [below_hz * step, above_hz * step],
            rated_drive: f64::INFINITY,
            thermal_time_s: f64::INFINITY,
        },
        lag_s: fit.lag_s,
        cut_off: lost as f64 / all as f64,
    })
}

fn check(sweep: &Sweep) -> Result<(), SweepError> {
    let (count, peak) = (sweep.drive.len(), sweep.drive.iter().fold(0.0, |most, u| u.abs().max(most)));
    let finite = sweep.drive.iter().chain(&sweep.acceleration_m_s2).all(|x| x.is_finite());
    if !finite || sweep.acceleration_m_s2.len() != count {
        return refused("holds samples that are no numbers", "both channels need a number a sample");
    }
    if !(200.0..=400_000.0).contains(&sweep.rate_hz) {
        return refused(format!("is sampled at {} Hz", sweep.rate_hz), "must be 200 Hz to 400 kHz");
    }
    if (count as f64) < 0.25 * sweep.rate_hz {
        let seconds = count as f64 / sweep.rate_hz;
        return refused(format!("lasts {seconds:.3} s"), "must last 0.25 s at least, some seconds are right");
    }
    if peak > 1.0 + 1e-3 {
        return refused(format!("its drive reaches {peak:.3}"), "the drive is within ±1, 1 being full scale");
    }
    if peak < 1e-6 {
        return refused("its drive is silent", "the first channel is the drive, the second the acceleration");
    }
    if sweep.acceleration_m_s2.iter().all(|a| *a == sweep.acceleration_m_s2[0]) {
        return refused("its acceleration is silent", "the second channel is the acceleration, m/s²");
    }
    Ok(())
}

fn known_well_enough(fit: &Fit, spread: &[f64; 4]) -> Result<(), SweepError> {
    let tolerated = TOLERATED[if fit.quality > 10.0 { 2 } else { 1 }];
    let right = "sweep longer, with less noise and clipping, so weakly that one resonance is all that moves";
    let known = |x: f64, most: f64| x.is_finite() && 3.0 * x <= most;
    if !(0.5..1e3).contains(&fit.quality) || !fit.felt_m.is_normal() {
        return refused("its acceleration follows no resonance of Q above 0.5", right);
    }
    if known(spread[0], tolerated) && known(spread[1], TOLERATED[0]) {
        return Ok(());
    }
    let what = format!(
        "gives its resonance to ± {:.2} % and its Q to ± {:.1} % only (three standard errors)",
        300.0 * spread[0],
        300.0 * spread[1]
    );
    refused(what, right)
}

/// Samples that stand where the recorder does not cut off.
fn not_cut_off(recorded: &[f64]) -> Vec<bool> {
    let [low, high] = recorded.iter().fold([f64::MAX, f64::MIN], |[l, h], x| [x.min(l), x.max(h)]);
    let is_plateau = |level: f64| recorded.iter().filter(|x| **x == level).count() >= PLATEAU;
    let [low_is, high_is] = [is_plateau(low), is_plateau(high)];
    recorded.iter().map(|x| !(low_is && *x == low || high_is && *x == high)).collect()
}

/// Leaves out tops that were cut off before noise came on them: where the model stands near the
/// recorded extreme or beyond, and the record inside it on average. True: something was left out.
fn leave_out_soft_tops(model: &[f64], recorded: &[f64], kept: &mut [bool]) -> bool {
    let count = recorded.len() as f64;
    let mean = recorded.iter().sum::<f64>() / count;
    let extreme = recorded.iter().fold(0.0, |most: f64, x| most.max((x - mean).abs()));
    let is_top = |at: usize| model[at].abs() > 0.9 * extreme;
    let tops = || (0..model.len()).filter(|at| is_top(*at));
    let inwards: Vec<f64> = tops()
        .filter(|at| kept[*at])
        .map(|at| model[at].signum() * (recorded[at] - mean - model[at]))
        .collect();
    let mean_inwards = -inwards.iter().sum::<f64>() / inwards.len() as f64;
    let is_cut = inwards.len() >= PLATEAU && mean_inwards > 0.02 * extreme;
    if is_cut {
        tops().for_each(|at| kept[at] = false);
    }
    is_cut
}
