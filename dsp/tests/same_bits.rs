//! Bits of the kernels on every processor: what this machine renders is what any other does.
//!
//! The figures are of x86-64; `.ci/run` renders them again on 64-bit ARM and in WebAssembly. A
//! change of a kernel's arithmetic changes them, and the new ones stand in the message.

use asperity_dsp::butterworth::{Butterworth, State};
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::gradient_noise_3d::{GradientNoise3d, Noise3Batch};
use asperity_dsp::micro_contact::{ContactSample, Integrator, MicroContact, Probe};
use asperity_dsp::modal_bank::{
    GroupOptions, GroupState, Input, Inputs, LaneGains, ModalBank, design_groups, lane_gains,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;

const RATE_HZ: f64 = 44_100.0;
const BLOCK: usize = 64;

/// FNV-1a over numbers.
struct Bits(u64);

impl Bits {
    fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    fn add(&mut self, bits: u64) {
        // The upper half too: single precision fills no other.
        self.0 = (self.0 ^ bits ^ bits >> 32).wrapping_mul(0x0100_0000_01B3);
    }

    fn of(numbers: impl IntoIterator<Item = f64>) -> u64 {
        let mut bits = Self::new();
        numbers.into_iter().for_each(|x| bits.add(x.to_bits()));
        bits.0
    }
}

fn modes(count: usize) -> Vec<Mode> {
    let mut rng = Rng::new(3);
    let mode = |i: usize| Mode {
        frequency_hz: 60.0 + 15_000.0 * i as f64 / count as f64,
        decay_per_s: 2.0 + 300.0 * rng.uniform(),
        amplitude: 1.0 / count as f64,
        phase_rad: rng.uniform(),
    };
    (0..count).map(mode).collect()
}

/// 100 modes, struck at all by one input or at different places by two.
fn bank(level: Level, inputs: usize) -> u64 {
    let modes = modes(100);
    let groups = design_groups(&modes, RATE_HZ, &GroupOptions::IMPULSE_RING);
    let groups: Vec<_> = groups.collect::<Result<_, _>>().expect("modes as they may be");
    let states = vec![GroupState::REST; groups.len()];
    let mut bank = ModalBank::new(level, groups, states);
    let mut rng = Rng::new(7);
    let mut gains = |_| -> Vec<LaneGains> { lane_gains((0..100).map(|_| rng.uniform() as f32)).collect() };
    let gains: Vec<_> = (0..2).map(&mut gains).collect();
    let mut all = Vec::new();
    for block in 0..100 {
        let impulses: [Vec<f32>; 2] =
            std::array::from_fn(|_| (0..BLOCK - 3).map(|_| rng.uniform() as f32 - 0.5).collect());
        let placed = [0, 1].map(|i| Input { impulses: &impulses[i], gains: &gains[i] });
        let mut out = [0.0; BLOCK - 3];
        let heard = if inputs == 1 { Inputs::One(&impulses[0]) } else { Inputs::Placed(&placed) };
        bank.render((block * out.len()) as u64, heard, &mut out);
        all.extend(out.map(f64::from));
    }
    Bits::of(all)
}

fn contact(level: Level, integrator: Integrator) -> u64 {
    let design = MicroContact::new(&Probe::default(), integrator, RATE_HZ).expect("a valid probe").on(level);
    let mut state = design.at_rest(0.0, 0.5);
    let mut rng = Rng::new(5);
    let height_m: Vec<f64> = (0..4096).map(|_| 3e-6 * rng.normal()).collect();
    let mut out = vec![ContactSample::default(); height_m.len()];
    design.run(&mut state, &height_m, &vec![0.5; height_m.len()], &mut out);
    assert!(out.iter().any(|row| row.onset.is_some()), "a contact that bounces shows more");
    Bits::of(out.iter().flat_map(|row| [row.pad_m, row.pad_velocity_m_s, row.contact_force_n]))
}

fn relief(level: Level) -> u64 {
    let position_m: Vec<_> = (0..4097).map(|n| [2e-6 * f64::from(n), 0.01 - 1e-6 * f64::from(n)]).collect();
    let (footprint_m, roughness) = (vec![2e-6; position_m.len()], vec![0.6; position_m.len()]);
    let mut height_m = vec![0.0; position_m.len()];
    let path = NoisePath { position_m: &position_m, footprint_m: &footprint_m };
    let weights = OctaveWeights::pinned(2e-6, f64::INFINITY);
    FractalNoise::new(1).on(level).add(&path, &roughness, &weights, &mut height_m);
    Bits::of(height_m)
}

fn solid_noise(level: Level) -> u64 {
    let axis = |step: f64| -> Vec<f64> { (0..1001).map(|n| step * f64::from(n) - 3.0).collect() };
    let mut out = [const { [0.0; 1001] }; 4];
    let [value, dx, dy, dz] = &mut out;
    GradientNoise3d::new(9).on(level).batch(
        &axis(0.013),
        &axis(-0.027),
        &axis(0.0071),
        &mut Noise3Batch { value, dx, dy, dz },
    );
    Bits::of(out.as_flattened().iter().map(|x| f64::from(*x)))
}

fn path_filter() -> u64 {
    let mut rng = Rng::new(2);
    let filter = Butterworth::new(30.0, RATE_HZ).expect("a cutoff below half the rate");
    let mut state = State::settled_at(0.0);
    Bits::of((0..4096).map(|_| state.tick(&filter, rng.normal()).low))
}

/// Name, what renders it, its bits where products and sums round apart, and its bits where they are
/// fused.
type Figure = (&'static str, fn(Level) -> u64, u64, u64);

const FIGURES: [Figure; 7] = [
    ("bank, one input", |level| bank(level, 1), 0x4C0E_9F4A_90AB_9997, 0x69A0_ECCB_A688_861D),
    ("bank, two inputs", |level| bank(level, 2), 0x2F56_EC46_E2AE_588B, 0x9347_F7B3_96DA_2E48),
    (
        "contact, exact events",
        |level| contact(level, Integrator::ExactEvent),
        0x448C_AAB3_3A58_6667,
        0x2CDA_0421_41C3_5730,
    ),
    (
        "contact, semi-implicit Euler",
        |level| contact(level, Integrator::SemiImplicitEuler),
        0x990B_951D_CA77_2406,
        0x47C9_D6DE_AE3C_7D76,
    ),
    (
        "contact, energy-conserving",
        |level| contact(level, Integrator::EnergyConserving),
        0x5808_A83C_3209_2587,
        0xED66_7C2D_B2D1_9D50,
    ),
    ("micro-relief", relief, 0xED24_A48C_E892_9E3C, 0xED24_A48C_E892_9E3C),
    ("solid noise", solid_noise, 0x900D_F5B4_D047_48F5, 0x900D_F5B4_D047_48F5),
];

/// Figures that a level renders otherwise.
fn other_bits(level: Level) -> Vec<String> {
    let figures = FIGURES.into_iter().filter_map(|(name, render, apart, fused)| {
        let (found, figure) = (render(level), if level == Level::PORTABLE { apart } else { fused });
        (found != figure).then(|| format!("{name}, {:?}: {found:#018x}", level.isa()))
    });
    figures.collect()
}

#[test]
fn the_portable_level_renders_these_bits_on_every_processor() {
    assert_eq!(other_bits(Level::PORTABLE), [""; 0]);
}

#[test]
fn every_level_that_fuses_renders_these_bits() {
    let fused = Level::available().filter(|level| *level != Level::PORTABLE);
    assert_eq!(fused.flat_map(other_bits).collect::<Vec<_>>(), [""; 0]);
}

#[test]
fn the_path_filter_renders_these_bits_on_every_processor() {
    let found = path_filter();
    assert_eq!(found, 0x6F9F_D7B7_F95B_1594, "{found:#018x}");
}
