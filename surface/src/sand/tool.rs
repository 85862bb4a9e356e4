//! Pressing any tool into sand: cut, then heap.
//!
//! What rises above the tool's lower surface is cut off and laid, to the last unit, onto the rim of
//! the cut, with the weights of the document's filter on its positive side,
//! f(r) = sin(r²) − 0.53, r from 1.2 (at the cut) to 1.607 (where f falls to 0); cells ahead of a
//! moving tool get up to twice, cells behind it down to none.
//!
//! Source: the sand paper §3.1. What we read differently: both printed inequalities are reversed,
//! and even corrected the two halves of f do not cancel (+0.33 and +1.16), so the printed sum of
//! zero cannot hold; ours keeps the volume by counting it. What we changed: the negative filter is
//! the tool's own lower surface (a sphere's, or any height map), the rim is found by growing the
//! cut's outline and not by a radius, and the weights lean forwards (bulldozing).

use super::grid::{HIGHEST, SandGrid, UNITS_PER_M, WALL};
use super::law::{BEARING_DEPTH_M, REFERENCE_RADIUS_M};
use crate::raster::Raster;
use asperity_dsp::DesignError;
use asperity_dsp::limits::{Range, sand as limits};

/// Inner and outer end of the positive side of f.
const RIM: [f64; 2] = [1.2, 1.607];
/// Width of the rim over the radius of the cut.
const RIM_WIDTH: f64 = RIM[1] / RIM[0] - 1.0;

/// Tool that is pressed into the sand.
#[derive(Debug, Clone, PartialEq)]
pub enum Tool {
    /// A sphere of a radius in metres.
    Sphere {
        /// Radius, metres.
        radius_m: f64,
    },
    /// Heights of a tool's underside above its lowest point, metres, centred on the contact;
    /// infinite where there is no tool.
    LowerMap {
        /// The heights.
        map: Raster,
        /// Edge of a texel, metres.
        texel_m: f64,
    },
}

impl Tool {
    /// Refuses tools without a size.
    ///
    /// # Errors
    /// When a size is not 0.1 mm to 0.2 m, or the map is not filled or has no lowest point.
    pub fn check(&self) -> Result<(), DesignError> {
        match self {
            Self::Sphere { radius_m } => {
                limits::TOOL_RADIUS_M.check("tool_radius_m", *radius_m)?;
            }
            Self::LowerMap { map, texel_m } => {
                let filled = map.values.len() == map.width * map.height;
                let count = map.values.len() as f64;
                DesignError::check("tool.map", count, "one value a texel", |n| filled && n > 0.0)?;
                limits::TOOL_TEXEL_M.check("tool.texel_m", *texel_m)?;
                let words = "1e-4 to 0.2 m in half its diagonal";
                Range { words, ..limits::TOOL_RADIUS_M }.check("tool", self.reach_m())?;
                let lowest = map.range().0;
                DesignError::check("tool.map", lowest, "0 m at its lowest point", |l| l.abs() < 1e-9)?;
            }
        }
        Ok(())
    }

    /// Furthest distance of the tool from its contact point, metres.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        match self {
            Self::Sphere { radius_m } => *radius_m,
            Self::LowerMap { map, texel_m } => {
                0.5 * texel_m * libm::hypot(map.width as f64, map.height as f64)
            }
        }
    }

    /// Radius of the print that the tool leaves at a depth, metres: of the circle of the same area.
    #[must_use]
    pub fn print_radius_m(&self, depth_m: f64) -> f64 {
        match self {
            Self::Sphere { radius_m } => {
                let below = depth_m.clamp(0.0, *radius_m);
                (below * (2.0 * radius_m - below)).sqrt()
            }
            Self::LowerMap { map, texel_m } => {
                let texels = map.values.iter().filter(|&&lower_m| lower_m < depth_m).count();
                texel_m * (texels as f64 / core::f64::consts::PI).sqrt()
            }
        }
    }

    /// Radius of its underside about the contact, metres: what it is to a stone. A picture's is
    /// taken for a point.
    #[must_use]
    pub fn tip_radius_m(&self) -> f64 {
        if let Self::Sphere { radius_m } = self { *radius_m } else { 0.0 }
    }

    /// Ratio of its bearing to the source's sphere, by the area of its print; see the
    /// [law](super::law).
    #[must_use]
    pub fn bearing(&self) -> f64 {
        let reference = Self::Sphere { radius_m: REFERENCE_RADIUS_M };
        let [own_m, reference_m] = [self, &reference].map(|tool| tool.print_radius_m(BEARING_DEPTH_M));
        (own_m / reference_m).powi(2).max(1e-6)
    }

    /// Height of the underside above the lowest point, metres; infinite where there is no tool.
    fn lower_m(&self, offset_m: [f64; 2]) -> f64 {
        match self {
            Self::Sphere { radius_m } => {
                let square = radius_m * radius_m - offset_m[0] * offset_m[0] - offset_m[1] * offset_m[1];
                if square < 0.0 { f64::INFINITY } else { radius_m - square.sqrt() }
            }
            Self::LowerMap { map, texel_m } => {
                let texel = |o: f64, n: usize| o / texel_m + 0.5 * n as f64;
                let (x, y) = (texel(offset_m[0], map.width), texel(offset_m[1], map.height));
                let inside = x >= 0.0 && y >= 0.0 && x < map.width as f64 && y < map.height as f64;
                if inside { map.at(x as usize, y as usize) } else { f64::INFINITY }
            }
        }
    }
}

