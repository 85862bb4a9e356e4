//! Bodies: what rings.

use crate::entry::{array, enter, out};
use crate::files::{Given, asp_files};
use crate::handles::{SCENES, SceneHalf, asp_scene};
use crate::material;
use crate::sized::{self, sized};
use crate::status::{ASP_BAD_ARGUMENT, ASP_REFUSED, Failure};
use crate::text;
use asperity::load::Overrides;
use asperity::{AddError, Body, BodyId, BusId, ModalModel, Mode};
use std::ffi::c_char;
use std::mem::offset_of;
use std::path::Path;
use toml::{Table, Value};

/// Most modes of a body.
const MAX_MODES: usize = 65_536;
/// Name of modes that a program has in memory.
const MODES: &str = "asp_body.modes.json";

/// A mode: amplitude · e^(−decay_per_s · t) · sin(2π · frequency_hz · t + phase_rad).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_mode {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Decay, 1/s.
    pub decay_per_s: f64,
    /// Amplitude after the impulse that the body's modes are given for.
    pub amplitude: f64,
    /// Phase at the onset, rad.
    pub phase_rad: f64,
}

/// A body; `asp_body_init` fills it. Its modes are one of `stock`, `modes`, `modes_json` and those
/// that `table` names; none = silent.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_body {
    /// Size of this struct, bytes.
    pub struct_size: u32,
    /// Material: ASP_MATERIAL_…
    pub material: u32,
    /// Audio bus on which it sounds, from 0.
    pub bus: u32,
    /// Number of `modes`.
    pub mode_count: u32,
    /// Gain, linear, 0 to 1000.
    pub gain: f64,
    /// Name in `asp_find`, logs and recordings; NULL = none.
    pub name: *const c_char,
    /// A stock shape: "bar", "tube", "ring", "plate", "disc", "bowl", "block", "box", "can",
    /// "bottle", "pan", "barrel" or "door".
    pub stock: *const c_char,
    /// Longest side or diameter of the stock shape, m.
    pub size_m: f64,
    /// Modes as numbers.
    pub modes: *const asp_mode,
    /// The strike that `modes` is the answer to, N·s.
    pub impulse_n_s: f64,
    /// The text of a modes file.
    pub modes_json: *const c_char,
    /// Keys of a scene file's `[[body]]`, TOML: a file of modes, a material's constants, …; the
    /// fields above count more.
    pub table: *const c_char,
    /// Place of the files that `table` names; NULL = the disk.
    pub files: *const asp_files,
    /// Gain of impacts relative to strokes, linear, 0 to 1000, 1 = as mechanics says; NAN = as
    /// `table` says, else as the level policy has found for the bodies of a scene file, else 1.
    /// (Since 0.1.1.)
    pub strike_gain: f64,
}

sized!(asp_body, [offset_of!(asp_body, strike_gain)], |zeroed| Self {
    gain: 1.0,
    impulse_n_s: 1.0,
    strike_gain: f64::NAN,
    ..zeroed
});

/// Status of a refusal to add.
pub(crate) fn refused(error: &AddError) -> Failure {
    use crate::status::{ASP_FULL, ASP_UNKNOWN};
    let status = match error {
        AddError::Full { .. } | AddError::QueueFull => ASP_FULL,
        AddError::Unknown(_) | AddError::UnknownBus { .. } => ASP_UNKNOWN,
        _ => ASP_REFUSED,
    };
    Failure::new(status, error)
}

/// The keys of a table that a program gives as text, to which fields are added.
pub(crate) fn table_of(text: Option<&str>, name: &str) -> Result<Table, Failure> {
    let Some(text) = text else { return Ok(Table::new()) };
    text.parse().map_err(|error: toml::de::Error| {
        let what = error.message().replace('\n', " ");
        Failure::new(ASP_REFUSED, format!("{name}: {what}; write keys of a scene file, as TOML"))
    })
}

/// The text of a table.
pub(crate) fn written(table: &Table) -> Result<String, Failure> {
    toml::to_string(table).map_err(|error| Failure::new(ASP_REFUSED, error))
}

impl asp_body {
    fn engines(&self, half: &SceneHalf) -> Result<Body, Failure> {
        let mut given = Given::new(self.files)?;
        let mut table = table_of(text::optional(self.table, "table")?, "table")?;
        if let Some(stock) = text::optional(self.stock, "stock")? {
            table.insert("stock".into(), Value::String(stock.into()));
            table.insert("size_m".into(), Value::Float(self.size_m));
        }
        if let Some(material) = material::name(self.material)? {
            table.insert("material".into(), Value::String(material.into()));
        }
        if let Some(json) = self.modes_json()? {
            if table.contains_key("modes") {
                let what = "table: modes stands beside modes of the struct; give one of them";
                return Err(Failure::new(ASP_BAD_ARGUMENT, what));
            }
            given.memory.add(MODES, json);
            table.insert("modes".into(), Value::String(MODES.into()));
        }
        if let Some(name) = text::optional(self.name, "name")? {
            table.insert("name".into(), Value::String(name.into()));
        }
        let overrides = Overrides { files: &given, live: half.live, ..Overrides::default() };
        let body = half.scene.read_body(&written(&table)?, Path::new(""), &overrides);
        let body = body.map_err(|error| Failure::new(ASP_REFUSED, error))?;
        let body = body.bus(BusId(self.bus as usize)).gain(self.gain);
        Ok(if self.strike_gain.is_nan() { body } else { body.strike_gain(self.strike_gain) })
    }

