//! Power spectra of test signals: a radix-2 FFT and Hann-windowed periodograms.

use std::f64::consts::PI;

/// In-place FFT of a power of two of complex numbers.
pub fn fft(re: &mut [f64], im: &mut [f64]) {
    let n = re.len();
    let mut j = 0;
    for i in 1..n {
        let mut bit = n >> 1;
        while j & bit != 0 {
            j ^= bit;
            bit >>= 1;
        }
        j |= bit;
        if i < j {
            re.swap(i, j);
            im.swap(i, j);
        }
    }
    let mut size = 2;
    while size <= n {
        let half = size / 2;
        let twiddles: Vec<(f64, f64)> =
            (0..half).map(|k| (-2.0 * PI * k as f64 / size as f64).sin_cos()).collect();
        for start in (0..n).step_by(size) {
            for (k, &(sin, cos)) in twiddles.iter().enumerate() {
                let (a, b) = (start + k, start + k + half);
                let (x, y) = (re[b] * cos - im[b] * sin, re[b] * sin + im[b] * cos);
                (re[b], im[b]) = (re[a] - x, im[a] - y);
                (re[a], im[a]) = (re[a] + x, im[a] + y);
            }
        }
        size *= 2;
    }
}

/// One-sided power per bin of a Hann-windowed segment: the sum over bins is the mean square.
pub fn power(signal: &[f64]) -> Vec<f64> {
    let n = signal.len();
    let mean = signal.iter().sum::<f64>() / n as f64;
    let hann = |i: usize| 0.5 - 0.5 * (2.0 * PI * i as f64 / n as f64).cos();
    let mut re: Vec<f64> = signal.iter().enumerate().map(|(i, x)| (x - mean) * hann(i)).collect();
    let mut im = vec![0.0; n];
    fft(&mut re, &mut im);
    let scale = 2.0 / (0.375 * (n as f64 * n as f64));
    (0..n / 2).map(|k| (re[k] * re[k] + im[k] * im[k]) * scale).collect()
}
