//! Load: an engine from a scene file, and the ids of what it names.

use crate::config::{ASP_MAX_CHANNELS, asp_config, hand_out, within};
use crate::entry::{enter, out};
use crate::files::{Given, asp_files};
use crate::handles::{SCENES, SceneHalf, asp_renderer, asp_scene};
use crate::pickup::ASP_MAX_PICKUPS;
use crate::sized;
use crate::status::{ASP_BAD_ARGUMENT, ASP_FILE, ASP_REFUSED, ASP_UNKNOWN, Failure};
use crate::text;
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::surface::sand::SandWorker;
use asperity::{ClockMode, Engine};
use std::ffi::c_char;
use std::path::Path;

/// A surface.
pub const ASP_SURFACE: u32 = 1;
/// A body.
pub const ASP_BODY: u32 = 2;
/// A probe.
pub const ASP_PROBE: u32 = 3;

/// Builds the engine of a scene file. `text` NULL: `path` is read from `files`; else `text` is the
/// scene, and `path` says only where it would lie. `files` NULL: the disk. Of `config` (NULL: the
/// defaults) clock, rate, seed and kernel count. With a live clock, sand is simulated on threads of
/// its own and every bus has a limiter, as before a sound card.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_load(
    path: *const c_char,
    text: *const c_char,
    files: *const asp_files,
    config: *const asp_config,
    scene: *mut *mut asp_scene,
    renderer: *mut *mut asp_renderer,
) -> i32 {
    enter(|| {
        let config: asp_config =
            if config.is_null() { sized::Sized32::initial() } else { sized::read(config, "config")? };
        let (scene, renderer) = (out(scene, "scene")?, out(renderer, "renderer")?);
        (*scene, *renderer) = (std::ptr::null_mut(), std::ptr::null_mut());
        let path = Path::new(text::needed(path, "path")?);
        let given = Given::new(files)?;
        let live = config.is_live()?;
        let counts = [config.haptic_channels, config.audio_buses, config.pickup_channels];
        if !config.more.is_null() || counts != [0; 3] {
            let what =
                "config: more, haptic_channels, audio_buses and pickup_channels stand beside a scene file";
            return Err(Failure::new(ASP_REFUSED, format!("{what}; write them into the scene file")));
        }
        let failed = |error| Failure::new(ASP_FILE, error);
        let file = match text::optional(text, "text")? {
            Some(text) => SceneFile::parse(text, path),
            None => SceneFile::load_from(&given, path),
        }
        .map_err(failed)?;
        within("actuators", file.actuators.len(), ASP_MAX_CHANNELS)?;
        within("pickups", file.pickups.len(), ASP_MAX_PICKUPS)?;
        let overrides = Overrides {
            files: &given,
            sample_rate_hz: Some(config.sample_rate_hz).filter(|rate_hz| *rate_hz != 0.0),
            seed: Some(config.seed).filter(|seed| *seed != 0),
            kernel: config.isa()?,
            clock: live.then_some(ClockMode::LIVE),
            live,
            ..Overrides::default()
        };
        let built = Engine::from_scene(&file, &overrides).map_err(failed)?;
        let Engine { scene: game, renderer: audio, names, workers, .. } = built;
        let sand = workers.into_iter().map(SandWorker::spawn).collect();
        hand_out(SceneHalf { scene: game, names, sand, live }, audio, scene, renderer)
    })
}

/// The id of a surface, body or probe by its name in the scene file, or by the name it was added
/// with.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_find(
    scene: *mut asp_scene,
    kind: u32,
    name: *const c_char,
    id: *mut u64,
) -> i32 {
    enter(|| {
        let (name, id) = (text::needed(name, "name")?, out(id, "id")?);
        *id = 0;
        let half = SCENES.hold(scene as usize)?;
        let (word, found) = match kind {
            ASP_SURFACE => ("surface", half.names.surfaces.get(name).map(|id| id.to_bits())),
            ASP_BODY => ("body", half.names.bodies.get(name).map(|id| id.to_bits())),
            ASP_PROBE => ("probe", half.names.probes.get(name).map(|id| id.to_bits())),
            other => {
                let right = "must be ASP_SURFACE, ASP_BODY or ASP_PROBE";
                return Err(Failure::new(ASP_BAD_ARGUMENT, format!("kind: {other} is refused; {right}")));
            }
        };
        *id = found.ok_or_else(|| {
            let right = format!("name a {word} of this scene");
            Failure::new(ASP_UNKNOWN, format!("{word}: \"{name}\" is unknown; {right}"))
        })?;
        Ok(())
    })
}
