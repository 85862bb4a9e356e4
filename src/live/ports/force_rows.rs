//! Force rows: the 3-D force on the finger at the ticks of a device's own rate, low-passed so that
//! no tick takes what lies beyond it.
//!
//! ```text
//! row(k, contact) = Σ h(τ − k) F(τ) / Σ h(τ − k)        τ: time of a sample in ticks, |τ − k| < 4
//! h(x)            = sinc(2 c x) · Kaiser(x / 4; β = 5)    c = 0.45 cycles a tick
//! row(k, hand)    = Σ over the contacts that the hand's actuator feels
//! |row|          ≤ cap        the lowest of what a row is made of; row = 0 before a touch out of the air
//! ```
//!
//! A row is the force at its tick's own instant: flat within 0.3 % up to a quarter of the rate, 50
//! dB down from 0.66 of it on. (A mean over the tick lets 900 Hz through a 1 kHz output at −19 dB,
//! as 100 Hz, and speaks of the middle of the tick.) It is complete 4 ticks later. The weights of
//! what a contact has reported are brought to 1, so that a constant force is itself from the first
//! row to the last.
//!
//! A filter with a steep edge swings about a jump of the force, by up to 9 % of it, before it as
//! after it. Two limits come after it therefore: a row is no larger than what the device gives, and
//! one that lies before a touch is exactly 0 N.

use crate::link::tap::ContactBlock;
use crate::model::event::{ChannelId, ContactId};
use asperity_surface::force_output::capped;
use asperity_surface::height_field::MAX_BLOCK;

/// Half the length of h, ticks: how far rows lag behind what is rendered.
pub const LAG_TICKS: u64 = 4;
/// Cutoff of h, cycles a tick.
const CUTOFF: f64 = 0.45;
/// Shape of its window.
const KAISER_BETA: f64 = 5.0;
/// Values of h between two ticks.
const STEPS: usize = 512;

/// Owner of a row's force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// One contact's.
    Contact(ContactId),
    /// The sum of all contacts that this channel's hand feels.
    Hand(ChannelId),
}

/// A force at one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceRow {
    /// The tick: it is `tick / rate_hz` seconds after sample 0.
    pub tick: u64,
    /// Whose force.
    pub of: Of,
    /// Along u, v and out of the surface, N.
    pub force_n: [f64; 3],
}

/// Makes rows of what contacts do.
#[derive(Debug, Clone)]
pub struct ForceRows {
    ticks_a_sample: f64,
    /// h from 0 to 4 ticks.
    kernel: Box<[f64]>,
    /// In order of contacts, with room for more.
    tracks: Vec<Track>,
    spare: Vec<Box<[OpenRow]>>,
    /// Ticks that a contact can have open.
    span: u64,
}

/// The open rows of one contact.
#[derive(Debug, Clone)]
struct Track {
    contact: ContactId,
    actuator: Option<ChannelId>,
    /// By their tick, modulo their number.
    rows: Box<[OpenRow]>,
    /// The first that is open, and one past the last that lies within the contact.
    open: [u64; 2],
    /// Last tick at which something pressed; none = not yet.
    pressed_at: Option<f64>,
}

#[derive(Debug, Clone, Copy)]
struct OpenRow {
    /// True where the contact was there at this tick.
    is_told: bool,
    /// Nothing has pressed for as long as a row reaches, and what presses next comes after this
    /// tick.
    is_before_touch: bool,
    weight: f64,
    sum_n: [f64; 3],
    /// Lowest of all samples in it.
    cap_n: f64,
}

impl OpenRow {
    const EMPTY: Self =
        Self { is_told: false, is_before_touch: false, weight: 0.0, sum_n: [0.0; 3], cap_n: f64::INFINITY };

    fn force_n(&self) -> [f64; 3] {
        if self.is_before_touch {
            return [0.0; 3];
        }
        capped(self.sum_n.map(|sum_n| sum_n / self.weight), self.cap_n)
    }
}

impl Track {
    /// Something presses at `now`, of which the ticks from `from` on hear.
    fn press(&mut self, now: f64, from: u64, mask: u64) {
        let touches = self.pressed_at.is_none_or(|pressed_at| now - pressed_at > LAG_TICKS as f64);
        self.pressed_at = Some(now);
        if touches {
            let before = (from..).take_while(|tick| (*tick as f64) < now);
            before.for_each(|tick| self.rows[(tick & mask) as usize].is_before_touch = true);
        }
    }
}

