//! Decoded pictures: rows of pixels of one to four channels, and one channel of them as a map.
//!
//! Nothing here decodes a file, so that a game that has its textures in memory already hands them
//! over as they are.

mod brightness;
mod ignored;
mod normals;
mod problem;

use crate::deband::deband;
use crate::raster::Raster;
use crate::wrap::Wrap;
pub use ignored::Ignored;
pub use problem::{ImageError, Problem};

/// Most texels a side may have.
pub const MAX_SIDE: u32 = 32_768;
/// Most texels an image may have: 8192 × 8192. Half a gigabyte as a [`Raster`].
pub const MAX_TEXELS: u64 = 1 << 26;
/// Most bytes a file may have.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Which numbers of a pixel are the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Grey, or 0.2126 R + 0.7152 G + 0.0722 B of the stored numbers (Rec. 709).
    #[default]
    Luma,
    /// Red; grey in a grey image.
    R,
    /// Green; grey in a grey image.
    G,
    /// Blue; grey in a grey image.
    B,
    /// Alpha: where packed textures keep the height.
    A,
    /// One number over two channels of 8 bits: 256 R + G.
    Rg,
    /// One number over three channels of 8 bits: 65536 R + 256 G + B.
    Rgb,
}

impl Channel {
    /// Every channel, by the word that files and options write for it.
    pub const ALL: [(&'static str, Self); 7] = [
        ("luma", Self::Luma),
        ("r", Self::R),
        ("g", Self::G),
        ("b", Self::B),
        ("a", Self::A),
        ("rg", Self::Rg),
        ("rgb", Self::Rgb),
    ];

    /// White of one number that channels of 8 bits hold together.
    fn packed_white(self) -> Option<u32> {
        match self {
            Self::Rg => Some(0xFFFF),
            Self::Rgb => Some(0xFF_FFFF),
            _ => None,
        }
    }
}

/// The numbers of a picture, pixel by pixel, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// 0–255.
    U8(Vec<u8>),
    /// 0–65535.
    U16(Vec<u16>),
    /// Heights as they are.
    F32(Vec<f32>),
}

impl Samples {
    fn len(&self) -> usize {
        match self {
            Self::U8(samples) => samples.len(),
            Self::U16(samples) => samples.len(),
            Self::F32(samples) => samples.len(),
        }
    }
}

/// A decoded picture: 1 channel is grey, 2 grey and alpha, 3 red, green and blue, 4 the same and
/// alpha.
///
/// ```
/// use asperity_surface::picture::{Channel, Picture, Samples};
///
/// let grey = Picture::new(2, 1, Samples::U8(vec![0, 255]))?;
/// assert_eq!(grey.channel(Channel::Luma)?.raster.values, [0.0, 1.0]);
/// # Ok::<(), asperity_surface::picture::Problem>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    channels: usize,
    samples: Samples,
    luma: Luma,
}

impl Picture {
    /// A picture of `width` × `height` pixels; how many channels it has follows from the number of
    /// samples.
    ///
    /// # Errors
    /// When there are no pixels, too many, or samples that are not one to four a pixel.
    pub fn new(width: u32, height: u32, samples: Samples) -> Result<Self, Problem> {
        let texels = u64::from(width) * u64::from(height);
        if texels == 0 {
            return Err(Problem::Empty);
        }
        if width > MAX_SIDE || height > MAX_SIDE || texels > MAX_TEXELS {
            return Err(Problem::TooLarge { width, height });
        }
        let (count, texels) = (samples.len(), texels as usize);
        let channels = count / texels;
        if !(1..=4).contains(&channels) || channels * texels != count {
            return Err(Problem::Samples { count, width, height });
        }
        Ok(Self { width: width as usize, height: height as usize, channels, samples, luma: Luma::default() })
    }

