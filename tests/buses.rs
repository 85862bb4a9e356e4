//! Sound leaves on buses, so that a game can place each body somewhere else.

use crate::common;

use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::{
    AddError, AudioBus, Body, BodyId, BusId, ChannelId, Config, ContactEvent, ContactId, ContactSample,
    Engine, Impact, Material, Refusal, Renderer, Scene, SurfaceId,
};
use common::{bar, peak, plate};
use std::path::Path;

/// An engine with so many buses, without limiters.
fn engine(buses: usize) -> (Scene, Renderer) {
    let config = Config { audio: vec![AudioBus::default(); buses], ..Config::default() };
    let Engine { scene, renderer, .. } = config.build().unwrap();
    (scene, renderer)
}

fn strike(body: BodyId, speed_m_s: f64) -> ContactEvent {
    ContactEvent::Impact(Impact {
        body,
        other: None,
        speed_m_s,
        mass_kg: 0.005,
        radius_m: 0.005,
        striker: Material::STEEL,
        restitution: 0.6,
        position: 0,
        ..Impact::on(body)
    })
}

fn touch(u: f64) -> ContactSample {
    ContactSample {
        uv: [u, 0.5],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
        ..ContactSample::default()
    }
}

/// Renders blocks of `block` frames and returns what each bus carried.
fn render(renderer: &mut Renderer, buses: usize, frames: usize, block: usize) -> Vec<Vec<f32>> {
    let mut all = vec![vec![0.0f32; frames]; buses];
    let mut at = 0;
    while at < frames {
        let n = block.min(frames - at);
        let mut haptic = vec![0.0f32; n];
        let mut slices: Vec<_> = all.iter_mut().map(|bus| &mut bus[at..at + n]).collect();
        renderer.render(&mut [&mut haptic], &mut slices);
        at += n;
    }
    all
}

#[test]
fn an_unstruck_body_leaves_its_bus_at_exactly_zero() {
    let (mut scene, mut renderer) = engine(2);
    let struck = scene.add_body(Body::new(bar()).material(Material::CERAMIC)).unwrap();
    scene.add_body(Body::new(bar()).material(Material::GLASS).bus(BusId(1))).unwrap();
    scene.report(0.0, strike(struck, 1.0)).unwrap();
    let heard = render(&mut renderer, 2, 44_100, 256);
    assert!(peak(&heard[0]) > 0.01);
    assert!(heard[1].iter().all(|x| *x == 0.0));
    let levels = scene.stats().bus_levels;
    assert_eq!(levels.len(), 2);
    assert_eq!(levels[1], 0.0);
    // A second after the blow the meter has fallen by 40 dB at most, and the body rings below it.
    assert!(levels[0] > 0.0 && f64::from(levels[0]) < peak(&heard[0]), "{levels:?}");
}

#[test]
fn without_limiters_the_buses_add_up_to_what_a_single_one_carries() {
    let game = |buses: usize| {
        let (mut scene, mut renderer) = engine(buses);
        for index in 0..3 {
            let material = [Material::CERAMIC, Material::GLASS, Material::WOOD][index];
            let body = scene.add_body(Body::new(bar()).material(material).bus(BusId(index % buses))).unwrap();
            let surface = scene.add_surface(plate(0.9).body(body)).unwrap();
            let contact = ContactId(index as u64);
            let (sample, t) = (touch(0.1 + 0.2 * index as f64), 0.02 * index as f64);
            scene.report(t, ContactEvent::begin(contact, surface, ChannelId(0), sample)).unwrap();
            scene.report(t + 0.01, strike(body, 0.5)).unwrap();
        }
        render(&mut renderer, buses, 20_000, 256)
    };
    let (one, three) = (game(1), game(3));
    assert!(three.iter().all(|bus| peak(bus) > 0.0));
    let worst = (0..20_000)
        .map(|i| (f64::from(one[0][i]) - three.iter().map(|bus| f64::from(bus[i])).sum::<f64>()).abs())
        .fold(0.0, f64::max);
    assert!(worst <= 1e-6 * peak(&one[0]), "{worst} of {}", peak(&one[0]));
}

