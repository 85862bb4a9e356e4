//! Paths in a scene's table, from another folder.

use std::fs;
use std::path::{Component, Path};
use toml::{Table, Value};

/// A scene's table with the files that it names written as absolute paths.
pub fn with_absolute_paths(scene: &Table, home: &Path) -> Table {
    with_paths(scene, &|text| {
        let path = fs::canonicalize(home.join(text)).ok().filter(|path| path.is_file())?;
        Some(path.to_string_lossy().into_owned())
    })
}

/// Scene with paths from a folder.
pub(super) fn with_relative_paths(scene: &Table, folder: &Path) -> Table {
    with_paths(scene, &|text| Path::new(text).is_absolute().then(|| relative(Path::new(text), folder)))
}

/// Every text with a dot that is a path, written anew.
fn with_paths(scene: &Table, change: &dyn Fn(&str) -> Option<String>) -> Table {
    fn walk(value: &mut Value, change: &dyn Fn(&str) -> Option<String>) {
        match value {
            Value::String(text) if text.contains('.') => {
                if let Some(changed) = change(text) {
                    *text = changed;
                }
            }
            Value::Array(values) => values.iter_mut().for_each(|value| walk(value, change)),
            Value::Table(table) => table.iter_mut().for_each(|(_, value)| walk(value, change)),
            _ => {}
        }
    }
    let mut scene = scene.clone();
    scene.iter_mut().for_each(|(_, value)| walk(value, change));
    scene
}

/// A path from a folder, both absolute; as it is where they share no root.
fn relative(path: &Path, folder: &Path) -> String {
    let (path_parts, folder_parts): (Vec<Component>, Vec<Component>) =
        (path.components().collect(), folder.components().collect());
    let shared = path_parts.iter().zip(&folder_parts).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return path.to_string_lossy().into_owned();
    }
    let up = folder_parts[shared..].iter().map(|_| "..".to_owned());
    let down = path_parts[shared..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_from_a_folder_leads_to_the_same_file() {
        let at = |path: &str, folder: &str| relative(Path::new(path), Path::new(folder));
        assert_eq!(at("/a/maps/wall.png", "/a/out/x"), "../../maps/wall.png");
        assert_eq!(at("/a/out/wall.png", "/a/out"), "wall.png");
        assert_eq!(at("/wall.png", "/a"), "../wall.png");
    }
}
