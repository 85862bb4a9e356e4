//! Data sets from outside: the same bytes whoever makes them, whatever happens on the way.

use asperity::files::FileError;
use asperity_batch::manifest::Manifest;
use asperity_batch::{DataSet, Outcome, Spec, verify};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SPEC: &str = r#"
seed = 11
strokes = 10
per_shard = 4
[surface]
choice = [{ solid = "granite" }, { name = "plate", roughness = { uniform = [0, 1] } }]
[body]
stock = "plate"
size_m = { uniform = [0.1, 0.3] }
material = { choice = ["ceramic", "wood"] }
[finger]
speed_m_s = { log_uniform = [0.02, 0.3] }
force_n = { normal = [0.6, 0.2], within = [0.1, 2] }
path = { choice = ["line", "arc", "back-and-forth"] }
duration_s = 0.1
[output]
tail_s = 0.02
haptic = { rate_hz = 8000 }
audio = { rate_hz = 22050 }
"#;

fn spec(folder: &TempDir, text: &str) -> Result<Spec, FileError> {
    let path = folder.path().join("spec.toml");
    fs::write(&path, text).unwrap();
    Spec::load(&path)
}

fn set(folder: &TempDir, text: &str, name: &str) -> Result<DataSet, FileError> {
    DataSet::open(spec(folder, text)?, &folder.path().join(name))
}

fn make(set: &DataSet, shards: impl IntoIterator<Item = u64>) {
    for index in shards {
        set.shard(index, &mut || ()).unwrap();
    }
    set.write_manifest().unwrap();
}

fn bytes(folder: &TempDir, name: &str) -> Vec<Vec<u8>> {
    ["shard-000000", "shard-000001", "shard-000002"]
        .map(|shard| {
            let file =
                |extension: &str| fs::read(folder.path().join(name).join(format!("{shard}.{extension}")));
            file("parquet").or_else(|_| file("tar")).unwrap()
        })
        .to_vec()
}

#[test]
fn shards_have_the_same_bytes_after_a_killed_run() {
    for format in ["parquet", "webdataset"] {
        let folder = tempfile::tempdir().unwrap();
        let text = SPEC.replace("tail_s", &format!("format = \"{format}\"\ntail_s"));
        make(&set(&folder, &text, "one").unwrap(), 0..3);
        make(&set(&folder, &text, "other").unwrap(), [2, 0, 1]);
        assert_eq!(bytes(&folder, "one"), bytes(&folder, "other"));
        // A run that was killed left a shard cut off, one without its hash, and half a file beside.
        let one = folder.path().join("one");
        let named = |shard: &str| {
            one.join(format!("{shard}.{}", if format == "parquet" { "parquet" } else { "tar" }))
        };
        let whole = fs::read(named("shard-000001")).unwrap();
        fs::write(named("shard-000001"), &whole[..whole.len() / 2]).unwrap();
        fs::remove_file(
            one.join(format!("{}.sha256", named("shard-000002").file_name().unwrap().to_string_lossy())),
        )
        .unwrap();
        fs::write(one.join(".shard-000001.part"), b"half").unwrap();
        let again = set(&folder, &text, "one").unwrap();
        assert_eq!(again.shard(0, &mut || ()).unwrap(), Outcome::Kept);
        assert!(matches!(again.shard(1, &mut || ()).unwrap(), Outcome::Made { .. }));
        assert!(matches!(again.shard(2, &mut || ()).unwrap(), Outcome::Made { .. }));
        again.write_manifest().unwrap();
        assert_eq!(bytes(&folder, "one"), bytes(&folder, "other"));
        let found = verify(&one, 1.0, &mut || ()).unwrap();
        assert_eq!((found.shards, found.rendered, found.missing), (3, 10, 0));
    }
}

#[test]
fn a_stroke_is_the_same_whatever_the_size_of_shards() {
    let folder = tempfile::tempdir().unwrap();
    let small = set(&folder, SPEC, "small").unwrap();
    let large = set(&folder, &SPEC.replace("per_shard = 4", "per_shard = 1000"), "large").unwrap();
    for number in [0, 5, 9] {
        let [a, b] = [&small, &large].map(|set| set.record(number).unwrap());
        assert!(a.samples.same_bits(&b.samples));
        assert_eq!((a.stroke.scene, a.stroke.contacts), (b.stroke.scene, b.stroke.contacts));
    }
}

