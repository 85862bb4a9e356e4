//! An app without a window whose time is set by hand: no test sleeps.

// Every test file uses a part of it.
#![allow(dead_code)]

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options, Render};
use asperity::{Body, Config, ContactSample, Engine, Material, Stock, Surface};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_asperity::*;
use std::collections::HashMap;
use std::time::Duration;

/// Length of a fixed step, and of a frame unless told otherwise.
pub const STEP: Duration = Duration::from_millis(16);

/// A ringing plate of 40 cm as the tests add it.
pub fn body() -> Body {
    Body::stock(Stock::Plate, Material::CERAMIC, 0.4).unwrap()
}

/// Its top, not on any body yet.
pub fn top() -> Surface {
    Surface::flat(0.4, 0.4).unwrap().of(Material::CERAMIC).wraps(false)
}

pub fn app() -> App {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins)
        .add_plugins(AsperityPlugin::to(Output::Null { keep: true }))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app
}

pub fn plate(app: &mut App) -> Entity {
    app.world_mut().spawn((TouchBody(body()), TouchSurface::new(top()))).id()
}

pub fn touch(app: &mut App) -> Mut<'_, Touch> {
    app.world_mut().resource_mut::<Touch>()
}

/// A frame of another length.
pub fn frame(app: &mut App, length: Duration) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(length));
    app.update();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
}

/// Where a finger is that slides over the plate.
pub fn sliding(t: f64) -> ContactSample {
    ContactSample::new([0.1 + 0.25 * t, 0.5], 0.7).sliding([0.1, 0.0])
}

/// Everything refused so far.
pub fn errors(app: &mut App) -> Vec<String> {
    app.world_mut().resource_mut::<Messages<TouchError>>().drain().map(|error| error.text).collect()
}

pub fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |peak, x| peak.max(x.abs()))
}

/// The recording rendered offline in an engine that is built as the app's was: `plates` of [`plate`], then the probes of an adapter.
pub fn offline(log: &ContactLog, names: &Names, plates: usize) -> Render {
    // The recording survives its file.
    let mut text = Vec::new();
    log.write(&mut text).unwrap();
    let log = ContactLog::parse(std::str::from_utf8(&text).unwrap(), "recording").unwrap();
    let Engine { mut scene, renderer, .. } =
        Config { clock: asperity::ClockMode::Exact, ..AsperityPlugin::default().config }.build().unwrap();
    let mut own = Names { surfaces: HashMap::new(), bodies: HashMap::new(), probes: HashMap::new() };
    for probe in names.probes.keys() {
        own.probes.insert(probe.clone(), scene.add_probe(asperity::probe_by_name("rigid").unwrap()).unwrap());
    }
    for i in 0..plates {
        let body = scene.add_body(body()).unwrap();
        own.bodies.insert(format!("body {i}"), body);
        own.surfaces.insert(format!("surface {i}"), scene.add_surface(top().on(body)).unwrap());
    }
    offline::render(scene, renderer, &log, &own, &Options { tail_s: 3.0, ..Options::default() }).unwrap()
}

/// What the null output got is what the recording renders to, to the bit; and it is not silence.
pub fn assert_same_bits(app: &mut App, plates: usize) {
    let (log, names) = {
        let mut touch = touch(app);
        assert_eq!((touch.stats().refused, touch.stats().dropped, touch.stats().late), (0, 0, 0));
        (touch.stop_recording(), touch.names().clone())
    };
    assert!(!log.lines.is_empty());
    let render = offline(&log, &names, plates);
    let mut output = app.world_mut().resource_mut::<NullOutput>();
    let late = output.latency_samples();
    for (what, played, rendered) in
        [("audio", &output.audio[0], &render.audio[0]), ("haptic", &output.haptic[0], &render.haptic[0])]
    {
        let played = &played[late..];
        let frames = played.len().min(rendered.len());
        assert!(frames > 80_000, "{what}: {frames} samples");
        let first = (0..frames).find(|i| played[*i].to_bits() != rendered[*i].to_bits());
        assert_eq!(first, None, "{what}: the first sample that differs, of {frames}");
    }
    assert!(peak(&output.audio[0]) > 1e-6, "silence");
}
