//! A rub coupled with a whole modal bank: against the plain step, the closed form, its energy, and
//! any cut into blocks.

use asperity_dsp::modal_bank::{
    FreeResponse, GroupOptions, GroupState, Input, Inputs, LANES, LaneGains, ModalBank, ModeGroup,
    design_groups, lane_gains,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use asperity_dsp::stick_slip::{
    Answer, CELL, Coupled, Friction, RubState, RubbedBody, RubbedModes, Sweep, place_speed,
};
use std::f64::consts::{PI, TAU};

type Bank = ModalBank<Box<[ModeGroup]>, Box<[GroupState]>>;

/// A body that is rubbed at one place: its modes, and φ of each there.
struct Rubbed {
    sound: Bank,
    ahead: Vec<FreeResponse>,
    answer: Answer,
    gains: Vec<LaneGains>,
    coupled: Coupled,
    position: u64,
    rate_hz: f64,
}

impl Rubbed {
    fn new(modes: &[(Mode, f64)], rate_hz: f64) -> Self {
        let level = Level::detect();
        let sound: Vec<Mode> = modes.iter().map(|(mode, _)| *mode).collect();
        // The input has the gain φ, and so has the output: half of the product each.
        let speed: Vec<Mode> =
            modes.iter().map(|(mode, phi)| place_speed(mode, *phi, rate_hz).unwrap()).collect();
        let squares: Vec<(Mode, f64)> = modes.iter().map(|(mode, phi)| (*mode, phi * phi)).collect();
        let mut answer = Answer::RIGID;
        answer.add_modes(level, &squares, rate_hz).unwrap();
        let groups: Box<[ModeGroup]> =
            design_groups(&sound, rate_hz, &GroupOptions::IMPULSE_RING).collect::<Result<_, _>>().unwrap();
        let states = vec![GroupState::REST; groups.len()].into();
        Self {
            sound: ModalBank::new(level, groups, states),
            ahead: speed.chunks(LANES).map(|speeds| FreeResponse::design(speeds, rate_hz).unwrap()).collect(),
            answer,
            gains: lane_gains(modes.iter().map(|(_, phi)| *phi as f32)).collect(),
            coupled: Coupled::begin(level),
            position: 0,
            rate_hz,
        }
    }

    /// The next samples, within one cell: forces and the sound.
    fn run(&mut self, friction: &Friction, sweep: &[Sweep]) -> (Vec<f64>, Vec<f32>) {
        let n = sweep.len();
        let first = self.position as usize % CELL;
        if first == 0 {
            let mut free = [0.0; CELL];
            self.sound.ahead(&self.ahead, &mut free);
            self.coupled.next_cell(&self.answer, &free);
        }
        let forces = self.coupled.run(friction, first, sweep, &[0.0; CELL]).to_vec();
        let mut impulses = vec![0.0; n];
        self.coupled.impulses(first, self.rate_hz, &mut impulses);
        let impulses: Vec<f32> = impulses.iter().map(|x| *x as f32).collect();
        let mut out = vec![0.0; n];
        let input = [Input { impulses: &impulses, gains: &self.gains }];
        self.sound.render(self.position, Inputs::Placed(&input), &mut out);
        self.position += n as u64;
        (forces, out)
    }
}

fn mode(frequency_hz: f64, decay_per_s: f64) -> Mode {
    Mode { frequency_hz, decay_per_s, amplitude: 1.0, phase_rad: 0.3 }
}

/// A body of some modes, and its plain twin.
fn many(count: usize, rate_hz: f64) -> (Vec<(Mode, f64)>, Vec<RubbedModes>) {
    let mut rng = Rng::new(31);
    let modes: Vec<(Mode, f64)> = (0..count)
        .map(|i| (mode(90.0 * 1.045_f64.powi(i as i32), 3.0 + 0.3 * i as f64), 0.2 + 3.0 * rng.uniform()))
        .collect();
    let plain: Vec<Mode> = modes.iter().map(|(mode, _)| *mode).collect();
    let plain = plain.chunks(RubbedModes::LANES).map(|c| RubbedModes::new(c, rate_hz).unwrap()).collect();
    (modes, plain)
}

#[test]
fn a_bank_rubs_as_the_plain_modes_do() {
    let rate_hz = 44_100.0;
    let (modes, mut plain) = many(100, rate_hz);
    let mut rubbed = Rubbed::new(&modes, rate_hz);
    let mut twin = RubbedBody::new(&mut plain, rate_hz);
    let mut state = RubState::default();
    twin.touch_at(&mut state, |k| modes.get(k).map_or(0.0, |(_, phi)| *phi as f32));
    let friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.05 };
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    // Before rounding parts two chaotic twins: the first fifth of a second.
    for cell in 0..140 {
        let now = |i: usize| {
            let t = (cell * CELL + i) as f64 / rate_hz;
            Sweep {
                sweep_m_s: 0.1 * (t / 0.02).min(1.0),
                normal_force_n: 1.0 + 0.2 * (40.0 * t).sin(),
                other_n_s: 0.0,
            }
        };
        let sweep: Vec<Sweep> = (0..CELL).map(now).collect();
        let (forces, _) = rubbed.run(&friction, &sweep);
        for (force_n, sweep) in forces.iter().zip(&sweep) {
            let rub = twin.tick(&mut state, &friction, sweep);
            worst = worst.max((force_n - rub.force_n).abs());
            most = most.max(rub.force_n.abs());
        }
    }
    println!("{worst:e} N apart of {most} N");
    assert!(worst <= 1e-3 * most, "{worst} N of {most} N");
}

