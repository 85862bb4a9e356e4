//! Block: how many samples a source is asked for at once.

/// Longest block a source is ever asked for, samples.
pub const MAX_BLOCK: usize = 64;

/// The least and the greatest coordinates of some places, [[u, v], [u, v]]; what is no number
/// counts for nothing.
#[must_use]
pub fn bounds(position_m: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let (mut low, mut high) = ([[f64::INFINITY; 2]; 4], [[f64::NEG_INFINITY; 2]; 4]);
    let widen = |low: &mut [f64; 2], high: &mut [f64; 2], at: &[f64; 2]| {
        for axis in 0..2 {
            low[axis] = if at[axis] < low[axis] { at[axis] } else { low[axis] };
            high[axis] = if at[axis] > high[axis] { at[axis] } else { high[axis] };
        }
    };
    // Four at a time, because each comparison waits for the one before.
    let (fours, rest) = position_m.as_chunks::<4>();
    for four in fours {
        for (i, at) in four.iter().enumerate() {
            widen(&mut low[i], &mut high[i], at);
        }
    }
    for at in rest {
        widen(&mut low[0], &mut high[0], at);
    }
    let least = |axis: usize| low.iter().map(|at| at[axis]).fold(f64::INFINITY, f64::min);
    let greatest = |axis: usize| high.iter().map(|at| at[axis]).fold(f64::NEG_INFINITY, f64::max);
    [[least(0), least(1)], [greatest(0), greatest(1)]]
}
