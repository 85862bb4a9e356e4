//! Mesh of a body as a file gives it: its volume, or its surface alone.

use crate::repair::Cracks;
use crate::surface_mesh::SurfaceMesh;
use crate::triangle_tree::{TriangleTree, area_vector};
use crate::vector::{Vec3, bounds, cross, dot, length};
use crate::volume_mesh::{VolumeMesh, find};
use rustc_hash::FxHashMap;

/// Pieces apart from a body whose surface is at most this part of the body's are no part of it.
const SPECK: f64 = 0.01;

/// A body's shape as it came.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// Cut into tetrahedra.
    Volume(VolumeMesh),
    /// Cut into tetrahedra with curved faces: their corners, and the surface they stand for, finely
    /// cut.
    Curved(VolumeMesh, SurfaceMesh),
    /// Its surface only.
    Surface(SurfaceMesh),
}

impl Mesh {
    /// Its points, m.
    #[must_use]
    pub fn points(&self) -> &[Vec3] {
        match self {
            Self::Volume(volume) | Self::Curved(volume, _) => &volume.points,
            Self::Surface(surface) => &surface.points,
        }
    }

    /// Drops points that no element uses: they would count as its size.
    #[must_use]
    pub fn used(mut self) -> Self {
        match &mut self {
            Self::Volume(volume) | Self::Curved(volume, _) => keep_used(&mut volume.points, &mut volume.tets),
            Self::Surface(surface) => keep_used(&mut surface.points, &mut surface.triangles),
        }
        self
    }

    /// Its largest part: of a surface with what lies inside it.
    #[must_use]
    pub fn largest_part(self) -> Self {
        match self {
            Self::Surface(surface) => Self::Surface(surface.largest_part()),
            Self::Volume(mut volume) => {
                volume.keep_largest();
                Self::Volume(volume)
            }
            // What is left of the surface is looked for from the corners that are left.
            Self::Curved(mut volume, surface) => {
                volume.keep_largest();
                Self::Curved(volume, surface)
            }
        }
        .used()
    }

    /// Moves the middle of its box to the origin, where sums of products are exact; gives where it
    /// was.
    pub(crate) fn centre(&mut self) -> Vec3 {
        let (low, high) = bounds(self.points()).unwrap_or_default();
        let middle: Vec3 = std::array::from_fn(|c| 0.5 * (low[c] + high[c]));
        self.change(|p| std::array::from_fn(|c| p[c] - middle[c]));
        middle
    }

    /// Moves every point.
    pub fn change(&mut self, to: impl Fn(Vec3) -> Vec3) {
        match self {
            Self::Volume(volume) => volume.points.iter_mut().for_each(|p| *p = to(*p)),
            Self::Surface(surface) => surface.points.iter_mut().for_each(|p| *p = to(*p)),
            Self::Curved(volume, surface) => {
                volume.points.iter_mut().chain(&mut surface.points).for_each(|p| *p = to(*p));
            }
        }
    }
}

fn keep_used<const N: usize>(points: &mut Vec<Vec3>, cells: &mut [[u32; N]]) {
    let mut used = vec![false; points.len()];
    cells.iter().flatten().for_each(|&i| used[i as usize] = true);
    let mut left = 0;
    let number: Vec<u32> = used
        .iter()
        .map(|&used| {
            left += u32::from(used);
            left.wrapping_sub(1)
        })
        .collect();
    let mut at = used.iter();
    points.retain(|_| at.next() == Some(&true));
    cells.iter_mut().flatten().for_each(|i| *i = number[*i as usize]);
}

/// A piece of a surface whose triangles hang together by points.
struct Piece {
    triangles: Vec<usize>,
    area_m2: f64,
    volume_m3: f64,
    low: Vec3,
    high: Vec3,
}

