//! Moving picture: heights of a surface that changes, tile by tile, for a program that draws it.
//!
//! The simulation writes tiles that changed, a reader takes those it has not seen; neither waits.
//! The picture is always the latest: a reader that comes late loses what lay between, and gets
//! how many states of tiles that was.
//!
//! ```text
//! writer: version + 1 (odd) → heights → version + 1 (even)     reader: version even? → copy → same version?
//! ```
//!
//! A sequence lock a tile: a tile that changes while it is copied is taken the next time. The
//! heights are made when a reader first asks, on its own thread; until then a picture costs its
//! writer one look a frame.

use crate::changed_tiles::ChangedTiles;
pub use crate::changed_tiles::TILE_CELLS;
use std::sync::atomic::{AtomicU32, Ordering, fence};
use std::sync::{Arc, OnceLock};

/// The heights of a grid of cells, shared by one writer and its readers.
#[derive(Debug)]
pub struct MovingPicture {
    columns: usize,
    rows: usize,
    cell_m: f64,
    shown: OnceLock<Shown>,
}

#[derive(Debug)]
struct Shown {
    /// Bits of the heights, m.
    heights: Box<[AtomicU32]>,
    /// Even, or odd while a tile is being written; 0 = never written.
    versions: Box<[AtomicU32]>,
}

/// One tile of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureTile<'a> {
    /// Its first column and row in the picture, cells.
    pub at: [usize; 2],
    /// Its columns and rows.
    pub size: [usize; 2],
    /// Row after row, metres above the bottom.
    pub height_m: &'a [f32],
}

/// Reads one picture; as many readers as one likes, each on a thread of its own.
#[derive(Debug)]
pub struct PictureReader {
    picture: Arc<MovingPicture>,
    seen: Vec<u32>,
    tile: Vec<f32>,
    missed: u64,
}

impl MovingPicture {
    /// A picture of `columns` × `rows` cells that nobody looks at yet.
    #[must_use]
    pub fn new(columns: usize, rows: usize, cell_m: f64) -> Arc<Self> {
        Arc::new(Self { columns, rows, cell_m, shown: OnceLock::new() })
    }

    /// Columns and rows, cells.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// Side of a cell, metres.
    #[must_use]
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// Makes the picture, if nobody has; it allocates.
    pub fn make(&self) {
        let words = |count| (0..count).map(|_| AtomicU32::new(0)).collect();
        let (cells, tiles) = (self.columns * self.rows, self.tiles());
        self.shown.get_or_init(|| Shown { heights: words(cells), versions: words(tiles) });
    }

    /// Height of the cell at a place as it was written last, of the nearest one beyond the edge, m;
    /// none before a picture was written. It neither waits nor allocates; two cells may be of two
    /// frames.
    #[must_use]
    pub fn height_at(&self, position_m: [f64; 2]) -> Option<f64> {
        let shown = self.shown.get()?;
        let cell = |a: usize, count: usize| ((position_m[a] / self.cell_m).max(0.0) as usize).min(count - 1);
        let (column, row) = (cell(0, self.columns), cell(1, self.rows));
        let tile = row / TILE_CELLS * self.columns.div_ceil(TILE_CELLS) + column / TILE_CELLS;
        let is_written = shown.versions[tile].load(Ordering::Acquire) != 0;
        let bits = shown.heights[row * self.columns + column].load(Ordering::Relaxed);
        is_written.then(|| f64::from(f32::from_bits(bits)))
    }

    /// A reader; the first one makes the picture.
    #[must_use]
    pub fn reader(self: &Arc<Self>) -> PictureReader {
        let tiles = self.tiles();
        self.make();
        PictureReader {
            picture: self.clone(),
            seen: vec![0; tiles],
            tile: Vec::with_capacity(TILE_CELLS * TILE_CELLS),
            missed: 0,
        }
    }

    /// Writes the tiles that differ from what the picture shows, of a surface whose cells lie at
    /// `height_m(column, row)`, m. Returns how many were written. Only `changed` tiles are looked
    /// at, and those that were never shown; the marks are then taken away. There is one writer;
    /// nothing is written before somebody looks.
    pub fn write(&self, changed: &mut ChangedTiles, height_m: impl Fn(usize, usize) -> f32) -> usize {
        let Some(shown) = self.shown.get() else { return 0 };
        let is_new = |tile: usize| shown.versions[tile].load(Ordering::Relaxed) == 0;
        let looked_at = (0..self.tiles()).filter(|&tile| changed.is_marked(tile) || is_new(tile));
        let written = looked_at.filter(|&tile| self.write_tile(shown, tile, &height_m)).count();
        changed.clear();
        written
    }

    fn write_tile(&self, shown: &Shown, tile: usize, height_m: &impl Fn(usize, usize) -> f32) -> bool {
        let ([x, y], [width, height]) = self.place(tile);
        let cells = || {
            (y..y + height).flat_map(move |row| {
                let first = row * self.columns;
                (x..x + width)
                    .map(move |column| (&shown.heights[first + column], height_m(column, row).to_bits()))
            })
        };
        let version = shown.versions[tile].load(Ordering::Relaxed);
        if version != 0 && cells().all(|(old, new)| old.load(Ordering::Relaxed) == new) {
            return false;
        }
        shown.versions[tile].store(version.wrapping_add(1), Ordering::Relaxed);
        fence(Ordering::Release);
        cells().for_each(|(old, new)| old.store(new, Ordering::Relaxed));
        // 0 is kept for what was never written.
        let next = version.wrapping_add(2);
        shown.versions[tile].store(if next == 0 { 2 } else { next }, Ordering::Release);
        true
    }

    fn tiles(&self) -> usize {
        self.columns.div_ceil(TILE_CELLS) * self.rows.div_ceil(TILE_CELLS)
    }

