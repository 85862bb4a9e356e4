//! Scenes of the strokes: published maps with the sizes they are taken to have, and the bodies
//! below them.

use std::path::Path;

/// A surface and the body that it rings.
pub struct Ground {
    /// Stem of the scene's files.
    pub name: &'static str,
    /// What uv 1 spans, m.
    pub size_m: [f64; 2],
    /// Height of white over black, m.
    pub relief_m: f64,
    displacement: Map,
    roughness: Option<&'static str>,
    wrap: &'static str,
    modes: &'static str,
    material: &'static str,
}

enum Map {
    Corpus(&'static str),
    Beside(&'static str),
}

/// Only the coin and the wood were measured; the other maps are pictures of things whose size is
/// guessed from what they show.
pub fn grounds(wood_relief_m: f64) -> Vec<Ground> {
    let square = |side_m: f64| [side_m, side_m];
    let wood_m = super::profile::SAMPLES as f64 * super::profile::STEP_M;
    vec![
        Ground {
            name: "walkway",
            size_m: square(0.2),
            relief_m: 1.5e-3,
            displacement: Map::Corpus("MetalWalkway006_1K-PNG_Displacement.png"),
            roughness: Some("MetalWalkway006_1K-PNG_Roughness.png"),
            wrap: "repeat",
            modes: "faust_churchBell",
            material: "steel",
        },
        Ground {
            name: "corrugated",
            size_m: square(0.2),
            relief_m: 2e-3,
            displacement: Map::Corpus("CorrugatedSteel003_1K-PNG_Displacement.png"),
            roughness: Some("CorrugatedSteel003_1K-PNG_Roughness.png"),
            wrap: "repeat",
            modes: "stk_Vibraphone",
            material: "steel",
        },
        Ground {
            name: "fabric",
            size_m: square(0.1),
            relief_m: 0.3e-3,
            displacement: Map::Corpus("Fabric061_1K-PNG_Displacement.png"),
            roughness: Some("Fabric061_1K-PNG_Roughness.png"),
            wrap: "repeat",
            modes: "tdw_wood_medium_0_mm",
            material: "wood",
        },
        Ground {
            name: "rock",
            size_m: square(0.3),
            relief_m: 10e-3,
            displacement: Map::Corpus("Rock003_1K-PNG_Displacement.png"),
            roughness: None,
            wrap: "repeat",
            modes: "tdw_stone_1_mm",
            material: "stone",
        },
        Ground {
            name: "ground16",
            size_m: square(0.3),
            relief_m: 5e-3,
            displacement: Map::Corpus("Ground048_1K-PNG_Displacement.png"),
            roughness: None,
            wrap: "repeat",
            modes: "faust_roundBigCenter",
            material: "plastic",
        },
        Ground {
            name: "ground8",
            size_m: square(0.3),
            relief_m: 5e-3,
            displacement: Map::Corpus("Ground048_1K-JPG_Displacement.jpg"),
            roughness: None,
            wrap: "repeat",
            modes: "faust_roundBigCenter",
            material: "plastic",
        },
        Ground {
            name: "coin",
            size_m: square(18.9566e-3),
            relief_m: 0.350_987e-3,
            displacement: Map::Corpus("dime_truemap_16bit.png"),
            roughness: None,
            wrap: "mirror",
            modes: "tdw_ceramic_0_mm",
            material: "ceramic",
        },
        Ground {
            name: "wood",
            size_m: square(wood_m),
            relief_m: wood_relief_m,
            displacement: Map::Beside("bass_wood.png"),
            roughness: None,
            wrap: "mirror",
            modes: "csound_Red_Cedar_wood_plate",
            material: "wood",
        },
    ]
}

impl Ground {
    /// The scene file.
    pub fn scene(&self, corpus: &Path, stem: &str) -> String {
        let texture = |name: &str| corpus.join("textures").join(name).display().to_string();
        let displacement = match self.displacement {
            Map::Corpus(name) => texture(name),
            Map::Beside(name) => name.to_owned(),
        };
        let roughness = match self.roughness {
            Some(name) => format!("roughness = '{}'\n", texture(name)),
            None => String::new(),
        };
        format!(
            "contacts = \"{stem}.jsonl\"\n\n\
             [[body]]\nname = \"body\"\nmodes = \"{}.modes.json\"\nmaterial = \"{}\"\n\n\
             [[surface]]\nname = \"ground\"\nbody = \"body\"\ndisplacement = '{displacement}'\n{roughness}\
             width_m = {}\nheight_m = {}\nrelief_m = {}\nwrap = \"{}\"\n",
            self.modes, self.material, self.size_m[0], self.size_m[1], self.relief_m, self.wrap,
        )
    }
}

/// A cube tossed onto a table.
pub const TOSSES: &str = "contacts = \"tosses.jsonl\"\n\n[audio]\ngain = 0.15\n\n\
    [[body]]\nname = \"table\"\nmodes = \"faust_semMidCenter.modes.json\"\nmaterial = \"wood\"\n";
