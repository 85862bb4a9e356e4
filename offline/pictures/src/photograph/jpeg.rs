//! Coarseness of a JPEG file, as it says itself.
//!
//! A file is a row of segments: FF, marker, length of two bytes (big-endian, with itself),
//! contents. Table DQT (marker DB) holds a byte (upper half: 0 for divisors of one byte, 1 for two;
//! lower half: number of the table, 0 is the brightness') and 64 divisors from slow waves to fast
//! ones. Source: ITU-T T.81, annexes B.1 and B.2.4.1.

use std::io::{self, BufRead, Seek, SeekFrom};

const START_OF_IMAGE: [u8; 2] = [0xFF, 0xD8];
const QUANTISATION: u8 = 0xDB;
const START_OF_SCAN: u8 = 0xDA;
/// Divisors of a table.
const DIVISORS: usize = 64;
/// Slowest waves of a block, of which the coarsest divisor counts: its mean, and half a wave along
/// each side.
const SLOWEST: usize = 3;

/// The coarsest divisor of the slowest waves of brightness, levels of 255 of a block's waves of
/// unit power; `None` where there is no such table, as in files that are no JPEG. Leaves the file
/// at its beginning.
pub(super) fn divisor(file: &mut (impl BufRead + Seek)) -> Option<f64> {
    let found = search(file).ok().flatten();
    file.rewind().ok()?;
    found
}

fn search(file: &mut (impl BufRead + Seek)) -> io::Result<Option<f64>> {
    if bytes::<2>(file)? != START_OF_IMAGE {
        return Ok(None);
    }
    loop {
        let [fill, mut marker] = bytes::<2>(file)?;
        if fill != 0xFF {
            return Ok(None);
        }
        while marker == 0xFF {
            [marker] = bytes::<1>(file)?;
        }
        if marker == START_OF_SCAN {
            return Ok(None);
        }
        let length = u16::from_be_bytes(bytes::<2>(file)?).saturating_sub(2);
        if marker == QUANTISATION {
            let mut tables = vec![0; usize::from(length)];
            file.read_exact(&mut tables)?;
            if let Some(divisor) = of_brightness(&tables) {
                return Ok(Some(divisor));
            }
        } else {
            file.seek(SeekFrom::Current(i64::from(length)))?;
        }
    }
}

fn bytes<const N: usize>(file: &mut impl BufRead) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// The divisor of the table of number 0, if a segment's tables have it.
fn of_brightness(mut tables: &[u8]) -> Option<f64> {
    while let [head, rest @ ..] = tables {
        let size = if head >> 4 == 0 { 1 } else { 2 };
        let table = rest.get(..size * DIVISORS)?;
        if head & 0x0F == 0 {
            let divisors = table
                .chunks_exact(size)
                .map(|bytes| bytes.iter().fold(0.0, |sum, &b| 256.0 * sum + f64::from(b)));
            return Some(divisors.take(SLOWEST).fold(0.0, f64::max));
        }
        tables = &rest[size * DIVISORS..];
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn file(quality: u8) -> Vec<u8> {
        let mut bytes = Vec::new();
        let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, quality);
        image::RgbImage::from_pixel(16, 16, image::Rgb([90, 120, 150])).write_with_encoder(encoder).unwrap();
        bytes
    }

    #[test]
    fn the_divisor_is_that_of_the_quality() {
        // Annex K's divisors of the slowest waves are 16, 11 and 12; quality 50 leaves them, 75
        // halves them, 90 divides by five.
        for (quality, divisor) in [(50, 16.0), (75, 8.0), (90, 3.0)] {
            let mut file = Cursor::new(file(quality));
            assert_eq!(super::divisor(&mut file), Some(divisor));
            assert_eq!(file.position(), 0);
        }
    }

    #[test]
    fn other_files_and_pieces_of_files_have_none() {
        assert_eq!(divisor(&mut Cursor::new(b"\x89PNG\r\n\x1a\n".to_vec())), None);
        let whole = file(80);
        for length in 0..20 {
            assert_eq!(divisor(&mut Cursor::new(whole[..length].to_vec())), None);
        }
    }

    #[test]
    fn divisors_of_two_bytes_and_a_table_behind_another_are_found() {
        let mut tables = vec![0x01];
        tables.extend([7; 64]);
        tables.push(0x10);
        tables.extend([0x01, 0x02, 0, 9].iter().chain(&[0; 124]));
        assert_eq!(of_brightness(&tables), Some(258.0));
        assert_eq!(of_brightness(&tables[..150]), None);
    }
}
