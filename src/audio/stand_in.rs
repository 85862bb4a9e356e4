//! Stand-ins: of a crowd of contacts on one surface some are computed, and these speak for the others, by noise of the same spectrum.
//!
//! ```text
//! each contact that is not computed is spoken for by the computed one r that is nearest to it in (lg F, lg v)
//! power of what r speaks for     p_r = Σ (v/v_r)^1.4 (F/F_r)^0.67 (gain/gain_r)²            growth of a stroke: v^0.7 F^⅓
//! what they send                 z[n] = Σ_r √p_r x_r[n]                                     x_r: what r sends to the body
//! stand-in                       y[n] = ½ Σ_j ±_j w((n − n_j)/L) z[n − d_j]                 8 grains, w a half sine, Σ w² = 4
//! ```
//! A grain has a random sign and a random delay of at most a tenth of a second and lasts L = 4096 samples at 44.1 kHz. Signs are independent, so in the mean y
//! has the power of z in every band, and no part of it is in step with what r itself sends: a sum of many contacts at places of their own. Whatever makes
//! the spectrum (relief, collisions, grains, probe) is in it, because it is computed and not predicted. What it is not: the crowd's own sound at a
//! moment (it comes up to a tenth of a second late), the blow of a landing, or several contacts in step on one grating.
//!
//! Everything happens at absolute samples: signs and delays are hashed from them, weights change on a grid.

use crate::model::id::BodyId;
use asperity_dsp::rng::hash_u32;
use asperity_texture::height_field::MAX_BLOCK;

/// Surfaces that may have a stand-in at the same time; on more, every contact is computed.
pub(crate) const STAND_INS: usize = 8;
/// Grains that sound at a time.
const GRAINS: usize = 8;
/// Length of a grain and longest delay, s, at 44.1 kHz 4096 and 4352 samples.
const GRAIN_AT_44_1: usize = 4096;
/// Cells of [`MAX_BLOCK`] samples between two looks at who speaks for whom.
const CELLS_A_LOOK: u64 = 16;
/// How far a gain goes on within a cell.
const GLIDE: f64 = 0.25;
/// Growth of a stroke's power with speed and force.
const BY_SPEED: f64 = 1.4;
const BY_FORCE: f64 = 2.0 / 3.0;
/// A contact that is slower counts as so fast, m/s.
const SLOWEST_M_S: f64 = 1e-4;
/// A contact is spoken for with at most so much more power than the one that speaks.
const MOST_POWER: f64 = 16.0;

/// A contact as far as its sound is foretold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    log_force: f64,
    log_speed: f64,
    gain: f64,
    still: bool,
}

impl Stroke {
    /// Pressed so hard, so fast, so loud.
    pub(crate) fn new(force_n: f64, [u, v]: [f64; 2], gain: f64) -> Self {
        let speed_m_s = libm::sqrt(u * u + v * v);
        Self {
            log_force: libm::log(force_n.max(1e-6)),
            log_speed: libm::log(speed_m_s.max(SLOWEST_M_S)),
            gain,
            still: speed_m_s < SLOWEST_M_S,
        }
    }

    /// How unlike another it is.
    fn distance(&self, other: &Self) -> f64 {
        let (force, speed) = (self.log_force - other.log_force, self.log_speed - other.log_speed);
        // Speed moves the spectrum, force hardly.
        speed * speed + 0.25 * force * force
    }

    /// Its power beside another's.
    fn power_beside(&self, other: &Self) -> f64 {
        if self.still || other.gain == 0.0 {
            return 0.0;
        }
        let grown =
            BY_SPEED * (self.log_speed - other.log_speed) + BY_FORCE * (self.log_force - other.log_force);
        (libm::exp(grown) * (self.gain / other.gain) * (self.gain / other.gain)).min(MOST_POWER)
    }
}

/// A voice that speaks for others.
#[derive(Debug, Clone, Copy, Default)]
struct Speaker {
    /// Gain at the beginning of the cell, at its end, and where it goes.
    from: f64,
    to: f64,
    wanted: f64,
}

