//! Exchange: bytes to and from JavaScript. It asks for an inbox of some size, writes there, calls;
//! what a call answers lies in the outbox until the next one.

use std::cell::RefCell;
use std::fmt::Display;

thread_local! {
    static INBOX: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTBOX: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Makes room for `bytes` bytes, and tells where.
#[unsafe(no_mangle)]
pub extern "C" fn asp_inbox(bytes: usize) -> *mut u8 {
    INBOX.with_borrow_mut(|inbox| {
        inbox.clear();
        inbox.resize(bytes, 0);
        inbox.as_mut_ptr()
    })
}

/// Place of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn asp_outbox() -> *const u8 {
    OUTBOX.with_borrow(Vec::as_ptr)
}

/// Number of its bytes.
#[unsafe(no_mangle)]
pub extern "C" fn asp_outbox_bytes() -> usize {
    OUTBOX.with_borrow(Vec::len)
}

/// Frees what both boxes hold.
#[unsafe(no_mangle)]
pub extern "C" fn asp_forget_boxes() {
    INBOX.take();
    OUTBOX.take();
}

/// Bytes that were handed over.
pub(crate) fn inbox() -> Vec<u8> {
    INBOX.take()
}

/// Bytes that were handed over, as text.
pub(crate) fn inbox_text() -> Result<String, String> {
    String::from_utf8(inbox()).map_err(|_| "the text is not UTF-8; must be".into())
}

/// Lays an answer into the outbox.
pub(crate) fn answer(bytes: impl Into<Vec<u8>>) {
    OUTBOX.set(bytes.into());
}

/// 1, or 0 and a sentence.
pub(crate) fn done(result: Result<(), impl Display>) -> u32 {
    match result {
        Ok(()) => 1,
        Err(sentence) => {
            answer(sentence.to_string());
            0
        }
    }
}
