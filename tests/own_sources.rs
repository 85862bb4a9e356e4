//! A source of one's own gets every call, whatever combination it is part of.

use crate::common;

use asperity::surface::combine::{BandSplit, Crossfade, Mask, Scale, Sum};
use asperity::surface::height_field::{
    Extension, HeightField, PathBlock, Properties, Reaction, Setup, SurfaceBlock, Touch, TouchKind,
    WavelengthBand,
};
use asperity::surface::height_map::{Extent, HeightMap};
use asperity::surface::tiled::Tiled;
use asperity::{
    Body, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Material, ModalModel, Mode,
    Surface, TipLaw,
};
use asperity_dsp::DesignError;
use common::peak;
use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Calls of one source.
#[derive(Debug, Default)]
struct Calls {
    properties: AtomicU64,
    prepare: AtomicU64,
    sample: AtomicU64,
    begins: AtomicU64,
    presses: AtomicU64,
    stands: AtomicU64,
    set: AtomicU64,
    /// Samples that asked for a ridden tip, for places of the body, and for the power of the
    /// relief.
    tips: AtomicU64,
    places: AtomicU64,
    powers: AtomicU64,
}

fn count(calls: &AtomicU64) {
    calls.fetch_add(1, Relaxed);
}

/// Flat ground of loose grains that counts what is asked of it.
struct Counting {
    calls: Arc<Calls>,
    extension: Extension,
}

/// A change of a [`Counting`] source.
#[derive(Clone, Copy)]
struct Loosen;

impl HeightField for Counting {
    fn properties(&self, _tile_m: [f64; 2]) -> Properties {
        count(&self.calls.properties);
        let band = WavelengthBand { shortest_m: 1e-3, longest_m: 2e-3 };
        let tip_law = Some(TipLaw::Spring { compliance_m_n: 2e-3, friction: 0.0 });
        Properties { extension: self.extension, tip_law, ..Properties::of(band) }
    }

    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        assert!(setup.tip_radii_m.iter().any(|radius_m| *radius_m > 0.0), "no tip was named");
        count(&self.calls.prepare);
        Ok(())
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        count(&self.calls.sample);
        self.calls.tips.fetch_add(u64::from(path.tip_radius_m > 0.0), Relaxed);
        self.calls.places.fetch_add(u64::from(!path.at_m.is_empty()), Relaxed);
        self.calls.powers.fetch_add(u64::from(path.full_power_m2.is_some()), Relaxed);
        out.clear(path.len());
    }

    fn touch(&mut self, touch: &Touch) -> Reaction {
        match touch.kind {
            TouchKind::Begins => count(&self.calls.begins),
            TouchKind::Presses => count(&self.calls.presses),
            TouchKind::Stands { depth_m } => {
                count(&self.calls.stands);
                return Reaction { support_force_n: Some(500.0 * depth_m.max(0.0)), ..Reaction::default() };
            }
        }
        Reaction { grain_rate_per_s: 3000.0, grain_impulse_n_s: 1e-5, ..Reaction::default() }
    }

    fn set(&mut self, change: &dyn Any, _sample: u64) -> bool {
        let meant = change.is::<Loosen>();
        self.calls.set.fetch_add(u64::from(meant), Relaxed);
        meant
    }
}

const SIDE_M: f64 = 0.1;

fn plane() -> Box<dyn HeightField> {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 0.0 };
    Box::new(HeightMap::flat(extent, 0.5).unwrap())
}

/// A mask that is half of the one and half of the other.
fn half() -> Box<dyn HeightField> {
    let raster = asperity::surface::raster::Raster::constant(1, 1, 0.5);
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    Box::new(HeightMap::new(&raster, extent, asperity::surface::wrap::Wrap::Repeat).unwrap())
}

type Wrap = fn(Box<dyn HeightField>) -> Box<dyn HeightField>;