    /// Picture whose brightness is that of a JPEG: 0.299 R + 0.587 G + 0.114 B, which is what the
    /// file holds beside two colours that are coarser. By other weights, the colours' errors would
    /// be brightness.
    #[must_use]
    pub fn of_jpeg(self) -> Self {
        Self { luma: Luma::Jpeg, ..self }
    }

    /// Pixels in a row, and rows.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// One channel as a map of a surface: [`channel`](Self::channel), but the brightness of a
    /// normal map is no map of anything.
    ///
    /// # Errors
    /// As [`channel`](Self::channel), and [`Problem::IsNormalMap`].
    pub fn map(&self, channel: Channel) -> Result<ChannelImage, Problem> {
        if channel == Channel::Luma && normals::is_normal_map(self) {
            return Err(Problem::IsNormalMap);
        }
        self.channel(channel)
    }

    /// One channel as heights: integers as 0–1, floating point as it is.
    ///
    /// # Errors
    /// When there is no such channel, or a value is not finite.
    pub fn channel(&self, channel: Channel) -> Result<ChannelImage, Problem> {
        let (width, height) = (self.width, self.height);
        if channel == Channel::A && self.channels % 2 == 1 {
            return Err(Problem::NoAlpha);
        }
        let packed = channel.packed_white();
        let holds_packed = self.channels > 2 && matches!(self.samples, Samples::U8(_));
        if packed.is_some() && !holds_packed {
            return Err(Problem::NotPacked);
        }
        let shape = [width * height, self.channels];
        let (values, step) = match &self.samples {
            Samples::U8(samples) => {
                let white = packed.unwrap_or(255);
                integers(samples.iter().map(|&s| u16::from(s)), shape, white, channel, self.luma)
            }
            Samples::U16(samples) => integers(samples.iter().copied(), shape, 65_535, channel, self.luma),
            Samples::F32(samples) => {
                let mut pixel = [0.0; 4];
                let values = samples.chunks_exact(self.channels).map(|stored| {
                    pixel.iter_mut().zip(stored).for_each(|(to, &from)| *to = f64::from(from));
                    channel_of(&pixel[..self.channels], channel, self.luma)
                });
                (values.collect(), 0.0)
            }
        };
        let raster = Raster { width, height, values };
        match raster.values.iter().position(|v| !v.is_finite()) {
            Some(at) => Err(Problem::NotFinite { x: at % width, y: at / width }),
            None => Ok(ChannelImage { raster, step, ignored: self.ignored(channel) }),
        }
    }
}

/// One channel of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelImage {
    /// Values 0–1 (black to white); EXR values as they are.
    pub raster: Raster,
    /// Distance between two neighbouring levels of the file, in the raster's units; 0 for floating
    /// point. Measured, so that 8-bit data in a 16-bit file is known for what it is.
    pub step: f64,
    /// Further contents of the picture, where no channel was named.
    pub ignored: Option<Ignored>,
}

impl ChannelImage {
    /// The raster without the terraces of coarse quantisation ([`crate::deband`]).
    #[must_use]
    pub fn debanded(&self, wrap: Wrap) -> Raster {
        deband(&self.raster, self.step, wrap)
    }
}

/// The channel of integer pixels as 0–1, and the distance of its levels: the greatest number of
/// which every level is a multiple.
fn integers(
    samples: impl Iterator<Item = u16>,
    [texels, channels]: [usize; 2],
    white: u32,
    channel: Channel,
    luma: Luma,
) -> (Vec<f64>, f64) {
    let mut pixel = [0.0; 4];
    let mut filled = 0;
    let mut common = 0;
    let mut values = Vec::with_capacity(texels);
    for sample in samples {
        pixel[filled] = f64::from(sample);
        filled += 1;
        if filled == channels {
            filled = 0;
            let value = channel_of(&pixel[..channels], channel, luma);
            if common != 1 {
                common = greatest_common_divisor(common, value.round() as u32);
            }
            values.push(value / f64::from(white));
        }
    }
    (values, f64::from(common) / f64::from(white))
}

