//! One least squares of surface, colour of the rig and levels of the strokes.
//!
//! ```text
//! L(group, f) = S(log f − log v) + C(log f) + e(stroke)
//! ```
//!
//! | | prior |
//! |---|---|
//! | S | second differences of 1 dB a third octave |
//! | C | 5 dB, correlated over half an octave, and a tilt of 2 dB an octave |
//! | e | 0.3 dB |
//!
//! Ground stays at one place in S for every speed, the rig at one frequency. One speed cannot tell
//! them apart, and then all of it is ground.

use crate::relief::{Band, Group, Level};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Response of the rig at a third octave of frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Colour {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Gain, dB, with a mean of 0.
    pub gain_db: f64,
    /// Its standard error, dB.
    pub se_db: f64,
}

/// Surface and rig.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parted {
    /// Spectrum of the felt height.
    pub bands: Vec<Band>,
    /// Response of the rig; empty where one speed cannot tell.
    pub colour: Vec<Colour>,
    /// Gain of each further octave of force beside the contact law, dB; none where forces do not
    /// differ by a factor of 2.
    pub force_db_per_octave: Option<f64>,
}

/// Prior of S: dB for a second difference.
const KINK_DB: f64 = 1.0;
/// Prior of S where nothing has to be told apart.
const LOOSE_KINK_DB: f64 = 6.0;
/// Prior of C: dB, octaves, dB an octave.
const COLOUR_DB: f64 = 5.0;
const CORRELATED_OCTAVES: f64 = 0.5;
const TILT_DB: f64 = 2.0;
/// Prior of a stroke's level, dB: gain and speed hold from stroke to stroke.
pub const LEVEL_DB: f64 = 0.3;
/// Prior of the force's own gain, dB an octave.
const FORCE_DB: f64 = 1.0;
/// Greatest over least speed from which colour and ground are told apart.
pub const LEAST_SPEEDS: f64 = 1.8;
/// Frequencies of the colour: node i is at 10^(i/10) Hz.
const NODES: std::ops::Range<usize> = 7..36;

/// Solves for surface and rig; `with_colour` where speeds differ. Levels of strokes differ by
/// `level_db` for reasons of their own.
#[must_use]
pub fn part(levels: &[Level], groups: &[Group], with_colour: bool, level_db: f64) -> Parted {
    let (low, high) =
        levels.iter().fold((usize::MAX, 0), |(low, high), level| (low.min(level.band), high.max(level.band)));
    if levels.is_empty() {
        return Parted::default();
    }
    let bands = high - low + 1;
    let nodes = if with_colour { NODES.len() } else { 0 };
    let several = groups.len() > 1;
    let level_count = if several { groups.len() } else { 0 };
    let forces = groups.iter().map(|group| group.force_n);
    let range = forces.clone().fold(0.0, f64::max) / forces.fold(f64::INFINITY, f64::min);
    let with_force = range >= 2.0;
    let unknowns = bands + nodes + level_count + usize::from(with_force);
    let mut normal = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DVector::<f64>::zeros(unknowns);
    let octaves = |group: usize| (groups[group].force_n).log2();
    let mean_force = (0..groups.len()).map(octaves).sum::<f64>() / groups.len().max(1) as f64;
    let row = |level: &Level| -> Vec<(usize, f64)> {
        let mut row = vec![(level.band - low, 1.0)];
        if with_colour {
            row.extend(node_weights(level.frequency_hz).into_iter().map(|(node, w)| (bands + node, w)));
        }
        if several {
            row.push((bands + nodes + level.group, 1.0));
        }
        if with_force {
            row.push((unknowns - 1, octaves(level.group) - mean_force));
        }
        row
    };
    for level in levels {
        let weight = level.se_db.powi(-2);
        let row = row(level);
        for (i, a) in &row {
            right[*i] += weight * a * level.level_db;
            for (j, b) in &row {
                normal[(*i, *j)] += weight * a * b;
            }
        }
    }
    let data = normal.clone();
    let kink_db = if with_colour || level_db > 1.0 { KINK_DB } else { LOOSE_KINK_DB };
    for i in 1..bands.saturating_sub(1) {
        let bend = [(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)];
        for (a, wa) in bend {
            for (b, wb) in bend {
                normal[(a, b)] += wa * wb * kink_db.powi(-2);
            }
        }
    }
    if with_colour {
        let prior = colour_prior(nodes);
        normal
            .view_mut((bands, bands), (nodes, nodes))
            .iter_mut()
            .zip(prior.iter())
            .for_each(|(a, b)| *a += b);
        // The mean of the colour is the surface's level.
        for i in 0..nodes {
            for j in 0..nodes {
                normal[(bands + i, bands + j)] += 1e2 / nodes as f64;
            }
        }
    }
    for i in 0..level_count {
        normal[(bands + nodes + i, bands + nodes + i)] += level_db.powi(-2);
    }
    if with_force {
        normal[(unknowns - 1, unknowns - 1)] += FORCE_DB.powi(-2);
    }
    for i in 0..bands {
        // A band that nobody saw lies on the line of its neighbours.
        normal[(i, i)] += 1e-9;
    }
    let Some(inverse) = normal.clone().try_inverse() else {
        return Parted::default();
    };
    let solved = &inverse * right;
    let seen = |i: usize| data[(i, i)] > 0.0;
    let band = |i: usize| Band { band: low + i, level_db: solved[i], se_db: inverse[(i, i)].sqrt() };
    let colour = (0..nodes)
        .filter(|i| seen(bands + i))
        .map(|i| Colour {
            frequency_hz: node_hz(i),
            gain_db: solved[bands + i],
            se_db: inverse[(bands + i, bands + i)].sqrt(),
        })
        .collect();
    Parted {
        bands: (0..bands).filter(|i| seen(*i)).map(band).collect(),
        colour,
        force_db_per_octave: with_force.then(|| solved[unknowns - 1]),
    }
}

fn node_hz(node: usize) -> f64 {
    10f64.powf((NODES.start + node) as f64 / 10.0)
}

/// Nodes about a frequency.
fn node_weights(frequency_hz: f64) -> [(usize, f64); 2] {
    let place = (10.0 * frequency_hz.log10() - NODES.start as f64).clamp(0.0, NODES.len() as f64 - 1.001);
    let below = place as usize;
    let share = place - below as f64;
    [(below, 1.0 - share), (below + 1, share)]
}

/// Inverse of the covariance of the colour's nodes.
fn colour_prior(nodes: usize) -> DMatrix<f64> {
    let octave = |i: usize| node_hz(i).log2();
    let centre = octave(nodes / 2);
    let covariance = DMatrix::from_fn(nodes, nodes, |i, j| {
        let apart = (octave(i) - octave(j)).abs() / CORRELATED_OCTAVES;
        COLOUR_DB.powi(2) * (-0.5 * apart * apart).exp()
            + TILT_DB.powi(2) * (octave(i) - centre) * (octave(j) - centre)
            + if i == j { 0.01 } else { 0.0 }
    });
    covariance.try_inverse().unwrap_or_else(|| DMatrix::identity(nodes, nodes))
}

/// Factor between the fastest and the slowest group.
#[must_use]
pub fn speed_range(groups: &[Group]) -> f64 {
    let speeds = groups.iter().map(|group| group.speed_m_s);
    speeds.clone().fold(0.0, f64::max) / speeds.fold(f64::INFINITY, f64::min)
}
