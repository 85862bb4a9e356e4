//! Ground: what is stroked, as a scene.

use super::Options;
use crate::arguments::plain;
use crate::error::CliError;
use crate::paths::has_end;
use crate::sounds::{Folder, Told, stem, with_absolute_paths};
use crate::strike::slowest_per_s;
use crate::texture::from_photo;
use asperity::files::scene_file::{SceneFile, Source};
use asperity::{Material, ModalModel, PROBE_PRESETS, Wrap};
use asperity_pictures::from_photo::TEXEL_M;
use asperity_surface::image_io::{Channel, load_channel};
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Height of white over black of a map that does not say, m.
const RELIEF_M: f64 = 1e-3;
/// Material of a map's body where nothing is said, and its side, m: a plate, but a sheet or a
/// cushion of what does not ring.
const BODY: (&str, f64) = ("wood", 0.2);
/// Bodies of what does not ring: stock, side, m, and materials.
const SOFT: [(&str, f64, [&str; 5]); 2] = [
    ("sheet", 0.5, ["cloth", "denim", "leather", "cardboard", "paper"]),
    ("cushion", 0.4, ["foam", "carpet", "soil", "cork", "skin"]),
];
/// A picture whose red and blue differ by more than this in the mean is a photograph.
const COLOURED: f64 = 0.01;

/// Ground that is stroked.
pub struct Ground {
    /// A name for files.
    pub name: String,
    /// The scene, its paths absolute.
    scene: Table,
    /// Name of the surface.
    pub surface: String,
    /// Metres that uv 1 spans.
    pub extent_m: [f64; 2],
    /// True where there is ground beyond its edges.
    pub runs_on: bool,
    /// Name of the default probe, for files.
    pub probe: String,
    /// Wait for what rings, s.
    pub tail_s: f64,
    /// Every file that is read.
    pub inputs: Vec<PathBuf>,
}

impl Ground {
    /// Meaning of the first argument, and remarks on it; a photograph's maps are made below the
    /// folder first.
    ///
    /// # Errors
    /// When it is nothing to stroke.
    pub fn of(options: &Options, folder: &Folder) -> Result<(Self, Told), CliError> {
        let what = &options.what;
        if what.is_dir() {
            let scene = what.join("scene.toml");
            if !scene.is_file() {
                let right = "name a folder that `asperity texture from-photo` made, a map or a scene";
                return Err(CliError::file(what, "is a folder without a scene.toml", right));
            }
            let name = what.canonicalize().map_or_else(|_| "surface".to_owned(), |path| stem(&path));
            return Ok((Self::of_scene(options, &scene, name)?, Told::default()));
        }
        if !what.is_file() {
            let right = "name a map, a photograph, a folder of from-photo or a scene; \
                         `asperity texture solid granite -o granite.png` makes a map";
            return Err(CliError::file(what, "no such file", right));
        }
        if has_end(what, &["toml"]) {
            return Ok((Self::of_scene(options, what, stem(what))?, Told::default()));
        }
        if has_end(what, &["wav", "flac", "ogg", "mp3", "aiff", "m4a", "json"]) {
            let right = "`asperity strike` takes recordings and modes files";
            return Err(CliError::file(what, "is nothing to stroke", right));
        }
        if is_photograph(what)? { Self::of_photo(options, folder) } else { Self::of_map(options) }
    }

    fn of_photo(options: &Options, folder: &Folder) -> Result<(Self, Told), CliError> {
        let material = options.material.as_deref();
        let body = material.map(|material| body_of(material, "plate")).transpose()?;
        let name = stem(&options.what);
        let maps = folder.path().join(format!("{name}-surface"));
        let report = from_photo::make(&from_photo::Options {
            width_m: options.width_m,
            relief_m: options.relief_m,
            ..plain(&options.what, &maps)?
        })?;
        let mut assumed =
            vec![format!("a photograph, {}; its maps are in {}", report.width_in_words(), maps.display())];
        if body.is_none() {
            assumed.push("on a free bar, whatever the picture shows (--material NAME: a plate of it)".into());
        }
        let remarks = Told { assumed, warnings: report.warnings().to_vec() };
        let plain = Options { width_m: None, relief_m: None, material: None, ..options.clone() };
        let mut ground = Self::of_scene(&plain, &maps.join("scene.toml"), name)?;
        if let Some(body) = body {
            let mut scene = ground.scene;
            scene.insert("body".into(), Value::Array(vec![Value::Table(body)]));
            ground = Self { inputs: ground.inputs, ..Self::of_table(&plain, scene, &maps, ground.name)? };
        }
        ground.inputs.push(options.what.clone());
        Ok((ground, remarks))
    }

