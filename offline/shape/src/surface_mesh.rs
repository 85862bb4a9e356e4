//! Surface of a body as games have it: joined points, one sense of turning, closed holes.

use crate::error::ShapeError;
use crate::holes::Caps;
use crate::repair::{Cracks, edge_uses, open_edges};
use crate::triangle_tree::{TriangleTree, area_vector};
use crate::vector::{Vec3, add_scaled, cross, dot, length, longest_side, mean, sub};
use crate::volume_mesh::find;

/// Most triangles that are read.
pub const MOST_TRIANGLES: usize = 4_000_000;
/// Holes whose triangles are more than this part of the whole surface make it an open sheet.
const LARGEST_HOLES: f64 = 0.09;
/// Single triangles that are missing were lost; they may be this part of the surface (a box has
/// twelve in all).
const LARGEST_LOST: f64 = 0.3;
/// A part counts as lying inside another when this much of its area does.
const NESTED: f64 = 0.9;
/// Triangles of a part that are asked for that.
const ASKED: usize = 64;

/// Points and triangles, anticlockwise from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SurfaceMesh {
    /// Corners, m.
    pub points: Vec<Vec3>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
}

impl SurfaceMesh {
    /// The corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|i| self.points[i as usize])
    }

    /// All triangles by their corners.
    #[must_use]
    pub fn all_corners(&self) -> Vec<[Vec3; 3]> {
        self.triangles.iter().map(|&t| self.corners(t)).collect()
    }

    /// Area, m².
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        self.all_corners().into_iter().map(|t| length(area_vector(t))).sum()
    }

    /// Volume, m³, where the surface is closed.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        self.all_corners().iter().map(|t| dot(t[0], cross(t[1], t[2])) / 6.0).sum()
    }

    /// Joins points, leaves out triangles without area and doubled ones, closes cracks, and turns
    /// each part one way.
    ///
    /// # Errors
    /// When a number is not finite or nothing is left.
    pub fn joined(self, cracks: Cracks, remarks: &mut Vec<String>) -> Result<Self, ShapeError> {
        if let Some(i) = self.points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            let what = format!("point {} is not a number", i + 1);
            return Err(ShapeError::new("", what, "coordinates must be finite metres"));
        }
        if self.triangles.is_empty() {
            return Err(ShapeError::new("", "has no triangle", "give the surface of a body"));
        }
        if self.triangles.len() > MOST_TRIANGLES {
            let what = format!("has {} triangles", self.triangles.len());
            return Err(ShapeError::new("", what, format!("at most {MOST_TRIANGLES}")));
        }
        let side_m = longest_side(&self.points);
        let mut repaired = self.repaired(cracks, remarks);
        if repaired.triangles.is_empty() {
            let what =
                format!("every triangle is lower than a millionth of the longest side, {side_m:.1e} m");
            return Err(ShapeError::new("", what, "give the surface of a body"));
        }
        repaired.turn_alike(remarks);
        Ok(repaired)
    }

    /// Parts that hang together by edges of two triangles: the number of each triangle's part.
    fn parts(&self) -> Vec<usize> {
        let mut root: Vec<usize> = (0..self.triangles.len()).collect();
        let uses = edge_uses(&self.triangles);
        for pair in uses.chunk_by(|a, b| a.edge == b.edge).filter(|uses| uses.len() == 2) {
            let (a, b) = (find(&mut root, pair[0].triangle), find(&mut root, pair[1].triangle));
            root[a.max(b)] = a.min(b);
        }
        (0..root.len()).map(|i| find(&mut root, i)).collect()
    }

    /// Turns the triangles of each part the way most of them are.
    fn turn_alike(&mut self, remarks: &mut Vec<String>) {
        let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); self.triangles.len()];
        let uses = edge_uses(&self.triangles);
        for pair in uses.chunk_by(|a, b| a.edge == b.edge).filter(|uses| uses.len() == 2) {
            let against = pair[0].upwards == pair[1].upwards;
            neighbours[pair[0].triangle].push((pair[1].triangle, against));
            neighbours[pair[1].triangle].push((pair[0].triangle, against));
        }
        let mut turned: Vec<Option<bool>> = vec![None; self.triangles.len()];
        let mut count = 0;
        for seed in 0..self.triangles.len() {
            if turned[seed].is_some() {
                continue;
            }
            let mut part = vec![seed];
            turned[seed] = Some(false);
            let mut next = 0;
            while next < part.len() {
                let (t, mine) = (part[next], turned[part[next]] == Some(true));
                next += 1;
                for &(other, against) in &neighbours[t] {
                    if turned[other].is_none() {
                        turned[other] = Some(mine != against);
                        part.push(other);
                    }
                }
            }
            let area = |t: usize| length(area_vector(self.corners(self.triangles[t])));
            let balance: f64 =
                part.iter().map(|&t| if turned[t] == Some(true) { -area(t) } else { area(t) }).sum();
            let flip_when = Some(balance >= 0.0);
            for &t in part.iter().filter(|&&t| turned[t] == flip_when) {
                self.triangles[t].swap(1, 2);
                count += 1;
            }
        }
        if count > 0 {
            remarks.push(format!("{count} triangles were inside out and were turned"));
        }
    }

    /// Closes holes, turns parts that are inside out, and refuses an open sheet.
    ///
    /// # Errors
    /// When it is an open sheet or encloses nothing.
    pub fn closed(mut self, remarks: &mut Vec<String>) -> Result<Self, ShapeError> {
        let whole = self.area_m2();
        let Caps { caps, lost, holes } = self.caps();
        let area = |triangles: &[[Vec3; 3]]| triangles.iter().map(|t| length(area_vector(*t))).sum::<f64>();
        let missing = area(&caps) + area(&lost);
        let closed = whole + missing;
        if area(&caps) > LARGEST_HOLES * closed || area(&lost) > LARGEST_LOST * closed {
            let percent = 100.0 * missing / (whole + missing);
            let what = format!("is an open sheet: {percent:.0} % of what would close it is missing");
            return Err(ShapeError::new(
                "",
                what,
                "close it, or say how thick the sheet is with --thickness",
            ));
        }
        if missing > 1e-9 * whole {
            let percent = 100.0 * missing / (whole + missing);
            remarks.push(format!("{holes} holes were closed, {percent:.1} % of the surface"));
        }
        for [a, b, c] in caps.into_iter().chain(lost) {
            let first = self.points.len() as u32;
            self.points.extend([a, b, c]);
            self.triangles.push([first, first + 1, first + 2]);
        }
        let mut rejoined = self.joined(Cracks::Hair, &mut Vec::new())?;
        rejoined.turn_parts_outwards(remarks);
        let side = longest_side(&rejoined.points);
        let enclosed = rejoined.volume_m3();
        if enclosed < 1e-6 * rejoined.area_m2() * side {
            let what = "encloses nothing: its walls have no thickness";
            return Err(ShapeError::new(
                "",
                what,
                "close it, or say how thick the sheet is with --thickness",
            ));
        }
        Ok(rejoined)
    }

    /// Outer parts enclose a positive volume; a part inside another that is turned inwards is a
    /// cavity and stays.
    fn turn_parts_outwards(&mut self, remarks: &mut Vec<String>) {
        let part_of = self.parts();
        let mut triangles_of: Vec<Vec<usize>> = vec![Vec::new(); self.triangles.len()];
        part_of.iter().enumerate().for_each(|(t, &part)| triangles_of[part].push(t));
        let volume = |t: usize| {
            let [a, b, c] = self.corners(self.triangles[t]);
            dot(a, cross(b, c)) / 6.0
        };
        let inwards: Vec<usize> = (0..triangles_of.len())
            .filter(|&part| triangles_of[part].iter().map(|&t| volume(t)).sum::<f64>() < 0.0)
            .collect();
        if inwards.is_empty() {
            return;
        }
        let mut outwards = self.clone();
        for &t in inwards.iter().flat_map(|&part| &triangles_of[part]) {
            outwards.triangles[t].swap(1, 2);
        }
        let tree = TriangleTree::new(&outwards.all_corners());
        let mut turned = false;
        for part in inwards {
            if outwards.share_inside(&triangles_of[part], &tree) < NESTED {
                triangles_of[part].iter().for_each(|&t| self.triangles[t] = outwards.triangles[t]);
                turned = true;
            }
        }
        if turned {
            remarks.push("the surface was inside out and was turned".into());
        }
    }

    /// Share of a part's area that lies inside others, in a surface whose parts all enclose a
    /// positive volume.
    fn share_inside(&self, part: &[usize], tree: &TriangleTree) -> f64 {
        let under = 1e-6 * longest_side(&self.points);
        let (mut inside, mut whole) = (0.0, 0.0);
        for &t in part.iter().step_by(part.len().div_ceil(ASKED)) {
            let corners = self.corners(self.triangles[t]);
            let area = area_vector(corners);
            let place = add_scaled(mean(corners), -under, crate::vector::unit(area));
            whole += length(area);
            // The part itself winds around it once.
            if tree.winding(place) >= 1.5 {
                inside += length(area);
            }
        }
        inside / whole
    }

    /// Outward unit normal of each triangle.
    #[must_use]
    pub fn normals(&self) -> Vec<Vec3> {
        self.all_corners().into_iter().map(|t| crate::vector::unit(area_vector(t))).collect()
    }

    /// The sheet as a body of `thickness_m`, half of it on either side: both sides and the rims
    /// between them.
    #[must_use]
    pub fn thickened(&self, thickness_m: f64) -> Self {
        let offsets = self.offsets();
        let n = self.points.len() as u32;
        let side = |sign: f64| {
            let half = 0.5 * sign * thickness_m;
            self.points.iter().zip(&offsets).map(move |(p, o)| add_scaled(*p, half, *o))
        };
        let points = side(1.0).chain(side(-1.0)).collect();
        let mut triangles = self.triangles.clone();
        triangles.extend(self.triangles.iter().map(|&[a, b, c]| [a + n, c + n, b + n]));
        for open in open_edges(&edge_uses(&self.triangles)) {
            let [a, b] = if open.upwards { open.edge } else { [open.edge[1], open.edge[0]] };
            triangles.extend([[b, a, a + n], [b, a + n, b + n]]);
        }
        triangles.sort_unstable();
        Self { points, triangles }
    }

    /// For each point the direction along which both sides of the sheet keep their distance from
    /// it.
    fn offsets(&self) -> Vec<Vec3> {
        let mut sum = vec![[0.0; 3]; self.points.len()];
        let mut around: Vec<Vec<Vec3>> = vec![Vec::new(); self.points.len()];
        for (triangle, normal) in self.triangles.iter().zip(self.normals()) {
            for k in 0..3 {
                let corners = self.corners([triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]]);
                let (u, v) = (sub(corners[1], corners[0]), sub(corners[2], corners[0]));
                let angle = length(cross(u, v)).atan2(dot(u, v));
                let i = triangle[k] as usize;
                sum[i] = add_scaled(sum[i], angle, normal);
                around[i].push(normal);
            }
        }
        sum.iter()
            .zip(&around)
            .map(|(s, normals)| {
                let n = crate::vector::unit(*s);
                // A mitre, no longer than twice the half thickness.
                let least = normals.iter().map(|m| dot(n, *m)).fold(1.0, f64::min).max(0.5);
                n.map(|x| x / least)
            })
            .collect()
    }
}
