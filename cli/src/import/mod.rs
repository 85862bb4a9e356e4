//! `asperity import SCENE.gltf -o DIR`: a glTF document becomes a scene that renders, by the draft
//! `KHR_audio_rigid_bodies` or, without it, by its meshes and normal textures.

mod bodies;
pub mod extent;
mod finish;
mod plain;

use crate::error::CliError;
use crate::output::{self, Outputs, ensure_folder};
use crate::unwrap::UnwrapOptions;
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogHand, LogLine, Striker};
use asperity::files::scene_file::SceneFile;
use asperity_plot::pixels;
use asperity_shape::ShapeError;
use asperity_shape::gltf::{Document, Placed};
use asperity_shape::unwrap::Unwrapped;
use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The extension, as of the draft's commit 2ea03a8 of 2026-08-22.
pub const EXTENSION: &str = "KHR_audio_rigid_bodies";
/// Extensions that are read where a document requires them.
const READ: [&str; 3] = [EXTENSION, "KHR_mesh_quantization", "KHR_texture_transform"];
/// Most relief that a scene takes, m.
const MOST_RELIEF_M: f64 = 0.1;

impl From<ShapeError> for CliError {
    fn from(error: ShapeError) -> Self {
        Self::from_error(error)
    }
}

/// Make a scene of a glTF document: its acoustic bodies and surfaces (the draft
/// KHR_audio_rigid_bodies), or its meshes and normal textures
#[derive(Debug, Args)]
pub struct Options {
    /// The document
    #[arg(value_name = "SCENE.(gltf|glb)")]
    pub document: PathBuf,
    /// Folder to fill: scene.toml, contacts.jsonl, modes and heights
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// Material of bodies where the document has none: a preset
    #[arg(long, value_name = "NAME", default_value = "ceramic")]
    pub material: String,
    /// Make no bodies of meshes without the draft: each takes seconds to solve
    #[arg(long)]
    pub surfaces_only: bool,
    /// Texture coordinates: into NAME.glb, of meshes without the draft
    #[command(flatten)]
    pub unwrap: UnwrapOptions,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    bodies: usize,
    surfaces: usize,
    #[serde(skip_serializing_if = "Unwraps::is_none")]
    unwrap: Unwraps,
    warnings: Vec<String>,
    files: Vec<PathBuf>,
}

/// Meshes that were unwrapped: one as an object, several as a list.
#[derive(Debug, Default, Serialize)]
#[serde(untagged)]
enum Unwraps {
    #[default]
    None,
    One(Unwrap),
    Several(Vec<Unwrap>),
}

impl Unwraps {
    fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    fn of(mut all: Vec<Unwrap>) -> Self {
        if all.len() > 1 {
            return Self::Several(all);
        }
        all.pop().map_or(Self::None, Self::One)
    }
}

/// One unwrapped mesh.
#[derive(Debug, Serialize)]
struct Unwrap {
    file: String,
    #[serde(flatten)]
    unwrapped: Unwrapped,
}

/// Runs the verb.
///
/// # Errors
/// When the document is no glTF, its extension breaks the draft, a scene takes none of its numbers,
/// or a file cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let document = Document::read(&options.document)?;
    output::reads(document.files());
    let mut scene = Scene::of(&document, options)?;
    let text = scene.toml();
    SceneFile::parse(&text, Path::new("scene.toml"))
        .map_err(|error| CliError::from(error).within(options.document.display()))?;
    ensure_folder(&options.output)?;
    let mut outputs = Outputs::new();
    for (name, bytes) in &scene.files {
        outputs.write(&options.output.join(name), bytes)?;
    }
    outputs.write(&options.output.join("scene.toml"), text.as_bytes())?;
    outputs.write(&options.output.join("contacts.jsonl"), scene.contacts().as_bytes())?;
    let report = Report {
        bodies: scene.bodies.len(),
        surfaces: scene.surfaces.len(),
        unwrap: Unwraps::of(std::mem::take(&mut scene.unwrapped)),
        warnings: std::mem::take(&mut scene.remarks),
        files: outputs.commit()?,
    };
    output::say_report(&report, options.json, || {
        let Report { bodies, surfaces, warnings, .. } = &report;
        format!(
            "{}: {bodies} bodies, {surfaces} surfaces{}",
            options.output.display(),
            output::warned(warnings)
        )
    })
}

