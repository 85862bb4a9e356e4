//! Large photographs, reduced to what is worked on.

use asperity_surface::raster::Raster;

/// Largest picture that is worked on, texels: larger ones are reduced ([`reduced`]).
pub const MOST_TEXELS: usize = 1 << 22;

/// A picture of at most [`MOST_TEXELS`] and how many of its texels are one of the result along a
/// side: means of n × n.
#[must_use]
pub fn reduced(picture: Raster) -> (Raster, usize) {
    let n = Raster::reduction(picture.width, picture.height, MOST_TEXELS);
    if n == 1 { (picture, 1) } else { (means(&picture, n), n) }
}

/// Means of n × n texels; what does not fill one at the right and lower border is left out.
pub(super) fn means(picture: &Raster, n: usize) -> Raster {
    let (w, h) = (picture.width / n, picture.height / n);
    let mut means = Raster::constant(w, h, 0.0);
    let share = 1.0 / (n * n) as f64;
    for y in 0..h * n {
        let row = &mut means.values[y / n * w..][..w];
        for (mean, texels) in row.iter_mut().zip(picture.row(y).chunks_exact(n)) {
            *mean += share * texels.iter().sum::<f64>();
        }
    }
    means
}
