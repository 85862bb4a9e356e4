//! The modal bank against closed forms, against figures of scipy, and against its own reference.

use asperity_dsp::modal_bank::{
    Culling, GRID_SAMPLES, GroupOptions, GroupState, Input, Inputs, LANES, LaneGains, ModalBank, ModeGroup,
    ReferenceMode, ReferenceState, SLEEP_AMPLITUDE, audible, design_group, design_groups, lane_gains,
    sort_by_decay,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::{Isa, Level};
use std::f64::consts::PI;

const RATES_HZ: [f64; 5] = [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];
const PLAIN: GroupOptions = GroupOptions { impulse_kernel_compensation: false, true_t60: true };

fn kernels() -> Vec<Level> {
    Isa::ALL.into_iter().filter_map(Level::find).collect()
}

fn mode(frequency_hz: f64, decay_per_s: f64, amplitude: f64, phase_rad: f64) -> Mode {
    Mode { frequency_hz, decay_per_s, amplitude, phase_rad }
}

fn design(modes: &[Mode], rate_hz: f64) -> Vec<ModeGroup> {
    design_groups(modes, rate_hz, &PLAIN).collect::<Result<_, _>>().unwrap()
}

/// A seeded body: frequencies spread over the audible band, decays that grow with frequency.
fn body(count: usize, rng: &mut Rng) -> Vec<Mode> {
    (0..count)
        .map(|_| {
            let f = 60.0 * (300.0_f64).powf(rng.uniform());
            let d = 2.0 + 1e-3 * f * (0.5 + rng.uniform()) + 20.0 * rng.uniform();
            mode(f, d, rng.uniform() + 0.01, 2.0 * PI * rng.uniform())
        })
        .collect()
}

/// A bank at rest that rings on to the last bit.
fn bank(kernel: Level, groups: &[ModeGroup]) -> ModalBank<&[ModeGroup], Vec<GroupState>> {
    ModalBank::new(kernel, groups, vec![GroupState::REST; groups.len()]).sleeping_below(0.0)
}

/// Renders `impulses` from absolute sample `first` in blocks whose lengths `next` gives.
fn render(
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

fn reference(modes: &[Mode], rate_hz: f64, impulses: &[f32]) -> Vec<f64> {
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

fn error_db(y: &[f32], exact: &[f64]) -> f64 {
    let error: f64 = y.iter().zip(exact).map(|(a, b)| (f64::from(*a) - b).powi(2)).sum();
    10.0 * (error / exact.iter().map(|x| x * x).sum::<f64>()).log10()
}

#[test]
fn an_impulse_rings_as_the_formula_says_at_every_rate_and_phase() {
    for rate in RATES_HZ {
        for kernel in kernels() {
            for (f, d, phase) in
                [(440.0, 5.0, 0.0), (3_000.0, 200.0, 1.0), (82.4, 1.0, -2.2), (9_800.0, 30.0, 3.0)]
            {
                let groups = design(&[mode(f, d, 0.7, phase)], rate);
                let mut impulses = vec![0.0; (0.2 * rate) as usize];
                impulses[0] = 2e-3;
                let y = render(kernel, &groups, &impulses, 17, || 128);
                for (n, y) in y.iter().enumerate() {
                    let t = n as f64 / rate;
                    let exact = 1.4e-3 * (-d * t).exp() * (2.0 * PI * f * t + phase).sin();
                    assert!((f64::from(*y) - exact).abs() < 1.4e-3 * 3e-5, "{rate} Hz, {f} Hz, sample {n}");
                }
            }
        }
    }
}

#[test]
fn the_bank_agrees_with_scipy() {
    let modes = [mode(440.0, 12.0, 0.8, 0.0), mode(3217.5, 55.0, 0.5, 1.1), mode(61.7, 3.0, 1.3, -0.6)];
    // scipy.signal.lfilter, tests/independent/modal_bank.py.
    // Rate, (sample, value), rms over half a second.
    type Figures = (f64, [(usize, f64); 7], f64);
    let figures: [Figures; 2] = [
        (
            44_100.0,
            [
                (0, -0.000_288_431_535_4),
                (44, 0.000_333_732_255),
                (1323, -0.000_747_913_951_3),
                (2646, -0.000_618_679_326_8),
                (4851, -0.000_238_993_652_3),
                (11_025, 0.000_742_685_691_8),
                (21_609, 0.000_121_622_601),
            ],
            5.805_079_871e-4,
        ),
        (
            192_000.0,
            [
                (0, -0.000_288_431_535_4),
                (192, 0.000_313_578_994_7),
                (5760, -0.000_747_913_951_2),
                (11_520, -0.000_618_679_327_1),
                (21_120, -0.000_238_993_652_4),
                (48_000, 0.000_742_685_691_7),
                (94_080, 0.000_121_622_601_8),
            ],
            5.805_102_948e-4,
        ),
    ];
    for (rate, values, rms) in figures {
        let mut impulses = vec![0.0_f32; (0.5 * rate) as usize];
        for (t, j) in [(0.0, 1e-3), (0.05, -4e-4), (0.1, 7e-4)] {
            impulses[(t * rate).round() as usize] = j;
        }
        for kernel in kernels() {
            let y = render(kernel, &design(&modes, rate), &impulses, 0, || 64);
            for (n, expected) in values {
                assert!((f64::from(y[n]) - expected).abs() < 1e-7 * 0.1, "{rate} Hz, sample {n}: {}", y[n]);
            }
            let measured = (y.iter().map(|y| f64::from(*y).powi(2)).sum::<f64>() / y.len() as f64).sqrt();
            assert!((measured / rms - 1.0).abs() < 5e-6, "{rate} Hz: rms {measured}");
        }
    }
}

/// Pitch error in cents and relative error of T60 of a rendered impulse, by comparing the phasor of the output in two
/// windows (Hann, many periods) with that of the formula.
fn pitch_and_t60_error(y: &[f32], m: &Mode, rate: f64) -> (f64, f64) {
    let window = (40.0 / m.frequency_hz * rate) as usize;
    let gap = y.len() - window;
    let phasor = |from: usize, sample: &dyn Fn(usize) -> f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for n in 0..window {
            let w = 0.5 - 0.5 * (2.0 * PI * n as f64 / window as f64).cos();
            let angle = 2.0 * PI * m.frequency_hz * (from + n) as f64 / rate;
            let x = w * sample(from + n);
            re += x * angle.cos();
            im += x * angle.sin();
        }
        (im.atan2(re), (re * re + im * im).sqrt())
    };
    let exact = |n: usize| {
        let t = n as f64 / rate;
        m.amplitude * (-m.decay_per_s * t).exp() * (2.0 * PI * m.frequency_hz * t).sin()
    };
    let turn = |sample: &dyn Fn(usize) -> f64| {
        let (a, b) = (phasor(0, sample), phasor(gap, sample));
        (b.0 - a.0, (a.1 / b.1).ln())
    };
    let (ours, theirs) = (turn(&|n| f64::from(y[n])), turn(&exact));
    let time = gap as f64 / rate;
    let hertz = (ours.0 - theirs.0) / (2.0 * PI * time);
    (1200.0 * (1.0 - hertz / m.frequency_hz).log2(), theirs.1 / ours.1 - 1.0)
}

#[test]
fn a_30_hz_mode_that_rings_ten_seconds_keeps_pitch_and_decay_at_every_rate() {
    let m = mode(30.0, 3.0 * std::f64::consts::LN_10 / 10.0, 1.0, 0.0);
    assert!((m.t60_s() - 10.0).abs() < 1e-12);
    for rate in RATES_HZ {
        for kernel in kernels() {
            // Slightly detuned copies: coefficients round differently.
            for shift in [1.0, 0.93, 1.017, 1.08] {
                let m = mode(30.0 * shift, m.decay_per_s, 1.0, 0.0);
                let mut impulses = vec![0.0; (5.0 * rate) as usize];
                impulses[0] = 1.0;
                let y = render(kernel, &design(&[m], rate), &impulses, 0, || 4096);
                let (cents, t60) = pitch_and_t60_error(&y, &m, rate);
                println!("{rate} Hz {:?}: {cents:.1e} cent, T60 {:.1e} %", kernel.isa(), 100.0 * t60);
                assert!(cents.abs() < 0.001, "{rate} Hz, {:?}: {cents} cent", kernel.isa());
                assert!(t60.abs() < 1e-4, "{rate} Hz, {:?}: T60 {t60}", kernel.isa());
            }
        }
    }
}

#[test]
fn without_the_trim_the_decay_is_what_f32_can_store() {
    let m = mode(30.0, 0.690_775_5, 1.0, 0.0);
    let untrimmed = GroupOptions { true_t60: false, ..PLAIN };
    let group = design_group(&[m], 192_000.0, &untrimmed).unwrap();
    let mut impulses = vec![0.0; 960_000];
    impulses[0] = 1.0;
    let y = render(Level::detect(), &[group], &impulses, 0, || 4096);
    let (_, t60) = pitch_and_t60_error(&y, &m, 192_000.0);
    assert!(t60.abs() > 3e-4 && t60.abs() < 1e-2, "{t60}");
}

#[test]
fn white_force_leaves_no_error_above_minus_100_db() {
    let mut rng = Rng::new(3);
    for rate in [44_100.0, 192_000.0] {
        for count in [16, 64, 256, 1024] {
            let modes = body(count, &mut rng);
            let impulses: Vec<f32> = (0..8192).map(|_| 1e-6 * rng.normal() as f32).collect();
            let exact = reference(&modes, rate, &impulses);
            for kernel in kernels() {
                let db = error_db(&render(kernel, &design(&modes, rate), &impulses, 0, || 64), &exact);
                println!("{count} modes at {rate} Hz, {:?}: {db:.1} dB", kernel.isa());
                assert!(db <= -100.0, "{count} modes at {rate} Hz, {:?}: {db} dB", kernel.isa());
            }
        }
    }
}

#[test]
fn two_seconds_of_white_force_on_the_lowest_mode_leave_no_error_above_minus_100_db() {
    let mut rng = Rng::new(4);
    for rate in [44_100.0, 192_000.0] {
        let modes = [mode(30.0, 0.690_775_5, 1.0, 0.0)];
        let impulses: Vec<f32> = (0..(2.0 * rate) as usize).map(|_| 1e-6 * rng.normal() as f32).collect();
        let exact = reference(&modes, rate, &impulses);
        for kernel in kernels() {
            let db = error_db(&render(kernel, &design(&modes, rate), &impulses, 0, || 64), &exact);
            println!("{rate} Hz, {:?}: {db:.1} dB", kernel.isa());
            assert!(db <= -100.0, "{rate} Hz, {:?}: {db} dB", kernel.isa());
        }
    }
}

#[test]
fn any_split_into_blocks_gives_the_same_bits() {
    let mut rng = Rng::new(5);
    for count in [5, 16, 40, 100, 257] {
        let groups = design(&body(count, &mut rng), 44_100.0);
        let impulses: Vec<f32> = (0..9_000).map(|_| 1e-6 * rng.normal() as f32).collect();
        for kernel in kernels() {
            let whole = render(kernel, &groups, &impulses, 1_000_003, || 9_000);
            for size in [1, 3, 63, 64, 65, 256, 1000, 4096] {
                assert_eq!(whole, render(kernel, &groups, &impulses, 1_000_003, || size), "blocks of {size}");
            }
            let mut sizes = Rng::new(count as u64);
            let random =
                render(kernel, &groups, &impulses, 1_000_003, || 1 + (sizes.uniform() * 700.0) as usize);
            assert_eq!(whole, random);
        }
    }
}

#[test]
fn any_split_gives_the_same_bits_with_gained_inputs_too() {
    let mut rng = Rng::new(15);
    let groups = design(&body(70, &mut rng), 44_100.0);
    for inputs in [1, 2, 3] {
        let impulses: Vec<Vec<f32>> =
            (0..inputs).map(|_| (0..1_000).map(|_| rng.normal() as f32).collect()).collect();
        let gains: Vec<Vec<LaneGains>> = (0..inputs)
            .map(|_| groups.iter().map(|_| LaneGains(std::array::from_fn(|_| rng.normal() as f32))).collect())
            .collect();
        for kernel in kernels() {
            let split = |size: usize| {
                let (mut bank, mut out) = (bank(kernel, &groups), vec![0.0; 1_000]);
                for at in (0..1_000).step_by(size) {
                    let to = (at + size).min(1_000);
                    let feed: Vec<Input> = impulses
                        .iter()
                        .zip(&gains)
                        .map(|(impulses, gains)| Input { impulses: &impulses[at..to], gains })
                        .collect();
                    bank.render(77 + at as u64, Inputs::Placed(&feed), &mut out[at..to]);
                }
                out
            };
            let whole = split(1_000);
            for size in [1, 2, 3, 37, 64] {
                assert_eq!(whole, split(size), "{inputs} inputs, {:?}, blocks of {size}", kernel.isa());
            }
        }
    }
}

#[test]
fn every_set_with_fused_arithmetic_gives_the_same_bits() {
    let mut rng = Rng::new(6);
    let fused: Vec<Level> = kernels().into_iter().filter(|k| k.isa() != Isa::Portable).collect();
    for count in [1, 16, 17, 100, 300] {
        let groups = design(&body(count, &mut rng), 48_000.0);
        let impulses: Vec<f32> = (0..3_000).map(|_| rng.normal() as f32).collect();
        let all: Vec<_> = fused.iter().map(|&k| render(k, &groups, &impulses, 9, || 200)).collect();
        assert!(all.windows(2).all(|w| w[0] == w[1]), "{count} modes");
    }
}

#[test]
fn modes_at_or_above_nyquist_are_silent_and_those_below_are_not() {
    let silent = design(&[mode(22_050.0, 1.0, 1.0, 0.3), mode(30_000.0, 1.0, 1.0, 0.0)], 44_100.0);
    let impulses: Vec<f32> = (0..2000).map(|n| (n % 7) as f32).collect();
    assert!(render(Level::detect(), &silent, &impulses, 0, || 64).iter().all(|&y| y == 0.0));
    let heard = design(&[mode(22_000.0, 100.0, 1.0, 0.0)], 44_100.0);
    assert!(render(Level::detect(), &heard, &impulses, 0, || 64).iter().any(|&y| y.abs() > 1e-3));
}

#[test]
fn an_impulse_is_equally_loud_at_every_rate() {
    let mut levels = vec![];
    for rate in RATES_HZ {
        let groups = design(&[mode(500.0, 20.0, 1.0, 0.0), mode(1_700.0, 40.0, 0.5, 0.4)], rate);
        let mut impulses = vec![0.0; (0.3 * rate) as usize];
        impulses[5] = 1.0;
        let y = render(Level::detect(), &groups, &impulses, 0, || 64);
        levels.push(10.0 * (y.iter().map(|y| f64::from(*y).powi(2)).sum::<f64>() / rate).log10());
    }
    assert!(levels.iter().all(|l| (l - levels[1]).abs() < 0.02), "{levels:?} dB");
}

#[test]
fn several_inputs_add_up_with_their_gains() {
    let mut rng = Rng::new(7);
    let modes = body(40, &mut rng);
    let groups = design(&modes, 44_100.0);
    for inputs in 1..=5 {
        let impulses: Vec<Vec<f32>> =
            (0..inputs).map(|_| (0..700).map(|_| rng.normal() as f32).collect()).collect();
        let gains: Vec<Vec<LaneGains>> = (0..inputs)
            .map(|_| {
                groups.iter().map(|_| LaneGains(std::array::from_fn(|_| rng.uniform() as f32))).collect()
            })
            .collect();
        let mut exact = vec![0.0; 700];
        for (u, gains) in impulses.iter().zip(&gains) {
            for (i, m) in modes.iter().enumerate() {
                let gain = f64::from(gains[i / LANES].0[i % LANES]);
                let scaled = [Mode { amplitude: m.amplitude * gain, ..*m }];
                for (sum, y) in exact.iter_mut().zip(reference(&scaled, 44_100.0, u)) {
                    *sum += y;
                }
            }
        }
        let feed: Vec<Input> =
            impulses.iter().zip(&gains).map(|(impulses, gains)| Input { impulses, gains }).collect();
        for kernel in kernels() {
            let mut out = vec![0.0; 700];
            bank(kernel, &groups).render(3, Inputs::Placed(&feed), &mut out);
            let db = error_db(&out, &exact);
            assert!(db < -100.0, "{inputs} inputs, {:?}: {db} dB", kernel.isa());
        }
    }
}

#[test]
fn gains_that_change_while_something_slides_are_two_inputs_that_cross_fade_without_a_step() {
    let (rate, samples) = (44_100.0, 8_820);
    let mut rng = Rng::new(71);
    let modes = body(37, &mut rng);
    let groups = design(&modes, rate);
    let ends: [Vec<f32>; 2] = std::array::from_fn(|_| modes.iter().map(|_| rng.normal() as f32).collect());
    let gains = ends.each_ref().map(|gains| lane_gains(gains.iter().copied()).collect::<Vec<_>>());
    let force: Vec<f32> = (0..samples).map(|_| 1e-6 * rng.normal() as f32).collect();
    let way = |n: usize| (n as f32 / samples as f32).clamp(0.0, 1.0);
    let leaving: Vec<f32> = force.iter().enumerate().map(|(n, u)| (1.0 - way(n)) * u).collect();
    let coming: Vec<f32> = force.iter().enumerate().map(|(n, u)| way(n) * u).collect();
    // Each mode by itself, driven by the force times its own gain at that sample.
    let mut exact = vec![0.0; samples];
    for (i, m) in modes.iter().enumerate() {
        let (design, mut state) = (ReferenceMode::new(m, rate, &PLAIN).unwrap(), ReferenceState::default());
        for (n, y) in exact.iter_mut().enumerate() {
            let gain = (1.0 - way(n)) * ends[0][i] + way(n) * ends[1][i];
            *y += design.tick(&mut state, f64::from(gain) * f64::from(force[n]));
        }
    }
    for kernel in kernels() {
        let mut out = vec![0.0; samples];
        let feed =
            [Input { impulses: &leaving, gains: &gains[0] }, Input { impulses: &coming, gains: &gains[1] }];
        bank(kernel, &groups).render(0, Inputs::Placed(&feed), &mut out);
        let db = error_db(&out, &exact);
        assert!(db < -100.0, "{:?}: {db} dB", kernel.isa());
    }
}

#[test]
fn a_bank_begins_as_its_states_are_and_forgets_them_when_it_is_silenced() {
    let groups = design(&body(40, &mut Rng::new(72)), 48_000.0);
    let mut struck = ModalBank::new(Level::detect(), &groups[..], [GroupState::REST; 3]);
    let mut impulses = [0.0; 64];
    impulses[5] = 1e-3;
    let (mut out, mut rest) = ([0.0; 64], [0.0; 64]);
    struck.render(0, Inputs::One(&impulses), &mut out);
    assert_eq!((struck.awake(), struck.groups()), (3, 3));
    let mut copy = struck.clone();
    copy.render(64, Inputs::One(&[0.0; 64]), &mut rest);
    assert!(rest.iter().any(|y| *y != 0.0));
    struck.silence();
    assert!(struck.is_at_rest() && struck.awake() == 0 && struck.energy() == 0.0);
    out.fill(0.0);
    struck.render(64, Inputs::One(&[0.0; 64]), &mut out);
    assert!(out.iter().all(|y| *y == 0.0));
}

#[test]
fn output_is_added_to_what_is_there_and_unequal_slices_do_no_harm() {
    let groups = design(&[mode(500.0, 20.0, 1.0, 0.5)], 44_100.0);
    let mut out = [1.0_f32; 8];
    let mut bank = bank(Level::detect(), &groups);
    bank.render(0, Inputs::One(&[0.0; 3]), &mut out);
    assert_eq!(out, [1.0; 8]);
    let mut without_memory = ModalBank::new(Level::detect(), &groups[..], []);
    without_memory.render(0, Inputs::One(&[1.0; 8]), &mut out);
    bank.render(0, Inputs::Placed(&[]), &mut out);
    bank.render(0, Inputs::Placed(&[Input { impulses: &[1.0; 8], gains: &[] }]), &mut out);
    assert_eq!(out, [1.0; 8]);
    bank.render(u64::MAX - 2, Inputs::One(&[1.0; 8]), &mut out);
    assert!(out.iter().all(|&y| y > 1.0));
}

#[test]
fn a_body_that_has_rung_out_sleeps_exactly_and_wakes_with_the_next_impulse() {
    let mut rng = Rng::new(8);
    let mut modes = body(100, &mut rng);
    sort_by_decay(&mut modes);
    assert!(modes.windows(2).all(|w| w[0].decay_per_s <= w[1].decay_per_s));
    let rate = 44_100.0;
    let groups = design(&modes, rate);
    let samples = 20 * 44_100 / 64 * 64;
    let mut impulses = vec![0.0_f32; samples];
    impulses[100] = 1e-2;
    impulses[samples - 1000] = 1e-2;
    let whole = render(Level::detect(), &groups, &impulses, 7, || 64);
    let sleepy = |block: usize| {
        let mut bank = ModalBank::new(Level::detect(), &groups[..], vec![GroupState::REST; groups.len()]);
        let (mut out, mut history) = (vec![0.0_f32; samples], vec![]);
        for at in (0..samples).step_by(block) {
            let to = (at + block).min(samples);
            bank.render(7 + at as u64, Inputs::One(&impulses[at..to]), &mut out[at..to]);
            history.push((bank.awake(), bank.is_at_rest()));
        }
        (out, history)
    };
    let (out, history) = sleepy(64);
    // Groups fall asleep one after the other, then all, then all wake at once.
    assert_eq!(history[2].0, 7);
    let counts: Vec<usize> = history.iter().map(|h| h.0).collect();
    assert!((1..7).all(|n| counts.contains(&n)), "groups fall asleep one by one");
    let asleep = 2 + history[2..].iter().position(|h| h.0 == 0).expect("the body falls silent");
    assert!(history[asleep].1 && out[(asleep + 1) * 64..samples - 1100].iter().all(|&y| y == 0.0));
    assert_eq!(history.last().unwrap().0, 7);
    let error = out.iter().zip(&whole).fold(0.0_f32, |e, (a, b)| e.max((a - b).abs()));
    assert!(error < 100.0 * SLEEP_AMPLITUDE, "{error}");
    for block in [1, 50, 1024, 4096] {
        assert_eq!(out, sleepy(block).0, "blocks of {block}");
    }
}

#[test]
fn no_state_is_ever_denormal_while_a_body_rings_out() {
    let mut rng = Rng::new(9);
    let mut modes = body(64, &mut rng);
    sort_by_decay(&mut modes);
    let groups = design(&modes, 44_100.0);
    // A bank a group: so that the quietest of them is seen.
    let states = vec![GroupState::REST; groups.len()];
    let alone = groups.iter().zip(states.chunks(1));
    let mut banks: Vec<_> = alone.map(|(g, s)| ModalBank::new(Level::detect(), [*g], s.to_vec())).collect();
    let mut out = [0.0_f32; 64];
    for block in 0..20_000_u64 {
        let mut impulses = [0.0; 64];
        if block == 0 {
            impulses[0] = 1e-3;
        }
        out.fill(0.0);
        for bank in &mut banks {
            bank.render(block * 64, Inputs::One(&impulses), &mut out);
            assert!(out.iter().all(|y| *y == 0.0 || y.is_normal()));
            let rings = bank.energy() >= 0.99 * SLEEP_AMPLITUDE * SLEEP_AMPLITUDE;
            assert!(bank.is_at_rest() || rings, "block {block}");
        }
    }
    assert!(banks.iter().all(|bank| bank.awake() == 0));
}

#[test]
fn broken_states_are_put_to_rest() {
    let groups = design(&[mode(500.0, 1.0, 1.0, 0.5); 20], 44_100.0);
    for poison in [f32::NAN, f32::INFINITY, 1e38] {
        let mut bank = bank(Level::detect(), &groups).sleeping_below(SLEEP_AMPLITUDE);
        let mut out = [0.0; 64];
        let mut impulses = [0.0; 64];
        impulses[3] = poison;
        bank.render(0, Inputs::One(&impulses), &mut out);
        assert_eq!(bank.awake(), 0);
        assert!(bank.is_at_rest());
    }
}

#[test]
fn retuning_every_grid_step_adds_no_energy_and_no_jump() {
    let mut rng = Rng::new(10);
    let base: Vec<Mode> = (0..16).map(|_| mode(300.0 + 2_000.0 * rng.uniform(), 0.0, 1.0, 1.0)).collect();
    for factor in [1.02, 1.5, 4.0] {
        let moved: Vec<Mode> =
            base.iter().map(|m| Mode { frequency_hz: m.frequency_hz * factor, ..*m }).collect();
        let pair = [design(&base, 44_100.0)[0], design(&moved, 44_100.0)[0]];
        let mut bank = ModalBank::new(Level::detect(), [pair[0]], [GroupState::REST]);
        let mut impulses = [0.0; GRID_SAMPLES as usize];
        impulses[0] = 1.0;
        let mut out = [0.0; GRID_SAMPLES as usize];
        bank.render(0, Inputs::One(&impulses), &mut out);
        let struck = bank.energy();
        assert!((struck - 16.0).abs() < 1e-3, "16 undamped modes of amplitude 1: {struck}");
        for step in 0..1000_usize {
            bank.retune(0, &pair[(step + 1) % 2]);
            bank.render(0, Inputs::One(&[0.0; 64]), &mut out);
            let now = bank.energy();
            assert!((now / struck - 1.0).abs() < 1e-3, "x{factor}, step {step}: {now} of {struck}");
        }
    }
}

#[test]
fn undamped_modes_keep_their_energy_for_three_million_samples() {
    let rate = 44_100.0;
    // From the lowest to near Nyquist; a quarter of the rate is where two samples turn a mode round.
    let hertz =
        [30.0, 55.3, 110.0, 440.0, 997.0, 3_001.0, 7_350.0, 11_025.0, 11_026.0, 15_000.0, 20_000.0, 21_900.0];
    let modes: Vec<Mode> = hertz.iter().map(|&f| mode(f, 0.0, 1.0, 0.7)).collect();
    for kernel in kernels() {
        for m in &modes {
            let groups = design(&[*m], rate);
            let (mut bank, mut out) = (bank(kernel, &groups), vec![0.0; 4096]);
            let mut impulses = vec![0.0; 4096];
            impulses[0] = 1.0;
            bank.render(0, Inputs::One(&impulses), &mut out);
            let struck = bank.energy();
            impulses[0] = 0.0;
            let blocks = 730;
            for block in 1..blocks {
                bank.render(block * 4096, Inputs::One(&impulses), &mut out);
            }
            let gain = bank.energy() / struck;
            println!("{:?}, {} Hz: energy x {gain}", kernel.isa(), m.frequency_hz);
            assert!((gain - 1.0).abs() < 1e-2, "{:?}, {} Hz: energy x {gain}", kernel.isa(), m.frequency_hz);
        }
    }
}

#[test]
fn a_retuned_mode_goes_on_at_its_phase_with_its_new_frequency() {
    let rate = 44_100.0;
    let (old, new) = (mode(700.0, 10.0, 0.9, 0.4), mode(1_000.0, 30.0, 0.3, -1.0));
    let pair = [design(&[old], rate)[0], design(&[new], rate)[0]];
    let mut bank = ModalBank::new(Level::detect(), [pair[0]], [GroupState::REST]);
    let mut impulses = [0.0; 500];
    impulses[0] = 1.0;
    let mut out = [0.0; 500];
    bank.render(0, Inputs::One(&impulses), &mut out);
    bank.retune(0, &pair[1]);
    out.fill(0.0);
    bank.render(500, Inputs::One(&[0.0; 500]), &mut out);
    let t0 = 499.0 / rate;
    let level = 0.9 * (-10.0 * t0).exp();
    let phase = 2.0 * PI * 700.0 * t0 + 0.4;
    for (n, y) in out.iter().enumerate() {
        let t = (n + 1) as f64 / rate;
        let exact = level * (-30.0 * t).exp() * (2.0 * PI * 1_000.0 * t + phase).sin();
        assert!((f64::from(*y) - exact).abs() < 2e-5, "sample {n}: {y} {exact}");
    }
}

#[test]
fn culling_keeps_what_is_heard() {
    let modes = [
        mode(1_000.0, 5.0, 1.0, 0.0),
        // 60 dB below, in the next critical band and shorter: masked.
        mode(1_040.0, 8.0, 1e-3, 0.0),
        // As quiet and as near, but it outlasts the loud one: kept.
        mode(1_045.0, 1.0, 1e-3, 0.0),
        // As quiet, three octaves up: kept.
        mode(8_000.0, 50.0, 1e-3, 0.0),
        // Below the level threshold.
        mode(300.0, 1.0, 1e-5, 0.0),
        // Above Nyquist.
        mode(30_000.0, 1.0, 1.0, 0.0),
    ];
    let mut keep = [true; 6];
    assert_eq!(audible(&modes, 44_100.0, &Culling::default(), &mut keep), 3);
    assert_eq!(keep, [true, false, true, true, false, false]);
    let everything = Culling { level_db: f64::INFINITY, masking: false, ..Culling::default() };
    assert_eq!(audible(&modes, 96_000.0, &everything, &mut keep), 6);
}

/// Masking as the equations say, every mode against every other.
fn exactly_audible(modes: &[Mode]) -> Vec<bool> {
    let bark = |f: f64| 26.81 * f / (1960.0 + f) - 0.53;
    let loudest = modes.iter().fold(0.0_f64, |a, m| a.max(m.amplitude.abs()));
    let level = |m: &Mode| 80.0 + 20.0 * (m.amplitude.abs() / loudest).log10();
    let masks = |other: &Mode, mode: &Mode| {
        let (l, dz) = (level(other), bark(mode.frequency_hz) - bark(other.frequency_hz));
        let slope = if !(-3.0..8.0).contains(&dz) {
            f64::NEG_INFINITY
        } else if dz < -1.0 {
            17.0 * dz - 0.4 * l + 11.0
        } else if dz < 0.0 {
            (0.4 * l + 6.0) * dz
        } else if dz < 1.0 {
            -17.0 * dz
        } else {
            -17.0 - (dz - 1.0) * (17.0 - 0.15 * l)
        };
        let below = l - 6.025 - 0.275 * bark(other.frequency_hz) + slope;
        other.decay_per_s <= mode.decay_per_s && level(mode) < below
    };
    modes.iter().map(|m| level(m) >= 0.0 && !modes.iter().any(|other| masks(other, m))).collect()
}

#[test]
fn masking_in_bands_loses_nothing_audible_and_finds_nearly_all_that_is_masked() {
    let mut rng = Rng::new(31);
    for (count, equal_decays) in [(20, false), (400, false), (400, true), (4000, false)] {
        let mut modes = body(count, &mut rng);
        for m in &mut modes {
            m.amplitude = 10f64.powf(-4.0 * rng.uniform());
            if equal_decays {
                m.decay_per_s = 8.0;
            }
        }
        sort_by_decay(&mut modes);
        let mut keep = vec![false; count];
        let start = std::time::Instant::now();
        let kept = audible(&modes, 44_100.0, &Culling::default(), &mut keep);
        let took = start.elapsed();
        let exact = exactly_audible(&modes);
        println!("{count} modes: {kept} kept, exactly {:?}", exact.iter().filter(|k| **k).count());
        assert!(
            keep.iter().zip(&exact).all(|(keep, exact)| *keep || !exact),
            "{count}: something audible went"
        );
        let superfluous = keep.iter().zip(&exact).filter(|(keep, exact)| **keep && !**exact).count();
        assert!(superfluous * 50 <= count, "{count} modes: {superfluous} masked ones stay");
        assert!(took.as_millis() < 2_000, "{took:?}");
    }
}

#[test]
fn impossible_modes_are_refused_by_name() {
    let field = |m: Mode| design_group(&[m], 44_100.0, &PLAIN).unwrap_err().field;
    assert_eq!(field(mode(0.0, 1.0, 1.0, 0.0)), "frequency_hz");
    assert_eq!(field(mode(f64::NAN, 1.0, 1.0, 0.0)), "frequency_hz");
    assert_eq!(field(mode(100.0, -1.0, 1.0, 0.0)), "decay_per_s");
    assert_eq!(field(mode(100.0, 1.0, f64::INFINITY, 0.0)), "amplitude");
    assert_eq!(field(mode(100.0, 1.0, 1.0, f64::NAN)), "phase_rad");
    assert_eq!(design_group(&[], 0.0, &PLAIN), Ok(ModeGroup::SILENT));
    assert_eq!(design_group(&[mode(100.0, 1.0, 1.0, 0.0); 17], 44_100.0, &PLAIN).unwrap_err().field, "modes");
    assert_eq!(
        design_group(&[mode(100.0, 1.0, 1.0, 0.0)], -1.0, &PLAIN).unwrap_err().field,
        "sample_rate_hz"
    );
}
