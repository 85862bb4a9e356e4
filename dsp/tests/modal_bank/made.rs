//! Bodies, banks and renders that the tests of the modal bank share.

use asperity_dsp::modal_bank::{
    GroupOptions, GroupState, Inputs, ModalBank, ModeGroup, ReferenceMode, ReferenceState, design_groups,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::{Isa, Level};
use std::f64::consts::PI;

pub const RATES_HZ: [f64; 5] = [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];
pub const PLAIN: GroupOptions =
    GroupOptions { impulse_kernel_compensation: false, true_t60: true, derivative: 0 };

pub fn kernels() -> Vec<Level> {
    Isa::ALL.into_iter().filter_map(Level::find).collect()
}

pub fn mode(frequency_hz: f64, decay_per_s: f64, amplitude: f64, phase_rad: f64) -> Mode {
    Mode { frequency_hz, decay_per_s, amplitude, phase_rad }
}

pub fn design(modes: &[Mode], rate_hz: f64) -> Vec<ModeGroup> {
    design_groups(modes, rate_hz, &PLAIN).collect::<Result<_, _>>().unwrap()
}

/// A seeded body: frequencies spread over the audible band, decays that grow with frequency.
pub fn body(count: usize, rng: &mut Rng) -> Vec<Mode> {
    (0..count)
        .map(|_| {
            let f = 60.0 * (300.0_f64).powf(rng.uniform());
            let d = 2.0 + 1e-3 * f * (0.5 + rng.uniform()) + 20.0 * rng.uniform();
            mode(f, d, rng.uniform() + 0.01, 2.0 * PI * rng.uniform())
        })
        .collect()
}

/// A bank at rest that rings on to the last bit.
pub fn bank(kernel: Level, groups: &[ModeGroup]) -> ModalBank<&[ModeGroup], Vec<GroupState>> {
    ModalBank::new(kernel, groups, vec![GroupState::REST; groups.len()]).sleeping_below(0.0)
}

/// Renders `impulses` from absolute sample `first` in blocks whose lengths `next` gives.
pub fn render(
    kernel: Level,
    groups: &[ModeGroup],
    impulses: &[f32],
    first: u64,
    mut next: impl FnMut() -> usize,
) -> Vec<f32> {
    let mut bank = bank(kernel, groups);
    let mut out = vec![0.0; impulses.len()];
    let mut at = 0;
    while at < out.len() {
        let len = next().min(out.len() - at);
        bank.render(first + at as u64, Inputs::One(&impulses[at..at + len]), &mut out[at..at + len]);
        at += len;
    }
    out
}

pub fn reference(modes: &[Mode], rate_hz: f64, impulses: &[f32]) -> Vec<f64> {
    let mut out = vec![0.0; impulses.len()];
    for m in modes {
        let (design, mut state) =
            (ReferenceMode::new(m, rate_hz, &PLAIN).unwrap(), ReferenceState::default());
        for (y, &u) in out.iter_mut().zip(impulses) {
            *y += design.tick(&mut state, f64::from(u));
        }
    }
    out
}

pub fn error_db(y: &[f32], exact: &[f64]) -> f64 {
    let error: f64 = y.iter().zip(exact).map(|(a, b)| (f64::from(*a) - b).powi(2)).sum();
    10.0 * (error / exact.iter().map(|x| x * x).sum::<f64>()).log10()
}
