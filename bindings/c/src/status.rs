//! Status: what a call answers, and the sentence that goes with it.
//!
//! 0 is well, below 0 is a kind of refusal. The sentence is kept for each thread until its next
//! call; it names the field, what is wrong with it and what would be right.

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::fmt::Display;

/// It is done.
pub const ASP_OK: i32 = 0;
/// A pointer, a size, a count or a text that cannot be.
pub const ASP_BAD_ARGUMENT: i32 = -1;
/// No such handle: freed already, of another kind, or never given out.
pub const ASP_BAD_HANDLE: i32 = -2;
/// Another thread is inside a call with this handle.
pub const ASP_BUSY: i32 = -3;
/// A number or a word that the engine refuses.
pub const ASP_REFUSED: i32 = -4;
/// An id or a name that is not, or no longer, in this scene.
pub const ASP_UNKNOWN: i32 = -5;
/// A queue or a table is full; later it may have room.
pub const ASP_FULL: i32 = -6;
/// A file that cannot be read or written, or does not hold what it should.
pub const ASP_FILE: i32 = -7;
/// No such sound card, or the system refuses it.
pub const ASP_DEVICE: i32 = -8;
/// This build of the library cannot do it.
pub const ASP_UNSUPPORTED: i32 = -9;
/// The header that the program was compiled with is not of this library.
pub const ASP_ABI_MISMATCH: i32 = -10;
/// A fault of this library. The handle is silent from now on and can only be freed.
pub const ASP_PANIC: i32 = -11;

/// Why a call is refused.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: i32,
    pub(crate) sentence: String,
}

impl Failure {
    pub(crate) fn new(status: i32, sentence: impl Display) -> Self {
        Self { status, sentence: sentence.to_string() }
    }
}

thread_local! {
    static LAST: RefCell<Option<CString>> = const { RefCell::new(None) };
}

/// Keeps what the last call of this thread said; `None`: nothing was wrong.
pub(crate) fn keep(sentence: Option<&str>) {
    let text = sentence.map(|sentence| {
        let printable: String = sentence.chars().filter(|c| *c != '\0').collect();
        CString::new(printable).unwrap_or_default()
    });
    // While a thread ends there is nobody left to ask.
    let _ = LAST.try_with(|last| last.replace(text));
}

/// Fault of this thread's last call, "" if nothing was. It is never null, and holds
/// until the thread's next call.
#[unsafe(no_mangle)]
pub extern "C" fn asp_last_error() -> *const c_char {
    let text = LAST.try_with(|last| last.borrow().as_ref().map(|text| text.as_ptr()));
    text.ok().flatten().unwrap_or(c"".as_ptr())
}
