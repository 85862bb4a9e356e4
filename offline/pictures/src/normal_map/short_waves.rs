//! Short waves of heights that the wrong differences have raised.
//!
//! ```text
//! P_t > MOST P_m        mean power of waves of 2–3 texels (t) and of 3–6 texels (m)
//! ```
//! Heights have less of shorter waves, at most as much (white noise). Central and Sobel's
//! differences hardly see waves of 2 to 3 texels, so integration divides these by next to nothing.
//! Of slopes made by such differences little is there to be divided; resizing, sharpening and JPEG
//! leave more.

use crate::fft2::{Fft2, angular_frequency};
use asperity_surface::raster::Raster;
use std::f64::consts::PI;

/// Power of the shortest waves over that of longer ones from which they were raised; 1 of white
/// noise.
const MOST: f64 = 1.5;

/// Tests whether the shortest waves of these heights outgrow longer ones.
pub(super) fn outgrow_longer_ones(heights: &Raster) -> bool {
    let (w, h) = (heights.width, heights.height);
    let spectrum = Fft2::new(w, h).spectrum(&heights.values);
    let mut thirds = [(0.0, 0.0); 3];
    for (place, value) in spectrum.iter().enumerate() {
        let frequency = angular_frequency(place / h, w).hypot(angular_frequency(place % h, h));
        if let Some((power, count)) = thirds.get_mut((3.0 * frequency / PI) as usize) {
            (*power, *count) = (*power + value.norm_sqr(), *count + 1.0);
        }
    }
    let [_, middle, top] = thirds.map(|(power, count)| power / f64::max(count, 1.0));
    top > MOST * middle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient_field::{Derivative, integrate_periodic, slopes};
    use asperity_dsp::rng::Rng;

    #[test]
    fn true_slopes_taken_for_differences_outgrow_and_noise_does_not() {
        let mut rng = Rng::new(7);
        let ground = Raster::from_fn(96, 80, |_, _| rng.normal());
        assert!(!outgrow_longer_ones(&ground));
        let baked = slopes(&ground, Derivative::Exact);
        assert!(outgrow_longer_ones(&integrate_periodic(&baked, Derivative::Sobel)));
        let by_sobel = slopes(&ground, Derivative::Sobel);
        assert!(!outgrow_longer_ones(&integrate_periodic(&by_sobel, Derivative::Sobel)));
    }
}
