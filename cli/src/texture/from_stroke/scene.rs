//! Scene, stroke and map of a surface from strokes, which render at once.

use super::input::NamedProbe;
use crate::error::CliError;
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights, Relief};
use asperity_stroke::StrokeSurface;
use asperity_stroke::octaves::OUTER_SCALE_M;
use asperity_stroke::tool::Ring;
use std::f64::consts::PI;

/// Side of a surface without lines, m: longer than the stroke.
const SIDE_M: f64 = 0.5;
/// Length of the stroke, s, and its events a second.
const SECONDS: f64 = 4.0;
const EVENTS_HZ: f64 = 60.0;
/// Texels of a map, and of the shortest line.
const TEXELS: usize = 1024;
const TEXELS_A_PERIOD: f64 = 14.0;
/// Seed of the relief that is drawn into a map.
const SEED: u64 = 61;

/// Map of a surface with lines: they run along v, relief lies beneath.
pub(super) struct Pattern {
    side_m: f64,
    relief_m: f64,
    grey: Vec<u16>,
}

impl Pattern {
    pub(super) fn png(&self) -> Vec<u8> {
        asperity_plot::pixels::png16(TEXELS, TEXELS, &self.grey)
    }
}

/// Draws lines and relief. Mirrored at its edges the map goes on without a seam: it is cut at tops
/// of the strongest line.
pub(super) fn pattern(found: &StrokeSurface) -> Pattern {
    let strongest_m = found.lines[0].period_m;
    let shortest_m = found.lines.iter().map(|line| line.period_m).fold(f64::INFINITY, f64::min);
    let periods = (shortest_m / TEXELS_A_PERIOD * TEXELS as f64 / strongest_m).round().max(2.0);
    let side_m = periods * strongest_m;
    let texel_m = side_m / TEXELS as f64;
    // The map is ridden by the tip itself, so the relief goes in as no tip has ridden it.
    let weights = OctaveWeights::new(&Relief {
        rms_at_1mm_m: found.relief.micro_relief_m,
        outer_scale_m: OUTER_SCALE_M,
        tip_radius_m: 0.0,
        longest_wavelength_m: f64::INFINITY,
    })
    .with_gains_db(&found.relief.octaves_db);
    let field = FractalNoise::new(SEED);
    let mut height_m = vec![0.0; TEXELS * TEXELS];
    let (footprint_m, roughness) = (vec![texel_m; TEXELS], vec![found.relief.roughness; TEXELS]);
    for (row, height_m) in height_m.chunks_mut(TEXELS).enumerate() {
        let position_m: Vec<[f64; 2]> =
            (0..TEXELS).map(|i| [texel_m * (i as f64 + 0.5), texel_m * (row as f64 + 0.5)]).collect();
        let path = NoisePath { position_m: &position_m, footprint_m: &footprint_m };
        field.add(&path, &roughness, &weights, height_m);
        for line in &found.lines {
            for (height_m, [x, _]) in height_m.iter_mut().zip(&position_m) {
                *height_m += line.amplitude_m * (2.0 * PI * x / line.period_m).cos();
            }
        }
    }
    let (low, high) =
        height_m.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let relief_m = (high - low).max(1e-12);
    let grey = height_m.iter().map(|h| ((h - low) / relief_m * 65_535.0).round() as u16).collect();
    Pattern { side_m, relief_m, grey }
}

/// Scene of one surface under the probe that recorded it; its channel is acceleration in m/s².
pub(super) fn scene(
    found: &StrokeSurface,
    probe: &NamedProbe,
    map: Option<&Pattern>,
    has_ring: bool,
) -> String {
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
    let friction = found.friction.map_or(String::new(), |mu| format!("friction = {mu:?}\n"));
    format!(
        "# A surface from a recorded stroke, under the probe that recorded it.\n\
         contacts = \"stroke.jsonl\"\n\n\
         [[body]]\nname = \"body\"\n{body}\n\n\
         [[surface]]\nname = \"stroked\"\nbody = \"body\"\n{source}\
         width_m = {side_m:?}\nheight_m = {side_m:?}\nroughness = {:?}\nmicro_relief_m = {:?}\nouter_scale_m = {OUTER_SCALE_M:?}\n\
         micro_relief_octaves_db = [{}]\n{friction}\n\
         [probe]\n{}\n\
         [[actuator]]\noutput = \"acceleration\"\nfull_scale = 1.0\nhighpass_hz = 0.0\nlimit = false\n",
        found.relief.roughness,
        found.relief.micro_relief_m,
        octaves.join(", "),
        toml::to_string(&probe.table).unwrap_or_default(),
    )
}

/// A stroke at the first speed and force that were recorded.
pub(super) fn stroke(found: &StrokeSurface, map: Option<&Pattern>) -> String {
    let (speed, force) = (found.groups[0].speed_m_s, found.groups[0].force_n);
    let side_m = map.map_or(SIDE_M, |map| map.side_m);
    // Across the lines, a little aslant.
    let velocity = if map.is_some() { [speed, 0.0] } else { [0.99 * speed, 0.14 * speed] };
    let mut text = String::new();
    let last = (SECONDS * EVENTS_HZ) as usize;
    for step in 0..last {
        let t = step as f64 / EVENTS_HZ;
        let uv = velocity.map(|v| 0.05 + v * t / side_m);
        let event = if step == 0 { "\"begin\"" } else { "\"move\"" };
        let place = if step == 0 { ",\"surface\":\"stroked\",\"actuator\":0" } else { "" };
        text.push_str(&format!(
            "{{\"t\":{t:.6},\"event\":{event},\"contact\":1{place},\"uv\":[{:.9},{:.9}],\"velocity_m_s\":[{:?},{:?}],\"normal_force_n\":{force:?}}}\n",
            uv[0], uv[1], velocity[0], velocity[1]
        ));
    }
    text.push_str(&format!("{{\"t\":{SECONDS:.6},\"event\":\"end\",\"contact\":1}}\n"));
    text
}

/// The ring as a modes file.
pub(super) fn ring_file(ring: &Ring) -> Result<String, CliError> {
    let modes: Vec<serde_json::Value> = ring
        .0
        .iter()
        .map(|mode| {
            serde_json::json!({
                "frequency_hz": mode.frequency_hz, "decay_per_s": mode.decay_per_s,
                "amplitude": mode.amplitude, "phase_rad": mode.phase_rad,
            })
        })
        .collect();
    let model = serde_json::json!({
        "format": "asperity.modes", "version": 1, "source": "the body under a recorded stroke",
        "impulse_n_s": 1.0, "modes": modes,
    });
    serde_json::to_string_pretty(&model)
        .map_err(|error| CliError::new("ring.modes.json", error, "please report it with the recording"))
}
