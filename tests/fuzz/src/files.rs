//! Doors of the offline crates: sounds, meshes, photographs, data sets.

use crate::Door;
use crate::engine::{as_file, one_line};
use asperity_batch::manifest::Manifest;
use asperity_batch::spec::Spec;
use asperity_fit::recording::{ChannelChoice, Sound};
use asperity_shape::repair::Cracks;
use asperity_shape::{Mesh, gltf};
use std::path::Path;

pub const DOORS: &[Door] = &[
    ("wav", |data| sound("wav", data)),
    ("flac", |data| sound("flac", data)),
    ("ogg", |data| sound("ogg", data)),
    ("aiff", |data| sound("aiff", data)),
    ("mp3", |data| sound("mp3", data)),
    ("m4a", |data| sound("m4a", data)),
    ("obj", |data| mesh("fuzz.obj", data)),
    ("stl", |data| mesh("fuzz.stl", data)),
    ("ply", |data| mesh("fuzz.ply", data)),
    ("msh", |data| mesh("fuzz.msh", data)),
    ("glb", |data| mesh("fuzz.glb", data)),
    ("batch", batch),
    ("manifest", manifest),
    ("photograph", photograph),
    ("stroke-models", stroke_models),
];

/// A recording: samples that are numbers, or the reason.
fn sound(ending: &str, data: &[u8]) {
    as_file(ending, data, |path| {
        match Sound::load(path, 0, 60.0) {
            Ok(sound) => assert!(sound.samples.iter().all(|x| x.is_finite())),
            Err(refused) => one_line(&refused),
        }
        match asperity_fit::load(path, ChannelChoice::Loudest) {
            Ok(recording) => assert!(recording.samples.iter().all(|x| x.is_finite())),
            Err(refused) => one_line(&refused),
        }
    });
}

/// Published models of strokes: densities that are numbers, or the reason.
fn stroke_models(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match asperity_stroke::models::read(text) {
        Ok(models) => assert!(models.windows.iter().all(|window| window.speed_m_s > 0.0)),
        Err(refused) => one_line(&refused),
    }
}

/// A mesh, and its repair where it is small.
fn mesh(name: &str, data: &[u8]) {
    match asperity_shape::parse(Path::new(name), data) {
        Ok(Mesh::Surface(surface)) => {
            let corners = surface.triangles.iter().flatten();
            assert!(corners.into_iter().all(|&i| (i as usize) < surface.points.len()));
            if surface.triangles.len() < 200 {
                let mut message = Vec::new();
                let joined = surface.joined(Cracks::Wide, &mut message);
                let _ = joined.and_then(|surface| surface.closed(&mut message));
            }
        }
        Ok(Mesh::Curved(..)) => {}
        Ok(Mesh::Volume(volume)) => {
            assert!(volume.tets.iter().flatten().all(|&i| (i as usize) < volume.points.len()));
        }
        Err(refused) => one_line(&refused),
    }
    if let Ok(document) = gltf::Document::parse(Path::new(name), data) {
        let _ = document.placed();
    }
}

fn batch(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match Spec::parse(text.to_owned(), Path::new("fuzz/spec.toml")) {
        Ok(spec) => assert!(spec.shards() > 0),
        Err(refused) => one_line(&refused),
    }
}

fn manifest(data: &[u8]) {
    as_file("json", data, |path| {
        let folder = path.with_extension("d");
        let _ = std::fs::create_dir_all(&folder);
        let _ = std::fs::copy(path, folder.join("manifest.json"));
        if let Err(refused) = Manifest::load(&folder) {
            one_line(&refused);
        }
        let _ = std::fs::remove_dir_all(folder);
    });
}

/// A photograph, reduced as the conversions ask for.
fn photograph(data: &[u8]) {
    as_file("jpg", data, |path| {
        if let Err(refused) = asperity_pictures::photograph::load_reduced_photograph(path, 1 << 12) {
            one_line(&refused);
        }
    });
}