#[test]
fn the_period_in_a_bank_is_that_of_the_closed_form() {
    let friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 1e-9 };
    let mut worst = 0.0_f64;
    for (frequency_hz, mass_kg, depth) in
        [(50.0, 0.5, 3.0), (220.0, 0.08, 5.0), (430.0, 0.02, 2.0), (800.0, 0.004, 8.0)]
    {
        for rate_hz in [44_100.0, 96_000.0, 192_000.0] {
            let mut rubbed = Rubbed::new(&[(mode(frequency_hz, 0.0), f64::powf(mass_kg, -0.5))], rate_hz);
            let w = TAU * frequency_hz;
            let normal_force_n = 1.5;
            let a = normal_force_n * 0.5 / (mass_kg * w * w);
            let sweep_m_s = a * w / depth;
            let exact = 2.0 * a / sweep_m_s + 2.0 / w * (PI - (a * w / sweep_m_s).atan());
            let sweep = [Sweep { sweep_m_s, normal_force_n, other_n_s: 0.0 }];
            let (mut begun, mut stuck) = (Vec::new(), false);
            let samples = (rate_hz * (2.0 + 400.0 / frequency_hz)) as u64;
            for n in 0..samples {
                rubbed.run(&friction, &sweep);
                let sticks = rubbed.coupled.sticks();
                if stuck && !sticks && n > samples / 4 {
                    begun.push(n);
                }
                stuck = sticks;
            }
            assert!(begun.len() > 20, "only {} slips", begun.len());
            let mean = (begun[begun.len() - 1] - begun[0]) as f64 / (begun.len() - 1) as f64 / rate_hz;
            let error = 100.0 * (mean / exact - 1.0);
            println!("{frequency_hz} Hz at {rate_hz} Hz: {error:+.3} %");
            worst = worst.max(error.abs());
        }
    }
    assert!(worst <= 0.2, "worst {worst:.3} %");
}

// A plain integrator of another hand (events by linear interpolation, fourth-order steps of 1/4000
// of a period): frequency, decay, mass, force, sweep, μ_s, μ_k, u_s, and the mean period, s.
const INTEGRATED: [[f64; 9]; 2] = [
    [300.0, 6.0, 0.06, 1.2, 0.02, 0.8, 0.3, 0.01, 0.003_387_983_994],
    [150.0, 3.0, 0.1, 1.5, 0.02, 0.7, 0.25, 0.02, 0.006_820_271_813],
];

