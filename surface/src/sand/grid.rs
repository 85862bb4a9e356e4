//! Heights of sand as whole numbers of 2⁻³⁰ m (0.93 nm).
//!
//! Every move takes a whole number from one cell and gives it to others, so that the volume does
//! not drift by a single unit however long the sand is played with (floating point drifts by 1e-6).
//! The grid is surrounded by a wall one cell thick that nothing slides over.

use crate::raster::Raster;
use asperity_dsp::DesignError;
use asperity_dsp::limits::sand as limits;

/// Columns of a tile of the erosion: wide enough that a vector is not read back before it has been
/// written.
pub const TILE: usize = 64;

/// Units of height in a metre.
pub const UNITS_PER_M: f64 = 1_073_741_824.0;
/// Most cells along an edge.
pub const MAX_CELLS: usize = 4096;
/// No sand is heaped higher than this, half a metre.
pub(super) const HIGHEST: i32 = 1 << 29;
/// Heights are 0 to below this, and so are their differences.
pub(super) const SPAN: u32 = 1 << 30;
/// A cell that is no sand: the wall around the grid, or the tool. Its difference to any height, in
/// either direction and wrapped to 32 bits, is no less than [`SPAN`].
pub(super) const WALL: i32 = -(3 << 29);

/// A rectangle of sand.
#[derive(Debug, Clone, PartialEq)]
pub struct SandGrid {
    columns: usize,
    rows: usize,
    cell_m: f64,
    /// Rows of heights with a wall around them, and walls on the right up to a whole number of
    /// tiles.
    pub(super) heights: Vec<i32>,
}

/// A 16-bit picture of the sand.
#[derive(Debug, Clone, PartialEq)]
pub struct SandPicture {
    /// Heights from 0 (lowest) to 1 (highest).
    pub raster: Raster,
    /// Height of one of 65 535 grey steps, metres.
    pub metres_per_grey: f64,
    /// Height of black, metres above the bottom.
    pub lowest_m: f64,
}

impl SandGrid {
    /// Flat sand, `depth_m` above the bottom.
    ///
    /// # Errors
    /// When an edge is not 4 to [`MAX_CELLS`] cells, a cell not 1 µm to 0.1 m, or the depth not
    /// above 0 and at most 0.45 m.
    pub fn flat(columns: usize, rows: usize, cell_m: f64, depth_m: f64) -> Result<Self, DesignError> {
        limits::CELLS.check("columns", columns as f64)?;
        limits::CELLS.check("rows", rows as f64)?;
        limits::CELL_M.check("cell_m", cell_m)?;
        limits::DEPTH_M.check("depth_m", depth_m)?;
        let mut grid = Self { columns, rows, cell_m, heights: Vec::new() };
        grid.heights = vec![WALL; grid.stride() * (rows + 2)];
        grid.fill(|_, _| depth_m);
        Ok(grid)
    }

    /// Sets every height, metres above the bottom (held within 0 to 0.499 m).
    pub fn fill(&mut self, mut height_m: impl FnMut(usize, usize) -> f64) {
        for y in 0..self.rows {
            for x in 0..self.columns {
                let at = self.index(x, y);
                self.heights[at] = (height_m(x, y).clamp(0.0, 0.499) * UNITS_PER_M) as i32;
            }
        }
    }

    /// Cells along u.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Cells along v.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Edge of a cell, metres.
    #[must_use]
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// Index of a cell's height.
    #[inline]
    pub(super) fn index(&self, x: usize, y: usize) -> usize {
        (y + 1) * self.stride() + x + 1
    }

    /// Heights in a row, walls included.
    #[inline]
    pub(super) fn stride(&self) -> usize {
        self.columns.next_multiple_of(TILE) + 2
    }

    /// Height of a cell, metres above the bottom.
    #[must_use]
    pub fn height_m(&self, x: usize, y: usize) -> f64 {
        f64::from(self.heights[self.index(x.min(self.columns - 1), y.min(self.rows - 1))]) / UNITS_PER_M
    }

    /// Height at a position in metres, linear between cell centres, level beyond the edge.
    #[must_use]
    pub fn height_at_m(&self, position_m: [f64; 2]) -> f64 {
        let along = |p: f64, n: usize| {
            let t = (p / self.cell_m - 0.5).clamp(0.0, (n - 1) as f64);
            let cell = (t as usize).min(n - 2);
            (cell, t - cell as f64)
        };
        let ((x, fx), (y, fy)) = (along(position_m[0], self.columns), along(position_m[1], self.rows));
        let row = |y: usize| {
            let (a, b) = (self.height_m(x, y), self.height_m(x + 1, y));
            a + fx * (b - a)
        };
        row(y) + fy * (row(y + 1) - row(y))
    }

    /// Sum of all heights in units: what must never change.
    #[must_use]
    pub fn volume_units(&self) -> i64 {
        (0..self.rows)
            .flat_map(|y| &self.heights[self.index(0, y)..self.index(0, y) + self.columns])
            .map(|&h| i64::from(h))
            .sum()
    }

    /// Volume, m³.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        self.volume_units() as f64 / UNITS_PER_M * self.cell_m * self.cell_m
    }

    /// Steepest slope between neighbours, along edges and diagonals, degrees.
    #[must_use]
    pub fn max_slope_deg(&self) -> f64 {
        let (mut axis, mut diagonal) = (0, 0);
        for y in 0..self.rows {
            for x in 0..self.columns {
                let at = self.index(x, y);
                let h = self.heights[at];
                let rise = |to: usize| {
                    let other = self.heights[to];
                    if other == WALL { 0 } else { (h - other).abs() }
                };
                axis = axis.max(rise(at + 1)).max(rise(at + self.stride()));
                let below = at + self.stride();
                diagonal = diagonal.max(rise(below + 1)).max(rise(below - 1));
            }
        }
        let run = self.cell_m * UNITS_PER_M;
        let slope = (f64::from(axis) / run).max(f64::from(diagonal) / (run * core::f64::consts::SQRT_2));
        libm::atan(slope).to_degrees()
    }

    /// A picture of the heights.
    #[must_use]
    pub fn picture(&self) -> SandPicture {
        let raster = Raster::from_fn(self.columns, self.rows, |x, y| self.height_m(x, y));
        let (low, high) = raster.range();
        let span = (high - low).max(1.0 / UNITS_PER_M);
        SandPicture {
            raster: raster.map(|h| (h - low) / span),
            metres_per_grey: span / 65_535.0,
            lowest_m: low,
        }
    }
}
