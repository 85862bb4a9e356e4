//! The actuator stage: high-pass, device model, inverse equaliser, limiters, gains.

use asperity_dsp::actuator::{
    Channel, ChannelControl, ChannelOptions, ChannelState, ContactOutput, ContactOutputState, DeviceModel,
    DeviceProfile, DeviceState, Equaliser, EqualiserState, PeakLimiter, PeakLimiterState, Protection,
    ProtectionState, Quantity,
};
use asperity_dsp::rng::Rng;
use std::f64::consts::PI;

const RATES_HZ: [f64; 5] = [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];
const PROFILES: [DeviceProfile; 4] = [
    DeviceProfile::LRA_170,
    DeviceProfile::CONSOLE_VOICE_COIL,
    DeviceProfile::HAPTUATOR,
    DeviceProfile::VR_CONTROLLER,
];

/// Amplitude of a steady sine through `run`.
fn amplitude(f: f64, rate: f64, mut run: impl FnMut(f64) -> f64) -> f64 {
    let settle = (0.4 * rate) as usize;
    let periods = (0.2 * f).round().max(1.0);
    let samples = (periods * rate / f).round() as usize;
    let (mut re, mut im) = (0.0, 0.0);
    for n in 0..settle + samples {
        let angle = 2.0 * PI * f * n as f64 / rate;
        let y = run(angle.sin());
        if n >= settle {
            re += y * angle.sin();
            im += y * angle.cos();
        }
    }
    2.0 * (re * re + im * im).sqrt() / samples as f64
}

#[test]
fn a_contact_begins_without_a_step() {
    let rate = 44_100.0;
    for quantity in [Quantity::Displacement, Quantity::Acceleration] {
        let design = ContactOutput::new(quantity, 10.0, rate).unwrap();
        let pad = |n: usize| 3e-4 + 2e-5 * (1.0 - (2.0 * PI * 80.0 * n as f64 / rate).cos());
        let velocity = |n: usize| 2e-5 * 2.0 * PI * 80.0 * (2.0 * PI * 80.0 * n as f64 / rate).sin();
        let mut state = ContactOutputState::begin(&design, pad(0), 0.0);
        assert_eq!(state.tick(&design, pad(0), 0.0), 0.0);
        let stroke: Vec<f64> = (1..3_000).map(|n| state.tick(&design, pad(n), velocity(n))).collect();
        let largest = stroke.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        assert!(largest > 0.0);
        // The acceleration of this stroke is there from its first sample on; its displacement is
        // not.
        if quantity == Quantity::Displacement {
            assert!(stroke[0].abs() < 0.01 * largest, "{} of {largest}", stroke[0]);
        }
    }
}

#[test]
fn acceleration_is_that_of_the_pad_and_zero_cutoff_leaves_it_alone() {
    for rate in RATES_HZ {
        let (omega, size) = (2.0 * PI * 250.0, 1e-5);
        let design = ContactOutput::new(Quantity::Acceleration, 0.0, rate).unwrap();
        let velocity = |n: f64| size * omega * (omega * n / rate).cos();
        let mut state = ContactOutputState::begin(&design, 0.0, velocity(0.0));
        for n in 1..2_000 {
            let y = state.tick(&design, 0.0, velocity(f64::from(n)));
            // Mean over the step: half a sample before its end.
            let exact = -size * omega * omega * (omega * (f64::from(n) - 0.5) / rate).sin();
            assert!((y - exact).abs() < 1e-3 * size * omega * omega, "{rate} Hz, sample {n}");
        }
        let raw = ContactOutput::new(Quantity::Displacement, 0.0, rate).unwrap();
        assert_eq!(ContactOutputState::begin(&raw, 2e-4, 0.0).tick(&raw, 2e-4, 0.0), 2e-4);
    }
}

// scipy.signal, tests/independent/actuator.py: (sample, m).
const DEVICE: [(usize, f64); 6] = [
    (50, 3.394_376_288_0e-7),
    (100, 1.667_828_735_0e-6),
    (250, -3.448_706_195_4e-6),
    (300, -3.412_300_951_2e-6),
    (1000, -2.028_217_996_5e-7),
    (3000, 6.427_304_105_3e-8),
];
const HIGH_PASS: [(usize, f64); 5] = [
    (1, 7.116_604_52e-8),
    (100, 6.287_903_598_2e-6),
    (500, 8.395_927_405_9e-6),
    (1000, -1.836_124_661_7e-5),
    (3999, 1.521_033_017_7e-5),
];

