//! Surface of a body as games have it, and its repair: joined points, one sense of turning, closed holes.

use crate::error::ShapeError;
use crate::triangle_tree::{TriangleTree, area_vector};
use crate::vector::{Vec3, cross, dot, length, longest_side, mean, sub};
use crate::volume_mesh::{check_side, find, sorted};
use std::collections::{HashMap, HashSet};

/// Most triangles that are read.
pub const MOST_TRIANGLES: usize = 4_000_000;
/// Points nearer than this part of the longest side are one.
const JOINED: f64 = 1e-6;
/// Holes whose triangles are more than this part of the whole surface make it an open sheet.
const LARGEST_HOLES: f64 = 0.09;
/// Single triangles that are missing were lost; they may be this part of the surface (a box has twelve in all).
const LARGEST_LOST: f64 = 0.3;
/// A part counts as lying inside another when this much of its area does.
const NESTED: f64 = 0.9;

/// Points and triangles, anticlockwise from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SurfaceMesh {
    /// Corners, m.
    pub points: Vec<Vec3>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
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

    /// Joins points, leaves out triangles without area and doubled ones, and turns each part one way.
    ///
    /// # Errors
    /// When a number is not finite, nothing is left, or the body is larger or smaller than any object.
    pub fn joined(mut self, told: &mut Vec<String>) -> Result<Self, ShapeError> {
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
        let side = longest_side(&self.points);
        check_side(side)?;
        let mut at: HashMap<[i64; 3], u32> = HashMap::new();
        let mut points = Vec::new();
        let moved: Vec<u32> = self
            .points
            .iter()
            .map(|p| {
                let key = p.map(|x| (x / (JOINED * side)).round() as i64);
                *at.entry(key).or_insert_with(|| {
                    points.push(*p);
                    points.len() as u32 - 1
                })
            })
            .collect();
        self.points = points;
        self.triangles.iter_mut().flatten().for_each(|i| *i = moved[*i as usize]);
        let flat = 1e-14 * side * side;
        let points = &self.points;
        self.triangles.retain(|t| length(area_vector(t.map(|i| points[i as usize]))) > flat);
        let mut seen = HashSet::new();
        let before = self.triangles.len();
        self.triangles.retain(|&t| seen.insert(sorted(t)));
        if self.triangles.len() < before {
            told.push(format!("{} doubled triangles were left out", before - self.triangles.len()));
        }
        if self.triangles.is_empty() {
            return Err(ShapeError::new("", "every triangle is without area", "give the surface of a body"));
        }
        self.turn_alike(told);
        Ok(self)
    }

    /// Parts that hang together by edges of two triangles: the number of each triangle's part.
    fn parts(&self) -> Vec<usize> {
        let mut root: Vec<usize> = (0..self.triangles.len()).collect();
        for pair in self.by_edge().values().filter(|t| t.len() == 2) {
            let (a, b) = (find(&mut root, pair[0].0), find(&mut root, pair[1].0));
            root[a] = b;
        }
        (0..root.len()).map(|i| find(&mut root, i)).collect()
    }

    /// The triangles at each edge, and whether they run along it upwards.
    fn by_edge(&self) -> HashMap<[u32; 2], Vec<(usize, bool)>> {
        let mut at: HashMap<[u32; 2], Vec<(usize, bool)>> = HashMap::with_capacity(self.triangles.len() * 2);
        for (t, triangle) in self.triangles.iter().enumerate() {
            for [a, b] in edges(*triangle) {
                at.entry([a.min(b), a.max(b)]).or_default().push((t, a < b));
            }
        }
        at
    }

    /// Turns the triangles of each part the way most of them are.
    fn turn_alike(&mut self, told: &mut Vec<String>) {
        let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); self.triangles.len()];
        for pair in self.by_edge().values().filter(|t| t.len() == 2) {
            let against = pair[0].1 == pair[1].1;
            neighbours[pair[0].0].push((pair[1].0, against));
            neighbours[pair[1].0].push((pair[0].0, against));
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
            told.push(format!("{count} triangles were inside out and were turned"));
        }
    }

    /// Closes holes, turns parts that are inside out, and refuses an open sheet.
    ///
    /// # Errors
    /// When it is an open sheet or encloses nothing.
    pub fn closed(mut self, told: &mut Vec<String>) -> Result<Self, ShapeError> {
        let whole = self.area_m2();
        let (caps, lost, loops) = self.caps();
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
            told.push(format!("{loops} holes were closed, {percent:.1} % of the surface"));
        }
        for [a, b, c] in caps.into_iter().chain(lost) {
            let first = self.points.len() as u32;
            self.points.extend([a, b, c]);
            self.triangles.push([first, first + 1, first + 2]);
        }
        let mut rejoined = self.joined(&mut Vec::new())?;
        rejoined.turn_parts_outwards(told);
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

    /// Triangles that close the holes, each hole a fan around its middle; those that were lost singly; how many holes there are.
    fn caps(&self) -> (Vec<[Vec3; 3]>, Vec<[Vec3; 3]>, usize) {
        // A hole's rim runs against the triangles beside it.
        let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
        let mut rims: Vec<(u32, u32)> = Vec::new();
        for (edge, triangles) in self.by_edge() {
            if let [(_, upwards)] = triangles[..] {
                let [a, b] = if upwards { [edge[1], edge[0]] } else { edge };
                next.entry(a).or_default().push(b);
                rims.push((a, b));
            }
        }
        rims.sort_unstable();
        let (mut caps, mut lost, mut loops) = (Vec::new(), Vec::new(), 0);
        for (start, _) in rims {
            let mut rim = vec![start];
            while let Some(to) = rim.last().and_then(|at| next.get_mut(at)).and_then(Vec::pop) {
                if to == start {
                    break;
                }
                rim.push(to);
            }
            if rim.len() < 3 {
                continue;
            }
            loops += 1;
            let places: Vec<Vec3> = rim.iter().map(|&i| self.points[i as usize]).collect();
            let n = places.len();
            if n == 3 {
                lost.push([places[0], places[1], places[2]]);
                continue;
            }
            let middle: Vec3 = std::array::from_fn(|c| places.iter().map(|p| p[c]).sum::<f64>() / n as f64);
            caps.extend((0..n).map(|i| [places[i], places[(i + 1) % n], middle]));
        }
        (caps, lost, loops)
    }

    /// Outer parts enclose a positive volume; a part inside another that is turned inwards is a cavity and stays.
    fn turn_parts_outwards(&mut self, told: &mut Vec<String>) {
        let part_of = self.parts();
        let mut names = part_of.clone();
        names.sort_unstable();
        names.dedup();
        let volume = |t: usize| {
            let [a, b, c] = self.corners(self.triangles[t]);
            dot(a, cross(b, c)) / 6.0
        };
        let mut inverted: Vec<usize> = Vec::new();
        if names.len() == 1 {
            if (0..self.triangles.len()).map(volume).sum::<f64>() < 0.0 {
                inverted.push(names[0]);
            }
        } else {
            let volumes: HashMap<usize, f64> =
                part_of.iter().enumerate().fold(HashMap::new(), |mut sum, (t, p)| {
                    *sum.entry(*p).or_insert(0.0) += volume(t);
                    sum
                });
            for &name in &names {
                let others: Vec<[Vec3; 3]> = (0..part_of.len())
                    .filter(|&t| part_of[t] != name)
                    .map(|t| {
                        let [a, b, c] = self.corners(self.triangles[t]);
                        if volumes[&part_of[t]] < 0.0 { [a, c, b] } else { [a, b, c] }
                    })
                    .collect();
                if volumes[&name] < 0.0
                    && self.share_inside(&part_of, name, &TriangleTree::new(&others)) < NESTED
                {
                    inverted.push(name);
                }
            }
        }
        for (t, triangle) in self.triangles.iter_mut().enumerate() {
            if inverted.contains(&part_of[t]) {
                triangle.swap(1, 2);
            }
        }
        if !inverted.is_empty() {
            told.push("the surface was inside out and was turned".into());
        }
    }

    /// How much of a part's area lies inside others.
    fn share_inside(&self, part_of: &[usize], name: usize, others: &TriangleTree) -> f64 {
        let mine: Vec<[Vec3; 3]> = (0..part_of.len())
            .filter(|&t| part_of[t] == name)
            .map(|t| self.corners(self.triangles[t]))
            .collect();
        let area = |t: &[Vec3; 3]| length(area_vector(*t));
        let whole: f64 = mine.iter().map(area).sum();
        mine.iter().filter(|t| others.contains(mean(**t))).map(area).sum::<f64>() / whole
    }

    /// Outward unit normal of each triangle.
    #[must_use]
    pub fn normals(&self) -> Vec<Vec3> {
        self.all_corners().into_iter().map(|t| crate::vector::unit(area_vector(t))).collect()
    }

    /// The sheet as a body of `thickness_m`, half of it on either side: both sides and the rims between them.
    #[must_use]
    pub fn thickened(&self, thickness_m: f64) -> Self {
        let offsets = self.offsets();
        let n = self.points.len() as u32;
        let side = |sign: f64| {
            let half = 0.5 * sign * thickness_m;
            self.points.iter().zip(&offsets).map(move |(p, o)| crate::vector::add_scaled(*p, half, *o))
        };
        let points = side(1.0).chain(side(-1.0)).collect();
        let mut triangles = self.triangles.clone();
        triangles.extend(self.triangles.iter().map(|&[a, b, c]| [a + n, c + n, b + n]));
        for (edge, beside) in self.by_edge() {
            if let [(_, upwards)] = beside[..] {
                let [a, b] = if upwards { edge } else { [edge[1], edge[0]] };
                triangles.extend([[b, a, a + n], [b, a + n, b + n]]);
            }
        }
        triangles.sort_unstable();
        Self { points, triangles }
    }

    /// For each point the direction along which both sides of the sheet keep their distance from it.
    fn offsets(&self) -> Vec<Vec3> {
        let mut sum = vec![[0.0; 3]; self.points.len()];
        let mut around: Vec<Vec<Vec3>> = vec![Vec::new(); self.points.len()];
        for (triangle, normal) in self.triangles.iter().zip(self.normals()) {
            for k in 0..3 {
                let corners = self.corners([triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]]);
                let (u, v) = (sub(corners[1], corners[0]), sub(corners[2], corners[0]));
                let angle = length(cross(u, v)).atan2(dot(u, v));
                let i = triangle[k] as usize;
                sum[i] = crate::vector::add_scaled(sum[i], angle, normal);
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