#[test]
fn the_manifest_names_build_levels_units_and_every_shard_that_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let set = set(&folder, SPEC, "set").unwrap();
    make(&set, [1]);
    let there = Manifest::load(&folder.path().join("set")).unwrap().unwrap();
    assert_eq!(there.shards.len(), 1);
    assert_eq!((there.shards[0].file.as_str(), there.shards[0].strokes), ("shard-000001.parquet", 4));
    make(&set, [0, 2]);
    let there = Manifest::load(&folder.path().join("set")).unwrap().unwrap();
    let strokes: Vec<u64> = there.shards.iter().map(|shard| shard.strokes).collect();
    assert_eq!(strokes, [4, 4, 2]);
    assert_eq!(there.build.spec_sha256, set.spec().sha256());
    assert_eq!((there.build.kernel.as_str(), there.units.haptic.as_str()), ("portable", "m"));
    assert!(there.levels.haptic_full_scale > 0.0 && there.levels.audio_gain > 0.0);
    assert_eq!(there.splits.len(), 2);
}

#[test]
fn a_record_holds_the_rates_and_lengths_that_were_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let record = set(&folder, SPEC, "set").unwrap().record(3).unwrap();
    let asperity_batch::record::Sound::F32(audio) = &record.samples.audio else { panic!("asked for f32") };
    // 0.1 s and its tail of 0.02 s.
    assert!((audio.len() as f64 / 22_050.0 - 0.12).abs() < 2e-3, "{}", audio.len());
    assert!((record.samples.haptic.len() as f64 / 8000.0 - 0.12).abs() < 2e-3);
    assert!(record.samples.haptic.iter().any(|x| *x != 0.0) && audio.iter().any(|x| *x != 0.0));
}

#[test]
fn flac_holds_the_samples_at_sixteen_bits() {
    let folder = tempfile::tempdir().unwrap();
    let plain = set(&folder, SPEC, "plain").unwrap().record(2).unwrap();
    let coded = SPEC.replace("rate_hz = 22050", "rate_hz = 22050, codec = \"flac16\"");
    let coded = set(&folder, &coded, "coded").unwrap().record(2).unwrap();
    let asperity_batch::record::Sound::Flac(file) = coded.samples.audio else { panic!("asked for flac16") };
    let asperity_batch::record::Sound::F32(samples) = plain.samples.audio else { panic!("asked for f32") };
    assert_eq!(&file[..4], b"fLaC");
    assert!(file.len() < 2 * samples.len() + 10_000, "{} bytes for {} samples", file.len(), samples.len());
}

#[test]
fn shards_of_another_build_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    make(&set(&folder, SPEC, "set").unwrap(), 0..1);
    let refusal = |text: &str| set(&folder, text, "set").err().unwrap().to_string();
    let other = refusal(&SPEC.replace("seed = 11", "seed = 12"));
    assert!(other.contains("manifest.json: is of another specification; choose another folder"), "{other}");
    // A shard alone tells as well.
    fs::remove_file(folder.path().join("set/manifest.json")).unwrap();
    let other = set(&folder, &SPEC.replace("seed = 11", "seed = 12"), "set").unwrap();
    let error = other.shard(0, &mut || ()).unwrap_err().to_string();
    assert!(error.contains("shard-000000.parquet: is of another specification"), "{error}");
    let mut build = asperity_batch::Build::of(other.spec());
    build.version = "0.0.9".to_owned();
    assert!(build.differs(&asperity_batch::Build::of(other.spec())).unwrap().starts_with("version"));
}

