//! A document without the draft: a body of each mesh, and a surface of each normal texture.

use super::{Options, Scene, Unwrap, extent, plain};
use crate::error::CliError;
use crate::modes;
use asperity_shape::eigenmodes::Wanted;
use asperity_shape::gltf::{Document, Placed, place};
use asperity_shape::modes_file::ModesFile;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::{Elastic, Making, Mesh};
use serde_json::{Value, json};
use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

/// Most bodies that are solved: each takes seconds.
const MOST_BODIES: usize = 16;
/// Modes of a body.
const MODES: Wanted = Wanted { up_to_hz: Some(20_000.0), most: 48 };
/// Micro-relief of a material of roughness 1, m: the scene's default.
const MICRO_RELIEF_M: f64 = 2e-6;

impl Scene {
    /// Bodies and surfaces of the meshes and materials that nodes place.
    pub fn plain(
        &mut self,
        document: &Document,
        maps: &[Option<Placed>],
        options: &Options,
    ) -> Result<(), CliError> {
        let material = &options.material;
        let (mut bodies, mut tried): (HashMap<u64, Option<String>>, usize) = (HashMap::new(), 0);
        let mut textures = HashSet::new();
        for (node, map) in document.list("nodes").iter().zip(maps) {
            let (Some(map), Some(mesh)) = (map, node["mesh"].as_u64()) else { continue };
            let named = document.json["meshes"][mesh as usize]["name"].as_str().or(node["name"].as_str());
            let name = format!("{}-{mesh}", plain(named.unwrap_or("mesh")));
            let body = match bodies.get(&mesh) {
                Some(body) => {
                    self.remark(
                        "meshes that several nodes place are bodies once, of the first node's size"
                            .to_owned(),
                    );
                    body.clone()
                }
                None if tried == MOST_BODIES => {
                    self.remark(format!(
                        "the first {MOST_BODIES} meshes are bodies, the others are left out"
                    ));
                    None
                }
                None => {
                    tried += 1;
                    let solved = self.solved(document, mesh, map, &name, options)?;
                    solved.then(|| name.clone())
                }
            };
            bodies.insert(mesh, body.clone());
            for primitive in
                document.json["meshes"][mesh as usize]["primitives"].as_array().into_iter().flatten()
            {
                let Some(index) = primitive["material"].as_u64() else { continue };
                let look = &document.json["materials"][index as usize];
                if look["normalTexture"].is_object() && textures.insert(index) {
                    let name = format!("{}-{index}", plain(look["name"].as_str().unwrap_or("surface")));
                    self.textured(document, node, map, look, &name, body.as_deref())?;
                }
            }
        }
        if !self.bodies.is_empty() {
            self.remark(format!(
                "a glTF does not say what bodies are made of: {material} is taken, --material names another"
            ));
        }
        Ok(())
    }

    /// Solves a mesh; where it is no body, that is reported.
    fn solved(
        &mut self,
        document: &Document,
        mesh: u64,
        map: &Placed,
        name: &str,
        options: &Options,
    ) -> Result<bool, CliError> {
        let (material, path) = (options.material.as_str(), options.document.as_path());
        let preset = modes::preset(material)?;
        let mut surface = SurfaceMesh::default();
        let primitives = &document.json["meshes"][mesh as usize]["primitives"];
        for (p, primitive) in primitives.as_array().into_iter().flatten().enumerate() {
            let at = format!("meshes[{mesh}].primitives[{p}]");
            if document.is_packed(primitive) {
                self.remark(format!("{at} is packed by Draco or meshopt and is left out"));
                continue;
            }
            let Some((points, triangles)) = document.triangles(primitive, &at)? else { continue };
            let first = surface.points.len() as u32;
            // In the node's own frame, as large as in the scene.
            let own = [map[0], map[1], map[2], [0.0; 3]];
            surface.points.extend(points.into_iter().map(|p| place(&own, p)));
            surface.triangles.extend(triangles.into_iter().map(|t| t.map(|i| i + first)));
        }
        match options.unwrap.glb(surface.clone()) {
            Ok(None) => {}
            Ok(Some((bytes, unwrapped))) => {
                let file = format!("{name}.glb");
                self.files.push((file.clone(), bytes));
                self.unwrapped.push(Unwrap { file, unwrapped });
            }
            Err(error) => {
                self.remark(format!("mesh {name} is not unwrapped: {}; {}", error.what, error.right))
            }
        }
        if options.surfaces_only {
            return Ok(false);
        }
        let elastic = Elastic {
            young_pa: preset.young_pa,
            poisson: preset.poisson,
            density_kg_m3: preset.density_kg_m3,
        };
        let making =
            Making { material: elastic, size_m: None, unit_m: Some(1.0), thickness_m: None, wanted: MODES };
        let mut body = match asperity_shape::make(Mesh::Surface(surface), &making, &mut |_| ()) {
            Ok(body) => body,
            Err(error) => {
                self.remark(format!("mesh {name} is no body: it {}", error.what));
                return Ok(false);
            }
        };
        let file = ModesFile::new(&mut body, &preset.damping(), false, path).map_err(CliError::from_error)?;
        let text = serde_json::to_string(&file).map_err(CliError::from_error)?;
        let written = format!("{name}.modes.json");
        let table = format!(
            "[[body]]\nname = {}\nmodes = {}\nmaterial = {}\n",
            json!(name),
            json!(written),
            json!(material)
        );
        self.files.push((written, text.into_bytes()));
        self.bodies.push((name.to_owned(), table));
        Ok(true)
    }

    fn textured(
        &mut self,
        document: &Document,
        node: &Value,
        map: &Placed,
        look: &Value,
        name: &str,
        body: Option<&str>,
    ) -> Result<(), CliError> {
        let extent = extent::extent_m(document, node, map, &look["normalTexture"])?;
        let mut table = format!("[[surface]]\nname = {}\n", json!(name));
        if let Some(body) = body {
            let _ = writeln!(table, "body = {}", json!(body));
        }
        let at = format!("materials.{name}.normalTexture");
        self.heights(document, &look["normalTexture"], extent, (name, &at), &mut table)?;
        let roughness = look["pbrMetallicRoughness"]["roughnessFactor"].as_f64().unwrap_or(1.0);
        let _ = writeln!(
            table,
            "roughness = {:?}\nmicro_relief_m = {MICRO_RELIEF_M:?}",
            roughness.clamp(0.0, 1.0)
        );
        self.surfaces.push((name.to_owned(), table));
        Ok(())
    }
}
