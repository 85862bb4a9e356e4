//! Two-dimensional transforms of real images: half the spectrum, half the work.
//!
//! ```text
//! X(−kx, −ky) = conj X(kx, ky)         so that columns kx = 0 … width/2 say everything
//! ```
//! Two rows of an image travel through one complex transform, as its real and its imaginary part.
//! Columns are not kept in an array of their own: they are made, transformed and used a few at a
//! time, while they are in the cache, and a caller's filter is applied as they pass.

use asperity_fft::num_complex::Complex64;
use asperity_fft::{Fft, FftPlanner};
use std::sync::Arc;

/// Bytes of the rows or columns that are transformed at once: two thirds of a first-level cache of
/// 48 KiB.
const BLOCK_BYTES: usize = 16 * 1024;
/// Fewest of them: as many complex numbers as lie in one cache line, so that each line is read
/// once.
const FEWEST_IN_BLOCK: usize = 4;

/// Working memory of [`RealFft2`], for transforms of any sizes one after the other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Workspace {
    /// The image as spectra of its rows, cut off after the columns kept.
    rows: Vec<Complex64>,
    /// A few rows or columns.
    block: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

/// Plans for real images of one size.
#[derive(Clone)]
pub(crate) struct RealFft2 {
    width: usize,
    height: usize,
    rows: [Arc<dyn Fft<f64>>; 2],
    columns: [Arc<dyn Fft<f64>>; 2],
}

impl std::fmt::Debug for RealFft2 {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "RealFft2({} × {})", self.width, self.height)
    }
}

impl RealFft2 {
    /// Plans transforms of `width` × `height` images, both at least 1.
    pub fn new(planner: &mut FftPlanner, width: usize, height: usize) -> Self {
        let rows = [planner.plan_fft_forward(width), planner.plan_fft_inverse(width)];
        let columns = [planner.plan_fft_forward(height), planner.plan_fft_inverse(height)];
        Self { width, height, rows, columns }
    }

    /// Texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Number of values in the image.
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Columns kx = 0 … width/2, which determine the others.
    pub fn half_columns(&self) -> usize {
        self.width / 2 + 1
    }

    /// Transforms `image`, row by row, and calls `take` with kx and X(kx, ·) for kx below `kept`.
    ///
    /// # Panics
    /// When `image` does not hold [`RealFft2::len`] values or `kept` is beyond
    /// [`RealFft2::half_columns`].
    pub fn forward(
        &self,
        image: &[f64],
        kept: usize,
        work: &mut Workspace,
        mut take: impl FnMut(usize, &[Complex64]),
    ) {
        assert_eq!(image.len(), self.len(), "an image of the size that was planned");
        let stride = self.prepare(kept, work);
        let Workspace { rows, block, scratch } = work;
        let pairs = image.chunks(2 * self.width).zip(rows.chunks_exact_mut(2 * stride));
        for (pair, spectra) in pairs {
            let packed = &mut block[..self.width];
            pack_image_rows(pair, packed);
            self.rows[0].process_with_scratch(packed, scratch);
            let (first, second) = spectra.split_at_mut(stride);
            unpack_spectra(packed, &mut first[..kept], &mut second[..kept]);
        }
        let at_once = in_block(self.height);
        for start in (0..kept).step_by(at_once) {
            let columns = &mut block[..at_once.min(kept - start) * self.height];
            for (column, kx) in columns.chunks_exact_mut(self.height).zip(start..) {
                for (to, from) in column.iter_mut().zip(rows.chunks_exact(stride)) {
                    *to = from[kx];
                }
            }
            self.columns[0].process_with_scratch(columns, scratch);
            columns.chunks_exact(self.height).zip(start..).for_each(|(column, kx)| take(kx, column));
        }
    }

