//! `AsperitySurface`: what is touched.

use crate::normal_map;
use crate::picture;
use crate::res_files::ResFiles;
use godot::classes::base_material_3d::{Feature, TextureChannel, TextureParam};
use godot::classes::{BaseMaterial3D, Texture2D};
use godot::prelude::*;
use toml::{Table, Value};

/// Surface as a finger feels it, from the maps the renderer draws. Numbers below 0 are not
/// told: then `table`, the body's material or the engine's default says them.
#[derive(GodotClass)]
#[class(init, base = Resource)]
pub struct AsperitySurface {
    /// Span of uv 0 to 1 along u, m.
    #[export]
    #[init(val = 1.0)]
    width_m: f64,
    /// Span of uv 0 to 1 along v, m.
    #[export]
    #[init(val = 1.0)]
    height_m: f64,
    /// Number of repetitions of the maps within uv 0 to 1, as a material's `uv1_scale`: a finger's
    /// uv times this is where it is on them.
    #[export]
    #[init(val = Vector2::ONE)]
    uv_scale: Vector2,
    /// Place of uv 0 on the maps, as a material's `uv1_offset`.
    #[export]
    uv_offset: Vector2,
    /// Heights: white is high.
    #[export]
    displacement: Option<Gd<Texture2D>>,
    /// Height of white above black, m.
    #[export]
    #[init(val = 0.001)]
    relief_m: f64,
    /// Roughness, black 0 to white 1.
    #[export]
    roughness_map: Option<Gd<Texture2D>>,
    /// Which channel of `roughness_map`: "luma", "r", "g", "b" or "a"; of a grey one "luma".
    #[export]
    #[init(val = "luma".into())]
    roughness_channel: GString,
    /// Roughness 0 to 1, the same everywhere, where there is no map.
    #[export]
    #[init(val = -1.0)]
    roughness: f64,
    /// Coulomb friction.
    #[export]
    #[init(val = -1.0)]
    friction: f64,
    /// Further keys of a scene file's [[surface]], TOML: `solid = "granite"`, `wrap = "clamp"`. The
    /// fields above count more.
    #[export(multiline)]
    table: GString,
    base: Base<Resource>,
}

/// Names of what lies in memory, as the table calls it.
const HEIGHTS: &str = "displacement";
const ROUGHNESS: &str = "roughness_map";

/// A parallax offset of 1 at Godot's `heightmap_scale` 100: its shader multiplies the scale by 0.01
/// and takes the result for uv.
const UV_PER_HEIGHTMAP_SCALE: f64 = 0.01;

#[godot_api]
impl AsperitySurface {
    /// The surface that a material draws: its heightmap, its roughness and its roughness texture.
    /// `width_m` and `height_m` are what uv 0 to 1 spans. The relief follows from
    /// `heightmap_scale`, as the shader shows it; set `relief_m` if it was exaggerated. Without a
    /// heightmap it has the heights whose normals the material draws, which takes some tenths of a
    /// second for a million texels; normals that are none of a surface's are not felt, and a
    /// warning says why. Null, and an error, where there is no material.
    #[func]
    fn from_material(material: Option<Gd<BaseMaterial3D>>, width_m: f64, height_m: f64) -> Option<Gd<Self>> {
        let Some(material) = material else {
            godot_error!("AsperitySurface.from_material: material is null; give a StandardMaterial3D");
            return None;
        };
        let mut surface = Self::new_gd();
        {
            let mut made = surface.bind_mut();
            (made.width_m, made.height_m) = (width_m, height_m);
            let (scale, offset) = (material.get_uv1_scale(), material.get_uv1_offset());
            (made.uv_scale, made.uv_offset) =
                (Vector2::new(scale.x, scale.y), Vector2::new(offset.x, offset.y));
            if material.get_feature(Feature::HEIGHT_MAPPING) {
                made.displacement = material.get_texture(TextureParam::HEIGHTMAP);
                made.relief_m = f64::from(material.get_heightmap_scale()).abs()
                    * UV_PER_HEIGHTMAP_SCALE
                    * made.spans_m()[0];
            }
            if made.displacement.is_none() {
                made.feel_normals(&material);
            }
            made.roughness = f64::from(material.get_roughness());
            made.roughness_map = material.get_texture(TextureParam::ROUGHNESS);
            made.roughness_channel = match material.get_roughness_texture_channel() {
                TextureChannel::RED => "r",
                TextureChannel::GREEN => "g",
                TextureChannel::BLUE => "b",
                TextureChannel::ALPHA => "a",
                _ => "luma",
            }
            .into();
        }
        Some(surface)
    }
}

