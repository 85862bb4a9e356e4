//! Diffuse bands: sound between and above the modes of a body, where its resonances lie too close
//! to be told apart, and all the sound of a body that does not ring.
//!
//! The impulse response of a band is a carrier that a narrow noise modulates, under an envelope of
//! one or two exponentials:
//!
//! ```text
//! u_i[n] = e^((−d_i + 2πi f) / fs) u_i[n−1] + a_i j[n]        i = 1, 2
//! y[n]   = Σ_bands Im( w[n] · Σ_i u_i[n] )                     a_i = √(4 d_i E_i)
//! ```
//!
//! | symbol | field |
//! |---|---|
//! | f | [`DiffuseBand::centre_hz`] |
//! | E_i | [`DiffusePart::energy`]: ∫ y² dt of the part alone after an impulse of 1 N·s |
//! | d_i | [`DiffusePart::decay_per_s`] |
//! | w | complex noise of mean square 1, [`DiffuseBand::width_hz`] wide |
//! | j | impulses, N·s a sample |
//!
//! u takes the input as a mode does, so a soft striker's long pulse leaves high bands out, and a
//! stroke sounds where its force has power. w is uniform noise at a quarter of the sample rate
//! through two equal one-pole low-passes, interpolated linearly. It begins anew at |w| = 1, with a
//! sign for each band, in the sample that wakes a bank at rest: y starts at 0 at its exact level,
//! and equal strikes on a silent body have equal bits.
//!
//! Twelve seeded modes a band, the other way that was tried, have the same level error (2.3 dB
//! beside 2.2 on a recorded board, 2.7 beside 2.8 on a barrel) with 450 modes to ring; a recorded
//! burst cannot be scaled and does not hear strokes.
//!
//! A strike that also plays a recorded burst gives up its bands at first: a third resonator, which
//! only strikes reach, takes (a₁ + a₂) e^(−r t) away, r = max d + 1/τ, so that the bands rise
//! within τ while the burst fades.
//!
//! No operation rounds once where another instruction set rounds twice: all levels give the same
//! bits. All that changes with time counts from the sample of waking: so does any split into
//! blocks. At rest a bank costs a look at its input.

mod design;

pub use design::{BAND_ERB, DiffuseBand, DiffuseGroup, DiffusePart, RISE_A_BURST, band_edges_hz};

use crate::rng::hash_u32;
use crate::simd::{Level, Set, at_level};
use fearless_simd::prelude::*;
use fearless_simd::{f32x16, i32x16, u32x16};

/// Bands side by side.
pub const BANDS: usize = 16;
/// Samples between two values of the noise.
const NOISE_STEP: usize = 4;
/// Samples of a turn, after which bands that have rung out are put to rest.
const TURN: usize = 64;
/// Level of a band that counts as rung out, in the output's unit: that of the bank of modes.
const SLEEP: f32 = crate::modal_bank::SLEEP_AMPLITUDE;
/// Levels beyond this are no vibration.
const ABSURD: f32 = 1e15;

type Lanes = [f32; BANDS];

/// State of some bands.
#[derive(Debug, Clone, PartialEq)]
pub struct DiffuseState {
    u: [[Lanes; 2]; 3],
    /// After the first low-pass, after the second, and the step of the latter a sample.
    v: [Lanes; 2],
    w: [Lanes; 2],
    dw: [Lanes; 2],
    random: [u32; BANDS],
}

impl DiffuseState {
    /// At rest.
    pub const REST: Self = Self {
        u: [[[0.0; BANDS]; 2]; 3],
        v: [[0.0; BANDS]; 2],
        w: [[0.0; BANDS]; 2],
        dw: [[0.0; BANDS]; 2],
        random: [0; BANDS],
    };
}

/// Bands of one body: coefficients and states, in memory of the caller's.
#[derive(Debug, Clone)]
pub struct DiffuseBank<G, S> {
    level: Level,
    groups: G,
    states: S,
    /// Samples since it woke; none at rest.
    age: Option<u64>,
    /// Something rises: the third resonators move.
    rises: bool,
    /// Number of the noise that it wakes with.
    take: u32,
}

