//! Modal bank: which modes are left out, and in which numbers the rest are computed.

use super::strokes::Strokes;
use super::{BLOCK, Row, SAMPLE_RATE_HZ, excitation, refused};
use crate::bench_scene;
use crate::error::CliError;
use crate::measure::ns_per_item;
use asperity::Mode;
use asperity_dsp::masking::Ranked;
use asperity_dsp::modal_bank::{
    Culling, GroupOptions, GroupState, Inputs, LOUDEST_DB_SPL, MODE_LEVELS, ModalBank, ModeGroup,
    ReferenceMode, ReferenceState, SLEEP_AMPLITUDE, SheddingLevels, audible, design_groups, ringing_s,
    shedding_order, sort_by_decay,
};
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::{Isa, Level};

const MODES: usize = 256;
const SAMPLES: usize = 16_384;
const OPTIONS: GroupOptions =
    GroupOptions { impulse_kernel_compensation: false, true_t60: true, derivative: 0 };
const CULLING_REFERENCE: &str = "all 256 modes of a body under the strokes of the named cases, same numbers";
const SHEDDING_REFERENCE: &str =
    "all 256 modes of a body under the strokes of the named cases; a masking model orders what is left out";
const FORMAT_REFERENCE: &str =
    "the paper's two-pole filter in f64, 256 modes under the strokes of the named cases";
/// As the engine orders modes: between what a stroke sends in a sample and a strike, N·s.
const TYPICAL_IMPULSE_N_S: f64 = 1e-4;

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

/// The groups of a body, designed once.
fn designed(modes: &[Mode]) -> Result<Vec<ModeGroup>, CliError> {
    design_groups(modes, SAMPLE_RATE_HZ, &OPTIONS).collect::<Result<Vec<_>, _>>().map_err(refused)
}

/// The engine's bank, block by block, of which no mode ever sleeps.
fn bank(groups: &[ModeGroup], kernel: Level, impulses: &[f32]) -> Vec<f32> {
    let states = vec![GroupState::REST; groups.len()];
    run(ModalBank::new(kernel, groups, states).sleeping_below(0.0), groups.len(), impulses)
}

/// Bank whose groups sleep once they have rung out, and of which only the first `driven` are
/// excited.
fn sleeping_bank(groups: &[ModeGroup], driven: usize, threshold: f32, impulses: &[f32]) -> Vec<f32> {
    let states = vec![GroupState::REST; groups.len()];
    run(ModalBank::new(Level::detect(), groups, states).sleeping_below(threshold), driven, impulses)
}

fn run(mut bank: ModalBank<&[ModeGroup], Vec<GroupState>>, driven: usize, impulses: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0f32; impulses.len()];
    for (index, (input, block)) in impulses.chunks(BLOCK).zip(out.chunks_mut(BLOCK)).enumerate() {
        bank.render_leading(driven, (index * BLOCK) as u64, Inputs::One(input), block);
    }
    out
}

fn ns(work: impl Fn() -> Vec<f32>) -> f64 {
    ns_per_item(SAMPLES, || {
        std::hint::black_box(work());
    })
}

/// Costs under the strokes of the cases, in which little falls asleep.
pub fn stroked_sleep_rows() -> Result<Vec<Row>, CliError> {
    let strokes = Strokes::new()?;
    let mut modes = body();
    modes.sort_by(|a, b| ringing_s(b, 1e-6).total_cmp(&ringing_s(a, 1e-6)));
    let groups = designed(&modes)?;
    let run = |threshold: f32, sent: &[f32]| sleeping_bank(&groups, groups.len(), threshold, sent);
    let reference = strokes.heard(|sent| run(0.0, sent));
    let rows = [-160.0, -120.0, -100.0, -80.0].into_iter().map(|level_db: f32| {
        let threshold = 10f32.powf(level_db / 20.0);
        let cases = strokes.errors(&strokes.heard(|sent| run(threshold, sent)), &reference);
        let note = if threshold == SLEEP_AMPLITUDE { " (the engine)" } else { "" };
        let ns = ns(|| run(threshold, &white().into_iter().map(|u| 1e-6 * u).collect::<Vec<_>>()));
        Row::on_cases(
            ("mode sleep, on the cases", format!("−{} dB{note}", -level_db)),
            ns,
            cases,
            "256 modes under the strokes of the named cases that all ring on",
        )
    });
    Ok(rows.collect())
}

/// A body in the order in which the engine leaves modes out, and how many groups hear at each
/// level.
fn in_order_of_need(modes: &[Mode]) -> (Vec<Mode>, SheddingLevels) {
    let mut order = vec![Ranked::default(); modes.len()];
    let levels = shedding_order(modes, TYPICAL_IMPULSE_N_S, LOUDEST_DB_SPL, &mut order);
    (order.iter().map(|ranked| modes[ranked.index]).collect(), levels)
}

