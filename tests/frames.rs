//! Surfaces that lie in a body: one block of stuff, cut by every face; one mapping between places
//! and texture coordinates.

use asperity::files::Memory;
use asperity::files::contact_log::{ContactLog, LogEvent, LogLine};
use asperity::offline::{Options, render_tapped};
use asperity::{ContactBlock, ContactSample, Engine, Tap};

/// Three faces of a granite cube of 4 cm that meet in a corner, and a plate of granite somewhere
/// else.
const CUBE: &str = r#"
[[surface]]
name = "top"
solid = "granite"
width_m = 0.04
height_m = 0.04
micro_relief_m = 0.0
[surface.frame]
[[surface]]
name = "front"
solid = "granite"
width_m = 0.04
height_m = 0.04
micro_relief_m = 0.0
frame = { u_axis = [1, 0, 0], v_axis = [0, 0, -2.5] }
[[surface]]
name = "side"
solid = "granite"
width_m = 0.04
height_m = 0.04
micro_relief_m = 0.0
frame = { origin_m = [0.04, 0.0, 0.0], u_axis = [0, 1, 0], v_axis = [0, 0, -1] }
[[surface]]
name = "plain"
solid = "granite"
width_m = 0.04
height_m = 0.04
micro_relief_m = 0.0
"#;

fn open(scene: &str) -> Result<Engine, String> {
    let mut files = Memory::new();
    files.add("scene.toml", scene);
    Engine::open_from(&files, "scene.toml").map_err(|error| error.to_string())
}

/// Heights that one slow stroke from uv to uv passes over, with the places.
fn heights(surface: &str, from: [f64; 2], to: [f64; 2]) -> Vec<([f64; 2], f64)> {
    struct Heights(Vec<([f64; 2], f64)>);
    impl Tap for Heights {
        fn contact(&mut self, block: &ContactBlock<'_>) {
            self.0.extend(block.uv.iter().zip(block.contact_samples).map(|(uv, row)| (*uv, row.height_m)));
        }
    }
    let Engine { scene, renderer, names, .. } = open(CUBE).unwrap();
    let steps = 120;
    let sample = |step: u32| {
        let t = f64::from(step) / f64::from(steps);
        let velocity = [0, 1].map(|a| (to[a] - from[a]) * 0.04 / 2.0);
        ContactSample {
            uv: [0, 1].map(|a| from[a] + t * (to[a] - from[a])),
            velocity_m_s: Some(velocity),
            normal_force_n: 0.5,
            closing_m_s: 0.0,
            ..ContactSample::default()
        }
    };
    let mut lines = vec![LogLine { t: 0.0, event: LogEvent::begin(1, surface, 0, sample(0)) }];
    lines.extend(
        (1..=steps)
            .map(|step| LogLine { t: f64::from(step) / 60.0, event: LogEvent::moved(1, sample(step)) }),
    );
    let mut felt = Heights(Vec::new());
    render_tapped(scene, renderer, &ContactLog { lines }, &names, &Options::default(), &mut felt).unwrap();
    felt.0
}

/// The height at an end of a stroke that comes to rest there is that of the edge.
fn at(surface: &str, uv: [f64; 2]) -> f64 {
    let rows = heights(surface, uv, uv);
    rows.last().unwrap().1
}

#[test]
fn faces_of_a_cube_from_one_block_meet_continuously() {
    let mut worst = 0.0f64;
    let mut differ = 0.0f64;
    for k in 0..8 {
        let s = 0.07 + 0.12 * f64::from(k);
        // Top and front share y = 0, z = 0; top and side share x = 4 cm; front and side share x = 4
        // cm, y = 0.
        for ((a, at_a), (b, at_b)) in [
            (("top", [s, 0.0]), ("front", [s, 0.0])),
            (("top", [1.0, s]), ("side", [s, 0.0])),
            (("front", [1.0, s]), ("side", [0.0, s])),
        ] {
            worst = worst.max((at(a, at_a) - at(b, at_b)).abs());
        }
        differ = differ.max((at("top", [s, 0.5]) - at("front", [s, 0.5])).abs());
    }
    assert!(worst < 1e-9, "{worst} m apart over an edge");
    assert!(differ > 1e-6, "the faces are not the same face: {differ}");
}

#[test]
fn a_frame_on_the_bodys_axes_differs_only_in_tiling() {
    for uv in [[0.3, 0.4], [0.6, 0.5]] {
        let (framed, plain) = (at("top", uv), at("plain", uv));
        // The tile without a seam blends only near its edges.
        assert!((framed - plain).abs() < 1e-15, "{framed} {plain}");
    }
    // A lap further it is another place of the block.
    assert!((at("top", [0.3, 0.4]) - at("top", [1.3, 0.4])).abs() > 1e-7);
    assert!((at("plain", [0.3, 0.4]) - at("plain", [1.3, 0.4])).abs() < 1e-9);
}

#[test]
fn places_in_the_body_are_told_as_texture_coordinates() {
    let Engine { scene, names, .. } = open(CUBE).unwrap();
    let uv = |name: &str, point: [f64; 3]| scene.uv_at(names.surfaces[name], point).unwrap();
    assert_eq!(uv("top", [0.01, 0.03, 0.0]), Some([0.25, 0.75]));
    assert_eq!(uv("front", [0.01, 0.0, -0.03]), Some([0.25, 0.75]));
    assert_eq!(uv("side", [0.04, 0.01, -0.03]), Some([0.25, 0.75]));
    assert_eq!(uv("plain", [0.01, 0.0, 0.0]), None);
    let body_of_glam = scene.uv_at(names.surfaces["top"], glam::DVec3::new(0.02, 0.0, 0.5)).unwrap();
    assert_eq!(body_of_glam, Some([0.5, 0.0]), "from any library's vectors, and from above");
}

#[test]
fn a_frame_that_is_none_is_refused_with_file_and_field() {
    for (frame, wrong) in [
        ("frame = { u_axis = [0, 0, 0] }", "frame: u_axis"),
        ("frame = { v_axis = [1, 1, 0] }", "frame: v_axis"),
        ("frame = { origin_m = [1e9, 0, 0] }", "frame: origin_m"),
        ("frame = { origin_m = [1, 0] }", "frame: origin_m"),
        ("frame = { w_axis = [1, 0, 0] }", "frame: w_axis"),
        ("frame = 3", "frame"),
    ] {
        let scene = format!(
            "[[surface]]\nname = \"s\"\nsolid = \"granite\"\nwidth_m = 0.04\nheight_m = 0.04\n{frame}\n"
        );
        let error = open(&scene).err().unwrap();
        assert!(error.starts_with("scene.toml: surface 1 \"s\": ") && error.contains(wrong), "{error}");
    }
}
