//! `asperity strike WHAT -o DIR`: what a thing sounds like when it is hit, without a scene and
//! without a log.

use crate::arguments::{plain, positive, three};
use crate::error::CliError;
use crate::fit;
use crate::paths::has_end;
use crate::scene_log::rounded;
use crate::sounds::{self, Folder, MOST_TAIL_S, Sound, Told, short, stem, take_suffix};
use asperity::files::contact_log::{ContactLog, LogEvent, LogHand, LogLine, Striker};
use asperity::{Material, ModalModel, Stock};
use asperity_dsp::rng::Rng;
use asperity_dsp::vector::longest_side;
use clap::Args;
use std::path::PathBuf;
use toml::{Table, Value};

/// Falls by 80 dB in this over the decay, as a power of e.
const RUNG_OUT: f64 = 9.21;
/// Shortest ring-out that is looked at, s.
const LEAST_TAIL_S: f64 = 0.3;
/// Rebound over approach speed of a hand-held striker. Source: assumed.
const RESTITUTION: f64 = 0.5;
/// Spread of takes: speed, mass and radius of the striker as ratios (standard deviation of their
/// logarithms), the place over the body's size. Source: assumed; drummers who repeat a stroke
/// spread by 5 to 15 % in force.
const SPREAD: [f64; 4] = [0.1, 0.05, 0.15, 0.02];
/// Milliseconds of what a recording has besides modes, kept as `asperity fit --burst-ms 40` does.
const BURST_MS: f64 = 40.0;

/// Hit a thing and write what it sounds like, with the scene and the log of each sound beside it
#[derive(Debug, Args)]
pub struct Options {
    /// A modes file (.json), a recording of a hit (fitted first), or a stock body: bar, bowl, can,
    /// …
    #[arg(value_name = "MODES.json|RECORDING|STOCK")]
    pub what: PathBuf,
    /// Material of the body [default: for a stock body the usual one]
    #[arg(long, value_name = "NAME", value_parser = material)]
    pub material: Option<Material>,
    /// Longest side or diameter of a stock body, m [default: the usual one]
    #[arg(long, value_name = "M")]
    pub size: Option<f64>,
    /// Materials of what hits it
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',', default_value = "wood", value_parser = material)]
    pub with: Vec<Material>,
    /// Speeds, m/s
    #[arg(long, value_name = "M_S", num_args = 1.., value_delimiter = ',', default_value = "1", value_parser = positive)]
    pub speeds: Vec<f64>,
    /// Place, m, in the frame of a body with shapes (`asperity modes`)
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    pub at: Option<[f64; 3]>,
    /// Which of the body's strike positions, from 0, where it has no shapes
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "at")]
    pub position: usize,
    /// Mass of the striker, kg
    #[arg(long, value_name = "KG", default_value_t = 0.02, value_parser = positive)]
    pub mass: f64,
    /// Radius of the striker where it hits, m
    #[arg(long, value_name = "M", default_value_t = 0.008, value_parser = positive)]
    pub radius: f64,
    /// Folder, format, takes
    #[command(flatten)]
    pub sounds: sounds::Options,
}

/// Slowest decay of all that rings of a body, 1/s: its modes, and its noise bands; infinite where
/// there is nothing.
pub fn slowest_per_s(model: &ModalModel) -> f64 {
    let bands = model.diffuse.iter().flat_map(|diffuse| &diffuse.bands);
    let modes = model.modes.iter().map(|mode| mode.decay_per_s);
    let bands = bands.flat_map(|band| &band.parts).map(|part| part.decay_per_s);
    modes.chain(bands).fold(f64::INFINITY, f64::min)
}

/// A material of the command line.
fn material(name: &str) -> Result<Material, String> {
    Material::by_name(name).ok_or_else(|| format!("must be one of: {}", Material::names()))
}

fn place(text: &str) -> Result<[f64; 3], String> {
    three(text, " in metres, such as 0.07,0,0.1")
}

