//! Height maps in a scene's folder.

use super::support::Scene;
use asperity_surface::image_io::save_gray16;
use asperity_surface::raster::Raster;

/// A folder with these maps in it.
pub fn with_maps(maps: &[(&str, Raster)]) -> Scene {
    let scene = Scene::new();
    for (name, map) in maps {
        save_gray16(scene.path(name), map).unwrap();
    }
    scene
}
