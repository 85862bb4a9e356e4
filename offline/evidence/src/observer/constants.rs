//! Every number the observer has, with its source. Changing one changes the hash that results are
//! printed with.
//!
//! **Recalled** marks figures that could not be opened again when they were written down.

use sha2::{Digest, Sha256};

/// Length of one look at a stimulus, s: about that of a trial's interval in difference threshold
/// experiments. **Assumed.**
pub const LOOK_S: f64 = 1.0;
/// Looks that add up; what lasts longer is not known better (memory). The independent looks of the
/// multiple-looks model, a choice that was made before anything was judged.
pub const MOST_LOOKS: usize = 4;
/// Frames in which fluctuation and places are felt and heard, s.
pub const FRAME_S: f64 = 0.1;
/// Share of trials answered at random.
pub const LAPSE: f64 = 0.02;

/// Third octaves of touch: centre of the first, Hz, and how many (10 Hz to 1 kHz).
pub const FIRST_THIRD_OCTAVE_HZ: f64 = 10.0;
/// See [`FIRST_THIRD_OCTAVE_HZ`].
pub const THIRD_OCTAVES: usize = 21;

/// Detection threshold of vibration on glabrous skin, (Hz, dB re 1 µm rms): Bolanowski, Gescheider,
/// Verrillo and Checkosky 1988 (thenar, 2.9 cm²; peak values less 3 dB). **Recalled**, to about 3
/// dB. Between points linear in log f.
pub const TOUCH_THRESHOLD: [(f64, f64); 11] = [
    (10.0, 13.0),
    (16.0, 10.0),
    (25.0, 7.0),
    (40.0, 2.0),
    (63.0, -6.0),
    (100.0, -15.0),
    (160.0, -21.0),
    (250.0, -24.0),
    (400.0, -17.0),
    (630.0, -4.0),
    (1000.0, 14.0),
];

/// Relative difference thresholds of vibration, (Hz, Weber fraction of the amplitude): the extremes
/// of the medians that Forta, Griffin and Morioka 2012 found (abstract; 0.58 at 10 Hz and 20 dB SL,
/// 0.20 at 125 Hz and 10 dB SL, three-down-one-up, two intervals). Between them linear in log f;
/// beyond, as at the nearer end.
pub const TOUCH_WEBER: [(f64, f64); 2] = [(10.0, 0.58), (125.0, 0.20)];

/// d′ at the threshold of the three-down-one-up rule in two intervals: √2 z(0.794).
pub const D_PRIME_AT_THRESHOLD: f64 = 1.16;

/// Bounds of the groups whose fluctuation is felt, Hz: about where flutter, the border and the
/// Pacinian channel lie.
pub const TOUCH_GROUPS_HZ: [f64; 4] = [20.0, 63.0, 250.0, 1000.0];
/// Bounds of the groups whose fluctuation is heard, Hz.
pub const SOUND_GROUPS_HZ: [f64; 4] = [100.0, 800.0, 3000.0, 12_000.0];

/// Parts of the plate, along u and along v, whose levels are kept apart where the task gives the
/// hand's place.
pub const PLACES: usize = 7;

/// Ears: ERB-number of the first band and the last (Glasberg and Moore 1990), one band each ERB.
pub const ERB_NUMBERS: (usize, usize) = (2, 37);
/// Just noticeable difference of a sound's level in one band, dB: about 1 dB at moderate levels
/// (textbook figure).
pub const SOUND_LEVEL_SD_DB: f64 = 1.0;
/// Just noticeable differences of a decay, shorter and longer, shares: −25 % and +40 % (impact
/// sounds). Their mean in logarithms is the deviation.
pub const DECAY_JND: [f64; 2] = [0.25, 0.40];
/// Sound pressure for which a full-scale sample stands when nobody says better, Pa: 94 dB SPL.
pub const LISTENING_PA: f64 = 1.0;

/// Threshold of vibration, m rms.
#[must_use]
pub fn touch_threshold_m(frequency_hz: f64) -> f64 {
    1e-6 * 10f64.powf(between(&TOUCH_THRESHOLD, frequency_hz) / 20.0)
}

/// Deviation of one look at the level of a band, dB: a step of one difference threshold has d′ =
/// 1.16.
#[must_use]
pub fn touch_sd_db(frequency_hz: f64) -> f64 {
    20.0 * (1.0 + between(&TOUCH_WEBER, frequency_hz)).log10() / D_PRIME_AT_THRESHOLD
}

/// Threshold of hearing, dB SPL: Terhardt's 1979 approximation.
#[must_use]
pub fn hearing_threshold_db(frequency_hz: f64) -> f64 {
    let khz = frequency_hz * 1e-3;
    3.64 * khz.powf(-0.8) - 6.5 * (-0.6 * (khz - 3.3).powi(2)).exp() + 1e-3 * khz.powi(4)
}

/// Linear in log f between the points of a table, held beyond its ends.
pub(crate) fn between(table: &[(f64, f64)], frequency_hz: f64) -> f64 {
    let mut value = table[0].1;
    for pair in table.windows(2) {
        let part = (frequency_hz / pair[0].0).ln() / (pair[1].0 / pair[0].0).ln();
        if part > 0.0 {
            value = pair[0].1 + part.min(1.0) * (pair[1].1 - pair[0].1);
        }
    }
    value
}

/// SHA-256 of all constants, in hexadecimal.
#[must_use]
pub fn constants_sha256() -> String {
    let text = format!(
        "{LOOK_S} {MOST_LOOKS} {FRAME_S} {LAPSE} {FIRST_THIRD_OCTAVE_HZ} {THIRD_OCTAVES} {TOUCH_THRESHOLD:?} {TOUCH_WEBER:?} \
         {D_PRIME_AT_THRESHOLD} {TOUCH_GROUPS_HZ:?} {SOUND_GROUPS_HZ:?} {PLACES} {ERB_NUMBERS:?} {SOUND_LEVEL_SD_DB} \
         {DECAY_JND:?} {LISTENING_PA}"
    );
    Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
}
