//! A stroke: the scene and the contact log of one number of a data set, and what they render to.

use crate::distribution::{drawn, drawn_table};
use crate::draw::Draws;
use crate::force::{ForceTable, ForceWatch};
use crate::path::{Motion, Shape};
use crate::spec::{Finger, Output, Spec};
use crate::surfaces::{Choice, split};
use asperity::files::FileError;
use asperity::files::contact_log::ContactLog;
use asperity::files::scene_file::SceneFile;
use asperity::load::{Maps, Overrides};
use asperity::offline::{self, Options, Render};
use asperity::{Engine, Quantity};
use std::path::Path;
use toml::{Table, Value};

/// Contacts that a record needs: room for 64 takes longer to make than a short stroke to render.
const FINGERS: usize = 1;
/// Longest stroke, s.
const MOST_S: f64 = 600.0;

/// Draws for one stroke.
#[derive(Debug, Clone)]
pub struct Stroke {
    /// Its number in twelve digits.
    pub id: String,
    /// `train`, `validation` or `test`.
    pub split: &'static str,
    /// Name of the surface.
    pub surface: String,
    /// Scene file, with paths relative to the data set's folder.
    pub scene: String,
    /// Contact log, JSON Lines.
    pub contacts: String,
    /// Motion of the finger.
    pub motion: Motion,
    /// Parsed `scene`.
    file: SceneFile,
    /// Parsed `contacts`.
    log: ContactLog,
}

/// Levels that hold for every stroke of a data set, so that strokes can be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct DataLevels {
    /// Metres or m/s² at sample value 1 of each quantity.
    pub full_scale: Vec<f64>,
    /// Gain of the sound.
    pub gain: f64,
}

impl Stroke {
    /// The stroke of that number.
    ///
    /// # Errors
    /// When a draw is out of its range; the message names the field and the stroke.
    pub fn drawn(
        spec: &Spec,
        choices: &[Choice],
        levels: Option<&DataLevels>,
        number: u64,
        folder: &Path,
    ) -> Result<Self, FileError> {
        let draws = Draws { seed: spec.says.seed, stroke: number };
        let at = |error: FileError| error.within(format!("{}: stroke {number}", spec.path.display()));
        let place = draws.place("surface", choices.len());
        let choice = &choices[place];
        let id = format!("{number:012}");
        let motion = motion(spec, draws).map_err(at)?;
        let mut drawn = [(); 4].map(|()| Table::new());
        for (table, (written, field)) in drawn.iter_mut().zip(sections(spec, choice)) {
            *table = drawn_table(written, field, draws).map_err(at)?;
        }
        let table = scene_of(spec, drawn, levels, &id, draws.bits("scene.seed", 0)[0]);
        let scene = toml::to_string(&table).map_err(|error| at(FileError::from_error(error)))?;
        let file = SceneFile::parse(&scene, &folder.join(format!("{id}.toml"))).map_err(at)?;
        let touched = &file.surfaces[0];
        let log = motion.log(&touched.name, [touched.width_m, touched.height_m], draws);
        let contacts = log.to_jsonl();
        let split = split(spec, place, choices.len(), number);
        Ok(Self { id, split, surface: choice.name.clone(), scene, contacts, motion, file, log })
    }

    /// Renders the stroke: equal to what [`rendered`] makes of its two texts, without reading them.
    ///
    /// # Errors
    /// When the engine refuses the scene.
    pub fn rendered(&self, spec: &Spec, levels: &DataLevels, maps: &Maps) -> Result<Take, FileError> {
        render(&self.file, &self.log, (spec, levels), &self.id, maps)
    }
}

/// Outputs of a stroke.
#[derive(Debug, Clone, PartialEq)]
pub struct Take {
    /// Audio, and the first haptic quantity.
    pub render: Render,
    /// The further quantities.
    pub further: Vec<Vec<f32>>,
    /// The force and the path, where they are kept.
    pub force: Option<ForceTable>,
}

/// The scene and the contact log of a record, rendered: what `asperity render` makes of them, and
/// of the scene with another `output`.
///
/// # Errors
/// When either cannot be used.
pub fn rendered(
    scene: &str,
    contacts: &str,
    (spec, levels): (&Spec, &DataLevels),
    id: &str,
    folder: &Path,
    maps: &Maps,
) -> Result<Take, FileError> {
    let file = SceneFile::parse(scene, &folder.join(format!("{id}.toml")))?;
    let log = ContactLog::parse(contacts, id).map_err(FileError::from_error)?;
    render(&file, &log, (spec, levels), id, maps)
}

