//! Amplitude spectrum of the reference with the original's phases, as the document's claims allow.

use crate::fft2::Fft2;
use crate::spectral_resample::resample_spectrum;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// The original's phases with the reference's amplitudes.
pub(super) fn with_amplitudes(original: &Raster, reference: &Raster) -> Raster {
    let mut fft = Fft2::new(original.width, original.height);
    let amplitudes = resample_spectrum(reference, original.width, original.height);
    let mut spectrum = fft.spectrum(&original.values);
    for (value, &amplitude) in spectrum.iter_mut().zip(&amplitudes) {
        let norm = value.norm();
        *value = if norm > 0.0 { *value * (amplitude / norm) } else { Complex64::default() };
    }
    // The mean is a height, not an amplitude: it keeps its sign.
    spectrum[0] = Complex64::new(reference.mean() * original.values.len() as f64, 0.0);
    fft.image(&mut spectrum)
}
