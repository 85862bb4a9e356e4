//! What a stroke of a data set costs beside the engine.

use asperity::Engine;
use asperity::load::{Maps, Overrides};
use asperity::offline::{self, Options};
use asperity_batch::stroke::{Stroke, data_levels};
use asperity_batch::surfaces::choices;
use asperity_batch::{DataSet, Spec};
use std::path::Path;
use std::time::Instant;

/// Drawing and opening, of rendering alone: 10 % by instructions, 12 to 16 % by time as the
/// machine's memory is quick or slow on the day.
const MOST: f64 = 0.2;
/// The same where others keep the machine's memory busy: opening is made of it, rendering is not.
const MOST_BESIDE_OTHERS: f64 = 0.4;

#[test]
fn drawing_and_opening_cost_a_fifth_of_rendering_a_stroke() {
    if cfg!(debug_assertions) {
        return println!("skipped: an unoptimised build says nothing about cost");
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/batch/strokes.toml");
    let folder = tempfile::tempdir().unwrap();
    let spec = Spec::load(&path).unwrap();
    drop(DataSet::open(spec.clone(), folder.path()).unwrap());
    let choices = choices(&spec, folder.path()).unwrap();
    let maps = Maps::default();
    let levels = data_levels(&spec, &choices, folder.path(), &maps).unwrap();
    let (mut beside, mut engine) = (0.0, 0.0);
    for number in 0..24 {
        // The least of several: what else runs on the machine does not count.
        let mut least = [f64::INFINITY; 2];
        for _ in 0..6 {
            let began = Instant::now();
            let stroke = Stroke::drawn(&spec, &choices, Some(&levels), number, folder.path()).unwrap();
            let whole = stroke.rendered(&spec, &levels, &maps).unwrap().render;
            let all_s = began.elapsed().as_secs_f64();
            let alone_s = rendering_alone(&stroke, &spec, folder.path(), &maps, whole.haptic[0].len());
            least = [least[0].min(all_s), least[1].min(alone_s)];
        }
        beside += least[0] - least[1];
        engine += least[1];
    }
    let share = beside / engine;
    let most = if others_are_busy() { MOST_BESIDE_OTHERS } else { MOST };
    println!("beside the engine, without encoding: {:.1} %, at most {:.0} %", 100.0 * share, 100.0 * most);
    assert!(share <= most, "{share}");
}

/// Tests whether more wants to run than there are processors, by the system's own word; where it
/// has none, yes.
fn others_are_busy() -> bool {
    let processors = std::thread::available_parallelism().map_or(1.0, |count| count.get() as f64);
    let load = std::fs::read_to_string("/proc/loadavg").ok();
    let load = load.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    // This test is one of them.
    load.is_none_or(|load| load > processors)
}

/// Seconds that the engine takes for a stroke that is open.
fn rendering_alone(stroke: &Stroke, spec: &Spec, folder: &Path, maps: &Maps, frames: usize) -> f64 {
    let path = folder.join("stroke.toml");
    let file = asperity::files::scene_file::SceneFile::parse(&stroke.scene, &path).unwrap();
    let log = asperity::files::contact_log::ContactLog::parse(&stroke.contacts, "stroke").unwrap();
    let overrides = Overrides {
        kernel: Some(spec.kernel()),
        maps: Some(maps),
        max_contacts: Some(1),
        ..Overrides::default()
    };
    let Engine { scene, renderer, names, .. } = Engine::from_scene(&file, &overrides).unwrap();
    let options = Options { tail_s: file.tail_s, ..Options::default() };
    let began = Instant::now();
    let render = offline::render(scene, renderer, &log, &names, &options).unwrap();
    let took = began.elapsed().as_secs_f64();
    assert_eq!(render.haptic[0].len(), frames);
    took
}
