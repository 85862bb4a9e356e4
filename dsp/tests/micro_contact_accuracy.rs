//! Error of each integrator against a 64 times oversampled reference, and of that reference against
//! figures that scipy made (`independent/micro_contact_reference.py`).

use crate::profiles;

use asperity_dsp::micro_contact::{
    ContactSample, Integrator, MicroContact, Probe, QuarticCorrections, SubSampleProfile,
};
use profiles::{HELD_OUT, Profile, SUITE};
use std::sync::OnceLock;

const RATE_HZ: f64 = 44_100.0;
const OVERSAMPLING: usize = 64;
/// Highest rate of a reference.
const REFERENCE_HZ: f64 = RATE_HZ * OVERSAMPLING as f64;

/// The contact whose figures an independent tool gave: linear, 50 kN/m.
fn linear() -> Probe {
    Probe { contact_stiffness_n_m: 5e4, force_exponent: 0.0, ..Probe::default() }
}

/// Rows aligned with the inputs: row n is input n.
fn rows(profile: &Profile, integrator: Integrator, rate_hz: f64) -> Vec<ContactSample> {
    let design = MicroContact::new(&linear(), integrator, rate_hz).unwrap();
    let (heights, forces) = (profile.heights_m(rate_hz), profile.forces_n(rate_hz));
    let mut state = design.at_rest(heights[0], forces[0]);
    let mut out = vec![ContactSample::default(); heights.len()];
    design.run(&mut state, &heights, &forces, &mut out);
    assert_eq!(state.resets(), 0);
    out.drain(..design.latency_samples());
    out
}

/// RMS of the difference over the AC RMS of the reference.
fn error(value: impl Fn(&ContactSample) -> f64, rows: &[ContactSample], reference: &[ContactSample]) -> f64 {
    let n = rows.len().min(reference.len());
    let mean = reference[..n].iter().map(&value).sum::<f64>() / n as f64;
    let pairs = rows.iter().zip(reference);
    let (difference, power) = pairs.fold((0.0, 0.0), |(d, p), (a, r)| {
        (d + (value(a) - value(r)).powi(2), p + (value(r) - mean).powi(2))
    });
    (difference / power).sqrt()
}

/// The oversampled reference at the times of `rate_hz`, its contact forces averaged over each step.
fn reference(profile: &Profile, rate_hz: f64) -> Vec<ContactSample> {
    let times = (REFERENCE_HZ / rate_hz).round() as usize;
    let fine = rows(profile, Integrator::ExactEvent, rate_hz * times as f64);
    let mut coarse: Vec<_> = fine.iter().copied().step_by(times).collect();
    for (n, row) in coarse.iter_mut().enumerate().skip(1) {
        let step = &fine[(n - 1) * times + 1..=n * times];
        row.contact_force_n = step.iter().map(|s| s.contact_force_n).sum::<f64>() / times as f64;
    }
    coarse
}

/// The references at 44.1 kHz, suite first, computed once.
fn references() -> &'static [Vec<ContactSample>] {
    static ALL: OnceLock<Vec<Vec<ContactSample>>> = OnceLock::new();
    ALL.get_or_init(|| SUITE.iter().chain(&HELD_OUT).map(|p| reference(p, RATE_HZ)).collect())
}

/// Force of the contact spring at the row's time.
fn spring_force_n(row: &ContactSample) -> f64 {
    (row.height_m - row.pad_m).max(0.0) * linear().contact_stiffness_n_m
}

/// Geometric means of the errors of pad position, spring force and mean contact force.
fn errors(
    suite: &[Profile],
    references: &[Vec<ContactSample>],
    rate_hz: f64,
    integrators: &[Integrator],
) -> Vec<[f64; 3]> {
    let mut logs = vec![[0.0; 3]; integrators.len()];
    for (profile, reference) in suite.iter().zip(references) {
        for (logs, &integrator) in logs.iter_mut().zip(integrators) {
            let rows = rows(profile, integrator, rate_hz);
            logs[0] += error(|s| s.pad_m, &rows, reference).ln();
            logs[1] += error(spring_force_n, &rows, reference).ln();
            logs[2] += error(|s| s.contact_force_n, &rows, reference).ln();
        }
    }
    logs.iter().map(|l| l.map(|x| (x / suite.len() as f64).exp())).collect()
}

#[test]
fn errors_stay_below_the_bars_on_unseen_profiles() {
    let (of_suite, of_held_out) = references().split_at(SUITE.len());
    for (name, suite, references) in [("suite", SUITE, of_suite), ("held out", HELD_OUT, of_held_out)] {
        let errors = errors(&suite, references, RATE_HZ, &Integrator::ALL);
        for (integrator, [pad, spring, mean]) in Integrator::ALL.iter().zip(&errors) {
            println!("{name} {:30} pad {pad:.2e} spring {spring:.2e} mean {mean:.2e}", integrator.name());
        }
        let [centred, explicit, exact, conserving] = [errors[0], errors[1], errors[2], errors[3]];
        assert!(exact[0] <= 5e-4 && exact[1] <= 2e-3 && exact[2] <= 2e-3, "{name}: {exact:?}");
        assert!(centred[0] <= 3e-3 && centred[1] <= 1e-2, "{name}: {centred:?}");
        assert!(conserving[0] <= 3e-3, "{name}: {conserving:?}");
        assert!(explicit[0] > 3.0 * centred[0], "{name}: centring the damper should pay, {explicit:?}");
    }
}