impl AsperitySurface {
    /// Spans of one repetition of the maps along u and v, m.
    fn spans_m(&self) -> [f64; 2] {
        let [u, v] = [self.uv_scale.x, self.uv_scale.y].map(|scale| f64::from(scale).abs());
        [self.width_m / u, self.height_m / v]
    }

    /// Place of a mesh's uv on the maps.
    pub(crate) fn on_maps(&self, uv: Vector2) -> Vector2 {
        uv * self.uv_scale + self.uv_offset
    }

    /// Place in metres as one on the maps.
    pub(crate) fn in_spans(&self, place_m: Vector2) -> Vector2 {
        let [u, v] = self.spans_m();
        Vector2::new(place_m.x / u as f32, place_m.y / v as f32)
    }

    /// Takes the heights of a material's normal map, where it draws one.
    fn feel_normals(&mut self, material: &Gd<BaseMaterial3D>) {
        let normals = material.get_texture(TextureParam::NORMAL);
        let Some(normals) = normals.filter(|_| material.get_feature(Feature::NORMAL_MAPPING)) else { return };
        let scale = f64::from(material.get_normal_scale());
        match normal_map::heightmap(&normals, scale >= 0.0) {
            Ok((heights, relief_px)) => {
                let texel_m = self.spans_m()[0] / f64::from(normals.get_width().max(1));
                self.relief_m = relief_px * texel_m * scale.abs();
                self.displacement = Some(heights.upcast());
            }
            Err(why) => godot_warn!("AsperitySurface.from_material: the normal map is not felt: {why}"),
        }
    }

    /// The keys of a scene file's `[[surface]]`, and the pictures that they name.
    pub(crate) fn told(&self, name: &str) -> Result<(String, ResFiles), String> {
        let mut files = ResFiles::default();
        let mut table = table_of(&self.table.to_string())?;
        let mut say = |key: &str, value: Value| table.insert(key.into(), value);
        if self.uv_scale.x == 0.0 || self.uv_scale.y == 0.0 {
            return Err(format!("uv_scale: {} is refused; neither may be 0", self.uv_scale));
        }
        let [width_m, height_m] = self.spans_m();
        say("width_m", Value::Float(width_m));
        say("height_m", Value::Float(height_m));
        for (key, number) in [("friction", self.friction)] {
            if number >= 0.0 {
                say(key, Value::Float(number));
            }
        }
        if let Some(texture) = &self.displacement {
            files.memory.add_picture(HEIGHTS, picture::of(texture, HEIGHTS)?.0);
            say("displacement", Value::String(HEIGHTS.into()));
            say("relief_m", Value::Float(self.relief_m));
        }
        if let Some(texture) = &self.roughness_map {
            let (picture, is_grey) = picture::of(texture, ROUGHNESS)?;
            let channel = if is_grey { "luma".into() } else { self.roughness_channel.to_string() };
            files.memory.add_picture(ROUGHNESS, picture);
            say("roughness", Value::String(ROUGHNESS.into()));
            say("roughness_channel", Value::String(channel));
        } else if self.roughness >= 0.0 {
            say("roughness", Value::Float(self.roughness));
        }
        if !name.is_empty() {
            say("name", Value::String(name.into()));
        }
        Ok((written(&table)?, files))
    }
}

/// The keys of a table that a project gives as text.
pub(crate) fn table_of(text: &str) -> Result<Table, String> {
    text.parse().map_err(|error: toml::de::Error| {
        format!("table: {}; write keys of a scene file, as TOML", error.message().replace('\n', " "))
    })
}

/// The text of a table.
pub(crate) fn written(table: &Table) -> Result<String, String> {
    toml::to_string(table).map_err(|error| error.to_string())
}
