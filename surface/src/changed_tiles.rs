//! Changed tiles: which parts of a grid of cells may differ from what was shown of them last.
//!
//! The side that changes a rectangle of cells marks it; the one that shows the grid looks at the
//! marked tiles alone and begins anew. A mark too many costs a look, a mark too few would show what
//! is no longer there.

/// Side of a tile, cells; those at the right and lower edge may be smaller.
pub const TILE_CELLS: usize = 32;

/// The marks of one grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChangedTiles {
    across: usize,
    down: usize,
    marked: Vec<bool>,
}

impl ChangedTiles {
    /// Tiles of a grid of `columns` × `rows` cells, all of it marked.
    #[must_use]
    pub fn all(columns: usize, rows: usize) -> Self {
        let (across, down) = (columns.div_ceil(TILE_CELLS), rows.div_ceil(TILE_CELLS));
        Self { across, down, marked: vec![true; across * down] }
    }

    /// Marks every tile.
    pub fn mark_all(&mut self) {
        self.marked.fill(true);
    }

    /// Marks a rectangle of cells, ends included; what lies beyond the grid is no tile.
    pub fn mark(&mut self, columns: [usize; 2], rows: [usize; 2]) {
        let last = |cell: usize, tiles: usize| (cell / TILE_CELLS).min(tiles - 1);
        for y in rows[0] / TILE_CELLS..=last(rows[1], self.down) {
            let row = &mut self.marked[y * self.across..][..self.across];
            for tile in row.iter_mut().take(last(columns[1], self.across) + 1).skip(columns[0] / TILE_CELLS) {
                *tile = true;
            }
        }
    }

    /// Tests whether a tile is marked, row after row of tiles.
    #[must_use]
    pub fn is_marked(&self, tile: usize) -> bool {
        self.marked.get(tile).copied().unwrap_or(true)
    }

    /// Takes all marks away.
    pub fn clear(&mut self) {
        self.marked.fill(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_marks_the_tiles_that_it_touches_and_no_other() {
        let mut changed = ChangedTiles::all(100, 70);
        assert!((0..12).all(|tile| changed.is_marked(tile)));
        changed.clear();
        changed.mark([31, 32], [40, 500]);
        let marked: Vec<usize> = (0..12).filter(|&tile| changed.is_marked(tile)).collect();
        assert_eq!(marked, [4, 5, 8, 9]);
        changed.clear();
        changed.mark([400, 500], [0, 0]);
        assert!((0..12).all(|tile| !changed.is_marked(tile)));
    }
}
