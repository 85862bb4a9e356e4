//! Inputs, gains and blocks of the modal bank.

use super::made::{PLAIN, RATES_HZ, bank, body, design, error_db, kernels, mode, reference, render};
use asperity_dsp::modal_bank::{
    GroupState, Input, Inputs, LANES, LaneGains, ModalBank, ReferenceMode, ReferenceState, lane_gains,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::{Isa, Level};

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
fn gains_changed_while_sliding_cross_fade_without_a_step() {
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
fn a_bank_begins_with_its_states_and_loses_them_when_silenced() {
    let groups = design(&body(40, &mut Rng::new(72)), 48_000.0);
    let mut struck = ModalBank::new(Level::detect(), &groups[..], [GroupState::REST; 3]);
    let mut impulses = [0.0; 64];
    impulses[5] = 1e-3;
    let (mut out, mut rest) = ([0.0; 64], [0.0; 64]);
    struck.render(0, Inputs::One(&impulses), &mut out);
    assert_eq!((struck.active_groups(), struck.groups()), (3, 3));
    let mut copy = struck.clone();
    copy.render(64, Inputs::One(&[0.0; 64]), &mut rest);
    assert!(rest.iter().any(|y| *y != 0.0));
    struck.silence();
    assert!(struck.is_at_rest() && struck.active_groups() == 0 && struck.energy() == 0.0);
    out.fill(0.0);
    struck.render(64, Inputs::One(&[0.0; 64]), &mut out);
    assert!(out.iter().all(|y| *y == 0.0));
}

#[test]
fn output_is_added_and_unequal_slices_do_no_harm() {
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
