//! The yardstick for settling: the document's pass over the whole grid, again and again until
//! nothing moves, and the random fields it is run on.
#![allow(dead_code)]

use asperity_dsp::gradient_noise_3d::GradientNoise3d;
use asperity_dsp::rng::Rng;

/// Units of height in a metre, as the grid's.
pub const UNIT: f64 = 1_073_741_824.0;
/// What no sand slides over.
const WALL: i32 = 1 << 30;

/// c of Δm = c · max e; the document leaves it open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Share {
    /// ½, as with one neighbour.
    Half,
    /// Brings the lowest neighbour exactly to the talus angle.
    Level,
}

/// Sand on a square with a wall around it.
#[derive(Debug, Clone)]
pub struct NaiveSand {
    n: usize,
    heights: Vec<i32>,
    limit: [i32; 2],
    tolerance: i32,
}

impl NaiveSand {
    /// `start` in metres, rows first; slopes count as settled `settled_deg` above the talus angle,
    /// the same as for the sand it is compared with.
    pub fn new(start: &[f64], n: usize, cell_m: f64, talus_deg: f64, settled_deg: f64) -> Self {
        let rise = |degrees: f64| degrees.to_radians().tan() * cell_m * UNIT;
        let mut heights = vec![WALL; (n + 2) * (n + 2)];
        for (i, h) in start.iter().enumerate() {
            heights[(i / n + 1) * (n + 2) + i % n + 1] = (h * UNIT) as i32;
        }
        let limit = [rise(talus_deg) as i32, (rise(talus_deg) * 2.0_f64.sqrt()) as i32];
        let tolerance = (rise(talus_deg + settled_deg) - rise(talus_deg)) as i32;
        Self { n, heights, limit, tolerance }
    }

    /// e_i = (h − h_i) − d_i tan θ > 0;  Δm = c max e,  Δm_i = Δm e_i / Σ e. Returns the passes.
    pub fn settle(&mut self, share: Share) -> usize {
        let stride = self.n + 2;
        for pass in 1.. {
            let mut moved = false;
            for y in 1..=self.n {
                for x in 1..=self.n {
                    moved |= self.slide(y * stride + x, stride, share);
                }
            }
            if !moved {
                return pass;
            }
        }
        0
    }

    #[inline]
    fn slide(&mut self, at: usize, stride: usize, share: Share) -> bool {
        let heights = &mut self.heights[..];
        let h = heights[at];
        let (above, below) = (at - stride, at + stride);
        let around = [at - 1, at + 1, above, below, above - 1, above + 1, below - 1, below + 1];
        let mut excess = [(0, 0_usize); 8];
        let (mut count, mut most, mut sum) = (0, 0, 0.0);
        for (k, to) in around.into_iter().enumerate() {
            let e = h - heights[to] - self.limit[k / 4];
            if e > 0 {
                excess[count] = (e, to);
                count += 1;
                most = most.max(e);
                sum += f64::from(e);
            }
        }
        if most <= self.tolerance {
            return false;
        }
        let most = f64::from(most);
        let part = match share {
            Share::Half => 0.5 * most / sum,
            Share::Level => most / (sum + most),
        };
        for &(e, to) in &excess[..count] {
            let given = (part * f64::from(e)) as i32;
            heights[to] += given;
            heights[at] -= given;
        }
        true
    }

    /// Heights, metres, rows first.
    pub fn heights_m(&self) -> Vec<f64> {
        let n = self.n;
        (0..n * n).map(|i| f64::from(self.heights[(i / n + 1) * (n + 2) + i % n + 1]) / UNIT).collect()
    }
}

/// Heights, metres: white noise far above, above and around the talus angle of 1 mm cells, and
/// hills and valleys over tens of cells.
pub fn random_fields(n: usize, seed: u64) -> [(&'static str, Vec<f64>); 4] {
    let mut rng = Rng::new(seed);
    let mut white =
        |sigma: f64| (0..n * n).map(|_| (0.05 + sigma * rng.normal()).max(0.0)).collect::<Vec<f64>>();
    let (rough, middling, mild) = (white(4e-3), white(1e-3), white(4e-4));
    let noise = GradientNoise3d::new(seed);
    let octave = |i: usize, k: i32| {
        let f = 0.01 * 2.0_f64.powi(k);
        let at = [f * (i % n) as f64, f * (i / n) as f64, 0.5 * f64::from(k)];
        0.03 / 2.0_f64.powi(k) * f64::from(noise.at(at).value)
    };
    let hills = (0..n * n).map(|i| 0.1 + (0..4).map(|k| octave(i, k)).sum::<f64>()).collect();
    [("white, 4 mm", rough), ("white, 1 mm", middling), ("white, 0.4 mm", mild), ("hills, 30 mm", hills)]
}
