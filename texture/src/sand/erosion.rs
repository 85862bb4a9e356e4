//! Sliding to the angle of repose, only where something can slide.
//!
//! ```text
//! e_i = (h − h_i) − d_i tan θ > 0      d_i = dx or √2 dx, eight neighbours
//! Δm  = c · max e_i                     c = ½, cells taken one after another
//! Δm_i = Δm · e_i / Σ e
//! ```
//!
//! Source: the sand paper §3.2. What we read differently: the printed "m_i" in the share is the
//! difference to the neighbour, not its height; diagonal neighbours are √2 further away. What we
//! changed: sand is cut into tiles of 32 × 32 cells, and a tile is looked at only while something
//! moved in it or next to it; whole rows are first tested without branches, and only the cells
//! that are too steep are worked on; the order of rows and cells turns with every pass, so that
//! sequential work has no preferred direction. A slope counts as settled at θ + ¼°, where
//! another hundred passes would only creep. All arithmetic is in whole numbers or single roundings:
//! the same sand gives the same sand everywhere.

use super::grid::{SandGrid, UNITS_PER_M, WALL};
use asperity_dsp::DesignError;

/// Edge of a tile, cells.
pub const TILE: usize = 32;
/// Excess over the talus angle that is left alone, degrees.
pub const SETTLED_DEG: f64 = 0.25;

/// The state of sliding on one grid.
#[derive(Debug, Clone)]
pub struct Erosion {
    /// Height a neighbour may be lower: along an edge, along a diagonal.
    limit: [i32; 2],
    /// Excess that makes a cell slide.
    tolerance: [i32; 2],
    tile_columns: usize,
    tile_rows: usize,
    active: Vec<bool>,
    next: Vec<bool>,
    pass: u32,
}

impl Erosion {
    /// Sliding at a talus angle; nothing is active yet.
    ///
    /// # Errors
    /// When the angle is not 1° to 80°.
    pub fn new(grid: &SandGrid, talus_deg: f64) -> Result<Self, DesignError> {
        DesignError::check("talus_deg", talus_deg, "1 to 80 degrees", |t| (1.0..=80.0).contains(&t))?;
        let rise = |degrees: f64| degrees.to_radians().tan() * grid.cell_m() * UNITS_PER_M;
        let (at, above) = (rise(talus_deg), rise(talus_deg + SETTLED_DEG) - rise(talus_deg));
        let both = |x: f64| [x as i32, (x * core::f64::consts::SQRT_2) as i32];
        let (tile_columns, tile_rows) = (grid.columns().div_ceil(TILE), grid.rows().div_ceil(TILE));
        let tiles = tile_columns * tile_rows;
        Ok(Self {
            limit: both(at),
            tolerance: both(above).map(|t| t.max(8)),
            tile_columns,
            tile_rows,
            active: vec![false; tiles],
            next: vec![false; tiles],
            pass: 0,
        })
    }

    /// Looks at everything in the next pass.
    pub fn activate_all(&mut self) {
        self.active.fill(true);
    }

    /// Looks at a rectangle of cells (ends included) and one cell around it in the next pass.
    pub fn activate(&mut self, x: [usize; 2], y: [usize; 2]) {
        let tiles = |range: [usize; 2], count: usize| {
            (range[0].saturating_sub(1) / TILE)..=((range[1] + 1) / TILE).min(count - 1)
        };
        for ty in tiles(y, self.tile_rows) {
            for tx in tiles(x, self.tile_columns) {
                self.active[ty * self.tile_columns + tx] = true;
            }
        }
    }

