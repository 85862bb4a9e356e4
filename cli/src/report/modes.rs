//! Modal bank: which modes are left out, and in which numbers the rest are computed.

use super::{BLOCK, Row, SAMPLE_RATE_HZ, refused};
use crate::bench_scene;
use crate::error::CliError;
use crate::measure::{ns_per_item, relative_error};
use asperity::Mode;
use asperity_dsp::modal_bank::{
    Culling, GroupOptions, GroupState, Isa, Kernel, LANES, ReferenceMode, ReferenceState, audible,
    design_group, sort_by_decay,
};
use asperity_dsp::rng::Rng;

const MODES: usize = 256;
const SAMPLES: usize = 16_384;
const OPTIONS: GroupOptions = GroupOptions { impulse_kernel_compensation: false, true_t60: true };
const CULLING_REFERENCE: &str = "all 256 modes of a struck body, same numbers";
const FORMAT_REFERENCE: &str = "the paper's two-pole filter in f64, 256 modes, white force in every sample";

/// A body whose modes differ in loudness by 100 dB.
fn body() -> Vec<Mode> {
    let mut modes = bench_scene::modes(MODES).modes;
    let mut rng = Rng::new(5);
    for mode in &mut modes {
        mode.amplitude = 0.3 * 10f64.powf(-5.0 * rng.uniform());
    }
    sort_by_decay(&mut modes);
    modes
}

/// One strike, then silence.
fn strike() -> Vec<f32> {
    let mut impulses = vec![0.0; SAMPLES];
    impulses[0] = 1.0;
    impulses
}

fn white() -> Vec<f32> {
    let mut rng = Rng::new(9);
    (0..SAMPLES).map(|_| rng.normal() as f32).collect()
}

/// The engine's bank.
fn bank(modes: &[Mode], kernel: Kernel, impulses: &[f32]) -> Result<Vec<f32>, CliError> {
    let groups = modes
        .chunks(LANES)
        .map(|chunk| design_group(chunk, SAMPLE_RATE_HZ, &OPTIONS))
        .collect::<Result<Vec<_>, _>>()
        .map_err(refused)?;
    let mut states = vec![GroupState::default(); groups.len()];
    let mut out = vec![0.0f32; impulses.len()];
    for (index, (input, block)) in impulses.chunks(BLOCK).zip(out.chunks_mut(BLOCK)).enumerate() {
        kernel.render((index * BLOCK) as u64, &groups, &mut states, input, block);
    }
    Ok(out)
}

fn bank_ns(modes: &[Mode], kernel: Kernel, impulses: &[f32]) -> f64 {
    ns_per_item(SAMPLES, || {
        let _ = std::hint::black_box(bank(modes, kernel, impulses));
    })
}

/// Measures what leaving modes out saves and costs.
pub fn culling_rows() -> Result<Vec<Row>, CliError> {
    let all = body();
    let impulses = strike();
    let kernel = Kernel::detect();
    let reference: Vec<f64> = bank(&all, kernel, &impulses)?.into_iter().map(f64::from).collect();
    let cullings = [
        ("none", Culling { level_db: f64::INFINITY, masking: false, ..Culling::default() }),
        ("below −80 dB", Culling { level_db: 80.0, masking: false, ..Culling::default() }),
        ("below −60 dB", Culling { level_db: 60.0, masking: false, ..Culling::default() }),
        ("below −40 dB", Culling { level_db: 40.0, masking: false, ..Culling::default() }),
        ("below −80 dB and masked", Culling::default()),
    ];
    cullings
        .into_iter()
        .map(|(name, culling)| {
            let mut keep = vec![false; all.len()];
            let count = audible(&all, SAMPLE_RATE_HZ, &culling, &mut keep);
            let kept: Vec<Mode> =
                all.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(mode, _)| *mode).collect();
            let found = bank(&kept, kernel, &impulses)?;
            Ok(Row {
                axis: "mode culling",
                choice: format!("{name}: {count} of {MODES} modes"),
                ns_per_sample: bank_ns(&kept, kernel, &impulses),
                error: relative_error(found.into_iter().map(f64::from), &reference),
                reference: CULLING_REFERENCE,
            })
        })
        .collect()
}

/// The paper's filter, one mode after the other.
fn direct_f64(modes: &[ReferenceMode], impulses: &[f32]) -> Vec<f64> {
    let mut out = vec![0.0; impulses.len()];
    for mode in modes {
        let mut state = ReferenceState::default();
        for (sum, impulse) in out.iter_mut().zip(impulses) {
            *sum += mode.tick(&mut state, f64::from(*impulse));
        }
    }
    out
}

/// The same in f32, as it is often written.
fn direct_f32(modes: &[Mode], impulses: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0f32; impulses.len()];
    for mode in modes {
        let radius = (-mode.decay_per_s / SAMPLE_RATE_HZ).exp();
        let theta = 2.0 * std::f64::consts::PI * mode.frequency_hz / SAMPLE_RATE_HZ;
        let (a1, a2) = ((2.0 * radius * theta.cos()) as f32, (-radius * radius) as f32);
        let b1 = (mode.amplitude * radius * theta.sin()) as f32;
        let (mut y1, mut y2, mut before) = (0.0f32, 0.0f32, 0.0f32);
        for (sum, impulse) in out.iter_mut().zip(impulses) {
            let y = a1 * y1 + a2 * y2 + b1 * before;
            (y2, y1, before) = (y1, y, *impulse);
            *sum += y;
        }
    }
    out
}

/// Measures number formats and instruction sets.
pub fn format_rows() -> Result<Vec<Row>, CliError> {
    let modes = bench_scene::modes(MODES).modes;
    let impulses = white();
    let designed = modes
        .iter()
        .map(|mode| ReferenceMode::new(mode, SAMPLE_RATE_HZ, &OPTIONS))
        .collect::<Result<Vec<_>, _>>()
        .map_err(refused)?;
    let reference = direct_f64(&designed, &impulses);
    let row = |choice: String, ns_per_sample: f64, error: f64| Row {
        axis: "number format",
        choice,
        ns_per_sample,
        error,
        reference: FORMAT_REFERENCE,
    };
    let wide = |values: Vec<f32>| values.into_iter().map(f64::from);
    let mut rows = vec![
        row(
            "direct form, f64 (the reference itself)".to_owned(),
            ns_per_item(SAMPLES, || {
                std::hint::black_box(direct_f64(&designed, &impulses));
            }),
            0.0,
        ),
        row(
            "direct form, f32 (not offered)".to_owned(),
            ns_per_item(SAMPLES, || {
                std::hint::black_box(direct_f32(&modes, &impulses));
            }),
            relative_error(wide(direct_f32(&modes, &impulses)), &reference),
        ),
    ];
    for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512] {
        if let Some(kernel) = Kernel::find(isa) {
            let error = relative_error(wide(bank(&modes, kernel, &impulses)?), &reference);
            rows.push(row(format!("delta form, f32, {isa:?}"), bank_ns(&modes, kernel, &impulses), error));
        }
    }
    Ok(rows)
}
