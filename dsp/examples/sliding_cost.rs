//! What contacts on a body cost its modal bank: a shared input, a place with gains, a slide (two inputs: fading out, fading in), a rub that sticks and
//! slips with it, and a rub that slides.
//!
//! Without arguments processor times, the best of many runs, as ratios. With `KIND MODES` a second of that kind alone, for an instruction
//! counter: `valgrind --tool=callgrind target/release/examples/sliding_cost rub 100`; the kind `nothing` is what has to be taken off.

use asperity_dsp::modal_bank::{
    AheadGroup, GroupOptions, GroupState, Input, Inputs, LANES, LaneGains, ModalBank, ModeGroup,
    design_groups,
};
use asperity_dsp::mode::Mode;
use asperity_dsp::simd::Level;
use asperity_dsp::stick_slip::{Answer, CELL, Coupled, Friction, Sweep, place_speed};
use std::hint::black_box;
use std::time::Instant;

const RATE_HZ: f64 = 44_100.0;
const KINDS: [&str; 7] = ["nothing", "shared", "place", "slide", "rub", "rub-slide", "ahead"];
/// Motion of every mode at the place, kg^−½.
const PHI: f64 = 0.3;

type Bank = ModalBank<Box<[ModeGroup]>, Box<[GroupState]>>;

struct Body {
    sound: Bank,
    ahead: Vec<AheadGroup>,
    answer: Answer,
    coupled: Coupled,
    gains: Vec<LaneGains>,
    input: [f32; CELL],
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
            ahead: speeds.chunks(LANES).map(|speeds| AheadGroup::design(speeds, RATE_HZ).unwrap()).collect(),
            answer,
            coupled: Coupled::begin(Level::detect()),
            gains: vec![LaneGains([PHI as f32; 16]); count.div_ceil(16)],
            input: std::array::from_fn(|n| 1e-6 * (n as f32).sin()),
            position: 0,
        }
    }

    /// A cell of 64 samples.
    fn cell(&mut self, kind: &str) -> [f32; CELL] {
        let mut out = [0.0; CELL];
        let rubs = kind.starts_with("rub");
        if rubs {
            self.rub();
        }
        let placed = [Input { impulses: &self.input, gains: &self.gains }; 2];
        match kind {
            "nothing" => {}
            "ahead" => self.sound.ahead(&self.ahead, &mut out),
            "shared" => self.sound.render(self.position, Inputs::One(&self.input), &mut out),
            "place" | "rub" => self.sound.render(self.position, Inputs::Placed(&placed[..1]), &mut out),
            _ => self.sound.render(self.position, Inputs::Placed(&placed), &mut out),
        }
        self.position += CELL as u64;
        out
    }

    /// The forces of a cell.
    fn rub(&mut self) {
        let friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.02 };
        let sweep = [Sweep { sweep_m_s: 0.05, normal_force_n: 1.0, other_n_s: 0.0 }; CELL];
        let (mut free, mut heard) = ([0.0; CELL], [0.0; CELL]);
        self.sound.ahead(&self.ahead, &mut free);
        self.coupled.next_cell(&self.answer, &free);
        self.coupled.run(&friction, 0, &sweep, &[0.0; CELL]);
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
            // What tells the free motion has to ring.
            body.cell("place");
            best_ns(&mut body, kind)
        });
        let [_, shared, place, slide, rub, rub_slide, ahead] = times;
        println!(
            "{count} modes: shared {shared:.1} ns a sample; a place {:.2} of it; a slide {:.2} of a place; a rub {:.2} of a place, {:.2} of a slide if it slides; of a rub {:.1} ns are the free motion and {:.1} ns the forces",
            place / shared,
            slide / place,
            rub / place,
            rub_slide / slide,
            ahead,
            rub - place - ahead
        );
    }
}
