//! The instruction set of the kernels can be pinned: the portable one does not depend on the processor.

mod common;

use asperity::offline::{self, Options, Render};
use asperity::{Config, Engine, Isa};
use common::{SIDE_M, bar, grating, stroke};

fn render(kernel: Option<Isa>) -> Option<(Isa, Render)> {
    let engine = Config { kernel, ..Config::default() }.build();
    let Engine { mut scene, renderer, mut names, .. } = match engine {
        Ok(engine) => engine,
        Err(refused) => {
            assert!(
                refused.to_string().contains("is not in this processor; must be one of: portable"),
                "{refused}"
            );
            return None;
        }
    };
    let body = scene.add_body(bar()).unwrap();
    names.surfaces.insert("s".to_owned(), scene.add_surface(grating(2e-3, 2e-5).on(body)).unwrap());
    let used = renderer.kernel();
    let log = stroke(SIDE_M, 0.1, 0.6, 0.5);
    Some((used, offline::render(scene, renderer, &log, &names, &Options::default()).unwrap()))
}

#[test]
fn every_kernel_of_this_processor_plays_the_same_and_the_fused_ones_to_the_bit() {
    let (fastest, default) = render(None).unwrap();
    let mut fused = 0;
    for isa in Isa::ALL {
        let Some((used, rendered)) = render(Some(isa)) else { continue };
        assert_eq!(used, isa);
        for (a, b) in [(&default.haptic[0], &rendered.haptic[0]), (&default.audio[0], &rendered.audio[0])] {
            let error: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
            let power: f64 = a.iter().map(|a| f64::from(*a).powi(2)).sum();
            let db = 10.0 * (error / power).log10();
            assert!(power > 0.0 && db < -80.0, "{isa:?}: {db} dB");
            if (isa == Isa::Portable) == (fastest == Isa::Portable) {
                assert!(a == b, "{isa:?} has other bits than {fastest:?}");
                fused += 1;
            }
        }
    }
    assert!(fused >= 2);
}