    /// Appends to `image`, row by row, the real part of the image whose spectrum is X(kx, ·) for kx
    /// below `kept`, conj X(−kx, −·) for negative kx and zero elsewhere; not divided by the number
    /// of values. `give` is called with each kx and must fill all of the column, whose former
    /// values mean nothing.
    ///
    /// # Panics
    /// When `kept` is beyond [`RealFft2::half_columns`].
    pub fn inverse_unscaled(
        &self,
        kept: usize,
        work: &mut Workspace,
        image: &mut Vec<f64>,
        mut give: impl FnMut(usize, &mut [Complex64]),
    ) {
        let stride = self.prepare(kept, work);
        let Workspace { rows, block, scratch } = work;
        let at_once = in_block(self.height);
        for start in (0..kept).step_by(at_once) {
            let columns = &mut block[..at_once.min(kept - start) * self.height];
            columns.chunks_exact_mut(self.height).zip(start..).for_each(|(column, kx)| give(kx, column));
            self.columns[1].process_with_scratch(columns, scratch);
            for (column, kx) in columns.chunks_exact(self.height).zip(start..) {
                for (&from, to) in column.iter().zip(rows.chunks_exact_mut(stride)) {
                    to[kx] = from;
                }
            }
        }
        image.reserve(self.len());
        for (pair, y) in rows.chunks_exact(2 * stride).zip((0..self.height).step_by(2)) {
            let packed = &mut block[..self.width];
            pack_spectra(&pair[..kept], &pair[stride..stride + kept], packed);
            self.rows[1].process_with_scratch(packed, scratch);
            image.extend(packed.iter().map(|value| value.re));
            if y + 1 < self.height {
                image.extend(packed.iter().map(|value| value.im));
            }
        }
    }

    /// Makes room and returns the distance between two rows. The row that an odd height lacks is
    /// zero.
    fn prepare(&self, kept: usize, work: &mut Workspace) -> usize {
        assert!((1..=self.half_columns()).contains(&kept), "the columns of half a spectrum");
        // An odd distance: with a power of two all rows would contend for a few places of the
        // cache.
        let stride = kept | 1;
        let zero = Complex64::default();
        work.rows.resize(stride * self.height.next_multiple_of(2), zero);
        work.rows[stride * self.height..].fill(zero);
        let block = self.width.max(in_block(self.height) * self.height);
        work.block.resize(work.block.len().max(block), zero);
        let plans = self.rows.iter().chain(&self.columns);
        let scratch = plans.map(|plan| plan.get_inplace_scratch_len()).max().unwrap_or(0);
        work.scratch.resize(work.scratch.len().max(scratch), zero);
        stride
    }
}

/// Number of columns of `height` values that are transformed at once.
fn in_block(height: usize) -> usize {
    (BLOCK_BYTES / (size_of::<Complex64>() * height)).max(FEWEST_IN_BLOCK)
}

/// a + i b from one or two rows a, b.
fn pack_image_rows(pair: &[f64], packed: &mut [Complex64]) {
    let (first, second) = pair.split_at(packed.len());
    if second.is_empty() {
        packed.iter_mut().zip(first).for_each(|(to, &re)| *to = Complex64::new(re, 0.0));
    } else {
        let both = first.iter().zip(second);
        packed.iter_mut().zip(both).for_each(|(to, (&re, &im))| *to = Complex64::new(re, im));
    }
}

/// The spectra A and B of two real rows from that of a + i b, as far as they are wanted.
fn unpack_spectra(packed: &[Complex64], first: &mut [Complex64], second: &mut [Complex64]) {
    first[0] = Complex64::new(packed[0].re, 0.0);
    second[0] = Complex64::new(packed[0].im, 0.0);
    let (first, second) = (&mut first[1..], &mut second[1..]);
    let up = &packed[1..=first.len()];
    let down = packed[packed.len() - first.len()..].iter().rev();
    for (((a, b), up), down) in first.iter_mut().zip(second).zip(up).zip(down) {
        *a = Complex64::new(0.5 * (up.re + down.re), 0.5 * (up.im - down.im));
        *b = Complex64::new(0.5 * (up.im + down.im), 0.5 * (down.re - up.re));
    }
}

