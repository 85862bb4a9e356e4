//! Volume mesh from a surface: points at a spacing, Delaunay tetrahedra over them, and of these the
//! ones inside.
//!
//! Corners and sharp edges are points and edges of the mesh from the beginning, and one layer of
//! elements fills a wall however thin against the spacing. Isosurface stuffing (Labelle & Shewchuk
//! 2007), which cuts a lattice instead, rounds edges off and needs cells finer than the wall: many
//! times the unknowns for a mug. What is inside is decided by the generalised winding number, which
//! open and self-crossing meshes have as well. Where faces of the mesh stray from the surface or a
//! sharp edge is crossed, points are added (Boissonnat & Oudot 2005).

use crate::delaunay::Delaunay;
use crate::error::ShapeError;
use crate::facets;
use crate::sampling::{Dice, Samples, sample, wall_thicknesses_m};
use crate::surface_mesh::SurfaceMesh;
use crate::triangle_tree::TriangleTree;
use crate::vector::{Vec3, distance, longest_side, mean};
use crate::volume_mesh::{
    EDGES, FACES, MOST_DEGREES_OF_FREEDOM, VolumeMesh, degrees_of_freedom, sorted, tet_volume_m3,
};
use rustc_hash::FxHashMap;
use std::collections::{HashMap, HashSet};

/// Spacing over wall thickness at most: beyond that quadratic elements get stiff in bending.
const LONGEST_PER_WALL: f64 = 1.4;
/// Faces may stray this part of the spacing from the surface.
const STRAY: f64 = 0.12;
/// Number of rounds in which points are added.
const ROUNDS: usize = 8;
/// Tetrahedra flatter than this (6√2 V / edge³) are taken off the surface.
const FLAT: f64 = 0.02;
/// The mesh's volume may differ by this part from the surface's.
const VOLUME: f64 = 0.03;
/// Pieces of at most this part of the volume may fall off.
const LOST: f64 = 0.01;

/// A surface ready to be filled.
#[derive(Debug)]
pub struct Body {
    mesh: SurfaceMesh,
    tree: TriangleTree,
    side: f64,
    /// Thickness that all but the thinnest twentieth of its walls have, m.
    pub wall_m: f64,
    volume_m3: f64,
}

impl Body {
    /// Measures a closed surface.
    ///
    /// # Errors
    /// When it encloses nothing.
    pub fn new(mesh: SurfaceMesh) -> Result<Self, ShapeError> {
        let tree = TriangleTree::new(&mesh.all_corners());
        let side = longest_side(&mesh.points);
        let walls = wall_thicknesses_m(&mesh, &tree, side);
        let Some(&wall_m) = walls.get(walls.len() / 20) else {
            return Err(ShapeError::new("", "encloses nothing", "give the surface of a body"));
        };
        let volume_m3 = mesh.volume_m3();
        Ok(Self { mesh, tree, side, wall_m, volume_m3 })
    }

    /// The spacing at which the mesh has about so many unknowns, m; finer where the walls need it.
    #[must_use]
    pub fn spacing_m(&self, unknowns: f64) -> f64 {
        let fits = |s: f64| self.expected_unknowns(s) <= unknowns;
        let (mut low, mut high) = (1e-6 * self.side, self.side);
        for _ in 0..60 {
            let middle = (low * high).sqrt();
            *(if fits(middle) { &mut high } else { &mut low }) = middle;
        }
        high.min(self.side / 4.0)
    }

    /// Longest spacing the walls allow, m.
    #[must_use]
    pub fn longest_spacing_m(&self) -> f64 {
        LONGEST_PER_WALL * self.wall_m
    }

    /// Unknowns to expect at a spacing: points of the surface, and of the inside, at about 25 each.
    #[must_use]
    pub fn expected_unknowns(&self, spacing_m: f64) -> f64 {
        let surface = 0.8 * self.mesh.area_m2() / spacing_m.powi(2);
        let inside = 0.35 * (self.volume_m3 / spacing_m.powi(3)).max(0.0);
        21.0 * surface + 24.0 * inside
    }

