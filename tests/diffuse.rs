//! Bands of noise, as bodies play them.

use crate::common::*;
use asperity::*;

/// Sound of impacts on a body from silence, in blocks.
fn struck(model: &ModalModel, seed: u64, impacts: &[(f64, f64)], seconds: f64, block: usize) -> Vec<f32> {
    let config = Config { seed, culling: None, ..Config::default() };
    let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let body = scene.add_body(Body::new(model.clone()).of(Material::STEEL)).unwrap();
    for (time_s, speed_m_s) in impacts {
        let striker = Striker::new(0.01, 0.005, Material::STEEL);
        scene.impact(*time_s, Impact::new(body, *speed_m_s, striker)).unwrap();
    }
    let mut out = vec![0.0; (seconds * 44_100.0) as usize];
    for out in out.chunks_mut(block) {
        renderer.render_audio(out);
    }
    out
}
