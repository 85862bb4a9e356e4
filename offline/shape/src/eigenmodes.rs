//! Modes of vibration of a free body: frequencies and mass-normalised motions, none missed.
//!
//! Lanczos finds them from below; the inertia of K − ω²M above the last one counts how many there
//! must be (`factor`), and the residual ‖Kφ − ω²Mφ‖ / ‖Kφ‖ of each is checked.

use crate::elastic::Elastic;
use crate::error::ShapeError;
use crate::factor::{MOST_STEPS, Symbolic};
use crate::lanczos::{Lanczos, Ritz};
use crate::system::System;
use crate::vector::longest_side;
use faer::Mat;
use std::f64::consts::TAU;

/// Most modes solved for at once.
pub const MOST_MODES: usize = 400;
/// Rigid motions of a free body.
const RIGID: usize = 6;
/// Greatest residual of a mode that is given out.
const WORST_RESIDUAL: f64 = 1e-7;

/// Which modes are wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// Every mode below this, Hz; none: by number alone.
    pub up_to_hz: Option<f64>,
    /// At most so many, the lowest ones.
    pub most: usize,
}

/// Modes of a free body, lowest first.
#[derive(Debug)]
pub struct Eigenmodes {
    /// Undamped frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Motions of the nodes (three rows a node), one column a mode, kg^−½: Φᵀ M Φ = 1.
    pub motions: Mat<f64>,
    /// Greatest ‖Kφ − ω²Mφ‖ / ‖Kφ‖ of them.
    pub worst_residual: f64,
    /// Multiplications that a factor took.
    pub steps: f64,
}

/// Solves for the modes of a body; `progress` gets the part done, 0 to 1.
///
/// # Errors
/// When memory runs out, the work would take more than a minute, more than [`MOST_MODES`] modes are
/// below the frequency asked for, the body hangs together by points only, or a mode does not reach
/// its accuracy.
pub fn solve(
    system: &System,
    material: &Elastic,
    wanted: &Wanted,
    progress: &mut dyn FnMut(f64),
) -> Result<Eigenmodes, ShapeError> {
    solve_within(MOST_STEPS, system, material, wanted, progress)
}

/// Solves for the modes of a body whose factors take at most `most_steps` multiplications each.
///
/// # Errors
/// When memory runs out, a factor would take more, more than [`MOST_MODES`] modes are below the
/// frequency asked for, the body hangs together by points only, or a mode does not reach its
/// accuracy.
pub(crate) fn solve_within(
    most_steps: f64,
    system: &System,
    material: &Elastic,
    wanted: &Wanted,
    progress: &mut dyn FnMut(f64),
) -> Result<Eigenmodes, ShapeError> {
    let symbolic = Symbolic::of(system, most_steps)?;
    progress(0.1);
    let below = wanted.up_to_hz.map(|hz| symbolic.modes_below(system, hz)).transpose()?;
    progress(if below.is_some() { 0.3 } else { 0.1 });
    let count = match below {
        Some(n) => n.saturating_sub(RIGID).min(wanted.most),
        None => wanted.most,
    };
    let count = count.min(system.unknowns().saturating_sub(RIGID + 1));
    if count > MOST_MODES {
        let what = format!("{count} modes are asked for");
        return Err(ShapeError::new(
            "--up-to",
            what,
            format!("at most {MOST_MODES} are solved: lower it, or give --max-modes"),
        ));
    }
    // A hundredth of what a wave running along the body does in a round: far below the modes of all
    // but thin bodies, and not so far that the factor loses its digits.
    let slow_hz = 0.01 * material.bar_speed_m_s() / longest_side(&system.nodes);
    let sigma = -(TAU * slow_hz).powi(2);
    let found = lowest(system, &symbolic, sigma, count, &mut |done| progress(0.35 + 0.45 * done))?;
    // Where the number was not counted before, it is counted now, in the widest gap near the end.
    let complete = below.is_some_and(|n| n.saturating_sub(RIGID) == count);
    let modes = if complete || count == 0 {
        found
    } else {
        let at = gap_hz(&found.frequency_hz, count);
        let there = symbolic.modes_below(system, at)?.saturating_sub(RIGID);
        let known = found.frequency_hz.iter().filter(|&&hz| hz < at).count();
        if there > known {
            lowest(system, &symbolic, sigma, count + 2 * (there - known) + 8, &mut |_| ())?
        } else {
            found
        }
    };
    progress(0.95);
    checked(system, modes, count, slow_hz)
}