    /// Fills the body at a spacing.
    ///
    /// # Errors
    /// When the walls are too thin for the mesh allowed, or two parts are left.
    pub fn fill(&self, spacing_m: f64, remarks: &mut Vec<String>) -> Result<VolumeMesh, ShapeError> {
        let expected = self.expected_unknowns(spacing_m);
        if expected > 1.3 * MOST_DEGREES_OF_FREEDOM as f64 {
            return Err(self.too_thin(expected));
        }
        let samples = sample(&self.mesh, &self.tree, spacing_m);
        let mut delaunay = Delaunay::around(&self.mesh.points);
        let numbers = put_in(&mut delaunay, &samples);
        let mut segments = samples
            .segments
            .iter()
            .filter_map(|&(a, b, line, from, to)| Some((numbers[a]?, numbers[b]?, line, from, to)))
            .collect::<Vec<_>>();
        let mut known = FxHashMap::default();
        let mut kept = self.inside(&delaunay, &mut known);
        for _ in 0..ROUNDS {
            // Corners and sharp edges alone may be more than the solver takes; rounds only add.
            let unknowns = degrees_of_freedom(&kept);
            if unknowns as f64 > (1.0 + LOST) * MOST_DEGREES_OF_FREEDOM as f64 {
                return Err(self.too_thin(unknowns as f64));
            }
            let added = self.join_segments(&mut delaunay, &samples, &mut segments, spacing_m)
                + self.refine(&mut delaunay, &kept, spacing_m);
            if added == 0 {
                break;
            }
            kept = self.inside(&delaunay, &mut known);
        }
        peel(&mut kept, delaunay.points());
        let mut mesh = VolumeMesh { points: delaunay.points().to_vec(), tets: kept };
        self.keep_one_part(&mut mesh, remarks)?;
        let mut mesh = mesh.checked(remarks).map_err(|error| self.of_walls(error))?;
        facets::round_out(&mut mesh, &self.tree);
        self.check_volume(&mesh)?;
        Ok(mesh)
    }

    /// Leaves out what hangs on by less than a face, where that is little.
    fn keep_one_part(&self, mesh: &mut VolumeMesh, remarks: &mut Vec<String>) -> Result<(), ShapeError> {
        let (lost, others) = mesh.keep_largest();
        if others == 0 {
            return Ok(());
        }
        let percent = 100.0 * lost;
        if lost <= LOST {
            remarks.push(format!(
                "{others} pieces that hung on by less than a wall were left out, {percent:.2} %"
            ));
            return Ok(());
        }
        let pieces = self.mesh.pieces_count();
        let (what, right) = if pieces > 1 {
            let what = format!(
                "has {} separate parts, and the largest has {:.0} % of the volume",
                others + 1,
                100.0 - percent
            );
            (what, "a body has one: name one with --part, or give each a file of its own")
        } else {
            let what = format!(
                "falls apart at its thinnest places: the largest of {} pieces has {:.0} % of the volume",
                others + 1,
                100.0 - percent
            );
            (what, "give it thicker walls there")
        };
        Err(ShapeError::new("", what, right))
    }

    fn too_thin(&self, unknowns: f64) -> ShapeError {
        let what = format!(
            "its walls ({:.3} mm on a body of {:.0} mm) are too thin: it would need {unknowns:.0} unknowns",
            1e3 * self.wall_m,
            1e3 * self.side
        );
        let right = format!("at most {MOST_DEGREES_OF_FREEDOM}: give it thicker walls");
        self.of_pieces(ShapeError::new("", what, right))
    }

