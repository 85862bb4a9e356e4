//! Kinds of files that are no map yet, by their first bytes, and what to make of them.

/// First bytes, place in the file, kind, and what is read in its place.
type Kind = (&'static [u8], usize, &'static str, &'static str);

const FLOATS: &str = "convert it to EXR or a TIFF of 32 bits";
const WHOLE: &str = "convert it to PNG of 8 or 16 bits";
const TEXTURE: &str = "unpack it to PNG (by `ktx extract`, texconv or the program that packed it)";
const LAYERS: &str = "flatten it and save it as PNG or TIFF";
const DRAWING: &str = "export it as PNG at the size it shall have";
const NO_PICTURE: &str = "download or unpack the picture itself";

/// Sources: the formats' own specifications, and the list of signatures of `file` (magic).
const KINDS: &[Kind] = &[
    (b"#?RADIANCE", 0, "Radiance HDR (RGBE)", FLOATS),
    (b"#?RGBE", 0, "Radiance HDR (RGBE)", FLOATS),
    (b"PF\n", 0, "PFM", FLOATS),
    (b"Pf\n", 0, "PFM", FLOATS),
    (b"\xabKTX 20\xbb", 0, "KTX2", TEXTURE),
    (b"\xabKTX 11\xbb", 0, "KTX", TEXTURE),
    (b"DDS ", 0, "DDS", TEXTURE),
    (b"sB\x13\0", 0, "Basis Universal", TEXTURE),
    (b"8BPS", 0, "Photoshop (PSD)", LAYERS),
    (b"gimp xcf", 0, "GIMP (XCF)", LAYERS),
    (b"\xff\x0a", 0, "JPEG XL", WHOLE),
    (b"\0\0\0\x0cJXL ", 0, "JPEG XL", WHOLE),
    (b"\0\0\0\x0cjP  ", 0, "JPEG 2000", WHOLE),
    (b"\xff\x4f\xff\x51", 0, "JPEG 2000", WHOLE),
    (b"ftypavi", 4, "AVIF", WHOLE),
    (b"ftyphe", 4, "HEIF (HEIC)", WHOLE),
    (b"ftypm", 4, "HEIF or a film", WHOLE),
    (b"\0\0\x01\0", 0, "ICO", WHOLE),
    (b"icns", 0, "ICNS", WHOLE),
    (b"qoif", 0, "QOI", WHOLE),
    (b"farbfeld", 0, "farbfeld", WHOLE),
    (b"\x01\xda", 0, "SGI", WHOLE),
    (b"%PDF", 0, "PDF", DRAWING),
    (b"%!PS", 0, "PostScript", DRAWING),
    (b"<svg", 0, "SVG", DRAWING),
    (b"<?xml", 0, "XML or SVG", DRAWING),
    (b"BLENDER", 0, "a Blender scene", NO_PICTURE),
    (b"PK\x03\x04", 0, "a ZIP archive", NO_PICTURE),
    (b"<!DOCTYPE", 0, "a web page", NO_PICTURE),
    (b"<!doctype", 0, "a web page", NO_PICTURE),
    (b"<html", 0, "a web page", NO_PICTURE),
    (b"version https://git-lfs", 0, "a pointer of Git LFS", "fetch it by `git lfs pull`"),
];

/// Kind of a file that begins so, and what is read in its place.
pub(super) fn of(first: &[u8]) -> Option<(&'static str, &'static str)> {
    let is = |(bytes, at, ..): &&Kind| first.get(*at..).is_some_and(|rest| rest.starts_with(bytes));
    KINDS.iter().find(is).map(|(_, _, kind, instead)| (*kind, *instead))
}
