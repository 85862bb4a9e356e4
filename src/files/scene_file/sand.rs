//! `sand = { … }`: a bed of sand and what is dragged through it.

use super::fields::Fields;
use super::pixels::{Pixels, read_channel};
use crate::files::FileError;
use crate::parameters::{Parameter, buried, layer, sand, tool};
use asperity_dsp::limits::Range;
use asperity_surface::sand::{Buried, Layer, MAX_BURIED, MAX_LAYERS, SandDesign, SandLaw, Tool};
use std::path::Path;

/// A bed of sand.
#[derive(Debug, Clone, PartialEq)]
pub struct Sand {
    /// Everything but the size, which is the surface's, and the tool, if it is a picture.
    pub design: SandDesign,
    /// Picture of what is dragged through it; none = the design's own.
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
        stiffness_n: table.number_or(&sand::STIFFNESS_N, default.law.stiffness_n)?,
        exponent_per_m: table.number_or(&sand::EXPONENT_PER_M, default.law.exponent_per_m)?,
        drag_s_per_m: table.number_or(&sand::DRAG_S_PER_M, default.law.drag_s_per_m)?,
        wetness: table.number_or(&sand::WETNESS, default.law.wetness)?,
        layers: read_layers(&mut table)?,
        grain_m: table.number_or(&sand::GRAIN_M, default.law.grain_m)?,
        cap_n: table.number_or(&sand::CAP_N, default.law.cap_n)?,
        buried: read_buried(&mut table)?,
        ..default.law
    };
    let (round, tool) = read_tool(&mut table, folder)?;
    let design = SandDesign {
        cells: table.count(&sand::CELLS)?.unwrap_or(default.cells),
        depth_m: table.number_or(&sand::DEPTH_M, default.depth_m)?,
        talus_deg: table.number_or(&sand::TALUS_DEG, default.talus_deg)?,
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
    for (slot, mut written) in layers.iter_mut().zip(written) {
        let from_m = written.needed_number(&Parameter {
            range: Range { low: above_m, ..layer::FROM_M.range },
            ..layer::FROM_M
        })?;
        *slot = Some(Layer { from_m, hardness: written.needed_number(&layer::HARDNESS)? });
        written.finish()?;
        above_m = from_m;
    }
    Ok(layers)
}

fn read_buried(table: &mut Fields) -> Result<[Option<Buried>; MAX_BURIED], FileError> {
    let mut buried = [None; MAX_BURIED];
    let written = table.tables("buried")?;
    if written.len() > MAX_BURIED {
        let what = format!("holds {}", written.len());
        return Err(table.refuse("buried", what, format!("at most {MAX_BURIED} stones and shells")));
    }
    for (slot, mut written) in buried.iter_mut().zip(written) {
        *slot = Some(Buried {
            at_m: [written.needed_number(&buried::U_M)?, written.needed_number(&buried::V_M)?],
            top_m: written.needed_number(&buried::TOP_M)?,
            half_m: [written.needed_number(&buried::HALF_U_M)?, written.needed_number(&buried::HALF_V_M)?],
            height_m: written.needed_number(&buried::HEIGHT_M)?,
            hardness: written.needed_number(&buried::HARDNESS)?,
        });
        written.finish()?;
    }
    Ok(buried)
}

fn read_tool(table: &mut Fields, folder: &Path) -> Result<(Option<Tool>, Option<ToolPicture>), FileError> {
    let radius_m = table.number(&sand::TOOL_RADIUS_M)?;
    let Some(mut picture) = table.table("tool")? else {
        return Ok((radius_m.map(|radius_m| Tool::Sphere { radius_m }), None));
    };
    if radius_m.is_some() {
        let right = "write one of them; a tool's picture has its own width_m";
        return Err(table.refuse("tool", "stands beside tool_radius_m", right));
    }
    let channel = read_channel(&mut picture, "channel")?;
    let image = Pixels { path: folder.join(picture.needed_text("map")?), channel };
    let width_m = picture.needed_number(&tool::WIDTH_M)?;
    let relief_m = picture.needed_number(&tool::RELIEF_M)?;
    picture.finish()?;
    Ok((None, Some(ToolPicture { image, width_m, relief_m })))
}
