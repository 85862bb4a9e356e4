//! A measured height profile as a thin raster that a scene can name.

use asperity_surface::raster::Raster;

/// Distance between the samples of the measured profiles, m.
pub const STEP_M: f64 = 1.394_068e-6;
/// Samples used: the widest map that is accepted, 45.7 mm of the profile.
pub const SAMPLES: usize = 32_768;
/// Rows of the raster; the profile is the same in each.
pub const ROWS: usize = 4;

/// The numbers of a one-dimensional `.npy` file of 64-bit floats.
pub fn read_npy(bytes: &[u8]) -> Result<Vec<f64>, String> {
    let header = |range: std::ops::Range<usize>| bytes.get(range).ok_or("shorter than its header");
    if header(0..6)? != b"\x93NUMPY" {
        return Err("not an .npy file".into());
    }
    let (length, start) = match header(6..8)?[0] {
        1 => (usize::from(u16::from_le_bytes([bytes[8], bytes[9]])), 10),
        2 | 3 => (u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]) as usize, 12),
        version => return Err(format!("version {version} of .npy is unknown")),
    };
    let described = String::from_utf8_lossy(header(start..start + length)?).into_owned();
    if !described.contains("'<f8'") {
        return Err(format!("not 64-bit little-endian floats: {described}"));
    }
    let numbers = bytes[start + length..].chunks_exact(8);
    Ok(numbers.map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])).collect())
}

/// The profile's first [`SAMPLES`] as grey 0–1, and its relief, m.
pub fn raster(heights_m: &[f64]) -> (Raster, f64) {
    let heights_m = &heights_m[..SAMPLES.min(heights_m.len())];
    let low = heights_m.iter().copied().fold(f64::INFINITY, f64::min);
    let relief_m = heights_m.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
    let raster = Raster::from_fn(heights_m.len(), ROWS, |x, _| (heights_m[x] - low) / relief_m);
    (raster, relief_m)
}
