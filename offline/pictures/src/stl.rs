//! Heights as a closed block: for a 3-D printer (binary STL, in millimetres), or as a mesh in
//! metres.
//!
//! ```text
//! x = u        y = depth − v        z = base + h(u, v) − lowest h
//! ```
//! The top has a vertex at every texel's centre and one at the edge beside every outermost texel,
//! so that the block is exactly as wide as the map; walls go down to z = 0 and a fan closes the
//! bottom. Cells of four texels are cut along one diagonal, so that the volume is area × (base +
//! mean height over the lowest) but for a twelfth of a texel at each corner of the map. Seen from
//! above it looks like the map. STL has no unit; printers read millimetres. Source: the embodiment
//! of the metamers is an object of known thickness from a 3-D printer that resolves less than
//! [`FINEST_TEXEL_M`].
//!
//! ```
//! use asperity_pictures::stl::Block;
//! use asperity_surface::raster::Raster;
//!
//! let heights_m = Raster::from_fn(16, 16, |x, _| 1e-3 * (x % 4) as f64);
//! let block = Block::new(&heights_m, 0.2e-3, 3e-3)?;
//! let mut file = Vec::new();
//! block.write_stl(&mut file)?;
//! assert_eq!(file.len() as u64, block.file_bytes());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;
use std::collections::HashMap;
use std::convert::Infallible;
use std::io::{self, Write};

/// Texels above this size, m, are felt as facets: the document prefers printers that are finer than
/// 0.25 mm.
pub const FINEST_TEXEL_M: f64 = 0.25e-3;
/// Most triangles in a file: 5 GB.
const MOST_TRIANGLES: u64 = 100_000_000;
const HEADER: &[u8] = b"asperity height field, millimetres";
const MM_PER_M: f64 = 1e3;

type Vertex = [f32; 3];

/// A height field on a base.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    heights_m: &'a Raster,
    texel_m: f64,
    base_m: f64,
    lowest_m: f64,
}

impl<'a> Block<'a> {
    /// A block of texels `texel_m` wide (1 µm to 1 m) whose lowest point is `base_m` thick (1 µm to
    /// 1 m).
    ///
    /// # Errors
    /// When a size is outside its range, a height is not finite, or there are no texels or too many
    /// for a file.
    pub fn new(heights_m: &'a Raster, texel_m: f64, base_m: f64) -> Result<Self, DesignError> {
        let is_size = |size: f64| (1e-6..=1.0).contains(&size);
        DesignError::check("texel_m", texel_m, "1e-6 to 1 (1 µm to 1 m)", is_size)?;
        DesignError::check("base_m", base_m, "1e-6 to 1 (1 µm to 1 m)", is_size)?;
        let (lowest_m, highest_m) = heights_m.range();
        let relief_m = highest_m - lowest_m;
        let is_relief = |relief: f64| (0.0..=1.0).contains(&relief);
        DesignError::check("relief", relief_m, "0 to 1 m of finite heights", is_relief)?;
        let is_finite = heights_m.values.iter().all(|height| height.is_finite());
        DesignError::check("heights", f64::from(u8::from(is_finite)), "finite", |all| all > 0.0)?;
        let block = Self { heights_m, texel_m, base_m, lowest_m };
        let fits = |count: f64| count <= MOST_TRIANGLES as f64;
        DesignError::check("triangles", block.triangles() as f64, "100 million or fewer", fits)?;
        Ok(block)
    }

    /// Width along u, along v, and greatest height, m.
    #[must_use]
    pub fn size_m(&self) -> [f64; 3] {
        let [width, depth] = [self.heights_m.width, self.heights_m.height].map(|n| n as f64 * self.texel_m);
        [width, depth, self.base_m + self.heights_m.range().1 - self.lowest_m]
    }

    /// Triangles of the closed surface.
    #[must_use]
    pub fn triangles(&self) -> u64 {
        let [columns, rows] = [self.heights_m.width, self.heights_m.height].map(|n| n as u64 + 1);
        // Two a cell of the top; two of the wall and one of the bottom an edge of the rim.
        2 * columns * rows + 3 * 2 * (columns + rows)
    }

    /// Bytes that [`Self::write_stl`] writes.
    #[must_use]
    pub fn file_bytes(&self) -> u64 {
        84 + 50 * self.triangles()
    }

