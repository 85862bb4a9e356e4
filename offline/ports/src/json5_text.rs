//! JSON as people write it: with comments, trailing commas, keys without quotes.

use serde_json::Value;

/// Deepest nesting of lists and objects: the reader of JSON5 has no limit of its own.
const DEEPEST: usize = 100;

/// Reads JSON, or what JSON5 allows beyond it.
pub(crate) fn value(text: &str) -> Result<Value, String> {
    let text = text.trim_start_matches('\u{feff}');
    let error = match serde_json::from_str(text) {
        Ok(value) => return Ok(value),
        Err(error) => error,
    };
    let mut depth = 0_usize;
    let deepest = text.chars().fold(0, |deepest, c| {
        match c {
            '[' | '{' => depth += 1,
            ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest.max(depth)
    });
    if deepest > DEEPEST {
        return Err(error.to_string());
    }
    // What neither takes is reported in the words of the plain format.
    json5::from_str(text).map_err(|_| error.to_string())
}