/// Runs the verb.
///
/// # Errors
/// When the body is none, an option does not fit it, or a file cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let kind = Kind::of(options)?;
    let folder = Folder::open(&options.sounds.output)?;
    let (body, mut remarks) = Body::of(options, &kind, &folder)?;
    body.check(options)?;
    if options.at.is_none() && body.model.shapes.is_some() {
        remarks.assumed.push("hit where its modes file says (--at X,Y,Z hits another place)".to_owned());
    }
    let sounds = body.sounds(options);
    let inputs = [options.what.clone()];
    sounds::make(&sounds, &options.sounds, &folder, &inputs, remarks)
}

/// Meaning of the first argument.
enum Kind {
    Stock(Stock),
    Modes,
    Recording,
}

impl Kind {
    fn of(options: &Options) -> Result<Self, CliError> {
        let what = &options.what;
        let kind = match Stock::by_name(&what.to_string_lossy()) {
            Some(stock) if !what.is_file() => Self::Stock(stock),
            _ if !what.exists() => {
                let right = format!("name a modes file, a recording, or one of: {}", Stock::names());
                return Err(CliError::file(what, "is no file and no stock body", right));
            }
            _ if has_end(what, &["json"]) => Self::Modes,
            _ if has_end(what, &["obj", "stl", "msh", "glb", "gltf", "ply"]) => {
                let right = "run `asperity modes` on it, and strike the modes file";
                return Err(CliError::file(what, "is a mesh", right));
            }
            _ if has_end(what, &["png", "jpg", "jpeg", "toml", "exr"]) => {
                let right = "`asperity stroke` takes maps, photographs and the surfaces of scenes, \
                             `asperity render` a scene with its log";
                return Err(CliError::file(what, "is nothing to strike", right));
            }
            _ => Self::Recording,
        };
        if options.size.is_some() && !matches!(kind, Self::Stock(_)) {
            let right = "leave it out; `asperity fit --scale-size` makes a fitted body larger";
            return Err(CliError::new("--size", "is for stock bodies", right));
        }
        Ok(kind)
    }
}

/// Body that rings.
struct Body {
    name: String,
    /// Its `[[body]]`, paths absolute.
    table: Table,
    model: ModalModel,
}

impl Body {
    fn of(options: &Options, kind: &Kind, folder: &Folder) -> Result<(Self, Told), CliError> {
        let mut table = Table::new();
        table.insert("name".into(), Value::String("body".into()));
        // Loudness is the set's; beside strokes there is nothing to be turned down for.
        table.insert("strike_gain".into(), Value::Float(1.0));
        let mut remarks = Told::default();
        let modes = match kind {
            Kind::Stock(stock) => {
                let (material, size_m) = stock.usual();
                let size_m = options.size.unwrap_or(size_m);
                let material = options.material.unwrap_or(material);
                let name = options.what.to_string_lossy().into_owned();
                let of = material.name().unwrap_or_default();
                if options.size.is_none() || options.material.is_none() {
                    remarks.assumed.push(format!("a {name} of {of}, {size_m} m (--material, --size)"));
                }
                let model = stock.modes(&material, size_m).map_err(CliError::from_error)?;
                table.insert("stock".into(), Value::String(name.clone()));
                table.insert("size_m".into(), Value::Float(size_m));
                table.insert("material".into(), Value::String(of.to_owned()));
                return Ok((Self { name: format!("{of}-{name}"), table, model }, remarks));
            }
            Kind::Modes => options.what.clone(),
            Kind::Recording => {
                let modes = folder.path().join(format!("{}.struck.modes.json", stem(&options.what)));
                let fitted =
                    fit::fit(&fit::Options { burst_ms: Some(BURST_MS), ..plain(&options.what, &modes)? })?;
                remarks.assumed.push(format!(
                    "fitted {}: {} modes, {:.0} dB above what they leave, in {}",
                    options.what.display(),
                    fitted.modes,
                    fitted.resynthesis_snr_db,
                    modes.display()
                ));
                remarks.warnings = fitted.warnings;
                modes
            }
        };
        let model = ModalModel::load(&modes).map_err(CliError::from_error)?;
        table.insert("modes".into(), Value::String(modes.to_string_lossy().into_owned()));
        if let Some(name) = options.material.and_then(|material| material.name()) {
            table.insert("material".into(), Value::String(name.to_owned()));
        } else {
            let assumed = "hit as if it were of PLA, which a hard striker dents (--material says what it is)";
            remarks.assumed.push(assumed.to_owned());
        }
        let home = std::env::current_dir().unwrap_or_default();
        let table = sounds::with_absolute_paths(&table, &home);
        Ok((Self { name: stem(&options.what), table, model }, remarks))
    }