#[test]
fn device_and_high_pass_agree_with_scipy() {
    let rate = 44_100.0;
    let model = DeviceModel::new(&DeviceProfile::LRA_170, Quantity::Displacement, rate).unwrap();
    let mut state = DeviceState::default();
    let drive = |n: usize| if n < 300 { (2.0 * PI * 150.0 * n as f64 / rate).sin() } else { 0.0 };
    let felt: Vec<f64> = (0..4_000).map(|n| state.tick(&model, drive(n))).collect();
    for (n, expected) in DEVICE {
        assert!((felt[n] - expected).abs() < 1e-11, "sample {n}: {}", felt[n]);
    }
    let design = ContactOutput::new(Quantity::Displacement, 10.0, rate).unwrap();
    let pad = |n: usize| 1e-4 + 2e-5 * (2.0 * PI * 25.0 * n as f64 / rate).sin();
    let mut state = ContactOutputState::begin(&design, pad(0), 0.0);
    let passed: Vec<f64> = (0..4_000).map(|n| state.tick(&design, pad(n), 0.0)).collect();
    for (n, expected) in HIGH_PASS {
        assert!((passed[n] - expected).abs() < 1e-14, "sample {n}: {}", passed[n]);
    }
}

#[test]
fn the_device_peaks_at_its_resonance_with_its_quality() {
    for rate in RATES_HZ {
        for profile in PROFILES {
            let gain = |f: f64| {
                let model = DeviceModel::new(&profile, Quantity::Displacement, rate).unwrap();
                let mut state = DeviceState::default();
                amplitude(f, rate, |u| state.tick(&model, u)) / profile.felt_at_resonance_m
            };
            for ratio in [0.4, 1.0, 2.5_f64] {
                let exact = 1.0 / (profile.quality * (1.0 - ratio * ratio)).hypot(ratio);
                let measured = gain(ratio * profile.resonance_hz);
                assert!((measured / exact - 1.0).abs() < 0.01, "{rate} Hz, {ratio} f0: {measured}, {exact}");
            }
        }
    }
}

/// Felt amplitude over the amplitude asked for, dB re that at the resonance, for a sine of `level`
/// · full scale.
fn felt_db(profile: &DeviceProfile, quantity: Quantity, rate: f64, f: f64, level: f64, protect: bool) -> f64 {
    let gain = |f: f64| {
        let equaliser = Equaliser::new(profile, quantity, rate).unwrap();
        let protection = Protection::new(profile, rate).unwrap();
        let model = DeviceModel::new(profile, quantity, rate).unwrap();
        let (mut eq, mut safe, mut device) =
            (EqualiserState::default(), ProtectionState::default(), DeviceState::default());
        amplitude(f, rate, |x| {
            let mut drive = eq.tick(&equaliser, level * x);
            if protect {
                drive = safe.tick(&protection, drive);
            }
            device.tick(&model, drive)
        })
    };
    20.0 * (gain(f) / gain(profile.resonance_hz)).log10()
}

#[test]
fn an_equalised_lra_is_flat_within_3_db_to_400_hz() {
    for rate in RATES_HZ {
        for quantity in [Quantity::Displacement, Quantity::Acceleration] {
            let mut spread = (0.0_f64, 0.0_f64);
            for f in [60.0, 75.0, 100.0, 130.0, 150.0, 165.0, 175.0, 190.0, 230.0, 300.0, 350.0, 400.0] {
                // 2 % of the resonance's full scale: inside every limit over the whole band.
                let db = felt_db(&DeviceProfile::LRA_170, quantity, rate, f, 0.02, true);
                spread = (spread.0.min(db), spread.1.max(db));
            }
            println!("{rate} Hz, {quantity:?}: {spread:.2?} dB");
            assert!(spread.0 > -1.5 && spread.1 < 1.5, "{rate} Hz, {quantity:?}: {spread:?} dB");
        }
    }
}

#[test]
fn every_preset_is_flat_within_3_db_over_its_own_band() {
    for profile in PROFILES {
        let [low, high] = profile.band_hz;
        for i in 0..=8 {
            let f = low * (high / low).powf(f64::from(i) / 8.0);
            let db = felt_db(&profile, Quantity::Displacement, 48_000.0, f, 0.01, false);
            assert!(db.abs() < 3.0, "{f} Hz: {db} dB");
        }
    }
}