    /// Writes the block as binary STL.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_stl(&self, mut out: impl Write) -> io::Result<()> {
        let mut header = [0; 80];
        header[..HEADER.len()].copy_from_slice(HEADER);
        out.write_all(&header)?;
        out.write_all(&u32::try_from(self.triangles()).unwrap_or(u32::MAX).to_le_bytes())?;
        self.each_triangle(MM_PER_M, |corners| write_triangle(&mut out, corners))
    }

    /// Vertices, m, each once, and the corners of the triangles.
    #[must_use]
    pub fn mesh(&self) -> (Vec<[f32; 3]>, Vec<u32>) {
        let (mut vertices, mut corners) = (Vec::new(), Vec::with_capacity(3 * self.triangles() as usize));
        let mut known = HashMap::new();
        let mut index = |vertex: Vertex| {
            *known.entry(vertex.map(f32::to_bits)).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() as u32 - 1
            })
        };
        let Ok(()) = self.each_triangle(1.0, |triangle| {
            corners.extend(triangle.map(&mut index));
            Ok::<(), Infallible>(())
        });
        (vertices, corners)
    }

    /// Hands out every triangle, counter-clockwise seen from outside, in these units.
    fn each_triangle<E>(
        &self,
        units_per_m: f64,
        mut emit: impl FnMut([Vertex; 3]) -> Result<(), E>,
    ) -> Result<(), E> {
        let unit = |[x, y, z]: [f64; 3]| [x, y, z].map(|m| (m * units_per_m) as f32);
        for (row, column) in
            (0..=self.heights_m.height).flat_map(|row| (0..=self.heights_m.width).map(move |at| (row, at)))
        {
            let [a, b, c, d] =
                [(0, 1), (1, 1), (1, 0), (0, 0)].map(|(x, y)| unit(self.top(column + x, row + y)));
            emit([a, b, c])?;
            emit([a, c, d])?;
        }
        let [width, depth, _] = self.size_m();
        let middle = unit([0.5 * width, 0.5 * depth, 0.0]);
        let rim = self.rim().into_iter().map(unit).collect::<Vec<_>>();
        for (from, to) in rim.iter().zip(rim.iter().cycle().skip(1)) {
            let below = |vertex: &Vertex| [vertex[0], vertex[1], 0.0];
            emit([below(from), below(to), *to])?;
            emit([below(from), *to, *from])?;
            emit([below(to), below(from), middle])?;
        }
        Ok(())
    }

    /// The edge of the top, counter-clockwise seen from above.
    fn rim(&self) -> Vec<[f64; 3]> {
        let (right, near) = (self.heights_m.width + 1, self.heights_m.height + 1);
        let mut rim = Vec::with_capacity(2 * (right + near));
        rim.extend((0..right).map(|column| self.top(column, near)));
        rim.extend((1..=near).rev().map(|row| self.top(right, row)));
        rim.extend((1..=right).rev().map(|column| self.top(column, 0)));
        rim.extend((0..near).map(|row| self.top(0, row)));
        rim
    }

    /// A vertex of the top, m: columns and rows 0 and n + 1 are the edges, those between the
    /// centres of texels.
    fn top(&self, column: usize, row: usize) -> [f64; 3] {
        let (w, h) = (self.heights_m.width, self.heights_m.height);
        let along = |at: usize, n: usize| (at as f64 - 0.5).clamp(0.0, n as f64) * self.texel_m;
        let inside = |at: usize, n: usize| at.clamp(1, n) - 1;
        let height_m = self.heights_m.at(inside(column, w), inside(row, h)) - self.lowest_m;
        let depth_m = h as f64 * self.texel_m;
        [along(column, w), depth_m - along(row, h), self.base_m + height_m]
    }
}