#[test]
fn a_smooth_curve_in_a_bank_agrees_with_another_integrator() {
    for [frequency_hz, decay_per_s, mass_kg, normal_force_n, sweep_m_s, mu_static, mu_kinetic, slip, exact] in
        INTEGRATED
    {
        let friction = Friction { mu_static, mu_kinetic, slip_speed_m_s: slip };
        for (rate_hz, bound) in [(44_100.0, 0.4), (96_000.0, 0.2), (192_000.0, 0.1)] {
            let mut rubbed =
                Rubbed::new(&[(mode(frequency_hz, decay_per_s), f64::powf(mass_kg, -0.5))], rate_hz);
            let sweep = [Sweep { sweep_m_s, normal_force_n, other_n_s: 0.0 }];
            let (mut begun, mut stuck) = (Vec::new(), false);
            for n in 0..2 * rate_hz as u32 {
                rubbed.run(&friction, &sweep);
                let sticks = rubbed.coupled.sticks();
                if stuck && !sticks && n > rate_hz as u32 {
                    begun.push(n);
                }
                stuck = sticks;
            }
            let mean = f64::from(begun[begun.len() - 1] - begun[0]) / (begun.len() - 1) as f64 / rate_hz;
            let error = 100.0 * (mean / exact - 1.0);
            println!("{frequency_hz} Hz at {rate_hz} Hz: {error:+.3} %");
            assert!(error.abs() <= bound, "{frequency_hz} Hz at {rate_hz} Hz: {error:+.3} %");
        }
    }
}

#[test]
fn a_million_random_steps_take_no_energy_from_the_friction() {
    let mut rng = Rng::new(815);
    for rate_hz in [44_100.0, 192_000.0] {
        let (modes, mut plain) = many(40, rate_hz);
        let mut rubbed = Rubbed::new(&modes, rate_hz);
        // Equal forces on the plain modes show how the place really moves.
        let mut twin = RubbedBody::new(&mut plain, rate_hz);
        let mut loose = RubState::default();
        twin.touch_at(&mut loose, |k| modes.get(k).map_or(0.0, |(_, phi)| *phi as f32));
        let free = Friction { mu_static: 0.0, mu_kinetic: 0.0, slip_speed_m_s: 1.0 };
        let (mut given_j, mut taken_j, mut most_j) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..500_000 / CELL {
            let mu_static = 2.0 * rng.uniform();
            let friction = Friction {
                mu_static,
                mu_kinetic: mu_static * rng.uniform(),
                slip_speed_m_s: 10.0_f64.powf(-9.0 + 9.0 * rng.uniform()),
            };
            let sweep: Vec<Sweep> = (0..CELL)
                .map(|_| Sweep {
                    sweep_m_s: 0.3 * rng.normal(),
                    normal_force_n: 50.0 * rng.uniform(),
                    other_n_s: 0.0,
                })
                .collect();
            let (forces, _) = rubbed.run(&friction, &sweep);
            for (force_n, sweep) in forces.iter().zip(&sweep) {
                let other_n_s = force_n / rate_hz;
                let moved =
                    twin.tick(&mut loose, &free, &Sweep { sweep_m_s: 0.0, normal_force_n: 0.0, other_n_s });
                let taken = force_n * (sweep.sweep_m_s - moved.body_m_s) / rate_hz;
                taken_j += taken.max(0.0);
                given_j += (-taken).max(0.0);
                assert!(force_n.is_finite());
            }
            most_j = most_j.max(twin.energy_j());
        }
        println!("{rate_hz} Hz: took {taken_j:.3} J, gave {given_j:e} J; body at most {most_j:.3e} J");
        // Rounding: the bank's single precision against the plain modes'.
        assert!(given_j <= 1e-6 * taken_j, "{given_j} of {taken_j} J");
    }
}