    fn check_volume(&self, mesh: &VolumeMesh) -> Result<(), ShapeError> {
        // Where the surface crosses itself its own sum counts the overlap twice; darts do not.
        let (truth, error) = self.volume_inside_m3();
        let ratio = mesh.volume_m3() / truth;
        if (ratio - 1.0).abs() <= VOLUME + 3.0 * error {
            return Ok(());
        }
        let what = format!("the mesh made of it has {:.0} % of its volume", 100.0 * ratio);
        let right = "its walls must be thicker or its surface cleaner";
        Err(self.of_pieces(ShapeError::new("", what, right)))
    }

    /// An error of the tetrahedra made of the surface, with the walls that they had to fill.
    fn of_walls(&self, error: ShapeError) -> ShapeError {
        let (wall, side) = (1e3 * self.wall_m, 1e3 * self.side);
        let what =
            format!("its walls ({wall:.3} mm on a body of {side:.0} mm) cannot be filled: {}", error.what);
        self.of_pieces(ShapeError::new("", what, "its walls must be thicker or its surface cleaner"))
    }

    /// An error that says how many separate pieces the surface has: an assembly, or a shell of
    /// parts that cancel, has thin walls where none of its parts has.
    fn of_pieces(&self, error: ShapeError) -> ShapeError {
        let pieces = self.mesh.pieces_count();
        if pieces < 2 {
            return error;
        }
        let what = format!("{}; it has {pieces} separate pieces", error.what);
        ShapeError { what, right: format!("{}, or name one part with --part", error.right), ..error }
    }

    /// Volume of what the surface winds around, m³, and its relative standard error.
    fn volume_inside_m3(&self) -> (f64, f64) {
        let Some((low, high)) = crate::vector::bounds(&self.mesh.points) else { return (0.0, 0.0) };
        let mut dice = Dice::new(17);
        let mut dart = || -> Vec3 { std::array::from_fn(|c| low[c] + (high[c] - low[c]) * dice.roll()) };
        let crossings = (0..200).any(|_| {
            let winding = self.tree.winding(dart());
            (winding.round() - winding).abs() > 0.1 || winding > 1.5
        });
        if !crossings {
            return (self.volume_m3, 0.0);
        }
        let darts = 60_000;
        let hits = (0..darts).filter(|_| self.tree.contains(dart())).count() as f64;
        let whole: f64 = (0..3).map(|c| high[c] - low[c]).product();
        (whole * hits / f64::from(darts), 1.0 / hits.max(1.0).sqrt())
    }

    /// The tetrahedra inside; of those of an earlier round that is `known`.
    fn inside(&self, delaunay: &Delaunay, known: &mut FxHashMap<[u32; 4], bool>) -> Vec<[u32; 4]> {
        let points = delaunay.points();
        let corners = |t: &[u32; 4]| t.map(|i| points[i as usize]);
        let mut is_inside = |t: &[u32; 4]| {
            let mut name = *t;
            name.sort_unstable();
            let look = || tet_volume_m3(corners(t)) > 0.0 && self.tree.contains(mean(corners(t)));
            *known.entry(name).or_insert_with(look)
        };
        delaunay.tets().into_iter().filter(&mut is_inside).collect()
    }

    /// Puts a point on each sharp edge between two neighbours that the mesh does not join.
    fn join_segments(
        &self,
        delaunay: &mut Delaunay,
        samples: &Samples,
        segments: &mut Vec<(u32, u32, usize, f64, f64)>,
        spacing_m: f64,
    ) -> usize {
        let mut joined: HashSet<[u32; 2]> = HashSet::new();
        for tet in delaunay.tets() {
            joined.extend(EDGES.map(|[a, b]| [tet[a].min(tet[b]), tet[a].max(tet[b])]));
        }
        let mut added = 0;
        for segment in segments.clone() {
            let (a, b, line, from, to) = segment;
            if joined.contains(&[a.min(b), a.max(b)]) || to - from < 0.15 * spacing_m {
                continue;
            }
            let middle = 0.5 * (from + to);
            if let Some(new) = delaunay.insert(samples.lines[line].at(middle).0) {
                segments.retain(|s| *s != segment);
                segments.extend([(a, new, line, from, middle), (new, b, line, middle, to)]);
                added += 1;
            }
        }
        added
    }