#[test]
fn without_the_equaliser_the_lra_is_not_flat() {
    let model = DeviceModel::new(&DeviceProfile::LRA_170, Quantity::Displacement, 48_000.0).unwrap();
    let gain = |f: f64| {
        let mut device = DeviceState::default();
        20.0 * amplitude(f, 48_000.0, |x| device.tick(&model, x)).log10()
    };
    assert!(gain(170.0) - gain(60.0) > 15.0 && gain(170.0) - gain(400.0) > 25.0);
}

#[test]
fn no_signal_drives_the_device_beyond_its_limits() {
    let mut rng = Rng::new(11);
    for profile in PROFILES {
        for rate in [22_050.0, 44_100.0, 192_000.0] {
            // A short thermal time, so that heat is tried as well.
            let profile = DeviceProfile { thermal_time_s: 0.1, rated_drive: 0.4, ..profile };
            let protection = Protection::new(&profile, rate).unwrap();
            let equaliser = Equaliser::new(&profile, Quantity::Displacement, rate).unwrap();
            let model = DeviceModel::new(&profile, Quantity::Displacement, rate).unwrap();
            let share = 1.0 - (-1.0 / (0.1 * rate)).exp();
            for kind in 0..5 {
                let (mut safe, mut eq) = (ProtectionState::default(), EqualiserState::default());
                let (mut device, mut heat, mut largest) = (DeviceState::default(), 0.0, 0.0_f64);
                for n in 0..(0.6 * rate) as usize {
                    let t = n as f64 / rate;
                    let x = match kind {
                        0 => 30.0 * rng.normal(),
                        1 => 20.0 * (2.0 * PI * profile.resonance_hz * t).sin(),
                        2 => 50.0 * (2.0 * PI * (20.0 + 900.0 * t) * t).sin(),
                        3 if n % 997 == 0 => 1e5,
                        3 => 0.0,
                        _ => {
                            if ((t * profile.resonance_hz * 2.0) as u64).is_multiple_of(2) {
                                1e3
                            } else {
                                -1e3
                            }
                        }
                    };
                    let drive = safe.tick(&protection, if kind == 4 { x } else { eq.tick(&equaliser, x) });
                    heat += share * (drive * drive - heat);
                    let felt = device.tick(&model, drive).abs();
                    largest = largest.max(felt);
                    let swing_m = device.amplitude_m();
                    let inside = swing_m.max(felt) <= profile.excursion_m * (1.0 + 1e-9);
                    let as_modelled = (safe.amplitude_m() - swing_m).abs() < 1e-12;
                    assert!(inside && as_modelled, "kind {kind}, sample {n}: {swing_m} m");
                    assert!(drive.abs() <= 1.0 + 1e-12 && heat <= 0.16 + 1e-9, "kind {kind}, sample {n}");
                }
                assert!(kind == 3 || largest > 0.005 * profile.excursion_m, "the limiter does not silence");
            }
        }
    }
}

#[test]
fn a_signal_inside_the_limits_passes_bit_for_bit() {
    let protection = Protection::new(&DeviceProfile::LRA_170, 44_100.0).unwrap();
    let mut state = ProtectionState::default();
    for n in 0..20_000 {
        let drive = 0.9 * (2.0 * PI * 170.0 * f64::from(n) / 44_100.0).sin();
        assert_eq!(state.tick(&protection, drive), drive);
    }
    assert!(state.gain() == 1.0 && state.amplitude_m() < DeviceProfile::LRA_170.excursion_m);
}

#[test]
fn an_overdriven_sine_stays_nearly_a_sine() {
    let (rate, profile) = (44_100.0, DeviceProfile::LRA_170);
    let protection = Protection::new(&profile, rate).unwrap();
    let mut state = ProtectionState::default();
    let wave = |n: f64| 1.6 * (2.0 * PI * 170.0 * n / rate).sin();
    let y: Vec<f64> = (0..44_100).map(|n| state.tick(&protection, wave(f64::from(n)))).collect();
    let tail = &y[33_075..];
    let (mut re, mut im, mut square) = (0.0, 0.0, 0.0);
    for (n, y) in tail.iter().enumerate() {
        let angle = 2.0 * PI * 170.0 * (n + 33_075) as f64 / rate;
        re += y * angle.sin() * 2.0 / tail.len() as f64;
        im += y * angle.cos() * 2.0 / tail.len() as f64;
        square += y * y / tail.len() as f64;
    }
    let distortion = (1.0 - 0.5 * (re * re + im * im) / square).max(0.0).sqrt();
    println!("distortion of a sine 4 dB over: {:.2} %", 100.0 * distortion);
    assert!(distortion < 0.1, "{distortion}");
}

