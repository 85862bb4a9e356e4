//! The parts: each measures its figures through the libraries that the other verbs use.

use super::{Matrix, Part};
use crate::bench_scene::{Bench, Load};
use crate::error::CliError;
use crate::paths::has_end;
use crate::report;
use asperity::surface::solid_materials::SolidMaterial;
use asperity::{Config, PathMode, Preset, Quantity};
use asperity_dsp::rng::Rng;
use asperity_dsp::trajectory::TrajectoryDesign;
use asperity_evidence::abrasive;
use asperity_evidence::growth::{growth, rms};
use asperity_evidence::plates::{self, CONDITIONS, Make, PLATES, Table};
use asperity_evidence::{cramer_rao, impact, score};
use asperity_fit::{ChannelChoice, FitOptions, Recording, fit as fit_recording, load};
use asperity_ports::score::Reference;
use asperity_ports::{Device, reduction};
use std::path::Path;

type Result<T> = std::result::Result<T, CliError>;

const HASTI: &str = "Chan, Tymms and Colonnese 2021, Fig. 10";
const SOLID: &str = "solid-noise textures, 16 people";
const HATT: &str = "Penn Haptic Texture Toolkit, 96 materials";
const OWN: &str = "own reference";
/// Recordings that are looked for in a folder.
const SOUNDS: [&str; 8] = ["wav", "aif", "aiff", "flac", "ogg", "mp3", "m4a", "oga"];

/// Contact, path, bank and the whole chain against their references.
pub fn kernels(quick: bool) -> Result<Part> {
    let mut part = Part::default();
    let command = "asperity report -o DIR";
    let bank = report::modes::format_rows()?;
    let worst = bank.iter().filter(|row| row.choice.starts_with("delta form, f32")).map(|row| row.worst);
    let db = 20.0 * worst.fold(0.0, f64::max).log10();
    let anchor = ("direct form in f64", OWN, command);
    part.row("modal bank in f32, worst case, dB", db, [None, Some(-80.0)], anchor);
    let path = TrajectoryDesign::new(PathMode::default(), 30.0, 44_100.0, [f64::INFINITY; 2]);
    let lag_ms = 1e3 * path.map_err(CliError::from_error)?.lag_s();
    let anchor = ("Butterworth of second order, 30 Hz: √2/ω", "Chan, Tymms and Colonnese 2021", command);
    part.row("path behind its reports, ms", lag_ms, [Some(7.4), Some(7.6)], anchor);
    if quick {
        return Ok(part);
    }
    for row in report::integrator::rows()? {
        let most = match row.choice.as_str() {
            "exact-event" => 1e-3,
            "semi-implicit-euler" => 3e-2,
            "semi-implicit-euler-explicit" => 1e-1,
            _ => continue,
        };
        let name = format!("contact, {}: geometric mean of errors", row.choice);
        let anchor = ("8 times the rate, relative to AC rms", OWN, command);
        part.row(name, row.geometric_mean, [None, Some(most)], anchor);
    }
    let anchor = ("everything in f64 at 16 times the rate", OWN, command);
    let db = report::end_to_end::worst_db(Preset::Default)?;
    part.row("chain, worst case that forgets how it began, dB", db, [None, Some(-40.0)], anchor);
    Ok(part)
}