fn render(
    file: &SceneFile,
    log: &ContactLog,
    (spec, levels): (&Spec, &DataLevels),
    id: &str,
    maps: &Maps,
) -> Result<Take, FileError> {
    let overrides = Overrides {
        kernel: Some(spec.kernel()),
        maps: Some(maps),
        max_contacts: Some(FINGERS),
        ..Overrides::default()
    };
    let options = Options { tail_s: file.tail_s, ..Options::default() };
    let at = |error| FileError::from_error(error).within(id);
    let Engine { scene, renderer, names, .. } = Engine::from_scene(file, &overrides)?;
    let output = &spec.says.output;
    let (render, force) = match output.force {
        None => (offline::render(scene, renderer, log, &names, &options).map_err(at)?, None),
        Some(force) => {
            let mut watch = ForceWatch::new(force.rate_hz, renderer.sample_rate_hz());
            let render = offline::render_tapped(scene, renderer, log, &names, &options, &mut watch);
            (render.map_err(at)?, Some(watch.finish()))
        }
    };
    // A contact has one haptic channel: every further quantity is felt anew.
    let mut further = Vec::new();
    for (haptic, full_scale) in output.haptic.iter().zip(&levels.full_scale).skip(1) {
        let mut file = file.clone();
        if let Some(actuator) = file.actuators.first_mut() {
            actuator.settings.output = quantity(&haptic.output);
            actuator.full_scale = Some(*full_scale);
            actuator.felt_force_exponent = Some(haptic.exponent());
        }
        let Engine { scene, renderer, names, .. } = Engine::from_scene(&file, &overrides)?;
        let mut render = offline::render(scene, renderer, log, &names, &options).map_err(at)?;
        further.push(std::mem::take(&mut render.haptic[0]));
    }
    Ok(Take { render, further, force })
}

/// The quantity of a name that the specification has been checked for.
fn quantity(name: &str) -> Quantity {
    match name {
        "acceleration" => Quantity::Acceleration,
        "tangential" => Quantity::Tangential,
        "force" => Quantity::Force,
        _ => Quantity::Displacement,
    }
}

/// The levels of a data set: as its specification says, and where it is silent those that the level
/// policy finds for its first choice.
///
/// # Errors
/// When that scene cannot be opened.
pub fn data_levels(
    spec: &Spec,
    choices: &[Choice],
    folder: &Path,
    maps: &Maps,
) -> Result<DataLevels, FileError> {
    let (haptics, audio) = (&spec.says.output.haptic, &spec.says.output.audio);
    let mut levels = DataLevels { full_scale: Vec::new(), gain: audio.gain.unwrap_or(f64::NAN) };
    let first = Stroke::drawn(spec, &choices[..1], None, 0, folder)?;
    let overrides = Overrides { kernel: Some(spec.kernel()), maps: Some(maps), ..Overrides::default() };
    for haptic in haptics {
        if let (Some(full_scale), false) = (haptic.full_scale, levels.gain.is_nan()) {
            levels.full_scale.push(full_scale);
            continue;
        }
        let mut file = SceneFile::parse(&first.scene, &folder.join("levels.toml"))?;
        if let Some(actuator) = file.actuators.first_mut() {
            actuator.settings.output = quantity(&haptic.output);
        }
        let engine = Engine::from_scene(&file, &overrides)?;
        levels.full_scale.push(haptic.full_scale.unwrap_or(engine.levels.full_scale[0]));
        if levels.gain.is_nan() {
            levels.gain = engine.levels.gain[0];
        }
    }
    Ok(levels)
}

/// The numbers of a finger, each with its range and what would be right.
pub(crate) fn finger_numbers(finger: &Finger) -> [(&'static str, &Value, [f64; 2], &'static str); 4] {
    let reports = "must be 5 to 5000; a contact without a report for 0.25 s is let go";
    [
        ("speed_m_s", &finger.speed_m_s, [0.0, 10.0], "must be 0 to 10"),
        ("force_n", &finger.force_n, [0.0, 1e4], "must be above 0, up to 10000; a normal draw needs within"),
        ("duration_s", &finger.duration_s, [0.001, MOST_S], "must be 0.001 to 600"),
        ("reports_hz", &finger.reports_hz, [5.0, 5000.0], reports),
    ]
}