#[test]
fn verify_names_the_first_bad_shard() {
    let folder = tempfile::tempdir().unwrap();
    let there = set(&folder, SPEC, "set").unwrap();
    make(&there, 0..3);
    let path = folder.path().join("set/shard-000001.parquet");
    let mut changed = fs::read(&path).unwrap();
    let middle = changed.len() / 2;
    changed[middle] ^= 1;
    fs::write(&path, changed).unwrap();
    let error = verify(&folder.path().join("set"), 0.0, &mut || ()).unwrap_err().to_string();
    assert!(error.contains("shard-000001.parquet: has other bytes"), "{error}");
    let error = verify(folder.path(), 0.0, &mut || ()).unwrap_err().to_string();
    assert!(error.contains("manifest.json: no such file"), "{error}");
}

#[test]
fn wrong_specifications_are_refused_in_one_line_and_leave_no_shard() {
    for (from, to, part) in [
        ("strokes = 10", "strokes = 0", "strokes: 0 is refused"),
        ("per_shard = 4", "per_shards = 4", "line"),
        ("seed = 11", "kernel = \"sse9\"", "kernel: \"sse9\" is unknown"),
        ("solid = \"granite\"", "solid = \"cheese\"", "cheese"),
        ("\"arc\"", "\"zigzag\"", "finger.path: \"zigzag\" is unknown"),
        ("rate_hz = 8000", "rate_hz = 80000", "output.haptic.rate_hz: 80000 is refused"),
        ("[0.02, 0.3]", "[0, 0.3]", "finger.speed_m_s.log_uniform: 0 is refused"),
        ("stock = \"plate\"", "stock = \"plat\"", "plat"),
        ("choice = [{", "choice = [\"no-such.toml\", {", "no-such.toml: no such file"),
        ("choice = [{", "choice = [\"no-*.toml\", {", "no-*.toml: no file is called so"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = SPEC.replace(from, to);
        assert_ne!(text, SPEC);
        let made = set(&folder, &text, "set")
            .and_then(|set| (0..3).try_for_each(|index| set.shard(index, &mut || ()).map(drop)));
        let error = made.err().unwrap_or_else(|| panic!("{to} was accepted")).to_string();
        assert!(error.contains(part) && !error.contains('\n'), "{to}: {error}");
        // Strokes before the refused one may have made whole shards; without one the folder is gone
        // again.
        let left = fs::read_dir(folder.path().join("set")).into_iter().flatten().filter_map(Result::ok);
        let left: Vec<String> = left.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        assert!(left.is_empty() || left.iter().any(|name| name.ends_with(".parquet")), "{to}: {left:?}");
        assert!(left.iter().all(|name| !name.ends_with(".part")), "{to}: {left:?}");
    }
}

#[test]
fn a_refused_specification_leaves_no_folder_and_takes_none_away() {
    let folder = tempfile::tempdir().unwrap();
    let text = SPEC.replace(
        "solid = \"granite\"",
        "displacement = \"no.png\", relief_m = 1e-3, width_m = 1, height_m = 1",
    );
    assert!(set(&folder, &text, "a/b/set").is_err());
    assert!(!folder.path().join("a").exists());
    fs::create_dir(folder.path().join("mine")).unwrap();
    assert!(set(&folder, &text, "mine").is_err());
    assert!(folder.path().join("mine").is_dir());
}

#[test]
fn a_part_without_a_stroke_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let one = SPEC.replace("{ solid = \"granite\" }, ", "");
    let message = set(&folder, &one, "one").unwrap().empty_parts().unwrap();
    assert!(
        message.starts_with("no stroke belongs to train and test")
            || message.contains("no stroke belongs to"),
        "{message}"
    );
    assert!(message.contains("there are 1 surfaces") && message.contains("by = \"stroke\""), "{message}");
    let by_stroke = format!("{one}[split]\nby = \"stroke\"\ntrain = 0.5\nvalidation = 0.0\ntest = 0.5\n");
    assert_eq!(set(&folder, &by_stroke, "two").unwrap().empty_parts(), None);
}

