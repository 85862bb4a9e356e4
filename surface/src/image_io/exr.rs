//! EXR maps: one layer of a file, with the channels that heights, roughness and normals are stored
//! in.
//!
//! A channel is called `R`, `Y` or `V`, or by its layer first: `displacement.R`, `Depth.Z`. A file
//! has layers of that kind, or parts that are named, or both. The layer without a name is the
//! picture; without one, the only layer is. Where several have names, it is unknown which is the
//! map. Values stay as they are; pixels outside the data window are 0.
//!
//! Source: OpenEXR, "Technical introduction" and "Standard attributes" (channel names).

use super::{MAX_SIDE, MAX_TEXELS, Picture, Problem, Samples, Source, one_line};
use exr::block::reader::ChunksReader;
use exr::meta::attribute::ChannelDescription;
use exr::meta::header::Header;

/// Names that channels of a picture go by, in the order of a pixel.
const COLOURS: [[&str; 4]; 2] = [["R", "G", "B", "A"], ["X", "Y", "Z", "A"]];
/// Layer names that are reported of a file that has several.
const TOLD: usize = 6;

/// A layer: its part, its name, and the channels there in the order of a pixel.
struct Layer {
    part: usize,
    name: String,
    channels: Vec<usize>,
}

/// The picture of an EXR file.
pub(super) fn read(file: &mut dyn Source) -> Result<Picture, Problem> {
    let reader = exr::block::read(file, false).map_err(translate)?;
    let Layer { part, channels, .. } = layer(reader.headers())?;
    let header = &reader.headers()[part];
    let window = header.shared_attributes.display_window;
    let [width, height] = [window.size.width(), window.size.height()];
    for size in [window.size, header.layer_size] {
        check(size.width(), size.height())?;
    }
    let position = header.own_attributes.layer_position;
    let offset = [position.x() - window.position.x(), position.y() - window.position.y()].map(i64::from);
    let count = channels.len();
    let mut samples = vec![0.0_f32; width * height * count];
    let chunks = reader
        .filter_chunks(false, |_, tile, block| block.layer == part && tile.is_largest_resolution_level())
        .map_err(translate)?;
    let mut line_samples = Vec::new();
    let read = chunks.decompress_sequential(false, |meta, block| {
        let list = &meta.headers[part].channels;
        for line in block.lines(list) {
            let at = line.location;
            let Some(to) = channels.iter().position(|&channel| channel == at.channel) else { continue };
            let y = at.position.y() as i64 + offset[1];
            if !(0..height as i64).contains(&y) {
                continue;
            }
            values(&mut line_samples, line.value, &list.list[at.channel]);
            let row = &mut samples[y as usize * width * count..][..width * count];
            for (x, value) in line_samples.iter().enumerate() {
                let x = (at.position.x() + x) as i64 + offset[0];
                if (0..width as i64).contains(&x) {
                    row[x as usize * count + to] = *value;
                }
            }
        }
        Ok(())
    });
    read.map_err(translate)?;
    Picture::new(width as u32, height as u32, Samples::F32(samples))
}

fn check(width: usize, height: usize) -> Result<(), Problem> {
    let sides = [width, height].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    if sides.iter().any(|side| *side > MAX_SIDE) || width as u64 * height as u64 > MAX_TEXELS {
        return Err(Problem::TooLarge { width: sides[0], height: sides[1] });
    }
    if width == 0 || height == 0 { Err(Problem::Empty) } else { Ok(()) }
}

/// The numbers of a line, in the byte order of this machine.
fn values(to: &mut Vec<f32>, bytes: &[u8], channel: &ChannelDescription) {
    use exr::meta::attribute::SampleType::{F16, F32, U32};
    to.clear();
    match channel.sample_type {
        F16 => {
            to.extend(bytes.chunks_exact(2).map(|b| exr::prelude::f16::from_ne_bytes([b[0], b[1]]).to_f32()))
        }
        F32 => to.extend(bytes.chunks_exact(4).map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]))),
        U32 => to.extend(bytes.chunks_exact(4).map(|b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]]) as f32)),
    }
}

/// The layer that is the picture.
fn layer(parts: &[Header]) -> Result<Layer, Problem> {
    let mut layers: Vec<Layer> = Vec::new();
    for (part, header) in parts.iter().enumerate().filter(|(_, header)| !header.deep) {
        layers.extend(layers_of(part, header, parts.len() == 1));
    }
    if let Some(unnamed) = layers.iter().position(|layer| layer.name.is_empty()) {
        return Ok(layers.swap_remove(unnamed));
    }
    if layers.len() > 1 {
        let names: Vec<&str> = layers.iter().take(TOLD).map(|layer| layer.name.as_str()).collect();
        let more = if layers.len() > TOLD { ", …" } else { "" };
        return Err(Problem::Layers(names.join(", ") + more));
    }
    layers.pop().ok_or_else(|| Problem::Unsupported("EXR without a flat layer of full resolution".into()))
}

/// The layers of a part; none where channels have fewer samples than pixels. A file's only part is
/// often named after what wrote it.
fn layers_of(part: usize, header: &Header, is_only: bool) -> Vec<Layer> {
    let name = header.own_attributes.layer_name.as_ref().filter(|_| !is_only);
    let whole = name.map(ToString::to_string).unwrap_or_default();
    let mut found: Vec<(String, Vec<(String, usize)>)> = Vec::new();
    if header.channels.list.iter().any(|channel| channel.sampling != exr::math::Vec2(1, 1)) {
        return Vec::new();
    }
    for (at, channel) in header.channels.list.iter().enumerate() {
        let name = channel.name.to_string();
        let (prefix, own) = name.rsplit_once('.').unwrap_or(("", &name));
        match found.iter_mut().find(|(layer, _)| layer == prefix) {
            Some((_, channels)) => channels.push((own.to_uppercase(), at)),
            None => found.push((prefix.to_owned(), vec![(own.to_uppercase(), at)])),
        }
    }
    found
        .into_iter()
        .map(|(prefix, channels)| Layer {
            part,
            name: whole_name(&whole, &prefix),
            channels: in_order(&channels),
        })
        .collect()
}

fn whole_name(part: &str, prefix: &str) -> String {
    match (part, prefix) {
        ("", name) | (name, "") => name.to_owned(),
        (part, prefix) => format!("{part}.{prefix}"),
    }
}

/// Channels of a layer as those of a pixel: colours or a vector, else grey and its alpha.
fn in_order(channels: &[(String, usize)]) -> Vec<usize> {
    let at = |name: &str| channels.iter().find(|(own, _)| own == name).map(|(_, at)| *at);
    for names in COLOURS {
        if let [Some(r), Some(g), Some(b)] = [0, 1, 2].map(|channel| at(names[channel])) {
            return [r, g, b].into_iter().chain(at(names[3])).collect();
        }
    }
    let grey = ["Y", "R", "V", "Z"].into_iter().find_map(at);
    let alpha = at("A");
    let any = channels.iter().map(|(_, at)| *at).find(|at| Some(*at) != alpha);
    match grey.or(any) {
        Some(grey) => std::iter::once(grey).chain(alpha).collect(),
        None => alpha.into_iter().collect(),
    }
}

fn translate(error: exr::error::Error) -> Problem {
    match error {
        exr::error::Error::Io(error) => Problem::Io(error),
        exr::error::Error::NotSupported(what) => Problem::Unsupported(one_line(&what)),
        other => Problem::Damaged(one_line(&other)),
    }
}
