//! The sand and the tools dragged through it, one frame (1/60 s) after another.
//!
//! In a frame every contact's tool goes from where it was to where it is now, a cell at a time, in
//! as many parts as there are passes of sliding, so that a fast tool leaves no scallops of a
//! frame's length. Its depth is the one at which the sand carries the contact's normal force
//! (`law`), below the level of the sand around it (the median on a circle outside the heap). Then
//! the sand slides for as many passes as the frame's budget of cells allows; where a tool stands it
//! is a wall, so that nothing trickles into the cut it fills. A contact that was not reported in a
//! frame is lifted.

mod drag;
mod view;

use super::around;
use super::erosion::Erosion;
use super::grid::{SandGrid, SandPicture, UNITS_PER_M, WALL};
use super::law::SandLaw;
pub use super::pose::{FRAMES_PER_S, Pose};
use super::tool::{Press, Tool};
use crate::changed_tiles::ChangedTiles;
use crate::height_field::Setup;
use crate::moving_picture::MovingPicture;
use asperity_dsp::DesignError;
use asperity_dsp::limits::sand as limits;
use drag::{Way, wake_print};
use std::sync::Arc;

/// Passes of sliding in a frame, at most.
pub const PASSES_A_FRAME: usize = 8;
/// Cells looked at in a frame before sliding is put off to the next: about 1 ms.
pub const CELLS_A_FRAME: usize = 400_000;

/// A bed of sand to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct SandDesign {
    /// Extent along u, metres.
    pub width_m: f64,
    /// Extent along v, metres.
    pub height_m: f64,
    /// Cells along u.
    pub cells: usize,
    /// Depth of the untouched sand, metres.
    pub depth_m: f64,
    /// Talus angle of the dry sand, degrees.
    pub talus_deg: f64,
    /// Force law, wetness, layers, grains.
    pub law: SandLaw,
    /// Tool that every contact drags.
    pub tool: Tool,
}

impl Default for SandDesign {
    /// 512 × 512 cells on a quarter of a metre, 50 mm deep, 30°, a fingertip.
    fn default() -> Self {
        Self {
            width_m: 0.25,
            height_m: 0.25,
            cells: 512,
            depth_m: 0.05,
            talus_deg: 30.0,
            law: SandLaw::default(),
            tool: Tool::Sphere { radius_m: 0.005 },
        }
    }
}

/// Figures of the sand for a render.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SandFigures {
    /// Volume when it was made, m³.
    pub volume_before_m3: f64,
    /// Volume now, m³.
    pub volume_after_m3: f64,
    /// Difference of the two in units of the grid: 0, or something is broken.
    pub drift_units: i64,
    /// Steepest slope now, degrees.
    pub max_slope_deg: f64,
    /// Deepest that a tool stood below the untouched bed, metres: what was felt, whatever slid into
    /// the print since.
    pub print_m: f64,
}

/// State of a contact.
#[derive(Debug, Clone, Copy, Default)]
struct Track {
    newest: Option<Pose>,
    pose: Option<Pose>,
    /// Level of the sand around, metres above the bottom.
    level_m: f64,
    /// Radius of the print, metres.
    radius_m: f64,
    displaced_m2: f64,
    way: Option<Way>,
}

/// Sand, its sliding and its tools.
#[derive(Debug, Clone)]
pub struct SandSimulation {
    grid: SandGrid,
    erosion: Erosion,
    law: SandLaw,
    dry_talus_deg: f64,
    tool: Tool,
    depth_m: f64,
    tracks: Vec<Track>,
    presses: Vec<Press>,
    walls: Vec<(usize, i32)>,
    volume_before_units: i64,
    /// Deepest that a tool stood below the untouched bed, metres.
    print_m: f64,
    /// For a program that draws the sand.
    moving_picture: Arc<MovingPicture>,
    /// Part that was not shown yet.
    changed: ChangedTiles,
}

