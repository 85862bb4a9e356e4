//! `asperity texture from-normals NORMAL.png -o OUT.png`: a normal map becomes a height map.

use super::object::{ObjectOptions, SizeMm};
use super::{channel, positive, refused};
use crate::arguments::{Words, one_of, word_of};
use crate::error::CliError;
use crate::output::{self, Outputs};
use asperity_pictures::from_photo::TEXEL_M;
use asperity_pictures::gradient_field::Derivative;
use asperity_pictures::normal_map::{Green, NormalMapOptions, heights_from_normals};
use asperity_surface::image_io::Channel;
use asperity_surface::raster::Raster;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Make a 16-bit height map of a normal map
#[derive(Debug, Args)]
pub struct Options {
    /// Normal map, tangent space
    #[arg(value_name = "NORMAL.png")]
    pub normals: PathBuf,
    /// 16-bit PNG to write
    #[arg(short, long = "output", value_name = "OUT.png")]
    pub output: PathBuf,
    /// Which way green points; found out unless given
    #[arg(long, value_name = "WAY", value_parser = one_of(GREENS))]
    pub green: Option<Green>,
    /// Operator that took the map's slopes from heights; estimated by default
    #[arg(long, value_name = "HOW", value_parser = one_of(DERIVATIVES))]
    pub derivative: Option<Derivative>,
    /// Take x from alpha: DXT5nm, where red is blank
    #[arg(long)]
    pub x_in_alpha: bool,
    /// Keep the mean slope of a map that does not tile
    #[arg(long)]
    pub keep_tilt: bool,
    /// Width of the map on the surface, m: adds relief_m to the report
    #[arg(long, value_name = "M", value_parser = positive, conflicts_with = "width_mm")]
    pub width_m: Option<f64>,
    /// The object's file and size
    #[command(flatten)]
    pub object: ObjectOptions,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Conventions of the green channel.
const GREENS: Words<Green, 2> = [
    ("opengl", "Green brightens towards slopes facing up the image", Green::OpenGl),
    ("directx", "Green brightens towards slopes facing down the image", Green::DirectX),
];
/// Ways of taking slopes from heights.
const DERIVATIVES: Words<Derivative, 4> = [
    ("exact", "The true derivative: normals baked from geometry", Derivative::Exact),
    ("central", "Half the difference of the texels on both sides", Derivative::Central),
    (
        "sobel",
        "Central difference averaged across (¼, ½, ¼): many height-to-normal converters",
        Derivative::Sobel,
    ),
    (
        "exact-or-central",
        "Half way between the first two: what is taken when the map does not tell them apart",
        Derivative::ExactOrCentral,
    ),
];

#[derive(Debug, Serialize)]
struct Report {
    width: usize,
    height: usize,
    /// Height of white over black in texels: times the size of a texel it is `relief_m`.
    relief_per_px: f64,
    relief_m: Option<f64>,
    /// Width, where it is given or an object is written.
    #[serde(flatten)]
    size: Option<SizeMm>,
    green: &'static str,
    green_is_certain: bool,
    derivative: &'static str,
    /// True where it was given or found in the map.
    derivative_is_certain: bool,
    tileable: bool,
    /// Degree to which the map was taken for flat places with walls between them, 0–1.
    walls: f64,
    /// Share of the map's slopes that no surface has, 0–1.
    curl: f64,
    warnings: Vec<String>,
    files: Vec<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// When the map cannot be read or the output cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    output::check_destination(&options.output)?;
    options.object.check_destination()?;
    let x = if options.x_in_alpha { Channel::A } else { Channel::R };
    let (red, green) = (channel(&options.normals, x)?, channel(&options.normals, Channel::G)?);
    let blue = match options.x_in_alpha {
        // Such maps keep a copy of y there, or nothing.
        true => Raster::constant(red.width, red.height, 1.0),
        false => channel(&options.normals, Channel::B)?,
    };
    let settings = NormalMapOptions {
        green: options.green.unwrap_or(Green::Detect),
        derivative: options.derivative,
        keep_tilt: options.keep_tilt,
        ..NormalMapOptions::default()
    };
    let x_may_be_in_alpha = !options.x_in_alpha && may_be_in_alpha(options, [&red, &green]);
    let found = heights_from_normals(&red, &green, &blue, &settings).map_err(|error| {
        let in_alpha =
            || CliError::file(&options.normals, "holds no normals in red, green and blue", IN_ALPHA);
        let is_none = error.field == "normal map";
        if is_none && x_may_be_in_alpha { in_alpha() } else { refused(&options.normals, &error) }
    })?;
    let (low, high) = found.height_px.range();
    let relief_per_px = high - low;
    let scaled = found.height_px.map(|z| if relief_per_px > 0.0 { (z - low) / relief_per_px } else { 0.5 });
    let mut outputs = Outputs::new();
    outputs.write_gray16(&options.output, &scaled)?;
    let width_m = options.object.width_mm.map(|mm| 1e-3 * mm).or(options.width_m);
    let told_texel_m = width_m.map(|width_m| width_m / scaled.width as f64);
    let texel_m = told_texel_m.or(options.object.stl.as_ref().map(|_| TEXEL_M));
    let heights_m = found.height_px.map(|z| z * texel_m.unwrap_or(TEXEL_M));
    options.object.write(&mut outputs, &heights_m, texel_m.unwrap_or(TEXEL_M))?;
    let size = texel_m.map(|texel_m| SizeMm::of(&heights_m, texel_m));
    let mut warnings = warnings(options, relief_per_px, size);
    warnings.extend(x_may_be_in_alpha.then(|| IN_ALPHA.to_owned()));
    warnings.extend(doubtful_normals([&red, &green], found.tileable).filter(|_| !x_may_be_in_alpha));
    let report = Report {
        width: scaled.width,
        height: scaled.height,
        relief_per_px,
        relief_m: texel_m.map(|texel_m| relief_per_px * texel_m),
        size,
        green: word_of(&GREENS, found.green),
        green_is_certain: found.green_is_certain,
        derivative: word_of(&DERIVATIVES, found.derivative),
        derivative_is_certain: found.derivative_is_certain,
        tileable: found.tileable,
        walls: found.walls,
        curl: found.curl,
        warnings,
        files: outputs.commit()?,
    };
    output::say_report(&report, options.json, || {
        let size = report.size.map_or(String::new(), |size| {
            let SizeMm { width_mm, height_mm, relief_mm, .. } = size;
            format!("{width_mm:.2} × {height_mm:.2} mm, relief {relief_mm:.3} mm\n")
        });
        let sure = |certain: bool| if certain { "" } else { " (the map does not tell)" };
        format!(
            "{size}{} × {} texels; white is {relief_per_px:.2} texels above black; {} green{}; {} slopes{}; {}{}{}\nwrote {}",
            report.width,
            report.height,
            report.green,
            sure(report.green_is_certain),
            report.derivative,
            sure(report.derivative_is_certain),
            if report.tileable { "tiles" } else { "does not tile" },
            if report.walls > 0.0 { "; flat but for walls, whose short waves are lowered" } else { "" },
            output::warned(&report.warnings),
            options.output.display()
        )
    })
}

fn warnings(options: &Options, relief_per_px: f64, size: Option<SizeMm>) -> Vec<String> {
    let flat =
        (relief_per_px == 0.0).then(|| "all normals of the map are alike: the surface is flat".to_string());
    let coarse = options.object.stl.as_ref().and(size.and_then(|size| size.warning()));
    flat.into_iter().chain(coarse).collect()
}

/// Mean of x or y from which a map that tiles was not stored as normals are.
const LEANS: f64 = 0.1;

/// Way out where x is not in red.
const IN_ALPHA: &str =
    "red is blank or a copy of green, and alpha varies: if x lies there (DXT5nm), write --x-in-alpha";

/// Tests whether red holds nothing of its own while alpha varies.
fn may_be_in_alpha(options: &Options, [red, green]: [&Raster; 2]) -> bool {
    let varies = |raster: &Raster| raster.range().1 - raster.range().0 > LEANS;
    let (low, high) = red.range();
    (low == high || (red == green && varies(green)))
        && channel(&options.normals, Channel::A).is_ok_and(|alpha| varies(&alpha))
}

/// Reports a gamma that normals were stored through.
fn doubtful_normals([red, green]: [&Raster; 2], tileable: bool) -> Option<String> {
    let neutral = [red, green].map(Raster::mean);
    let [x, y] = neutral.map(|mean| 2.0 * mean - 1.0);
    let leans = x.abs().max(y.abs()) > LEANS;
    // A gamma moves both the same way; a surface leans either way.
    let both = x * y > 0.0 && x.abs().min(y.abs()) > LEANS;
    (both || (leans && tileable)).then(|| {
        format!(
            "its normals lean: red and green are {:.0} and {:.0} of 255 on average, where a flat place has 128; a map that was saved through a gamma (sRGB) has to be \
             converted first, or its heights are wrong",
            255.0 * neutral[0],
            255.0 * neutral[1]
        )
    })
}
