//! Modal tables as other projects publish them, as modes files.
//!
//! None of them says what strike its amplitudes answer to, so the strike is assumed; and none holds
//! phases, so every mode starts as a sine, without a step.

use asperity::{ModalModel, Mode};
use serde_json::Value;

/// The strike that published amplitudes are taken to answer to, N·s: the default of `asperity fit`.
pub const STRIKE_N_S: f64 = 0.01;
/// Fundamental given to tables of bare ratios, Hz. Assumed.
pub const FUNDAMENTAL_HZ: f64 = 440.0;
/// 60 dB decay time given to tables without decays, s. Assumed.
pub const DECAY_TIME_S: f64 = 0.5;
/// Longest believable 60 dB decay time, s: fits of short recordings contain outliers up to 120 s.
pub const LONGEST_DECAY_S: f64 = 10.0;
/// Rate at which the pole radii of four-mode tables were tuned, Hz.
const POLE_RATE_HZ: f64 = 44_100.0;

/// Amplitude falls by 60 dB in this time: decay per second.
fn decay_per_s(t60_s: f64) -> f64 {
    1000f64.ln() / t60_s.min(LONGEST_DECAY_S)
}

fn list(value: &Value, key: &str) -> Option<Vec<f64>> {
    value.get(key)?.as_array()?.iter().map(Value::as_f64).collect()
}

fn needed(value: &Value, key: &str) -> Result<Vec<f64>, String> {
    list(value, key).ok_or_else(|| format!("no list of numbers \"{key}\""))
}

fn model(name: &str, modes: Vec<Mode>) -> Result<(String, ModalModel), String> {
    let mut model = ModalModel::new(modes, STRIKE_N_S).map_err(|error| format!("{name}: {error}"))?;
    model.source = name.into();
    Ok((name.into(), model))
}

fn mode(frequency_hz: f64, decay_per_s: f64, amplitude: f64) -> Mode {
    Mode { frequency_hz, decay_per_s, amplitude, phase_rad: 0.0 }
}

/// Modes fitted to recorded impacts: `cf` Hz, `op` dB, `rt` 60 dB decay time in s.
pub fn fitted(name: &str, text: &str) -> Result<(String, ModalModel), String> {
    let table: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let (cf, op, rt) = (needed(&table, "cf")?, needed(&table, "op")?, needed(&table, "rt")?);
    // Published levels lie near −50 dB; only their differences mean something. The loudest becomes
    // 0.1.
    let loudest = op.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let modes = cf.iter().zip(&op).zip(&rt);
    let modes = modes
        .map(|((cf, op), rt)| mode(*cf, decay_per_s(*rt), 0.1 * 10f64.powf((op - loudest) / 20.0)))
        .collect();
    model(name, modes)
}

/// Bodies with lists `freq_hz`, `gain`, `t60_s`, or bars and bells with `gains` per place of the
/// strike and frequencies or ratios; bare ratios ring at [`FUNDAMENTAL_HZ`] for [`DECAY_TIME_S`].
/// Zeros that hold a place in a list are left out.
pub fn bodies(text: &str) -> Result<Vec<(String, ModalModel)>, String> {
    let tables: Vec<Value> = serde_json::from_str(text).map_err(|error| error.to_string())?;
    tables.iter().map(body).collect()
}

fn body(table: &Value) -> Result<(String, ModalModel), String> {
    let name = table["name"].as_str().ok_or("an entry has no name")?;
    if table.get("pole_radius").is_some() {
        return model(name, four_modes(table)?);
    }
    let frequency_hz = list(table, "freq_hz")
        .or_else(|| {
            let ratios = list(table, "freq_ratio").or_else(|| list(table, "ratio"))?;
            Some(ratios.iter().map(|ratio| ratio * FUNDAMENTAL_HZ).collect())
        })
        .ok_or_else(|| format!("{name}: no frequencies"))?;
    let first_place: Option<Vec<f64>> =
        table["gains"].get(0).and_then(|g| g.as_array()?.iter().map(Value::as_f64).collect());
    let gains = list(table, "gain").or(first_place);
    let t60_s = list(table, "t60_s");
    let lowest_hz = frequency_hz.iter().copied().filter(|hz| *hz > 0.0).fold(f64::INFINITY, f64::min);
    let modes = frequency_hz.iter().enumerate().filter(|(_, hz)| **hz > 0.0).map(|(i, hz)| {
        let gain = gains.as_ref().and_then(|gains| gains.get(i)).copied();
        // High modes of real bodies die sooner.
        let t60_s = t60_s.as_ref().and_then(|t| t.get(i)).copied().unwrap_or(DECAY_TIME_S * lowest_hz / hz);
        mode(*hz, decay_per_s(t60_s), 0.1 * gain.unwrap_or(lowest_hz / hz))
    });
    model(name, modes.collect())
}

/// Ratio (negative: fixed Hz), pole radius at the tuning rate, gain.
fn four_modes(table: &Value) -> Result<Vec<Mode>, String> {
    let ratios = needed(table, "ratio_or_negative_fixed_hz")?;
    let (radii, gains) = (needed(table, "pole_radius")?, needed(table, "gain")?);
    let modes = ratios.iter().zip(&radii).zip(&gains).map(|((ratio, radius), gain)| {
        let hz = if *ratio < 0.0 { -ratio } else { ratio * FUNDAMENTAL_HZ };
        mode(hz, -radius.ln() * POLE_RATE_HZ, *gain)
    });
    Ok(modes.collect())
}
