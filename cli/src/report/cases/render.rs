//! A case rendered by the engine, with everything that its contact did.

use super::{Case, memory};
use crate::error::CliError;
use crate::report::refused;
use asperity::files::contact_log::ContactLog;
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::offline::{self, Options};
use asperity::{ContactBlock, Engine, Integrator, PathMode, Preset, Tap};
use std::path::PathBuf;

/// Settings of the engine for a render.
#[derive(Debug, Clone, Copy, Default)]
pub struct Chain {
    /// Hz; none: the scene's.
    pub rate_hz: Option<f64>,
    /// Accuracy.
    pub preset: Preset,
    /// Counts more.
    pub integrator: Option<Integrator>,
    /// Counts more.
    pub oversampling: Option<usize>,
    /// None: extrapolate.
    pub path: Option<PathMode>,
    /// Excitation of the body in place of the contact's force.
    pub excitation: Option<&'static str>,
    /// Rows of the contact at the rate inside.
    pub inner_rows: bool,
}

/// A render: what left the engine, and a row a sample of the contact; where there is none, zeros.
#[derive(Debug, Clone, Default)]
pub struct Take {
    /// Hz.
    pub rate_hz: f64,
    /// Hz.
    pub inner_rate_hz: f64,
    /// Heights under the contact, m.
    pub height_m: Vec<f64>,
    /// Pad displacement, m.
    pub pad_m: Vec<f64>,
    /// N, the mean over a sample.
    pub force_n: Vec<f64>,
    /// Sent to the body, N·s.
    pub impulse_n_s: Vec<f64>,
    /// Felt, m.
    pub haptic: Vec<f64>,
    /// Heard.
    pub audio: Vec<f64>,
    /// By how much sound lags behind felt, s.
    pub sound_late_s: f64,
    /// Time in the renderer, s.
    pub processing_s: f64,
    inner_rows: bool,
}

impl Take {
    /// A row of the contact by its name in the report.
    pub fn signal(&self, of: Signal) -> &[f64] {
        match of {
            Signal::Displacement => &self.pad_m,
            Signal::ContactForce => &self.force_n,
            Signal::Felt => &self.haptic,
            Signal::Heard => &self.audio,
        }
    }
}

/// Quantities that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    Displacement,
    ContactForce,
    Felt,
    Heard,
}

impl Tap for Take {
    fn wants_inner_samples(&self) -> bool {
        self.inner_rows
    }

    fn contact(&mut self, block: &ContactBlock<'_>) {
        let first = block.first_sample as usize;
        let end = first + block.contact_samples.len();
        if self.pad_m.len() < end {
            for signal in [&mut self.height_m, &mut self.pad_m, &mut self.force_n, &mut self.impulse_n_s] {
                signal.resize(end, 0.0);
            }
        }
        for (i, (row, impulse_n_s)) in block.contact_samples.iter().zip(block.impulse_n_s).enumerate() {
            self.height_m[first + i] = row.height_m;
            self.pad_m[first + i] = row.pad_m;
            self.force_n[first + i] = row.contact_force_n;
            self.impulse_n_s[first + i] = *impulse_n_s;
        }
    }
}

/// Renders a case's profile of a seed; `log` in place of its own.
///
/// # Errors
/// Never but by a defect.
pub fn take(case: &Case, seed: u64, chain: &Chain, log: Option<&ContactLog>) -> Result<Take, CliError> {
    let (files, own) = memory(case, seed, chain.excitation)?;
    let file =
        SceneFile::load_from(&files, &PathBuf::from(format!("{}.toml", case.name))).map_err(refused)?;
    let overrides = Overrides {
        files: &files,
        sample_rate_hz: chain.rate_hz,
        preset: chain.preset,
        integrator: chain.integrator,
        oversampling: chain.oversampling,
        path: chain.path,
        ..Overrides::default()
    };
    let Engine { scene, renderer, names, .. } = Engine::from_scene(&file, &overrides).map_err(refused)?;
    let inner_rate_hz = scene.config().inner_rate_hz();
    let late_samples = renderer.audio_latency_samples() - renderer.latency_samples();
    let sound_late_s = late_samples as f64 / renderer.sample_rate_hz();
    let mut taken = Take { inner_rate_hz, sound_late_s, inner_rows: chain.inner_rows, ..Take::default() };
    let options =
        Options { tail_s: file.tail_s, clock_s: Some(crate::measure::seconds), ..Options::default() };
    let log = log.unwrap_or(&own);
    let render =
        offline::render_tapped(scene, renderer, log, &names, &options, &mut taken).map_err(refused)?;
    let wide = |channel: &Vec<f32>| channel.iter().map(|x| f64::from(*x)).collect();
    taken.rate_hz = render.sample_rate_hz;
    taken.processing_s = render.processing.as_secs_f64();
    taken.haptic = render.haptic.first().map(wide).unwrap_or_default();
    taken.audio = render.audio.first().map(wide).unwrap_or_default();
    for signal in [&mut taken.height_m, &mut taken.pad_m, &mut taken.force_n, &mut taken.impulse_n_s] {
        let every = if chain.inner_rows { inner_rate_hz / taken.rate_hz } else { 1.0 };
        signal.resize((taken.audio.len() as f64 * every).round() as usize, 0.0);
    }
    Ok(taken)
}