#[test]
fn errors_fall_with_the_rate_from_22_to_192_khz() {
    let suite = [SUITE[0], SUITE[1], SUITE[6], SUITE[11]];
    let mut last = f64::INFINITY;
    for (rate_hz, bar) in
        [(22_050.0, 5e-3), (44_100.0, 5e-4), (48_000.0, 5e-4), (96_000.0, 1e-4), (192_000.0, 1e-4)]
    {
        let references: Vec<_> = suite.iter().map(|p| reference(p, rate_hz)).collect();
        let [pad, spring, mean] = errors(&suite, &references, rate_hz, &[Integrator::ExactEvent])[0];
        println!("{rate_hz} Hz: pad {pad:.2e} spring {spring:.2e} mean {mean:.2e}");
        assert!(pad <= bar && pad < last, "{rate_hz} Hz: {pad:e}");
        last = pad;
    }
}

#[test]
fn the_reference_agrees_with_scipy() {
    let table = include_str!("independent/micro_contact_reference.csv");
    for (profile, fine) in SUITE.iter().chain(&HELD_OUT).zip(references()) {
        let coarse = rows(profile, Integrator::ExactEvent, RATE_HZ);
        let (mut count, mut worst) = (0, [0.0_f64; 4]);
        let mean = fine.iter().map(|s| s.pad_m).sum::<f64>() / fine.len() as f64;
        let rms = (fine.iter().map(|s| (s.pad_m - mean).powi(2)).sum::<f64>() / fine.len() as f64).sqrt();
        for line in table.lines().filter(|l| l.starts_with(&format!("{},", profile.name))) {
            let field = |i: usize| line.split(',').nth(i).unwrap().parse::<f64>().unwrap();
            let n = (field(1) * RATE_HZ).round() as usize;
            worst[0] = worst[0].max((fine[n].pad_m - field(2)).abs() / rms);
            worst[1] = worst[1].max((fine[n].finger_m - field(3)).abs() / rms);
            worst[2] = worst[2].max((coarse[n].pad_m - field(2)).abs() / rms);
            worst[3] = worst[3].max((fine[n].pad_velocity_m_s - field(4)).abs());
            count += 1;
        }
        println!(
            "{:20} {count} 64x: pad {:.1e} finger {:.1e}; 44.1 kHz: pad {:.1e}",
            profile.name, worst[0], worst[1], worst[2]
        );
        assert_eq!(count, 24, "{}", profile.name);
        // The lightest finger bounces chaotically, everything else agrees to 1e-5 or far better.
        let bar = if profile.name == "fractal 1 light" { 1e-3 } else { 1e-5 };
        assert!(worst[0] <= bar && worst[1] <= bar, "{}: {worst:?}", profile.name);
        assert!(worst[3] <= 1e3 * bar * rms, "{}: velocity {worst:?}", profile.name);
        assert!(worst[2] <= 5e-2, "{}: {worst:?}", profile.name);
    }
}

#[test]
fn collisions_on_a_fast_sine_are_found_to_a_microsecond() {
    let profile = &SUITE[1];
    let times = |rows: &[ContactSample], rate_hz: f64| -> Vec<f64> {
        let touch = |(n, row): (usize, &ContactSample)| {
            row.onset.map(|onset| (n as f64 - 1.0 + onset.offset) / rate_hz)
        };
        rows.iter().enumerate().filter_map(touch).collect()
    };
    let fine_hz = REFERENCE_HZ;
    let wanted = times(&rows(profile, Integrator::ExactEvent, fine_hz), fine_hz);
    assert!(wanted.len() > 380, "one touch a period: {}", wanted.len());
    for (integrator, bar_s) in [(Integrator::ExactEvent, 0.1e-6), (Integrator::SemiImplicitEuler, 5e-6)] {
        let found = times(&rows(profile, integrator, RATE_HZ), RATE_HZ);
        assert_eq!(found.len(), wanted.len(), "{}", integrator.name());
        let square = found.iter().zip(&wanted).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let rms_s = (square / found.len() as f64).sqrt();
        println!("{}: {} touches, {:.3} us rms", integrator.name(), found.len(), rms_s * 1e6);
        assert!(rms_s <= bar_s, "{}: {rms_s:e} s", integrator.name());
    }
}

