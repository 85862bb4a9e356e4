//! From what a scene file says of bodies, surfaces and actuators to what the engine takes.

pub(crate) use super::loader::Loader;
use super::maps::{MapOf, Values};
use super::source::Ground;
use crate::files::actuator_profile::ActuatorPreset;
use crate::files::contact_log::{LogSurface, Names};
use crate::files::scene_file::{ActuatorEntry, AudioEntry, BodyEntry, RoughnessEntry, Source, SurfaceEntry};
use crate::files::{FileError, Files};
use crate::model::actuator::{ActuatorSettings, DeviceProfile, FELT_FORCE_EXPONENT, Quantity};
use crate::model::body::{Body, Sends};
use crate::model::bus::BusId;
use crate::model::material::Material;
use crate::model::modal_model::ModalModel;
use crate::model::mode_shapes::Unit;
use crate::model::surface::{Roughness, Surface};
use asperity_surface::height_map::Extent;
use asperity_surface::wrap::Wrap;
use std::path::Path;

impl<'a> Loader<'a> {
    /// A body, on the bus that it names; its impacts are as loud as it says, or else as
    /// `strike_gain` does.
    pub fn body(
        &self,
        entry: &BodyEntry,
        audio: &[AudioEntry],
        gains: &[f64],
        strike_gain: f64,
    ) -> Result<Body, FileError> {
        let material = entry.material.unwrap_or(Body::DEFAULT_MATERIAL);
        let mut model = match (&entry.modes, &entry.solved, entry.stock) {
            (Some(path), _, _) => ModalModel::load_from(self.files, path).map_err(FileError::from_error)?,
            (None, Some(solved), _) => solved.as_ref().clone(),
            (None, None, Some((shape, size_m))) => {
                shape.modes(&material, size_m).map_err(FileError::from_error)?
            }
            (None, None, None) => ModalModel::silent(),
        };
        if let (Some((mesh, _)), None) = (&entry.shape, &entry.solved) {
            let what = format!("{} is a mesh, which the engine does not solve", mesh.display());
            let right = "run `asperity modes` on it, and write modes = \"NAME.modes.json\"";
            return Err(FileError::new(format!("body \"{}\": shape", entry.name), what, right));
        }
        if entry.radiation {
            let placed = |error| FileError::from_error(error).within(format!("body \"{}\"", entry.name));
            model = model.radiating(&material).map_err(placed)?;
        }
        if !entry.diffuse {
            model.diffuse = None;
        }
        if let Some(gain) = entry.residual {
            let residual = model.residual.take();
            model = model.with_residual(residual, gain).map_err(FileError::from_error)?;
        }
        let on = entry.plays_on(audio);
        let (bus, gain) = on[0];
        if let Some(pascals) = audio.get(bus).and_then(|bus| bus.pascals_at_full_scale)
            && model.unit == Unit::PascalsAtOneMetre
        {
            // A gain that nobody wrote is there for the other bodies of the bus.
            let found = gains.get(bus).filter(|_| audio[bus].gain.is_none());
            let policy = found.filter(|gain| **gain > 0.0).unwrap_or(&1.0);
            model = model.with_gain(1.0 / (pascals * policy)).map_err(FileError::from_error)?;
        }
        let stock_kg = || entry.stock.map(|(shape, size_m)| shape.mass_kg(&material, size_m));
        let body = Body::new(model).material(material).bus(BusId(bus));
        let strike_gain = Some(entry.strike_gain.unwrap_or(strike_gain));
        // The gain of a body counts on all of its buses.
        let further = on[1..].iter().map(|(bus, share)| Some((*bus, share / gain)));
        let mut sends = Sends::default();
        sends.iter_mut().zip(further).for_each(|(send, further)| *send = further);
        let (least_time_s, variation) = (entry.least_time_s.unwrap_or(0.0), entry.variation.unwrap_or(0.0));
        let (mass_kg, pickups) = (entry.mass_kg.or_else(stock_kg), entry.pickups.clone());
        Ok(Body { mass_kg, strike_gain, least_time_s, pickups, gain, sends, variation, ..body })
    }

