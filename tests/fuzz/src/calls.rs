//! Door of the C library: sequences of calls, by the C program of random calls.

use crate::Door;
// It links what the C program calls.
use asperity_c as _;

pub const DOORS: &[Door] = &[("c", calls)];

unsafe extern "C" {
    fn asperity_calls(data: *const u8, size: usize);
}

fn calls(data: &[u8]) {
    // SAFETY: the function reads that many bytes and keeps none.
    unsafe { asperity_calls(data.as_ptr(), data.len()) }
}
