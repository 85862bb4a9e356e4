//! Rumble: faint modes below the lowest partial of the body.
//!
//! A room, a table or a breath fills the octaves below a struck body with slow noise, and a fit
//! finds modes in it: 26 of 63 in a vibraphone bar's recording, all below 1.25 kHz and together 34
//! dB down. The lowest *proven* partial is the lowest that rings (Q = ω / 2δ of at least 10) and is
//! loud (30 dB under the loudest such). What lies below it and is fainter than that is left out,
//! the faintest first, as long as this costs no more than 0.5 dB of signal to error. A thump that
//! is loud stays: it is part of the sound, if not of the body.

use crate::proof::warning::Warning;
use crate::sinusoid::partial::Partial;
use std::f64::consts::PI;

/// A partial rings if it turns by so many radians in the time of two nepers.
const RINGING_Q: f64 = 10.0;
/// And is loud within this part of the loudest one's energy.
const LOUD: f64 = 1e-3;
/// By how much, as a part, the squared residual may rise: 0.5 dB.
const COST: f64 = 0.12;

/// Takes the rumble out of `partials`, which leave a squared residual of `left` over `count`
/// samples.
pub(crate) fn take_rumble(
    partials: &mut Vec<Partial>,
    count: usize,
    left: f64,
    rate_hz: f64,
) -> Option<Warning> {
    let ringing = |p: &&Partial| p.omega >= 2.0 * RINGING_Q * p.delta;
    let energy = |p: &Partial| p.energy(count);
    let loudest = partials.iter().filter(ringing).map(energy).fold(0.0, f64::max);
    let proven = |p: &&Partial| ringing(p) && energy(p) >= LOUD * loudest;
    let lowest = partials.iter().filter(proven).map(|p| p.omega).fold(f64::INFINITY, f64::min);
    let mut below: Vec<Partial> =
        partials.iter().filter(|p| p.omega < lowest && energy(p) < LOUD * loudest).copied().collect();
    below.sort_by(|a, b| energy(a).total_cmp(&energy(b)));
    let mut spent = 0.0;
    below.retain(|p| {
        spent += energy(p);
        spent <= COST * left
    });
    partials.retain(|p| !below.contains(p));
    (!below.is_empty())
        .then(|| Warning::Rumble { count: below.len(), lowest_hz: lowest * rate_hz / (2.0 * PI) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    #[test]
    fn faint_modes_below_the_lowest_partial_go_and_a_loud_thump_stays() {
        let partial =
            |omega: f64, q: f64, c: f64| Partial { omega, delta: omega / (2.0 * q), c: Complex::new(c, 0.0) };
        let (bar, second) = (partial(0.2, 500.0, 1.0), partial(0.7, 300.0, 0.3));
        let (thump, rumble) = (partial(0.01, 1.0, 2.0), partial(0.005, 50.0, 3e-4));
        let mut partials = vec![bar, second, thump, rumble];
        let left = 1e-3 * bar.energy(44_100);
        let warning = take_rumble(&mut partials, 44_100, left, 44_100.0);
        assert_eq!(partials, [bar, second, thump]);
        let Some(Warning::Rumble { count: 1, lowest_hz }) = warning else { panic!("{warning:?}") };
        assert!((lowest_hz - 0.2 * 44_100.0 / (2.0 * PI)).abs() < 1e-6);
        // A fit so good that the rumble is a part of it keeps it.
        partials.push(rumble);
        assert_eq!(take_rumble(&mut partials, 44_100, rumble.energy(44_100), 44_100.0), None);
    }
}
