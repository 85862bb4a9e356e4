//! Bodies of a scene that are meshes: solved before it is opened, as `asperity modes` does.

use crate::error::CliError;
use crate::modes;
use crate::progress::Progress;
use asperity::files::scene_file::{BodyEntry, SceneFile};
use asperity::{Body, Material, ModalModel};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// Steps of the progress bar of one body.
const STEPS: u64 = 100;

/// Mesh, size and material that a solution follows from.
#[derive(Clone, PartialEq)]
struct Asked {
    mesh: PathBuf,
    changed: Option<SystemTime>,
    size_m: Option<f64>,
    material: Material,
}

/// Solutions so far: a set of sounds and `play --watch` open a scene again and again.
static SOLVED: Mutex<Vec<(Asked, Arc<ModalModel>)>> = Mutex::new(Vec::new());

/// Solves the bodies of a scene that are meshes.
///
/// # Errors
/// When one is no body; the message names it.
pub fn solve(file: &mut SceneFile) -> Result<(), CliError> {
    for entry in &mut file.bodies {
        let Some((mesh, size_m)) = entry.shape.clone() else { continue };
        let changed = std::fs::metadata(&mesh).and_then(|data| data.modified()).ok();
        let material = entry.material.unwrap_or(Body::DEFAULT_MATERIAL);
        let asked = Asked { mesh, changed, size_m, material };
        let remarks = |error: CliError| error.within(place(&file.path, entry));
        entry.solved = Some(solved(asked).map_err(remarks)?);
    }
    Ok(())
}

fn place(scene: &Path, entry: &BodyEntry) -> String {
    format!("{}: body \"{}\": shape", scene.display(), entry.name)
}

fn solved(asked: Asked) -> Result<Arc<ModalModel>, CliError> {
    let known = || SOLVED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, model)) = known().iter().find(|(known, _)| *known == asked) {
        return Ok(Arc::clone(model));
    }
    let mut progress = Progress::new("solving", STEPS);
    let model = modes::model(&asked.mesh, &asked.material, asked.size_m, &mut |done| progress.reach(done))?;
    let model = Arc::new(model);
    known().push((asked, Arc::clone(&model)));
    Ok(model)
}