    fn of_map(options: &Options) -> Result<(Self, Told), CliError> {
        let what = &options.what;
        let map = load_channel(what, Channel::Luma).map_err(CliError::from_error)?.raster;
        let mut assumed = Vec::new();
        let width_m = options.width_m.unwrap_or_else(|| {
            let width_m = TEXEL_M * map.width as f64;
            assumed
                .push(format!("a height map, taken to be {} mm wide (--width-m)", (1e3 * width_m).round()));
            width_m
        });
        let relief_m = options.relief_m.unwrap_or_else(|| {
            assumed.push(format!("white taken to be {} mm above black (--relief-m)", 1e3 * RELIEF_M));
            RELIEF_M
        });
        let material = options.material.as_deref().unwrap_or(BODY.0);
        let body = body_of(material, "body")?;
        let named = if options.material.is_none() { " (--material)" } else { "" };
        let (stock, size_m) = (body["stock"].as_str().unwrap_or_default(), &body["size_m"]);
        assumed.push(format!("on a {stock} of {material}, {size_m} m{named}"));
        let path = fs::canonicalize(what).map_err(|error| CliError::read(what, &error))?;
        let text = |text: &str| Value::String(text.to_owned());
        let mut surface = Table::new();
        surface.insert("name".into(), text("map"));
        surface.insert("body".into(), text("body"));
        surface.insert("displacement".into(), text(&path.to_string_lossy()));
        surface.insert("width_m".into(), Value::Float(width_m));
        surface.insert("height_m".into(), Value::Float(width_m * map.height as f64 / map.width as f64));
        surface.insert("relief_m".into(), Value::Float(relief_m));
        let mut scene = Table::new();
        scene.insert("body".into(), Value::Array(vec![Value::Table(body)]));
        scene.insert("surface".into(), Value::Array(vec![Value::Table(surface)]));
        let home = path.parent().unwrap_or(Path::new(""));
        Ok((Self::of_table(options, scene, home, stem(what))?, Told { assumed, ..Told::default() }))
    }

    fn of_scene(options: &Options, path: &Path, name: String) -> Result<Self, CliError> {
        for (option, is_given) in [
            ("--width-m", options.width_m.is_some()),
            ("--relief-m", options.relief_m.is_some()),
            ("--material", options.material.is_some()),
        ] {
            if is_given {
                let right = match option {
                    "--material" => format!(
                        "write stock = \"plate\", size_m = {} and material = … for the body in {}, in place of modes",
                        BODY.1,
                        path.display()
                    ),
                    _ => format!("change it in {}", path.display()),
                };
                return Err(CliError::new(option, "is for maps and photographs", right));
            }
        }
        let file = SceneFile::load(path)?;
        let text = fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
        let scene: Table = text.parse().map_err(CliError::from_error)?;
        let home = file.path.parent().unwrap_or(Path::new("")).to_owned();
        let mut ground = Self::of_table(options, with_absolute_paths(&scene, &home), &home, name)?;
        ground.inputs.push(path.to_owned());
        ground.inputs.extend(file.contacts.clone());
        Ok(ground)
    }

    fn of_table(options: &Options, scene: Table, home: &Path, name: String) -> Result<Self, CliError> {
        let text = toml::to_string(&scene).map_err(CliError::from_error)?;
        let file = SceneFile::parse(&text, &home.join("scene.toml"))?;
        let named = |name: &String| file.surfaces.iter().find(|surface| surface.name == *name);
        let surface = match &options.surface {
            None => file.surfaces.first(),
            Some(name) => named(name),
        };
        let surface = surface.ok_or_else(|| {
            let names: Vec<&str> = file.surfaces.iter().map(|surface| surface.name.as_str()).collect();
            match (&options.surface, names.is_empty()) {
                (Some(name), false) => {
                    let right = format!("must be one of: {}", names.join(", "));
                    CliError::new("--surface", format!("\"{name}\" is unknown"), right)
                }
                _ => CliError::file(
                    &options.what,
                    "has no surface",
                    "write a [[surface]]; blows are for a contact log and `asperity render`",
                ),
            }
        })?;
        let probe = scene.get("probe").and_then(|probe| probe.get("preset")).and_then(Value::as_str);
        Ok(Self {
            name,
            surface: surface.name.clone(),
            extent_m: [surface.width_m, surface.height_m],
            runs_on: surface.wrap != Wrap::Clamp && !matches!(surface.source, Source::Sand(_)),
            probe: probe.unwrap_or("fingertip").to_owned(),
            tail_s: tail_s(&file),
            inputs: file.named_files().into_iter().map(Path::to_owned).collect(),
            scene,
        })
    }

