//! A case as files: its scene, log, map, and the body they share.

use super::{Case, LENGTH_M, TEXELS};
use crate::demo::scenes::plate_modes;
use crate::error::CliError;
use asperity::files::Memory;
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogHand, LogLine};
use asperity_plot::pixels;
use std::path::Path;

/// Profiles of a kind that a figure is of.
pub const SEEDS: std::ops::RangeInclusive<u64> = 1..=4;
/// Rows of a map.
const ROWS: usize = 4;
/// Reports a second, as games send them.
const REPORT_RATE_HZ: f64 = 60.0;
/// Times at which the finger comes and goes, s.
pub const STROKE_S: (f64, f64) = (0.05, 0.6);
/// The body's file.
const MODES: &str = "plate.modes.json";

/// The scene file: everything that a re-integration has to know stands in it.
fn toml(case: &Case, seed: u64, excitation: Option<&str>) -> String {
    let excitation = excitation.unwrap_or("force");
    let name = case.name;
    let height_m = LENGTH_M * ROWS as f64 / TEXELS as f64;
    let ground = match case.ground.map(seed) {
        Some((_, relief_m)) => {
            format!(
                "displacement = \"{name}.png\"\nrelief_m = {relief_m:e}\nroughness = 0.0\nmicro_relief_m = 0.0"
            )
        }
        None => format!("roughness = {}\nmicro_relief_m = 2.2e-5", case.ground.roughness().unwrap_or(0.0)),
    };
    format!(
        "# A case of `asperity report`: {name}, {speed} m/s, {force} N.\n\
         seed = {seed}\n\
         contacts = \"{name}.jsonl\"\n\
         tail_s = 0.1\n\n\
         [[body]]\n\
         name = \"plate\"\n\
         modes = \"{MODES}\"\n\
         material = \"steel\"\n\n\
         [[surface]]\n\
         name = \"ground\"\n\
         body = \"plate\"\n\
         {ground}\n\
         width_m = {LENGTH_M}\n\
         height_m = {height_m}\n\
         wrap = \"repeat\"\n\
         excitation = \"{excitation}\"\n\n\
         [probe]                            # a fingertip of constant stiffness\n\
         pad_mass_kg = 0.15e-3\n\
         pad_stiffness_n_m = 1000.0\n\
         pad_damping_n_s_m = 2.0\n\
         finger_mass_kg = 0.02\n\
         contact_stiffness_n_m = 2e5\n\
         force_exponent = 0.0\n\
         tip_radius_m = 0.0\n\n\
         [[actuator]]\n\
         output = \"displacement\"\n\
         full_scale = 1.0                   # metres\n\
         limit = false\n\n\
         [audio]\n\
         gain = 1.0\n\
         limit = false\n",
        speed = case.speed_m_s,
        force = case.force_n,
    )
}

impl Case {
    /// Its log.
    pub fn log(&self) -> ContactLog {
        log(self)
    }
}

/// Moves a log along u, m.
pub fn move_along(log: &mut ContactLog, by_m: f64) {
    for line in &mut log.lines {
        if let LogEvent::Begin { sample, .. } | LogEvent::Move { sample, .. } = &mut line.event {
            sample.uv[0] += by_m / LENGTH_M;
        }
    }
}

/// A straight stroke of constant speed and force that slides already when it begins.
fn log(case: &Case) -> ContactLog {
    let (begin_s, end_s) = STROKE_S;
    let reports = ((end_s - begin_s) * REPORT_RATE_HZ) as usize;
    let samples = (0..reports).map(|report| {
        let since_s = report as f64 / REPORT_RATE_HZ;
        let sample = ContactSample {
            uv: [0.1 + case.speed_m_s * since_s / LENGTH_M, 0.5],
            velocity_m_s: Some([case.speed_m_s, 0.0]),
            normal_force_n: case.force_n,
            ..ContactSample::default()
        };
        (begin_s + since_s, sample)
    });
    ContactLog { lines: LogLine::contact(1, ("ground", LogHand::felt_by(0)), samples, end_s) }
}

/// Names and contents of a case's files.
///
/// # Errors
/// Never but by a defect.
pub fn files(case: &Case, seed: u64, excitation: Option<&str>) -> Result<Vec<(String, Vec<u8>)>, CliError> {
    let name = case.name;
    let mut files = vec![
        (MODES.to_owned(), plate_modes().to_json().into_bytes()),
        (format!("{name}.jsonl"), log(case).to_jsonl().into_bytes()),
        (format!("{name}.toml"), toml(case, seed, excitation).into_bytes()),
    ];
    if let Some((heights, _)) = case.ground.map(seed) {
        let grey: Vec<u16> = heights.iter().map(|height| (height * 65_535.0).round() as u16).collect();
        files.push((format!("{name}.png"), pixels::png16(TEXELS, ROWS, &grey.repeat(ROWS))));
    }
    Ok(files)
}

/// Case in memory, and the log as it was written.
///
/// # Errors
/// As [`files`].
pub fn memory(case: &Case, seed: u64, excitation: Option<&str>) -> Result<(Memory, ContactLog), CliError> {
    let mut memory = Memory::new();
    for (name, bytes) in files(case, seed, excitation)? {
        memory.add(Path::new(&name), bytes);
    }
    Ok((memory, log(case)))
}
