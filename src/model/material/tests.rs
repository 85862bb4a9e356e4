use super::*;
use std::fmt::Write;

/// Path of the table, `docs/materials.md`.
const MARKS: [&str; 2] = ["<!-- made from the table of presets -->\n", "<!-- end -->\n"];

#[test]
fn every_preset_is_found_by_its_name_and_is_a_solid() {
    assert!(Material::PRESETS.len() >= 12);
    for preset in Material::PRESETS {
        assert_eq!(Material::by_name(preset.name), Some(preset.material));
        assert_eq!(preset.material.name(), Some(preset.name));
        assert!(preset.material.checked().is_ok(), "{}", preset.name);
        assert!(preset.material.mu_static >= preset.material.mu_kinetic, "{}", preset.name);
    }
    assert_eq!(Material::by_name("unobtainium"), None);
}

#[test]
fn three_constants_are_a_material_and_misspelt_ones_refused() {
    let text = r#"{"young_pa":12e9,"poisson":0.35,"density_kg_m3":720.0}"#;
    assert_eq!(serde_json::from_str::<Material>(text).unwrap(), Material::new(12e9, 0.35, 720.0));
    let all = serde_json::to_string(&Material::GLASS).unwrap();
    assert_eq!(serde_json::from_str::<Material>(&all).unwrap(), Material::GLASS);
    assert!(serde_json::from_str::<Material>(&text.replace("poisson", "poison")).is_err());
}

#[test]
fn numbers_that_no_material_has_are_refused_by_name() {
    for (field, material) in [
        ("young_pa", Material { young_pa: f64::NAN, ..Material::STEEL }),
        ("eta", Material { eta: -1e-3, ..Material::STEEL }),
        ("mu_static", Material { mu_static: 11.0, ..Material::STEEL }),
        ("roughness", Material { roughness: 1.5, ..Material::STEEL }),
    ] {
        assert_eq!(material.checked().unwrap_err().field, field);
    }
}

/// Measured decays of pieces: material, frequency in Hz, T60 in s, and whose. The recordings and
/// tables are public; decays of recordings are those of the fit's strongest mode in that range.
const MEASURED: [(Material, f64, f64, &str); 9] = [
    (Material::ALUMINIUM, 1254.5, 2.05, "a vibraphone bar, recorded"),
    (Material::STEEL, 2095.0, 2.7, "a glockenspiel bar, recorded"),
    (Material::CERAMIC, 1700.0, 2.3, "the bowl of DiffSound, recorded"),
    (Material::WOOD, 764.0, 0.15, "struck wood, a table of ThreeDWorld"),
    (Material::WOOD, 1376.0, 0.35, "a wood block, recorded"),
    (Material::WOOD, 1874.0, 0.22, "claves, recorded"),
    (Material::STONE, 1810.0, 0.128, "a struck stone, a table of ThreeDWorld"),
    (Material::PLA, 286.1, 0.284, "a printed body, faustlibraries"),
    (Material::PLA, 375.0, 0.102, "a smaller one, faustlibraries"),
];

#[test]
fn each_material_rings_as_a_measured_piece_within_a_factor() {
    for (material, frequency_hz, measured_s, piece) in MEASURED {
        let ratio = material.damping().t60_s(frequency_hz) / measured_s;
        assert!((0.4..=2.5).contains(&ratio), "{piece}: {ratio}");
    }
}

#[test]
fn the_printed_table_is_the_one_in_use() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/materials.md");
    let text = std::fs::read_to_string(path).unwrap();
    let begin = text.find(MARKS[0]).unwrap() + MARKS[0].len();
    let end = begin + text[begin..].find(MARKS[1]).unwrap();
    let made = tables();
    if std::env::var_os("ASPERITY_WRITE_DOCS").is_some() {
        std::fs::write(path, format!("{}{made}{}", &text[..begin], &text[end..])).unwrap();
    } else {
        assert!(
            text[begin..end] == made,
            "docs/materials.md is another table; ASPERITY_WRITE_DOCS=1 writes it"
        );
    }
}

fn tables() -> String {
    let mut out = String::from(
        "\n| name | what | E, GPa | ν | ρ, kg/m³ | α, 1/s | η | β, s | μ stick | μ slide | R | micro-relief, µm | T60 at 1 kHz, s |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for MaterialPreset { name, what, material: m, .. } in Material::PRESETS {
        let _ = writeln!(
            out,
            "| `{name}` | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.2} |",
            what.trim_end_matches('.'),
            m.young_pa / 1e9,
            m.poisson,
            m.density_kg_m3,
            m.alpha_per_s,
            m.eta,
            m.beta_s,
            m.mu_static,
            m.mu_kinetic,
            m.roughness,
            (m.micro_relief_m * 1e9).round() / 1e3,
            m.damping().t60_s(1000.0),
        );
    }
    out += "\n| name | E, ν, ρ | α, η, β | friction | finish |\n|---|---|---|---|---|\n";
    for p in Material::PRESETS {
        let sources = [p.elastic_source, p.damping_source, p.friction_source, p.finish_source];
        let _ = writeln!(out, "| `{}` | {} |", p.name, sources.join(" | "));
    }
    out += "\n| measured piece | of | Hz | T60, s | T60 of the preset, s |\n|---|---|---|---|---|\n";
    for (material, frequency_hz, measured_s, piece) in MEASURED {
        let (name, ours_s) = (material.name().unwrap_or_default(), material.damping().t60_s(frequency_hz));
        let _ = writeln!(out, "| {piece} | {name} | {frequency_hz} | {measured_s} | {ours_s:.2} |");
    }
    out + "\n"
}
