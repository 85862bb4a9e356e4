//! Mode-samples a second of every instruction set at hand, force in every sample; and what silence
//! costs. The comparison with C in one run is `examples/modal_speed.rs`.

use asperity_dsp::modal_bank::{GroupOptions, GroupState, Inputs, ModalBank, ModeGroup, design_groups};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::{Isa, Level};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const BLOCK: usize = 64;

fn bank(modes: usize) -> Vec<ModeGroup> {
    let mode = |i: usize| Mode {
        frequency_hz: 100.0 + 15_000.0 * i as f64 / modes as f64,
        decay_per_s: 5.0 + i as f64 / 10.0,
        amplitude: 1.0 / modes as f64,
        phase_rad: 0.0,
    };
    let all: Vec<Mode> = (0..modes).map(mode).collect();
    design_groups(&all, 44_100.0, &GroupOptions::IMPULSE_RING).collect::<Result<_, _>>().unwrap()
}

fn modal_bank(c: &mut Criterion) {
    let mut rng = Rng::new(1);
    let force: Vec<f32> = (0..BLOCK).map(|_| rng.uniform() as f32 - 0.5).collect();
    let mut group = c.benchmark_group("modal bank");
    for modes in [16, 64, 256, 1024, 4096] {
        let groups = bank(modes);
        group.throughput(Throughput::Elements((modes * BLOCK) as u64));
        for kernel in Isa::ALL.into_iter().filter_map(Level::find) {
            let states = vec![GroupState::REST; groups.len()];
            let mut bank = ModalBank::new(kernel, &groups[..], states);
            let (mut out, mut at) = (vec![0.0; BLOCK], 0);
            group.bench_function(format!("{:?}, {modes} modes", kernel.isa()), |b| {
                b.iter(|| {
                    bank.render(at, Inputs::One(&force), &mut out);
                    at += BLOCK as u64;
                });
            });
        }
        let states = vec![GroupState::REST; groups.len()];
        let mut bank = ModalBank::new(Level::detect(), &groups[..], states);
        let (mut out, mut at, silence) = (vec![0.0; BLOCK], 0, vec![0.0; BLOCK]);
        group.bench_function(format!("rung out, {modes} modes"), |b| {
            b.iter(|| {
                bank.render(at, Inputs::One(&silence), &mut out);
                at += BLOCK as u64;
            });
        });
    }
    group.finish();
}

criterion_group!(benches, modal_bank);
criterion_main!(benches);
