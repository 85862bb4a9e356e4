//! Makes `cli/assets/tile_strike.wav`, the recording that `asperity demo` fits: not a recording of
//! anything, but made by this project to have what recordings have. A ceramic-tile-like body (24
//! modes, damping d = 9 + 3.2e-8 ω², two pairs a few hertz apart) is struck by 0.7 ms of half-sine
//! force after 120 ms of pre-roll; a room (decaying noise, T60 0.35 s, 34 dB down) answers, and
//! microphone noise lies 62 dB under the peak. 44.1 kHz, 16 bit, mono, 1.8 s.
//!
//! `cargo run --release -p asperity-fit --example tile_strike -- cli/assets/tile_strike.wav`

use asperity_dsp::rng::Rng;
use std::f64::consts::PI;

const RATE_HZ: f64 = 44_100.0;
const SECONDS: f64 = 1.8;
const PRE_ROLL_S: f64 = 0.12;
const CONTACT_S: f64 = 0.0007;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: tile_strike OUT.wav")?;
    let mut rng = Rng::new(2026);
    let count = (RATE_HZ * SECONDS) as usize;
    let dry = strike(&mut rng, count);
    let room = room(&dry, &mut rng);
    let mut sound: Vec<f64> = dry.iter().zip(&room).map(|(dry, room)| dry + room).collect();
    let peak = sound.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    for x in &mut sound {
        *x = 0.8 * *x / peak + 0.8 * 10.0_f64.powf(-62.0 / 20.0) * rng.normal();
    }
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: RATE_HZ as u32,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(path, spec)?;
    for x in sound {
        writer.write_sample((32_767.0 * x).round().clamp(-32_768.0, 32_767.0) as i16)?;
    }
    writer.finalize()?;
    Ok(())
}

/// The body's answer to the contact force.
fn strike(rng: &mut Rng, count: usize) -> Vec<f64> {
    let mut out = vec![0.0; count];
    let force: Vec<f64> = (0..(CONTACT_S * RATE_HZ) as usize)
        .map(|n| (PI * (n as f64 + 0.5) / (CONTACT_S * RATE_HZ)).sin())
        .collect();
    let onset = (PRE_ROLL_S * RATE_HZ) as usize;
    for k in 0..24 {
        // A free square plate's spacing, detuned; every eighth mode has a twin.
        let twin = k % 8 == 7;
        let place = f64::from(if twin { k - 1 } else { k });
        let frequency_hz = 790.0
            * (1.0 + 0.62 * place + 0.012 * place * place)
            * (1.0 + 0.01 * rng.normal() * f64::from(u8::from(!twin)))
            + if twin { 3.5 } else { 0.0 };
        let omega = 2.0 * PI * frequency_hz;
        let decay_per_s = (9.0 + 3.2e-8 * omega * omega) * (0.25 * rng.normal()).exp();
        let gain = (0.4 * rng.normal()).exp() / (1.0 + 0.35 * place);
        let (mut re, mut im) = (0.0, 0.0);
        let (pole_re, pole_im) = (
            (-decay_per_s / RATE_HZ).exp() * (omega / RATE_HZ).cos(),
            (-decay_per_s / RATE_HZ).exp() * (omega / RATE_HZ).sin(),
        );
        for (n, x) in out[onset..].iter_mut().enumerate() {
            (re, im) = (re * pole_re - im * pole_im, re * pole_im + im * pole_re);
            re += force.get(n).copied().unwrap_or(0.0) * gain;
            *x += im;
        }
    }
    out
}

/// Sparse late echoes of what is struck: noise that decays, convolved coarsely with the strike's
/// energy.
fn room(dry: &[f64], rng: &mut Rng) -> Vec<f64> {
    let mut out = vec![0.0; dry.len()];
    for _ in 0..220 {
        let delay_s = 0.004 + 0.4 * rng.uniform();
        let gain = 10.0_f64.powf(-34.0 / 20.0) * (-6.908 * delay_s / 0.35).exp() * rng.normal();
        let delay = (delay_s * RATE_HZ) as usize;
        for (x, d) in out[delay..].iter_mut().zip(dry) {
            *x += gain * d;
        }
    }
    out
}