/// Room for one press, made once.
#[derive(Debug, Clone)]
pub struct Press {
    /// Cells from the contact's cell to the edge of the box that is looked at.
    half: usize,
    /// 0 = untouched, 1 = cut, 2… = ring of the rim; one byte a cell of the box.
    ring: Vec<u8>,
    /// The cut cells: index in the grid and height before.
    cut: Vec<(usize, i32)>,
    rim: Vec<(usize, f64)>,
}

/// Result of a press.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Displaced {
    /// Sand that was moved, units of height in cells.
    pub units: i64,
    /// Cells that may have changed: first and last column, first and last row.
    pub columns: [usize; 2],
    /// First and last row.
    pub rows: [usize; 2],
}

impl Press {
    /// Room for a tool on a grid.
    #[must_use]
    pub fn new(tool: &Tool, grid: &SandGrid) -> Self {
        let half = ((1.0 + RIM_WIDTH) * tool.reach_m() / grid.cell_m()).ceil() as usize + 3;
        let box_cells = (2 * half + 1) * (2 * half + 1);
        Self {
            half,
            ring: vec![0; box_cells],
            cut: Vec::with_capacity(box_cells),
            rim: Vec::with_capacity(box_cells),
        }
    }

    /// The cells of the last cut and their heights as the tool left them.
    pub(super) fn cut_cells(&self) -> impl Iterator<Item = usize> + '_ {
        self.cut.iter().map(|&(at, _)| at)
    }

    /// Presses a tool with its lowest point at `tip_m` above the bottom at a position, moving along
    /// `direction` (a unit vector, or zeros).
    pub fn apply(
        &mut self,
        grid: &mut SandGrid,
        tool: &Tool,
        position_m: [f64; 2],
        tip_m: f64,
        direction: [f64; 2],
    ) -> Displaced {
        self.cut.clear();
        let cell = grid.cell_m();
        let centre = [0, 1].map(|a| (position_m[a] / cell).floor());
        let limits = [grid.columns() as f64, grid.rows() as f64];
        let half = self.half as f64;
        if (0..2).any(|a| !(centre[a] >= -half && centre[a] < limits[a] + half)) {
            return Displaced::default();
        }
        let range = |a: usize| {
            let first = (centre[a] - half).max(0.0) as usize;
            [first, (centre[a] + half).clamp(0.0, limits[a] - 1.0) as usize]
        };
        let area = Area { columns: range(0), rows: range(1) };
        self.ring[..area.count()].fill(0);
        let cut = self.cut(grid, tool, position_m, tip_m, &area);
        if cut.units == 0 {
            return Displaced::default();
        }
        let heaped = self.heap(grid, &area, &cut, direction);
        if heaped.units == 0 {
            for &(at, before) in &self.cut {
                grid.heights[at] = before;
            }
        }
        heaped
    }

    /// Cuts what rises above the tool.
    fn cut(
        &mut self,
        grid: &mut SandGrid,
        tool: &Tool,
        position_m: [f64; 2],
        tip_m: f64,
        area: &Area,
    ) -> Cut {
        let cell = grid.cell_m();
        let reach = tool.reach_m();
        let contact = position_m.map(|p| if p >= 0.0 { (p / cell) as usize } else { usize::MAX });
        let mut units = 0_i64;
        let mut middle = [0.0; 2];
        let mut bounds = Area { columns: [usize::MAX, 0], rows: [usize::MAX, 0] };
        for y in area.rows[0]..=area.rows[1] {
            let dy = (y as f64 + 0.5) * cell - position_m[1];
            for x in area.columns[0]..=area.columns[1] {
                let dx = (x as f64 + 0.5) * cell - position_m[0];
                let holds_contact = [x, y] == contact;
                if dx * dx + dy * dy > reach * reach && !holds_contact {
                    continue;
                }
                let mut lower_m = tool.lower_m([dx, dy]);
                if holds_contact {
                    // So that the print is as deep as the tool stands, wherever within a cell that
                    // is.
                    lower_m = lower_m.min(tool.lower_m([0.0; 2]));
                }
                let lower = (tip_m + lower_m) * UNITS_PER_M;
                let at = grid.index(x, y);
                let before = grid.heights[at];
                // Touching counts as cut, so that the tool keeps standing in its own print.
                if lower <= f64::from(before) + 1.0 && before != WALL {
                    let after = (lower.max(0.0) as i32).min(before);
                    grid.heights[at] = after;
                    units += i64::from(before) - i64::from(after);
                    self.cut.push((at, before));
                    self.ring[area.index(x, y)] = 1;
                    middle[0] += x as f64;
                    middle[1] += y as f64;
                    bounds.include(x, y);
                }
            }
        }
        let count = self.cut.len().max(1) as f64;
        Cut { units, middle: middle.map(|m| m / count), bounds }
    }

    /// Lays the sand onto the rim; nothing is displaced when there is no cell for it.
    fn heap(&mut self, grid: &mut SandGrid, area: &Area, cut: &Cut, direction: [f64; 2]) -> Displaced {
        let radius = (self.cut.len() as f64 / core::f64::consts::PI).sqrt();
        let rings = ((RIM_WIDTH * radius).round() as u8).clamp(1, 200);
        let near = cut.bounds.grown(usize::from(rings), area);
        self.rim.clear();
        let mut total = 0.0;
        for ring in 1..=rings {
            let t = (f64::from(ring) - 0.5) / f64::from(rings);
            let r = RIM[0] + t * (RIM[1] - RIM[0]);
            let weight = libm::sin(r * r) - 0.53;
            for y in near.rows[0]..=near.rows[1] {
                for x in near.columns[0]..=near.columns[1] {
                    let at = grid.index(x, y);
                    if self.ring[area.index(x, y)] != 0
                        || !self.touches(area, x, y, ring)
                        || grid.heights[at] >= HIGHEST
                    {
                        continue;
                    }
                    self.ring[area.index(x, y)] = ring + 1;
                    let out = [x as f64 - cut.middle[0], y as f64 - cut.middle[1]];
                    let ahead = (out[0] * direction[0] + out[1] * direction[1])
                        / libm::hypot(out[0], out[1]).max(1.0);
                    total += weight * (1.0 + ahead);
                    self.rim.push((at, total));
                }
            }
        }
        if total <= 0.0 {
            return Displaced::default();
        }
        let mut given = 0;
        for &(at, sum) in &self.rim {
            // Rounded so that the last one brings the sum to what was cut.
            let due = if sum == total { cut.units } else { (cut.units as f64 * (sum / total)) as i64 };
            let part = (due - given).min(i64::from(HIGHEST - grid.heights[at]));
            grid.heights[at] += part as i32;
            given += part;
        }
        // What a heap that is full to the top cannot take stays under the tool.
        for &(at, before) in &self.cut {
            let part = (cut.units - given).min(i64::from(before - grid.heights[at]));
            grid.heights[at] += part as i32;
            given += part;
        }
        Displaced { units: cut.units, columns: near.columns, rows: near.rows }
    }

    /// Tests whether a cell of the box has a neighbour in a ring.
    fn touches(&self, area: &Area, x: usize, y: usize, ring: u8) -> bool {
        let [left, right] = area.columns;
        let [top, bottom] = area.rows;
        (y.max(top + 1) - 1..=(y + 1).min(bottom))
            .any(|y| (x.max(left + 1) - 1..=(x + 1).min(right)).any(|x| self.ring[area.index(x, y)] == ring))
    }
}

/// Cut: its volume, its middle in cells, the cells around it.
struct Cut {
    units: i64,
    middle: [f64; 2],
    bounds: Area,
}

/// A rectangle of cells.
struct Area {
    columns: [usize; 2],
    rows: [usize; 2],
}

impl Area {
    fn include(&mut self, x: usize, y: usize) {
        self.columns = [self.columns[0].min(x), self.columns[1].max(x)];
        self.rows = [self.rows[0].min(y), self.rows[1].max(y)];
    }

    fn grown(&self, by: usize, within: &Self) -> Self {
        let grow = |a: [usize; 2], w: [usize; 2]| [a[0].saturating_sub(by).max(w[0]), (a[1] + by).min(w[1])];
        Self { columns: grow(self.columns, within.columns), rows: grow(self.rows, within.rows) }
    }

    fn width(&self) -> usize {
        self.columns[1] - self.columns[0] + 1
    }

    fn count(&self) -> usize {
        self.width() * (self.rows[1] - self.rows[0] + 1)
    }

    fn index(&self, x: usize, y: usize) -> usize {
        (y - self.rows[0]) * self.width() + x - self.columns[0]
    }
}
