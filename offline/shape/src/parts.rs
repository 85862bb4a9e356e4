//! Named parts of a mesh file, and the one that is asked for.

use crate::error::ShapeError;
use crate::mesh::Mesh;
use std::collections::HashMap;

/// The word for the part of the greatest volume.
const LARGEST: &str = "largest";
/// Names that an error lists.
const LISTED: usize = 12;

/// Names of a file's elements: an object's and a group's each, as numbers in `names`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Names {
    names: Vec<String>,
    numbers: HashMap<String, u32>,
    of: Vec<[Option<u32>; 2]>,
}

impl Names {
    /// Number of a name.
    pub(crate) fn number(&mut self, name: &str) -> u32 {
        let Self { names, numbers, .. } = self;
        *numbers.entry(name.to_owned()).or_insert_with(|| {
            names.push(name.to_owned());
            names.len() as u32 - 1
        })
    }

    /// Names elements up to `elements` that have none yet.
    pub(crate) fn fill(&mut self, elements: usize, names: [Option<u32>; 2]) {
        self.of.resize(elements, names);
    }

    fn list(&self) -> String {
        let shown: Vec<&str> = self.names.iter().take(LISTED).map(String::as_str).collect();
        let more = if self.names.len() > LISTED { ", …" } else { "" };
        if shown.is_empty() { LARGEST.to_owned() } else { format!("{}{more} or {LARGEST}", shown.join(", ")) }
    }
}

/// The part that is asked for.
///
/// # Errors
/// When the file has no part of that name.
pub(crate) fn part(mesh: Mesh, names: &Names, wanted: &str) -> Result<Mesh, ShapeError> {
    let number = names.numbers.get(wanted).copied();
    let Mesh::Surface(mut surface) = mesh else {
        return if wanted == LARGEST { Ok(mesh.largest_part()) } else { Err(unknown(names, wanted)) };
    };
    if let Some(number) = number {
        let mut of = names.of.iter();
        surface.triangles.retain(|_| of.next().is_some_and(|name| name.contains(&Some(number))));
        return Ok(Mesh::Surface(surface).used());
    }
    if wanted == LARGEST { Ok(Mesh::Surface(surface).largest_part()) } else { Err(unknown(names, wanted)) }
}

fn unknown(names: &Names, wanted: &str) -> ShapeError {
    ShapeError::new("--part", format!("{wanted} is unknown"), format!("must be one of {}", names.list()))
}
