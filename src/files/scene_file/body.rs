//! `[[body]]`: what rings, what it is made of, and where its sound leaves.

use super::fields::{self, Fields};
use crate::files::FileError;
use crate::model::body::MAX_SENDS;
use crate::model::material::Material;
use crate::model::modal_model::ModalModel;
use crate::model::pickup::Pickup;
use crate::model::stock::Stock;
use crate::parameters;
use asperity_dsp::limits;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Value;

/// A body: what an impact on it sounds like.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyEntry {
    /// Name that surfaces and impacts use.
    pub name: String,
    /// Modes file; none = those of `stock`, or silent.
    pub modes: Option<PathBuf>,
    /// A stock shape and its size, m.
    pub stock: Option<(Stock, f64)>,
    /// A mesh, and its longest side, m; none = as long as it is. Whoever opens the scene solves it.
    pub shape: Option<(PathBuf, Option<f64>)>,
    /// Modes of that mesh, of this material and size: `asperity render` sets them, and a program
    /// with a solver of its own can.
    pub solved: Option<Arc<ModalModel>>,
    /// Material; none = the engine's default.
    pub material: Option<Material>,
    /// True where its modes are as loud as their shapes radiate, in pascals at 1 m.
    pub radiation: bool,
    /// Gain of the residual that its modes file may carry; none = 1, 0 = not played.
    pub residual: Option<f64>,
    /// False where the bands of noise that its modes may carry are not played.
    pub diffuse: bool,
    /// Gain of impacts beside strokes; none = by the level policy.
    pub strike_gain: Option<f64>,
    /// Least time between equally strong impacts that are heard, s; none = 0.
    pub least_time_s: Option<f64>,
    /// Its mass, kg; none = a stock body's own, or unknown.
    pub mass_kg: Option<f64>,
    /// Spread of equal impacts; none = 0.
    pub variation: Option<f64>,
    /// Name of the bus it plays on; none = the first, or those of `sends`.
    pub bus: Option<String>,
    /// Names of the buses it plays on, and how loud on each, linear; empty = on `bus`.
    pub sends: Vec<(String, f64)>,
    /// Pickups on it.
    pub pickups: Vec<Pickup>,
}

/// Reads one `[[body]]`.
pub(super) fn read(mut fields: Fields, folder: &Path) -> Result<BodyEntry, FileError> {
    let name = fields.needed_text("name")?;
    let place = format!("{} \"{name}\"", fields.inner("").trim_end_matches(": "));
    fields.rename(place);
    let modes = fields.file("modes", folder)?;
    let (shape, stock) = read_form(&mut fields, folder)?;
    let body = BodyEntry {
        name,
        modes,
        stock,
        shape,
        solved: None,
        material: read_material(&mut fields, "material")?,
        radiation: fields.flag("radiation")?.unwrap_or(false),
        residual: fields.number(&parameters::body::RESIDUAL)?,
        diffuse: fields.flag("diffuse")?.unwrap_or(true),
        strike_gain: fields.number(&parameters::body::STRIKE_GAIN)?,
        least_time_s: fields.number(&parameters::body::LEAST_TIME_S)?,
        mass_kg: fields.number(&parameters::body::MASS_KG)?,
        variation: fields.number(&parameters::body::VARIATION)?,
        sends: read_sends(&mut fields)?,
        bus: fields.text("bus")?,
        pickups: Vec::new(),
    };
    for (key, is_there) in [("stock", body.stock.is_some()), ("shape", body.shape.is_some())] {
        if body.modes.is_some() && is_there {
            return Err(fields.refuse(key, "stands beside modes", "write one of them"));
        }
    }
    if body.radiation && body.modes.is_none() && body.shape.is_none() {
        let right = "give modes with shapes, or leave it out; a stock body radiates already";
        return Err(fields.refuse("radiation", "stands without modes", right));
    }
    fields.finish()?;
    Ok(body)
}

