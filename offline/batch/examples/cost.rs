//! What a stroke of a data set costs, phase by phase, beside the engine alone.
//!
//! `cargo run --release -p asperity-batch --example cost -- SPEC.toml [STROKES [TIMES]]`
//!
//! Each stroke is made several times and the least time of each phase is taken, so that what else
//! runs on the machine does not count.

use asperity::Engine;
use asperity::files::contact_log::ContactLog;
use asperity::files::scene_file::SceneFile;
use asperity::load::{Maps, Overrides};
use asperity::offline::{self, Options};
use asperity_batch::record::{Record, Samples};
use asperity_batch::stroke::{DataLevels, Stroke, Take, data_levels};
use asperity_batch::surfaces::choices;
use asperity_batch::{Build, Spec, parquet_file};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

const PHASES: [&str; 6] = ["draw", "open", "engine", "encode", "write", "(read)"];

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().collect();
    let path = words.get(1).ok_or("name a specification")?;
    let number = |place: usize, missing: u64| words.get(place).map_or(Ok(missing), |word| word.parse());
    let (strokes, times) = (number(2, 100)?, number(3, 3)?);
    let spec = Spec::load(Path::new(path))?;
    let folder = std::env::temp_dir().join(format!("asperity-cost-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let choices = choices(&spec, &folder)?;
    let maps = Maps::default();
    let began = Instant::now();
    let levels = data_levels(&spec, &choices, &folder, &maps)?;
    println!("levels of the data set, once a shard: {:.1} ms", 1e3 * began.elapsed().as_secs_f64());
    let mut sums = [0.0; PHASES.len()];
    let (mut seconds, mut bytes) = (0.0, 0);
    for stroke in 0..strokes {
        let mut least = [f64::INFINITY; PHASES.len()];
        for _ in 0..times {
            let took = one(&spec, &choices, &levels, stroke, &folder, &maps, &mut seconds, &mut bytes)?;
            least.iter_mut().zip(took).for_each(|(least, took)| *least = least.min(took));
        }
        sums.iter_mut().zip(least).for_each(|(sum, least)| *sum += least);
    }
    std::fs::remove_dir_all(&folder)?;
    let each = sums.map(|sum| 1e3 * sum / strokes as f64);
    for (name, ms) in PHASES.iter().zip(each) {
        println!("{name:>7} {ms:8.3} ms a stroke, {:6.1} % of the engine", 100.0 * ms / each[2]);
    }
    let beside = each[0] + each[1];
    println!(
        "beside engine, encoding and writing: {:.1} % of the engine; {:.2} s and {:.0} kB a stroke, {:.2} ms in all",
        100.0 * beside / each[2],
        seconds / (strokes * times) as f64,
        bytes as f64 / 1e3 / (strokes * times) as f64,
        each[..5].iter().sum::<f64>()
    );
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        status.lines().filter(|line| line.starts_with("VmHWM")).for_each(|line| println!("{line}"));
    }
    Ok(())
}

#[allow(clippy::too_many_arguments, reason = "a bench of one function's insides")]
fn one(
    spec: &Spec,
    choices: &[asperity_batch::surfaces::Choice],
    levels: &DataLevels,
    number: u64,
    folder: &Path,
    maps: &Maps,
    seconds: &mut f64,
    bytes: &mut u64,
) -> Result<[f64; PHASES.len()], Box<dyn Error>> {
    let mut took = [0.0; PHASES.len()];
    let mut last = Instant::now();
    let mut lap = |place: usize| {
        took[place] = last.elapsed().as_secs_f64();
        last = Instant::now();
    };
    let stroke = Stroke::drawn(spec, choices, Some(levels), number, folder)?;
    lap(0);
    // Read beside the clock: the data set renders what it drew, not the text of it.
    let file = SceneFile::parse(&stroke.scene, &folder.join("stroke.toml"))?;
    let log = ContactLog::parse(&stroke.contacts, "stroke")?;
    lap(5);
    let overrides = Overrides {
        kernel: Some(spec.kernel()),
        maps: Some(maps),
        max_contacts: Some(1),
        ..Overrides::default()
    };
    let Engine { scene, renderer, names, .. } = Engine::from_scene(&file, &overrides)?;
    lap(1);
    let options = Options { tail_s: file.tail_s, ..Options::default() };
    let render = offline::render(scene, renderer, &log, &names, &options)?;
    lap(2);
    *seconds += render.haptic[0].len() as f64 / render.sample_rate_hz;
    let take = Take { render, further: Vec::new(), force: None };
    let samples = Samples::of(&stroke.id, take, &spec.says.output)?;
    lap(3);
    let mut shard = parquet_file::Shard::begin(Vec::new(), &Build::of(spec), &spec.says.output, &[])?;
    shard.add(Record { stroke, samples })?;
    *bytes += shard.finish()?.len() as u64;
    lap(4);
    Ok(took)
}
