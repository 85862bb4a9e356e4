//! Picture: a texture's samples, as the engine takes them.

use asperity::surface::picture::{Picture, Samples};
use godot::classes::Texture2D;
use godot::classes::image::Format;
use godot::global::Error;
use godot::prelude::*;

/// The samples of a texture, and whether it is grey; `name` is what sentences call it.
pub(crate) fn of(texture: &Gd<Texture2D>, name: &str) -> Result<(Picture, bool), String> {
    let image = texture.get_image().ok_or_else(|| {
        format!("{name}: the texture has no image; must have one (a NoiseTexture2D needs a moment: await its `changed`)")
    })?;
    let mut image = image.duplicate_resource();
    if image.is_compressed() && image.decompress() != Error::OK {
        return Err(format!("{name}: Godot cannot decompress it; import it as lossless"));
    }
    let (width, height) = (image.get_width() as u32, image.get_height() as u32);
    let is_byte = matches!(
        image.get_format(),
        Format::L8
            | Format::LA8
            | Format::R8
            | Format::RG8
            | Format::RGB8
            | Format::RGBA8
            | Format::RGBA4444
            | Format::RGB565
    );
    // Mipmaps, where there are some, follow the picture itself.
    let texels = width as usize * height as usize;
    let (samples, is_grey) = if is_byte {
        // Grey stays grey: three equal channels would be weighted as colours.
        let is_grey = matches!(image.get_format(), Format::L8 | Format::R8);
        if !is_grey {
            image.convert(Format::RGBA8);
        }
        let mut bytes = image.get_data().to_vec();
        bytes.truncate(texels * if is_grey { 1 } else { 4 });
        (Samples::U8(bytes), is_grey)
    } else {
        let is_grey = matches!(image.get_format(), Format::RF | Format::RH);
        image.convert(if is_grey { Format::RF } else { Format::RGBAF });
        let data = image.get_data().to_vec();
        let count = texels * if is_grey { 1 } else { 4 };
        let numbers = data.as_chunks().0.iter().take(count).map(|four| f32::from_le_bytes(*four));
        (Samples::F32(numbers.collect()), is_grey)
    };
    let picture = Picture::new(width, height, samples).map_err(|problem| format!("{name}: {problem}"))?;
    Ok((picture, is_grey))
}