    /// Settings that all sources of a surface share.
    pub fn ground(&self, entry: &SurfaceEntry) -> Ground<'a> {
        let extent = Extent { width_m: entry.width_m, height_m: entry.height_m, relief_m: 1.0 };
        Ground { maker: *self, extent, wrap: entry.wrap, frame: entry.frame }
    }

    /// A surface, on the body that it names. On one of a `material` that the scene names it has
    /// that material's finish where it says nothing else.
    pub fn surface(
        &self,
        entry: &SurfaceEntry,
        material: Option<Material>,
        names: &Names,
    ) -> Result<Surface, FileError> {
        let ground = self.ground(entry);
        let source = ground.source(&entry.source)?;
        let surface =
            Surface::from_source(source, entry.width_m, entry.height_m).map_err(FileError::from_error)?;
        let surface = match (material, &entry.source) {
            (Some(material), Source::Flat) => surface.material(material),
            // How rough a pictured surface is, its material does not say: it may be glazed or
            // sanded.
            (Some(material), Source::Map { .. } | Source::Lattice(_)) => {
                surface.material(material).roughness(Roughness::FromSource)
            }
            // Other sources bring a finish of their own.
            _ => surface,
        };
        // A solid in a body is cut from a block that goes on: another uv is another place.
        let in_block = entry.frame.is_some() && matches!(entry.source, Source::Solid { .. });
        let mut surface = surface
            .wraps(entry.wrap != Wrap::Clamp && !in_block)
            .at_strike_position(entry.strike_position)
            .excitation(entry.excitation);
        if let Some(roughness) = self.roughness(entry, ground.extent)? {
            surface = surface.roughness(roughness);
        }
        if let Some(rms_m) = entry.micro_relief_m {
            surface = surface.micro_relief_m(rms_m);
        }
        if let Some(outer_scale_m) = entry.outer_scale_m {
            surface = surface.outer_scale_m(outer_scale_m);
        }
        if let Some(gains_db) = entry.micro_relief_octaves_db {
            surface = surface.micro_relief_octaves_db(gains_db);
        }
        if let Some(long_waves) = entry.long_waves {
            surface = surface.long_waves(long_waves);
        }
        if let Some(frame) = entry.frame {
            surface = surface.frame(frame);
        }
        surface.stick_slip = entry.stick_slip;
        if let Some(friction) = entry.friction {
            surface = surface.friction(friction);
        }
        if let Some(compliance_m_n) = entry.compliance_m_n {
            surface = surface.compliance_m_n(compliance_m_n);
        }
        let (table, folder) = &entry.written;
        let folder = Some(folder.display().to_string()).filter(|folder| !folder.is_empty());
        surface.described = Some(Box::new(LogSurface { is: Some(table.clone()), folder, material }));
        let body = entry.body.as_ref().and_then(|name| names.bodies.get(name));
        Ok(match body {
            Some(body) => surface.body(*body),
            None => surface,
        })
    }

    fn roughness(&self, entry: &SurfaceEntry, extent: Extent) -> Result<Option<Roughness>, FileError> {
        Ok(match &entry.roughness {
            RoughnessEntry::Number(r) => r.map(Roughness::Constant),
            RoughnessEntry::Map { image, gloss } => {
                let (image, invert, wrap) = (image.clone(), *gloss, entry.wrap);
                let map = MapOf { image, values: Values::AsTheyAre, invert, extent, wrap };
                Some(Roughness::Map(Box::new(self.maps.get(map, self.files)?)))
            }
        })
    }
}

/// An actuator of the scene that lies at `scene`.
pub(crate) fn actuator(
    files: &dyn Files,
    entry: &ActuatorEntry,
    full_scale: f64,
    scene: &Path,
) -> Result<ActuatorSettings, FileError> {
    let folder = scene.parent().unwrap_or(Path::new(""));
    Ok(ActuatorSettings {
        full_scale,
        felt_force_exponent: felt_force_exponent(entry),
        limit_peaks: entry.limit_peaks.unwrap_or(entry.full_scale.is_none() && entry.limit.is_none()),
        equalise: device(files, "equalise", entry.equalise.as_deref(), folder)?,
        limit: device(files, "limit", entry.limit.as_deref(), folder)?,
        ..entry.settings
    })
}

/// Exponent of a finger's displacement over what presses: metres that a scene writes are the pad's
/// own.
pub(crate) fn felt_force_exponent(entry: &ActuatorEntry) -> f64 {
    let by_policy = entry.full_scale.is_none() && entry.settings.output == Quantity::Displacement;
    entry.felt_force_exponent.unwrap_or(if by_policy { FELT_FORCE_EXPONENT } else { 0.0 })
}

/// A shipped profile by name, or a profile's file, relative to the scene's.
fn device(
    files: &dyn Files,
    field: &str,
    name: Option<&str>,
    folder: &Path,
) -> Result<Option<DeviceProfile>, FileError> {
    let Some(name) = name else { return Ok(None) };
    if let Some(preset) = ActuatorPreset::by_name(name) {
        return Ok(Some(preset.profile));
    }
    let at = format!("actuator: {field}");
    if Path::new(name).extension().is_some_and(|ending| ending == "toml") {
        let preset = ActuatorPreset::load_from(files, folder.join(name));
        return preset
            .map(|preset| Some(preset.profile))
            .map_err(|error| FileError::from_error(error).within(at));
    }
    let right = format!("must be none, a profile's file (NAME.toml) or one of: {}", ActuatorPreset::names());
    Err(FileError::new(at, format!("\"{name}\" is unknown"), right))
}