impl SandSimulation {
    /// Flat, untouched sand.
    ///
    /// # Errors
    /// Names the field that is out of its range.
    pub fn new(design: &SandDesign) -> Result<Self, DesignError> {
        design.law.check()?;
        design.tool.check()?;
        limits::SIDE_M.check("width_m", design.width_m)?;
        limits::SIDE_M.check("height_m", design.height_m)?;
        let cells = design.cells.max(1);
        let cell_m = design.width_m / cells as f64;
        let rows = (design.height_m / cell_m).round().min(1e6) as usize;
        let grid = SandGrid::flat(design.cells, rows, cell_m, design.depth_m)?;
        let (columns, rows) = (grid.columns(), grid.rows());
        let reach = design.tool.reach_m() / cell_m;
        DesignError::check("tool_radius_m", reach, "at most 256 cells", |r| r <= 256.0)?;
        // A tool that fits into a cell would leave no groove.
        let narrow = "so many that a cell is no wider than the tool";
        DesignError::check("cells", cells as f64, narrow, |_| 2.0 * reach >= 1.0)?;
        let erosion = Erosion::new(&grid, design.law.talus_deg(design.talus_deg))?;
        let walls = Vec::with_capacity(4 * grid.columns().min(1024));
        let volume_before_units = grid.volume_units();
        let mut sand = Self {
            grid,
            erosion,
            law: design.law.under(design.tool.bearing(), design.tool.tip_radius_m()),
            dry_talus_deg: design.talus_deg,
            tool: design.tool.clone(),
            depth_m: design.depth_m,
            tracks: Vec::new(),
            presses: Vec::new(),
            walls,
            volume_before_units,
            print_m: 0.0,
            moving_picture: MovingPicture::new(columns, rows, cell_m),
            changed: ChangedTiles::all(columns, rows),
        };
        sand.make_room(Setup::default().voices);
        Ok(sand)
    }

    /// Makes room for contacts numbered below `contacts`, if there is less; there is room for those
    /// of [`Setup::default`].
    pub fn make_room(&mut self, contacts: usize) {
        if contacts > self.tracks.len() {
            let track = Track { level_m: self.depth_m, ..Track::default() };
            self.tracks.resize(contacts, track);
            self.presses.resize(contacts, Press::new(&self.tool, &self.grid));
        }
    }

    /// The sand.
    #[must_use]
    pub fn grid(&self) -> &SandGrid {
        &self.grid
    }

    /// Shapes the sand before it is touched (the volume counts from then on).
    pub fn shape(&mut self, height_m: impl FnMut(usize, usize) -> f64) {
        self.grid.fill(height_m);
        self.volume_before_units = self.grid.volume_units();
        self.changed.mark_all();
        self.erosion.activate_all();
    }

    /// Another force law; when the wetness is another, so is the talus angle, and what is now too
    /// steep slides.
    pub fn set_law(&mut self, law: SandLaw) {
        if law.check().is_err() {
            return;
        }
        let talus_deg = law.talus_deg(self.dry_talus_deg);
        if talus_deg != self.law.talus_deg(self.dry_talus_deg)
            && self.erosion.set_talus(&self.grid, talus_deg).is_ok()
        {
            self.erosion.activate_all();
        }
        self.law = law.under(self.tool.bearing(), self.tool.tip_radius_m());
    }

    /// The force law, under its tool.
    #[must_use]
    pub fn law(&self) -> &SandLaw {
        &self.law
    }