    /// Refuses a place that the body does not have.
    fn check(&self, options: &Options) -> Result<(), CliError> {
        let what = options.what.display();
        if options.at.is_some() && self.model.shapes.is_none() {
            let right =
                "leave it out, or take a body of `asperity modes`; --position takes its strike positions";
            return Err(CliError::new("--at", format!("{what} has no shapes"), right));
        }
        let count = self.model.position_count();
        if options.position >= count {
            let places = asperity_plot::counted(count as u64, "strike position");
            let right =
                if count == 1 { "leave it out".to_owned() } else { format!("must be 0 to {}", count - 1) };
            return Err(CliError::new("--position", format!("{what} has {places}"), right));
        }
        if slowest_per_s(&self.model).is_infinite() && self.model.residual.is_none() {
            let rings = "rings outside 16 Hz to 20 kHz only, and has no noise bands";
            return Err(CliError::new(what, rings, "name another --size, --material or body"));
        }
        Ok(())
    }

    fn sounds(&self, options: &Options) -> Vec<Sound> {
        let slowest_per_s = slowest_per_s(&self.model).max(1e-3);
        let tail_s = (RUNG_OUT / slowest_per_s).clamp(LEAST_TAIL_S, MOST_TAIL_S);
        let mut scene = Table::new();
        scene.insert("body".into(), Value::Array(vec![Value::Table(self.table.clone())]));
        let mut sounds = Vec::new();
        for striker in &options.with {
            for speed_m_s in &options.speeds {
                for take in 1..=options.sounds.takes {
                    let name = format!(
                        "{}-{}-{}m_s{}",
                        self.name,
                        striker.name().unwrap_or("striker"),
                        short(*speed_m_s),
                        take_suffix(take, options.sounds.takes)
                    );
                    let event = self.impact(options, striker, *speed_m_s, take);
                    let log = ContactLog { lines: vec![LogLine { t: 0.0, event }] };
                    sounds.push(Sound { name, scene: scene.clone(), log, tail_s, is_felt: false, cut: None });
                }
            }
        }
        sounds
    }

    /// One hit. The first take is exact; further ones differ as a hand does.
    fn impact(&self, options: &Options, striker: &Material, speed_m_s: f64, take: u16) -> LogEvent {
        let mut rng = Rng::new(options.sounds.seed.wrapping_mul(1000).wrapping_add(u64::from(take)));
        let mut spread = |share: f64| if take == 1 { 0.0 } else { share * rng.normal().clamp(-2.5, 2.5) };
        let [faster, heavier, rounder, aside] = SPREAD;
        let at_m = self.model.shapes.as_ref().map(|shapes| {
            let at_m = options.at.unwrap_or(shapes.points_m[shapes.struck_point]);
            let size_m = longest_side(&shapes.points_m);
            at_m.map(|x| rounded(x + size_m * spread(aside), 9))
        });
        LogEvent::Impact {
            body: "body".to_owned(),
            other: None,
            speed_m_s: rounded(speed_m_s * spread(faster).exp(), 9),
            mass_kg: rounded(options.mass * spread(heavier).exp(), 9),
            radius_m: rounded(options.radius * spread(rounder).exp(), 9),
            striker: Striker::from(*striker),
            restitution: RESTITUTION,
            position: options.position,
            at_m,
            direction: None,
            hand: LogHand::default(),
        }
    }
}
