//! Vectors of three components: the few operations that meshes and motions need.

/// A point or direction, m.
pub type Vec3 = [f64; 3];

/// a − b.
#[must_use]
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + s b.
#[must_use]
pub fn add_scaled(a: Vec3, s: f64, b: Vec3) -> Vec3 {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// a · b.
#[must_use]
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[must_use]
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// |a|.
#[must_use]
pub fn length(a: Vec3) -> f64 {
    libm::sqrt(dot(a, a))
}

/// |a − b|.
#[must_use]
pub fn distance(a: Vec3, b: Vec3) -> f64 {
    length(sub(a, b))
}

/// a / |a|; zero stays zero.
#[must_use]
pub fn unit(a: Vec3) -> Vec3 {
    let l = length(a);
    if l > 0.0 { [a[0] / l, a[1] / l, a[2] / l] } else { [0.0; 3] }
}

/// The mean of some points.
#[must_use]
pub fn mean<const N: usize>(points: [Vec3; N]) -> Vec3 {
    core::array::from_fn(|c| points.iter().map(|p| p[c]).sum::<f64>() / N as f64)
}

/// The least and greatest corner of the box around some points; none for no point.
#[must_use]
pub fn bounds(points: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(low, high), p| {
        (core::array::from_fn(|c| low[c].min(p[c])), core::array::from_fn(|c| high[c].max(p[c])))
    }))
}

/// The longest side of the box around some points, m; 0 for no point.
#[must_use]
pub fn longest_side(points: &[Vec3]) -> f64 {
    bounds(points).map_or(0.0, |(low, high)| (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn products_of_random_vectors_obey_lagranges_identity() {
        assert_eq!(cross([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        let mut rng = Rng::new(7);
        for _ in 0..1000 {
            let [a, b]: [Vec3; 2] = [0; 2].map(|_| [0; 3].map(|_| rng.normal()));
            let (s, c) = (rng.normal(), cross(a, b));
            let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
            let sum = add_scaled(a, s, b);
            for (found, wanted) in [
                (dot(c, c) + ab * ab, aa * bb),
                (dot(a, c), 0.0),
                (dot(b, c), 0.0),
                (dot(sum, sum), aa + s * (2.0 * ab + s * bb)),
                (distance(sum, a), s.abs() * length(b)),
            ] {
                assert!((found - wanted).abs() < 1e-10, "{a:?}, {b:?}, {s}: {found} and not {wanted}");
            }
        }
    }
}
