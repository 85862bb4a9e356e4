//! Polygons cut into triangles: a fan where that covers the polygon, ears where it is concave.

use crate::triangle_tree::area_vector;
use crate::vector::{Vec3, add_scaled, dot};
use earcut::{Earcut, utils3d::project3d_to_2d};

/// Triangles of a polygon by its corners; none where a corner is not there.
pub(crate) fn triangles(points: &[Vec3], corners: &[u32]) -> Option<Vec<[u32; 3]>> {
    let places = corners.iter().map(|&i| points.get(i as usize).copied()).collect::<Option<Vec<Vec3>>>()?;
    let last = corners.len().checked_sub(1)?;
    let fan: Vec<[usize; 3]> = (1..last).map(|i| [0, i, i + 1]).collect();
    let areas: Vec<Vec3> = fan.iter().map(|t| area_vector(t.map(|i| places[i]))).collect();
    let whole = areas.iter().fold([0.0; 3], |sum, a| add_scaled(sum, 1.0, *a));
    let of = |t: [usize; 3]| t.map(|i| corners[i]);
    let is_covered = areas.iter().all(|a| dot(*a, whole) >= 0.0);
    let (mut flat, mut ears) = (Vec::new(), Vec::new());
    if is_covered || !project3d_to_2d(&places, places.len(), &mut flat) {
        return Some(fan.into_iter().map(of).collect());
    }
    Earcut::new().earcut(flat, &[], &mut ears);
    let (ears, _): (&[[usize; 3]], _) = ears.as_chunks();
    Some(ears.iter().map(|&t| of(t)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::length;

    #[test]
    fn a_concave_polygon_is_covered_once_from_whichever_corner_it_begins() {
        // An L of area 3 in a tilted plane.
        let flat = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let points: Vec<Vec3> = flat.iter().map(|[x, y]| [*x, 0.6 * y, 0.8 * y]).collect();
        for first in 0..6 {
            let corners: Vec<u32> = (0..6).map(|i| (first + i) % 6).collect();
            let cut = triangles(&points, &corners).unwrap();
            let areas = cut.iter().map(|t| area_vector(t.map(|i| points[i as usize])));
            let sum: f64 = areas.clone().map(length).sum();
            assert!((sum - 3.0).abs() < 1e-12, "{first}: {sum} {cut:?}");
            assert!(areas.into_iter().all(|a| a[1] < 1e-12 && a[2] > -1e-12), "{first}");
        }
    }
}