#[test]
fn any_cut_into_blocks_rubs_the_same_bits() {
    let rate_hz = 44_100.0;
    let (modes, _) = many(50, rate_hz);
    let friction = Friction { mu_static: 0.9, mu_kinetic: 0.4, slip_speed_m_s: 0.02 };
    let sweep =
        |n: u64| Sweep { sweep_m_s: 0.2 * (n as f64 * 3e-4).sin(), normal_force_n: 2.0, other_n_s: 0.0 };
    let render = |cuts: &mut dyn FnMut() -> usize| {
        let mut rubbed = Rubbed::new(&modes, rate_hz);
        let mut out = Vec::new();
        while rubbed.position < 20_000 {
            let left = CELL - rubbed.position as usize % CELL;
            let n = cuts().clamp(1, left);
            let now: Vec<Sweep> = (0..n as u64).map(|i| sweep(rubbed.position + i)).collect();
            out.extend(rubbed.run(&friction, &now).1);
        }
        out.truncate(20_000);
        out
    };
    let whole = render(&mut || CELL);
    assert!(whole.iter().any(|x| x.abs() > 1e-6));
    for seed in 0..5 {
        let mut rng = Rng::new(seed);
        let cut = render(&mut || 1 + (CELL as f64 * rng.uniform()) as usize);
        assert!(whole == cut, "seed {seed}");
    }
}

#[test]
fn modes_above_half_the_rate_do_not_yield() {
    let mut answer = Answer::RIGID;
    let mut add = |mode: Mode| answer.add_modes(Level::detect(), &[(mode, 1.0)], 44_100.0);
    add(mode(30_000.0, 1.0)).unwrap();
    assert_eq!(add(mode(100.0, -1.0)).unwrap_err().field, "decay_per_s");
    assert_eq!(answer, Answer::RIGID);
    assert_eq!(place_speed(&mode(30_000.0, 1.0), 1.0, 44_100.0).unwrap().amplitude, 0.0);
    assert_eq!(place_speed(&mode(-1.0, 1.0), 1.0, 44_100.0).unwrap_err().field, "frequency_hz");
    assert_eq!(FreeResponse::design(&[mode(30_000.0, 1.0)], 44_100.0).unwrap(), FreeResponse::SILENT);
    assert_eq!(FreeResponse::design(&[mode(100.0, -1.0)], 44_100.0).unwrap_err().field, "decay_per_s");
}

#[test]
fn a_banks_forecast_is_what_its_modes_sound_like() {
    let mut rng = Rng::new(17);
    for level in Level::available() {
        for (count, rate_hz) in [(3, 44_100.0), (50, 22_050.0), (200, 192_000.0)] {
            let random = |_| Mode {
                frequency_hz: 20.0 * 800.0_f64.powf(rng.uniform()),
                decay_per_s: 3.0 * 100.0_f64.powf(rng.uniform()),
                amplitude: 1.0,
                phase_rad: 0.7,
            };
            let modes: Vec<Mode> = (0..count).map(random).collect();
            let heard: Vec<Mode> = modes
                .iter()
                .map(|m| Mode { amplitude: rng.normal(), phase_rad: TAU * rng.uniform(), ..*m })
                .collect();
            let bank = |modes: &[Mode]| {
                let groups: Box<[ModeGroup]> = design_groups(modes, rate_hz, &GroupOptions::default())
                    .collect::<Result<_, _>>()
                    .unwrap();
                let states = vec![GroupState::REST; groups.len()].into_boxed_slice();
                ModalBank::new(level, groups, states).sleeping_below(0.0)
            };
            let (mut sound, mut other) = (bank(&modes), bank(&heard));
            let ahead: Vec<FreeResponse> =
                heard.chunks(LANES).map(|modes| FreeResponse::design(modes, rate_hz).unwrap()).collect();
            let struck: Vec<f32> = (0..3 * CELL).map(|_| rng.normal() as f32).collect();
            sound.render(0, Inputs::One(&struck), &mut [0.0; 3 * CELL]);
            other.render(0, Inputs::One(&struck), &mut [0.0; 3 * CELL]);
            let (mut predicted, mut found) = ([0.0; CELL], [0.0; CELL]);
            sound.ahead(&ahead, &mut predicted);
            other.render(3 * CELL as u64, Inputs::One(&[0.0; CELL]), &mut found);
            let most = found.iter().fold(0.0_f32, |most, y| most.max(y.abs()));
            let worst = predicted.iter().zip(&found).fold(0.0_f32, |worst, (a, b)| worst.max((a - b).abs()));
            println!(
                "{} {count} modes at {rate_hz} Hz: {:.1e} of the peak apart",
                level.isa().name(),
                worst / most
            );
            assert!(worst <= 1e-5 * most, "{worst} of {most}");
        }
    }
}