impl ForceRows {
    /// For `rate_hz` rows a second. Allocates room for `contacts` at once; more make it allocate
    /// later.
    #[must_use]
    pub fn new(rate_hz: f64, sample_rate_hz: f64, contacts: usize) -> Self {
        let ticks_a_sample = rate_hz / sample_rate_hz;
        // Closed at least once a block; what comes meanwhile reaches 4 ticks either way.
        let reported = (2.0 * MAX_BLOCK as f64 * ticks_a_sample).ceil() as u64;
        let span = (2 * LAG_TICKS + reported + 4).next_power_of_two();
        let rows = || vec![OpenRow::EMPTY; span as usize].into_boxed_slice();
        let kernel = (0..=LAG_TICKS as usize * STEPS + 1).map(|i| kernel(i as f64 / STEPS as f64)).collect();
        let mut spare = Vec::with_capacity(contacts + 1);
        spare.extend((0..contacts).map(|_| rows()));
        Self { ticks_a_sample, kernel, tracks: Vec::with_capacity(contacts), spare, span }
    }

    /// Time of a sample in ticks. What lies next to a tick is at it.
    fn ticks(&self, sample: u64) -> f64 {
        let ticks = sample as f64 * self.ticks_a_sample;
        if (ticks - ticks.round()).abs() < 1e-9 * (1.0 + ticks) { ticks.round() } else { ticks }
    }

    fn weight(&self, away: f64) -> f64 {
        let at = away.abs() * STEPS as f64;
        let index = at as usize;
        let rest = at - index as f64;
        self.kernel[index] * (1.0 - rest) + self.kernel[index + 1] * rest
    }

    /// Adds what a contact does during a stretch of at most 64 samples; whatever ended before must
    /// have been [closed](Self::close).
    pub fn add(&mut self, block: &ContactBlock<'_>) {
        let Some(last) = block.force_n.len().checked_sub(1) else { return };
        let index = self.track(block);
        let first_tick = self.ticks(block.first_sample) as u64;
        let end_tick = self.ticks(block.first_sample + last as u64) as u64 + 1;
        let mask = self.span - 1;
        let track = &mut self.tracks[index];
        if track.open[0] == track.open[1] {
            track.open = [first_tick; 2];
        }
        track.open[1] = track.open[1].max(end_tick);
        for tick in first_tick..end_tick {
            track.rows[(tick & mask) as usize].is_told = true;
        }
        for ((sample, force_n), cap_n) in (block.first_sample..).zip(block.force_n).zip(block.cap_n) {
            let now = self.ticks(sample);
            let from = (now as u64 + 1).saturating_sub(LAG_TICKS).max(self.tracks[index].open[0]);
            if *force_n != [0.0; 3] {
                self.tracks[index].press(now, from, mask);
            }
            for tick in from..=now as u64 + LAG_TICKS {
                let weight = self.weight(now - tick as f64);
                let row = &mut self.tracks[index].rows[(tick & mask) as usize];
                row.weight += weight;
                row.cap_n = row.cap_n.min(*cap_n);
                row.sum_n = std::array::from_fn(|axis| row.sum_n[axis] + weight * force_n[axis]);
            }
        }
    }

    /// The track of a block's contact; a new one in its place if there is none.
    fn track(&mut self, block: &ContactBlock<'_>) -> usize {
        let found = self.tracks.binary_search_by_key(&block.contact, |track| track.contact);
        found.unwrap_or_else(|index| {
            let rows = self.spare.pop();
            let rows = rows.unwrap_or_else(|| vec![OpenRow::EMPTY; self.span as usize].into_boxed_slice());
            let track = Track {
                contact: block.contact,
                actuator: block.actuator,
                rows,
                open: [0; 2],
                pressed_at: None,
            };
            self.tracks.insert(index, track);
            index
        })
    }

    /// Hands out the rows that nothing from a sample on can change: the contacts of a tick in
    /// order, then the hands.
    pub fn close(&mut self, before: u64, mut row: impl FnMut(ForceRow)) {
        let done = (self.ticks(before) as u64).saturating_add(1).saturating_sub(LAG_TICKS);
        while let Some(tick) = self.tracks.iter().map(|track| track.open[0]).min().filter(|tick| *tick < done)
        {
            self.close_tick(tick, &mut row);
        }
    }

