//! `sand = { … }`: a bed of sand and what is dragged through it.

use super::fields::Fields;
use super::pixels::{Pixels, read_channel};
use crate::files::FileError;
use asperity_dsp::limits::{Range, sand as limits};
use std::path::Path;

/// Layers below the top that the engine knows.
const MAX_LAYERS: usize = 4;
/// Width of a tool's picture: both sides of the widest tool.
const TOOL_WIDTH_M: Range = Range::new(2e-4, 0.4, "2e-4 to 0.4 m");
/// Height of white over black in it.
const TOOL_RELIEF_M: Range = Range::above(0.0, 0.4, "above 0, to 0.4 m");

/// Sand.
#[derive(Debug, Clone, PartialEq)]
pub struct Sand {
    /// Cells along u.
    pub cells: u64,
    /// Depth of the bed, m.
    pub depth_m: f64,
    /// Angle of repose, degrees.
    pub talus_deg: f64,
    /// k_s of the repulse force, N.
    pub stiffness_n: f64,
    /// k_c of the repulse force, 1/m.
    pub exponent_per_m: f64,
    /// k_f of the drag, s/m.
    pub drag_s_per_m: f64,
    /// 0 dry – 1 wet; none = the engine's default.
    pub wetness: Option<f64>,
    /// Diameter of a grain, m; none = the engine's default.
    pub grain_m: Option<f64>,
    /// Depth at which a layer begins (m), and its hardness against the top's.
    pub layers: Vec<(f64, f64)>,
    /// What is dragged through it.
    pub tool: Tool,
}

/// What a contact drags.
#[derive(Debug, Clone, PartialEq)]
pub enum Tool {
    /// A sphere of this radius, m.
    Sphere(f64),
    /// Any tool, by a picture of its underside.
    Map {
        /// Grey is height above the tool's lowest point, white is no tool.
        image: Pixels,
        /// Width of the picture, m.
        width_m: f64,
        /// Height of white over black, m.
        relief_m: f64,
    },
}

/// Reads the table.
pub fn read(mut table: Fields, folder: &Path) -> Result<Sand, FileError> {
    let sand = Sand {
        cells: table.whole("cells", 16, 2048)?.unwrap_or(512),
        depth_m: table.number_or("depth_m", 0.05, limits::DEPTH_M)?,
        talus_deg: table.number_or("talus_deg", 30.0, limits::TALUS_DEG)?,
        stiffness_n: table.number_or("stiffness_n", 1_000.0, limits::STIFFNESS_N)?,
        exponent_per_m: table.number_or("exponent_per_m", 1.0, limits::EXPONENT_PER_M)?,
        drag_s_per_m: table.number_or("drag_s_per_m", 20.0, limits::DRAG_S_PER_M)?,
        wetness: table.number("wetness", limits::WETNESS)?,
        grain_m: table.number("grain_m", limits::GRAIN_M)?,
        layers: read_layers(&mut table)?,
        tool: read_tool(&mut table, folder)?,
    };
    table.finish()?;
    Ok(sand)
}

fn read_layers(table: &mut Fields) -> Result<Vec<(f64, f64)>, FileError> {
    let mut layers = Vec::new();
    let mut above_m = 0.0;
    for mut layer in table.tables("layers")? {
        let from_m = layer.needed_number("from_m", Range { low: above_m, ..limits::LAYER_FROM_M })?;
        layers.push((from_m, layer.needed_number("hardness", limits::HARDNESS)?));
        layer.finish()?;
        above_m = from_m;
    }
    if layers.len() > MAX_LAYERS {
        let what = format!("holds {}", layers.len());
        return Err(table.refuse("layers", what, format!("at most {MAX_LAYERS} layers below the top")));
    }
    Ok(layers)
}

fn read_tool(table: &mut Fields, folder: &Path) -> Result<Tool, FileError> {
    let radius_m = table.number("tool_radius_m", limits::TOOL_RADIUS_M)?;
    let Some(mut tool) = table.table("tool")? else {
        return Ok(Tool::Sphere(radius_m.unwrap_or(0.005)));
    };
    if radius_m.is_some() {
        let right = "write one of them; a tool's picture has its own width_m";
        return Err(table.refuse("tool", "stands beside tool_radius_m", right));
    }
    let channel = read_channel(&mut tool, "channel")?;
    let image = Pixels { path: folder.join(tool.needed_text("map")?), channel };
    let width_m = tool.needed_number("width_m", TOOL_WIDTH_M)?;
    let relief_m = tool.needed_number("relief_m", TOOL_RELIEF_M)?;
    tool.finish()?;
    Ok(Tool::Map { image, width_m, relief_m })
}