/// What is sent to a body in a stretch: spread for the bank, and as it is.
type Streams = [[f64; MAX_BLOCK]; 2];

/// The stand-in of one surface.
struct StandIn {
    /// Its surface, while it has one.
    surface: Option<usize>,
    /// What the speakers send, by absolute sample.
    heard: [Box<[f32]>; 2],
    /// The present stretch of it.
    now: Streams,
    /// How many samples ago something was heard.
    quiet: usize,
}

/// The stand-ins of a renderer.
pub(crate) struct StandIns {
    /// Contacts of a surface that are computed; none = all.
    exact: usize,
    each: Box<[StandIn]>,
    speakers: Box<[Speaker]>,
    window: Box<[f32]>,
    /// Between two grains.
    hop: usize,
}

impl StandIns {
    /// For so many voices, of which `exact` on each surface are computed; allocates only if there is such a bound.
    pub(crate) fn new(exact: Option<usize>, voices: usize, sample_rate_hz: f64) -> Self {
        let octaves = libm::round(libm::log2(sample_rate_hz / 44_100.0)).clamp(-3.0, 6.0);
        let grain = (GRAIN_AT_44_1 as f64 * libm::exp2(octaves)) as usize;
        let count = if exact.is_some() { STAND_INS } else { 0 };
        let ring = || vec![0.0; 4 * grain].into_boxed_slice();
        let each = (0..count).map(|_| StandIn {
            surface: None,
            heard: [ring(), ring()],
            now: [[0.0; MAX_BLOCK]; 2],
            quiet: 0,
        });
        let at = |n: usize| libm::sin(std::f64::consts::PI * (n as f64 + 0.5) / grain as f64) as f32;
        Self {
            exact: exact.unwrap_or(usize::MAX),
            each: each.collect(),
            speakers: vec![Speaker::default(); if exact.is_some() { voices } else { 0 }].into(),
            window: (0..if exact.is_some() { grain } else { 0 }).map(at).collect(),
            hop: grain / GRAINS,
        }
    }

    /// Whether contacts may ever be spoken for.
    pub(crate) fn are_on(&self) -> bool {
        !self.each.is_empty()
    }

    /// How many contacts of a surface are computed.
    pub(crate) fn exact(&self) -> usize {
        self.exact
    }

    /// A stand-in for a surface, if it has one or one is free.
    pub(crate) fn open(&mut self, surface: usize) -> bool {
        if self.each.iter().any(|of| of.surface == Some(surface)) {
            return true;
        }
        let Some(free) = self.each.iter_mut().find(|of| of.surface.is_none()) else { return false };
        (free.surface, free.quiet) = (Some(surface), 0);
        true
    }

    /// Whether it is time to look who speaks for whom.
    pub(crate) fn looks(&self, position: u64) -> bool {
        self.are_on() && position.is_multiple_of(CELLS_A_LOOK * MAX_BLOCK as u64)
    }

    /// Nobody is spoken for until it is [said](Self::speak).
    pub(crate) fn forget(&mut self) {
        self.speakers.iter_mut().for_each(|speaker| speaker.wanted = 0.0);
    }

    /// A contact is spoken for by the nearest of these voices.
    pub(crate) fn speak(&mut self, contact: &Stroke, computed: impl Iterator<Item = (usize, Stroke)>) {
        let near = |(_, a): &(usize, Stroke), (_, b): &(usize, Stroke)| {
            contact.distance(a).total_cmp(&contact.distance(b))
        };
        let Some((voice, by)) = computed.min_by(near) else { return };
        if let Some(speaker) = self.speakers.get_mut(voice) {
            // A power until all have been said.
            speaker.wanted += contact.power_beside(&by);
        }
    }

    /// All have been said.
    pub(crate) fn said(&mut self) {
        self.speakers.iter_mut().for_each(|speaker| speaker.wanted = libm::sqrt(speaker.wanted));
    }

    /// Another contact has this voice from now on.
    pub(crate) fn begin(&mut self, voice: usize) {
        if let Some(speaker) = self.speakers.get_mut(voice) {
            *speaker = Speaker::default();
        }
    }