    fn close_tick(&mut self, tick: u64, row: &mut impl FnMut(ForceRow)) {
        let at = (tick & (self.span - 1)) as usize;
        let of_tick = |track: &&Track| track.open[0] == tick && track.rows[at].is_told;
        let reported = || self.tracks.iter().filter(of_tick);
        for track in reported() {
            row(ForceRow { tick, of: Of::Contact(track.contact), force_n: track.rows[at].force_n() });
        }
        for (index, track) in reported().enumerate() {
            let Some(hand) = track.actuator else { continue };
            let felt_by_hand = |track: &&Track| track.actuator == Some(hand);
            if reported().take(index).any(|track| felt_by_hand(&track)) {
                continue;
            }
            let rows = || reported().skip(index).filter(felt_by_hand).map(|track| &track.rows[at]);
            let forces_n = rows().map(OpenRow::force_n);
            let force_n = forces_n.fold([0.0; 3], |a, b| std::array::from_fn(|axis| a[axis] + b[axis]));
            let cap_n = rows().fold(f64::INFINITY, |cap_n, row| cap_n.min(row.cap_n));
            row(ForceRow { tick, of: Of::Hand(hand), force_n: capped(force_n, cap_n) });
        }
        for track in self.tracks.iter_mut().filter(|track| track.open[0] == tick) {
            track.rows[at] = OpenRow::EMPTY;
            track.open[0] += 1;
        }
        while let Some(over) = self.tracks.iter().position(|track| track.open[0] >= track.open[1]) {
            let mut rows = self.tracks.remove(over).rows;
            // Ticks beyond its end were begun as well.
            rows.fill(OpenRow::EMPTY);
            self.spare.push(rows);
        }
    }
}

/// h at a distance in ticks.
fn kernel(away: f64) -> f64 {
    let reach = away / LAG_TICKS as f64;
    if reach >= 1.0 {
        return 0.0;
    }
    let x = std::f64::consts::TAU * CUTOFF * away;
    let sinc = if x == 0.0 { 1.0 } else { libm::sin(x) / x };
    sinc * bessel_i0(KAISER_BETA * (1.0 - reach * reach).sqrt()) / bessel_i0(KAISER_BETA)
}

