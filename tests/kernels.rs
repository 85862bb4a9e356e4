//! `Config::kernel` pins the instruction set: what it names is what runs, on any processor that has
//! it.

use crate::common;

use asperity::dsp::simd::Level;
use asperity::{ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Impact, Isa};
use common::{bar, grating};

/// Heard and felt of one stroke and one strike, from an engine built with this kernel, or with the
/// fastest.
fn render(kernel: Option<Isa>, block: usize) -> (Isa, Vec<f32>, Vec<f32>) {
    let Engine { mut scene, mut renderer, .. } = Config { kernel, ..Config::default() }.build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(grating(2e-3, 5e-5).body(body)).unwrap();
    scene.report(0.01, ContactEvent::Impact(Impact::on(body))).unwrap();
    let sample = |t: f64| ContactSample::new([0.1 + t, 0.5], 1.0).sliding([0.14, 0.0]);
    let begin = ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample(0.0));
    scene.report(0.02, begin).unwrap();
    for step in 1..30 {
        let t = f64::from(step) / 60.0;
        scene.report(0.02 + t, ContactEvent::moved(ContactId(1), sample(t))).unwrap();
    }
    let (mut haptic, mut audio) = (vec![0.0; 22_050], vec![0.0; 22_050]);
    for (haptic, audio) in haptic.chunks_mut(block).zip(audio.chunks_mut(block)) {
        renderer.render(&mut [haptic], &mut [audio]);
    }
    (renderer.kernel(), haptic, audio)
}

fn error_db(found: &[f32], exact: &[f32]) -> f64 {
    let square = |x: f64| x * x;
    let error: f64 = found.iter().zip(exact).map(|(a, b)| square(f64::from(*a) - f64::from(*b))).sum();
    10.0 * (error / exact.iter().map(|x| square(f64::from(*x))).sum::<f64>()).log10()
}

#[test]
fn a_pinned_kernel_runs_and_gives_its_familys_bits() {
    let portable = render(Some(Isa::Portable), 128);
    let fused: Vec<_> = Isa::ALL
        .into_iter()
        .filter(|isa| *isa != Isa::Portable && Level::find(*isa).is_some())
        .map(|isa| render(Some(isa), 128))
        .collect();
    assert_eq!(portable.0, Isa::Portable);
    assert!(portable.2.iter().any(|x| *x != 0.0) && portable.1.iter().any(|x| *x != 0.0));
    for (isa, haptic, audio) in &fused {
        // Every family with a fused multiply-add gives the same bits, in any blocks.
        assert!((haptic, audio) == (&fused[0].1, &fused[0].2), "{isa:?}");
        assert!((haptic, audio) == (&render(Some(*isa), 441).1, &render(Some(*isa), 441).2), "{isa:?}");
        // The plain one rounds apart: other bits, the same sound.
        assert!(*audio != portable.2, "{isa:?} runs as the plain one does");
        let db = error_db(audio, &portable.2);
        assert!(db < -80.0, "{isa:?}: {db} dB");
    }
    assert!(portable == render(Some(Isa::Portable), 441));
    let fastest = render(None, 128);
    assert_eq!(fastest.0, Level::detect().isa());
    let same = fused.iter().chain([&portable]).find(|pinned| pinned.0 == fastest.0);
    assert!(same == Some(&fastest), "what is found is what may be pinned");
}

#[test]
fn a_rate_change_keeps_the_pinned_kernel() {
    let config = Config { kernel: Some(Isa::Portable), ..Config::default() };
    let Engine { mut scene, renderer, .. } = config.build().unwrap();
    scene.add_body(bar()).unwrap();
    let renderer = scene.at_rate(renderer, 48_000.0).unwrap().renderer;
    assert_eq!(renderer.kernel(), Isa::Portable);
}