fn run(channel: &Channel, control: &ChannelControl, input: &[f64], block: usize) -> Vec<f32> {
    let (mut state, mut out) = (ChannelState::default(), vec![0.0; input.len()]);
    for (x, y) in input.chunks(block).zip(out.chunks_mut(block)) {
        state.run(channel, control, x, y);
    }
    out
}

#[test]
fn full_scale_is_one_and_any_split_gives_the_same_bits() {
    let mut rng = Rng::new(12);
    let input: Vec<f64> = (0..6_000).map(|_| 3e-5 * rng.normal()).collect();
    let plain = Channel::new(&ChannelOptions::default(), 44_100.0).unwrap();
    let out = run(&plain, &ChannelControl::default(), &input, 6_000);
    assert!(input.iter().zip(&out).all(|(x, y)| (x * 1e4 - f64::from(*y)).abs() < 1e-7));
    let lra = Some(DeviceProfile::LRA_170);
    let options =
        ChannelOptions { equalise: lra, limit: lra, soft_start_s: 0.05, ..ChannelOptions::default() };
    let full = Channel::new(&options, 44_100.0).unwrap();
    assert!((full.group_delay_s() - 2_f64.sqrt() / (2.0 * PI * 600.0)).abs() < 1e-6);
    let whole = run(&full, &ChannelControl { gain: 0.7, mute: false }, &input, 6_000);
    for block in [1, 7, 64, 1000, 4096] {
        assert_eq!(whole, run(&full, &ChannelControl { gain: 0.7, mute: false }, &input, block), "{block}");
    }
}

#[test]
fn soft_start_mute_and_gain_move_without_a_step() {
    let options = ChannelOptions { full_scale: 1.0, soft_start_s: 0.1, ..ChannelOptions::default() };
    let channel = Channel::new(&options, 44_100.0).unwrap();
    let mut state = ChannelState::default();
    let mut out = vec![0.0; 44_100];
    let ones = vec![1.0; 44_100];
    state.run(&channel, &ChannelControl::default(), &ones, &mut out);
    assert!(out[0] < 1e-3 && (out[2_205] - 0.5).abs() < 1e-3 && out[4_500] == 1.0);
    for (control, end) in [
        (ChannelControl { gain: 2.0, mute: false }, 2.0),
        (ChannelControl { gain: 2.0, mute: true }, 0.0),
        (ChannelControl { gain: 0.5, mute: false }, 0.5),
        (ChannelControl { gain: f64::NAN, mute: false }, 0.0),
    ] {
        let before = *out.last().unwrap();
        state.run(&channel, &control, &ones, &mut out);
        let steps = out.windows(2).map(|w| (w[1] - w[0]).abs()).fold((out[0] - before).abs(), f32::max);
        assert!(*out.last().unwrap() == end && steps < 3e-3, "{end}: step {steps}");
    }
}

#[test]
fn silence_in_is_exactly_silence_out_and_rubbish_does_not_stay() {
    let lra = Some(DeviceProfile::LRA_170);
    let options = ChannelOptions { equalise: lra, limit: lra, ..ChannelOptions::default() };
    let channel = Channel::new(&options, 44_100.0).unwrap();
    let mut input = vec![0.0; 30_000];
    input[10] = 1e-4;
    input[20] = f64::NAN;
    input[30] = f64::INFINITY;
    input[40] = 1e300;
    let out = run(&channel, &ChannelControl::default(), &input, 64);
    assert!(out.iter().all(|y| y.is_finite() && y.abs() <= 1.0));
    assert!(out[11] != 0.0 && out[29_000..].iter().all(|y| *y == 0.0));
}

#[test]
fn the_audio_limiter_keeps_its_ceiling_and_passes_quiet_sound() {
    let limiter = PeakLimiter::new(0.97, 44_100.0).unwrap();
    let mut rng = Rng::new(13);
    let mut state = PeakLimiterState::default();
    let mut block: Vec<f32> = (0..5_000).map(|_| 0.2 * (rng.uniform() as f32 - 0.5)).collect();
    let quiet = block.clone();
    state.run(&limiter, &mut block);
    assert_eq!(quiet, block);
    let mut block: Vec<f32> = (0..50_000).map(|_| 3.0 * rng.normal() as f32).collect();
    block[7] = f32::NAN;
    block[9] = f32::INFINITY;
    block[11] = 1e38;
    state.run(&limiter, &mut block);
    assert!(block.iter().all(|y| y.abs() <= limiter.ceiling()));
    // It recovers.
    let mut later = vec![0.1_f32; 88_200];
    state.run(&limiter, &mut later);
    assert!((later[88_199] - 0.1).abs() < 1e-3);
}

