//! Record: what was reported, as a contact log; and a log rendered into WAV files, with the bits of `asperity render --kernel portable`.

use crate::exchange::{answer, done, inbox_text};
use crate::session;
use asperity::files::contact_log::ContactLog;
use asperity::open::Edits;
use asperity::offline::{self, Options};
use asperity::NoTap;
use std::cell::RefCell;
use std::io::Cursor;

thread_local! {
    /// The haptic channels of the last log that was rendered, as a WAV file.
    static HAPTIC: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Records from now on.
#[unsafe(no_mangle)]
pub extern "C" fn asp_record_start() -> u32 {
    done(session::with(|session| {
        session.scene.start_recording(&session.names);
        Ok(())
    }))
}

/// Ends the recording. Outbox: the log, JSON Lines.
#[unsafe(no_mangle)]
pub extern "C" fn asp_record_stop() -> u32 {
    done(session::with(|session| {
        let mut lines = Vec::new();
        session.scene.stop_recording().write(&mut lines).map_err(|error| error.to_string())?;
        answer(lines);
        Ok(())
    }))
}

/// Renders the log of the inbox with the scene that is open (with exact times), and closes it. Outbox: the audio buses as a WAV file; the haptic
/// channels come with `asp_haptic_wav`.
#[unsafe(no_mangle)]
pub extern "C" fn asp_render_log() -> u32 {
    let render = || -> Result<(), String> {
        let log = ContactLog::parse(&inbox_text()?, "log").map_err(|error| error.to_string())?;
        let session = session::take()?;
        let options = Options { tail_s: session.file.tail_s, ..Options::default() };
        let (scene, renderer, names) = (session.scene, session.renderer, session.names);
        let render = crate::files::with(|files| {
            let mut edits = Edits { files, ..Edits::default() };
            offline::render_edited(scene, renderer, &log, &names, &options, &mut edits, &mut NoTap)
        })
        .map_err(|error| error.to_string())?;
        HAPTIC.set(wav(&render.haptic, render.sample_rate_hz)?);
        answer(wav(&render.audio, render.sample_rate_hz)?);
        Ok(())
    };
    done(render())
}

/// Outbox: the haptic channels of the log that was rendered last, as a WAV file.
#[unsafe(no_mangle)]
pub extern "C" fn asp_haptic_wav() -> u32 {
    answer(HAPTIC.take());
    1
}

/// A file of 32-bit floating point, as the program writes it.
fn wav(channels: &[Vec<f32>], rate_hz: f64) -> Result<Vec<u8>, String> {
    let spec = hound::WavSpec {
        channels: channels.len() as u16,
        sample_rate: rate_hz.round() as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut bytes = Cursor::new(Vec::new());
    let mut write = || {
        let mut writer = hound::WavWriter::new(&mut bytes, spec)?;
        let frames = channels.first().map_or(0, Vec::len);
        for frame in 0..frames {
            channels.iter().try_for_each(|channel| writer.write_sample(channel[frame]))?;
        }
        writer.finalize()
    };
    write().map_err(|error: hound::Error| error.to_string())?;
    Ok(bytes.into_inner())
}