/// Modified Bessel function of the first kind and order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..40 {
        term *= (0.5 * x / f64::from(k)).powi(2);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of one contact that is pushed with `force` of time.
    fn rows(rate_hz: f64, sample_rate_hz: f64, force: impl Fn(f64) -> f64) -> Vec<ForceRow> {
        pushed(rate_hz, sample_rate_hz, f64::INFINITY, |t| [force(t), 0.0, 1.0])
    }

    /// Row with all three forces, which a cap limits.
    fn pushed(
        rate_hz: f64,
        sample_rate_hz: f64,
        cap_n: f64,
        force: impl Fn(f64) -> [f64; 3],
    ) -> Vec<ForceRow> {
        let mut rows = ForceRows::new(rate_hz, sample_rate_hz, 2);
        let mut reported = Vec::new();
        let mut first_sample = 0;
        while first_sample < (0.5 * sample_rate_hz) as u64 {
            let at = |i: usize| force((first_sample + i as u64) as f64 / sample_rate_hz);
            let force_n: Vec<[f64; 3]> = (0..64).map(at).collect();
            rows.close(first_sample, |row| reported.push(row));
            rows.add(&ContactBlock {
                first_sample,
                contact: ContactId(7),
                actuator: Some(ChannelId(0)),
                position_m: &[],
                uv: &[],
                velocity_m_s: &[],
                contact_samples: &[],
                impulse_n_s: &[],
                force_n: &force_n,
                cap_n: &[cap_n; 64],
            });
            first_sample += 64;
        }
        rows.close(u64::MAX, |row| reported.push(row));
        reported.retain(|row| row.of == Of::Contact(ContactId(7)));
        reported
    }

    #[test]
    fn a_tone_below_the_band_edge_passes_and_one_beyond_vanishes() {
        for (rate_hz, sample_rate_hz) in [(1000.0, 44_100.0), (5000.0, 22_050.0), (5000.0, 192_000.0)] {
            let worst = |cycles: f64, aside: bool| {
                let tone = |t: f64| (std::f64::consts::TAU * cycles * rate_hz * t + 0.3).sin();
                let reported = rows(rate_hz, sample_rate_hz, tone);
                let inner = reported.iter().filter(|row| row.tick > 8 && (row.tick as f64) < 0.49 * rate_hz);
                inner.fold(0.0f64, |worst, row| {
                    let wanted = if aside { 0.0 } else { tone(row.tick as f64 / rate_hz) };
                    worst.max((row.force_n[0] - wanted).abs())
                })
            };
            let (near, far) = (worst(0.22, false), worst(0.1, false));
            let (gone, beyond) = (worst(0.7, true), worst(0.9, true));
            println!("{rate_hz} of {sample_rate_hz}: {far:.5} {near:.5}, aliases {gone:.5} {beyond:.5}");
            assert!(near < 0.004 && far < 0.004 && gone < 0.005 && beyond < 0.005);
        }
    }

    #[test]
    fn a_constant_force_is_itself_from_the_first_row_to_the_last() {
        for sample_rate_hz in [8_000.0, 44_100.0, 96_000.0] {
            let reported = rows(1000.0, sample_rate_hz, |_| 0.25);
            assert!((500..=512).contains(&reported.len()), "{} rows", reported.len());
            assert!(reported.windows(2).all(|pair| pair[0].tick + 1 == pair[1].tick));
            assert!(reported.iter().all(|row| {
                (row.force_n[0] - 0.25).abs() < 1e-12 && (row.force_n[2] - 1.0).abs() < 1e-12
            }));
        }
    }

    #[test]
    fn no_row_beside_a_jump_passes_the_cap() {
        for (rate_hz, sample_rate_hz) in [(1000.0, 44_100.0), (5000.0, 22_050.0), (2000.0, 96_000.0)] {
            // It comes down at 0.1 s on what gives 20 N at most, and leaves from 0.3 to 0.4 s.
            let down = |t: f64| (0.1..0.3).contains(&t) || t >= 0.4;
            let reported =
                pushed(rate_hz, sample_rate_hz, 20.0, |t| if down(t) { [12.0, 0.0, 16.0] } else { [0.0; 3] });
            let size_n = |row: &ForceRow| row.force_n[0].hypot(row.force_n[2]);
            let most_n = reported.iter().map(size_n).fold(0.0, f64::max);
            assert!((20.0 - 1e-12..=20.0 + 1e-12).contains(&most_n), "{most_n} N");
            let time_s = |row: &ForceRow| row.tick as f64 / rate_hz;
            let in_the_air = |row: &&ForceRow| {
                let t = time_s(row);
                t < 0.1 || (0.3 + 4.0 / rate_hz..0.4).contains(&t)
            };
            assert!(reported.iter().filter(in_the_air).count() as f64 > 0.18 * rate_hz);
            assert!(reported.iter().filter(in_the_air).all(|row| row.force_n == [0.0; 3]));
            // What touches is reported at once.
            let touch = reported.iter().find(|row| time_s(row) >= 0.1 + 1.0 / rate_hz).unwrap();
            assert!(size_n(touch) > 15.0, "{touch:?}");
        }
    }

    #[test]
    fn several_contacts_give_a_hand_no_more_than_its_device() {
        let mut rows = ForceRows::new(1000.0, 44_100.0, 2);
        let mut reported = Vec::new();
        for cell in 0..40 {
            for contact in 0..2 {
                rows.add(&ContactBlock {
                    first_sample: 64 * cell,
                    contact: ContactId(contact),
                    actuator: Some(ChannelId(3)),
                    position_m: &[],
                    uv: &[],
                    velocity_m_s: &[],
                    contact_samples: &[],
                    impulse_n_s: &[],
                    force_n: &[[0.0, 0.0, 15.0]; 64],
                    cap_n: &[20.0; 64],
                });
            }
            rows.close(64 * (cell + 1), |row| reported.push(row));
        }
        let of = |of: Of| reported.iter().filter(move |row| row.of == of);
        assert!(of(Of::Contact(ContactId(1))).all(|row| (row.force_n[2] - 15.0).abs() < 1e-12));
        assert!(of(Of::Hand(ChannelId(3))).count() > 20);
        assert!(of(Of::Hand(ChannelId(3))).all(|row| (row.force_n[2] - 20.0).abs() < 1e-12));
    }
}
