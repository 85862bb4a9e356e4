//! Edits of a recording, made again.

use super::maker::Loader;
use super::maps::Maps;
use crate::files::contact_log::{LogEdit, LogSurface, Names};
use crate::files::scene_file::{MakeSource, SurfaceEntry};
use crate::files::{Disk, FileError, Files};
use crate::game::scene::Scene;
use crate::model::bus::BusId;
use crate::model::event::ChannelId;
use crate::model::id::{BodyId, SurfaceId};
use crate::model::surface::Surface;
use std::path::Path;

/// Makes the surfaces of a recording that the game's own code made, by name: `None` for one it does
/// not know.
pub type MakeSurface<'a> = dyn FnMut(&str, &Names) -> Option<Surface> + 'a;

/// Makers of the edits of a recording that is rendered again.
pub struct Edits<'a> {
    /// Place of the files that surfaces name; the disk by default.
    pub files: &'a dyn Files,
    /// Sources of one's own, as in [`Overrides::own`](crate::load::Overrides::own).
    pub own: &'a [(&'a str, MakeSource)],
    /// Surfaces that the recording cannot hold.
    pub surfaces: Option<&'a mut MakeSurface<'a>>,
}

impl Default for Edits<'_> {
    fn default() -> Self {
        Self { files: &Disk, own: &[], surfaces: None }
    }
}

impl Edits<'_> {
    /// Makes one edit of game time `time_s`; new things get their names.
    pub(crate) fn make(
        &mut self,
        edit: &LogEdit,
        scene: &mut Scene,
        names: &mut Names,
        time_s: f64,
    ) -> Result<(), FileError> {
        match edit {
            LogEdit::AddBody { body, is } => {
                let id = scene
                    .add_body(is.body().map_err(FileError::from_error)?)
                    .map_err(FileError::from_error)?;
                names.bodies.insert(body.clone(), id);
                Ok(())
            }
            LogEdit::ReplaceBody { body, is } => {
                let new = is.body().map_err(FileError::from_error)?;
                scene.replace_body(known_body(names, body)?, new)
            }
            LogEdit::BodyBus { body, bus } => scene.set_body_bus(known_body(names, body)?, BusId(*bus)),
            LogEdit::BodySend { body, bus, gain } => {
                scene.set_body_send(known_body(names, body)?, BusId(*bus), *gain)
            }
            LogEdit::BodyGain { body, gain } => scene.set_body_gain(known_body(names, body)?, *gain),
            LogEdit::Mute { muted } => scene.set_muted(*muted),
            LogEdit::Pause { paused } => scene.set_paused(*paused),
            LogEdit::TimeScale { scale, bend_pitch } => scene.scale_time(time_s, *scale, *bend_pitch),
            LogEdit::Pitch { pitch } => scene.set_pitch(*pitch),
            LogEdit::FadeAll => scene.fade_all(),
            LogEdit::RemoveBody { body } => scene.remove_body(known_body(names, body)?),
            LogEdit::AddProbe { probe, is } => scene.add_probe(*is).map(|id| {
                names.probes.insert(probe.clone(), id);
            }),
            LogEdit::AddSurface { surface, is } => {
                let new = self.surface(surface, is, scene, names)?;
                scene.add_surface(new).map(|id| {
                    names.surfaces.insert(surface.clone(), id);
                })
            }
            LogEdit::ReplaceSurface { surface, is } => {
                let new = self.surface(surface, is, scene, names)?;
                scene.replace_surface(known_surface(names, surface)?, new)
            }
            LogEdit::RemoveSurface { surface } => scene.remove_surface(known_surface(names, surface)?),
            LogEdit::ChangeSurface { surface } => {
                let right =
                    "record with replace_surface instead; the parameters of a source are not in a recording";
                return Err(FileError::new(
                    format!("surface \"{surface}\""),
                    "was changed by the game's own code",
                    right,
                ));
            }
            LogEdit::HapticGain { actuator, gain } => scene.set_haptic_gain(ChannelId(*actuator), *gain),
            LogEdit::AudioGain { bus, gain } => scene.set_audio_gain(BusId(*bus), *gain),
        }
        .map_err(FileError::from_error)
    }

    fn surface(
        &mut self,
        name: &str,
        is: &LogSurface,
        scene: &Scene,
        names: &Names,
    ) -> Result<Surface, FileError> {
        let place = |error: FileError| error.within(format!("surface \"{name}\""));
        if let Some(table) = &is.is {
            let entry =
                SurfaceEntry::read(table.clone(), Path::new(is.folder.as_deref().unwrap_or_default()));
            let maker = Loader {
                files: self.files,
                maps: &Maps::default(),
                own: self.own,
                seed: scene.config().seed,
                workers: None,
            };
            return entry.and_then(|entry| maker.surface(&entry, is.material, names)).map_err(place);
        }
        let made = self.surfaces.as_mut().and_then(|make| make(name, names));
        made.ok_or_else(|| {
            let right = "give it to the replay under this name (Edits::surfaces)";
            place(FileError::new("the recording", "cannot hold what the game's own code made", right))
        })
    }
}

fn known_body(names: &Names, name: &str) -> Result<BodyId, FileError> {
    let unknown = || FileError::new(format!("body \"{name}\""), "is unknown", "name a body of the scene");
    names.bodies.get(name).copied().ok_or_else(unknown)
}

fn known_surface(names: &Names, name: &str) -> Result<SurfaceId, FileError> {
    let unknown =
        || FileError::new(format!("surface \"{name}\""), "is unknown", "name a surface of the scene");
    names.surfaces.get(name).copied().ok_or_else(unknown)
}

crate::opaque::debug_by_name!(Edits<'_>);