/// Impulses of a stretch, N·s a sample, each as long as the stretch.
#[derive(Debug, Clone, Copy)]
pub struct DiffuseInput<'a> {
    /// All of them.
    pub all: &'a [f32],
    /// Part of them after which the bands rise; empty for none.
    pub rising: &'a [f32],
}

impl<G: AsRef<[DiffuseGroup]>, S: AsMut<[DiffuseState]>> DiffuseBank<G, S> {
    /// A bank at rest; there must be as many states as groups.
    pub const fn new(level: Level, groups: G, states: S) -> Self {
        Self { level, groups, states, age: None, rises: false, take: 0 }
    }

    /// Tests whether nothing sounds.
    #[must_use]
    pub const fn is_at_rest(&self) -> bool {
        self.age.is_none()
    }

    /// Puts everything to rest.
    pub fn silence(&mut self) {
        self.states.as_mut().fill(DiffuseState::REST);
        (self.age, self.rises) = (None, false);
    }

    /// Chooses the noise with which it wakes from now on: each number stands for another one, 0 for
    /// that of the groups' own seeds.
    pub const fn wake_with(&mut self, take: u32) {
        self.take = take;
    }

    /// Adds the answer to `input` to `out`.
    pub fn render(&mut self, input: DiffuseInput<'_>, out: &mut [f32]) {
        let mut at = 0;
        let len = out.len().min(input.all.len());
        while at < len {
            let Some(age) = self.age else {
                let Some(next) = input.all[at..len].iter().position(|x| *x != 0.0) else { return };
                self.wake();
                at += next;
                continue;
            };
            let in_turn = (age % TURN as u64) as usize;
            let end = (at + TURN - in_turn).min(len);
            let rising = input.rising.get(at..end).unwrap_or_default();
            self.rises |= rising.iter().any(|x| *x != 0.0);
            let rising = if self.rises { rising } else { &[] };
            let (groups, states) = (self.groups.as_ref(), self.states.as_mut());
            let (all, out) = (&input.all[at..end], &mut out[at..end]);
            let turn = Turn { phase: in_turn % NOISE_STEP, all, rising };
            at_level!(self.level, s => run(s, groups, states, turn, self.rises, out));
            self.age = Some(age + (end - at) as u64);
            if in_turn + (end - at) == TURN {
                self.settle();
            }
            at = end;
        }
    }

    fn wake(&mut self) {
        for (group, state) in self.groups.as_ref().iter().zip(self.states.as_mut()) {
            let take = self.take;
            let seeds = group.seeds.map(|seed| if take == 0 { seed } else { hash_u32(seed ^ take) });
            *state = DiffuseState { random: seeds, ..DiffuseState::REST };
            for (lane, seed) in seeds.iter().enumerate() {
                let sign = if seed & 1 == 0 { 1.0 } else { -1.0 };
                (state.v[0][lane], state.w[0][lane]) = (sign, sign);
            }
        }
        self.age = Some(0);
    }

    /// Puts resonators that have rung out to rest, and the bank when all have.
    fn settle(&mut self) {
        let mut rings = [false; 3];
        for state in self.states.as_mut() {
            for (rings, [re, im]) in rings.iter_mut().zip(&mut state.u) {
                for (re, im) in re.iter_mut().zip(im) {
                    let square = *re * *re + *im * *im;
                    // False for NaN as well.
                    let keep = (SLEEP * SLEEP..ABSURD * ABSURD).contains(&square);
                    if !keep {
                        (*re, *im) = (0.0, 0.0);
                    }
                    *rings |= keep;
                }
            }
        }
        self.rises &= rings[2];
        if !rings.contains(&true) {
            self.age = None;
        }
    }
}

impl<G, S: AsRef<[DiffuseState]>> DiffuseBank<G, S> {
    /// Sum of the bands' squared amplitudes.
    #[must_use]
    pub fn energy(&self) -> f32 {
        let resonators = self.states.as_ref().iter().flat_map(|state| &state.u[..2]);
        resonators.map(|u| u.as_flattened().iter().map(|x| x * x).sum::<f32>()).sum()
    }
}

