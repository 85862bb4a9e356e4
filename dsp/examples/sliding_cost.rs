//! What a contact that slides over a body costs the modal bank: two inputs with gains (fading out, fading in) against one with gains (a place that
//! stays) and one without (a body of one position). Processor time of the best of many runs; and stick–slip against one-way modes.

use asperity_dsp::modal_bank::{
    GroupOptions, GroupState, Input, Inputs, Kernel, LaneGains, ModalBank, design_groups,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::stick_slip::{Friction, RubState, RubbedBody, RubbedModes, Sweep};
use std::hint::black_box;
use std::time::Instant;

const RATE_HZ: f64 = 44_100.0;
const BLOCK: usize = 64;

fn best_ns(mut run: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..400 {
        let begun = Instant::now();
        run();
        best = best.min(begun.elapsed().as_nanos() as f64);
    }
    best
}

fn main() {
    let input: Vec<f32> = (0..BLOCK).map(|n| 1e-6 * (n as f32).sin()).collect();
    for count in [32, 100, 128, 512] {
        let mode = |i: usize| Mode {
            frequency_hz: 80.0 + 19_000.0 * i as f64 / count as f64,
            decay_per_s: 5.0,
            amplitude: 1.0,
            phase_rad: 1.0,
        };
        let modes: Vec<Mode> = (0..count).map(mode).collect();
        let designed = design_groups(&modes, RATE_HZ, &GroupOptions::IMPULSE_RING);
        let groups: Vec<_> = designed.collect::<Result<_, _>>().unwrap();
        let gains = vec![LaneGains([0.5; 16]); groups.len()];
        let time = |inputs: usize| {
            let states = vec![GroupState::REST; groups.len()];
            let mut bank = ModalBank::new(Kernel::detect(), &groups[..], states);
            let placed = [Input { impulses: &input, gains: &gains }; 2];
            let mut position = 0;
            best_ns(|| {
                for _ in 0..16 {
                    let mut out = [0.0; BLOCK];
                    match inputs {
                        0 => bank.render(position, Inputs::One(&input), &mut out),
                        n => bank.render(position, Inputs::Placed(&placed[..n]), &mut out),
                    }
                    position += BLOCK as u64;
                    black_box(out);
                }
            }) / (16 * BLOCK * count) as f64
        };
        let [shared, one, two] = [0, 1, 2].map(time);
        println!(
            "{count} modes: shared {shared:.4} ns a mode and sample, a place {:.2}, sliding {:.2} of it; sliding over a place {:.2}",
            one / shared,
            two / shared,
            two / one
        );
        let friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.02 };
        let rows = |modes: &[Mode]| -> Vec<RubbedModes> {
            modes.chunks(RubbedModes::LANES).map(|c| RubbedModes::new(c, RATE_HZ).unwrap()).collect()
        };
        let mut rubbed = rows(&modes);
        let mut body = RubbedBody::new(&mut rubbed, RATE_HZ);
        let mut state = RubState::default();
        body.touch_at(&mut state, |_| 0.3);
        let now = Sweep { sweep_m_s: 0.05, normal_force_n: 1.0, other_n_s: 0.0 };
        let coupled = best_ns(|| {
            for _ in 0..1024 {
                black_box(body.tick(&mut state, &friction, &now));
            }
        }) / (1024 * count) as f64;
        // The same modes driven one way: one pass of the plain delta form, sample by sample, its sum read out.
        let (mut y, mut d) = (vec![0.0_f32; count], vec![0.0_f32; count]);
        let one_way = best_ns(|| {
            for n in 0..1024 {
                let x = input[n % BLOCK];
                let mut sums = [0.0_f32; 8];
                for (y, d) in y.chunks_mut(8).zip(d.chunks_mut(8)) {
                    for ((y, d), sum) in y.iter_mut().zip(d).zip(&mut sums) {
                        *d = 0.9999 * *d - 0.01 * *y + 0.3 * x;
                        *y += *d;
                        *sum += 0.3 * *y;
                    }
                }
                black_box(sums);
            }
        }) / (1024 * count) as f64;
        println!(
            "    rubbed {coupled:.3} ns a mode and sample: {:.2} of the same modes one way",
            coupled / one_way
        );
    }
}