    /// First column and row of a tile, and its size.
    fn place(&self, tile: usize) -> ([usize; 2], [usize; 2]) {
        let across = self.columns.div_ceil(TILE_CELLS);
        let at = [tile % across * TILE_CELLS, tile / across * TILE_CELLS];
        (at, [(self.columns - at[0]).min(TILE_CELLS), (self.rows - at[1]).min(TILE_CELLS)])
    }
}

impl PictureReader {
    /// Shows every tile that has changed since the last call, as it is now; returns how many.
    pub fn changed(&mut self, mut show: impl FnMut(PictureTile<'_>)) -> usize {
        let Some(shown) = self.picture.shown.get() else { return 0 };
        let mut count = 0;
        for tile in 0..self.seen.len() {
            let version = shown.versions[tile].load(Ordering::Acquire);
            if version == self.seen[tile] || version % 2 == 1 {
                continue;
            }
            let (at, size) = self.picture.place(tile);
            self.tile.clear();
            for row in at[1]..at[1] + size[1] {
                let first = row * self.picture.columns + at[0];
                let heights = &shown.heights[first..first + size[0]];
                self.tile.extend(heights.iter().map(|bits| f32::from_bits(bits.load(Ordering::Relaxed))));
            }
            fence(Ordering::Acquire);
            if shown.versions[tile].load(Ordering::Relaxed) != version {
                continue;
            }
            self.missed += u64::from(version.wrapping_sub(self.seen[tile]) / 2).saturating_sub(1);
            self.seen[tile] = version;
            show(PictureTile { at, size, height_m: &self.tile });
            count += 1;
        }
        count
    }

    /// States of tiles that were written and never shown here.
    #[must_use]
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// The picture.
    #[must_use]
    pub fn picture(&self) -> &MovingPicture {
        &self.picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 70 × 40 cells: tiles of every size.
    fn picture() -> (Arc<MovingPicture>, Vec<Vec<f32>>) {
        (MovingPicture::new(70, 40, 1e-3), vec![vec![0.05; 70]; 40])
    }

    /// Everything may have changed.
    fn all() -> ChangedTiles {
        ChangedTiles::all(70, 40)
    }

    /// Reader's view of its tiles.
    fn draw(reader: &mut PictureReader, drawn: &mut [Vec<f32>]) -> usize {
        reader.changed(|tile| {
            for (y, row) in tile.height_m.chunks(tile.size[0]).enumerate() {
                drawn[tile.at[1] + y][tile.at[0]..tile.at[0] + tile.size[0]].copy_from_slice(row);
            }
        })
    }

    #[test]
    fn only_tiles_that_changed_are_shown_and_they_are_what_was_written() {
        let (picture, mut heights) = picture();
        assert_eq!(picture.write(&mut all(), |x, y| heights[y][x]), 0, "nobody looks");
        let mut reader = picture.reader();
        let mut drawn = vec![vec![0.0; 70]; 40];
        assert_eq!((picture.write(&mut all(), |x, y| heights[y][x]), draw(&mut reader, &mut drawn)), (6, 6));
        assert!(drawn == heights);
        heights[35][69] = 0.01;
        heights[0][31] = 0.02;
        assert_eq!((picture.write(&mut all(), |x, y| heights[y][x]), draw(&mut reader, &mut drawn)), (2, 2));
        assert!(drawn == heights);
        assert_eq!((picture.write(&mut all(), |x, y| heights[y][x]), draw(&mut reader, &mut drawn)), (0, 0));
        assert_eq!(reader.missed(), 0);
    }

    #[test]
    fn unmarked_stretches_are_skipped_and_unseen_ones_examined() {
        let (picture, mut heights) = picture();
        let mut none = all();
        none.clear();
        let mut reader = picture.reader();
        let mut drawn = vec![vec![0.0; 70]; 40];
        assert_eq!((picture.write(&mut none, |x, y| heights[y][x]), draw(&mut reader, &mut drawn)), (6, 6));
        (heights[3][3], heights[35][69]) = (0.01, 0.02);
        let mut one = none.clone();
        one.mark([69, 69], [35, 35]);
        assert_eq!((picture.write(&mut one, |x, y| heights[y][x]), draw(&mut reader, &mut drawn)), (1, 1));
        assert_eq!((drawn[3][3], drawn[35][69]), (0.05, 0.02));
        assert_eq!(one, none);
    }

    #[test]
    fn a_late_reader_sees_the_latest_and_the_number_missed() {
        let (picture, mut heights) = picture();
        let (mut late, mut drawn) = (picture.reader(), vec![vec![0.0; 70]; 40]);
        for n in 0..10 {
            heights[3][3] = n as f32;
            picture.write(&mut all(), |x, y| heights[y][x]);
        }
        assert_eq!(draw(&mut late, &mut drawn), 6);
        assert!(drawn == heights);
        assert_eq!(late.missed(), 9);
        let mut second = picture.reader();
        assert_eq!(draw(&mut second, &mut drawn), 6);
    }

    #[test]
    fn a_tile_is_never_shown_half_written() {
        let (picture, _) = picture();
        let mut reader = picture.reader();
        let shared = picture.clone();
        let writing = std::thread::spawn(move || {
            for n in 0..20_000 {
                shared.write(&mut all(), |_, _| n as f32);
            }
        });
        let mut seen = 0;
        while seen < 6 * 19_999 {
            reader.changed(|tile| {
                let first = tile.height_m[0];
                assert!(tile.height_m.iter().all(|height| *height == first));
                seen = seen.max(if first == 19_999.0 { 6 * 19_999 } else { 0 });
            });
        }
        writing.join().unwrap();
    }
}
