//! One list of what is accepted: the reader of scene files, the engine and the documents say the
//! same.

use crate::support;

use asperity::limits::{self, Range, brownian, material, output, probe, sand, solid};
use std::fs;
use support::{Scene, TOML, assert_refused};

/// Where a key stands in a scene file.
#[derive(Clone, Copy)]
enum Place {
    Top,
    Surface,
    Probe,
    Actuator,
    Audio,
    Material,
    Stock,
    Sand,
    Solid,
    Brownian,
}

const ALL: [(Place, &str, Range); 42] = [
    (Place::Top, "sample_rate_hz", output::SAMPLE_RATE_HZ),
    (Place::Surface, "width_m", limits::SIDE_M),
    (Place::Surface, "relief_m", limits::RELIEF_M),
    (Place::Surface, "micro_relief_m", limits::MICRO_RELIEF_M),
    (Place::Surface, "friction", limits::FRICTION),
    (Place::Surface, "roughness", limits::ROUGHNESS),
    (Place::Surface, "scale", limits::combined::FACTOR),
    (Place::Probe, "pad_mass_kg", probe::PAD_MASS_KG),
    (Place::Probe, "pad_stiffness_n_m", probe::PAD_STIFFNESS_N_M),
    (Place::Probe, "pad_damping_n_s_m", probe::PAD_DAMPING_N_S_M),
    (Place::Probe, "finger_mass_kg", probe::FINGER_MASS_KG),
    (Place::Probe, "contact_stiffness_n_m", probe::CONTACT_STIFFNESS_N_M),
    (Place::Probe, "leash_m", probe::LEASH_M),
    (Place::Actuator, "full_scale", output::FULL_SCALE),
    (Place::Actuator, "highpass_hz", output::HIGHPASS_HZ),
    (Place::Audio, "gain", output::AUDIO_GAIN),
    (Place::Material, "young_pa", material::YOUNG_PA),
    (Place::Material, "poisson", material::POISSON),
    (Place::Material, "density_kg_m3", material::DENSITY_KG_M3),
    (Place::Material, "alpha_per_s", material::ALPHA_PER_S),
    (Place::Material, "eta", material::ETA),
    (Place::Material, "beta_s", material::BETA_S),
    (Place::Stock, "size_m", material::SIZE_M),
    (Place::Sand, "depth_m", sand::DEPTH_M),
    (Place::Sand, "talus_deg", sand::TALUS_DEG),
    (Place::Sand, "stiffness_n", sand::STIFFNESS_N),
    (Place::Sand, "exponent_per_m", sand::EXPONENT_PER_M),
    (Place::Sand, "drag_s_per_m", sand::DRAG_S_PER_M),
    (Place::Sand, "wetness", sand::WETNESS),
    (Place::Sand, "grain_m", sand::GRAIN_M),
    (Place::Sand, "tool_radius_m", sand::TOOL_RADIUS_M),
    (Place::Solid, "magnitude", solid::MAGNITUDE),
    (Place::Solid, "frequency", solid::FREQUENCY),
    (Place::Solid, "lacunarity", solid::LACUNARITY),
    (Place::Solid, "persistence", solid::PERSISTENCE),
    (Place::Solid, "texture_factor_per_m", solid::TEXTURE_FACTOR_PER_M),
    (Place::Solid, "amplitude_m", solid::AMPLITUDE_M),
    (Place::Solid, "limit_n", solid::LIMIT_N),
    (Place::Solid, "cap_n", solid::CAP_N),
    (Place::Solid, "viscosity_n_s_m", solid::VISCOSITY_N_S_M),
    (Place::Brownian, "hurst", brownian::HURST),
    (Place::Brownian, "rms_m", brownian::RMS_M),
];

/// A scene in which `key` has `value`.
fn scene_with(place: Place, key: &str, value: f64) -> String {
    let line = format!("{key} = {value:?}").to_lowercase();
    let plate = |lines: &str| TOML.replace("roughness = 0.7", lines);
    let source = |kind: &str, rest: &str| plate(&format!("{kind} = {{ {line}{rest} }}"));
    match (place, key) {
        (Place::Top, _) => format!("{line}\n{TOML}"),
        (Place::Surface, "width_m") => TOML.replace("width_m = 0.1", &line),
        (Place::Surface, _) => plate(&line),
        (Place::Probe, _) => format!("{TOML}\n[probe]\n{line}\n"),
        (Place::Actuator, "full_scale") => TOML.replace("full_scale = 1.0", &line),
        (Place::Actuator, _) => TOML.replace("full_scale = 1.0", &format!("full_scale = 1.0\n{line}")),
        (Place::Audio, _) => format!("{TOML}\n[audio]\n{line}\n"),
        (Place::Material, _) => {
            let rest = [("young_pa", "1e9"), ("poisson", "0.3"), ("density_kg_m3", "2000.0")];
            let rest: Vec<_> =
                rest.iter().filter(|(other, _)| *other != key).map(|(k, v)| format!("{k} = {v}")).collect();
            TOML.replace("material = \"steel\"", &format!("material = {{ {line}, {} }}", rest.join(", ")))
        }
        (Place::Stock, _) => TOML.replace("modes = \"bar.modes.json\"", &format!("stock = \"bar\"\n{line}")),
        (Place::Sand, _) => source("sand", ""),
        (Place::Solid, _) => source("solid", ", preset = \"gravel\""),
        (Place::Brownian, "hurst") => source("brownian", ", rms_m = 1e-4"),
        (Place::Brownian, _) => source("brownian", ", hurst = 0.5"),
    }
}

#[test]
fn what_lies_beyond_a_limit_is_refused_with_the_range() {
    let scene = Scene::new();
    for (place, key, range) in ALL {
        let below = if range.above { range.low } else { range.low - 1e-3 * range.low.abs().max(1e-9) };
        for value in [range.high * 1.001, below, f64::NAN, f64::INFINITY] {
            scene.write("scene.toml", scene_with(place, key, value));
            let refused = scene.render(&[]);
            assert_refused(&refused, &[&format!("{key}: "), range.words]);
        }
    }
}

#[test]
fn the_documents_print_every_range() {
    let formats =
        fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/formats/scene.md")).unwrap();
    let reports = [
        ("uv", limits::UV),
        ("velocity_m_s", limits::VELOCITY_M_S),
        ("normal_force_n", limits::NORMAL_FORCE_N),
        ("closing_m_s", limits::SPEED_M_S),
        ("speed_m_s", limits::SPEED_M_S),
        ("mass_kg", limits::impact::MASS_KG),
        ("radius_m", limits::impact::RADIUS_M),
        ("restitution", limits::impact::RESTITUTION),
    ];
    for (key, range) in ALL.iter().map(|(_, key, range)| (*key, *range)).chain(reports) {
        let row = format!("`{key}` | {}", range.words);
        assert!(formats.contains(&row), "docs/formats/scene.md lacks\n{row}");
    }
}
