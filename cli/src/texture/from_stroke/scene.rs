//! Scene, stroke and map of a surface from strokes, which render at once.

use super::input::NamedProbe;
use crate::scene_log::rounded;
use asperity::ModalModel;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine};
use asperity_stroke::StrokeSurface;
use asperity_stroke::octaves::OUTER_SCALE_M;
use asperity_stroke::pattern::{Pattern, TEXELS};
use asperity_stroke::tool::Ring;

/// Side of a surface without lines, m: longer than the stroke.
const SIDE_M: f64 = 0.5;
/// Length of the stroke, s, and its events a second.
const SECONDS: f64 = 4.0;
const EVENTS_HZ: f64 = 60.0;
/// Map of a surface with lines as a scene names it.
pub(super) struct Map {
    side_m: f64,
    relief_m: f64,
    /// 16-bit greys as a PNG.
    pub(super) png: Vec<u8>,
}

impl Map {
    pub(super) fn of(found: &StrokeSurface) -> Option<Self> {
        let Pattern { side_m, height_m } = Pattern::of(found)?;
        let (low, high) =
            height_m.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        let relief_m = (high - low).max(1e-12);
        let grey: Vec<u16> =
            height_m.iter().map(|h| ((h - low) / relief_m * 65_535.0).round() as u16).collect();
        Some(Self { side_m, relief_m, png: asperity_plot::pixels::png16(TEXELS, TEXELS, &grey) })
    }
}

/// Scene of one surface under the probe that recorded it; its channel is acceleration in m/s².
pub(super) fn scene(found: &StrokeSurface, probe: &NamedProbe, map: Option<&Map>, has_ring: bool) -> String {
    let side_m = map.map_or(SIDE_M, |map| map.side_m);
    let source = map.map_or(String::new(), |map| {
        format!("displacement = \"displacement.png\"\nrelief_m = {:?}\nwrap = \"mirror\"\n", map.relief_m)
    });
    let body = if has_ring {
        "modes = \"ring.modes.json\""
    } else {
        "stock = \"plate\"\nsize_m = 0.3\nmaterial = \"wood\""
    };
    let octaves: Vec<String> = found.relief.octaves_db.iter().map(|db| format!("{db:.2}")).collect();
    let key = |name: &str, value: Option<f64>| value.map_or(String::new(), |x| format!("{name} = {x:?}\n"));
    let friction = key("friction", found.friction);
    let compliance = key("compliance_m_n", found.compliance.map(|compliance| compliance.m_n));
    format!(
        "# A surface from a recorded stroke, under the probe that recorded it.\n\
         contacts = \"stroke.jsonl\"\n\n\
         [[body]]\nname = \"body\"\n{body}\n\n\
         [[surface]]\nname = \"stroked\"\nbody = \"body\"\n{source}\
         width_m = {side_m:?}\nheight_m = {side_m:?}\nroughness = {:?}\nmicro_relief_m = {:?}\nouter_scale_m = {OUTER_SCALE_M:?}\n\
         micro_relief_octaves_db = [{}]\n{friction}{compliance}\n\
         [probe]\n{}\n\
         [[actuator]]\noutput = \"acceleration\"\nfull_scale = 1.0\nlowpass_hz = 0.0\nhighpass_hz = 0.0\nlimit = false\n",
        found.relief.roughness,
        found.relief.micro_relief_m,
        octaves.join(", "),
        toml::to_string(&probe.table).unwrap_or_default(),
    )
}

/// A stroke at the first speed and force that were recorded.
pub(super) fn stroke(found: &StrokeSurface, map: Option<&Map>) -> ContactLog {
    let (speed, force) = (found.groups[0].speed_m_s, found.groups[0].force_n);
    let side_m = map.map_or(SIDE_M, |map| map.side_m);
    // Across the lines, a little aslant.
    let velocity = if map.is_some() { [speed, 0.0] } else { [0.99 * speed, 0.14 * speed] };
    let samples = (0..(SECONDS * EVENTS_HZ) as usize).map(|step| {
        let t = step as f64 / EVENTS_HZ;
        let uv = velocity.map(|v| rounded(0.05 + v * t / side_m, 9));
        (rounded(t, 6), ContactSample::new(uv, force).sliding(velocity))
    });
    ContactLog { lines: LogLine::contact(1, ("stroked", LogHand::felt_by(0)), samples, SECONDS) }
}

/// The ring as a modes file.
pub(super) fn ring_file(ring: &Ring) -> ModalModel {
    let source = "the body under a recorded stroke".to_owned();
    ModalModel { source, impulse_n_s: 1.0, modes: ring.0.clone(), ..ModalModel::silent() }
}
