//! Texts of C: UTF-8 that ends with a zero byte.

use crate::status::{ASP_BAD_ARGUMENT, Failure};
use std::ffi::{CStr, c_char};

/// A text that may be missing.
pub(crate) fn optional<'a>(text: *const c_char, name: &str) -> Result<Option<&'a str>, Failure> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: not null; that it ends with a zero byte is the caller's promise.
    let text = unsafe { CStr::from_ptr(text) };
    let text = text.to_str();
    text.map(Some).map_err(|_| Failure::new(ASP_BAD_ARGUMENT, format!("{name}: is no UTF-8; must be")))
}

/// A text that must be there.
pub(crate) fn needed<'a>(text: *const c_char, name: &str) -> Result<&'a str, Failure> {
    optional(text, name)?
        .ok_or_else(|| Failure::new(ASP_BAD_ARGUMENT, format!("{name}: is null; must be a text")))
}

/// Copies a text into a program's memory, cut to fit, with a zero byte behind it. Gives the length
/// of the whole text.
pub(crate) fn copy(text: &str, to: &mut [u8]) -> usize {
    if let Some(room) = to.len().checked_sub(1) {
        let mut end = text.len().min(room);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        to[..end].copy_from_slice(&text.as_bytes()[..end]);
        to[end] = 0;
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_cut_between_letters_and_always_ends() {
        let mut room = [9u8; 6];
        assert_eq!(copy("aäöü", &mut room), 7);
        assert_eq!(&room, b"a\xc3\xa4\xc3\xb6\0");
        let mut room = [9u8; 5];
        copy("aäöü", &mut room);
        assert_eq!(&room[..4], b"a\xc3\xa4\0");
        assert_eq!(copy("x", &mut []), 1);
    }
}