/// Bodies and surfaces of the nodes of a document.
#[derive(Default)]
struct Scene {
    bodies: Vec<(String, String)>,
    surfaces: Vec<(String, String)>,
    files: Vec<(String, Vec<u8>)>,
    unwrapped: Vec<Unwrap>,
    remarks: Vec<String>,
}

impl Scene {
    fn of(document: &Document, options: &Options) -> Result<Self, CliError> {
        let mut scene = Self::default();
        let maps = document.placed()?;
        let mut has_draft = false;
        for (index, node) in document.list("nodes").iter().enumerate() {
            let extension = &node["extensions"][EXTENSION];
            if let (true, Some(map)) = (extension.is_object(), &maps[index]) {
                has_draft = true;
                scene.node(document, node, extension, index, map)?;
            }
        }
        if !has_draft {
            scene.plain(document, &maps, options)?;
        }
        let required = document.list("extensionsRequired").iter().filter_map(Value::as_str);
        for name in required.filter(|name| !READ.contains(name)) {
            scene.remark(format!("{name}, which the document requires, is not read"));
        }
        if scene.bodies.is_empty() && scene.surfaces.is_empty() && scene.unwrapped.is_empty() {
            let right = format!(
                "must have a node with {EXTENSION}, or a closed mesh or a normal texture that a node places"
            );
            let why = scene.remarks.first().map_or(String::new(), |remark| format!(" ({remark})"));
            let what = format!("hold nothing that sounds or is touched{why}");
            return Err(document.wrong("nodes", what, &right).into());
        }
        Ok(scene)
    }

    fn remark(&mut self, what: String) {
        if !self.remarks.contains(&what) {
            self.remarks.push(what);
        }
    }