    /// Contacts are numbered below this.
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.tracks.len()
    }

    /// Sets where a contact is; the last pose before a frame counts.
    pub fn set_pose(&mut self, pose: Pose) {
        let finite = pose.position_m.iter().chain(&pose.velocity_m_s).all(|x| x.is_finite());
        if let Some(track) = self.tracks.get_mut(pose.contact).filter(|_| finite) {
            let normal_force_n = if pose.normal_force_n.is_finite() { pose.normal_force_n } else { 0.0 };
            let landed = pose.landed || track.newest.is_some_and(|newest| newest.landed);
            track.newest = Some(Pose { normal_force_n: normal_force_n.clamp(0.0, 1e4), landed, ..pose });
        }
    }

    /// Tests whether a contact's tool stands in the sand.
    #[must_use]
    pub fn is_down(&self, contact: usize) -> bool {
        self.tracks.get(contact).is_some_and(|t| t.pose.is_some())
    }

    /// One frame: tools move and sand slides, by turns.
    pub fn frame(&mut self) {
        for contact in 0..self.tracks.len() {
            self.set_out(contact);
        }
        let mut cells = 0;
        for pass in 0..PASSES_A_FRAME {
            for contact in 0..self.tracks.len() {
                self.drag(contact, pass);
            }
            if cells <= CELLS_A_FRAME && !self.erosion.is_settled() {
                self.raise_walls();
                cells += self.erosion.pass(&mut self.grid);
                self.lower_walls();
            }
        }
        for contact in 0..self.tracks.len() {
            self.arrive(contact);
        }
        let (grid, changed) = (&self.grid, &mut self.changed);
        self.erosion.slid(|columns, rows| changed.mark(columns, rows));
        self.moving_picture.write(changed, |column, row| grid.height_m(column, row) as f32);
    }

    /// The sand as it moves, written once a frame.
    #[must_use]
    pub fn moving_picture(&self) -> &Arc<MovingPicture> {
        &self.moving_picture
    }

    /// Lifts all tools and lets the sand slide until nothing moves.
    pub fn settle(&mut self) {
        for (track, press) in self.tracks.iter_mut().zip(&self.presses) {
            if track.pose.take().is_some() {
                wake_print(&mut self.erosion, &self.grid, press);
            }
            track.newest = None;
        }
        self.erosion.settle(&mut self.grid);
    }

    /// Tests whether nothing slides and no tool is down.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.erosion.is_settled() && self.tracks.iter().all(|t| t.pose.is_none() && t.newest.is_none())
    }

    /// Volumes and steepest slope.
    #[must_use]
    pub fn figures(&self) -> SandFigures {
        let after = self.grid.volume_units();
        let m3 = self.grid.cell_m() * self.grid.cell_m() / UNITS_PER_M;
        SandFigures {
            volume_before_m3: self.volume_before_units as f64 * m3,
            volume_after_m3: after as f64 * m3,
            drift_units: after - self.volume_before_units,
            max_slope_deg: self.grid.max_slope_deg(),
            print_m: self.print_m,
        }
    }

    /// A 16-bit picture of the sand.
    #[must_use]
    pub fn picture(&self) -> SandPicture {
        self.grid.picture()
    }

    /// Level of the sand around a print of this radius, metres above the bottom.
    #[must_use]
    pub fn level_m(&self, position_m: [f64; 2], radius_m: f64) -> f64 {
        level_around(&self.grid, position_m, radius_m)
    }

    /// Level that a contact would sink from where it lands, metres above the bottom, and the radius
    /// of its print.
    fn landing(&self, pose: &Pose) -> (f64, f64) {
        let radius_m = self.tool.print_radius_m(self.law.depth_m(pose.normal_force_n));
        (level_around(&self.grid, pose.position_m, radius_m), radius_m)
    }

    /// Makes every tool that is down a wall for the sliding sand.
    fn raise_walls(&mut self) {
        self.walls.clear();
        for (track, press) in self.tracks.iter().zip(&self.presses) {
            if track.pose.is_some() {
                for at in press.cut_cells() {
                    let height = self.grid.heights[at];
                    if height != WALL {
                        self.walls.push((at, height));
                        self.grid.heights[at] = WALL;
                    }
                }
            }
        }
    }

    fn lower_walls(&mut self) {
        for &(at, height) in &self.walls {
            self.grid.heights[at] = height;
        }
    }
}

/// Level of the sand around a place, metres above the bottom.
fn level_around(grid: &SandGrid, at: [f64; 2], radius_m: f64) -> f64 {
    around::level_around(grid.cell_m(), at, radius_m, |at| grid.height_at_m(at))
}