/// Input of a part of a turn; its first sample is `phase` after a new value of the noise.
#[derive(Clone, Copy)]
struct Turn<'a> {
    phase: usize,
    all: &'a [f32],
    rising: &'a [f32],
}

#[inline(always)]
fn run<S: Set>(
    s: S,
    groups: &[DiffuseGroup],
    states: &mut [DiffuseState],
    turn: Turn<'_>,
    rises: bool,
    out: &mut [f32],
) {
    let mut sums = [[0.0; BANDS]; TURN];
    for (group, state) in groups.iter().zip(states) {
        if rises {
            group_of_bands::<S, 3>(s, group, state, turn, &mut sums);
        } else {
            group_of_bands::<S, 2>(s, group, state, turn, &mut sums);
        }
    }
    for (y, sum) in out.iter_mut().zip(&sums) {
        let (low, high) = f32x16::load_array_ref(s, sum).split();
        let (low, high) = (low + high).split();
        let [a, b, c, d]: [f32; 4] = (low + high).into();
        *y += (a + c) + (b + d);
    }
}

/// Adds `N` resonators of each band to the sums.
#[inline(always)]
fn group_of_bands<S: Set, const N: usize>(
    s: S,
    group: &DiffuseGroup,
    state: &mut DiffuseState,
    turn: Turn<'_>,
    sums: &mut [Lanes; TURN],
) {
    let load = |lanes: &Lanes| f32x16::load_array_ref(s, lanes);
    let pair = |[a, b]: &[Lanes; 2]| [load(a), load(b)];
    let poles: [[f32x16<S>; 2]; N] = core::array::from_fn(|i| pair(&group.poles[i]));
    let gains: [f32x16<S>; N] = core::array::from_fn(|i| load(&group.gains[i]));
    let [pole, source, second] = [0, 1, 2].map(|i| load(&group.noise[i]));
    let mut u: [[f32x16<S>; 2]; N] = core::array::from_fn(|i| pair(&state.u[i]));
    let (mut v, mut w, mut dw) = (pair(&state.v), pair(&state.w), pair(&state.dw));
    let mut random = u32x16::load_array_ref(s, &state.random);
    for (n, (j, sum)) in turn.all.iter().zip(sums).enumerate() {
        if (turn.phase + n).is_multiple_of(NOISE_STEP) {
            for part in 0..2 {
                random = random * 747_796_405 + 2_891_336_453;
                let uniform: f32x16<S> = random.bitcast::<i32x16<S>>().to_float();
                // The line has arrived at the second low-pass's last value.
                v[part] = pole * v[part] + source * (uniform * (1.0 / 2_147_483_648.0));
                let next = pole * w[part] + second * v[part];
                dw[part] = (next - w[part]) * (1.0 / NOISE_STEP as f32);
            }
        }
        for (i, u) in u.iter_mut().enumerate() {
            let input = if i < 2 { *j } else { turn.rising.get(n).copied().unwrap_or(0.0) };
            let re = (poles[i][0] * u[0] - poles[i][1] * u[1]) + gains[i] * input;
            u[1] = poles[i][1] * u[0] + poles[i][0] * u[1];
            u[0] = re;
        }
        let mut all = [u[0][0] + u[1][0], u[0][1] + u[1][1]];
        if N == 3 {
            all = [all[0] + u[2][0], all[1] + u[2][1]];
        }
        let y = w[0] * all[1] + w[1] * all[0];
        (y + load(sum)).store_array(sum);
        w = [w[0] + dw[0], w[1] + dw[1]];
    }
    let store = |from: [f32x16<S>; 2], to: &mut [Lanes; 2]| {
        from[0].store_array(&mut to[0]);
        from[1].store_array(&mut to[1]);
    };
    for (i, u) in u.into_iter().enumerate() {
        store(u, &mut state.u[i]);
    }
    store(v, &mut state.v);
    store(w, &mut state.w);
    store(dw, &mut state.dw);
    random.store_array(&mut state.random);
}

#[cfg(test)]
mod tests;