    /// Whether nothing slides any more.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        !self.active.contains(&true)
    }

    /// Tiles that the next pass looks at.
    #[must_use]
    pub fn active_tiles(&self) -> usize {
        self.active.iter().filter(|&&a| a).count()
    }

    /// One pass over the active tiles; returns how many cells it looked at.
    pub fn pass(&mut self, grid: &mut SandGrid) -> usize {
        let tiles = self.active.len();
        let mut cells = 0;
        for n in 0..tiles {
            let tile = if self.pass & 1 == 0 { n } else { tiles - 1 - n };
            if self.active[tile] {
                cells += self.tile(grid, tile % self.tile_columns, tile / self.tile_columns);
            }
        }
        core::mem::swap(&mut self.active, &mut self.next);
        self.next.fill(false);
        self.pass = self.pass.wrapping_add(1);
        cells
    }

    /// Passes until settled; returns their number.
    pub fn settle(&mut self, grid: &mut SandGrid) -> usize {
        let mut passes = 0;
        while !self.is_settled() {
            self.pass(grid);
            passes += 1;
        }
        passes
    }

    fn tile(&mut self, grid: &mut SandGrid, tx: usize, ty: usize) -> usize {
        let columns = (tx * TILE)..((tx + 1) * TILE).min(grid.columns());
        let rows = (ty * TILE)..((ty + 1) * TILE).min(grid.rows());
        let count = rows.len();
        // Edges of the tile that something moved at: left, right, top, bottom, anywhere.
        let mut moved = [false; 5];
        for n in 0..count {
            let y = if self.pass & 2 == 0 { rows.start + n } else { rows.end - 1 - n };
            let mut steep = self.steep_cells(grid, grid.index(columns.start, y), columns.len());
            while steep != 0 {
                let x = if self.pass & 1 == 0 { steep.trailing_zeros() } else { 31 - steep.leading_zeros() };
                steep &= !(1 << x);
                let at = grid.index(columns.start + x as usize, y);
                if self.slide(grid, at) {
                    moved[0] |= x == 0;
                    moved[1] |= x as usize + 1 == columns.len();
                    moved[2] |= y == rows.start;
                    moved[3] |= y + 1 == rows.end;
                    moved[4] = true;
                }
            }
        }
        if moved[4] {
            self.wake(tx, ty, &moved);
        }
        count * columns.len()
    }

    /// Wakes a tile and those whose cells may have become steep: a move changes the eight cells
    /// around it, and those look one cell further.
    fn wake(&mut self, tx: usize, ty: usize, moved: &[bool; 5]) {
        let reach = |low: bool, high: bool, t: usize, count: usize| {
            t.saturating_sub(usize::from(low))..=(t + usize::from(high)).min(count - 1)
        };
        for y in reach(moved[2], moved[3], ty, self.tile_rows) {
            for x in reach(moved[0], moved[1], tx, self.tile_columns) {
                self.next[y * self.tile_columns + x] = true;
            }
        }
    }

    /// Which of up to 32 cells of a row are too steep, one bit a cell, without branches.
    fn steep_cells(&self, grid: &SandGrid, at: usize, count: usize) -> u32 {
        let stride = grid.stride();
        let row = |offset: usize| &grid.heights[offset..offset + count + 2];
        let (above, here, below) = (row(at - stride - 1), row(at - 1), row(at + stride - 1));
        let axis_limit = self.limit[0] + self.tolerance[0];
        let diagonal_limit = self.limit[1] + self.tolerance[1];
        let mut flags = [0_u8; TILE];
        for (i, flag) in flags.iter_mut().enumerate().take(count) {
            let axis = here[i].min(here[i + 2]).min(above[i + 1].min(below[i + 1]));
            let diagonal = above[i].min(above[i + 2]).min(below[i].min(below[i + 2]));
            let h = here[i + 1];
            let steep = (h - axis > axis_limit) | (h - diagonal > diagonal_limit);
            *flag = u8::from(steep & (h < WALL));
        }
        let mut bits = 0;
        for (i, flag) in flags.iter().enumerate() {
            bits |= u32::from(*flag) << i;
        }
        bits
    }

    /// Lets one cell slide; tells whether anything moved.
    fn slide(&self, grid: &mut SandGrid, at: usize) -> bool {
        let stride = grid.stride();
        let neighbours = [
            at - 1,
            at + 1,
            at - stride,
            at + stride,
            at - stride - 1,
            at - stride + 1,
            at + stride - 1,
            at + stride + 1,
        ];
        let h = grid.heights[at];
        let (mut most, mut sum) = (0, 0.0_f64);
        let excess: [i32; 8] = core::array::from_fn(|i| {
            let e = (h - grid.heights[neighbours[i]] - self.limit[i / 4]).max(0);
            most = most.max(e);
            sum += f64::from(e);
            e
        });
        if most <= self.tolerance[0].min(self.tolerance[1]) {
            return false;
        }
        let share = 0.5 * f64::from(most) / sum;
        let mut given = 0;
        for (i, &e) in excess.iter().enumerate() {
            let part = (share * f64::from(e)) as i32;
            grid.heights[neighbours[i]] += part;
            given += part;
        }
        grid.heights[at] = h - given;
        given > 0
    }
}