/// Every combination, by name.
fn wrappers() -> Vec<(&'static str, Wrap)> {
    vec![
        ("plain", |own| own),
        ("the second of a sum", |own| Box::new(Sum::new(vec![plane(), own]))),
        ("scaled", |own| Box::new(Scale::new(own, 0.7).unwrap())),
        ("the first of a crossfade", |own| Box::new(Crossfade::new(own, plane()))),
        ("inside a mask", |own| Box::new(Mask::new(half(), own, plane()))),
        ("outside a mask", |own| Box::new(Mask::new(half(), plane(), own))),
        ("the coarse part of a band split", |own| Box::new(BandSplit::new(own, plane(), 1e-3).unwrap())),
        ("tiled", |own| Box::new(Tiled::new(own, [SIDE_M; 2]))),
        ("scaled in a sum that is tiled", |own| {
            let scaled = Box::new(Scale::new(own, 2.0).unwrap());
            Box::new(Tiled::new(Box::new(Sum::new(vec![scaled, plane()])), [SIDE_M; 2]))
        }),
        #[cfg(feature = "brownian")]
        ("under a Brownian force", |own| {
            use asperity::surface::brownian::rendering::{BrownianForce, BrownianSurface, Rendering};
            let force = BrownianForce::surface(Rendering::Lateral, 1e-3).unwrap();
            Box::new(BrownianSurface::new(own, force))
        }),
    ]
}

/// Strokes a surface for 512 samples; the calls, and the loudest sample.
fn stroked(wrap: Wrap, extension: Extension) -> (Arc<Calls>, f64) {
    let calls = Arc::new(Calls::default());
    let own = Box::new(Counting { calls: calls.clone(), extension });
    let Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let stylus = scene.add_probe(asperity::probe_by_name("stylus").unwrap()).unwrap();
    let mode = Mode { frequency_hz: 3000.0, decay_per_s: 200.0, amplitude: 1.0, phase_rad: 0.0 };
    let body = Body::new(ModalModel::new(vec![mode], 0.01).unwrap()).material(Material::CERAMIC);
    let body = scene.add_body(body).unwrap();
    let surface = Surface::from_source(wrap(own), SIDE_M, SIDE_M).unwrap().micro_relief_m(1e-6).body(body);
    let surface = scene.add_surface(surface).unwrap();
    let sample = ContactSample {
        uv: [0.4, 0.4],
        velocity_m_s: Some([0.05, 0.0]),
        normal_force_n: 0.5,
        depth_m: Some(1e-3),
        at_m: Some([0.01, 0.02, 0.03]),
        ..ContactSample::default()
    };
    let mut touching = asperity::Touching::on(surface).felt_by(ChannelId(0));
    touching.probe = Some(stylus);
    let begin = ContactEvent::Begin { contact: ContactId(1), touching, sample };
    scene.report(0.0, begin).unwrap();
    scene.change_surface(surface, Loosen).unwrap();
    let (mut haptic, mut audio) = ([0.0f32; 512], [0.0f32; 512]);
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    let loudest = peak(&audio);
    assert_eq!(scene.stats().quarantined, 0, "a change was not taken");
    (calls, loudest)
}

/// One of the counters.
type Counter = fn(&Calls) -> &AtomicU64;

#[test]
fn a_source_gets_every_call_in_every_combination() {
    for beyond in [Extension::Same, Extension::Fresh] {
        let (plain, _) = stroked(|own| own, beyond);
        for (name, wrap) in wrappers() {
            let (calls, loudest) = stroked(wrap, beyond);
            println!("{name}, {beyond:?}: {calls:?}, {loudest}");
            let of = |which: Counter| [&plain, &calls].map(|calls| which(calls).load(Relaxed));
            let once: [(&str, Counter); 4] = [
                ("begins", |calls| &calls.begins),
                ("presses", |calls| &calls.presses),
                ("stands", |calls| &calls.stands),
                ("set", |calls| &calls.set),
            ];
            for (call, which) in once {
                let [wanted, found] = of(which);
                assert!(wanted > 0 && found == wanted, "{name}, {beyond:?}: {call} {found} of {wanted}");
            }
            let often: [(&str, Counter); 5] = [
                ("properties", |calls| &calls.properties),
                ("prepare", |calls| &calls.prepare),
                ("sample", |calls| &calls.sample),
                ("tips", |calls| &calls.tips),
                ("places", |calls| &calls.places),
            ];
            for (call, which) in often {
                let [wanted, found] = of(which);
                assert!(wanted > 0 && found >= wanted, "{name}, {beyond:?}: {call} {found} of {wanted}");
            }
            let asked = calls.powers.load(Relaxed) > 0 || name.contains("band split");
            assert!(asked, "{name}, {beyond:?}: nobody asked for the relief's power");
            assert!(loudest > 1e-6, "{name}, {beyond:?}: its grains are not heard");
        }
    }
}
