//! Rub of a whole modal bank: the closed-form step of every sample, with the modes run a cell of 64
//! samples at a time.
//!
//! ```text
//! v*[n] = ṽ[n] + Σ_i f_i U[n − i] + Σ_m g[n − m] F[m]       m: the samples of the cell before n
//! U[j] = Σ φ_k² Im(q_k zʲ) / ω      q = (z − 1) / Σ_t c_t z^−t      z = R e^(iθ)
//! g[j] = Σ_t c_t U[j − t]  = Σ φ_k² Im(zʲ (z − 1)) / ω               F[n] from v*[n] and g[0], as in the [module](super)
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | ṽ | what a [`place_speed`] output of the bank says ahead of the cell ([`ModalBank::ahead`](crate::modal_bank::ModalBank::ahead)): the free motion |
//! | c_t | the five taps through which a bank takes a force ([`FORCE_TAPS`]) |
//! | f_i | what the bank still has to hear in the cell's sample i of the forces before it |
//! | U, g | [`Answer`], m/s a newton |
//! | F | [`Coupled::run`] |
//!
//! The modes are linear, so what a force does within its own cell is a sum over its few samples,
//! and what it does later is in the states once the bank has heard it. So the bank is rendered
//! once, with the forces, for the sound; before that it gives the free motion of the cell, and a
//! force, once it is known, is added to the speeds of all later samples of the cell at once: what a
//! sample has to wait for is the one product with the force before it. The sum is the plain step's
//! to rounding ([`RubbedBody`](super::RubbedBody)): nothing is a sample late and nothing is
//! iterated.

mod answer;

use super::{Friction, Law, RubState, Slips, Solved, Sweep, fused};
use crate::hertz::{FORCE_HISTORY, FORCE_TAPS};
use crate::simd::{Level, Set, at_level};
pub use answer::{Answer, place_speed};
use core::array::from_fn;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

/// Samples of a cell; cells begin at absolute multiples of it.
pub const CELL: usize = crate::modal_bank::GRID_SAMPLES as usize;
/// Samples whose forces are added to what is further away all at once.
const BLOCK: usize = 8;
/// Samples beyond those that are kept at hand.
const WINDOW: usize = 2 * BLOCK;
/// Samples whose answers are not added to what is known: this one and the two after it.
const NEAR: usize = 3;

/// Room before a cell's first sample, and for a cell with the window behind its last.
const LEAD: usize = BLOCK - NEAR;
/// Answers beyond the window, and with a block of zeros before them.
const BEYOND: usize = CELL - NEAR - WINDOW;
const FAR: usize = (BLOCK + BEYOND).next_multiple_of(BLOCK);
const KNOWN: usize = (LEAD + CELL + NEAR + WINDOW).next_multiple_of(BLOCK);

/// A rubbing contact of a bank: whether it sticks, its forces so far, and what they will move.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Coupled {
    /// Motion of the place in the present cell with all that is known, but for the two samples just
    /// before: they come with the sample itself, m/s. From [`LEAD`] on, so that blocks that begin
    /// [`NEAR`] samples later lie in one cache line each.
    known_m_s: [f64; KNOWN],
    level: Level,
    state: RubState,
    /// The last forces of the cell before, then those of the present one, N.
    force_n: [f64; FORCE_HISTORY + CELL],
    /// g at lags of 0, 1 and 2.
    near_m_s_n: [f64; NEAR],
    moved: Moved,
    /// g at the lags of the window, and beyond it after as many zeros as a block has samples.
    window_m_s_n: [f64; WINDOW],
    far_m_s_n: [f64; FAR],
}

/// Motion by the samples just before.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moved {
    /// By the sample before: these, and `slips_m_s` + `share` (t − root) along the way, where it
    /// slipped; t is known before the root.
    all_m_s: f64,
    slips_m_s: f64,
    share: f64,
    t: f64,
    root: f64,
    /// 1 or −1; 0 where it did not slip.
    way: f64,
    /// By the one before that, and by the sample before in the sample after.
    before_m_s: f64,
    after_m_s: f64,
}

impl Moved {
    const NOTHING: Self = Self {
        all_m_s: 0.0,
        slips_m_s: 0.0,
        share: 0.0,
        t: 0.0,
        root: 0.0,
        way: 0.0,
        before_m_s: 0.0,
        after_m_s: 0.0,
    };
}

impl Coupled {
    /// Nothing has rubbed yet.
    #[must_use]
    pub fn begin(level: Level) -> Self {
        Self {
            level,
            state: RubState::default(),
            force_n: [0.0; FORCE_HISTORY + CELL],
            known_m_s: [0.0; KNOWN],
            near_m_s_n: [0.0; NEAR],
            moved: Moved::NOTHING,
            window_m_s_n: [0.0; WINDOW],
            far_m_s_n: [0.0; FAR],
        }
    }

    /// Tests whether it sticks at present.
    #[must_use]
    pub fn sticks(&self) -> bool {
        self.state.sticks
    }