#[test]
fn a_scenes_maps_are_copied_and_its_record_renders_alone() {
    let folder = tempfile::tempdir().unwrap();
    let picture: Vec<u8> = (0..64 * 64).map(|i| ((i * 7) % 251) as u8).collect();
    let mut pgm = b"P5 64 64 255\n".to_vec();
    pgm.extend(picture);
    fs::write(folder.path().join("map.pgm"), pgm).unwrap();
    let scene = "[[surface]]\nname = \"top\"\ndisplacement = \"map.pgm\"\nrelief_m = 1e-4\nwidth_m = 0.05\nheight_m = 0.05\n";
    fs::write(folder.path().join("bricks.toml"), scene).unwrap();
    let text = SPEC.replace("{ solid = \"granite\" }", "\"br*.toml\"");
    make(&set(&folder, &text, "set").unwrap(), 0..3);
    fs::remove_file(folder.path().join("map.pgm")).unwrap();
    fs::remove_file(folder.path().join("bricks.toml")).unwrap();
    let moved = folder.path().join("moved");
    fs::rename(folder.path().join("set"), &moved).unwrap();
    assert_eq!(verify(&moved, 1.0, &mut || ()).unwrap().rendered, 10);
    let is_copied = |path: &Path| path.join("map.pgm").exists();
    assert!(fs::read_dir(moved.join("surfaces")).unwrap().any(|entry| is_copied(&entry.unwrap().path())));
}

#[test]
fn a_folder_that_cannot_be_written_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), b"").unwrap();
    let error = set(&folder, SPEC, "file").err().unwrap().to_string();
    assert!(error.contains("file: cannot be written") && !error.contains('\n'), "{error}");
}

#[test]
fn halves_of_killed_runs_are_removed_and_those_of_living_ones_stay() {
    let folder = tempfile::tempdir().unwrap();
    let there = set(&folder, SPEC, "set").unwrap();
    let half = |name: &str| {
        let path = folder.path().join("set").join(name);
        (fs::File::create(&path).unwrap(), path)
    };
    let (_, killed) = half(".shard-000001.parquet.77-5-0.part");
    let (_, manifest) = half(".manifest.json.77-5-1.part");
    let (held, alive) = half(".shard-000002.parquet.78-6-0.part");
    held.lock().unwrap();
    make(&there, 0..2);
    assert!(!killed.exists() && !manifest.exists() && alive.exists());
    drop(held);
    make(&there, [2]);
    assert!(!alive.exists());
}

#[test]
fn a_drawn_record_renders_as_its_texts_and_in_larger_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let there = set(&folder, SPEC, "set").unwrap();
    for number in 0..4 {
        let record = there.record(number).unwrap();
        let home = folder.path().join("set");
        let stroke = &record.stroke;
        let path = home.join(format!("{}.toml", stroke.id));
        let file = asperity::files::scene_file::SceneFile::parse(&stroke.scene, &path).unwrap();
        let log = asperity::files::contact_log::ContactLog::parse(&stroke.contacts, &stroke.id).unwrap();
        let overrides = asperity::load::Overrides {
            kernel: Some(asperity::Isa::Portable),
            ..asperity::load::Overrides::default()
        };
        let asperity::Engine { scene, renderer, names, .. } =
            asperity::Engine::from_scene(&file, &overrides).unwrap();
        let options = asperity::offline::Options { tail_s: file.tail_s, ..Default::default() };
        let render = asperity::offline::render(scene, renderer, &log, &names, &options).unwrap();
        let output = &there.spec().says.output;
        let take = asperity_batch::stroke::Take { render, further: Vec::new(), force: None };
        let theirs = asperity_batch::record::Samples::of(&stroke.id, take, output).unwrap();
        assert!(theirs.same_bits(&record.samples), "stroke {number}");
    }
}

/// Two quantities at rates of their own, and the force.
fn spec_with_force(format: &str) -> String {
    let haptic = "haptic = [\"displacement\", { output = \"acceleration\", rate_hz = 4000 }]\nforce = { rate_hz = 500 }";
    SPEC.replace("haptic = { rate_hz = 8000 }", &format!("{haptic}\nformat = \"{format}\""))
}