    /// Modes that are given in memory, as the text of a modes file.
    fn modes_json(&self) -> Result<Option<String>, Failure> {
        let json = text::optional(self.modes_json, "modes_json")?;
        match (json, self.mode_count) {
            (Some(json), 0) => Ok(Some(json.into())),
            (None, 0) => Ok(None),
            (Some(_), _) => {
                Err(Failure::new(ASP_BAD_ARGUMENT, "modes_json: stands beside modes; give one of them"))
            }
            (None, count) => {
                let modes = array(self.modes, count as usize, MAX_MODES, "modes")?;
                let modes = modes.iter().map(|mode| Mode {
                    frequency_hz: mode.frequency_hz,
                    decay_per_s: mode.decay_per_s,
                    amplitude: mode.amplitude,
                    phase_rad: mode.phase_rad,
                });
                let model = ModalModel::new(modes.collect(), self.impulse_n_s);
                model.map(|model| Some(model.to_json())).map_err(|error| Failure::new(ASP_REFUSED, error))
            }
        }
    }
}

/// Fills a body of `size` bytes, sizeof(asp_body), with that size and the defaults. A size that
/// never was fills nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_init_body(body: *mut asp_body, size: u32) {
    sized::init_as(body, size);
}

/// Fills the shorter body of programs that were compiled with 0.1.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_body_init(body: *mut asp_body) {
    sized::init_as(body, <asp_body as sized::Sized32>::SHIPPED[0]);
}

/// Adds a body and gives its id, which is never 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_add_body(scene: *mut asp_scene, body: *const asp_body, id: *mut u64) -> i32 {
    enter(|| {
        let (body, id) = (sized::read(body, "body")?, out(id, "id")?);
        *id = 0;
        let mut half = SCENES.hold(scene as usize)?;
        let made = body.engines(&half)?;
        let new = half.scene.add_body(made).map_err(|error| refused(&error))?;
        if let Some(name) = text::optional(body.name, "name")? {
            half.names.bodies.insert(name.into(), new);
        }
        *id = new.to_bits();
        Ok(())
    })
}

/// Gives a body other modes, material, bus and gain while it sounds; what rings rings out under the
/// new. Its name stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_replace_body(scene: *mut asp_scene, id: u64, body: *const asp_body) -> i32 {
    enter(|| {
        let body = sized::read(body, "body")?;
        let mut half = SCENES.hold(scene as usize)?;
        let made = body.engines(&half)?;
        half.scene.replace_body(BodyId::from_bits(id), made).map_err(|error| refused(&error))
    })
}

/// Takes a body away; it rings out until it sleeps. Its id is refused from then on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_remove_body(scene: *mut asp_scene, id: u64) -> i32 {
    enter(|| {
        let mut half = SCENES.hold(scene as usize)?;
        let id = BodyId::from_bits(id);
        half.scene.remove_body(id).map_err(|error| refused(&error))?;
        half.names.bodies.retain(|_, known| *known != id);
        Ok(())
    })
}

/// Lets a body sound on another bus, without a click.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_body_bus(scene: *mut asp_scene, id: u64, bus: u32) -> i32 {
    enter(|| {
        let mut half = SCENES.hold(scene as usize)?;
        half.scene.set_body_bus(BodyId::from_bits(id), BusId(bus as usize)).map_err(|error| refused(&error))
    })
}

/// Lets a body sound on a bus beside its own, so loud, linear, 0 to 1000, without a step; 0 for no
/// longer. At most four: a bus for each listener.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_body_send(scene: *mut asp_scene, id: u64, bus: u32, gain: f64) -> i32 {
    enter(|| {
        let mut half = SCENES.hold(scene as usize)?;
        half.scene
            .set_body_send(BodyId::from_bits(id), BusId(bus as usize), gain)
            .map_err(|error| refused(&error))
    })
}

/// Makes a body louder or softer, linear, 0 to 1000, without a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_set_body_gain(scene: *mut asp_scene, id: u64, gain: f64) -> i32 {
    enter(|| {
        let mut half = SCENES.hold(scene as usize)?;
        half.scene.set_body_gain(BodyId::from_bits(id), gain).map_err(|error| refused(&error))
    })
}
