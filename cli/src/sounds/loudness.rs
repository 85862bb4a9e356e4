//! Loudness of a file: integrated, gated, as ITU-R BS.1770 and EBU R 128 have it.

use ebur128::{Channel, EbuR128, Mode};

/// Length of the shortest gating block, s.
const BLOCK_S: f64 = 0.4;

/// Loudness in LUFS; none of silence. What is shorter than a gating block counts with the silence
/// that fills one. Every channel is a bus of its own and counts as a front one does.
pub fn integrated_lufs(channels: &[&[f32]], rate_hz: f64) -> Option<f64> {
    let count = u32::try_from(channels.len()).ok()?;
    let mut meter = EbuR128::new(count, rate_hz.round() as u32, Mode::I).ok()?;
    for channel in 0..count {
        meter.set_channel(channel, Channel::Center).ok()?;
    }
    let frames = channels.first()?.len();
    let least = (BLOCK_S * rate_hz).ceil() as usize + 1;
    let padded: Vec<Vec<f32>> = channels
        .iter()
        .map(|channel| {
            let mut channel = channel.to_vec();
            channel.resize(frames.max(least), 0.0);
            channel
        })
        .collect();
    let padded: Vec<&[f32]> = padded.iter().map(Vec::as_slice).collect();
    meter.add_frames_planar_f32(&padded).ok()?;
    meter.loudness_global().ok().filter(|lufs| lufs.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(hz: f64, seconds: f64, amplitude: f64) -> Vec<f32> {
        let sample = |i: usize| amplitude * (std::f64::consts::TAU * hz * i as f64 / 48e3).sin();
        (0..(seconds * 48e3) as usize).map(|i| sample(i) as f32).collect()
    }

    #[test]
    fn a_full_scale_tone_of_997_hz_has_the_recommended_loudness() {
        // ITU-R BS.1770-4, annex 1: a 0 dBFS sine of 997 Hz in one front channel reads −3.01 LKFS.
        let lufs = integrated_lufs(&[&tone(997.0, 3.0, 1.0)], 48e3).unwrap();
        assert!((lufs + 3.01).abs() < 0.05, "{lufs}");
        let quieter = integrated_lufs(&[&tone(997.0, 3.0, 0.1)], 48e3).unwrap();
        assert!((quieter + 23.01).abs() < 0.05, "{quieter}");
    }

    #[test]
    fn a_short_hit_has_a_loudness_and_silence_has_none() {
        let short = integrated_lufs(&[&tone(997.0, 0.1, 1.0)], 48e3).unwrap();
        assert!((short + 3.01 + 6.02).abs() < 0.2, "{short}");
        assert_eq!(integrated_lufs(&[&[0.0; 48_000]], 48e3), None);
        assert_eq!(integrated_lufs(&[&[]], 48e3), None);
    }
}