/// Modes of made strikes, whose truth and whose Cramér–Rao bounds are known.
pub fn fit(quick: bool) -> Result<Part> {
    let (mut missed, mut found, mut snr_db) = (0, 0, Vec::new());
    for seed in if quick { 11..13 } else { 11..19 } {
        let made = impact::impact(30, 40.0, seed, 44_100.0, 2.0);
        let peak = made.noisy.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        let samples = made.noisy.iter().map(|x| 0.5 * x / peak).collect();
        let recording = Recording::from_samples("made", samples, 44_100.0).map_err(CliError::from_error)?;
        let options = FitOptions { start_offset_s: Some(0.0), ..FitOptions::default() };
        let result = fit_recording(&recording, &options, &mut |_| {}).map_err(CliError::from_error)?;
        let louder = |mode: asperity::Mode| asperity::Mode { amplitude: mode.amplitude * peak / 0.5, ..mode };
        let modes: Vec<_> = result.modes.iter().map(|mode| louder(mode.mode())).collect();
        let bounds = cramer_rao::cramer_rao(&made.truth, 44_100.0, made.noisy.len(), made.noise_std);
        let score = score::score(&made, &bounds, &modes);
        (missed, found) = (missed + score.missed, found + score.identifiable);
        snr_db.push(result.snr_from_onset_db);
    }
    snr_db.sort_by(f64::total_cmp);
    let mut part = Part::default();
    let command = "asperity fit HIT.wav -o HIT.modes.json";
    let share = missed as f64 / found.max(1) as f64;
    let anchor = ("modes that the noise lets be known", "Cramér–Rao bound", command);
    part.row("fit of made strikes: modes missed, share", share, [None, Some(0.05)], anchor);
    let anchor = ("40 dB of the mean power", "white noise of the recording", command);
    part.row(
        "fit of made strikes: SNR from the onset, median, dB",
        snr_db[snr_db.len() / 2],
        [Some(30.0), None],
        anchor,
    );
    Ok(part)
}

/// Recordings of hits in a folder: how much of each its modes explain.
pub fn recordings(folder: &Path, quick: bool) -> Result<Part> {
    let unread = |error: std::io::Error| CliError::file(folder, error, "give a folder of recordings of hits");
    let entries = std::fs::read_dir(folder).map_err(unread)?;
    let mut paths =
        entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>().map_err(unread)?;
    paths.retain(|path| has_end(path, &SOUNDS));
    paths.sort();
    paths.truncate(if quick { 3 } else { usize::MAX });
    let mut snr_db = Vec::new();
    for path in &paths {
        let refused = |error: String| CliError::file(path, error, "take it out of the folder");
        let recording = load(path, ChannelChoice::Loudest).map_err(|error| refused(error.to_string()))?;
        let fitted = fit_recording(&recording, &FitOptions::default(), &mut |_| {});
        snr_db.push(fitted.map_err(|error| refused(error.to_string()))?.snr_from_onset_db);
    }
    snr_db.sort_by(f64::total_cmp);
    let (Some(least), Some(median)) = (snr_db.first(), snr_db.get(snr_db.len() / 2)) else {
        return Err(CliError::file(folder, "holds no recording", "give a folder of recordings of hits"));
    };
    let mut part = Part::default();
    let count = asperity_plot::counted(snr_db.len() as u64, "recording");
    let command = "asperity fit HIT.wav -o HIT.modes.json";
    let anchor = ("instruments 20, household objects 8", "public recordings", command);
    part.row(format!("fit of {count}: SNR from the onset, median, dB"), *median, [Some(8.0), None], anchor);
    let anchor = ("none worse than silence", "public recordings", command);
    part.row(format!("fit of {count}: SNR from the onset, least, dB"), *least, [Some(0.0), None], anchor);
    Ok(part)
}

