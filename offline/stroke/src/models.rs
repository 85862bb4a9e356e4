//! Published models of strokes: XML files of auto-regressive filters over speed and force, as
//! haptic texture toolkits write them (Culbertson, Lopez Delgado, Kuchenbecker 2014).
//!
//! ```text
//! P(f) = 2 σ² g² |MA(e^(−iω)) / AR(e^(−iω))|² / rate
//! ```
//! A model is one window. Copies at the border of the measured speeds and forces, and those without
//! motion or force, are left out. A few poles fitted over strokes whose speed wanders hold no line.

use crate::StrokeError;
use crate::recording::Window;
use asperity_fft::num_complex::Complex;
use std::f64::consts::PI;

/// Models of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Models {
    /// Name of the material, where the file says one.
    pub material: Option<String>,
    /// Coefficient of friction, where the file says one.
    pub friction: Option<f64>,
    /// A window for each model.
    pub windows: Vec<Window>,
}

/// Distance of two bins, Hz.
const BIN_HZ: f64 = 1.0;
/// Deviation of a model's level from what its neighbours say, dB: speed and force of a hand wander.
pub const LEVEL_DB: f64 = 2.7;
/// Time that a model stands for, s: one level of it errs by 1.6 dB in a third octave.
const STANDS_FOR_S: f64 = 0.6;

/// Reads models.
///
/// # Errors
/// When the file is not XML, holds no model, or a number that cannot be.
pub fn read(text: &str) -> Result<Models, StrokeError> {
    let refused = |what: String, expected: &str| StrokeError::new("models", what, expected);
    let document = roxmltree::Document::parse(text)
        .map_err(|error| refused(error.to_string(), "must be XML of AR or ARMA models"))?;
    let root = document.root_element();
    let word = |node: roxmltree::Node<'_, '_>, name: &str| -> Option<String> {
        let found = node.children().find(|child| child.has_tag_name(name))?;
        found.text().map(|text| text.trim().to_owned())
    };
    let number = |node, name: &str| word(node, name).and_then(|text| text.parse::<f64>().ok());
    let factor = match word(root, "SpeedUnits").as_deref() {
        None | Some("mm/s") => 1e-3,
        Some("m/s") => 1.0,
        Some(other) => return Err(refused(format!("SpeedUnits {other:?}"), "must be mm/s or m/s")),
    };
    if let Some(units) = word(root, "AccelUnits").filter(|units| !matches!(units.as_str(), "m/s^2" | "m/s2"))
    {
        return Err(refused(format!("AccelUnits {units:?}"), "must be m/s^2"));
    }
    let rate_hz = number(root, "SampleRate").unwrap_or(1000.0);
    if !(100.0..=1e6).contains(&rate_hz) {
        return Err(refused(format!("SampleRate {rate_hz}"), "must be 100 to 1000000 Hz"));
    }
    let coefficients = |node: roxmltree::Node<'_, '_>, name: &str| -> Option<Vec<f64>> {
        let list = node.children().find(|child| child.has_tag_name(name))?;
        let values = list.children().filter(|child| child.is_element());
        values.map(|value| value.text()?.trim().parse().ok()).collect()
    };
    let mut known: Vec<Vec<f64>> = Vec::new();
    let mut windows = Vec::new();
    for (index, model) in root.children().filter(|child| child.has_tag_name("model")).enumerate() {
        let missing =
            |name: &str| refused(format!("model {} has no {name}", index + 1), "must be an AR or ARMA model");
        let ar = coefficients(model, "ARcoeff").ok_or_else(|| missing("ARcoeff"))?;
        let ma = coefficients(model, "MAcoeff").unwrap_or_else(|| vec![1.0]);
        let variance = number(model, "var").ok_or_else(|| missing("var"))?;
        let gain =
            number(model, "gain").filter(|_| model.children().any(|child| child.has_tag_name("MAcoeff")));
        let speed_m_s = factor * number(model, "speedMod").ok_or_else(|| missing("speedMod"))?;
        let force_n = number(model, "forceMod").ok_or_else(|| missing("forceMod"))?;
        if speed_m_s <= 0.0 || force_n <= 0.0 || variance <= 0.0 || known.contains(&ar) {
            continue;
        }
        let evaluate = |filter: &[f64], turn: f64| -> Complex<f64> {
            filter.iter().enumerate().map(|(k, c)| Complex::from_polar(*c, -turn * k as f64)).sum()
        };
        let level = 2.0 * variance * gain.unwrap_or(1.0).powi(2) / rate_hz;
        let density = (0..(0.5 * rate_hz / BIN_HZ) as usize)
            .map(|i| {
                let turn = 2.0 * PI * i as f64 * BIN_HZ / rate_hz;
                level * evaluate(&ma, turn).norm_sqr() / evaluate(&ar, turn).norm_sqr().max(1e-30)
            })
            .collect();
        known.push(ar);
        windows.push(Window {
            stroke: windows.len(),
            speed_m_s,
            force_n,
            rate_hz,
            density,
            bin_hz: BIN_HZ,
            stands_for_s: STANDS_FOR_S,
            response: Vec::new(),
        });
    }
    if windows.is_empty() {
        return Err(refused(
            "no model of a moving, pressed probe".into(),
            "must hold `model` with ARcoeff, var, speedMod, forceMod",
        ));
    }
    Ok(Models { material: word(root, "material"), friction: number(root, "mu"), windows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn xml_cut_off_at_a_lines_end_is_refused_in_one_line() {
        let refused = read("<modelSet><model/\n</modelSet>").unwrap_err().to_string();
        assert!(refused.starts_with("models: ") && refused.lines().count() == 1, "{refused}");
    }
}
