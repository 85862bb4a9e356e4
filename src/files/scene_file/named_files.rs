//! The files that a scene names besides itself: what a watcher of the scene looks at.

use super::{BodyEntry, RoughnessEntry, SceneFile, Source, SurfaceEntry};
use std::path::Path;

impl SceneFile {
    /// Every picture and modes file that bodies and surfaces name.
    #[must_use]
    pub fn named_files(&self) -> Vec<&Path> {
        let bodies = self.bodies.iter().flat_map(BodyEntry::named_files);
        bodies.chain(self.surfaces.iter().flat_map(SurfaceEntry::named_files)).collect()
    }
}

impl BodyEntry {
    /// Its modes file or its mesh, where it has one.
    #[must_use]
    pub fn named_files(&self) -> Vec<&Path> {
        self.modes.as_deref().into_iter().chain(self.shape.as_ref().map(|(mesh, _)| &**mesh)).collect()
    }
}

impl SurfaceEntry {
    /// The pictures that its source and its roughness are made from. What a source of one's own
    /// reads is not known.
    #[must_use]
    pub fn named_files(&self) -> Vec<&Path> {
        let mut all = Vec::new();
        self.source.name_files(&mut all);
        if let RoughnessEntry::Map { image, .. } = &self.roughness {
            all.push(image.path.as_path());
        }
        all
    }
}

impl Source {
    fn name_files<'a>(&'a self, all: &mut Vec<&'a Path>) {
        match self {
            Self::Flat | Self::Solid { .. } | Self::Grating(_) | Self::Brownian(_) | Self::Own(_) => {}
            Self::Map { image, .. } => all.push(&image.path),
            Self::Lattice(lattice) => all.push(&lattice.cell.path),
            Self::Sand(sand) => all.extend(sand.tool.iter().map(|tool| tool.image.path.as_path())),
            Self::Sum(parts) => parts.iter().for_each(|part| part.name_files(all)),
            Self::Scale(part, _) => part.name_files(all),
            Self::Mask { image, inside, outside } => {
                all.push(&image.path);
                inside.name_files(all);
                outside.name_files(all);
            }
            Self::Crossfade { from, to, .. } => {
                from.name_files(all);
                to.name_files(all);
            }
        }
    }
}