/// `sends`: a table from buses to gains.
fn read_sends(fields: &mut Fields) -> Result<Vec<(String, f64)>, FileError> {
    let Some(table) = fields.table("sends")? else { return Ok(Vec::new()) };
    let gains = table.numbers_by_name(limits::impact::GAIN)?;
    let audible = |gains: &[(String, f64)]| gains.iter().filter(|(_, gain)| *gain > 0.0).count();
    let most = MAX_SENDS + 1;
    let right = format!("name 1 to {most} buses of [[audio]] with a gain each, one of them above 0");
    if fields.has("bus") {
        return Err(fields.refuse("sends", "stands beside bus", "write one of them"));
    }
    if gains.len() > MAX_SENDS + 1 || audible(&gains) == 0 {
        let what = format!("names {} buses, {} of them above 0", gains.len(), audible(&gains));
        return Err(fields.refuse("sends", what, right));
    }
    Ok(gains)
}

/// A mesh and its longest side, and a stock body and its size, of which a body has one or neither.
type Form = (Option<(PathBuf, Option<f64>)>, Option<(Stock, f64)>);

/// `shape`, which may have a `size_m`, or `stock`, which needs one.
fn read_form(fields: &mut Fields, folder: &Path) -> Result<Form, FileError> {
    let mesh = fields.file("shape", folder)?;
    let stock = fields.word("stock", &Stock::ALL)?;
    let size_m = fields.number(&parameters::body::SIZE_M)?;
    match (mesh, stock, size_m) {
        (Some(_), Some(_), _) => Err(fields.refuse("shape", "stands beside stock", "write one of them")),
        (Some(mesh), None, size_m) => Ok((Some((mesh, size_m)), None)),
        (None, Some(stock), Some(size_m)) => Ok((None, Some((stock, size_m)))),
        (None, Some(_), None) => {
            Err(fields.missing("size_m", "its longest side or its diameter, for instance 0.3"))
        }
        (None, None, Some(_)) => {
            let right = "write stock = \"bar\" or shape = \"body.obj\", or leave it out";
            Err(fields.refuse("size_m", "stands without stock or shape", right))
        }
        (None, None, None) => Ok((None, None)),
    }
}

/// A preset's name, or a table of constants: elastic ones, and what else differs from the default
/// material.
pub(super) fn read_material(fields: &mut Fields, key: &'static str) -> Result<Option<Material>, FileError> {
    let table = match fields.take(key) {
        None => return Ok(None),
        Some(Value::String(name)) => {
            let unknown = || {
                let right = format!("must be one of: {}, or a table of constants", Material::names());
                fields.refuse(key, format!("\"{name}\" is unknown"), right)
            };
            return Material::by_name(&name).map(Some).ok_or_else(unknown);
        }
        Some(Value::Table(table)) => table,
        Some(other) => {
            let what = format!("{} is not a material", fields::shown(&other));
            let right = "write a preset's name, or { young_pa = …, poisson = …, density_kg_m3 = … }";
            return Err(fields.refuse(key, what, right));
        }
    };
    use parameters::material as of;
    let mut fields = Fields::new(table, fields.inner(key));
    let young_pa = fields.needed_number(&of::YOUNG_PA)?;
    let poisson = fields.needed_number(&of::POISSON)?;
    let other = Material::new(young_pa, poisson, fields.needed_number(&of::DENSITY_KG_M3)?);
    let material = Material {
        alpha_per_s: fields.number_or(&of::ALPHA_PER_S, other.alpha_per_s)?,
        eta: fields.number_or(&of::ETA, other.eta)?,
        beta_s: fields.number_or(&of::BETA_S, other.beta_s)?,
        mu_static: fields.number_or(&of::MU_STATIC, other.mu_static)?,
        mu_kinetic: fields.number_or(&of::MU_KINETIC, other.mu_kinetic)?,
        roughness: fields.number_or(&of::ROUGHNESS, other.roughness)?,
        micro_relief_m: fields.number_or(&of::MICRO_RELIEF_M, other.micro_relief_m)?,
        ..other
    };
    fields.finish()?;
    Ok(Some(material))
}
