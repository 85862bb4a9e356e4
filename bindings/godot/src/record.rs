//! Recording: what was reported, as a contact log, and what it renders to.

use crate::res_files::ResFiles;
use crate::world::AsperityWorld;
use asperity::Engine;
use asperity::files::contact_log::ContactLog;
use asperity::offline::{self, Options};
use godot::classes::FileAccess;
use godot::classes::file_access::ModeFlags;
use godot::prelude::*;

#[godot_api(secondary)]
impl AsperityWorld {
    /// Records what is reported from now on, as a contact log.
    #[func]
    fn record_start(&mut self) -> bool {
        self.tried("record_start", |running| {
            running.scene.start_recording(&running.names);
            Ok(())
        })
        .is_some()
    }

    /// Ends the recording and writes it (JSON Lines) to a path, `user://touch.jsonl` for example.
    #[func]
    fn record_stop(&mut self, path: GString) -> bool {
        self.tried("record_stop", |running| {
            let lines = running.scene.stop_recording().to_jsonl().into_bytes();
            let file = FileAccess::open(&path, ModeFlags::WRITE);
            let wrong =
                || format!("{path}: {:?}; give a path that can be written", FileAccess::get_open_error());
            let written = file.ok_or_else(wrong)?.store_buffer(&PackedByteArray::from(lines));
            if written { Ok(()) } else { Err(format!("{path}: could not be written whole")) }
        })
        .is_some()
    }

    /// Renders a recorded log of a world with a scene file once more, faster than real time.
    /// "rate_hz", "audio" and "haptic", arrays of a PackedFloat32Array each; empty, and an error,
    /// where it cannot.
    #[func]
    fn render_log(&mut self, path: GString) -> VarDictionary {
        let mut told = VarDictionary::new();
        let made = self.open(false).and_then(|engine| {
            let log = ContactLog::load_from(&ResFiles::default(), path.to_string())
                .map_err(|error| error.to_string())?;
            let Engine { scene, renderer, names, .. } = engine;
            offline::render(scene, renderer, &log, &names, &Options::default())
                .map_err(|error| error.to_string())
        });
        let Some(render) = self.said("render_log", made) else { return told };
        let pack = |channels: &[Vec<f32>]| -> Array<PackedFloat32Array> {
            channels.iter().map(|channel| PackedFloat32Array::from(channel.as_slice())).collect()
        };
        told.set("rate_hz", render.sample_rate_hz);
        told.set("audio", &pack(&render.audio));
        told.set("haptic", &pack(&render.haptic));
        told
    }
}
