//! Surfaces: what is touched.

use crate::body::{refused, table_of, written};
use crate::entry::{enter, out};
use crate::files::{Given, asp_files};
use crate::handles::{SCENES, SceneHalf, asp_scene};
use crate::image::{self, asp_image, picture};
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, ASP_REFUSED, Failure};
use crate::text;
use asperity::load::{Overrides, ReadSurface};
use asperity::surface::sand::SandWorker;
use asperity::{BodyId, Surface, SurfaceId};
use std::ffi::c_char;
use std::path::Path;
use toml::Value;

/// Beyond uv 0 to 1 it repeats.
pub const ASP_WRAP_REPEAT: u32 = 0;
/// Beyond its edge it is as at the edge.
pub const ASP_WRAP_CLAMP: u32 = 1;
/// Every second tile is mirrored.
pub const ASP_WRAP_MIRROR: u32 = 2;

/// Grey, or the luma of a colour picture.
pub const ASP_CHANNEL_LUMA: u32 = 0;
/// Red.
pub const ASP_CHANNEL_R: u32 = 1;
/// Green.
pub const ASP_CHANNEL_G: u32 = 2;
/// Blue.
pub const ASP_CHANNEL_B: u32 = 3;
/// Alpha.
pub const ASP_CHANNEL_A: u32 = 4;

/// A surface; `asp_surface_init` fills it. A number that is NAN is not told: then `table`, the
/// body's material or the engine's default says it. Without `heights` and without a source in
/// `table` it is a plane with the finish of its body's material.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_surface {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// ASP_WRAP_…
    pub wrap: u32,
    /// The body that rings when it is touched; 0 = none, or the one that `table` names.
    pub body: u64,
    /// Name in `asp_find`, logs and recordings; NULL = none.
    pub name: *const c_char,
    /// Span of uv 0 to 1 along u, m.
    pub width_m: f64,
    /// Span of uv 0 to 1 along v, m.
    pub height_m: f64,
    /// Height of a sample of full scale (255, 65535 or 1.0) above 0, m; 1 if the heights are
    /// metres.
    pub relief_m: f64,
    /// Displacement map.
    pub heights: asp_image,
    /// Roughness map, 0 to 1.
    pub roughness_map: asp_image,
    /// Which samples of a pixel of `heights`: ASP_CHANNEL_…
    pub heights_channel: u32,
    /// Which samples of a pixel of `roughness_map`: ASP_CHANNEL_…
    pub roughness_channel: u32,
    /// Roughness 0 to 1, the same everywhere, where there is no map.
    pub roughness: f64,
    /// Rms of the micro-relief in the octave about 1 mm at roughness 1, m.
    pub micro_relief_m: f64,
    /// Coulomb friction of the force.
    pub friction: f64,
    /// Compliance, m/N; 0 = hard.
    pub compliance_m_n: f64,
    /// Keys of a scene file's `[[surface]]`, TOML: solid = "granite", sand = { … }, files of maps,
    /// …; the fields above count more.
    pub table: *const c_char,
    /// Place of the files that `table` names; NULL = the disk.
    pub files: *const asp_files,
}

sized!(asp_surface, |zeroed| Self {
    width_m: f64::NAN,
    height_m: f64::NAN,
    relief_m: f64::NAN,
    heights: image::NONE,
    roughness_map: image::NONE,
    roughness: f64::NAN,
    micro_relief_m: f64::NAN,
    friction: f64::NAN,
    compliance_m_n: f64::NAN,
    ..zeroed
});

/// Names of what lies in memory, as the table calls it.
const HEIGHTS: &str = "heights";
const ROUGHNESS: &str = "roughness_map";

