//! `play --watch`: the scene file, and the pictures and modes files that it names, are looked at
//! while it plays, and what has changed is applied to what sounds.

use crate::error::CliError;
use crate::shapes;
use asperity::Scene;
use asperity::files::contact_log::Names;
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity_surface::sand::{SandThread, SandWorker};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Interval at which the file is looked at.
const EVERY: Duration = Duration::from_millis(200);

/// A scene file that is watched.
pub struct Watch<'a> {
    /// As it was applied last.
    pub file: SceneFile,
    overrides: Overrides<'a>,
    seen: Option<SystemTime>,
    /// The files that it names, and when they were written.
    named: BTreeMap<PathBuf, Option<SystemTime>>,
    looked: Instant,
    /// Simulations of the sand that changes brought.
    pub sand: Vec<SandThread>,
}

/// The files that a scene names, and when they were written.
fn named(file: &SceneFile) -> BTreeMap<PathBuf, Option<SystemTime>> {
    file.named_files().into_iter().map(|path| (path.to_owned(), written(path))).collect()
}

/// Time of a file's last change; none while an editor puts another in its place.
fn written(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|file| file.modified()).ok()
}

impl<'a> Watch<'a> {
    /// Watches the file that a scene was opened from.
    pub fn new(file: SceneFile, overrides: Overrides<'a>) -> Self {
        let (seen, named) = (written(&file.path), named(&file));
        Self { file, overrides, seen, named, looked: Instant::now(), sand: Vec::new() }
    }

    /// News since the last look: what was applied, what waits, or why the old scene goes on.
    pub fn look(&mut self, scene: &mut Scene, names: &mut Names) -> Vec<String> {
        if self.looked.elapsed() < EVERY {
            return Vec::new();
        }
        self.looked = Instant::now();
        let now = written(&self.file.path);
        let touched = self.touched();
        if now.is_none() || (now == self.seen && touched.is_empty()) {
            return Vec::new();
        }
        let said = self.apply(scene, names, &touched);
        self.seen = now;
        self.named = named(&self.file);
        said.unwrap_or_else(|error| {
            vec![format!("warning: {}; the scene goes on as it was", error.without_prefix())]
        })
    }

    /// Files that were written since the last look; one that is just being put in its place is not
    /// there yet.
    fn touched(&self) -> Vec<PathBuf> {
        let now = |path: &PathBuf| written(path);
        let newer = self.named.iter().filter(|(path, seen)| now(path).is_some_and(|now| Some(now) != **seen));
        newer.map(|(path, _)| path.clone()).collect()
    }

    fn apply(
        &mut self,
        scene: &mut Scene,
        names: &mut Names,
        touched: &[PathBuf],
    ) -> Result<Vec<String>, CliError> {
        let mut after = SceneFile::load(&self.file.path)?;
        shapes::solve(&mut after)?;
        let overrides = Overrides { touched, ..self.overrides };
        let changes = scene.apply(names, &self.file, &after, &overrides)?;
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
    fn a_scene_file_is_changed_and_mended_while_it_plays() {
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

        // Nothing in the scene file changes, only the picture that it names.
        let relief = folder.path().join("relief.pgm");
        let paint = |text: &str, age: u64| {
            std::fs::write(&relief, text).unwrap();
            let later = SystemTime::now() + Duration::from_secs(age);
            std::fs::File::options().write(true).open(&relief).unwrap().set_modified(later).unwrap();
        };
        paint("P2 2 2 255 0 255 255 0", 10);
        let mapped =
            SCENE.replace("height_m = 0.1", "height_m = 0.1\ndisplacement = \"relief.pgm\"\nrelief_m = 1e-4");
        write(&mapped);
        assert!(heard(&mut watch, &mut scene, &mut names).contains(&"surface \"plate\": changed".to_owned()));
        paint("P2 2 2 255 255 0 0 255", 20);
        assert_eq!(heard(&mut watch, &mut scene, &mut names), ["surface \"plate\": changed"]);
        paint("no picture", 30);
        let said = heard(&mut watch, &mut scene, &mut names);
        assert!(
            said[0].contains("relief.pgm") && said[0].ends_with("the scene goes on as it was"),
            "{said:?}"
        );
        paint("P2 2 2 255 0 128 128 0", 40);
        assert_eq!(heard(&mut watch, &mut scene, &mut names), ["surface \"plate\": changed"]);

        assert_eq!(names.surfaces["plate"], plate, "ids stay what they are");
        assert!(scene.remove_body(bell).is_err(), "the bell is gone");
        let (mut device, _) = sink.stop().unwrap();
        assert!(device.renderer().position() > 0);
        assert_eq!(scene.stats().quarantined, 0);
    }
}
