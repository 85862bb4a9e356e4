//! Shader source of a surface: its heights as functions of WGSL or GLSL (ES 3.00), without
//! uniforms.
//!
//! One text serves both: `$float n = …` declares a constant there and here. Integers wrap in both
//! languages, so that lattice points have the engine's hash; fractions are single precision.

use asperity_dsp::gradient_noise_3d::GradientNoise3d;
use asperity_surface::grating::{GratingKind, GratingParameters};
use asperity_surface::solid_noise::{NoiseKind, SolidCut, SolidNoise, SolidNoiseParameters};
use clap::ValueEnum;
use std::fmt::Write as _;

/// Language of a shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// WebGPU's
    Wgsl,
    /// OpenGL's, ES 3.00 (WebGL2)
    Glsl,
}

const CORNER: &str = "
$fn float #_corner(uint hash, vec3 d) {
  $uint k = (((hash * 0x27D4EB2Fu) >> 16u) * 12u) >> 16u;
  $float s = 1.0 - 2.0 * float(k & 1u);
  $float t = s * (1.0 - float(k & 2u));
  if (k < 4u) { return s * d.x + t * d.y; }
  if (k < 8u) { return s * d.x + t * d.z; }
  return s * d.y + t * d.z;
}
$fn float #_noise(vec3 p, uint seed) {
  $vec3 f = p - floor(p);
  $vec3 g = f - vec3(1.0, 1.0, 1.0);
  $vec3 w = f * f * f * (f * (f * 6.0 - vec3(15.0, 15.0, 15.0)) + vec3(10.0, 10.0, 10.0));
  $uvec3 primes = uvec3(0x9E3779B1u, 0x85EBCA77u, 0xC2B2AE3Du);
  $uvec3 a = uvec3(ivec3(floor(p))) * primes;
  $uvec3 b = a + primes;
  $uint y = a.y ^ a.z ^ seed;
  $uint yy = b.y ^ a.z ^ seed;
  $uint z = a.y ^ b.z ^ seed;
  $uint zz = b.y ^ b.z ^ seed;
  $float low = mix(
    mix(#_corner(a.x ^ y, f), #_corner(b.x ^ y, vec3(g.x, f.y, f.z)), w.x),
    mix(#_corner(a.x ^ yy, vec3(f.x, g.y, f.z)), #_corner(b.x ^ yy, vec3(g.x, g.y, f.z)), w.x), w.y);
  $float high = mix(
    mix(#_corner(a.x ^ z, vec3(f.x, f.y, g.z)), #_corner(b.x ^ z, vec3(g.x, f.y, g.z)), w.x),
    mix(#_corner(a.x ^ zz, vec3(f.x, g.y, g.z)), #_corner(b.x ^ zz, g), w.x), w.y);
  return mix(low, high, w.z);
}
";

const CELLS: &str = "
$fn uint #_hash(uint x) {
  $uint s = x * 747796405u + 2891336453u;
  $uint w = ((s >> ((s >> 28u) + 4u)) ^ s) * 277803737u;
  return (w >> 22u) ^ w;
}
$fn float #_noise(vec3 p, uint seed) {
  $vec3 cell = floor(p);
  $var float best = 3.0;
  for ($var int z = -2; z <= 2; z = z + 1) {
    for ($var int y = -2; y <= 2; y = y + 1) {
      for ($var int x = -2; x <= 2; x = x + 1) {
        $vec3 at = cell + vec3(float(x), float(y), float(z));
        $uvec3 mixed = uvec3(ivec3(at)) * uvec3(0x9E3779B1u, 0x85EBCA77u, 0xC2B2AE3Du);
        $uint first = #_hash(mixed.x ^ mixed.y ^ mixed.z ^ seed);
        $uint second = #_hash(first);
        $uvec3 bits = uvec3(first, second, #_hash(second)) >> uvec3(8u, 8u, 8u);
        $vec3 away = p - at - vec3(float(bits.x), float(bits.y), float(bits.z)) / 16777216.0;
        best = min(best, dot(away, away));
      }
    }
  }
  return sqrt(best);
}
";

/// Heights of a solid: in its block's frame, in that of a body made of it, and as the picture of
/// `texture solid` cuts it.
pub fn of_solid(
    name: &str,
    noise: &SolidNoise,
    parameters: &SolidNoiseParameters,
    language: Language,
) -> String {
    let mut text = String::new();
    let kind = parameters.modules[0].kind;
    text.push_str(if kind == NoiseKind::Voronoi { CELLS } else { CORNER });
    let curve = match kind {
        NoiseKind::Gradient | NoiseKind::Voronoi => "n",
        NoiseKind::Ridged => "(1.0 - abs(n)) * (1.0 - abs(n))",
        NoiseKind::Billow => "2.0 * abs(n) - 1.0",
        NoiseKind::Turbulence => "abs(n)",
    };
    let _ = write!(
        text,
        "$fn float #_octave(vec3 p, uint seed) {{\n  $float n = #_noise(p, seed);\n  return {curve};\n}}\n\
         // Height, m, at a place in the block, m.\n\
         $fn float #_height(vec3 at_m) {{\n  $var float sum = 0.0;\n"
    );
    for (which, module) in parameters.modules.iter().enumerate().filter(|(_, m)| m.magnitude > 0.0) {
        for octave in 0..module.octaves {
            let (per_m, amplitude) = parameters.octave(module, octave);
            let seed = GradientNoise3d::seed(noise.lattice(which, octave));
            let scale = amplitude * parameters.amplitude_m;
            let _ = writeln!(text, "  sum = sum + {scale:?} * #_octave(at_m * {per_m:?}, {seed}u);");
        }
    }
    let SolidCut { u_axis: u, v_axis: v, .. } = SolidCut::SLANTED;
    let [u, v, n] = [u, v, SolidCut::SLANTED.normal()].map(|[x, y, z]| format!("vec3({x:?}, {y:?}, {z:?})"));
    let _ = write!(
        text,
        "  return sum;\n}}\n\
         // Height, m, at a place of a body that is made of it, m (`at_m` of a contact).\n\
         $fn float #_in_body(vec3 at_m) {{\n  return #_height(at_m.x * {u} + at_m.y * {v} + at_m.z * {n});\n}}\n\
         // Height, m, at a place of the picture of `asperity texture solid`, m to the right and
         // down.\n\
         $fn float #_picture(vec2 at_m) {{\n  return #_height(at_m.x * {u} + at_m.y * {v});\n}}\n"
    );
    finished(&text, name, language)
}

/// Heights of a grating: x and y of its block are u and v.
pub fn of_grating(name: &str, grating: &GratingParameters, language: Language) -> String {
    let GratingParameters { pitch_m, amplitude_m, duty, kind } = *grating;
    let level = match kind {
        GratingKind::Sine => "  return #_A * sin(6.283185307179586 * p.x);\n".to_owned(),
        GratingKind::Ridges => format!(
            "  $float t = clamp(({:?} - abs(p.x)) / {:?} + 0.5, 0.0, 1.0);\n  return -#_A * cos(3.141592653589793 * t);\n",
            0.5 * duty,
            grating.flank()
        ),
        GratingKind::Dots => format!(
            "  $float r = min(sqrt(p.x * p.x + p.y * p.y) / {duty:?}, 0.5);\n  return #_A * cos(6.283185307179586 * r);\n"
        ),
    };
    let text = format!(
        "\n// Height, m, at a place of the surface, m; z says nothing.\n\
         $fn float #_height(vec3 at_m) {{\n  $vec3 turns = at_m / {pitch_m:?};\n  \
         $vec3 p = turns - floor(turns + vec3(0.5, 0.5, 0.5));\n{}}}\n\
         // The same at a place of the picture of `asperity texture solid`, m to the right and
         // down.\n\
         $fn float #_picture(vec2 at_m) {{\n  return #_height(vec3(at_m.x, at_m.y, 0.0));\n}}\n",
        level.replace("#_A", &format!("{amplitude_m:?}"))
    );
    finished(&text, name, language)
}

/// The text in a language, its functions beginning with the surface's name.
fn finished(text: &str, name: &str, language: Language) -> String {
    let mut made = format!("// Heights of {name}, metres; made by asperity.\n");
    for line in text.trim_start().lines() {
        let line = match (line.strip_prefix("$fn "), language) {
            (Some(line), Language::Wgsl) => wgsl_signature(line),
            (Some(line), Language::Glsl) => line.to_owned(),
            (None, Language::Wgsl) => wgsl_line(line),
            (None, Language::Glsl) => line.replace("$var ", "").replace('$', ""),
        };
        made.push_str(&line.replace('#', name));
        made.push('\n');
    }
    if language == Language::Glsl {
        made.insert_str(0, "precision highp float;\nprecision highp int;\n");
    }
    made
}

const TYPES: [(&str, &str); 6] = [
    ("float", "f32"),
    ("uint", "u32"),
    ("int", "i32"),
    ("vec2", "vec2<f32>"),
    ("vec3", "vec3<f32>"),
    ("uvec3", "vec3<u32>"),
];

fn wgsl_type(name: &str) -> &str {
    TYPES.iter().find(|(glsl, _)| *glsl == name).map_or(name, |(_, wgsl)| wgsl)
}

/// `float f(vec3 p) {` as WGSL.
fn wgsl_signature(line: &str) -> String {
    let (result, rest) = line.split_once(' ').unwrap_or((line, ""));
    let (name, rest) = rest.split_once('(').unwrap_or((rest, ""));
    let arguments = rest.split_once(')').map_or(rest, |(inside, _)| inside).split(", ");
    let arguments: Vec<String> = arguments
        .filter_map(|argument| argument.split_once(' '))
        .map(|(of, name)| format!("{name}: {}", wgsl_type(of)))
        .collect();
    format!("fn {name}({}) -> {} {{", arguments.join(", "), wgsl_type(result))
}

/// Declarations and conversions of a line as WGSL's.
fn wgsl_line(line: &str) -> String {
    let mut line = line.to_owned();
    for (glsl, _) in TYPES {
        line = line.replace(&format!("$var {glsl} "), "var ").replace(&format!("${glsl} "), "let ");
    }
    line.replace("uvec3(", "vec3<u32>(").replace("ivec3(", "vec3<i32>(").replace("float(", "f32(")
}
