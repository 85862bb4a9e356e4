//! A render repeats to the waveform where its contacts are contractive: a path moved by 1e-12 m is
//! heard and felt the same. Where a contact bounces for good it is chaotic, another waveform of the
//! same level; the documents list which shipped scenes are.

use crate::support;

use std::fs;
use std::path::Path;
use support::{asperity, message};

/// The shipped scenes that are chaotic, as `docs/formats/scene.md` lists them.
const CHAOTIC: [&str; 1] = ["scraped"];

/// Contractive: what is left of the difference, dB of the signal.
const CONTRACTIVE_DB: f64 = -80.0;

fn samples(path: &Path) -> Vec<f64> {
    let mut reader = hound::WavReader::open(path).unwrap();
    reader.samples::<f32>().map(|x| f64::from(x.unwrap())).collect()
}

fn rms(x: impl Iterator<Item = f64>, n: usize) -> f64 {
    (x.map(|x| x * x).sum::<f64>() / n.max(1) as f64).sqrt()
}

/// Level of the difference, dB of the signal; of silence, nothing.
fn difference_db(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let level = rms(a.iter().copied(), a.len());
    let apart = rms(a.iter().zip(b).map(|(a, b)| a - b), a.len());
    if apart == 0.0 { f64::NEG_INFINITY } else { 20.0 * (apart / level).log10() }
}

/// The log with every contact 1e-11 of a tile further along u, which of a plate of 0.1 m is a
/// picometre.
fn moved(log: &str) -> String {
    let mut moved = String::new();
    for line in log.lines() {
        let mut event: serde_json::Value = serde_json::from_str(line).unwrap();
        if let Some(u) = event.pointer_mut("/uv/0") {
            *u = (u.as_f64().unwrap() + 1e-11).into();
        }
        moved += &format!("{event}\n");
    }
    moved
}

#[test]
fn demo_scenes_repeat_to_the_waveform_or_are_listed_chaotic() {
    let folder = tempfile::tempdir().unwrap();
    let (status, _, err) = message(&asperity(folder.path(), &["demo", "-o", "."]));
    assert_eq!((status, err.as_str()), (0, ""));
    let mut chaotic = Vec::new();
    let mut scenes: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    assert!(scenes.len() >= 8);
    for path in scenes {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let log = folder.path().join(format!("{name}.jsonl"));
        let text = fs::read_to_string(&log).unwrap();
        fs::write(&log, moved(&text)).unwrap();
        let toml = format!("{name}.toml");
        let (status, _, err) = message(&asperity(folder.path(), &["render", &toml, "-o", "moved"]));
        assert_eq!((status, err.as_str()), (0, ""), "{name}");
        let apart = ["audio", "haptic"].map(|kind| {
            let of = |stem: &str| samples(&folder.path().join(format!("{stem}.{kind}.wav")));
            difference_db(&of(&name), &of("moved"))
        });
        println!("{name}: heard {:.0} dB, felt {:.0} dB", apart[0], apart[1]);
        if apart[0].max(apart[1]) > CONTRACTIVE_DB {
            chaotic.push(name);
        }
    }
    chaotic.sort();
    assert_eq!(chaotic, CHAOTIC);
    let formats =
        fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/formats/scene.md")).unwrap();
    for name in CHAOTIC {
        assert!(
            formats.contains(&format!("| demo: `{name}` |")),
            "docs/formats/scene.md does not list {name}"
        );
    }
}