impl SurfaceMesh {
    /// Its pieces, that with the largest surface first.
    fn pieces(&self) -> Vec<Piece> {
        let mut root: Vec<usize> = (0..self.points.len()).collect();
        for t in &self.triangles {
            for i in [t[1], t[2]] {
                let (a, b) = (find(&mut root, t[0] as usize), find(&mut root, i as usize));
                root[a.max(b)] = a.min(b);
            }
        }
        let mut numbers: FxHashMap<usize, usize> = FxHashMap::default();
        let mut pieces: Vec<Piece> = Vec::new();
        for (t, triangle) in self.triangles.iter().enumerate() {
            let corners = self.corners(*triangle);
            let number = *numbers.entry(find(&mut root, triangle[0] as usize)).or_insert(pieces.len());
            if number == pieces.len() {
                let (low, high) = ([f64::MAX; 3], [f64::MIN; 3]);
                pieces.push(Piece { triangles: Vec::new(), area_m2: 0.0, volume_m3: 0.0, low, high });
            }
            let piece = &mut pieces[number];
            piece.triangles.push(t);
            piece.area_m2 += length(area_vector(corners));
            piece.volume_m3 += dot(corners[0], cross(corners[1], corners[2])) / 6.0;
            for (p, c) in corners.iter().flat_map(|p| (0..3).map(move |c| (p, c))) {
                piece.low[c] = piece.low[c].min(p[c]);
                piece.high[c] = piece.high[c].max(p[c]);
            }
        }
        pieces.sort_by(|a, b| b.area_m2.total_cmp(&a.area_m2));
        pieces
    }

    /// Number of pieces that hang together by points.
    pub(crate) fn pieces_count(&self) -> usize {
        self.pieces().len()
    }

    fn keep_triangles(&mut self, mut triangles: Vec<usize>) {
        triangles.sort_unstable();
        self.triangles = triangles.into_iter().map(|t| self.triangles[t]).collect();
        keep_used(&mut self.points, &mut self.triangles);
    }

    /// Leaves small pieces out whose box is apart from that of the largest: they would count as its
    /// size.
    pub(crate) fn leave_specks_out(&mut self, remarks: &mut Vec<String>) {
        let pieces = self.pieces();
        let Some((body, others)) = pieces.split_first() else { return };
        let is_speck = |piece: &&Piece| {
            let apart = (0..3).any(|c| piece.low[c] > body.high[c] || piece.high[c] < body.low[c]);
            apart && piece.area_m2 <= SPECK * body.area_m2
        };
        let specks = others.iter().filter(is_speck).count();
        if specks == 0 {
            return;
        }
        let area: f64 = others.iter().filter(is_speck).map(|piece| piece.area_m2).sum();
        remarks.push(format!(
            "{specks} pieces apart from the body were left out, {:.2} % of the surface",
            100.0 * area / (area + body.area_m2)
        ));
        let kept: Vec<usize> = std::iter::once(body)
            .chain(others.iter().filter(|piece| !is_speck(piece)))
            .flat_map(|piece| piece.triangles.iter().copied())
            .collect();
        self.keep_triangles(kept);
    }

    /// The piece of the greatest volume, and what lies inside it.
    fn largest_part(self) -> Self {
        let mut surface = self.repaired(Cracks::Wide, &mut Vec::new());
        let pieces = surface.pieces();
        let largest = (0..pieces.len())
            .max_by(|&a, &b| pieces[a].volume_m3.abs().total_cmp(&pieces[b].volume_m3.abs()));
        let Some(largest) = largest else { return surface };
        let corners = |piece: &Piece| -> Vec<[Vec3; 3]> {
            piece.triangles.iter().map(|&t| surface.corners(surface.triangles[t])).collect()
        };
        let tree = TriangleTree::new(&corners(&pieces[largest]));
        let inside = |piece: &Piece| tree.winding(surface.corners(surface.triangles[piece.triangles[0]])[0]);
        let kept = (0..pieces.len())
            .filter(|&i| i == largest || inside(&pieces[i]).abs() > 0.5)
            .flat_map(|i| pieces[i].triangles.iter().copied())
            .collect();
        surface.keep_triangles(kept);
        surface
    }
}