/// Remainder of a sine once its own frequency is taken out, dB of it, from `skip` s on.
fn distortion_db(frequency_hz: f64, over_db: f64, rate_hz: f64, skip_s: f64) -> f64 {
    let limiter = PeakLimiter::new(1.0, rate_hz).unwrap();
    let mut state = PeakLimiterState::default();
    let amplitude = 10f64.powf(over_db / 20.0);
    let phase = |n: usize| 2.0 * PI * frequency_hz * n as f64 / rate_hz;
    // Whole periods to measure, to within a sample's share.
    let skip = (skip_s * rate_hz) as usize;
    let count = ((0.5 * frequency_hz).round() / frequency_hz * rate_hz).round() as usize;
    let mut block: Vec<f32> = (0..skip + count).map(|n| (amplitude * phase(n).sin()) as f32).collect();
    state.run(&limiter, &mut block);
    assert!(block.iter().all(|y| y.abs() <= 1.0), "{frequency_hz} Hz passes full scale");
    let heard: Vec<f64> = block[skip..].iter().map(|y| f64::from(*y)).collect();
    // Least squares on sine and cosine: exact whatever the number of periods.
    let (mut ss, mut sc, mut cc, mut ys, mut yc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (n, y) in heard.iter().enumerate() {
        let (s, c) = phase(n + skip).sin_cos();
        (ss, sc, cc, ys, yc) = (ss + s * s, sc + s * c, cc + c * c, ys + y * s, yc + y * c);
    }
    let det = ss * cc - sc * sc;
    let (a, b) = ((ys * cc - yc * sc) / det, (yc * ss - ys * sc) / det);
    let tone = |n: usize| a * phase(n).sin() + b * phase(n).cos();
    let left: f64 = heard.iter().enumerate().map(|(n, y)| (y - tone(n + skip)).powi(2)).sum();
    let whole: f64 = heard.iter().enumerate().map(|(n, _)| tone(n + skip).powi(2)).sum();
    10.0 * (left / whole).log10()
}

#[test]
fn a_sine_far_over_full_scale_is_turned_down_and_not_bent() {
    for rate_hz in [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0] {
        let tones = [31.0, 50.0, 100.0, 440.0, 500.0, 997.0, 3_000.0, 7_351.0];
        // With less than 8 samples a period the samples' own peaks beat: next to a third, a
        // quarter, two fifths of the rate for long.
        let beating = [rate_hz / 3.0 + 1.0, 0.25 * rate_hz - 0.5, 0.25 * rate_hz + 7.0, 0.4 * rate_hz + 0.7];
        for frequency_hz in tones.into_iter().chain(beating).filter(|f| *f <= 0.45 * rate_hz) {
            for over_db in [0.5, 3.5, 9.5, 20.0, 40.0] {
                let bound_db = if 8.0 * frequency_hz <= rate_hz { -80.0 } else { -50.0 };
                let after_s = if 8.0 * frequency_hz <= rate_hz { 0.1 } else { 0.6 };
                let steady = distortion_db(frequency_hz, over_db, rate_hz, after_s);
                assert!(steady < bound_db, "{frequency_hz} Hz, +{over_db} dB, {rate_hz} Hz: {steady:.1} dB");
            }
        }
    }
}

#[test]
fn impossible_designs_are_refused_by_name() {
    let lra = DeviceProfile::LRA_170;
    let field = |p: DeviceProfile| Protection::new(&p, 44_100.0).unwrap_err().field;
    assert_eq!(field(DeviceProfile { quality: 0.4, ..lra }), "quality");
    assert_eq!(field(DeviceProfile { resonance_hz: 30_000.0, ..lra }), "resonance_hz");
    assert_eq!(field(DeviceProfile { excursion_m: f64::NAN, ..lra }), "excursion_m");
    assert_eq!(field(DeviceProfile { band_hz: [100.0, 50.0], ..lra }), "band_hz");
    assert_eq!(field(DeviceProfile { rated_drive: 2.0, ..lra }), "rated_drive");
    assert_eq!(ContactOutput::new(Quantity::Displacement, -1.0, 44_100.0).unwrap_err().field, "highpass_hz");
    let options = ChannelOptions { full_scale: 0.0, ..ChannelOptions::default() };
    assert_eq!(Channel::new(&options, 44_100.0).unwrap_err().field, "full_scale");
    assert_eq!(PeakLimiter::new(-1.0, 44_100.0).unwrap_err().field, "ceiling");
}