#[test]
fn a_quantity_more_and_the_force_are_those_of_single_renders() {
    let folder = tempfile::tempdir().unwrap();
    let there = set(&folder, &spec_with_force("parquet"), "set").unwrap();
    let home = folder.path().join("set");
    let manifest = there.write_manifest().unwrap();
    for number in 0..3 {
        let record = there.record(number).unwrap();
        let stroke = &record.stroke;
        let log = asperity::files::contact_log::ContactLog::parse(&stroke.contacts, &stroke.id).unwrap();
        let render = |scene: &str, tap: &mut dyn asperity::Tap| {
            struct Dynamic<'a>(&'a mut dyn asperity::Tap);
            impl asperity::Tap for Dynamic<'_> {
                fn contact(&mut self, block: &asperity::ContactBlock<'_>) {
                    self.0.contact(block);
                }
            }
            let file =
                asperity::files::scene_file::SceneFile::parse(scene, &home.join("stroke.toml")).unwrap();
            let overrides = asperity::load::Overrides {
                kernel: Some(asperity::Isa::Portable),
                ..asperity::load::Overrides::default()
            };
            let asperity::Engine { scene, renderer, names, .. } =
                asperity::Engine::from_scene(&file, &overrides).unwrap();
            let options = asperity::offline::Options { tail_s: file.tail_s, ..Default::default() };
            asperity::offline::render_tapped(scene, renderer, &log, &names, &options, &mut Dynamic(tap))
                .unwrap()
        };
        // The same scene with the other quantity, as somebody would write it.
        let full_scale = |text: f64| format!("full_scale = {text:?}");
        let other = stroke.scene.replace("output = \"displacement\"", "output = \"acceleration\"").replace(
            &full_scale(manifest.levels.haptic_full_scale),
            &full_scale(manifest.further_haptic[0].full_scale),
        );
        assert_ne!(other, stroke.scene);
        let felt = render(&other, &mut asperity::NoTap).haptic.swap_remove(0);
        let felt: Vec<f64> = felt.into_iter().map(f64::from).collect();
        let at_4_khz = asperity_ports::resample::resampled(&felt, 22_050.0, 4000.0);
        assert_eq!(record.samples.further.len(), 1);
        assert!(
            at_4_khz
                .iter()
                .zip(&record.samples.further[0])
                .all(|(a, b)| (*a as f32).to_bits() == b.to_bits())
        );
        assert!(record.samples.further[0].iter().any(|x| *x != 0.0));

        struct Told(Vec<[f64; 4]>, Vec<[f64; 4]>, asperity::live::ports::ForceRows);
        impl asperity::Tap for Told {
            fn contact(&mut self, block: &asperity::ContactBlock<'_>) {
                let Self(rows, samples, force) = self;
                force.close(block.first_sample, |row| rows.extend(message(row)));
                force.add(block);
                for (index, sample) in block.contact_samples.iter().enumerate() {
                    let [u, v] = block.uv[index];
                    let [x, y] = block.velocity_m_s[index];
                    samples.push([u, v, x.hypot(y), sample.normal_force_n]);
                }
            }
        }
        fn message(row: asperity::live::ports::ForceRow) -> Option<[f64; 4]> {
            let [x, y, z] = row.force_n;
            let of_contact = matches!(row.of, asperity::live::ports::Of::Contact(_));
            of_contact.then_some([row.tick as f64 / 500.0, x, y, z])
        }
        let mut tap =
            Told(Vec::new(), Vec::new(), asperity::live::ports::ForceRows::new(500.0, 22_050.0, 64));
        render(&stroke.scene, &mut tap);
        let Told(mut rows, samples, mut force) = tap;
        force.close(u64::MAX, |row| rows.extend(message(row)));
        let table = record.samples.force.as_ref().unwrap();
        assert!(table[0].len() >= 45 && table.iter().all(|column| column.len() == table[0].len()));
        for (row, wanted) in rows.iter().take(table[0].len()).enumerate() {
            assert_eq!([0, 1, 2, 3].map(|column| table[column][row]), *wanted, "stroke {number}, row {row}");
            let sample = (wanted[0] * 22_050.0).round() as usize;
            assert_eq!([4, 5, 6, 7].map(|column| table[column][row]), samples[sample], "row {row}");
        }
    }
}