    /// Puts a point of the surface where a face of the mesh strays from it.
    fn refine(&self, delaunay: &mut Delaunay, kept: &[[u32; 4]], spacing_m: f64) -> usize {
        let stray = (STRAY * spacing_m).min(0.25 * self.wall_m);
        let faces = boundary(kept);
        let mut added = 0;
        for (face, _) in faces {
            let corners = face.map(|i| delaunay.points()[i as usize]);
            let Some(near) = self.tree.nearest(mean(corners)) else { continue };
            let room = corners.iter().map(|c| distance(*c, near.point)).fold(f64::MAX, f64::min);
            if near.distance > stray
                && room > 0.3 * spacing_m.min(self.wall_m)
                && delaunay.insert(near.point).is_some()
            {
                added += 1;
            }
        }
        added
    }
}

/// Puts all points in, those that lie together after each other.
fn put_in(delaunay: &mut Delaunay, samples: &Samples) -> Vec<Option<u32>> {
    let all: Vec<Vec3> = samples.surface.iter().chain(&samples.inside).copied().collect();
    let (low, high) = crate::vector::bounds(&all).unwrap_or_default();
    let side = (0..3).map(|c| high[c] - low[c]).fold(f64::MIN_POSITIVE, f64::max);
    let mut order: Vec<usize> = (0..all.len()).collect();
    let key = |&i: &usize| morton(std::array::from_fn(|c| ((all[i][c] - low[c]) / side * 1023.0) as u64));
    order.sort_by_key(key);
    let mut numbers = vec![None; all.len()];
    for i in order {
        numbers[i] = delaunay.insert(all[i]);
    }
    numbers
}

/// Bits of three numbers below 1024, dealt in turn.
fn morton(cell: [u64; 3]) -> u64 {
    (0..10).map(|bit| (0..3).map(|c| ((cell[c] >> bit) & 1) << (3 * bit + c as u64)).sum::<u64>()).sum()
}

/// Faces with one tetrahedron, and which one.
fn boundary(tets: &[[u32; 4]]) -> Vec<([u32; 3], usize)> {
    let mut seen: HashMap<[u32; 3], Option<usize>> = HashMap::with_capacity(tets.len() * 3);
    for (t, tet) in tets.iter().enumerate() {
        for face in FACES {
            seen.entry(sorted(face.map(|i| tet[i]))).and_modify(|one| *one = None).or_insert(Some(t));
        }
    }
    let mut faces: Vec<_> = seen.into_iter().filter_map(|(face, t)| t.map(|t| (face, t))).collect();
    faces.sort_unstable();
    faces
}

/// 1 for a regular tetrahedron, 0 for a flat one.
fn roundness(corners: [Vec3; 4]) -> f64 {
    let square: f64 = EDGES.iter().map(|&[a, b]| distance(corners[a], corners[b]).powi(2)).sum::<f64>() / 6.0;
    6.0 * std::f64::consts::SQRT_2 * tet_volume_m3(corners) / square.powf(1.5)
}

/// Takes flat tetrahedra off the surface, as long as that uncovers no further point: two faces
/// outside become the two others.
fn peel(tets: &mut Vec<[u32; 4]>, points: &[Vec3]) {
    for _ in 0..6 {
        let mut outside: HashMap<usize, usize> = HashMap::new();
        for (_, t) in boundary(tets) {
            *outside.entry(t).or_insert(0) += 1;
        }
        let flat = |t: usize| roundness(tets[t].map(|i| points[i as usize])) < FLAT;
        let off: HashSet<usize> =
            outside.into_iter().filter(|&(t, n)| n >= 2 && flat(t)).map(|(t, _)| t).collect();
        if off.is_empty() {
            return;
        }
        let mut t = 0;
        tets.retain(|_| {
            t += 1;
            !off.contains(&(t - 1))
        });
    }
}