/// A drawn number within its range.
pub(crate) fn in_range(
    field: &str,
    value: &Value,
    [low, high]: [f64; 2],
    right: &str,
) -> Result<f64, FileError> {
    match value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64)) {
        Some(number) if (low..=high).contains(&number) => Ok(number),
        Some(number) => Err(FileError::new(field, format!("{number} is refused"), right)),
        None => Err(FileError::new(field, "is no number", "write a number or a distribution of numbers")),
    }
}

fn motion(spec: &Spec, draws: Draws) -> Result<Motion, FileError> {
    let finger = &spec.says.finger;
    let mut numbers = [0.0; 4];
    for (number, (name, value, range, right)) in numbers.iter_mut().zip(finger_numbers(finger)) {
        let field = format!("finger.{name}");
        *number = in_range(&field, &drawn(value, &field, draws)?, range, right)?;
    }
    let [speed_m_s, force_n, duration_s, reports_hz] = numbers;
    let shape = Shape::from_name(drawn(&finger.path, "finger.path", draws)?.as_str().unwrap_or_default())?;
    Ok(Motion { shape, speed_m_s, force_n, duration_s, reports_hz })
}

/// Tables that a stroke's scene is drawn from, with the field of each: the choice, and what the
/// specification says over it.
pub(crate) fn sections<'a>(spec: &'a Spec, choice: &'a Choice) -> [(&'a Table, &'a str); 4] {
    let says = &spec.says;
    [
        (&choice.scene, &*choice.name),
        (&says.surface.over, "surface"),
        (&says.body, "body"),
        (&says.probe, "probe"),
    ]
}

/// The choice's scene, with what the specification says over it, all drawn ([`sections`]).
pub(crate) fn scene_of(
    spec: &Spec,
    [mut scene, surface, of_body, probe]: [Table; 4],
    levels: Option<&DataLevels>,
    id: &str,
    seed: u64,
) -> Table {
    let touched = first(&mut scene, "surface");
    touched.extend(surface);
    if !of_body.is_empty() {
        let name = touched.get("body").cloned().unwrap_or_else(|| Value::String("body".into()));
        touched.insert("body".into(), name.clone());
        let body = first(&mut scene, "body");
        body.extend(of_body);
        body.insert("name".into(), name);
    }
    if !probe.is_empty() {
        scene.insert("probe".into(), Value::Table(probe));
    }
    // 63 bits are what TOML's whole numbers hold.
    scene.insert("seed".into(), Value::Integer((seed >> 1) as i64));
    scene.insert("contacts".into(), Value::String(format!("{id}.jsonl")));
    outputs(&mut scene, &spec.says.output, levels);
    scene
}

/// One haptic channel, of the first quantity, and one bus, at the rate of the sound.
fn outputs(scene: &mut Table, output: &Output, levels: Option<&DataLevels>) {
    scene.insert("sample_rate_hz".into(), Value::Float(output.audio.rate_hz));
    scene.insert("tail_s".into(), Value::Float(output.tail_s));
    let mut actuator = Table::new();
    actuator.insert("output".into(), Value::String(output.haptic[0].output.clone()));
    let mut audio = Table::new();
    if let Some(levels) = levels {
        actuator.insert("full_scale".into(), Value::Float(levels.full_scale[0]));
        actuator.insert("felt_force_exponent".into(), Value::Float(output.haptic[0].exponent()));
        audio.insert("gain".into(), Value::Float(levels.gain));
    }
    scene.insert("actuator".into(), Value::Array(vec![Value::Table(actuator)]));
    scene.insert("audio".into(), Value::Table(audio));
}

/// The first table of a list, made where there is none.
fn first<'a>(scene: &'a mut Table, key: &str) -> &'a mut Table {
    let list = scene.entry(key).or_insert_with(|| Value::Array(Vec::new()));
    if !list.is_array() {
        *list = Value::Array(Vec::new());
    }
    let list = list.as_array_mut().expect("made a list above");
    if list.first().is_none_or(|value| !value.is_table()) {
        list.insert(0, Value::Table(Table::new()));
    }
    list[0].as_table_mut().expect("made a table above")
}