fn greatest_common_divisor(mut a: u32, mut b: u32) -> u32 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

fn channel_of(pixel: &[f64], channel: Channel, luma: Luma) -> f64 {
    let is_grey = pixel.len() < 3;
    match channel {
        Channel::A => pixel[pixel.len() - 1],
        Channel::Rg => 256.0 * pixel[0] + pixel[1],
        Channel::Rgb => 65_536.0 * pixel[0] + 256.0 * pixel[1] + pixel[2],
        Channel::Luma if !is_grey => luma.of(pixel[0], pixel[1], pixel[2]),
        Channel::G if !is_grey => pixel[1],
        Channel::B if !is_grey => pixel[2],
        _ => pixel[0],
    }
}

/// Conversion of colours to brightness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Luma {
    /// As eyes weigh them (Rec. 709).
    #[default]
    Seen,
    /// As JPEG does (Rec. 601).
    Jpeg,
}

impl Luma {
    /// Weighted so that a grey pixel keeps its number exactly.
    fn of(self, r: f64, g: f64, b: f64) -> f64 {
        let [red, blue] = match self {
            Self::Seen => [0.2126, 0.0722],
            Self::Jpeg => [0.299, 0.114],
        };
        g + red * (r - g) + blue * (b - g)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_of_a_pixel_is_found_where_it_is() {
        let pixel = [51, 102, 204, 255];
        let rgba = Picture::new(1, 1, Samples::U8(pixel.to_vec())).unwrap();
        for (channel, stored) in [(Channel::R, 51), (Channel::G, 102), (Channel::B, 204), (Channel::A, 255)] {
            let value = rgba.channel(channel).unwrap().raster.values[0];
            assert_eq!(value, f64::from(stored) / 255.0);
        }
        let weighted = (0.2126 * 51.0 + 0.7152 * 102.0 + 0.0722 * 204.0) / 255.0;
        let luma = rgba.channel(Channel::Luma).unwrap();
        assert!((luma.raster.values[0] - weighted).abs() < 1e-12);
        let coded = (0.299 * 51.0 + 0.587 * 102.0 + 0.114 * 204.0) / 255.0;
        let jpeg = rgba.clone().of_jpeg();
        assert!((jpeg.channel(Channel::Luma).unwrap().raster.values[0] - coded).abs() < 1e-12);
        assert!((jpeg.brightness(1).unwrap().values[0] - coded).abs() < 1e-12);
        let rgb = Picture::new(1, 1, Samples::U8(pixel[..3].to_vec())).unwrap();
        assert!(matches!(rgb.channel(Channel::A), Err(Problem::NoAlpha)));
    }

    #[test]
    fn eight_bits_in_sixteen_are_known_for_what_they_are() {
        let picture = Picture::new(3, 1, Samples::U16(vec![0, 257, 3 * 257])).unwrap();
        assert_eq!(picture.channel(Channel::Luma).unwrap().step, 257.0 / 65_535.0);
    }

    #[test]
    fn samples_that_make_no_picture_are_refused_with_what_is_needed() {
        let refused = |w, h, samples| Picture::new(w, h, samples).unwrap_err().to_string();
        assert!(refused(2, 2, Samples::U8(vec![0; 3])).contains("3 samples do not fill 2 × 2 pixels"));
        assert!(refused(1, 1, Samples::U8(vec![0; 5])).contains("one to four"));
        assert!(refused(0, 7, Samples::U8(Vec::new())).contains("at least 1 × 1"));
        assert!(refused(MAX_SIDE + 1, 1, Samples::U8(vec![0; 9])).contains("too many"));
        let bad = Picture::new(2, 1, Samples::F32(vec![0.0, f32::NAN])).unwrap();
        assert!(matches!(bad.channel(Channel::Luma), Err(Problem::NotFinite { x: 1, y: 0 })));
    }
}