/// Both observers' tables and controls.
fn judged(
    part: &mut Part,
    what: &str,
    labels: &[&str],
    of: &[Make],
    quick: bool,
    conditions: &[(&'static str, &[usize])],
    placed: bool,
) -> Result<Vec<Table>> {
    let count = if quick { 4 } else { 16 };
    let [known, asked] = plates::lots(of, count, placed)?;
    let tables = plates::judge(&known, &asked, conditions);
    let chance = 1.0 / labels.len() as f64;
    let two_se = 2.0 * (chance * (1.0 - chance) / (labels.len() as f64 * count as f64)).sqrt();
    for table in &tables {
        let name = format!("{what} by {}, {} observer", table.condition, table.observer);
        let bound = [Some(chance - two_se), Some(chance + two_se)];
        part.row(
            format!("shuffled labels: {name}"),
            table.shuffled,
            bound,
            ("chance ± 2 standard errors", "control", "asperity scorecard -o DIR"),
        );
        let counts = &table.confusion.counts;
        let share = |row: &Vec<u32>| {
            row.iter().map(|n| f64::from(*n) / f64::from(row.iter().sum::<u32>().max(1))).collect()
        };
        let matrix = Matrix {
            labels: labels.iter().map(ToString::to_string).collect(),
            observer: table.observer,
            ours: counts.iter().map(share).collect(),
            paper: None,
        };
        part.confusion.insert(name, matrix);
    }
    if placed {
        let two_se = 2.0 * (0.25 / (labels.len() as f64 * count as f64)).sqrt();
        for (observer, right) in ["first", "second"].into_iter().zip(plates::against_itself(&known, &asked)) {
            let bound = [Some(0.5 - two_se), Some(0.5 + two_se)];
            part.row(
                format!("a plate against itself, {observer} observer"),
                right,
                bound,
                ("chance ± 2 standard errors", "control", "asperity scorecard -o DIR"),
            );
        }
    }
    Ok(tables)
}

/// Six plates by touch, by ear and by both.
pub fn six_plates(quick: bool) -> Result<Part> {
    let mut part = Part::default();
    let of = plates::six_plates();
    let tables = judged(&mut part, "six plates", &PLATES, &of, quick, &CONDITIONS, true)?;
    for table in &tables {
        let name = format!("six plates by {}, {} observer", table.condition, table.observer);
        let least = (0..PLATES.len()).map(|plate| table.confusion.right(plate)).fold(1.0, f64::min);
        let command = "asperity study --example six-plates -o DIR";
        part.row(
            format!("{name}: mean"),
            table.confusion.mean(),
            [Some(0.85), Some(1.0)],
            ("people, 0.85 on average", HASTI, command),
        );
        part.row(
            format!("{name}: least"),
            least,
            [Some(0.60), Some(1.0)],
            ("people, each plate above 0.60", HASTI, command),
        );
    }
    Ok(part)
}

/// Seven materials by touch.
pub fn seven_materials(quick: bool) -> Result<Part> {
    let mut part = Part::default();
    let names = SolidMaterial::SEVEN.map(SolidMaterial::name);
    let of = plates::seven_materials();
    let tables = judged(&mut part, "seven materials", &names, &of, quick, &CONDITIONS[..1], false)?;
    for table in &tables {
        let name = format!("seven materials by touch, {} observer: mean", table.observer);
        let command = "asperity study --example seven-materials -o DIR";
        part.row(
            name,
            table.confusion.mean(),
            [Some(0.77), Some(0.91)],
            ("people, 95 of 112: 0.848, 95 % band", SOLID, command),
        );
    }
    Ok(part)
}

/// Growth with speed and force beside measured tools and fingers.
pub fn growth_laws(_quick: bool) -> Result<Part> {
    let mut part = Part::default();
    let command = "asperity stroke MAP -o DIR --speed V --force N";
    let stylus = growth("stylus", Quantity::Acceleration, 0.5)?;
    let finger = growth("fingertip", Quantity::Acceleration, 0.5)?;
    let [fabric, textures] = ["published fingers on fabric", "published fingers, eight textures"];
    for (of, ours, [low, high], anchor, source) in [
        ("stylus: exponent of speed", stylus.speed_exponent, [0.72, 1.23], "0.96, each 0.72–1.23", HATT),
        ("stylus: exponent of force", stylus.force_exponent, [0.02, 0.40], "0.21, each 0.02–0.40", HATT),
        ("stylus: level at 0.12 m/s and 1.5 N, m/s²", stylus.level, [0.37, 4.7], "1.07, 0.37–4.7", HATT),
        (
            "fingertip: exponent of speed",
            finger.speed_exponent,
            [0.5, 1.4],
            "0.70–0.90 on four fabrics",
            fabric,
        ),
        ("fingertip: exponent of force", finger.force_exponent, [0.0, 0.5], "above 0", textures),
    ] {
        part.row(format!("growth, {of}"), ours, [Some(low), Some(high)], (anchor, source, command));
    }
    let ground = (abrasive::abrasive(141e-6).map_err(CliError::from_error)?, abrasive::SIDE_M);
    let level = rms("stylus", Quantity::Acceleration, ground, 0.12, 1.5)?;
    let off_db = 20.0 * (level / abrasive::MEASURED_M_S2[0]).log10() + abrasive::FRICTION_DB;
    let anchor = ("6.5 m/s², of which friction is 4 dB", HATT, command);
    part.row("stylus on abrasive of grit 100: level, dB", off_db, [Some(-9.0), Some(8.0)], anchor);
    Ok(part)
}

/// Errors of device models on a made vibration.
pub fn ports(_quick: bool) -> Result<Part> {
    let mut part = Part::default();
    let rate_hz = 8000.0;
    let mut rng = Rng::new(21);
    // A stroke over a grating that speeds up, with noise, 2 s.
    let mut phase = 0.0;
    let samples: Vec<f64> = (0..16_000)
        .map(|n| {
            let t = f64::from(n) / rate_hz;
            phase += std::f64::consts::TAU * (60.0 + 50.0 * t) / rate_hz;
            (0.3 + 0.2 * (7.0 * t).sin()) * (phase.sin() + 0.2 * rng.normal())
        })
        .collect();
    for name in Device::NAMES {
        let Some(device) = Device::shipped(name) else { continue };
        let settings = reduction::Options {
            points_per_s: Some(device.points_per_s.min(250.0)),
            ..reduction::Options::default()
        };
        let made = reduction::reduce(&samples, rate_hz, &device, &settings, &mut |_| {})
            .map_err(CliError::from_error)?;
        let score = Reference::new(&made.original, device.band_hz).score(&made.left);
        let command = "asperity haptic IN.wav -o OUT.haptic --score";
        part.row(
            format!("port {name}: envelope correlation"),
            score.envelope_correlation,
            [Some(0.8), Some(1.0)],
            ("the vibration as it was", "device model", command),
        );
        part.row(
            format!("port {name}: error within its band, dB"),
            score.in_band_error_db,
            [None, Some(6.0)],
            ("the vibration as it was", "device model", command),
        );
    }
    Ok(part)
}

/// Figures and tables of the sources whose numbers are claimed; none in a quick run.
pub fn sources(quick: bool) -> Result<Part> {
    let mut part = Part::default();
    for entry in asperity_evidence::sources::ALL.iter().filter(|_| !quick) {
        let Some(within) = entry.within else { continue };
        let evidence = entry.run().map_err(|error| CliError::new(entry.name, error, "please report it"))?;
        let anchor = ("as printed, largest difference", entry.name, "asperity evidence NAME -o DIR");
        part.row(
            format!("source {}: {}", entry.name, entry.title),
            evidence.apart(),
            [None, Some(within)],
            anchor,
        );
    }
    Ok(part)
}

/// Real-time factor, the median of pieces of eight blocks.
pub fn speed(quick: bool) -> Result<Part> {
    let mut part = Part::default();
    let load = Load { contacts: 10, bodies: 10, modes_per_body: 100, lift: false };
    let mut bench = Bench::new(load, Config::default())?;
    let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
    let pieces = if quick { 600 } else { 3000 };
    let mut times: Vec<f64> = (0..pieces).map(|_| bench.blocks(8, &mut haptic, &mut audio)).collect();
    times.sort_by(f64::total_cmp);
    let factor = 8.0 * 64.0 / 44_100.0 / times[times.len() / 2].max(1e-9);
    part.row(
        "speed: ten fingers on ten bodies, × real time",
        factor,
        [Some(5.0), None],
        ("5 × real time on a phone's core", OWN, "asperity headroom"),
    );
    Ok(part)
}
