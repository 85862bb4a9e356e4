//! Cost of contacts on a body to its modal bank: a shared input, a place with gains, a slide (two
//! inputs: fading out, fading in), friction that rubs one way (the same law, deaf to how the body
//! moves), a rub that is coupled with the body in every sample, and one that slides as well.
//!
//! Without arguments processor times, the best of many runs, as ratios. With `KIND MODES` a second
//! of that kind alone, for an instruction counter: `valgrind --tool=callgrind
//! target/release/examples/sliding_cost rub 100`; the kind `nothing` is what has to be taken off.

use asperity_dsp::hertz::{FORCE_HISTORY, FORCE_TAPS};
use asperity_dsp::modal_bank::{
    FreeResponse, GroupOptions, GroupState, Input, Inputs, LANES, LaneGains, ModalBank, ModeGroup,
    design_groups,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::simd::Level;
use asperity_dsp::stick_slip::{Answer, CELL, Coupled, Friction, Sweep, place_speed};
use std::hint::black_box;
use std::time::Instant;

const RATE_HZ: f64 = 44_100.0;
const KINDS: [&str; 8] = ["nothing", "shared", "place", "slide", "one-way", "rub", "rub-slide", "ahead"];
const FRICTION: Friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.02 };
const SWEEP: Sweep = Sweep { sweep_m_s: 0.05, normal_force_n: 1.0, other_n_s: 0.0 };
/// Motion of every mode at the place, kg^−½.
const PHI: f64 = 0.3;

type Bank = ModalBank<Box<[ModeGroup]>, Box<[GroupState]>>;

struct Body {
    sound: Bank,
    ahead: Vec<FreeResponse>,
    answer: Answer,
    coupled: Coupled,
    gains: Vec<LaneGains>,
    input: [f32; CELL],
    force_n: [f64; FORCE_HISTORY + CELL],
    position: u64,
}

fn bank(modes: &[Mode], options: &GroupOptions) -> Bank {
    let groups: Box<[ModeGroup]> = design_groups(modes, RATE_HZ, options).collect::<Result<_, _>>().unwrap();
    let states = vec![GroupState::REST; groups.len()].into();
    ModalBank::new(Level::detect(), groups, states)
}

impl Body {
    fn new(count: usize) -> Self {
        let mode = |i: usize| Mode {
            frequency_hz: 80.0 + 19_000.0 * i as f64 / count as f64,
            decay_per_s: 5.0,
            amplitude: 1.0,
            phase_rad: 1.0,
        };
        let modes: Vec<Mode> = (0..count).map(mode).collect();
        let speeds: Vec<Mode> = modes.iter().map(|m| place_speed(m, PHI, RATE_HZ).unwrap()).collect();
        let mut answer = Answer::RIGID;
        let squares: Vec<(Mode, f64)> = modes.iter().map(|mode| (*mode, PHI * PHI)).collect();
        answer.add_modes(Level::detect(), &squares, RATE_HZ).unwrap();
        Self {
            sound: bank(&modes, &GroupOptions::IMPULSE_RING),
            ahead: speeds
                .chunks(LANES)
                .map(|speeds| FreeResponse::design(speeds, RATE_HZ).unwrap())
                .collect(),
            answer,
            coupled: Coupled::begin(Level::detect()),
            gains: vec![LaneGains([PHI as f32; 16]); count.div_ceil(16)],
            input: std::array::from_fn(|n| 1e-6 * (n as f32).sin()),
            force_n: [0.0; FORCE_HISTORY + CELL],
            position: 0,
        }
    }

    /// A cell of 64 samples.
    fn cell(&mut self, kind: &str) -> [f32; CELL] {
        let mut out = [0.0; CELL];
        let rubs = kind.starts_with("rub");
        if rubs {
            self.rub();
        } else if kind == "one-way" {
            self.one_way();
        }
        let placed = [Input { impulses: &self.input, gains: &self.gains }; 2];
        match kind {
            "nothing" => {}
            "ahead" => self.sound.ahead(&self.ahead, &mut out),
            "shared" => self.sound.render(self.position, Inputs::One(&self.input), &mut out),
            "place" | "one-way" | "rub" => {
                self.sound.render(self.position, Inputs::Placed(&placed[..1]), &mut out)
            }
            _ => self.sound.render(self.position, Inputs::Placed(&placed), &mut out),
        }
        self.position += CELL as u64;
        out
    }

    /// The forces of a cell of the same friction on a body that is taken to stand still.
    fn one_way(&mut self) {
        let sweep = black_box([SWEEP; CELL]);
        self.force_n.copy_within(CELL.., 0);
        let Friction { mu_static, mu_kinetic, slip_speed_m_s } = FRICTION;
        for (to, sweep) in self.force_n[FORCE_HISTORY..].iter_mut().zip(&sweep) {
            let weaker = (mu_static - mu_kinetic) / (1.0 + sweep.sweep_m_s.abs() / slip_speed_m_s);
            let size_n = sweep.normal_force_n.max(0.0) * (mu_kinetic + weaker);
            *to = size_n.copysign(sweep.sweep_m_s);
        }
        for (to, forces_n) in self.input.iter_mut().zip(self.force_n.windows(FORCE_HISTORY + 1)) {
            let heard: f64 = (0..=FORCE_HISTORY)
                .map(|tap| FORCE_TAPS[tap] / RATE_HZ * forces_n[FORCE_HISTORY - tap])
                .sum();
            *to = heard as f32;
        }
    }

    /// The forces of a cell.
    fn rub(&mut self) {
        let sweep = black_box([SWEEP; CELL]);
        let (mut free, mut heard) = ([0.0; CELL], [0.0; CELL]);
        self.sound.ahead(&self.ahead, &mut free);
        self.coupled.next_cell(&self.answer, &free);
        self.coupled.run(&FRICTION, 0, &sweep, &[0.0; CELL]);
        self.coupled.impulses(0, RATE_HZ, &mut heard);
        self.input.iter_mut().zip(heard).for_each(|(to, x)| *to = x as f32);
    }
}

fn best_ns(body: &mut Body, kind: &str) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..400 {
        let begun = Instant::now();
        for _ in 0..16 {
            black_box(body.cell(kind));
        }
        best = best.min(begun.elapsed().as_nanos() as f64 / (16 * CELL) as f64);
    }
    best
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    if let (Some(kind), Some(count)) = (arguments.next(), arguments.next().and_then(|n| n.parse().ok())) {
        assert!(KINDS.contains(&kind.as_str()), "{kind} is none of {KINDS:?}");
        let mut body = Body::new(count);
        let seconds = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(1);
        for _ in 0..(seconds * RATE_HZ as usize / CELL) {
            black_box(body.cell(&kind));
        }
        return;
    }
    for count in [16, 32, 100, 128, 512] {
        let times = KINDS.map(|kind| {
            let mut body = Body::new(count);
            // The free motion is known only of a body that rings.
            body.cell("place");
            best_ns(&mut body, kind)
        });
        let [_, shared, place, slide, one_way, rub, rub_slide, ahead] = times;
        println!(
            "{count} modes: shared {shared:.1} ns a sample; a place {:.2} of it; a slide {:.2} of a place; a rub {:.2} of friction one way, {:.2} of a place, {:.2} of a slide if it slides; of a rub {:.1} ns are the free motion and {:.1} ns the forces",
            place / shared,
            slide / place,
            rub / one_way,
            rub / place,
            rub_slide / slide,
            ahead,
            rub - place - ahead
        );
    }
}
