//! States of the modal bank: sleep, rest, broken numbers, retuning.

use super::made::{bank, body, design, kernels, mode, render};
use asperity_dsp::modal_bank::{GRID_SAMPLES, GroupState, Inputs, ModalBank, SLEEP_AMPLITUDE, sort_by_decay};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use std::f64::consts::PI;

#[test]
fn a_body_that_has_rung_out_sleeps_until_the_next_impulse() {
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
            history.push((bank.active_groups(), bank.is_at_rest()));
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
    assert!(banks.iter().all(|bank| bank.active_groups() == 0));
}

#[test]
fn broken_states_are_put_to_rest_and_loud_ones_ring_on() {
    let groups = design(&[mode(500.0, 1.0, 1.0, 0.5); 20], 44_100.0);
    for (impulse, ringing) in [(f32::NAN, 0), (f32::INFINITY, 0), (1e38, 0), (1e12, 2)] {
        let mut bank = bank(Level::detect(), &groups).sleeping_below(SLEEP_AMPLITUDE);
        let mut out = [0.0; 64];
        let mut impulses = [0.0; 64];
        impulses[3] = impulse;
        bank.render(0, Inputs::One(&impulses), &mut out);
        assert_eq!((bank.active_groups(), bank.is_at_rest()), (ringing, ringing == 0), "{impulse}");
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
    // From the lowest to near Nyquist; a quarter of the rate is where two samples turn a mode
    // round.
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
