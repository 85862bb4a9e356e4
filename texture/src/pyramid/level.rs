//! Rectangles of low frequencies: which frequencies of an image a level keeps, and where they lie on its own grid.

use super::Sampling;
use crate::fft2::{Fft2, angular_frequency};

/// A rectangle of low frequencies and the grid on which they are sampled.
#[derive(Debug, Clone)]
pub(super) struct Level {
    /// Frequencies kept: at most `crop` of the image's in each direction.
    pub crop: [usize; 2],
    pub fft: Fft2,
}

/// A run of frequencies that lie side by side in the image's spectrum, the crop and the level.
pub(super) struct Run {
    pub full: usize,
    pub crop: usize,
    pub level: usize,
    pub len: usize,
}

impl Level {
    /// The frequencies that survive `halvings` of the band's upper edge, and their grid.
    pub fn new(width: usize, height: usize, halvings: usize, sampling: Sampling) -> Self {
        let side = |n: usize| n.div_ceil(1 << halvings);
        let crop = [side(width), side(height)];
        let [w, h] = if sampling == Sampling::Full { [width, height] } else { crop };
        Self { crop, fft: Fft2::new(w, h) }
    }

    /// Calls `each` with the runs of frequencies of this level. The filters are zero at and above
    /// the crop's own Nyquist frequency, so it does not matter on which side that bin is kept.
    pub fn runs(&self, width: usize, height: usize, mut each: impl FnMut(Run)) {
        let [crop_w, crop_h] = self.crop;
        let (level_w, level_h) = (self.fft.width(), self.fft.height());
        debug_assert!(crop_w <= width && crop_h <= level_h);
        let upper = crop_h / 2 + 1;
        for kx in 0..crop_w {
            let below = crop_w - kx;
            let negative = kx > crop_w / 2;
            let full = if negative { width - below } else { kx } * height;
            let level = if negative { level_w - below } else { kx } * level_h;
            let crop = kx * crop_h;
            let upper = upper.min(crop_h);
            each(Run { full, crop, level, len: upper });
            let len = crop_h - upper;
            if len > 0 {
                each(Run {
                    full: full + height - len,
                    crop: crop + upper,
                    level: level + level_h - len,
                    len,
                });
            }
        }
    }

    /// Calls `each` with place in the crop, place in the image's spectrum and angular frequency.
    pub fn visit(&self, width: usize, height: usize, mut each: impl FnMut(usize, usize, [f64; 2])) {
        self.runs(width, height, |run| {
            for i in 0..run.len {
                let full = run.full + i;
                let omega =
                    [angular_frequency(full / height, width), angular_frequency(full % height, height)];
                each(run.crop + i, full, omega);
            }
        });
    }
}
