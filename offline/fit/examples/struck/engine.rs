//! One strike of a body by the engine itself.

use asperity::{Config, ContactEvent, Impact, Material, ModalModel, Residual};
use asperity_dsp::mode::Mode;

/// The impulse the modes are the answer to, N·s.
const IMPULSE_N_S: f64 = 0.01;
/// Fast and blunt, and both as hard as the engine allows: a contact of a tenth of a microsecond, a
/// pure impulse.
const SPEED_M_S: f64 = 100.0;
const RADIUS_M: f64 = 10.0;
const HARD: Material = Material::new(1e13, 0.3, 7850.0);

/// What the renderer plays when `modes` are struck once, from `before_s` before the strike on,
/// `count` samples and twice `before_s` more.
pub fn struck(modes: &[Mode], burst: Option<&[f32]>, rate_hz: f64, count: usize, before_s: f64) -> Vec<f64> {
    let before = (before_s * rate_hz).round() as usize;
    let mut out = vec![0.0; count + 2 * before];
    let config = Config { sample_rate_hz: rate_hz, ..Config::default() };
    let Ok(asperity::Engine { mut scene, mut renderer, .. }) = config.build() else { return out };
    let Ok(model) = ModalModel::new(modes.to_vec(), IMPULSE_N_S) else { return out };
    let residual = burst.map(|samples| Residual { sample_rate_hz: rate_hz, samples: samples.to_vec() });
    let body = model
        .with_residual(residual, 1.0)
        .ok()
        .and_then(|model| scene.add_body(asperity::Body::new(model).material(HARD)).ok());
    let Some(body) = body else { return out };
    let impact = Impact {
        body,
        other: None,
        speed_m_s: SPEED_M_S,
        mass_kg: IMPULSE_N_S / (2.0 * SPEED_M_S),
        radius_m: RADIUS_M,
        striker: HARD,
        restitution: 1.0,
        position: 0,
        ..Impact::on(body)
    };
    if scene.report(before as f64 / rate_hz, ContactEvent::Impact(impact)).is_err() {
        return out;
    }
    let mut block = [0.0_f32; 256];
    let latency = renderer.latency_samples();
    let mut played = Vec::with_capacity(out.len() + latency + block.len());
    while played.len() < out.len() + latency {
        renderer.render(&mut [], &mut [&mut block]);
        played.extend(block.iter().map(|&x| f64::from(x)));
    }
    out.copy_from_slice(&played[latency..latency + count + 2 * before]);
    out
}
