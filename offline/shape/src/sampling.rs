//! Points of a surface at a given spacing: corners, then sharp edges, then faces, then the inside.
//!
//! On faces a point is taken when no other is nearer than the spacing (Poisson-disk sampling by
//! dart throwing); the two sides of a thin wall do not count as near, because their normals differ.

use crate::feature_lines::{FeatureLine, feature_lines};
use crate::surface_mesh::SurfaceMesh;
use crate::triangle_tree::{TriangleTree, area_vector};
use crate::vector::{Vec3, add_scaled, bounds, distance, dot, length, sub, unit};
use rustc_hash::FxHashMap;

/// Points on faces keep this part of the spacing from points on sharp edges.
const FROM_EDGE: f64 = 0.75;
/// Points on sharp edges that are nearer than this part of the spacing to another are left out:
/// edges finer than the mesh.
const FINEST: f64 = 0.2;
/// Points inside keep this part of the spacing from the surface.
const INSET: f64 = 0.6;
/// Spacing inside grows by this much for each metre away from the surface.
const GROWTH: f64 = 0.35;
/// Darts thrown for each point that fits.
const DARTS: f64 = 14.0;

/// Numbers that look random and are the same in every run (xorshift).
#[derive(Debug, Clone)]
pub struct Dice(u64);

