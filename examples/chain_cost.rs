//! Cost of each stage of one contact, and growth of the whole with contacts and modes.
//!
//! `cargo run --release --example chain_cost`. One thread; the quickest tenth, so that a busy
//! machine matters less. Whole scenes in real time are measured by `asperity headroom` and `cargo
//! bench --bench headroom`.

#[path = "../benches/scenes/mod.rs"]
mod scenes;

use asperity::Config;
use asperity_dsp::actuator::{ContactOutput, ContactOutputState, Quantity};
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::micro_contact::{ContactSample, Integrator, MicroContact, Probe};
use asperity_dsp::trajectory::{PathEvent, PathMode, PathPoint, Trajectory, TrajectoryDesign};
use asperity_surface::height_field::{HeightField, PathBlock, SurfaceBlock};
use scenes::{Plan, Running};
use std::time::Instant;

const RATE_HZ: f64 = 44_100.0;
const FRAMES: usize = 64;

fn main() {
    stages();
    growth();
}

/// Ns that one call of `work` takes: the quickest tenth of `calls` calls. `prepare` runs before
/// each, outside the clock.
fn quiet_ns(calls: usize, prepare: &mut dyn FnMut(), work: &mut dyn FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..calls)
        .map(|_| {
            prepare();
            let began = Instant::now();
            work();
            began.elapsed().as_nanos() as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[calls / 10]
}

fn alone_ns(mut work: impl FnMut()) -> f64 {
    quiet_ns(20_000, &mut || (), &mut work)
}

/// The stages of one contact, each alone on blocks of 64.
fn stages() {
    println!("stage, ns/sample alone");
    let show = |name: &str, ns: f64| println!("  {name:<22} {:6.1}", ns / FRAMES as f64);
    let design =
        TrajectoryDesign::new(PathMode::Extrapolate, 30.0, RATE_HZ, [scenes::SIDE_M; 2]).expect("valid");
    let event = PathEvent {
        sample: 0,
        fraction: 0.0,
        position_m: [0.01, 0.02],
        velocity_m_s: Some([0.09, 0.04]),
        normal_force_n: 0.5,
    };
    let mut path = Trajectory::begin(&design, &event);
    let mut points = [PathPoint::default(); FRAMES];
    path.advance(&design, &mut points);
    show(
        "path",
        alone_ns(|| {
            path = Trajectory::begin(&design, &event);
            path.advance(&design, &mut points);
        }),
    );
    let mut map = scenes::map(1e-4);
    let position_m = points.map(|p| p.position_m);
    let velocity_m_s = points.map(|p| p.velocity_m_s);
    let footprint_m = [0.1 / RATE_HZ; FRAMES];
    let block = PathBlock {
        position_m: &position_m,
        velocity_m_s: &velocity_m_s,
        footprint_m: &footprint_m,
        normal_force_n: &[],
        first_sample: 0,
        contact: 0,
        slopes: false,
        ..PathBlock::default()
    };
    let mut out = SurfaceBlock::default();
    show("both maps", alone_ns(|| map.sample(&block, &mut out)));
    let noise = FractalNoise::new(1);
    let noise_path = NoisePath { position_m: &position_m, footprint_m: &footprint_m };
    let longest_m = map.properties([1.0; 2]).band.shortest_m;
    let mut height_m = out.height_m;
    show(
        "noise below the map",
        alone_ns(|| {
            noise.add(&noise_path, &out.roughness, &OctaveWeights::pinned(2e-6, longest_m), &mut height_m)
        }),
    );
    show(
        "noise, 12 octaves",
        alone_ns(|| {
            noise.add(&noise_path, &out.roughness, &OctaveWeights::pinned(2e-6, f64::INFINITY), &mut height_m)
        }),
    );
    let force_n = [0.5; FRAMES];
    let mut rows = [ContactSample::default(); FRAMES];
    for integrator in [Integrator::ExactEvent, Integrator::SemiImplicitEuler, Integrator::EnergyConserving] {
        let contact = MicroContact::new(&Probe::default(), integrator, RATE_HZ).expect("valid");
        let mut state = contact.at_rest(out.height_m[0], 0.5);
        show(
            &format!("{integrator:?}"),
            alone_ns(|| contact.run(&mut state, &out.height_m, &force_n, &mut rows)),
        );
    }
    let output = ContactOutput::new(Quantity::Displacement, 10.0, RATE_HZ).expect("valid");
    let mut feel = ContactOutputState::begin(&output, 0.0, 0.0);
    let mut felt = [0.0; FRAMES];
    show(
        "haptic high-pass",
        alone_ns(|| {
            for (felt, row) in felt.iter_mut().zip(&rows) {
                *felt = feel.tick(&output, row.pad_m, row.pad_velocity_m_s);
            }
        }),
    );
    std::hint::black_box(&felt);
}

fn busy_ns(plan: Plan) -> f64 {
    let blocks = (6000 / plan.contacts.max(1)).clamp(1500, 6000);
    let mut running = Running::new(Config::default(), plan, FRAMES);
    for _ in 0..400 {
        running.step();
        running.block();
    }
    let running = std::cell::RefCell::new(running);
    quiet_ns(blocks, &mut || running.borrow_mut().step(), &mut || running.borrow_mut().block())
        / FRAMES as f64
}

fn growth() {
    println!("contacts (16 modes and a map of 1024² each), ns/sample and contact");
    for contacts in [1, 2, 4, 8, 16, 32, 64] {
        let ns = busy_ns(Plan { contacts, modes: 16, speed_m_s: 0.1 });
        println!("  {contacts:4} {:8.1}", ns / contacts as f64);
    }
    println!("modes (one contact), ns/sample beyond a contact without");
    let without = busy_ns(Plan { contacts: 1, modes: 0, speed_m_s: 0.1 });
    for modes in [16, 64, 256, 1024, 4096] {
        let ns = busy_ns(Plan { contacts: 1, modes, speed_m_s: 0.1 }) - without;
        println!("  {modes:4} {ns:8.1}   {:.4} a mode", ns / modes as f64);
    }
}
