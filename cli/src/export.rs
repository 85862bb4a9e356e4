//! `asperity export BODY.modes.json … -o BODIES.(gltf|glb)`: bodies with mode shapes for tools that
//! read the draft `KHR_audio_rigid_bodies`.
//!
//! | draft | ours |
//! |---|---|
//! | `frequencies`, `decayRates` | `frequency_hz`, `decay_per_s` of the modes file |
//! | `positions`, `indices` | `shapes.points_m`, `shapes.triangles` |
//! | `shapes`, one mode after the other | `shapes.phi_per_sqrt_kg` |
//! | `acousticMaterials` | what `--material` names |
//!
//! Numbers are single precision there. The draft has neither loudness nor a residual: who
//! reads it takes a mode's loudness from its shape.

pub mod binary;

use crate::error::CliError;
use crate::import::EXTENSION;
use crate::modes::preset;
use crate::output::{self, Outputs};
use crate::paths::without_ends;
use asperity::{Material, ModalModel, ModeShapes};
use binary::Binary;
use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Write bodies with mode shapes as a glTF document (the draft KHR_audio_rigid_bodies)
#[derive(Debug, Args)]
pub struct Options {
    /// Modes files of version 2, as `asperity modes` writes them; a node each
    #[arg(value_name = "BODY.modes.json", required = true)]
    pub bodies: Vec<PathBuf>,
    /// Document to write; `.gltf` carries its numbers inside it
    #[arg(short, long = "output", value_name = "OUT.(gltf|glb)")]
    pub output: PathBuf,
    /// Material of the bodies: a preset
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    bodies: usize,
    modes: usize,
    warnings: Vec<String>,
    files: Vec<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// When a modes file is none or has no shapes, or the document cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let packed = match options.output.extension().and_then(|ending| ending.to_str()) {
        Some("gltf") => false,
        Some("glb") => true,
        _ => return Err(CliError::file(&options.output, "has another ending", "must end in .gltf or .glb")),
    };
    let material = options.material.as_deref().map(preset).transpose()?;
    let (mut document, mut report) =
        (Document::default(), Report { bodies: 0, modes: 0, warnings: Vec::new(), files: Vec::new() });
    for path in &options.bodies {
        let model = ModalModel::load(path).map_err(CliError::from_error)?;
        output::reads(["glb", "shapes"].map(|ending| path.with_extension(ending)));
        let Some(shapes) = &model.shapes else {
            let right = "must be of version 2 with shapes, as `asperity modes` writes it";
            return Err(CliError::file(path, "has no mode shapes", right));
        };
        if model.residual.is_some() {
            report.warnings.push(format!("{}: its residual is left out: the draft has none", path.display()));
        }
        report.bodies += 1;
        report.modes += model.modes.len();
        document.body(&without_ends(path), &model, shapes, material.is_some());
    }
    let mut outputs = Outputs::new();
    outputs.write(&options.output, &document.finish(material.as_ref(), packed))?;
    report.files = outputs.commit()?;
    output::say_report(&report, options.json, || {
        let Report { bodies, modes, warnings, .. } = &report;
        format!("{}: {bodies} bodies, {modes} modes{}", options.output.display(), output::warned(warnings))
    })
}

/// Document so far.
#[derive(Default)]
struct Document {
    binary: Binary,
    models: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl Document {
    fn body(&mut self, name: &str, model: &ModalModel, shapes: &ModeShapes, has_material: bool) {
        let column = |of: &dyn Fn(&asperity::Mode) -> f64| {
            model.modes.iter().map(|mode| of(mode) as f32).collect::<Vec<_>>()
        };
        let points: Vec<[f32; 3]> = shapes.points_m.iter().map(|point| point.map(|x| x as f32)).collect();
        let motions: Vec<[f32; 3]> = shapes.phi_per_sqrt_kg.iter().flatten().copied().collect();
        let positions = self.binary.vectors(&points, true);
        let indices = self.binary.indices(shapes.triangles.as_flattened());
        let mut entry = json!({
            "name": name,
            "frequencies": self.binary.scalars(&column(&|mode| mode.frequency_hz)),
            "decayRates": self.binary.scalars(&column(&|mode| mode.decay_per_s)),
            "positions": positions,
            "shapes": self.binary.vectors(&motions, false),
            "indices": indices,
        });
        if has_material {
            entry["material"] = json!(0);
        }
        let index = self.models.len();
        self.models.push(entry);
        self.meshes.push(json!({"name": name, "primitives": [{"attributes": {"POSITION": positions}, "indices": indices}]}));
        self.nodes
            .push(json!({"name": name, "mesh": index, "extensions": {EXTENSION: {"modalModel": index}}}));
    }

    fn finish(self, material: Option<&Material>, packed: bool) -> Vec<u8> {
        let mut extension = json!({"modalModels": self.models});
        if let Some(m) = material {
            extension["acousticMaterials"] = json!([{
                "density": m.density_kg_m3, "youngsModulus": m.young_pa, "poissonRatio": m.poisson,
                "alpha": m.alpha_per_s, "beta": m.beta_s,
            }]);
        }
        let all: Vec<usize> = (0..self.nodes.len()).collect();
        let document = json!({
            "asset": {"version": "2.0", "generator": "asperity"},
            "extensionsUsed": [EXTENSION],
            "scene": 0, "scenes": [{"nodes": all}],
            "nodes": self.nodes, "meshes": self.meshes,
            "extensions": {EXTENSION: extension},
        });
        self.binary.close(document, packed)
    }
}
