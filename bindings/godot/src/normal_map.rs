//! Normal map: the heights whose normals a material draws.
//!
//! ```text
//! height of white above black, m = that of the heights of the normals, texels · normal_scale · width_m / texels a row
//! ```

use crate::picture;
use asperity_pictures::normal_map::{NormalMapOptions, heights_from_normals};
use asperity_surface::picture::Channel;
use asperity_surface::raster::Raster;
use godot::classes::image::Format;
use godot::classes::{Image, ImageTexture, Texture2D};
use godot::prelude::*;

/// The heightmap of a normal map, white is high (or low, of one that is drawn the other way round),
/// and the height of white above black in texels. Takes some tenths of a second for a million
/// texels.
pub(crate) fn heightmap(texture: &Gd<Texture2D>, upright: bool) -> Result<(Gd<ImageTexture>, f64), String> {
    let [red, green, blue] = normals(texture)?;
    let found = heights_from_normals(&red, &green, &blue, &NormalMapOptions::default());
    let heights = found.map_err(|error| error.to_string())?.height_px;
    let (low, high) = heights.range();
    let relief_px = high - low;
    let part = |z: &f64| if relief_px > 0.0 { (z - low) / relief_px } else { 0.5 };
    let white = |z: &f64| if upright { part(z) } else { 1.0 - part(z) };
    let bytes: Vec<u8> = heights.values.iter().flat_map(|z| (white(z) as f32).to_le_bytes()).collect();
    let (width, height) = (heights.width as i32, heights.height as i32);
    let image = Image::create_from_data(width, height, false, Format::RF, &PackedByteArray::from(bytes));
    let drawn = image.as_ref().and_then(ImageTexture::create_from_image);
    Ok((drawn.ok_or("Godot makes no texture of its heights")?, relief_px))
}

/// The three channels of a normal map, 0 to 1. Importers often keep two of them: the third is then
/// the same everywhere.
fn normals(texture: &Gd<Texture2D>) -> Result<[Raster; 3], String> {
    let (picture, is_grey) = picture::of(texture, "it")?;
    if is_grey {
        return Err("it is grey; must have the colours of normals".into());
    }
    let channel = |channel| match picture.channel(channel) {
        Ok(image) => Ok(image.raster),
        Err(problem) => Err(format!("it is no picture of normals: {problem}")),
    };
    Ok([channel(Channel::R)?, channel(Channel::G)?, channel(Channel::B)?])
}
