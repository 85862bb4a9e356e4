//! Compliance of the ground: how deep a displacement sensor sinks while the force changes.
//!
//! ```text
//! x̄ = a − c F̄ − F̄^(1−n) / ((1 − n) k₁)        means over blocks of a quarter of a second
//! ```
//! The last term is the probe's own contact spring. The long waves of the ground are the noise of
//! this line; each stroke has its own a. An accelerometer holds nothing of it.

use crate::recording::Stroke;
use crate::tool::{Quantity, Tool};

/// Sinking under a force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compliance {
    /// m/N.
    pub m_n: f64,
    /// Standard error, m/N.
    pub se_m_n: f64,
}

/// Length of a block, s.
const BLOCK_S: f64 = 0.25;
/// Greatest over least force from which it is estimated.
const LEAST_RANGE: f64 = 2.0;
/// Error that is stated, a share of it.
const MOST_ERROR: f64 = 0.1;

/// Compliance that strokes show, or a remark why not.
pub(crate) fn find(strokes: &[Stroke], tool: &Tool, warnings: &mut Vec<String>) -> Option<Compliance> {
    let of = |stroke: &Stroke| -> Vec<[f64; 2]> {
        let block = (BLOCK_S * stroke.rate_hz) as usize;
        let mean = |from: usize| stroke.axes[0][from..from + block].iter().sum::<f64>() / block as f64;
        let starts = (0..stroke.len() + 1 - block.min(stroke.len())).step_by(block);
        starts.map(|from| [stroke.force_n.mean(from, block), mean(from)]).collect()
    };
    let measured = || strokes.iter().filter(|stroke| stroke.force_n.is_measured());
    let blocks: Vec<Vec<[f64; 2]>> = measured().map(of).collect();
    let forces = || blocks.iter().flatten().map(|block| block[0]).filter(|force| *force > 0.0);
    let range = forces().fold(0.0, f64::max) / forces().fold(f64::INFINITY, f64::min);
    if range.is_nan() || range < LEAST_RANGE {
        return None;
    }
    if tool.quantity != Quantity::Displacement || measured().any(|stroke| stroke.axes.len() > 1) {
        warnings.push(
            "compliance is not estimated: only the displacement of one axis, along the normal, holds how deep a changing force sinks".to_owned(),
        );
        return None;
    }
    let probe = &tool.probe;
    let rest = 1.0 - probe.force_exponent;
    let own_m = |force_n: f64| force_n.max(0.0).powf(rest) / (rest * probe.contact_stiffness_n_m);
    // Force, and sinking with the axis either way, each beside its stroke's mean.
    let sums = |sign: f64| -> [f64; 4] {
        let mut sums = [0.0; 4];
        for blocks in &blocks {
            let count = blocks.len().max(1) as f64;
            let sunk = |[force, x]: &[f64; 2]| sign * x - own_m(*force);
            let force = blocks.iter().map(|block| block[0]).sum::<f64>() / count;
            let depth = blocks.iter().map(sunk).sum::<f64>() / count;
            for block in blocks {
                let (f, y) = (block[0] - force, sunk(block) - depth);
                let terms = [f * f, f * y, y * y, 1.0];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
            sums[3] -= 1.0;
        }
        sums
    };
    let [ff, fy, yy, count] = [-1.0, 1.0].map(sums).into_iter().max_by(|a, b| a[1].total_cmp(&b[1]))?;
    let m_n = fy / ff;
    let se_m_n = ((yy - fy * m_n).max(0.0) / (count - 1.0).max(1.0) / ff).sqrt();
    if m_n > 0.0 && se_m_n <= MOST_ERROR * m_n {
        return Some(Compliance { m_n, se_m_n });
    }
    warnings.push(format!(
        "compliance is not estimated: {:.1} ± {:.1} µm/N; press from light to hard over the same metres, for longer",
        1e6 * m_n,
        1e6 * se_m_n
    ));
    None
}
