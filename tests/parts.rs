//! Bodies, surfaces and probes that are read from tables by themselves are those of a scene file.

use asperity::files::Memory;
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::{
    ChannelId, ClockMode, Config, ContactEvent, ContactId, ContactSample, Engine, Integrator, Probe,
    Renderer, Scene, SurfaceId, Touching,
};
use std::path::Path;

const BODY: &str = "stock = \"plate\"\nsize_m = 0.14\nmaterial = \"ceramic\"";
const SURFACE: &str = "width_m = 0.14\nheight_m = 0.14\nsolid = \"granite\"";
const PROBE: &str = "preset = \"stylus\"\ntip_radius_m = 2e-4";

fn stroke(mut scene: Scene, mut renderer: Renderer, touching: Touching) -> Vec<f32> {
    let sample = |t: f64| ContactSample::new([0.1 + t, 0.5], 0.6).sliding([0.14, 0.0]);
    scene.report(0.0, ContactEvent::begin_with(ContactId(1), touching, sample(0.0))).unwrap();
    for step in 1..20 {
        let t = f64::from(step) / 60.0;
        scene.report(t, ContactEvent::moved(ContactId(1), sample(t))).unwrap();
    }
    let (mut haptic, mut audio) = (vec![0.0; 14_000], vec![0.0; 14_000]);
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    haptic.extend(audio);
    haptic
}

#[test]
fn a_scene_of_parts_renders_the_bits_of_the_scene_file() {
    let mut files = Memory::new();
    let scene = format!(
        "[[body]]\nname = \"b\"\n{BODY}\n[[surface]]\nname = \"s\"\nbody = \"b\"\n{SURFACE}\n[[probe]]\nname = \"p\"\n{PROBE}\n\
         [[actuator]]\nfull_scale = 1e-4\n[audio]\ngain = 1.0\n"
    );
    files.add("scene.toml", scene);
    let whole = Engine::open_from(&files, "scene.toml").unwrap();
    let touching =
        Touching::on(whole.names.surfaces["s"]).probe(whole.names.probes["p"]).felt_by(ChannelId(0));
    let expected = stroke(whole.scene, whole.renderer, touching);
    assert!(expected.iter().any(|x| *x != 0.0));

    let Engine { mut scene, renderer, names, .. } = Config::default().build().unwrap();
    let (here, overrides) = (Path::new(""), Overrides::default());
    let probe = scene.add_probe(Scene::read_probe(PROBE).unwrap()).unwrap();
    let body = scene.read_body(BODY, here, &overrides).unwrap();
    let body = scene.add_body(body).unwrap();
    let read = scene.read_surface(SURFACE, here, Some(body), &names, &overrides).unwrap();
    assert!(read.workers.is_empty());
    let surface: SurfaceId = scene.add_surface(read.surface).unwrap();
    let parts = stroke(scene, renderer, Touching::on(surface).probe(probe).felt_by(ChannelId(0)));
    assert!(parts == expected);
}

#[test]
fn what_is_wrong_in_a_table_is_said_by_name() {
    let Engine { scene, names, .. } = Config::default().build().unwrap();
    let (here, overrides) = (Path::new(""), Overrides::default());
    let body = |table| scene.read_body(table, here, &overrides).unwrap_err().to_string();
    let surface = |table| scene.read_surface(table, here, None, &names, &overrides).unwrap_err().to_string();
    assert!(body("stock = \"cube\"\nsize_m = 1.0").contains("\"cube\""));
    assert!(body("bus = \"left\"").contains("number of the bus"));
    assert!(body("= 1").contains("[[body]]"));
    assert!(surface("width_m = 0.1").contains("height_m"));
    assert!(surface("width_m = 0.1\nheight_m = 0.1\nbody = \"bell\"").contains("\"bell\" is unknown"));
    assert!(Scene::read_probe("preset = \"toe\"").unwrap_err().to_string().contains("\"toe\""));
}

#[test]
fn a_game_opens_a_scene_file_with_the_same_levels() {
    let file =
        SceneFile::parse(&format!("[[surface]]\nname = \"s\"\n{SURFACE}\n"), Path::new("s.toml")).unwrap();
    let live = Overrides { clock: Some(ClockMode::LIVE), ..Overrides::default() };
    let (exact, live) = (
        Engine::from_scene(&file, &Overrides::default()).unwrap(),
        Engine::from_scene(&file, &live).unwrap(),
    );
    assert_eq!(live.scene.config().clock, ClockMode::LIVE);
    assert_eq!(exact.scene.config().clock, ClockMode::Exact);
    assert_eq!(live.levels, exact.levels);
}

#[test]
fn sand_of_a_live_scene_brings_its_worker() {
    let Engine { scene, names, .. } = Config::live(48_000.0).build().unwrap();
    let table = "width_m = 0.2\nheight_m = 0.2\nsand = { cells = 64, depth_m = 0.02, tool_radius_m = 0.005 }";
    let overrides = Overrides { live: true, ..Overrides::default() };
    let read = scene.read_surface(table, Path::new(""), None, &names, &overrides).unwrap();
    assert_eq!(read.workers.len(), 1);
}

#[test]
fn an_integrator_replaced_and_sub_steps_are_reported() {
    let message = |integrator, contact_stiffness_n_m| {
        let probe = Probe { contact_stiffness_n_m, ..Probe::default() };
        Config { integrator, probe, ..Config::default() }.build().unwrap().remarks
    };
    let [remark] = &message(Integrator::SemiImplicitEuler, 1e6)[..] else { panic!("no remark") };
    assert!(remark.contains("energy-conserving instead of semi-implicit-euler"), "{remark}");
    assert!(remark.contains("contact_stiffness_n_m"), "{remark}");
    let [remark] = &message(Integrator::SemiImplicitEuler, 2e5)[..] else { panic!("no remark") };
    assert!(remark.contains("2 sub-steps"), "{remark}");
    assert!(message(Integrator::SemiImplicitEuler, 5e4).is_empty());
    let [remark] = &message(Integrator::ExactEvent, 1e7)[..] else { panic!("no remark") };
    assert!(remark.contains("energy-conserving instead of exact-event"), "{remark}");
    for preset in asperity::Preset::ALL {
        assert!(Config::default().preset(preset).build().unwrap().remarks.is_empty(), "{preset:?}");
    }
    // Of a scene file each probe is told by its name.
    let mut files = Memory::new();
    files.add("scene.toml", "[[probe]]\nname = \"steel\"\npreset = \"rigid\"\ncontact_stiffness_n_m = 2e7\n");
    let scene = SceneFile::load_from(&files, Path::new("scene.toml")).unwrap();
    let asked = Overrides { files: &files, ..Overrides::default() };
    let remarks = Engine::from_scene(&scene, &asked).unwrap().remarks;
    assert!(remarks.len() == 1 && remarks[0].starts_with("probe \"steel\": integrator: "), "{remarks:?}");
}
