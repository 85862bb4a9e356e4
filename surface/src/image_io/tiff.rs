//! TIFF maps of one channel of 32 or 64 bits, as terrain programs write them: `image` reads such
//! numbers only in colour.

use super::{MAX_SIDE, MAX_TEXELS, Picture, Problem, Samples, Source, one_line};
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};

/// The picture, if it is of that kind; leaves the file at its beginning if not.
pub(super) fn read(file: &mut dyn Source) -> Result<Option<Picture>, Problem> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 8 * MAX_TEXELS as usize;
    limits.intermediate_buffer_size = MAX_TEXELS as usize;
    let read = (|| {
        let mut decoder = Decoder::new(&mut *file)?.with_limits(limits);
        if !matches!(decoder.colortype()?, ColorType::Gray(32 | 64)) {
            return Ok(None);
        }
        let size = decoder.dimensions()?;
        if size.0 > MAX_SIDE || size.1 > MAX_SIDE || u64::from(size.0) * u64::from(size.1) > MAX_TEXELS {
            return Ok(Some((size, None)));
        }
        Ok(Some((size, Some(decoder.read_image()?))))
    })();
    let Some(((width, height), numbers)) = read.map_err(translate)? else {
        file.rewind().map_err(Problem::Io)?;
        return Ok(None);
    };
    let Some(numbers) = numbers else { return Err(Problem::TooLarge { width, height }) };
    let samples = match numbers {
        DecodingResult::F32(numbers) => numbers,
        DecodingResult::F64(numbers) => numbers.into_iter().map(|number| number as f32).collect(),
        DecodingResult::U32(numbers) => numbers.into_iter().map(|number| white(number.into(), 32)).collect(),
        DecodingResult::U64(numbers) => numbers.into_iter().map(|number| white(number as f64, 64)).collect(),
        _ => return Err(Problem::Unsupported("TIFF of signed whole numbers".into())),
    };
    Picture::new(width, height, Samples::F32(samples)).map(Some)
}

/// A whole number of so many bits as 0–1.
fn white(number: f64, bits: i32) -> f32 {
    (number / (libm::exp2(f64::from(bits)) - 1.0)) as f32
}

fn translate(error: tiff::TiffError) -> Problem {
    match error {
        tiff::TiffError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            Problem::Io(error)
        }
        tiff::TiffError::UnsupportedError(what) => Problem::Unsupported(one_line(&what)),
        tiff::TiffError::LimitsExceeded => Problem::TooMuchMemory,
        other => Problem::Damaged(one_line(&other)),
    }
}
