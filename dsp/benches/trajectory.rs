//! The path stage, 60 Hz events at 44.1 kHz, by mode.

use asperity_dsp::trajectory::{PathEvent, PathMode, PathPoint, Trajectory, TrajectoryDesign};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const SAMPLES: usize = 735;
const EVENTS: usize = 60;

fn trajectory(c: &mut Criterion) {
    let mut group = c.benchmark_group("trajectory");
    group.throughput(Throughput::Elements((SAMPLES * EVENTS) as u64)).sample_size(40);
    let event = |n: usize| PathEvent {
        sample: (n * SAMPLES) as u64,
        fraction: 0.0,
        position_m: [0.1 * n as f64 / 60.0, 0.03],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.5,
    };
    for mode in [PathMode::Extrapolate, PathMode::Hold, PathMode::Hermite] {
        let design = TrajectoryDesign::new(mode, 30.0, 44_100.0, [0.14; 2]).expect("a valid design");
        let mut out = [PathPoint::default(); SAMPLES];
        group.bench_function(format!("{mode:?}"), |b| {
            b.iter(|| {
                let mut path = Trajectory::begin(&design, &event(0));
                for n in 1..=EVENTS {
                    path.advance(&design, &mut out);
                    path.moved(&design, &event(n));
                }
                path
            });
        });
    }
    group.finish();
}

criterion_group!(benches, trajectory);
criterion_main!(benches);