/// A triangle with its outward normal.
fn write_triangle(out: &mut impl Write, corners: [Vertex; 3]) -> io::Result<()> {
    let edge = |to: usize| -> [f32; 3] { std::array::from_fn(|axis| corners[to][axis] - corners[0][axis]) };
    let ([ax, ay, az], [bx, by, bz]) = (edge(1), edge(2));
    let across = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    let length = across.iter().map(|c| c * c).sum::<f32>().sqrt();
    let normal = across.map(|c| if length > 0.0 { c / length } else { 0.0 });
    let mut record = [0; 50];
    let numbers = normal.iter().chain(corners.as_flattened());
    for (bytes, number) in record.chunks_exact_mut(4).zip(numbers) {
        bytes.copy_from_slice(&number.to_le_bytes());
    }
    out.write_all(&record)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(heights: &Raster, texel_m: f64, base_m: f64) -> &'static str {
        Block::new(heights, texel_m, base_m).unwrap_err().field
    }

    #[test]
    fn sizes_that_no_printer_makes_are_refused_by_name() {
        let flat = Raster::constant(4, 3, 0.0);
        assert_eq!(refused(&flat, 0.0, 1e-3), "texel_m");
        assert_eq!(refused(&flat, 1e-4, f64::NAN), "base_m");
        assert_eq!(refused(&Raster::default(), 1e-4, 1e-3), "relief");
        assert_eq!(refused(&Raster::from_fn(2, 2, |x, _| 5.0 * x as f64), 1e-4, 1e-3), "relief");
        let hole = Raster::from_fn(2, 2, |x, _| if x == 0 { f64::NAN } else { 0.0 });
        assert_eq!(refused(&hole, 1e-4, 1e-3), "heights");
        assert_eq!(refused(&Raster::constant(8192, 8192, 0.0), 1e-4, 1e-3), "triangles");
    }

    #[test]
    fn a_block_of_any_texels_is_closed_and_has_its_heights_volume() {
        let mut rng = asperity_dsp::rng::Rng::new(5);
        for (w, h) in [(1, 1), (1, 4), (2, 2), (2, 5), (3, 3), (7, 4)] {
            let heights = Raster::from_fn(w, h, |_, _| 1e-3 * rng.uniform());
            let block = Block::new(&heights, 2e-3, 1e-3).unwrap();
            let (vertices, corners) = block.mesh();
            assert_eq!(corners.len() as u64, 3 * block.triangles());
            let (mut edges, mut volume_m3) = (HashMap::new(), 0.0);
            for corners in corners.as_chunks::<3>().0 {
                let [a, b, c] = corners.map(|corner| vertices[corner as usize].map(f64::from));
                volume_m3 += (a[0] * (b[1] * c[2] - b[2] * c[1])
                    + a[1] * (b[2] * c[0] - b[0] * c[2])
                    + a[2] * (b[0] * c[1] - b[1] * c[0]))
                    / 6.0;
                for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
                    *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|sum| *sum == 0), "{w} × {h}");
            let mean_m = 1e-3 + heights.mean() - heights.range().0;
            let [far, near] = [0, h - 1].map(|y| heights.at(w - 1, y) - heights.at(0, y));
            let corners_m = if w.min(h) > 1 { (far - near) / 12.0 } else { 0.0 };
            let expected = block.size_m()[0] * block.size_m()[1] * mean_m + 4e-6 * corners_m;
            assert!((volume_m3 / expected - 1.0).abs() < 1e-5, "{w} × {h}: {volume_m3} {expected}");
        }
    }

    #[test]
    fn a_flat_map_is_a_box_whose_upright_normals_point_outwards() {
        let flat = Raster::constant(4, 3, 7.0);
        let block = Block::new(&flat, 1e-3, 2e-3).unwrap();
        let mut file = Vec::new();
        block.write_stl(&mut file).unwrap();
        assert_eq!(file.len() as u64, block.file_bytes());
        let float = |at: usize| f32::from_le_bytes([file[at], file[at + 1], file[at + 2], file[at + 3]]);
        for triangle in 0..block.triangles() as usize {
            let at = 84 + 50 * triangle;
            let normal = [0, 1, 2].map(|axis| float(at + 4 * axis));
            let centre = [0, 1, 2]
                .map(|axis| (0..3).map(|corner| float(at + 12 + 12 * corner + 4 * axis)).sum::<f32>() / 3.0);
            let outwards = normal.iter().zip(centre).zip([2.0, 1.5, 1.0]).map(|((n, c), m)| n * (c - m));
            assert!(outwards.sum::<f32>() > 0.9, "{normal:?} at {centre:?}");
        }
    }
}
