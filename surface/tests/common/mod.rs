//! Strokes over a source, in blocks of any length.
#![allow(dead_code)]

use asperity_surface::height_field::{HeightField, MAX_BLOCK, PathBlock, SurfaceBlock};

/// A straight stroke.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    pub start_m: [f64; 2],
    pub velocity_m_s: [f64; 2],
    pub sample_rate_hz: f64,
    pub first_sample: u64,
    pub samples: usize,
}

impl Stroke {
    pub fn new(start_m: [f64; 2], velocity_m_s: [f64; 2], sample_rate_hz: f64, samples: usize) -> Self {
        Self { start_m, velocity_m_s, sample_rate_hz, first_sample: 0, samples }
    }

    pub fn position_m(&self, n: usize) -> [f64; 2] {
        let t = n as f64 / self.sample_rate_hz;
        [0, 1].map(|a| self.start_m[a] + self.velocity_m_s[a] * t)
    }

    pub fn footprint_m(&self) -> f64 {
        self.velocity_m_s[0].hypot(self.velocity_m_s[1]) / self.sample_rate_hz
    }

    /// Runs the stroke; `lengths` gives the block lengths in turn, `before` is called with the
    /// absolute sample before every block.
    pub fn run(
        &self,
        source: &mut dyn HeightField,
        lengths: &[usize],
        mut before: impl FnMut(&mut dyn HeightField, u64),
        mut each: impl FnMut(usize, &SurfaceBlock, usize),
    ) {
        let mut out = SurfaceBlock::default();
        let (mut n, mut turn) = (0, 0);
        while n < self.samples {
            let length = lengths[turn % lengths.len()].min(self.samples - n).min(MAX_BLOCK);
            turn += 1;
            let position: Vec<[f64; 2]> = (n..n + length).map(|i| self.position_m(i)).collect();
            let first_sample = self.first_sample + n as u64;
            before(source, first_sample);
            let path = PathBlock {
                position_m: &position,
                velocity_m_s: &vec![self.velocity_m_s; length],
                footprint_m: &vec![self.footprint_m(); length],
                normal_force_n: &[],
                first_sample,
                contact: 0,
                slopes: true,
                ..PathBlock::default()
            };
            source.sample(&path, &mut out);
            for i in 0..length {
                each(n + i, &out, i);
            }
            n += length;
        }
    }

    pub fn heights(&self, source: &mut dyn HeightField, lengths: &[usize]) -> Vec<f64> {
        let mut heights = vec![0.0; self.samples];
        self.run(source, lengths, |_, _| (), |n, out, i| heights[n] = out.height_m[i]);
        heights
    }
}

pub fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

pub fn rms(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}
