//! asperity's offline tools as WebAssembly, for a worker of the page: one recorded hit becomes
//! modes, one photograph a relief.
//!
//! | call | inbox | outbox |
//! |---|---|---|
//! | [`tools_fit`] | samples of one channel | modes, strongest first: frequency, decay, amplitude, phase; all `f64` |
//! | [`tools_photo`] | brightness, row after row | width, height, relief, micro-relief, then heights and roughness, each 0–1; all `f64` |
//!
//! A call that can fail answers 1 when it is done and 0 when it is not; then the outbox holds a
//! sentence that says what is wrong and what would be right. Numbers are little-endian. Exported
//! functions are safe whatever they are given.

// What is exported keeps its name.
#![allow(unsafe_code)]

use asperity_fit::{Fit, FitOptions, Recording};
use asperity_pictures::from_photo::{PhotoOptions, reduced, surface_from_photo};
use asperity_surface::raster::Raster;
use std::cell::RefCell;

/// Most modes of a body that a page plays beside four others.
const MOST_MODES: usize = 100;
/// A mode this far below the strongest in energy is not played, dB.
const FAINTEST_DB: f64 = -70.0;
/// Longest part of a recording that is looked at, s; a browser's visitor does not wait longer.
const LONGEST_S: f64 = 12.0;

thread_local! {
    static INBOX: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTBOX: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Makes room for so many bytes and tells where.
#[unsafe(no_mangle)]
pub extern "C" fn tools_inbox(bytes: usize) -> *mut u8 {
    INBOX.with_borrow_mut(|inbox| {
        inbox.clear();
        inbox.resize(bytes, 0);
        inbox.as_mut_ptr()
    })
}

/// Place of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn tools_outbox() -> *const u8 {
    OUTBOX.with_borrow(|outbox| outbox.as_ptr())
}

/// Length of it, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn tools_outbox_bytes() -> usize {
    OUTBOX.with_borrow(Vec::len)
}

/// Fits modes to a recorded hit. Inbox: samples of one channel, full scale 1.
#[unsafe(no_mangle)]
pub extern "C" fn tools_fit(rate_hz: f64) -> u32 {
    done(fitted(rate_hz).map(|fit| {
        let rows = fit.modes.iter();
        rows.flat_map(|mode| [mode.frequency_hz, mode.decay_per_s, mode.amplitude, mode.phase_rad]).collect()
    }))
}

/// Makes a relief of a photograph. Inbox: brightness as stored (sRGB), 0–1; `texel_m`: what a texel
/// is on the surface, m; `relief_m`: height from the lowest to the highest point, m, or 0: what
/// contrast gives.
#[unsafe(no_mangle)]
pub extern "C" fn tools_photo(width: usize, height: usize, texel_m: f64, relief_m: f64) -> u32 {
    done(relief(width, height, texel_m, relief_m))
}

fn numbers() -> Vec<f64> {
    INBOX.with_borrow(|inbox| inbox.as_chunks().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect())
}

fn fitted(rate_hz: f64) -> Result<Fit, String> {
    let mut samples = numbers();
    // Everything that rings after a hit lies behind its loudest sample; what lies long before is
    // not looked at.
    let longest = (LONGEST_S * rate_hz).clamp(0.0, 1e8) as usize;
    samples.truncate(longest);
    let recording =
        Recording::from_samples("recording", samples, rate_hz).map_err(|error| error.to_string())?;
    let options = FitOptions {
        max_modes: MOST_MODES,
        least_level_db: FAINTEST_DB,
        threads: 1,
        ..FitOptions::default()
    };
    asperity_fit::fit(&recording, &options, &mut |_| {}).map_err(|error| error.to_string())
}

fn relief(width: usize, height: usize, texel_m: f64, relief_m: f64) -> Result<Vec<f64>, String> {
    let values = numbers();
    if width.checked_mul(height) != Some(values.len()) {
        return Err(format!("picture: has {} samples; must have {width} times {height}", values.len()));
    }
    let (picture, reduced_by) = reduced(Raster { width, height, values });
    let options = PhotoOptions {
        texel_m: texel_m * reduced_by as f64,
        relief_m: (relief_m > 0.0).then_some(relief_m),
        ..PhotoOptions::default()
    };
    let surface = surface_from_photo(&picture, &options, |_| {}).map_err(|error| error.to_string())?;
    let size = [surface.displacement.width as f64, surface.displacement.height as f64];
    let scale = [surface.relief_m, surface.micro_relief_m];
    Ok([&size[..], &scale, &surface.displacement.values, &surface.roughness.values].concat())
}

/// Puts what a call has found, or why it failed, into the outbox.
fn done(found: Result<Vec<f64>, String>) -> u32 {
    let (is_done, bytes) = match found {
        Ok(numbers) => (1, numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
        Err(sentence) => (0, sentence.into_bytes()),
    };
    OUTBOX.set(bytes);
    is_done
}