/// The frequency between mode `count` and its neighbour above, in the widest relative gap of the
/// last few.
fn gap_hz(frequency_hz: &[f64], count: usize) -> f64 {
    let last = frequency_hz.len().min(count + 3);
    let first = count.saturating_sub(1).min(last.saturating_sub(1));
    (first + 1..last)
        .map(|i| (frequency_hz[i - 1], frequency_hz[i]))
        .max_by(|a, b| (a.1 / a.0).total_cmp(&(b.1 / b.0)))
        .map_or_else(|| frequency_hz[first] * 1.001, |(low, high)| (low * high).sqrt())
}

/// The lowest `count` modes and a few more.
fn lowest(
    system: &System,
    symbolic: &Symbolic,
    sigma: f64,
    count: usize,
    progress: &mut dyn FnMut(f64),
) -> Result<Eigenmodes, ShapeError> {
    let factor = symbolic.factor(system, sigma)?;
    let mut lanczos = Lanczos::new(system, &factor)?;
    let wanted = count + 3;
    let most = (system.unknowns() - RIGID).min(6 * wanted + 200);
    let mut ritz: Option<Ritz> = None;
    // The basis needs about twice as many vectors as modes; then it is asked every few blocks.
    let mut next_look = wanted + 8;
    while lanczos.len() + 4 <= most {
        lanczos.step();
        progress((lanczos.len() as f64 / (2.2 * wanted as f64 + 24.0)).min(1.0));
        if lanczos.len() < next_look {
            continue;
        }
        let now = lanczos.ritz()?;
        let settled = now.converged.iter().take_while(|c| **c).count();
        ritz = Some(now);
        if settled >= wanted {
            break;
        }
        next_look = lanczos.len() + 4 * 2.max((wanted - settled) / 8);
    }
    let ritz = match ritz {
        Some(ritz) => ritz,
        None => lanczos.ritz()?,
    };
    let take = wanted.min(ritz.theta.iter().filter(|t| **t > 0.0).count());
    let frequency_hz =
        ritz.theta[..take].iter().map(|theta| (sigma + 1.0 / theta).max(0.0).sqrt() / TAU).collect();
    let motions = lanczos.motions(&ritz, take);
    Ok(Eigenmodes { frequency_hz, motions, worst_residual: f64::NAN, steps: symbolic.steps })
}

/// Keeps the wanted modes and makes sure of each.
fn checked(
    system: &System,
    mut modes: Eigenmodes,
    count: usize,
    slow_hz: f64,
) -> Result<Eigenmodes, ShapeError> {
    let count = count.min(modes.frequency_hz.len());
    modes.frequency_hz.truncate(count);
    modes.motions.resize_with(system.unknowns(), count, |_, _| 0.0);
    if modes.frequency_hz.first().is_some_and(|hz| *hz < 1e-3 * slow_hz) {
        let what = "parts of it hang together by a point or an edge only";
        return Err(ShapeError::new("", what, "join them by a face, or give each a file of its own"));
    }
    let n = system.unknowns();
    let (mut kv, mut mv) = (vec![0.0; n], vec![0.0; n]);
    let mut worst: f64 = 0.0;
    for (j, hz) in modes.frequency_hz.iter().enumerate() {
        let v = modes.motions.col_as_slice(j);
        system.times_stiffness(v, &mut kv);
        system.times_mass(v, &mut mv);
        let omega2 = (TAU * hz).powi(2);
        let residual: f64 = kv.iter().zip(&mv).map(|(k, m)| (k - omega2 * m).powi(2)).sum();
        let whole: f64 = kv.iter().map(|k| k * k).sum();
        worst = worst.max((residual / whole).sqrt());
    }
    if worst > WORST_RESIDUAL || worst.is_nan() {
        let what = format!("a mode has a residual of {worst:.1e}: some tetrahedra are too flat");
        return Err(ShapeError::new("", what, "mesh it anew with better elements"));
    }
    Ok(Eigenmodes { worst_residual: worst, ..modes })
}