fn word(name: &str, words: &[&'static str], number: u32) -> Result<&'static str, Failure> {
    words.get(number as usize).copied().ok_or_else(|| {
        let right = format!("must be 0 to {}: {}", words.len() - 1, words.join(", "));
        Failure::new(ASP_BAD_ARGUMENT, format!("{name}: {number} is refused; {right}"))
    })
}

impl asp_surface {
    fn engines(&self, half: &SceneHalf) -> Result<ReadSurface, Failure> {
        let mut given = Given::new(self.files)?;
        let mut table = table_of(text::optional(self.table, "table")?, "table")?;
        let mut say = |key: &str, value: Value| table.insert(key.into(), value);
        let numbers = [
            ("width_m", self.width_m),
            ("height_m", self.height_m),
            ("relief_m", self.relief_m),
            ("roughness", self.roughness),
            ("micro_relief_m", self.micro_relief_m),
            ("friction", self.friction),
            ("compliance_m_n", self.compliance_m_n),
        ];
        for (key, number) in numbers.into_iter().filter(|(_, number)| !number.is_nan()) {
            say(key, Value::Float(number));
        }
        let wrap = word("wrap", &["repeat", "clamp", "mirror"], self.wrap)?;
        if self.wrap != ASP_WRAP_REPEAT {
            say("wrap", Value::String(wrap.into()));
        }
        let maps = [
            ("displacement", "channel", HEIGHTS, &self.heights, self.heights_channel),
            ("roughness", "roughness_channel", ROUGHNESS, &self.roughness_map, self.roughness_channel),
        ];
        for (key, channel_key, path, image, channel) in maps {
            let channel = word(channel_key, &["luma", "r", "g", "b", "a"], channel)?;
            if image.samples.is_null() && image.width == 0 && image.height == 0 {
                continue;
            }
            given.memory.add_picture(path, picture(image, path)?);
            say(key, Value::String(path.into()));
            say(channel_key, Value::String(channel.into()));
        }
        if let Some(name) = text::optional(self.name, "name")? {
            say("name", Value::String(name.into()));
        }
        let on = Some(self.body).filter(|id| *id != 0).map(BodyId::from_bits);
        let overrides = Overrides { files: &given, live: half.live, ..Overrides::default() };
        let read = half.scene.read_surface(&written(&table)?, Path::new(""), on, &half.names, &overrides);
        read.map_err(|error| Failure::new(ASP_REFUSED, error))
    }

    /// Makes the surface, puts it into the scene, and lets its sand run.
    fn put<T>(
        &self,
        half: &mut SceneHalf,
        put: impl FnOnce(&mut SceneHalf, Surface) -> Result<T, asperity::AddError>,
    ) -> Result<T, Failure> {
        let ReadSurface { surface, workers, .. } = self.engines(half)?;
        let done = put(half, surface).map_err(|error| refused(&error))?;
        half.sand.extend(workers.into_iter().map(SandWorker::spawn));
        Ok(done)
    }
}

/// Fills a surface with its size and the defaults; its width and height have to be told.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_surface_init(surface: *mut asp_surface) {
    sized::init(surface);
}

/// Adds a surface and gives its id, which is never 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_add_surface(
    scene: *mut asp_scene,
    surface: *const asp_surface,
    id: *mut u64,
) -> i32 {
    enter(|| {
        let (surface, id) = (sized::read(surface, "surface")?, out(id, "id")?);
        *id = 0;
        let mut half = SCENES.hold(scene as usize)?;
        let new = surface.put(&mut half, |half, made| half.scene.add_surface(made))?;
        if let Some(name) = text::optional(surface.name, "name")? {
            half.names.surfaces.insert(name.into(), new);
        }
        *id = new.to_bits();
        Ok(())
    })
}

/// Changes a surface under the contacts that slide on it, without a click. Its name stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_replace_surface(
    scene: *mut asp_scene,
    id: u64,
    surface: *const asp_surface,
) -> i32 {
    enter(|| {
        let surface = sized::read(surface, "surface")?;
        let mut half = SCENES.hold(scene as usize)?;
        let id = SurfaceId::from_bits(id);
        surface.put(&mut half, |half, made| half.scene.replace_surface(id, made))
    })
}

/// Takes a surface away; contacts on it fade. Its id is refused from then on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_remove_surface(scene: *mut asp_scene, id: u64) -> i32 {
    enter(|| {
        let mut half = SCENES.hold(scene as usize)?;
        let id = SurfaceId::from_bits(id);
        half.scene.remove_surface(id).map_err(|error| refused(&error))?;
        half.names.surfaces.retain(|_, known| *known != id);
        Ok(())
    })
}