    /// A voice has sent these during the stretch from `position` on.
    pub(crate) fn hear(&mut self, voice: usize, surface: usize, position: u64, sent: [&[f64]; 2]) {
        let Some(Speaker { from, to, .. }) = self.speakers.get(voice).copied() else { return };
        if from == 0.0 && to == 0.0 {
            return;
        }
        let Some(of) = self.each.iter_mut().find(|of| of.surface == Some(surface)) else { return };
        of.quiet = 0;
        let first = position as usize % MAX_BLOCK;
        for (now, sent) in of.now.iter_mut().zip(sent) {
            for (i, (sum, x)) in now.iter_mut().zip(sent).enumerate() {
                *sum += (from + (to - from) * (first + i) as f64 / MAX_BLOCK as f64) * x;
            }
        }
    }

    /// Renders the next `n` samples of each surface: `place` tells the body and the position that it excites, `send` takes them there.
    pub(crate) fn render(
        &mut self,
        position: u64,
        n: usize,
        place: impl Fn(usize) -> Option<(BodyId, usize)>,
        mut send: impl FnMut((BodyId, usize), [&[f64]; 2]),
    ) {
        let Self { each, window, hop, speakers, .. } = self;
        let grain = window.len();
        for of in each.iter_mut() {
            let Some(surface) = of.surface else { continue };
            let mut out = [[0.0; MAX_BLOCK]; 2];
            for ((heard, now), out) in of.heard.iter_mut().zip(&mut of.now).zip(&mut out) {
                let mask = heard.len() - 1;
                for (i, now) in now[..n].iter_mut().enumerate() {
                    heard[(position as usize + i) & mask] = std::mem::take(now) as f32;
                }
                for j in 0..GRAINS {
                    grains(position, n, surface, (j, *hop), window, |i, age, sign, delay| {
                        let x = heard[(position as usize + i).wrapping_sub(delay) & mask];
                        out[i] += f64::from(sign * window[age] * x);
                    });
                }
            }
            out.iter_mut().flatten().for_each(|y| *y *= 0.5);
            of.quiet += n;
            if let Some(place) = place(surface) {
                send(place, [&out[0][..n], &out[1][..n]]);
            }
            // What was heard has left the longest delay behind.
            if of.quiet > 3 * grain {
                of.surface = None;
                of.heard.iter_mut().for_each(|heard| heard.fill(0.0));
            }
        }
        if (position + n as u64).is_multiple_of(MAX_BLOCK as u64) {
            for Speaker { from, to, wanted } in speakers.iter_mut() {
                *from = *to;
                *to += GLIDE * (*wanted - *to);
                if *wanted == 0.0 && *to < 1e-3 {
                    *to = 0.0;
                }
            }
        }
    }

    /// Forgets all that was heard.
    pub(crate) fn silence(&mut self) {
        self.speakers.fill(Speaker::default());
        for of in &mut self.each {
            of.surface = None;
            of.heard.iter_mut().for_each(|heard| heard.fill(0.0));
        }
    }
}