#[test]
fn a_sounding_body_changes_its_bus_without_a_step_in_any_split() {
    let game = |moves: bool, block: usize| {
        let (mut scene, mut renderer) = engine(2);
        let body = scene.add_body(bar()).unwrap();
        scene.report(0.0, strike(body, 1.0)).unwrap();
        let mut heard = render(&mut renderer, 2, 4096, block);
        if moves {
            scene.set_body_bus(body, BusId(1)).unwrap();
        }
        let after = render(&mut renderer, 2, 16_384, block);
        heard.iter_mut().zip(after).for_each(|(bus, after)| bus.extend(after));
        heard
    };
    let (stays, moves) = (game(false, 64), game(true, 64));
    for block in [1, 63, 64, 100, 4096] {
        assert!(game(true, block) == moves, "blocks of {block} differ");
    }
    let step = |x: &[f32]| x.windows(2).map(|w| f64::from((w[1] - w[0]).abs())).fold(0.0, f64::max);
    let (quiet, change) = (step(&stays[0][4000..]), step(&moves[0][4000..]).max(step(&moves[1][4000..])));
    assert!(change <= 1.01 * quiet, "{change} against {quiet}");
    // Nothing is lost on the way, and all of it has arrived.
    let worst = (0..stays[0].len())
        .map(|i| f64::from((moves[0][i] + moves[1][i] - stays[0][i]).abs()))
        .fold(0.0, f64::max);
    assert!(worst <= 1e-6 * peak(&stays[0]), "{worst}");
    // One pole of 5 ms is there, to the bit, within a tenth of a second.
    assert!(moves[0][4096 + 4410..].iter().all(|x| *x == 0.0));
}

#[test]
fn a_missing_bus_is_refused_with_the_number_of_buses() {
    let (mut scene, _renderer) = engine(2);
    let refused = scene.add_body(Body::new(bar()).bus(BusId(2))).unwrap_err();
    assert_eq!(refused, AddError::UnknownBus { bus: 2, buses: 2 });
    assert_eq!(refused.to_string(), "bus: 2 is refused; must be below 2, the number of buses under audio");
    let body = scene.add_body(bar()).unwrap();
    assert!(scene.set_body_bus(body, BusId(7)).is_err());
}

#[test]
fn every_call_refuses_the_id_of_a_removed_thing() {
    let (mut scene, mut renderer) = engine(1);
    let old_body = scene.add_body(bar()).unwrap();
    let old_surface = scene.add_surface(plate(0.5).body(old_body)).unwrap();
    scene.remove_surface(old_surface).unwrap();
    scene.remove_body(old_body).unwrap();
    render(&mut renderer, 1, 8192, 256);
    let body = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(plate(0.5).body(body)).unwrap();
    assert_ne!((old_body, old_surface), (body, surface));
    assert_eq!(old_body.to_bits() as u32, body.to_bits() as u32, "the place is the same");
    let unknown = [
        scene.remove_body(old_body),
        scene.replace_body(old_body, bar()),
        scene.set_body_bus(old_body, BusId(0)),
        scene.remove_surface(old_surface),
        scene.replace_surface(old_surface, plate(0.1)),
        scene.add_surface(plate(0.1).body(old_body)).map(|_| ()),
    ];
    for answer in unknown {
        assert!(matches!(answer, Err(AddError::Unknown(_))), "{answer:?}");
    }
    let begin = |surface: SurfaceId| ContactEvent::begin(ContactId(1), surface, ChannelId(0), touch(0.3));
    assert_eq!(scene.report(0.0, begin(old_surface)).unwrap_err().reason, Refusal::UnknownSurface);
    assert_eq!(scene.report(0.0, strike(old_body, 1.0)).unwrap_err().reason, Refusal::UnknownBody);
    scene.report(0.0, begin(surface)).unwrap();
    // From numbers as another language holds them, too.
    assert_eq!(scene.remove_body(BodyId::from_bits(old_body.to_bits())), Err(AddError::Unknown("body")));
    assert!(scene.remove_body(BodyId::from_bits(0)).is_err());
    scene.remove_body(BodyId::from_bits(body.to_bits())).unwrap();
}

#[test]
fn strokes_on_a_removed_bodys_surface_ring_no_other() {
    let (mut scene, mut renderer) = engine(1);
    let gone = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(plate(0.9).body(gone)).unwrap();
    scene.remove_body(gone).unwrap();
    render(&mut renderer, 1, 8192, 256);
    scene.add_body(bar()).unwrap();
    for step in 0..30 {
        let (time_s, sample) = (0.2 + f64::from(step) / 60.0, touch(0.1 + 0.01 * f64::from(step)));
        let event = match step {
            0 => ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample),
            _ => ContactEvent::moved(ContactId(1), sample),
        };
        scene.report(time_s, event).unwrap();
    }
    let heard = render(&mut renderer, 1, 30_000, 256);
    assert!(heard[0].iter().all(|x| *x == 0.0));
    assert!(scene.stats().contacts == 1);
}

