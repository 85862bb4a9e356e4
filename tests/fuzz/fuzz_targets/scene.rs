//! Any bytes as a scene file: read or refused, never a panic.
#![no_main]

use asperity::files::scene_file::SceneFile;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Err(refused) = SceneFile::parse(text, std::path::Path::new("fuzz/scene.toml")) {
        assert!(!refused.to_string().contains('\n'), "an error is one line");
    }
});
