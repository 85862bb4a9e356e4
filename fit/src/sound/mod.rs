//! From a file to one channel, and the strikes in it.

pub mod onset;
pub(crate) mod packed_file;
pub mod recording;
pub(crate) mod sound_file;
pub(crate) mod sound_format;
pub(crate) mod wav_file;
