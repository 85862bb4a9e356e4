//! Channels of a picture that nobody asked for: colours where a map is grey, an alpha that varies.
//!
//! Packed textures keep heights in alpha, or occlusion, roughness and metal in red, green and blue.
//! Their brightness is a map of nothing, and no error either: a map that was saved in colour is
//! read by its brightness.

use super::{Channel, Picture, Samples};

/// Mean distance of a pixel's strongest and weakest colour from which a picture is coloured, of
/// white: JPEG leaves 0.01 of a grey one, wood and stone have 0.1.
const COLOURED: f64 = 0.03;
/// Range of an alpha that is a map, of white.
const VARIES: f64 = 0.1;
/// Pixels that are looked at.
const LOOKED_AT: usize = 4096;

/// Contents of a picture besides the brightness that was read of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ignored {
    /// Its red, green and blue differ.
    Colours,
    /// Its alpha varies.
    Alpha,
}

impl std::fmt::Display for Ignored {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Colours => "is coloured, and its brightness is read",
            Self::Alpha => "has an alpha that varies, and its brightness is read",
        })
    }
}

impl Picture {
    /// Channels that are read past where the brightness is taken.
    pub(super) fn ignored(&self, channel: Channel) -> Option<Ignored> {
        if channel != Channel::Luma || self.channels == 1 {
            return None;
        }
        let pixels = self.width * self.height;
        let step = pixels.div_ceil(LOOKED_AT);
        let looked_at = || (0..pixels).step_by(step).map(|pixel| self.pixel(pixel));
        let is_coloured = self.channels > 2 && {
            let spread = |[r, g, b, _]: [f64; 4]| r.max(g).max(b) - r.min(g).min(b);
            looked_at().map(spread).sum::<f64>() > COLOURED * looked_at().count() as f64
        };
        let alpha = |[.., a]: [f64; 4]| a;
        let range = looked_at()
            .map(alpha)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], a| [low.min(a), high.max(a)]);
        // Where alpha varies, it is the height that people pack beside a colour.
        let varies = self.channels.is_multiple_of(2) && range[1] - range[0] > VARIES;
        match (varies, is_coloured) {
            (true, _) => Some(Ignored::Alpha),
            (false, true) => Some(Ignored::Colours),
            _ => None,
        }
    }

    /// Hands over the colour of every pixel, as 0–1 of white, where there are colours.
    pub fn each_colour(&self, mut take: impl FnMut([f64; 3])) {
        if self.channels < 3 {
            return;
        }
        for pixel in 0..self.width * self.height {
            let [r, g, b, _] = self.pixel(pixel);
            take([r, g, b]);
        }
    }

    /// A pixel as 0–1 of white; what there is not is 0.
    fn pixel(&self, pixel: usize) -> [f64; 4] {
        let first = pixel * self.channels;
        let mut found = [0.0; 4];
        for (channel, to) in found.iter_mut().take(self.channels).enumerate() {
            *to = match &self.samples {
                Samples::U8(samples) => f64::from(samples[first + channel]) / 255.0,
                Samples::U16(samples) => f64::from(samples[first + channel]) / 65_535.0,
                Samples::F32(samples) => f64::from(samples[first + channel]),
            };
        }
        if self.channels == 2 { [found[0], found[0], found[0], found[1]] } else { found }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ignored(channels: usize, pixel: impl Fn(usize) -> Vec<u8>) -> Option<Ignored> {
        let samples: Vec<u8> = (0..64 * 64).flat_map(pixel).collect();
        assert_eq!(samples.len(), 64 * 64 * channels);
        Picture::new(64, 64, Samples::U8(samples)).unwrap().channel(Channel::Luma).unwrap().ignored
    }

    #[test]
    fn packed_channels_are_seen_and_grey_saved_in_colour_is_grey() {
        let v = |at: usize| (at % 200) as u8;
        assert_eq!(ignored(3, |at| vec![v(at), v(at + 1), v(at + 2)]), None);
        assert_eq!(ignored(4, |at| vec![v(at), v(at), v(at), 255]), None);
        assert_eq!(ignored(1, |at| vec![v(at)]), None);
        assert_eq!(ignored(3, |at| vec![255, v(at), 0]), Some(Ignored::Colours));
        assert_eq!(ignored(4, |at| vec![90, 60, 30, v(at)]), Some(Ignored::Alpha));
        assert_eq!(ignored(2, |at| vec![128, v(at)]), Some(Ignored::Alpha));
    }

    #[test]
    fn nothing_is_read_past_where_a_channel_is_named() {
        let samples = (0..3 * 64 * 64).map(|at| (at * 37 % 251) as u8).collect();
        let picture = Picture::new(64, 64, Samples::U8(samples)).unwrap();
        assert_eq!(picture.channel(Channel::R).unwrap().ignored, None);
        assert_eq!(picture.channel(Channel::Luma).unwrap().ignored, Some(Ignored::Colours));
    }

    #[test]
    fn a_height_over_two_or_three_channels_is_one_number() {
        let heights = [0_u32, 1, 255, 256, 40_000, 65_535];
        let rg = heights.iter().flat_map(|&h| [(h >> 8) as u8, h as u8, 7]).collect();
        let picture = Picture::new(6, 1, Samples::U8(rg)).unwrap();
        let read = picture.channel(Channel::Rg).unwrap();
        for (value, height) in read.raster.values.iter().zip(heights) {
            assert!((value - f64::from(height) / 65_535.0).abs() < 1e-12);
        }
        assert!((read.step - 1.0 / 65_535.0).abs() < 1e-12);
        // Terrarium: height = 256 R + G + B / 256 − 32768 m.
        let rgb = picture.channel(Channel::Rgb).unwrap().raster.values[4];
        assert!((rgb * 16_777_215.0 - (256.0 * 40_000.0 + 7.0)).abs() < 1e-6);
        for samples in [Samples::U8(vec![0; 6]), Samples::U16(vec![0; 18]), Samples::F32(vec![0.0; 18])] {
            let picture = Picture::new(6, 1, samples).unwrap();
            assert!(matches!(picture.channel(Channel::Rg), Err(super::super::Problem::NotPacked)));
        }
    }
}