    fn node(
        &mut self,
        document: &Document,
        node: &Value,
        extension: &Value,
        index: usize,
        map: &Placed,
    ) -> Result<(), CliError> {
        let at = format!("nodes[{index}].extensions.{EXTENSION}");
        let root = &document.json["extensions"][EXTENSION];
        let entry = |list: &str, key: &str| -> Result<Option<&Value>, CliError> {
            if extension[key].is_null() {
                return Ok(None);
            }
            let found = extension[key].as_u64().and_then(|i| root[list].get(i as usize));
            let right = format!("must be the index of one of {list}");
            found.map(Some).ok_or_else(|| {
                let what = format!("{} is not there", extension[key]);
                document.wrong(format!("{at}.{key}"), what, &right).into()
            })
        };
        let gain = extension["gain"].as_f64().unwrap_or(1.0);
        if !(gain.is_finite() && gain >= 0.0) {
            return Err(document.wrong(format!("{at}.gain"), "is below 0", "must be 0 or more").into());
        }
        let name = format!("{}-{index}", plain(node["name"].as_str().unwrap_or("node")));
        let model = entry("modalModels", "modalModel")?;
        let surface = entry("acousticSurfaces", "acousticSurface")?;
        let material = |of: Option<&Value>| {
            of.and_then(|of| of["material"].as_u64()).and_then(|i| root["acousticMaterials"].get(i as usize))
        };
        if let Some(model) = model {
            let scale = |column: usize| map[column].iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0..3).any(|column| (scale(column) - 1.0).abs() > 1e-6) {
                let remark = "scales of nodes do not reach modes: they and their shapes are those of the model's own size";
                self.remark(remark.to_owned());
            }
            let text = bodies::modes(document, model, &format!("{at}.modalModel"), gain)?;
            let file = format!("{name}.modes.json");
            let mut table = format!("[[body]]\nname = {}\nmodes = {}\n", json!(name), json!(file));
            table.push_str(&stiffness(material(Some(model)).or(material(surface))));
            self.files.push((file, text.into_bytes()));
            self.bodies.push((name.clone(), table));
        }
        if let Some(surface) = surface {
            let body = model.is_some().then_some(name.as_str());
            let at = format!("{at}.acousticSurface");
            self.surface(document, (node, map), surface, &name, body, &at)?;
        }
        Ok(())
    }

    fn surface(
        &mut self,
        document: &Document,
        (node, map): (&Value, &Placed),
        surface: &Value,
        name: &str,
        body: Option<&str>,
        at: &str,
    ) -> Result<(), CliError> {
        let finish = finish::finish(document, surface, at)?;
        if !surface["profile"].is_null() {
            self.remark(
                "stored profiles are read past: their surfaces are made from roughness, length and slope"
                    .to_owned(),
            );
        }
        let texture = &surface["normalTexture"];
        let extent = extent::extent_m(document, node, map, texture)?;
        let mut table = format!("[[surface]]\nname = {}\n", json!(name));
        if let Some(body) = body {
            let _ = writeln!(table, "body = {}", json!(body));
        }
        self.heights(document, texture, extent, (name, &format!("{at}.normalTexture")), &mut table)?;
        let _ = writeln!(table, "roughness = {:?}", finish.roughness);
        let _ = writeln!(
            table,
            "micro_relief_m = {:?}\nouter_scale_m = {:?}",
            finish.micro_relief_m, finish.outer_scale_m
        );
        self.surfaces.push((name.to_owned(), table));
        Ok(())
    }

    /// Heights of a normal texture and the metres it spans, as lines of a surface's table.
    fn heights(
        &mut self,
        document: &Document,
        texture: &Value,
        [width_m, height_m]: [f64; 2],
        (name, at): (&str, &str),
        table: &mut String,
    ) -> Result<(), CliError> {
        let mut relief_m = 0.0;
        if texture.is_object() {
            let heights = finish::heights(document, texture, [width_m, height_m], at)?;
            relief_m = heights.relief_m;
            if relief_m > MOST_RELIEF_M {
                self.remark(format!("{name}: a relief of {relief_m:.3} m is held at {MOST_RELIEF_M} m"));
                relief_m = MOST_RELIEF_M;
            }
            let file = format!("{name}.heights.png");
            let _ = writeln!(table, "displacement = {}", json!(file));
            self.files.push((file, pixels::png16(heights.width, heights.height, &heights.grey)));
        }
        let _ = writeln!(table, "width_m = {width_m:?}\nheight_m = {height_m:?}");
        if relief_m > 0.0 {
            let _ = writeln!(table, "relief_m = {relief_m:?}");
        }
        Ok(())
    }

    fn toml(&self) -> String {
        let mut text = format!(
            "# From a glTF document (by {EXTENSION}, a draft, where it has that).\ncontacts = \"contacts.jsonl\"\ntail_s = 1.0\n"
        );
        for (_, table) in self.bodies.iter().chain(&self.surfaces) {
            let _ = write!(text, "\n{table}");
        }
        text.push_str("\n[[actuator]]\noutput = \"displacement\"\n");
        text
    }

    /// A strike on every body, then a stroke on every surface: the document says what there is, not
    /// what is done to it.
    fn contacts(&self) -> String {
        let (mut log, mut t) = (ContactLog::default(), 0.0);
        for (name, _) in &self.bodies {
            let event = LogEvent::strike(name.as_str(), 0.5, Striker::Preset("steel".into()), (0.01, 0.005));
            log.lines.push(LogLine { t, event });
            t += 0.5;
        }
        for (contact, (name, _)) in self.surfaces.iter().enumerate() {
            let samples = (0..=24).map(|step| {
                let part = f64::from(step) / 24.0;
                (t + 0.4 * part, ContactSample::new([0.2 + 0.6 * part, 0.5], 0.6))
            });
            let touching = (name.as_str(), LogHand::felt_by(0));
            log.lines.extend(LogLine::contact(contact as u64, touching, samples, t + 0.45));
            t = t + 0.45 + 0.1;
        }
        log.to_jsonl()
    }
}

/// A material's constants as a table; nothing where one is missing.
fn stiffness(material: Option<&Value>) -> String {
    let number = |key: &str| material.and_then(|m| m[key].as_f64());
    match (number("youngsModulus"), number("poissonRatio"), number("density")) {
        (Some(young), Some(poisson), Some(density)) => {
            format!(
                "material = {{ young_pa = {young:?}, poisson = {poisson:?}, density_kg_m3 = {density:?} }}\n"
            )
        }
        _ => String::new(),
    }
}

/// A name that a file may have.
fn plain(name: &str) -> String {
    let kept: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).take(60).collect();
    if kept.is_empty() { "node".to_owned() } else { kept }
}
