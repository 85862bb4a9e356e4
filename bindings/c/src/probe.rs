//! Probes: what touches, beside the engine's own fingertip.

use crate::body::refused;
use crate::entry::{enter, out};
use crate::handles::{SCENES, asp_scene};
use crate::status::{ASP_REFUSED, Failure};
use crate::text;
use asperity::Scene;
use std::ffi::c_char;

/// Adds a probe and gives its id, which is never 0. `table` is what a scene file's `[[probe]]`
/// says, TOML: preset = "stylus" (fingertip, fingernail, stylus, sole, rigid), and what differs
/// from it. `name` may be NULL. It stays as long as the scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_add_probe(
    scene: *mut asp_scene,
    table: *const c_char,
    name: *const c_char,
    id: *mut u64,
) -> i32 {
    enter(|| {
        let (table, name) = (text::needed(table, "table")?, text::optional(name, "name")?);
        let id = out(id, "id")?;
        *id = 0;
        let mut half = SCENES.hold(scene as usize)?;
        let probe = Scene::read_probe(table).map_err(|error| Failure::new(ASP_REFUSED, error))?;
        let new = half.scene.add_probe(probe).map_err(|error| refused(&error))?;
        if let Some(name) = name {
            half.names.probes.insert(name.into(), new);
        }
        *id = new.to_bits();
        Ok(())
    })
}