#[test]
fn quantities_and_force_are_read_back_and_rendered_again_from_either_format() {
    for format in ["parquet", "webdataset"] {
        let folder = tempfile::tempdir().unwrap();
        make(&set(&folder, &spec_with_force(format), "set").unwrap(), 0..3);
        assert_eq!(verify(&folder.path().join("set"), 1.0, &mut || ()).unwrap().rendered, 10, "{format}");
        let manifest = Manifest::load(&folder.path().join("set")).unwrap().unwrap();
        let further = &manifest.further_haptic[0];
        assert_eq!((further.column.as_str(), further.unit.as_str()), ("haptic_acceleration", "m/s^2"));
        assert_eq!(manifest.force.unwrap().columns[..4], ["time_s", "x_n", "y_n", "z_n"]);
    }
}

#[test]
fn quantities_are_written_as_a_name_a_table_or_a_list() {
    let folder = tempfile::tempdir().unwrap();
    let outputs = |haptic: &str| -> Result<Vec<(String, f64)>, FileError> {
        let spec = spec(&folder, &SPEC.replace("haptic = { rate_hz = 8000 }", haptic))?;
        Ok(spec.says.output.haptic.into_iter().map(|haptic| (haptic.output, haptic.rate_hz)).collect())
    };
    let one = |name: &str, rate_hz: f64| (name.to_owned(), rate_hz);
    assert_eq!(outputs("haptic = \"acceleration\"").unwrap(), [one("acceleration", 8000.0)]);
    let both = [one("displacement", 2000.0), one("tangential", 2000.0)];
    let table = "haptic = { output = [\"displacement\", \"tangential\"], rate_hz = 2000 }";
    assert_eq!(outputs(table).unwrap(), both);
    assert_eq!(outputs("haptic = [\"displacement\", \"acceleration\"]").unwrap().len(), 2);
    for (haptic, part) in [
        ("haptic = []", "output.haptic: is empty"),
        ("haptic = [\"displacement\", \"displacement\"]", "displacement stands there twice"),
        ("haptic = [\"torque\"]", "output.haptic.output: \"torque\" is unknown"),
        ("haptic = 3", "haptic must be a quantity"),
        ("force = { rate_hz = 0 }", "output.force.rate_hz: 0 is refused"),
        ("force = { rate_hz = 44100 }", "output.force.rate_hz: 44100 is refused"),
        ("force = { rate = 1000 }", "rate: unknown key; write rate_hz"),
    ] {
        let error = outputs(haptic).unwrap_err().to_string();
        assert!(error.contains(part) && !error.contains('\n'), "{haptic}: {error}");
    }
}

#[test]
fn feeling_grows_with_force_and_stated_metres_do_not() {
    let folder = tempfile::tempdir().unwrap();
    let rms = |force: &str, haptic: &str, name: &str| {
        let text = SPEC
            .replace("{ normal = [0.6, 0.2], within = [0.1, 2] }", force)
            .replace("{ log_uniform = [0.02, 0.3] }", "0.1")
            .replace("duration_s = 0.1", "duration_s = 0.4")
            .replace("haptic = { rate_hz = 8000 }", haptic);
        let there = set(&folder, &text, name).unwrap();
        let record = there.record(0).unwrap();
        let felt = &record.samples.haptic;
        let power = felt.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / felt.len() as f64;
        (power.sqrt(), record.stroke.scene.clone(), there.write_manifest().unwrap())
    };
    let (light, scene, manifest) = rms("0.25", "haptic = { rate_hz = 8000 }", "light");
    let (firm, ..) = rms("2", "haptic = { rate_hz = 8000 }", "firm");
    assert!(firm > 1.5 * light, "{light} at 0.25 N, {firm} at 2 N");
    assert!(scene.contains("felt_force_exponent = 0.3333333333333333"), "{scene}");
    assert_eq!(manifest.levels.haptic_felt_force_exponent, 1.0 / 3.0);
    let metres = "haptic = { rate_hz = 8000, full_scale = 1e-4 }";
    let (light, scene, _) = rms("0.25", metres, "light-m");
    let (firm, ..) = rms("2", metres, "firm-m");
    assert!(scene.contains("felt_force_exponent = 0.0") && firm < 1.5 * light, "{light} {firm}");
}

