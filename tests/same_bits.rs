//! Bits of a whole engine on the portable level: heard and felt are the same on every processor.
//!
//! The figures are of x86-64; `.ci/run` renders them again in WebAssembly and, where it can, on
//! 64-bit ARM. Nothing here calls a function of the standard library whose digits are the
//! platform's.

use asperity::{
    ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Extent, Impact, Isa, ModalModel, Mode,
    Surface, Wrap,
};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;

const SIDE_M: f64 = 0.1;

/// A map of whole numbers: what a hash of each texel leaves.
fn map() -> HeightMap {
    let texel = |x: usize, y: usize| ((x * 7919 + y * 104_729 + x * y * 13) % 256) as f64 / 255.0;
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 4e-5 };
    HeightMap::new(&Raster::from_fn(128, 128, texel), extent, Wrap::Repeat)
        .unwrap()
        .with_roughness(0.6)
        .unwrap()
}

fn body() -> ModalModel {
    let mode = |i: u32| {
        let (i, phase_rad) = (f64::from(i), 0.1 * f64::from(i));
        Mode {
            frequency_hz: 211.0 + 397.0 * i,
            decay_per_s: 5.0 + 3.0 * i,
            amplitude: 1.0 / (3.0 + i),
            phase_rad,
        }
    };
    ModalModel::new((0..23).map(mode).collect(), 0.01).unwrap()
}

/// Felt and heard of a strike, a stroke that begins, turns and ends, and what rings after it.
fn render() -> [Vec<f32>; 2] {
    let config = Config { kernel: Some(Isa::Portable), ..Config::default() };
    let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let body = scene.add_body(body()).unwrap();
    let surface = scene.add_surface(Surface::new(map(), SIDE_M, SIDE_M).unwrap().body(body)).unwrap();
    scene.report(0.01, ContactEvent::Impact(Impact::on(body))).unwrap();
    let sample = |n: i32| {
        let t = f64::from(n) / 60.0;
        let (u, speed) = if n < 20 { (t, 1.0) } else { (2.0 * 20.0 / 60.0 - t, -1.0) };
        ContactSample::new([0.1 + u, 0.5 + 0.3 * u], 0.8).sliding([speed * SIDE_M, 0.3 * speed * SIDE_M])
    };
    scene.report(0.02, ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample(0))).unwrap();
    for n in 1..30 {
        scene.report(0.02 + f64::from(n) / 60.0, ContactEvent::moved(ContactId(1), sample(n))).unwrap();
    }
    scene.report(0.53, ContactEvent::end(ContactId(1))).unwrap();
    let (mut haptic, mut audio) = (vec![0.0; 33_075], vec![0.0; 33_075]);
    for (haptic, audio) in haptic.chunks_mut(128).zip(audio.chunks_mut(128)) {
        renderer.render(&mut [haptic], &mut [audio]);
    }
    [haptic, audio]
}

/// FNV-1a.
fn bits(samples: &[f32]) -> u64 {
    samples
        .iter()
        .fold(0xCBF2_9CE4_8422_2325, |bits, x| (bits ^ u64::from(x.to_bits())).wrapping_mul(0x0100_0000_01B3))
}

#[test]
fn a_portable_engine_has_the_same_bits_on_every_processor() {
    let [haptic, audio] = render();
    assert!(
        haptic.iter().any(|x| x.abs() > 1e-4) && audio.iter().any(|x| x.abs() > 1e-4),
        "nothing to compare"
    );
    let found = [bits(&haptic), bits(&audio)];
    assert_eq!(found, [0x1884_D181_B9BC_8FDD, 0x1925_CB8B_238E_E8F6], "{found:#018x?}");
}
