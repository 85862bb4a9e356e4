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
//! u hears the input as a mode does, so a soft striker's long pulse leaves high bands out, and a
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

use crate::DesignError;
use crate::rng::{Rng, hash_u32};
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
/// Widest band, in rates of the noise.
const WIDEST: f64 = 0.5;
/// Levels beyond this are no vibration.
const ABSURD: f32 = 1e15;

/// One exponential of a band.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DiffusePart {
    /// Energy of its answer to an impulse of 1 N·s: ∫ y² dt, the output's unit squared times s.
    pub energy: f64,
    /// Decay of its amplitude, 1/s.
    pub decay_per_s: f64,
}

/// A band of noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DiffuseBand {
    /// Centre, Hz.
    pub centre_hz: f64,
    /// Equivalent rectangular width, Hz.
    pub width_hz: f64,
    /// Exponentials of its envelope, whose amplitudes add; a part without energy is not there.
    pub parts: [DiffusePart; 2],
}

/// Width of the bands that fits and stock bodies have, in equivalent rectangular bandwidths of
/// hearing (Glasberg and Moore 1990): 32 of them, two groups, reach from 60 Hz to 18 kHz.
pub const BAND_ERB: f64 = 1.25;

/// Edges of bands of [`BAND_ERB`] from one frequency to another.
pub fn band_edges_hz(low_hz: f64, high_hz: f64) -> impl Iterator<Item = f64> {
    let number = |hz: f64| 21.4 * libm::log10(1.0 + 4.37e-3 * hz);
    let low = number(low_hz);
    let count = ((number(high_hz) - low) / BAND_ERB).max(0.0) as u32;
    (0..=count).map(move |i| (libm::pow(10.0, (low + BAND_ERB * f64::from(i)) / 21.4) - 1.0) / 4.37e-3)
}

type Lanes = [f32; BANDS];

/// Coefficients of some bands.
#[derive(Debug, Clone, PartialEq)]
pub struct DiffuseGroup {
    /// Real and imaginary part of the poles of both parts, and of what rises.
    poles: [[Lanes; 2]; 3],
    /// Amplitude after an impulse of 1 N·s.
    gains: [Lanes; 3],
    /// Pole of the noise, and gains of its source and of its second low-pass.
    noise: [Lanes; 3],
    seeds: [u32; BANDS],
}

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

impl DiffuseGroup {
    /// Coefficients of up to [`BANDS`] bands (more are left out) at a sample rate. `rise_s` is the
    /// time in which the bands rise after a strike.
    ///
    /// # Errors
    /// When a number is not finite or outside its range, or a centre is not below half the rate.
    pub fn new(
        bands: &[DiffuseBand],
        rise_s: f64,
        seed: u64,
        sample_rate_hz: f64,
    ) -> Result<Self, DesignError> {
        let mut group = Self {
            poles: [[[0.0; BANDS]; 2]; 3],
            gains: [[0.0; BANDS]; 3],
            noise: [[0.0; BANDS]; 3],
            seeds: [0; BANDS],
        };
        let mut rng = Rng::new(seed);
        for seed in &mut group.seeds {
            *seed = hash_u32(rng.next_u32());
        }
        for (lane, band) in bands.iter().enumerate().take(BANDS) {
            group.set(lane, band, rise_s, sample_rate_hz)?;
        }
        Ok(group)
    }

    fn set(&mut self, lane: usize, band: &DiffuseBand, rise_s: f64, rate_hz: f64) -> Result<(), DesignError> {
        let nyquist_hz = 0.5 * rate_hz;
        let centre_hz =
            DesignError::check("centre_hz", band.centre_hz, "from 1 Hz to below half the rate", |x| {
                (1.0..nyquist_hz).contains(&x)
            })?;
        let width_hz = DesignError::check("width_hz", band.width_hz, "at least 1 Hz", |x| x >= 1.0)?;
        let noise_hz = rate_hz / NOISE_STEP as f64;
        let pole = noise_pole((width_hz / noise_hz).min(WIDEST));
        self.noise[0][lane] = pole as f32;
        self.noise[1][lane] = (noise_gain(pole) * (1.0 - pole)) as f32;
        self.noise[2][lane] = (1.0 - pole) as f32;
        let mut fastest_per_s: f64 = 0.0;
        let mut sum = 0.0;
        for (i, part) in band.parts.iter().enumerate() {
            let energy =
                DesignError::check("energy", part.energy, "0–1e30", |x| (0.0..=1e30).contains(&x))?;
            let decay_per_s = part.decay_per_s;
            let decay_per_s =
                DesignError::check("decay_per_s", decay_per_s, "0–1e5 1/s", |x| (0.0..=1e5).contains(&x))?;
            let gain = libm::sqrt(4.0 * decay_per_s * energy);
            self.set_pole(i, lane, (centre_hz, decay_per_s, gain), rate_hz);
            fastest_per_s = fastest_per_s.max(decay_per_s);
            sum += gain;
        }
        let rise_s = DesignError::check("rise_s", rise_s, "1e-4–10 s", |x| (1e-4..=10.0).contains(&x))?;
        self.set_pole(2, lane, (centre_hz, fastest_per_s + 1.0 / rise_s, -sum), rate_hz);
        Ok(())
    }

    fn set_pole(&mut self, i: usize, lane: usize, (hz, decay_per_s, gain): (f64, f64, f64), rate_hz: f64) {
        let (radius, angle) = (libm::exp(-decay_per_s / rate_hz), 2.0 * core::f64::consts::PI * hz / rate_hz);
        self.poles[i][0][lane] = (radius * libm::cos(angle)) as f32;
        self.poles[i][1][lane] = (radius * libm::sin(angle)) as f32;
        self.gains[i][lane] = gain as f32;
    }
}

/// Pole p of two one-poles (1 − p) / (1 − p z⁻¹) in a row whose equivalent rectangular width, both
/// sides of 0 together, is `width` sample rates: (1 − p)⁴ (1 + p²) / (1 − p²)³, by bisection.
fn noise_pole(width: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let p = 0.5 * (low + high);
        if power(p) > width { low = p } else { high = p }
    }
    0.5 * (low + high)
}

/// Mean square of white noise of mean square 1 after both low-passes.
fn power(p: f64) -> f64 {
    let q = 1.0 - p * p;
    (1.0 - p) * (1.0 - p) * (1.0 - p) * (1.0 - p) * (1.0 + p * p) / (q * q * q)
}

/// Gain of uniform numbers, −1 to 1 in both parts, that makes |w|² 1 in the mean, over the line
/// between two values too: they correlate by 2p / (1 + p²).
fn noise_gain(p: f64) -> f64 {
    let correlation = 2.0 * p / (1.0 + p * p);
    let steps = (0..NOISE_STEP).map(|k| k as f64 / NOISE_STEP as f64);
    let on_line = steps.map(|x| (1.0 - x) * (1.0 - x) + x * x + 2.0 * x * (1.0 - x) * correlation);
    let on_line = on_line.sum::<f64>() / NOISE_STEP as f64;
    libm::sqrt(1.5 / (power(p) * on_line))
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
        Self { level, groups, states, age: None, rises: false }
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
            *state = DiffuseState { random: group.seeds, ..DiffuseState::REST };
            for (lane, seed) in group.seeds.iter().enumerate() {
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
