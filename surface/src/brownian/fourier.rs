//! Fourier transforms of rows and of squares, in place, forwards and not scaled.

use asperity_fft::FftPlanner;

pub(super) type Complex = asperity_fft::num_complex::Complex<f64>;

/// Transforms every line of `n` values.
pub(super) fn forward_lines(values: &mut [Complex], n: usize) {
    let fft = FftPlanner::new().plan_fft_forward(n);
    let mut scratch = vec![Complex::default(); fft.get_inplace_scratch_len()];
    fft.process_with_scratch(values, &mut scratch);
}

/// Transforms an n × n square along both axes.
pub(super) fn forward_2d(values: &mut [Complex], n: usize) {
    forward_lines(values, n);
    transpose(values, n);
    forward_lines(values, n);
    transpose(values, n);
}

/// In tiles that stay in the cache.
fn transpose(values: &mut [Complex], n: usize) {
    const TILE: usize = 16;
    for y0 in (0..n).step_by(TILE) {
        for x0 in (y0..n).step_by(TILE) {
            for y in y0..(y0 + TILE).min(n) {
                for x in x0.max(y + 1)..(x0 + TILE).min(n) {
                    values.swap(y * n + x, x * n + y);
                }
            }
        }
    }
}
