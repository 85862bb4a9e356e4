//! What the ear is said to miss of a struck body of which modes are left out: the difference of excitation, with spreading and the threshold in
//! quiet (`asperity_dsp::masking`).

use asperity_dsp::masking::{erb_number, excitation_db, quiet_db_spl};
use asperity_dsp::mode::Mode;

/// Frames of 20 ms …
const FRAMES: usize = 50;
const FRAME_S: f64 = 0.02;
/// … and bands of an ERB, from 100 Hz to 15 kHz.
const ERBS: std::ops::Range<i32> = 4..40;
/// Share of the cells that are within what is told.
const MOST: f64 = 0.99;

/// Excitation at one ERB number and time, with the threshold in quiet, as a power.
fn excitation(modes: &[Mode], loudest_db_spl: f64, loudest: f64, erb: f64, time_s: f64) -> f64 {
    let hz = (10f64.powf(erb / 21.4) - 1.0) / 0.00437;
    let power = |db: f64| 10f64.powf(0.1 * db);
    let of = |mode: &Mode| {
        let level_db = loudest_db_spl + 20.0 * (mode.amplitude.abs() / loudest).max(1e-30).log10()
            - 8.686 * mode.decay_per_s * time_s;
        power(excitation_db(level_db, erb_number(mode.frequency_hz), erb))
    };
    modes.iter().map(of).sum::<f64>() + power(quiet_db_spl(hz))
}

/// In 99 of 100 cells of an ERB and 20 ms the first `kept` modes excite the ear as all of them do within this, dB.
pub fn apart_db(modes: &[Mode], kept: usize, loudest_db_spl: f64) -> f64 {
    let loudest = modes.iter().fold(f64::MIN_POSITIVE, |most, mode| most.max(mode.amplitude.abs()));
    let cells = (0..FRAMES).flat_map(|frame| ERBS.map(move |erb| (f64::from(erb), frame)));
    let mut apart_db: Vec<f64> = cells
        .map(|(erb, frame)| {
            let of = |modes: &[Mode]| {
                excitation(modes, loudest_db_spl, loudest, erb, FRAME_S * (frame as f64 + 0.5))
            };
            10.0 * (of(modes) / of(&modes[..kept.min(modes.len())])).log10()
        })
        .collect();
    apart_db.sort_by(f64::total_cmp);
    crate::measure::quantile(&apart_db, MOST)
}