    /// Another cell begins: how its place answers, and `free_m_s`, what the bank says of it ahead.
    pub fn next_cell(&mut self, answer: &Answer, free_m_s: &[f32; CELL]) {
        at_level!(self.level, token => self.next_cell_in(token, answer, free_m_s));
    }

    #[inline(always)]
    fn next_cell_in<T: Set>(&mut self, token: T, answer: &Answer, free_m_s: &[f32; CELL]) {
        let own = &answer.own;
        self.state.mobility_m_s_n = own[0];
        self.moved = Moved::NOTHING;
        self.near_m_s_n = [own[0], own[1], own[2]];
        self.window_m_s_n.copy_from_slice(&own[NEAR..NEAR + WINDOW]);
        self.far_m_s_n[BLOCK..][..BEYOND].copy_from_slice(&own[NEAR + WINDOW..]);
        self.force_n.copy_within(CELL.., 0);
        self.force_n[FORCE_HISTORY..].fill(0.0);
        let unheard_n: [f64; FORCE_HISTORY] = from_fn(|at| {
            let heard_n = |tap: usize| FORCE_TAPS[tap] * self.force_n[FORCE_HISTORY + at - tap];
            (at + 1..=FORCE_HISTORY).map(heard_n).sum()
        });
        let known = self.known_m_s[LEAD..][..CELL].as_chunks_mut::<BLOCK>().0;
        for ((block, known), free_m_s) in known.iter_mut().enumerate().zip(free_m_s.as_chunks::<BLOCK>().0) {
            let mut sum = f64x8::from_slice(token, &free_m_s.map(f64::from));
            for (at, unheard_n) in unheard_n.iter().enumerate() {
                let answers = &answer.tapped[FORCE_HISTORY - at + BLOCK * block..][..BLOCK];
                sum = fused_each(token, *unheard_n, f64x8::from_slice(token, answers), sum);
            }
            sum.store_slice(known);
        }
        self.known_m_s[LEAD + CELL..].fill(0.0);
    }

    /// The forces of the coming samples, N, from sample `first` of the cell on: `sweep` is what
    /// rubs, `struck_m_s` how the place moves because of what has struck the bank since the cell
    /// began. Lengths: as far as the shortest reaches, within the cell.
    pub fn run(&mut self, friction: &Friction, first: usize, sweep: &[Sweep], struck_m_s: &[f32]) -> &[f64] {
        let n = sweep.len().min(struck_m_s.len()).min(CELL.saturating_sub(first));
        let law = Law::new(friction, self.state.mobility_m_s_n);
        at_level!(self.level, token => self.run_in(token, &law, first, &sweep[..n], &struck_m_s[..n]));
        &self.force_n[FORCE_HISTORY + first..FORCE_HISTORY + first + n]
    }

    #[inline(always)]
    fn run_in<T: Set>(&mut self, token: T, law: &Law, first: usize, sweep: &[Sweep], struck_m_s: &[f32]) {
        let eight = |x: &[f64]| f64x8::from_slice(token, &x[..BLOCK]);
        let (mut state, mut moved) = (self.state, self.moved);
        let answers = [eight(&self.window_m_s_n), eight(&self.window_m_s_n[BLOCK..])];
        // The known part of the coming samples stays in registers: a load would come late.
        let known = &self.known_m_s[LEAD + first..];
        let mut near_m_s: [f64; NEAR] = from_fn(|i| known[i]);
        let mut window = [eight(&known[NEAR..]), eight(&known[NEAR + BLOCK..])];
        let (mut at, mut sweep, mut struck_m_s) = (first, sweep, struck_m_s);
        while !sweep.is_empty() {
            let n = (BLOCK - at % BLOCK).min(sweep.len());
            let (now, struck_now);
            ((now, sweep), (struck_now, struck_m_s)) = (sweep.split_at(n), struck_m_s.split_at(n));
            let coming_m_s = &self.known_m_s[LEAD + NEAR + WINDOW + at..];
            let forces_n = &mut self.force_n[FORCE_HISTORY + at..];
            for (((sweep, struck_m_s), coming_m_s), to_n) in
                now.iter().zip(struck_now).zip(coming_m_s).zip(forces_n)
            {
                let behind_m_s = sweep.sweep_m_s - (near_m_s[0] + f64::from(*struck_m_s));
                let quick_n;
                ([*to_n, quick_n], moved) =
                    sample(token, law, self.near_m_s_n, &mut state, &moved, sweep.normal_force_n, behind_m_s);
                let moves = |known, answers| fused_each(token, quick_n, answers, known);
                let [nearer, further] = [moves(window[0], answers[0]), moves(window[1], answers[1])];
                near_m_s = [near_m_s[1], near_m_s[2], nearer[0]];
                let coming = f64x8::splat(token, *coming_m_s);
                window = [nearer.slide::<1>(further), further.slide::<1>(coming)];
            }
            at += n;
            if at % BLOCK == 0 {
                window[1] = self.moves_far(token, at, window[1]);
            }
        }
        (self.state, self.moved) = (state, moved);
        let known = &mut self.known_m_s[LEAD + at..];
        known[..NEAR].copy_from_slice(&near_m_s);
        window[0].store_slice(&mut known[NEAR..][..BLOCK]);
        window[1].store_slice(&mut known[NEAR + BLOCK..][..BLOCK]);
    }

