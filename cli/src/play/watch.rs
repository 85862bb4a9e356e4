//! `play --watch`: the scene file is looked at while it plays, and what has changed in it is applied to what sounds.

use crate::error::CliError;
use asperity::Scene;
use asperity::files::contact_log::Names;
use asperity::files::scene_file::SceneFile;
use asperity::open::Overrides;
use asperity_texture::sand::{SandThread, SandWorker};
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// How often the file is looked at.
const EVERY: Duration = Duration::from_millis(200);

/// A scene file that is watched.
pub struct Watch<'a> {
    /// As it was applied last.
    pub file: SceneFile,
    overrides: Overrides<'a>,
    seen: Option<SystemTime>,
    looked: Instant,
    /// Simulations of the sand that changes brought.
    pub sand: Vec<SandThread>,
}

/// When a file was written last; none while an editor puts another in its place.
fn written(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|file| file.modified()).ok()
}

impl<'a> Watch<'a> {
    /// Watches the file that a scene was opened from.
    pub fn new(file: SceneFile, overrides: Overrides<'a>) -> Self {
        let seen = written(&file.path);
        Self { file, overrides, seen, looked: Instant::now(), sand: Vec::new() }
    }

    /// What there is to say since the last look: what was applied, what waits, or why the old scene goes on.
    pub fn look(&mut self, scene: &mut Scene, names: &mut Names) -> Vec<String> {
        if self.looked.elapsed() < EVERY {
            return Vec::new();
        }
        self.looked = Instant::now();
        let now = written(&self.file.path);
        if now.is_none() || now == self.seen {
            return Vec::new();
        }
        match self.apply(scene, names) {
            Ok(said) => {
                self.seen = now;
                said
            }
            Err(error) => {
                self.seen = now;
                vec![format!("warning: {}; the scene goes on as it was", error.without_prefix())]
            }
        }
    }

    fn apply(&mut self, scene: &mut Scene, names: &mut Names) -> Result<Vec<String>, CliError> {
        let after = SceneFile::load(&self.file.path)?;
        let changes = scene.apply(names, &self.file, &after, &self.overrides)?;
        self.sand.extend(changes.workers.into_iter().map(SandWorker::spawn));
        self.file = after;
        let waiting = changes.waiting.iter().map(|waiting| format!("warning: {waiting}"));
        let mut said: Vec<String> = changes.done.into_iter().chain(waiting).collect();
        if said.is_empty() {
            said.push("the scene file says the same".to_owned());
        }
        Ok(said)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::Engine;
    use asperity::live::channel_map::{ChannelMap, Interleaver};
    use asperity::live::null_sink::NullSink;

    const SCENE: &str = "[[body]]\nname = \"bell\"\nstock = \"bar\"\nsize_m = 0.2\n[[surface]]\nname = \"plate\"\n\
        body = \"bell\"\nwidth_m = 0.1\nheight_m = 0.1\n";

    /// Looks until there is something to say.
    fn heard(watch: &mut Watch<'_>, scene: &mut Scene, names: &mut Names) -> Vec<String> {
        let began = Instant::now();
        loop {
            let said = watch.look(scene, names);
            if !said.is_empty() || began.elapsed() > Duration::from_secs(20) {
                return said;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    #[test]
    fn a_scene_file_is_changed_broken_and_mended_while_it_plays_into_the_null_sink() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, SCENE).unwrap();
        let file = SceneFile::load(&path).unwrap();
        let overrides = Overrides { live: true, ..Overrides::default() };
        let Engine { mut scene, renderer, mut names, .. } = Engine::from_scene(&file, &overrides).unwrap();
        let sink =
            NullSink::start(Interleaver::new(renderer, ChannelMap::stereo_then_haptics(1)), 256).unwrap();
        let mut watch = Watch::new(file, overrides);
        let (bell, plate) = (names.bodies["bell"], names.surfaces["plate"]);

        let write = |text: &str| {
            // File systems that count in whole seconds see the change too.
            std::fs::write(&path, text).unwrap();
            let later = SystemTime::now() + Duration::from_secs(text.len() as u64);
            std::fs::File::options().write(true).open(&path).unwrap().set_modified(later).unwrap();
        };
        write(&SCENE.replace("size_m = 0.2", "size_m = 0.3"));
        assert_eq!(heard(&mut watch, &mut scene, &mut names), ["body \"bell\": changed"]);

        write(&SCENE.replace("size_m = 0.2", "size_m = 0.3\ncolour = 1"));
        let said = heard(&mut watch, &mut scene, &mut names);
        assert!(
            said[0].contains("colour: unknown key") && said[0].ends_with("the scene goes on as it was"),
            "{said:?}"
        );

        write(
            &SCENE
                .replace("size_m = 0.2", "size_m = 0.3")
                .replace("height_m = 0.1", "height_m = 0.1\nsolid = \"wood\""),
        );
        assert_eq!(heard(&mut watch, &mut scene, &mut names), ["surface \"plate\": changed"]);
        write(&format!("sample_rate_hz = 22050\n{}", SCENE.replace("bell", "gong")));
        let said = heard(&mut watch, &mut scene, &mut names);
        assert!(
            said.contains(&"body \"gong\": added".to_owned())
                && said.contains(&"body \"bell\": removed".to_owned()),
            "{said:?}"
        );
        assert!(
            said.contains(&"warning: sample_rate_hz: takes effect when the scene is opened again".to_owned()),
            "{said:?}"
        );

        assert_eq!(names.surfaces["plate"], plate, "ids stay what they are");
        assert!(scene.remove_body(bell).is_err(), "the bell is gone");
        let (mut device, _) = sink.stop().unwrap();
        assert!(device.renderer().position() > 0);
        assert_eq!(scene.stats().quarantined, 0);
    }
}
