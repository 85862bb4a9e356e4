//! Options of `asperity modes`, and what they say about the body.

use crate::arguments::{Words, one_of};
use crate::error::CliError;
use crate::unwrap::UnwrapOptions;
use asperity::Material;
use asperity_dsp::damping::Damping;
use asperity_shape::Elastic;
use asperity_shape::eigenmodes::Wanted;
use clap::Args;
use std::path::PathBuf;

/// The lowest so many modes, where nothing else is said.
const ORDINARY_MODES: usize = 64;
/// And none beyond what is heard, Hz.
const HEARD_HZ: f64 = 20_000.0;

/// Turn the shape of a body into modes that ring wherever it is struck
#[derive(Debug, Args)]
pub struct Options {
    /// Shape of the body in metres: its surface (.obj, .stl, .ply, .glb, .gltf), or tetrahedra or
    /// its surface from Gmsh (.msh 2.2, 4.1)
    #[arg(value_name = "BODY.(obj|stl|ply|glb|gltf|msh)")]
    pub body: PathBuf,
    /// Modes file to write
    #[arg(short, long = "output", value_name = "OUT.modes.json")]
    pub output: PathBuf,
    /// Material: a preset
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Young's modulus, Pa, instead of the material's
    #[arg(long, value_name = "PA")]
    pub young_pa: Option<f64>,
    /// Poisson's ratio, 0 to 0.49, instead of the material's
    #[arg(long, value_name = "NU")]
    pub poisson: Option<f64>,
    /// Density, kg/m³, instead of the material's
    #[arg(long, value_name = "KG_M3")]
    pub density_kg_m3: Option<f64>,
    /// One of the file's parts: an object or a group of an .obj, a solid of an .stl, a node or a
    /// mesh of a glTF, or `largest`
    #[arg(long, value_name = "NAME")]
    pub part: Option<String>,
    /// Unit of the file's numbers, metres where nothing is said
    #[arg(long, value_name = "UNIT", value_parser = one_of(UNITS), conflicts_with = "size")]
    pub unit: Option<f64>,
    /// Longest side, m: scales the mesh about the origin of its frame
    #[arg(long, value_name = "M")]
    pub size: Option<f64>,
    /// The surface is a sheet of this thickness, m, half of it on either side
    #[arg(long, value_name = "M")]
    pub thickness: Option<f64>,
    /// Damping of a recorded body of the same material: its modes file
    #[arg(long, value_name = "HIT.modes.json")]
    pub damping_from: Option<PathBuf>,
    /// Finds the level of each mode in the air at 1 m, in pascals, and its radiation loss; without
    /// this levels are relative
    #[arg(long)]
    pub radiation: bool,
    /// Write the shapes into a file of their own, OUT.shapes, a fifth as large
    #[arg(long)]
    pub shapes_beside: bool,
    /// Write the shapes into a glTF document of their own, OUT.glb, that viewers of meshes open
    #[arg(long, conflicts_with = "shapes_beside")]
    pub shapes_glb: bool,
    /// Texture coordinates: into OUT.uv.glb
    #[command(flatten)]
    pub unwrap: UnwrapOptions,
    /// Every mode below this frequency, Hz
    #[arg(long, value_name = "HZ")]
    pub up_to: Option<f64>,
    /// The lowest so many modes; without this and --up-to 64, as far as 20 kHz
    #[arg(long, value_name = "N")]
    pub max_modes: Option<usize>,
    /// Picture of the first shapes, the frequencies and the damping
    #[arg(long, value_name = "OUT.svg")]
    pub plot: Option<PathBuf>,
    /// Print the report as JSON
    #[arg(long)]
    pub json: bool,
}

/// Units of the numbers of a mesh, m.
const UNITS: Words<f64, 4> = [
    ("mm", "Millimetres", 1e-3),
    ("cm", "Centimetres", 1e-2),
    ("in", "Inches", 0.0254),
    ("m", "Metres", 1.0),
];

impl Options {
    /// Which modes to solve for.
    pub fn wanted(&self) -> Result<Wanted, CliError> {
        if let Some(hz) = self.up_to.filter(|hz| !(*hz >= 1.0 && *hz <= 1e6)) {
            return Err(CliError::new("--up-to", format!("{hz} is refused"), "must be 1 to 1e6 Hz"));
        }
        let most = asperity_shape::eigenmodes::MOST_MODES;
        if let Some(n) = self.max_modes.filter(|n| !(1..=most).contains(n)) {
            return Err(CliError::new(
                "--max-modes",
                format!("{n} is refused"),
                format!("must be 1 to {most}"),
            ));
        }
        Ok(match (self.up_to, self.max_modes) {
            (None, None) => Wanted { up_to_hz: Some(HEARD_HZ), most: ORDINARY_MODES },
            (up_to_hz, most) => Wanted { up_to_hz, most: most.unwrap_or(usize::MAX) },
        })
    }

    /// Material and its damping.
    pub fn material(&self) -> Result<(Elastic, Damping), CliError> {
        let preset = self.material.as_deref().map(preset).transpose()?;
        let missing = |option: &str| {
            let right = "give it, or --material NAME, which has all three";
            CliError::new(option, "is missing", right)
        };
        let young_pa = self.young_pa.or(preset.map(|m| m.young_pa)).ok_or_else(|| {
            if self.poisson.is_none() && self.density_kg_m3.is_none() {
                let right = format!("must be one of {}", Material::names());
                return CliError::new("--material", "is missing", right);
            }
            missing("--young-pa")
        })?;
        let poisson = self.poisson.or(preset.map(|m| m.poisson)).ok_or_else(|| missing("--poisson"))?;
        let density_kg_m3 = self
            .density_kg_m3
            .or(preset.map(|m| m.density_kg_m3))
            .ok_or_else(|| missing("--density-kg-m3"))?;
        let elastic = Elastic { young_pa, poisson, density_kg_m3 }.checked().map_err(CliError::from_error)?;
        Ok((elastic, self.damping(preset)?))
    }

    fn damping(&self, preset: Option<Material>) -> Result<Damping, CliError> {
        let Some(path) = &self.damping_from else {
            return Ok(preset.unwrap_or(Material::PLA).damping());
        };
        let recorded = asperity::ModalModel::load(path).map_err(CliError::from_error)?;
        asperity_shape::damping_fit::fit(&recorded.modes).ok_or_else(|| {
            CliError::file(path, "has no damped mode to learn from", "name the modes file of a recording")
        })
    }
}

/// The material that `--material` names.
pub fn preset(name: &str) -> Result<Material, CliError> {
    Material::by_name(name).ok_or_else(|| {
        let right = format!("must be one of {}", Material::names());
        CliError::new("--material", format!("{name} is unknown"), right)
    })
}