impl Dice {
    /// From a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed | 1)
    }

    /// Seed of its own for each cell of a grid (SplitMix64's finaliser).
    fn of_cell(cell: [u64; 3]) -> Self {
        let mixed = cell.into_iter().fold(0x9e37_79b9_7f4a_7c15_u64, |seed, x| {
            let mut z = (seed ^ x).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        });
        Self::new(mixed)
    }

    /// 0 to 1.
    pub fn roll(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A point and the normals of the surface there.
type Held = (Vec3, [Vec3; 2]);

/// Points by the cell they lie in.
struct Cells {
    width: f64,
    cells: FxHashMap<[i64; 3], Vec<Held>>,
}

impl Cells {
    fn key(&self, p: Vec3) -> [i64; 3] {
        p.map(|x| (x / self.width).floor() as i64)
    }

    fn add(&mut self, p: Vec3, normals: [Vec3; 2]) {
        let key = self.key(p);
        self.cells.entry(key).or_default().push((p, normals));
    }

    /// Tests whether a point with a similar normal (any, where none is given) lies nearer than
    /// `reach`.
    fn crowded(&self, p: Vec3, normal: Option<Vec3>, reach: f64) -> bool {
        let [x, y, z] = self.key(p);
        let n = (reach / self.width).ceil() as i64;
        let mut keys = (x - n..=x + n)
            .flat_map(|i| (y - n..=y + n).flat_map(move |j| (z - n..=z + n).map(move |k| [i, j, k])));
        keys.any(|key| {
            self.cells.get(&key).is_some_and(|points| {
                points.iter().any(|(q, normals)| {
                    distance(p, *q) < reach && normal.is_none_or(|n| normals.iter().any(|m| dot(n, *m) > 0.5))
                })
            })
        })
    }
}

/// Points of a body at a spacing.
pub struct Samples {
    /// On the surface.
    pub surface: Vec<Vec3>,
    /// Neighbours along sharp edges, which the mesh must join: numbers of points, the line, and
    /// where on it both are.
    pub segments: Vec<(usize, usize, usize, f64, f64)>,
    /// The sharp lines.
    pub lines: Vec<FeatureLine>,
    /// Inside.
    pub inside: Vec<Vec3>,
}

/// Thickness of the walls at evenly spread places, thinnest first, m.
#[must_use]
pub fn wall_thicknesses_m(mesh: &SurfaceMesh, tree: &TriangleTree, side: f64) -> Vec<f64> {
    let mut dice = Dice::new(11);
    let spread = Spread::over(mesh);
    let mut walls: Vec<f64> = (0..1500)
        .filter_map(|_| {
            let (p, normal) = spread.dart(mesh, &mut dice);
            let inwards = normal.map(|x| -x);
            let from = add_scaled(p, 1e-6 * side, inwards);
            tree.contains(from).then(|| tree.free_path(from, inwards, 1e-7 * side)).flatten()
        })
        .collect();
    walls.sort_by(f64::total_cmp);
    walls
}

/// Triangles by area.
struct Spread {
    sums: Vec<f64>,
    normals: Vec<Vec3>,
}

impl Spread {
    fn over(mesh: &SurfaceMesh) -> Self {
        let mut sum = 0.0;
        let sums = mesh
            .all_corners()
            .into_iter()
            .map(|t| {
                sum += length(area_vector(t));
                sum
            })
            .collect();
        Self { sums, normals: mesh.normals() }
    }

    fn area_m2(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// A point anywhere on the surface, and the normal there.
    fn dart(&self, mesh: &SurfaceMesh, dice: &mut Dice) -> (Vec3, Vec3) {
        let at = dice.roll() * self.area_m2();
        let t = self.sums.partition_point(|&s| s < at).min(self.sums.len() - 1);
        let [a, b, c] = mesh.corners(mesh.triangles[t]);
        let (mut u, mut v) = (dice.roll(), dice.roll());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        (add_scaled(add_scaled(a, u, sub(b, a)), v, sub(c, a)), self.normals[t])
    }
}

/// Points at `spacing_m`.
#[must_use]
pub fn sample(mesh: &SurfaceMesh, tree: &TriangleTree, spacing_m: f64) -> Samples {
    let mut cells = Cells { width: spacing_m, cells: FxHashMap::default() };
    let mut samples =
        Samples { surface: Vec::new(), segments: Vec::new(), lines: feature_lines(mesh), inside: Vec::new() };
    put_on_lines(&mut samples, &mut cells, tree, spacing_m);
    put_on_faces(&mut samples, &mut cells, mesh, tree, spacing_m);
    put_inside(&mut samples, mesh, tree, spacing_m);
    samples
}

/// Tests whether a place of the surface divides inside from outside; where bodies overlap, it does
/// not.
fn divides(tree: &TriangleTree, p: Vec3, normal: Vec3, spacing_m: f64) -> bool {
    let step = 1e-4 * spacing_m;
    tree.contains(add_scaled(p, -step, normal)) && !tree.contains(add_scaled(p, step, normal))
}

fn put_on_lines(samples: &mut Samples, cells: &mut Cells, tree: &TriangleTree, spacing_m: f64) {
    let mut numbers: FxHashMap<[u64; 3], usize> = FxHashMap::default();
    // Corners come first, so that no point of a line takes their place.
    let ends = |line: &FeatureLine| [line.at(0.0), line.at(line.length_m())];
    let lines = samples.lines.clone();
    let mut put = |samples: &mut Samples, cells: &mut Cells, p: Vec3, normals: [Vec3; 2]| -> Option<usize> {
        if let Some(&number) = numbers.get(&p.map(f64::to_bits)) {
            return Some(number);
        }
        let outwards = unit(add_scaled(normals[0], 1.0, normals[1]));
        let step = 1e-3 * spacing_m;
        let hidden =
            tree.contains(add_scaled(p, step, outwards)) == tree.contains(add_scaled(p, -step, outwards));
        if hidden || cells.crowded(p, None, FINEST * spacing_m) {
            return None;
        }
        cells.add(p, normals);
        samples.surface.push(p);
        numbers.insert(p.map(f64::to_bits), samples.surface.len() - 1);
        Some(samples.surface.len() - 1)
    };
    for line in &lines {
        for (p, normals) in ends(line) {
            put(samples, cells, p, normals);
        }
    }
    for (l, line) in lines.iter().enumerate() {
        let whole = line.length_m();
        let ring = line.points.first() == line.points.last();
        let pieces = ((whole / spacing_m).round() as usize).max(if ring { 3 } else { 1 });
        let mut before: Option<(usize, f64)> = None;
        for i in 0..=pieces {
            let along = if i == pieces { whole } else { whole * i as f64 / pieces as f64 };
            let (p, normals) = line.at(along);
            let here = put(samples, cells, p, normals);
            if let (Some((a, from)), Some(b)) = (before, here)
                && a != b
            {
                samples.segments.push((a, b, l, from, along));
            }
            before = here.map(|n| (n, along)).or(before);
        }
    }
}

fn put_on_faces(
    samples: &mut Samples,
    cells: &mut Cells,
    mesh: &SurfaceMesh,
    tree: &TriangleTree,
    spacing_m: f64,
) {
    let spread = Spread::over(mesh);
    let mut on_lines = Cells { width: spacing_m, cells: std::mem::take(&mut cells.cells) };
    let mut dice = Dice::new(5);
    let darts = (DARTS * 0.7 * spread.area_m2() / (spacing_m * spacing_m)).ceil() as usize + 64;
    for _ in 0..darts {
        let (p, normal) = spread.dart(mesh, &mut dice);
        let crowded = on_lines.crowded(p, Some(normal), FROM_EDGE * spacing_m)
            || cells.crowded(p, Some(normal), spacing_m);
        if !crowded && divides(tree, p, normal, spacing_m) {
            cells.add(p, [normal; 2]);
            samples.surface.push(p);
        }
    }
    cells.cells.extend(on_lines.cells.drain());
}

/// Cells of half the spacing, of which each is tried once. Boxes of cells that the surface does not
/// reach and that lie outside are passed over whole, so that the work grows with the body, not with
/// the box around it.
fn put_inside(samples: &mut Samples, mesh: &SurfaceMesh, tree: &TriangleTree, spacing_m: f64) {
    let Some((low, high)) = bounds(&mesh.points) else { return };
    let mut taken = Cells { width: spacing_m, cells: FxHashMap::default() };
    let step = 0.5 * spacing_m;
    let most = (0..3).map(|c| (high[c] - low[c]) / step).fold(1.0, f64::max).ceil();
    let mut boxes: Vec<([u64; 3], u64)> = vec![([0; 3], (most as u64).next_power_of_two())];
    while let Some((first, wide)) = boxes.pop() {
        let at =
            |offset: f64| -> Vec3 { std::array::from_fn(|c| low[c] + step * (first[c] as f64 + offset)) };
        if (0..3).any(|c| low[c] + step * first[c] as f64 > high[c]) {
            continue;
        }
        if wide > 1 {
            let middle = at(0.5 * wide as f64);
            let reach = 0.87 * wide as f64 * step;
            let Some(near) = tree.nearest(middle) else { continue };
            if near.distance < reach || tree.contains(middle) {
                let half = wide / 2;
                boxes.extend((0..8).map(|i: u64| {
                    (
                        [
                            first[0] + half * (i & 1),
                            first[1] + half * (i >> 1 & 1),
                            first[2] + half * (i >> 2),
                        ],
                        half,
                    )
                }));
            }
            continue;
        }
        let mut dice = Dice::of_cell(first);
        let p: Vec3 = std::array::from_fn(|c| low[c] + step * (first[c] as f64 + 0.2 + 0.6 * dice.roll()));
        let Some(near) = tree.nearest(p) else { continue };
        if near.distance < INSET * spacing_m {
            continue;
        }
        let room = 0.95 * spacing_m + GROWTH * (near.distance - INSET * spacing_m);
        if !taken.crowded(p, None, room) && tree.contains(p) {
            taken.add(p, [[0.0; 3]; 2]);
            samples.inside.push(p);
        }
    }
}