/// The spectrum of a + i b from those of two real rows, which may be cut off.
fn pack_spectra(first: &[Complex64], second: &[Complex64], packed: &mut [Complex64]) {
    let width = packed.len();
    packed[0] = Complex64::new(first[0].re, second[0].re);
    // Columns that have a mirror image: all but zero and, in even widths, the last.
    let paired = first.len().min(width.div_ceil(2));
    packed[paired..=width - paired].fill(Complex64::default());
    if first.len() > paired {
        packed[paired] = Complex64::new(first[paired].re, second[paired].re);
    }
    let (low, high) = packed.split_at_mut(paired);
    let up = &mut low[1..];
    let from = high.len() - up.len();
    let down = high[from..].iter_mut().rev();
    for (((a, b), up), down) in first[1..paired].iter().zip(&second[1..paired]).zip(up).zip(down) {
        *up = Complex64::new(a.re - b.im, a.im + b.re);
        *down = Complex64::new(a.re + b.im, b.re - a.im);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fft2::Fft2;
    use asperity_dsp::rng::Rng;

    const SIZES: [(usize, usize); 8] =
        [(1, 1), (2, 2), (1, 6), (6, 1), (8, 12), (15, 9), (33, 20), (64, 300)];

    fn noise(count: usize, seed: u64) -> Vec<f64> {
        let mut rng = Rng::new(seed);
        (0..count).map(|_| rng.normal()).collect()
    }

    #[test]
    fn half_the_spectrum_is_that_of_the_complex_transform_at_any_size() {
        let mut work = Workspace::default();
        for (width, height) in SIZES {
            let image = noise(width * height, 6);
            let mut complex: Vec<_> = image.iter().map(|&v| Complex64::new(v, 0.0)).collect();
            let mut whole = complex.clone();
            Fft2::new(width, height).forward(&mut complex, &mut whole);
            let real = RealFft2::new(&mut FftPlanner::new(), width, height);
            for kept in 1..=real.half_columns() {
                let mut next = 0;
                real.forward(&image, kept, &mut work, |kx, column| {
                    assert_eq!(kx, next);
                    next += 1;
                    let expected = &whole[kx * height..(kx + 1) * height];
                    assert!(column.iter().zip(expected).all(|(a, b)| (a - b).norm() < 1e-11));
                });
                assert_eq!(next, kept);
            }
        }
    }

    #[test]
    fn columns_left_out_count_as_zero_on_the_way_back() {
        let mut work = Workspace::default();
        for (width, height) in SIZES {
            let real = RealFft2::new(&mut FftPlanner::new(), width, height);
            let parts = noise(2 * width * height, 7);
            for kept in 1..=real.half_columns() {
                let at = |kx: usize, ky: usize| {
                    let place = 2 * (kx * height + ky);
                    Complex64::new(parts[place], parts[place + 1])
                };
                // X(k) + conj X(−k) is the spectrum of twice the real part.
                let mut whole = vec![Complex64::default(); width * height];
                for kx in 0..kept {
                    for ky in 0..height {
                        whole[kx * height + ky] += at(kx, ky);
                        let mirrored = (width - kx) % width * height + (height - ky) % height;
                        whole[mirrored] += at(kx, ky).conj();
                    }
                }
                let mut expected = whole.clone();
                Fft2::new(width, height).inverse(&mut whole, &mut expected);
                let texels = (width * height) as f64;
                let mut image = Vec::new();
                real.inverse_unscaled(kept, &mut work, &mut image, |kx, column| {
                    // A column that is its own mirror image has been added to itself.
                    let scale = if (2 * kx).is_multiple_of(width) { 2.0 } else { 1.0 };
                    for (ky, value) in column.iter_mut().enumerate() {
                        *value = scale * at(kx, ky);
                    }
                });
                assert_eq!(image.len(), expected.len());
                assert!(image.iter().zip(&expected).all(|(a, b)| (a - texels * b.re).abs() < 1e-9));
            }
        }
    }
}