/// A stroked body of which some groups no longer hear the force, as the governor's first level
/// leaves it.
pub fn shedding_rows() -> Result<Vec<Row>, CliError> {
    let strokes = Strokes::new()?;
    let (modes, levels) = in_order_of_need(&body());
    let groups = designed(&modes)?;
    let run = |driven: usize, sent: &[f32]| sleeping_bank(&groups, driven, SLEEP_AMPLITUDE, sent);
    let reference = strokes.heard(|sent| run(groups.len(), sent));
    let impulses: Vec<f32> = white().into_iter().map(|u| 1e-6 * u).collect();
    let rows = (0..MODE_LEVELS).map(|level| {
        let driven = levels[level];
        let cases = strokes.errors(&strokes.heard(|sent| run(driven, sent)), &reference);
        let name = format!("level {level}: {driven} of {} groups", groups.len());
        let ns = ns(|| run(driven, &impulses));
        let missed = strokes.heard_of("rough", |sent| run(driven, sent));
        let excitation_db = missed.zip(strokes.heard_of("rough", |sent| run(groups.len(), sent)));
        let excitation_db = excitation_db
            .map(|(less, whole)| excitation::missed(&less, &whole, SAMPLE_RATE_HZ).excitation_db);
        Row { excitation_db, ..Row::on_cases(("load shedding", name), ns, cases, SHEDDING_REFERENCE) }
    });
    Ok(rows.collect())
}

/// Measures what leaving modes out saves and costs under strokes.
pub fn culling_rows() -> Result<Vec<Row>, CliError> {
    let strokes = Strokes::new()?;
    let whole = designed(&body())?;
    let reference = strokes.heard(|sent| bank(&whole, Level::detect(), sent));
    let all = body();
    let cullings = [
        ("none", Culling { level_db: f64::INFINITY, masking: false, ..Culling::default() }),
        ("below −80 dB", Culling { level_db: 80.0, masking: false, ..Culling::default() }),
        ("below −60 dB", Culling { level_db: 60.0, masking: false, ..Culling::default() }),
        ("below −40 dB", Culling { level_db: 40.0, masking: false, ..Culling::default() }),
        ("below −80 dB and masked", Culling::default()),
    ];
    let row = |(name, culling): (&str, Culling)| {
        let mut keep = vec![false; all.len()];
        let count = audible(&all, SAMPLE_RATE_HZ, &culling, &mut keep);
        let kept: Vec<Mode> =
            all.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(mode, _)| *mode).collect();
        let groups = designed(&kept)?;
        let cases = strokes.errors(&strokes.heard(|sent| bank(&groups, Level::detect(), sent)), &reference);
        let ns = ns(|| bank(&groups, Level::detect(), &strike()));
        let name = format!("{name}: {count} of {MODES} modes");
        Ok(Row::on_cases(("mode culling", name), ns, cases, CULLING_REFERENCE))
    };
    cullings.into_iter().map(row).collect()
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

/// Bank in f32, as it is often written.
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
    let strokes = Strokes::new()?;
    let modes = bench_scene::modes(MODES).modes;
    let impulses = white();
    let filters = modes
        .iter()
        .map(|mode| ReferenceMode::new(mode, SAMPLE_RATE_HZ, &OPTIONS))
        .collect::<Result<Vec<_>, _>>()
        .map_err(refused)?;
    let reference = strokes.heard(|sent| direct_f64(&filters, sent));
    let row = |choice: String, ns_per_sample: f64, found: &[Vec<f64>]| {
        let cases = strokes.errors(found, &reference);
        Row::on_cases(("number format", choice), ns_per_sample, cases, FORMAT_REFERENCE)
    };
    let direct_ns = ns_per_item(SAMPLES, || {
        std::hint::black_box(direct_f64(&filters, &impulses));
    });
    let mut rows = vec![
        row("direct form, f64 (the reference itself)".to_owned(), direct_ns, &reference),
        row(
            "direct form, f32 (not offered)".to_owned(),
            ns(|| direct_f32(&modes, &impulses)),
            &strokes.heard(|sent| direct_f32(&modes, sent)),
        ),
    ];
    let groups = designed(&modes)?;
    for isa in Isa::ALL {
        if let Some(kernel) = Level::find(isa) {
            let ns = ns(|| bank(&groups, kernel, &impulses));
            let found = strokes.heard(|sent| bank(&groups, kernel, sent));
            rows.push(row(format!("delta form, f32, {isa:?}"), ns, &found));
        }
    }
    Ok(rows)
}