/// Three waves of 6–9 samples, 2 µm high, under 0.1 N on 200 kN/m: the pad hops from crest to
/// crest.
fn quick_waves(at: f64) -> f64 {
    [(6.1, 0.0), (7.3, 1.0), (8.9, 2.0)]
        .iter()
        .map(|(samples, phase)| 1e-6 * (std::f64::consts::TAU * at / samples + phase).sin())
        .sum()
}

/// Known part of the ground between samples.
#[derive(Clone, Copy, PartialEq)]
enum Known {
    Nothing,
    Midway,
    Quarters,
}

/// Rows over them, `times` a sample, in such blocks.
fn over_quick_waves(times: usize, known: Known, cuts: usize) -> Vec<ContactSample> {
    let probe = Probe { contact_stiffness_n_m: 2e5, force_exponent: 0.0, ..Probe::default() };
    let design = MicroContact::new(&probe, Integrator::ExactEvent, RATE_HZ * times as f64).unwrap();
    let count = 8000 * times;
    let heights = |earlier: f64| -> Vec<f64> {
        (0..count).map(|n| quick_waves((n as f64 - earlier) / times as f64)).collect()
    };
    let [at, first, midway, second] = [0.0, 0.75, 0.5, 0.25].map(heights);
    let (mut bends, mut halves) = (vec![[0.0; 4]; count], vec![[[0.0; 4]; 2]; count]);
    QuarticCorrections::default().midway(design.level(), &at, &midway, &mut bends);
    QuarticCorrections::default().quarters(design.level(), &at, &midway, [&first, &second], &mut halves);
    let (forces, mut state) = (vec![0.1; count], design.at_rest(at[0], 0.1));
    let mut out = vec![ContactSample::default(); count];
    for (n, rows) in out.chunks_mut(cuts).enumerate() {
        let now = n * cuts..n * cuts + rows.len();
        let ground = match known {
            Known::Nothing => SubSampleProfile::AtSamples,
            Known::Midway => SubSampleProfile::Midway(&bends[now.clone()]),
            Known::Quarters => SubSampleProfile::Quarters(&halves[now.clone()]),
        };
        design.run_over(&mut state, &at[now.clone()], &forces[now], ground, rows);
    }
    out.drain(..design.latency_samples());
    out
}

#[test]
fn ground_known_midway_is_followed_a_hundred_times_as_well() {
    let fine = over_quick_waves(OVERSAMPLING, Known::Nothing, 1000);
    let reference: Vec<_> = fine.iter().copied().step_by(OVERSAMPLING).collect();
    let [plain, bent, halved] = [Known::Nothing, Known::Midway, Known::Quarters].map(|known| {
        let rows = over_quick_waves(1, known, 64);
        assert!(rows.iter().filter(|row| row.onset.is_some()).count() > 300, "the pad does not hop");
        error(|row| row.pad_m, &rows[1000..], &reference[1000..])
    });
    println!("cubic {plain:.2e}, known midway {bent:.2e}, at the quarters {halved:.2e}");
    assert!(bent < 1e-3 && bent < 0.05 * plain, "{plain:e}, {bent:e}");
    assert!(halved < 0.2 * bent, "{bent:e}, {halved:e}");
}

#[test]
fn bends_give_the_same_rows_in_any_blocks() {
    for known in [Known::Midway, Known::Quarters] {
        let whole = over_quick_waves(1, known, 8000);
        for cuts in [1, 7, 63, 200] {
            assert!(whole == over_quick_waves(1, known, cuts), "{cuts}");
        }
        assert!(whole != over_quick_waves(1, Known::Nothing, 8000));
    }
    // A height that is no number bends nothing.
    let design = MicroContact::new(&linear(), Integrator::ExactEvent, RATE_HZ).unwrap();
    let rows = |ground: SubSampleProfile<'_>| {
        let (mut state, mut out) = (design.at_rest(0.0, 0.5), [ContactSample::default(); 100]);
        let heights: Vec<f64> = (0..100).map(|n| 1e-6 * (0.3 * f64::from(n)).sin()).collect();
        design.run_over(&mut state, &heights, &[0.5; 100], ground, &mut out);
        out
    };
    for bend in [f64::NAN, f64::INFINITY, 1e9] {
        let [wrong, none] = [bend, 0.0].map(|bend| [[bend, 0.0, 0.0, 0.0]; 100]);
        assert!(rows(SubSampleProfile::Midway(&wrong)) == rows(SubSampleProfile::Midway(&none)), "{bend}");
        assert!(
            rows(SubSampleProfile::Midway(&none[..7])) == rows(SubSampleProfile::Midway(&none)),
            "missing"
        );
        let [wrong, none] = [wrong, none].map(|bends| bends.map(|bend| [[0.0; 4], bend]));
        assert!(
            rows(SubSampleProfile::Quarters(&wrong)) == rows(SubSampleProfile::Quarters(&none)),
            "{bend}"
        );
    }
}
