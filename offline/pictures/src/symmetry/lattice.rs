//! Two translations that carry a pattern onto itself, and the arithmetic of the lattice they span.

use serde::Serialize;

/// The lattice of a repeated pattern, in texels of the picture; x grows to the right, y downwards.
///
/// The basis is reduced: `t1_px` is a shortest translation and points right (or straight down; of
/// several as short to within 2 % the one nearest to "right"), `t2_px` a shortest one that is not
/// parallel to it, turned from `t1_px` by 60° to 120° clockwise as seen on the picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Lattice {
    /// First translation, texels.
    pub t1_px: [f64; 2],
    /// Second translation, texels.
    pub t2_px: [f64; 2],
    /// Certainty that the pattern repeats, 0–1; 0.5 is where "no lattice" begins.
    pub confidence: f64,
}

impl Lattice {
    /// Area of the cell, texels².
    #[must_use]
    pub fn cell_area_px2(&self) -> f64 {
        cross(self.t1_px, self.t2_px).abs()
    }

    /// The translation m·t1 + n·t2, texels.
    #[must_use]
    pub fn translation(&self, m: f64, n: f64) -> [f64; 2] {
        combine(self.t1_px, self.t2_px, m, n)
    }

    /// Coordinates of a point in units of the basis: the inverse of [`Self::translation`].
    #[must_use]
    pub fn coordinates(&self, point: [f64; 2]) -> [f64; 2] {
        solve(self.t1_px, self.t2_px, point)
    }
}

/// Relative difference up to which two translations count as equally short.
const AS_SHORT: f64 = 0.02;
/// Sine of the angle up to which a translation counts as straight down or up.
const STRAIGHT: f64 = 0.01;

/// a × b.
pub(super) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// a · b.
pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Length of a.
pub(super) fn length(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

/// m·a + n·b.
pub(super) fn combine(a: [f64; 2], b: [f64; 2], m: f64, n: f64) -> [f64; 2] {
    [m * a[0] + n * b[0], m * a[1] + n * b[1]]
}

/// The m, n of m·a + n·b = point.
pub(super) fn solve(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> [f64; 2] {
    let area = cross(a, b);
    [cross(point, b) / area, cross(a, point) / area]
}

/// The reduced basis of the lattice that a and b span (Lagrange and Gauss), oriented as [`Lattice`]
/// says.
pub(super) fn reduced(a: [f64; 2], b: [f64; 2]) -> [[f64; 2]; 2] {
    let (mut short, mut long) = if length(a) <= length(b) { (a, b) } else { (b, a) };
    // Each round shortens `long` or ends; 64 rounds would shrink any finite basis to nothing.
    for _ in 0..64 {
        let turns = (dot(short, long) / dot(short, short)).round();
        long = combine(long, short, 1.0, -turns);
        // A hair's margin: equal lengths must not swap for ever.
        if length(long) >= length(short) * (1.0 - 1e-12) {
            break;
        }
        std::mem::swap(&mut short, &mut long);
    }
    if short[0] < 0.0 || (short[0] == 0.0 && short[1] < 0.0) {
        short = [-short[0], -short[1]];
    }
    if cross(short, long) < 0.0 {
        long = [-long[0], -long[1]];
    }
    [short, long]
}

/// Lattice with the first translation as nearly to the right as one of the shortest can be, so that
/// noise does not turn a square lattice by 90°.
pub(super) fn upright([a, b]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let shortest = length(a) * (1.0 + AS_SHORT);
    let between = if dot(a, b) > 0.0 { combine(a, b, 1.0, -1.0) } else { combine(a, b, 1.0, 1.0) };
    let slope = |t: &[f64; 2]| (t[1].abs() / length(*t), if t[1] < 0.0 { 1 } else { 0 });
    let all = [a, b, between].map(|t| if t[0] < 0.0 { [-t[0], -t[1]] } else { t });
    let best = all
        .into_iter()
        .filter(|t| length(*t) <= shortest)
        .min_by(|s, t| slope(s).partial_cmp(&slope(t)).unwrap_or(std::cmp::Ordering::Equal));
    let mut first = best.unwrap_or(a);
    if first[0] < STRAIGHT * length(first) && first[1] < 0.0 {
        first = [-first[0], -first[1]];
    }
    let others = all.into_iter().filter(|t| cross(first, *t).abs() > 0.5 * cross(a, b).abs());
    let mut second = others.min_by(|s, t| length(*s).total_cmp(&length(*t))).unwrap_or(b);
    if cross(first, second) < 0.0 {
        second = [-second[0], -second[1]];
    }
    [first, second]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduction_finds_the_short_basis_of_a_skewed_one() {
        let [a, b] = reduced([10.0 + 7.0 * 30.0, 7.0 * 4.0], [30.0, 4.0]);
        // (10, 0) and (30, 4) span what (0, 4) and (10, 0) span.
        assert!((length(a) - 4.0).abs() < 1e-9 && (length(b) - 10.0).abs() < 1e-9);
        assert!((cross(a, b) - 40.0).abs() < 1e-9);
        assert!(2.0 * dot(a, b).abs() <= dot(a, a) + 1e-9);
    }

    #[test]
    fn coordinates_undo_translations() {
        let lattice = Lattice { t1_px: [20.0, 3.0], t2_px: [-5.0, 31.0], confidence: 1.0 };
        let [m, n] = lattice.coordinates(lattice.translation(2.25, -7.5));
        assert!((m - 2.25).abs() < 1e-12 && (n + 7.5).abs() < 1e-12);
        assert!((lattice.cell_area_px2() - 635.0).abs() < 1e-9);
    }

    #[test]
    fn a_square_lattice_is_told_upright_however_it_was_found() {
        for (a, b) in [
            ([1e-4, 16.0], [-16.01, 0.0]),
            ([16.0, 1e-4], [0.0, 16.02]),
            ([1e-5, -16.0], [16.0, 0.0]),
            ([-16.0, 0.0], [0.0, -16.0]),
        ] {
            let [s, t] = upright([a, b]);
            let off = length([s[0] - 16.0, s[1]]).max(length([t[0], t[1] - 16.0]));
            assert!(off < 0.05, "{a:?} {b:?}: {s:?} {t:?}");
        }
        // A clearly shorter translation straight up stays the first, straight down.
        let [s, t] = upright([[1e-5, -13.0], [17.0, 0.1]]);
        assert!((s[1] - 13.0).abs() < 1e-9 && (t[0] + 17.0).abs() < 1e-9, "{s:?} {t:?}");
    }

    #[test]
    fn a_hexagonal_basis_keeps_its_lengths() {
        let [a, b] = reduced([16.0, 0.0], [24.0, 8.0 * 3.0_f64.sqrt()]);
        assert!((length(a) - 16.0).abs() < 1e-9 && (length(b) - 16.0).abs() < 1e-9);
    }
}
