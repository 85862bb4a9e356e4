//! Frames: the audio server's buffers, stereo, as slices.

use godot::classes::native::AudioFrame;

/// Most frames that are rendered at once; the audio server asks for 512.
pub(crate) const CHUNK_FRAMES: usize = 2048;

/// The audio server's buffer.
///
/// # Safety
/// `buffer` is null, or holds `frames` frames that nobody else touches while the slice lives.
pub(crate) unsafe fn of<'a>(buffer: *mut AudioFrame, frames: i32) -> &'a mut [AudioFrame] {
    let frames = usize::try_from(frames).unwrap_or(0);
    if buffer.is_null() || frames == 0 {
        return &mut [];
    }
    // SAFETY: not null, and as long as the caller says.
    unsafe { std::slice::from_raw_parts_mut(buffer, frames) }
}

/// Silence.
pub(crate) fn silence(frames: &mut [AudioFrame]) {
    frames.fill(AudioFrame { left: 0.0, right: 0.0 });
}