#[test]
fn a_body_sounds_on_four_buses_at_a_gain_each() {
    let gains = [1.0, 0.5, 0.25, 2.0];
    let mut heard = Vec::new();
    for sends in [false, true] {
        let (mut scene, mut renderer) = engine(4);
        let body = scene.add_body(bar()).unwrap();
        for (bus, gain) in gains.iter().enumerate().skip(1).filter(|_| sends) {
            scene.set_body_send(body, BusId(bus), *gain).unwrap();
        }
        // They are there within a tenth of a second.
        render(&mut renderer, 4, 8192, 256);
        scene.report(8192.0 / 44_100.0, strike(body, 1.0)).unwrap();
        heard.push(render(&mut renderer, 4, 8192, 256));
    }
    for (bus, gain) in gains.iter().enumerate() {
        let off = |(own, sent): (&f32, &f32)| (gain * f64::from(*own) - f64::from(*sent)).abs();
        let worst = heard[0][0].iter().zip(&heard[1][bus]).map(off).fold(0.0, f64::max);
        println!("bus {bus}: {worst:.1e} of {:.1e}", peak(&heard[0][0]));
        assert!(worst <= 1e-6 * peak(&heard[0][0]), "bus {bus}: {worst}");
    }
}

#[test]
fn a_listener_comes_and_goes_without_a_step_in_any_split() {
    let game = |sends: bool, block: usize| {
        let (mut scene, mut renderer) = engine(2);
        let body = scene.add_body(bar()).unwrap();
        scene.report(0.0, strike(body, 1.0)).unwrap();
        let mut heard = render(&mut renderer, 2, 4096, block);
        for gain in [0.5, 0.0].into_iter().filter(|_| sends) {
            scene.set_body_send(body, BusId(1), gain).unwrap();
            let after = render(&mut renderer, 2, 8192, block);
            heard.iter_mut().zip(after).for_each(|(bus, after)| bus.extend(after));
        }
        heard
    };
    let sent = game(true, 64);
    for block in [1, 63, 100, 4096] {
        assert!(game(true, block) == sent, "blocks of {block} differ");
    }
    let step = |x: &[f32]| x.windows(2).map(|w| f64::from((w[1] - w[0]).abs())).fold(0.0, f64::max);
    assert!(step(&sent[1]) <= 1.01 * step(&sent[0][4000..]));
    assert!(peak(&sent[1]) > 0.0 && sent[1][16_384..].iter().all(|x| *x == 0.0), "it has gone");
}

#[test]
fn a_body_has_four_further_listeners_besides_its_own_bus() {
    let (mut scene, _renderer) = engine(7);
    let body = scene.add_body(bar()).unwrap();
    assert!(scene.set_body_send(body, BusId(0), 0.5).unwrap_err().to_string().contains("further bus"));
    assert!(scene.set_body_send(body, BusId(1), f64::NAN).is_err());
    assert!(scene.set_body_send(body, BusId(7), 1.0).is_err());
    (1..5).for_each(|bus| scene.set_body_send(body, BusId(bus), 0.5).unwrap());
    let full = AddError::Full { kind: "sends of a body", capacity: 4 };
    assert_eq!(scene.set_body_send(body, BusId(5), 0.5), Err(full));
    scene.set_body_send(body, BusId(3), 0.0).unwrap();
    scene.set_body_send(body, BusId(5), 0.5).unwrap();
    // Another bus of its own ends them.
    scene.set_body_bus(body, BusId(6)).unwrap();
    (1..5).for_each(|bus| scene.set_body_send(body, BusId(bus), 0.5).unwrap());
}

/// A scene of three buses and a bar that plays on them as `sends` says.
fn scene_of(sends: &str) -> Result<SceneFile, String> {
    let buses = ["left", "right", "room"].map(|name| format!("[[audio]]\nname = \"{name}\"\ngain = 1.0\n"));
    let body =
        format!("[[body]]\nname = \"bar\"\nstock = \"bar\"\nsize_m = 0.3\nstrike_gain = 1.0\n{sends}\n");
    let text = format!("{body}{}[[actuator]]\nfull_scale = 1e-4\n", buses.concat());
    SceneFile::parse(&text, Path::new("s.toml")).map_err(|error| error.to_string())
}

/// Peaks of the buses under a blow.
fn peaks_of(sends: &str) -> Vec<f64> {
    let file = scene_of(sends).unwrap();
    let mut engine = Engine::from_scene(&file, &Overrides::default()).unwrap();
    engine.scene.report(0.0, strike(engine.names.bodies["bar"], 1.0)).unwrap();
    render(&mut engine.renderer, 3, 8192, 256).iter().map(|bus| peak(bus)).collect()
}

