//! Sliding to the angle of repose, only where something can slide.
//!
//! ```text
//! e = |h − h_i| − d_i tan θ             d_i = dx or √2 dx, for each of a cell's eight neighbours in turn
//! Δm = ½ e  from the higher to the lower one, where e is more than ¼° of slope
//! ```
//!
//! Source: the sand paper §3.2, whose rule gives each lower neighbour Δm_i = Δm · e_i / Σ e of Δm =
//! c · max e, all at once and c left open. (The printed "m_i" in the share is the difference to the
//! neighbour, not its height; diagonal neighbours are √2 further away.) With one neighbour too low,
//! ours is the same with c = ½; with several, they are served one after another instead of in
//! shares.
//!
//! Why: pairs of cells that do not touch each other can slide at once, so that a whole row slides
//! against the next one, or against itself shifted by a cell, in vector registers and without
//! branches (`row`): 0.9 ns a cell for all eight neighbours, where the rule as printed takes 4 to
//! 17. A random field settles 15 to 25 times faster than by repeating the document's pass over the
//! whole grid until nothing moves. Cones come out rounder than the document's: within 2.6 % of the
//! ideal radius along the axes and the diagonals (10 % with shares and cells taken row by row).
//!
//! Sand is cut into tiles of 64 × 32 cells. Each remembers which of its rows may have become too
//! steep, a bit a row, and only those are looked at. Rows, and what is served first within them,
//! turn with every pass, so that sequential work has no preferred direction. A slope counts as
//! settled at θ + ¼°, where another hundred passes would only creep. All arithmetic is in whole
//! numbers: the same sand gives the same sand everywhere.

mod row;

use super::grid::{SandGrid, TILE, UNITS_PER_M};
use asperity_dsp::DesignError;
use asperity_dsp::limits::sand as limits;
use asperity_dsp::simd::Level;
use row::{Moved, Order, Steepness, slide};

/// Rows of a tile: the bits of a word.
const TILE_ROWS: usize = u32::BITS as usize;
/// Excess over the talus angle that is left alone, degrees.
pub const SETTLED_DEG: f64 = 0.25;

/// The state of sliding on one grid.
#[derive(Debug, Clone)]
pub struct Erosion {
    steepness: Steepness,
    tile_columns: usize,
    tile_rows: usize,
    /// Rows to be looked at in this pass, one bit a row, one word a tile.
    active: Vec<u32>,
    next: Vec<u32>,
    /// Rows from or to which sand slid since anybody asked.
    slid: Vec<u32>,
    pass: u32,
    level: Level,
}

/// Cells that moved in a tile, one bit a row.
#[derive(Default)]
struct Slides {
    /// Anything.
    any: u32,
    /// Sand went to or came from the row below.
    below: u32,
    /// Cells that touch the tile to the left, to the right.
    left: u32,
    right: u32,
    /// To be looked at again.
    again: u32,
}

impl Erosion {
    /// Sliding at a talus angle; nothing is active yet.
    ///
    /// # Errors
    /// When the angle is not 1° to 80°.
    pub fn new(grid: &SandGrid, talus_deg: f64) -> Result<Self, DesignError> {
        let (tile_columns, tile_rows) = (grid.columns().div_ceil(TILE), grid.rows().div_ceil(TILE_ROWS));
        let tiles = tile_columns * tile_rows;
        Ok(Self {
            steepness: steepness(grid, talus_deg)?,
            tile_columns,
            tile_rows,
            active: vec![0; tiles],
            next: vec![0; tiles],
            slid: vec![0; tiles],
            pass: 0,
            level: Level::detect(),
        })
    }

    /// Another talus angle; nothing becomes active by it.
    ///
    /// # Errors
    /// When the angle is not 1° to 80°.
    pub fn set_talus(&mut self, grid: &SandGrid, talus_deg: f64) -> Result<(), DesignError> {
        self.steepness = steepness(grid, talus_deg)?;
        Ok(())
    }

    /// Erodes on a chosen instruction set; the sand is the same.
    #[must_use]
    pub fn on(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// Looks at everything in the next pass.
    pub fn activate_all(&mut self) {
        self.active.fill(u32::MAX);
    }

    /// Looks at a rectangle of cells (ends included) and what is around it in the next pass.
    pub fn activate(&mut self, x: [usize; 2], y: [usize; 2]) {
        // A row slides against the one below: the row above the first one sees it too.
        let (first, last) = (y[0].saturating_sub(1), y[1]);
        let (left, right) = (x[0].saturating_sub(1) / TILE, (x[1] / TILE).min(self.tile_columns - 1));
        for ty in first / TILE_ROWS..=(last / TILE_ROWS).min(self.tile_rows - 1) {
            let from = first.saturating_sub(ty * TILE_ROWS);
            let to = (last - ty * TILE_ROWS).min(TILE_ROWS - 1);
            let bits = (u32::MAX << from) & (u32::MAX >> (TILE_ROWS - 1 - to));
            for tx in left..=right {
                self.active[ty * self.tile_columns + tx] |= bits;
            }
        }
    }

    /// Tests whether nothing slides any more.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.active.iter().all(|&rows| rows == 0)
    }