#[test]
fn choices_and_ranges_are_tried_before_anything_is_rendered() {
    for (from, to, part) in [
        ("\"back-and-forth\"", "\"zigzag\"", "line 14: finger.path: \"zigzag\" is unknown"),
        ("[\"ceramic\", \"wood\"]", "[\"wood\", \"stel\"]", "line 10: body 1 \"body\": material: \"stel\""),
        ("[\"ceramic\", \"wood\"]", "[\"wood\", { choice = [\"stel\"] }]", "\"stel\" is unknown"),
        ("roughness = { uniform = [0, 1] }", "roughness = { uniform = [0, 3] }", "roughness: 3"),
        ("size_m = { uniform = [0.1, 0.3] }", "size_m = { uniform = [0.1, 300] }", "size_m: 300"),
        ("stock = \"plate\"", "stock = { choice = [\"plate\", \"plat\"] }", "stock: \"plat\" is unknown"),
        (
            "[body]",
            "[probe]\npreset = { choice = [\"stylus\", \"styluss\"] }\n[body]",
            "\"styluss\" is unknown",
        ),
        (
            "within = [0.1, 2]",
            "within = [-1, 2]",
            "finger.force_n: -0.029193205257869503 is refused; must be above 0",
        ),
        (", within = [0.1, 2]", "", "finger.force_n: -0.0"),
        ("{ normal = [0.6, 0.2], within = [0.1, 2] }", "0", "finger.force_n: 0 touches nothing"),
        ("{ normal = [0.6, 0.2], within = [0.1, 2] }", "{ choice = [0, 1] }", "0 touches nothing"),
        ("duration_s = 0.1", "reports_hz = 2", "reports_hz: 2 is refused; must be 5 to 5000; a contact"),
        (
            "choice = [{ solid = \"granite\" }, ",
            "displacement = { choice = [\"a.png\", \"b.png\"] }\nrelief_m = 1e-3\nchoice = [",
            "spec.toml: a.png: is no file of the data set",
        ),
        ("{ solid = \"granite\" }", "{ solid = \"cheese\" }", "surface.choice 1: solid: \"cheese\""),
        ("{ solid = \"granite\" }", "{ solid = { choice = [\"granite\", \"cheese\"] } }", "\"cheese\""),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = SPEC.replace(from, to);
        assert_ne!(text, SPEC);
        let error = set(&folder, &text, "set").err().unwrap_or_else(|| panic!("{to} was accepted"));
        let error = error.to_string();
        assert!(error.contains(part) && error.contains("spec.toml: "), "{to}: {error}");
        assert!(!error.contains("check.toml") && !error.contains("stroke "), "{to}: {error}");
        assert!(!folder.path().join("set").exists(), "{to} left a folder");
    }
}

#[test]
fn grams_and_centimetres_are_told_with_what_was_meant() {
    let message = |from: &str, to: &str| {
        let folder = tempfile::tempdir().unwrap();
        let text = SPEC.replace(from, to);
        set(&folder, &text, "set").unwrap().remarks()
    };
    assert_eq!(message("seed = 11", "seed = 12"), [""; 0]);
    let force = "{ normal = [0.6, 0.2], within = [0.1, 2] }";
    for (from, to, doubt) in [
        (
            force,
            "{ uniform = [50, 200] }",
            "finger.force_n is 50 to 200, beyond the usual 30; if these are grams, write 0.4905 to 1.962",
        ),
        (
            "{ uniform = [0.1, 0.3] }",
            "{ uniform = [10, 30] }",
            "body.size_m is 10 to 30, beyond the usual 5; if these are centimetres, write 0.1 to 0.3",
        ),
        (
            "{ log_uniform = [0.02, 0.3] }",
            "{ choice = [5, 8] }",
            "finger.speed_m_s is 5 to 8, beyond the usual 3; if these are mm/s, write 0.005 to 0.008",
        ),
        (
            "{ solid = \"granite\" }",
            "{ name = \"g\", solid = \"granite\", width_m = 80 }",
            "g.surface.width_m is 80, beyond the usual 5; if these are millimetres, write 0.08",
        ),
    ] {
        assert_eq!(message(from, to), [doubt]);
    }
}