/// Calls `each` with place, age, sign and delay of one of the grains in every sample of a stretch.
fn grains(
    position: u64,
    n: usize,
    surface: usize,
    (j, hop): (usize, usize),
    window: &[f32],
    mut each: impl FnMut(usize, usize, f32, usize),
) {
    let grain = window.len();
    // Grain j begins at every `grain` samples, j hops later than the first.
    let shifted = position + ((GRAINS - j) * hop) as u64;
    let mut at = 0;
    while at < n {
        let now = shifted + at as u64;
        let (age, number) = ((now % grain as u64) as usize, now / grain as u64);
        let until = (at + grain - age).min(n);
        let bits = hash_u32(hash_u32(number as u32 ^ ((surface as u32) << 20)).wrapping_add(j as u32));
        let sign = if bits & 1 == 0 { 1.0 } else { -1.0 };
        // From an eighth of a hop on, so that nothing is in step with the speaker itself.
        let delay = hop / 8 + ((u64::from(bits >> 1) * grain as u64) >> 31) as usize;
        (at..until).for_each(|i| each(i, age + i - at, sign, delay));
        at = until;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    const RATE_HZ: f64 = 44_100.0;

    fn spoken_for(contacts: usize, position: u64, ins: &mut StandIns) {
        if ins.looks(position) {
            ins.forget();
            let stroke = Stroke::new(0.5, [0.1, 0.0], 1.0);
            (0..contacts).for_each(|_| ins.speak(&stroke, std::iter::once((0, stroke))));
            ins.said();
        }
    }

    /// What stands in for so many contacts that send what one sends, in stretches of these lengths.
    fn stand_in(contacts: usize, sent: &[f64], lengths: &[usize]) -> Vec<f64> {
        let mut ins = StandIns::new(Some(2), 4, RATE_HZ);
        assert!(ins.open(3));
        let (mut out, mut at, mut which) = (Vec::new(), 0, 0);
        while at < sent.len() {
            let position = at as u64;
            let n = lengths[which % lengths.len()].min(MAX_BLOCK - at % MAX_BLOCK).min(sent.len() - at);
            spoken_for(contacts, position, &mut ins);
            ins.hear(0, 3, position, [&sent[at..at + n]; 2]);
            ins.render(
                position,
                n,
                |surface| Some((BodyId::from_bits(1 << 32), surface)),
                |_, y| {
                    assert_eq!(y[0], y[1]);
                    out.extend_from_slice(y[0]);
                },
            );
            (at, which) = (at + n, which + 1);
        }
        out
    }

    fn power(x: &[f64]) -> f64 {
        x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64
    }

    #[test]
    fn noise_of_one_contact_becomes_that_of_many_with_their_power_and_not_in_step_with_it() {
        let mut rng = Rng::new(5);
        let sent: Vec<f64> = (0..400_000).map(|_| rng.normal()).collect();
        for contacts in [1, 25, 184] {
            let y = stand_in(contacts, &sent, &[64]);
            assert_eq!(y.len(), sent.len());
            let (sent, y) = (&sent[20_000..], &y[20_000..]);
            let louder_db = 10.0 * (power(y) / power(sent) / contacts as f64).log10();
            assert!(louder_db.abs() < 0.3, "{contacts}: {louder_db} dB");
            let with: f64 = sent.iter().zip(y).map(|(a, b)| a * b).sum::<f64>() / sent.len() as f64;
            assert!(with.abs() < 0.02 * (power(sent) * power(y)).sqrt(), "{contacts}: {with}");
        }
    }

    #[test]
    fn any_split_into_stretches_sends_the_same_bits_and_it_ends_when_nobody_speaks() {
        let mut rng = Rng::new(6);
        let mut sent: Vec<f64> = (0..20_000).map(|_| rng.normal()).collect();
        sent.resize(60_000, 0.0);
        let whole = stand_in(9, &sent, &[64]);
        assert_eq!(stand_in(9, &sent, &[1, 7, 64, 13]), whole);
        assert!(whole[30_000..].iter().all(|y| *y == 0.0));
    }

    #[test]
    fn a_contact_is_spoken_for_by_the_one_most_like_it() {
        let mut ins = StandIns::new(Some(2), 4, RATE_HZ);
        ins.forget();
        let at = |force_n: f64, speed_m_s: f64| Stroke::new(force_n, [speed_m_s, 0.0], 1.0);
        let computed = [(1, at(0.5, 0.05)), (2, at(0.5, 0.2))];
        for (force_n, speed_m_s) in [(0.5, 0.2), (0.3, 0.21), (0.6, 0.04), (0.5, 0.0)] {
            ins.speak(&at(force_n, speed_m_s), computed.into_iter());
        }
        ins.said();
        assert!(
            (ins.speakers[2].wanted.powi(2) - 1.0 - (1.05f64.powf(1.4) * 0.6f64.powf(2.0 / 3.0))).abs()
                < 1e-9
        );
        assert!(
            (ins.speakers[1].wanted.powi(2) - 0.8f64.powf(1.4) * 1.2f64.powf(2.0 / 3.0)).abs() < 1e-9,
            "and who rests is silent"
        );
    }
}