#[test]
fn a_scene_file_sends_a_body_to_several_buses() {
    let whole = peaks_of("bus = \"left\"");
    assert!(whole[0] > 0.0 && whole[1..] == [0.0, 0.0]);
    let sent = peaks_of("sends = { left = 0.2, right = 0.5, room = 0 }");
    for (sent, gain) in sent.iter().zip([0.2, 0.5, 0.0]) {
        assert!((sent - gain * whole[0]).abs() <= 1e-6 * whole[0], "{sent} of {}", whole[0]);
    }
    for (sends, words) in [
        ("sends = { left = 1 }\nbus = \"left\"", ["sends", "beside bus"]),
        ("sends = { lfet = 1 }", ["sends", "lfet"]),
        ("sends = { left = -1 }", ["left", "0 to 1000"]),
        ("sends = { left = 0 }", ["sends", "above 0"]),
        ("sends = 0.5", ["sends", "table"]),
    ] {
        let error = scene_of(sends).unwrap_err();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}

#[test]
fn a_changed_scene_file_changes_what_a_body_sends() {
    let files = ["sends = { left = 1, right = 0.5 }", "sends = { left = 0.5, room = 0.25 }"].map(scene_of);
    let [before, after] = files.map(Result::unwrap);
    let mut engine = Engine::from_scene(&before, &Overrides::default()).unwrap();
    engine.scene.apply(&mut engine.names, &before, &after, &Overrides::default()).unwrap();
    render(&mut engine.renderer, 3, 8192, 256);
    engine.scene.report(0.2, strike(engine.names.bodies["bar"], 1.0)).unwrap();
    let peaks: Vec<f64> = render(&mut engine.renderer, 3, 8192, 256).iter().map(|bus| peak(bus)).collect();
    let whole = peaks_of("bus = \"left\"")[0];
    for (heard, gain) in peaks.iter().zip([0.5, 0.0, 0.25]) {
        assert!((heard - gain * whole).abs() <= 1e-5 * whole, "{peaks:?} of {whole}");
    }
}

#[test]
fn the_same_blow_told_twice_within_the_least_time_sounds_once() {
    let mut heard = Vec::new();
    for (least_time_s, blows) in [(0.0, 1), (0.03, 2), (0.0, 2)] {
        let (mut scene, mut renderer) = engine(1);
        let body = scene.add_body(Body::new(bar()).least_time_s(least_time_s)).unwrap();
        (0..blows).for_each(|n| scene.report(0.005 * f64::from(n), strike(body, 1.0)).unwrap());
        heard.push((render(&mut renderer, 1, 8192, 256), scene.stats().too_soon, scene.stats().impacts));
    }
    assert!(heard[0].0 == heard[1].0 && heard[1].0 != heard[2].0);
    assert_eq!(heard.iter().map(|heard| (heard.1, heard.2)).collect::<Vec<_>>(), [(0, 1), (1, 1), (0, 2)]);
    // What is stronger, or comes later, is another sound.
    let (mut scene, mut renderer) = engine(1);
    let body = scene.add_body(Body::new(bar()).least_time_s(0.03)).unwrap();
    for (t, speed_m_s) in [(0.0, 0.5), (0.005, 1.0), (0.010, 0.9), (0.036, 0.1)] {
        scene.report(t, strike(body, speed_m_s)).unwrap();
    }
    render(&mut renderer, 1, 8192, 256);
    assert_eq!((scene.stats().impacts, scene.stats().too_soon), (3, 1));
    assert!(scene.add_body(Body::new(bar()).least_time_s(-1.0)).is_err());
}

#[test]
fn a_scene_file_gives_a_body_its_least_time() {
    let (mut scene, mut renderer) = engine(1);
    let table = "name = \"bar\"\nstock = \"bar\"\nsize_m = 0.3\nleast_time_s = 0.03";
    let read = scene.read_body(table, Path::new(""), &Overrides::default()).unwrap();
    let body = scene.add_body(read).unwrap();
    for t in [0.0, 0.005, 0.035] {
        scene.report(t, strike(body, 1.0)).unwrap();
    }
    render(&mut renderer, 1, 8192, 256);
    assert_eq!((scene.stats().impacts, scene.stats().too_soon), (2, 1));
    let refused = scene.read_body(&table.replace("0.03", "61.0"), Path::new(""), &Overrides::default());
    let error = refused.unwrap_err().to_string();
    assert!(error.contains("least_time_s") && error.contains("0 to 60 s"), "{error}");
}