    /// Adds what the forces of the block before sample `at` move beyond the window: in its further
    /// half, and in what will come into it.
    #[inline(always)]
    fn moves_far<T: Set>(&mut self, token: T, at: usize, further: f64x8<T>) -> f64x8<T> {
        let forces_n = &self.force_n[FORCE_HISTORY + at - BLOCK..][..BLOCK];
        let far = &self.far_m_s_n;
        let add = |apart: usize, mut sum: f64x8<T>| {
            for (i, force_n) in forces_n.iter().enumerate() {
                let answers = f64x8::from_slice(token, &far[BLOCK * (apart + 1) - i..][..BLOCK]);
                sum = fused_each(token, *force_n, answers, sum);
            }
            sum
        };
        let known = self.known_m_s[LEAD + NEAR + WINDOW + at..].as_chunks_mut::<BLOCK>().0;
        for (apart, known) in (1..).zip(known).take(BEYOND.saturating_sub(at).div_ceil(BLOCK)) {
            add(apart, f64x8::from_slice(token, known)).store_slice(known);
        }
        add(0, further)
    }

    /// Impulses of the forces so far on the bank, from sample `first` of the cell on, N·s.
    pub fn impulses(&self, first: usize, sample_rate_hz: f64, impulse_n_s: &mut [f64]) {
        at_level!(self.level, _token => self.impulses_in(first, 1.0 / sample_rate_hz, impulse_n_s));
    }

    #[inline(always)]
    fn impulses_in(&self, first: usize, step_s: f64, impulse_n_s: &mut [f64]) {
        let forces_n = self.force_n.get(first..).unwrap_or_default();
        for (to, forces_n) in impulse_n_s.iter_mut().zip(forces_n.windows(FORCE_HISTORY + 1)) {
            *to =
                (0..=FORCE_HISTORY).map(|tap| FORCE_TAPS[tap] * step_s * forces_n[FORCE_HISTORY - tap]).sum();
        }
    }
}

/// One sample, in which the place would lag `behind_m_s` behind what rubs if the two samples before
/// had not been.
///
/// A slipping contact waits for the root of the sample before and for nothing else: a product, a
/// square, and the next root.
#[inline(always)]
fn sample<T: Set>(
    token: T,
    law: &Law,
    [_, next_m_s_n, after_m_s_n]: [f64; NEAR],
    state: &mut RubState,
    last: &Moved,
    normal_force_n: f64,
    behind_m_s: f64,
) -> ([f64; 2], Moved) {
    let pressed = law.pressed(normal_force_n);
    let early = last.way * behind_m_s + (pressed.lean_m_s - last.slips_m_s);
    let early = fused(token, -last.share, last.t, fused(token, -last.way, last.before_m_s, early));
    let t = fused(token, last.share, last.root, early);
    let solved = match law.slips(token, &pressed, t) {
        // As it did.
        Some([root, twice_m_s]) => {
            state.last_n = last.way * pressed.slides_n(twice_m_s);
            Solved { force_n: state.last_n, slips: Some(Slips { way: last.way, t, root }) }
        }
        None => {
            let moved_m_s = last.all_m_s + last.way * (last.slips_m_s + last.share * (last.t - last.root));
            state.solve(token, law, &pressed, behind_m_s - last.before_m_s - moved_m_s)
        }
    };
    match solved.slips {
        Some(Slips { way, t, root }) => {
            // (t − root) / 2g is what friction has beyond N μ_k: as good where all that counts is
            // what it moves, and known before a quotient is.
            let half = 0.5 * law.stiffness_n_s_m;
            let quick_n = way * fused(token, half, t - root, pressed.kinetic_n);
            let moved = Moved {
                all_m_s: 0.0,
                slips_m_s: next_m_s_n * pressed.kinetic_n,
                share: half * next_m_s_n,
                t,
                root,
                way,
                before_m_s: last.after_m_s,
                after_m_s: after_m_s_n * quick_n,
            };
            ([solved.force_n, quick_n], moved)
        }
        None => {
            let force_n = solved.force_n;
            let (all_m_s, after_m_s) = (force_n * next_m_s_n, force_n * after_m_s_n);
            ([force_n; 2], Moved { all_m_s, before_m_s: last.after_m_s, after_m_s, ..Moved::NOTHING })
        }
    }
}

/// factor · answers + plus.
#[inline(always)]
fn fused_each<T: Set>(token: T, factor: f64, answers: f64x8<T>, plus: f64x8<T>) -> f64x8<T> {
    let factor = f64x8::splat(token, factor);
    if T::FUSED { factor.mul_add(answers, plus) } else { factor * answers + plus }
}
