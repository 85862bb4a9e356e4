//! Roughness of samples, as octave gains. A plate has one roughness, and so have most samples that
//! lie side by side on a map: then plain numbers say it for all of them, once.

use super::gains::{Gains, gains, within_0_1};
use super::{OCTAVES, OctaveWeights};
use crate::simd::Vector;

/// Gains of N samples.
pub(super) struct Rough<F> {
    /// True where one holds for all: then only the boost is given here.
    pub(super) even: bool,
    /// Within 0–1.
    pub(super) lanes: F,
    pub(super) gains: Gains<F>,
}

impl<F: Copy> Rough<F> {
    #[inline(always)]
    pub(super) fn new<const N: usize, const W: usize, V: Vector<N, Single = F>>(
        v: V,
        sets: &[&OctaveWeights; W],
        roughness: &[f64; N],
        even: &mut Even<W>,
    ) -> Self {
        let (lanes, first) = (v.load(roughness), roughness[0] as f32);
        if v.equal(lanes, v.splat(first)) {
            if first != even.roughness {
                even.recompute_gains(v, sets, first);
            }
            let tail_boost = v.splat(even.tail_boost);
            return Self { even: true, lanes, gains: Gains { finest: lanes, coarser: lanes, tail_boost } };
        }
        Self { even: false, lanes: within_0_1(v, lanes), gains: gains(v, lanes) }
    }
}

/// Gains of one roughness, kept until it is another.
pub(super) struct Even<const W: usize> {
    roughness: f32,
    tail_boost: f32,
    /// Gains of the octaves; their weights, by set; and both together.
    pub(super) gains: [f32; OCTAVES],
    pub(super) weights: [[f32; OCTAVES]; W],
    pub(super) scales: [[f32; OCTAVES]; W],
}

impl<const W: usize> Even<W> {
    pub(super) const UNKNOWN: Self = Self {
        roughness: f32::NAN,
        tail_boost: 0.0,
        gains: [0.0; OCTAVES],
        weights: [[0.0; OCTAVES]; W],
        scales: [[0.0; OCTAVES]; W],
    };

    /// Gains of another roughness.
    #[inline(always)]
    fn recompute_gains<const N: usize, V: Vector<N>>(
        &mut self,
        v: V,
        sets: &[&OctaveWeights; W],
        roughness: f32,
    ) {
        let lanes = v.splat(roughness);
        let (within, found) = (v.first(within_0_1(v, lanes)), gains(v, lanes));
        (self.roughness, self.tail_boost) = (roughness, v.first(found.tail_boost));
        let (mut gain, coarser) = (v.first(found.finest), v.first(found.coarser));
        for gains in self.gains.iter_mut().rev() {
            *gains = gain;
            gain *= coarser;
        }
        for (set, (weights, scales)) in sets.iter().zip(self.weights.iter_mut().zip(&mut self.scales)) {
            for i in set.coarsest..OCTAVES {
                let [.., last] = set.of[i];
                let mut sum = last;
                for c in set.of[i].iter().rev().skip(1) {
                    sum = c + within * sum;
                }
                weights[i] = sum;
                scales[i] = self.gains[i] * sum;
            }
        }
    }
}