    /// One pass over the active rows; returns how many cells it looked at.
    pub fn pass(&mut self, grid: &mut SandGrid) -> usize {
        let tiles = self.active.len();
        let mut rows = 0;
        for n in 0..tiles {
            let tile = if self.pass & 1 == 0 { n } else { tiles - 1 - n };
            if self.active[tile] != 0 {
                rows += self.tile(grid, tile);
            }
        }
        core::mem::swap(&mut self.active, &mut self.next);
        self.next.fill(0);
        self.pass = self.pass.wrapping_add(1);
        rows * TILE
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

    /// The active rows of a tile, and those that become so under way; returns their number.
    fn tile(&mut self, grid: &mut SandGrid, tile: usize) -> usize {
        let (tx, ty) = (tile % self.tile_columns, tile / self.tile_columns);
        let first_row = ty * TILE_ROWS;
        let rows = (grid.rows() - first_row).min(TILE_ROWS) as u32;
        let within = u32::MAX >> (u32::BITS - rows);
        let order = Order::of(self.pass);
        let mut left = self.active[tile] & within;
        let mut slides = Slides::default();
        let mut looked_at = 0;
        while left != 0 {
            let row =
                if order.upwards { u32::BITS - 1 - left.leading_zeros() } else { left.trailing_zeros() };
            let bit = 1 << row;
            left &= !bit;
            looked_at += 1;
            let at = grid.index(tx * TILE, first_row + row as usize);
            let moved = slide(self.level, grid, at, &self.steepness, order);
            if moved.any {
                let (up, down) = (bit >> 1, if moved.below { bit << 1 } else { 0 });
                // What comes next in this pass sees it now, what came before in the next pass.
                let now = if order.upwards { up } else { down } & within;
                left |= now;
                slides.record(bit, &moved);
                slides.again |= (bit | up | down) & !now & within;
            }
        }
        if slides.any != 0 {
            self.slid[tile] |= slides.any;
            self.wake(tile, rows, &slides);
        }
        looked_at
    }

    /// Shows the rectangles of cells in which sand has slid since the last call, first and last
    /// column, first and last row; some may not have changed.
    pub fn slid(&mut self, mut see: impl FnMut([usize; 2], [usize; 2])) {
        for (tile, rows) in self.slid.iter_mut().enumerate().filter(|(_, rows)| **rows != 0) {
            let [x, y] = [tile % self.tile_columns * TILE, tile / self.tile_columns * TILE_ROWS];
            let (first, last) =
                (rows.trailing_zeros() as usize, TILE_ROWS - 1 - rows.leading_zeros() as usize);
            // A row slides against the one below, and its last cell against the next tile's first.
            see([x, x + TILE], [y + first, y + last + 1]);
            *rows = 0;
        }
    }

    /// Marks the rows that a tile's slides may have made too steep, in it and in the tiles around
    /// it.
    fn wake(&mut self, tile: usize, rows: u32, slides: &Slides) {
        let (tx, ty) = (tile % self.tile_columns, tile / self.tile_columns);
        let last_row = 1 << (rows - 1);
        let above = (slides.any & 1 != 0 && ty > 0).then(|| tile - self.tile_columns);
        let below =
            (slides.below & last_row != 0 && ty + 1 < self.tile_rows).then(|| tile + self.tile_columns);
        let lowest = 1 << (TILE_ROWS - 1);
        self.next[tile] |= slides.again;
        if let Some(above) = above {
            self.next[above] |= lowest;
        }
        if let Some(below) = below {
            self.next[below] |= 1;
        }
        let mut beside = |moved: u32, step: fn(usize) -> usize| {
            if moved != 0 {
                self.next[step(tile)] |= moved | (moved >> 1) | ((moved & slides.below) << 1);
                if let Some(above) = above {
                    self.next[step(above)] |= if moved & 1 != 0 { lowest } else { 0 };
                }
                if let Some(below) = below {
                    self.next[step(below)] |= u32::from(moved & last_row != 0);
                }
            }
        };
        if tx > 0 {
            beside(slides.left, |t| t - 1);
        }
        if tx + 1 < self.tile_columns {
            beside(slides.right, |t| t + 1);
        }
    }
}

/// Differences of height at a talus angle and where it counts as too steep.
fn steepness(grid: &SandGrid, talus_deg: f64) -> Result<Steepness, DesignError> {
    limits::TALUS_DEG.check("talus_deg", talus_deg)?;
    let rise = |degrees: f64| libm::tan(degrees.to_radians()) * grid.cell_m() * UNITS_PER_M;
    let (at, above) = (rise(talus_deg), rise(talus_deg + SETTLED_DEG) - rise(talus_deg));
    let over = |run: f64| {
        let limit = (at * run) as i32;
        (limit, limit.saturating_add(((above * run) as i32).max(8)))
    };

    Ok(Steepness { axis: over(1.0), diagonal: over(core::f64::consts::SQRT_2) })
}

impl Slides {
    fn record(&mut self, bit: u32, moved: &Moved) {
        let flag = |set: bool| if set { bit } else { 0 };
        self.any |= bit;
        self.below |= flag(moved.below);
        self.left |= flag(moved.left);
        self.right |= flag(moved.right);
    }
}