    /// The scene with a probe, and the name that contacts call it by; none where it is the default
    /// one.
    ///
    /// # Errors
    /// When there is no probe of that name.
    pub fn with_probe(&self, name: Option<&str>) -> Result<(Table, Option<String>), CliError> {
        let mut scene = self.scene.clone();
        let Some(name) = name else { return Ok((scene, None)) };
        let is_it = |probe: &Value| probe.get("name").and_then(Value::as_str) == Some(name);
        let probes = scene.get("probe").and_then(Value::as_array);
        if probes.is_some_and(|probes| probes.iter().any(is_it)) {
            return Ok((scene, Some(name.to_owned())));
        }
        if !PROBE_PRESETS.iter().any(|(known, _)| *known == name) {
            let known: Vec<&str> = PROBE_PRESETS.iter().map(|(known, _)| *known).collect();
            let right = format!("must be one of: {}, or a probe of the scene", known.join(", "));
            return Err(CliError::new("--probe", format!("\"{name}\" is unknown"), right));
        }
        let mut preset = Table::new();
        preset.insert("preset".into(), Value::String(name.to_owned()));
        match scene.get_mut("probe") {
            Some(Value::Array(probes)) => {
                preset.insert("name".into(), Value::String(name.to_owned()));
                probes.push(Value::Table(preset));
                Ok((scene, Some(name.to_owned())))
            }
            _ => {
                scene.insert("probe".into(), Value::Table(preset));
                Ok((scene, None))
            }
        }
    }
}

/// Wait for what rings, s.
fn tail_s(file: &SceneFile) -> f64 {
    let models = file.bodies.iter().filter_map(|body| match (&body.modes, &body.stock) {
        (Some(path), _) => ModalModel::load(path).ok(),
        (None, Some((stock, size_m))) => stock.modes(&body.material.unwrap_or(Material::PLA), *size_m).ok(),
        (None, None) => None,
    });
    let slowest_per_s = models.map(|model| slowest_per_s(&model)).fold(f64::INFINITY, f64::min);
    if slowest_per_s.is_finite() { (9.21 / slowest_per_s.max(1e-3)).clamp(0.3, 20.0) } else { 0.3 }
}

/// A body of a material, as a `[[body]]`.
fn body_of(material: &str, name: &str) -> Result<Table, CliError> {
    if Material::by_name(material).is_none() {
        let right = format!("must be one of: {}", Material::names());
        return Err(CliError::new("--material", format!("\"{material}\" is unknown"), right));
    }
    let soft = SOFT.iter().find(|(_, _, materials)| materials.contains(&material));
    let (stock, size_m) = soft.map_or(("plate", BODY.1), |(stock, size_m, _)| (stock, *size_m));
    let text = |text: &str| Value::String(text.to_owned());
    let mut body = Table::new();
    body.insert("name".into(), text(name));
    body.insert("stock".into(), text(stock));
    body.insert("size_m".into(), Value::Float(size_m));
    body.insert("material".into(), text(material));
    Ok(body)
}

/// A picture in colours is a photograph, as is a JPEG; a grey one is a map.
fn is_photograph(path: &Path) -> Result<bool, CliError> {
    if has_end(path, &["exr", "pgm"]) {
        return Ok(false);
    }
    if has_end(path, &["jpg", "jpeg"]) {
        return Ok(true);
    }
    let of =
        |channel| Ok::<_, CliError>(load_channel(path, channel).map_err(CliError::from_error)?.raster.values);
    let (red, blue) = (of(Channel::R)?, of(Channel::B)?);
    let apart: f64 = red.iter().zip(&blue).map(|(red, blue)| (red - blue).abs()).sum();
    Ok(apart > COLOURED * red.len() as f64)
}
