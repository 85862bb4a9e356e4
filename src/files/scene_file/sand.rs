//! `sand = { … }`: a bed of sand and what is dragged through it.

use super::fields::Fields;
use super::pixels::{Pixels, read_channel};
use crate::files::FileError;
use asperity_dsp::limits::{Range, sand as limits};
use asperity_texture::sand::{Layer, MAX_LAYERS, SandDesign, SandLaw, Tool};
use std::path::Path;

/// Width of a tool's picture: both sides of the widest tool.
const TOOL_WIDTH_M: Range = Range::new(2e-4, 0.4, "2e-4 to 0.4 m");
/// Height of white over black in it.
const TOOL_RELIEF_M: Range = Range::above(0.0, 0.4, "above 0, to 0.4 m");

/// A bed of sand.
#[derive(Debug, Clone, PartialEq)]
pub struct Sand {
    /// Everything but the size, which is the surface's, and the tool, if it is a picture.
    pub design: SandDesign,
    /// What is dragged through it, by its picture; none = the design's own.
    pub tool: Option<ToolPicture>,
}

/// Any tool, by a picture of its underside.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolPicture {
    /// Grey is height above the tool's lowest point, white is no tool.
    pub image: Pixels,
    /// Width of the picture, m.
    pub width_m: f64,
    /// Height of white over black, m.
    pub relief_m: f64,
}

/// Reads the table.
pub fn read(mut table: Fields, folder: &Path) -> Result<Sand, FileError> {
    let default = SandDesign::default();
    let law = SandLaw {
        stiffness_n: table.number_or("stiffness_n", default.law.stiffness_n, limits::STIFFNESS_N)?,
        exponent_per_m: table.number_or(
            "exponent_per_m",
            default.law.exponent_per_m,
            limits::EXPONENT_PER_M,
        )?,
        drag_s_per_m: table.number_or("drag_s_per_m", default.law.drag_s_per_m, limits::DRAG_S_PER_M)?,
        wetness: table.number_or("wetness", default.law.wetness, limits::WETNESS)?,
        layers: read_layers(&mut table)?,
        grain_m: table.number_or("grain_m", default.law.grain_m, limits::GRAIN_M)?,
    };
    let (round, tool) = read_tool(&mut table, folder)?;
    let design = SandDesign {
        cells: table.whole("cells", 16, 2048)?.map_or(default.cells, |cells| cells as usize),
        depth_m: table.number_or("depth_m", default.depth_m, limits::DEPTH_M)?,
        talus_deg: table.number_or("talus_deg", default.talus_deg, limits::TALUS_DEG)?,
        tool: round.unwrap_or_else(|| default.tool.clone()),
        law,
        ..default
    };
    table.finish()?;
    Ok(Sand { design, tool })
}

fn read_layers(table: &mut Fields) -> Result<[Option<Layer>; MAX_LAYERS], FileError> {
    let (mut layers, mut above_m) = ([None; MAX_LAYERS], 0.0);
    let written = table.tables("layers")?;
    if written.len() > MAX_LAYERS {
        let what = format!("holds {}", written.len());
        return Err(table.refuse("layers", what, format!("at most {MAX_LAYERS} layers below the top")));
    }
    for (slot, mut layer) in layers.iter_mut().zip(written) {
        let from_m = layer.needed_number("from_m", Range { low: above_m, ..limits::LAYER_FROM_M })?;
        *slot = Some(Layer { from_m, hardness: layer.needed_number("hardness", limits::HARDNESS)? });
        layer.finish()?;
        above_m = from_m;
    }
    Ok(layers)
}

fn read_tool(table: &mut Fields, folder: &Path) -> Result<(Option<Tool>, Option<ToolPicture>), FileError> {
    let radius_m = table.number("tool_radius_m", limits::TOOL_RADIUS_M)?;
    let Some(mut tool) = table.table("tool")? else {
        return Ok((radius_m.map(|radius_m| Tool::Sphere { radius_m }), None));
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
    Ok((None, Some(ToolPicture { image, width_m, relief_m })))
}
