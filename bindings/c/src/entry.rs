//! Entry: the frame around every fallible call. No panic leaves it, and its status has a sentence.

use crate::status::{self, ASP_BAD_ARGUMENT, ASP_OK, ASP_PANIC, Failure};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a call, keeps its sentence, gives its status.
pub(crate) fn enter(call: impl FnOnce() -> Result<(), Failure>) -> i32 {
    // What a panic leaves half done is a handle's content, and that is poisoned.
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => {
            status::keep(None);
            ASP_OK
        }
        Ok(Err(failure)) => {
            status::keep(Some(&failure.sentence));
            failure.status
        }
        Err(panic) => {
            let what = panic.downcast_ref::<&str>().map(ToString::to_string);
            let what = what.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
            status::keep(Some(&format!(
                "asperity: a fault in the library ({what}); free the handle, and report this sentence"
            )));
            // Its payload is somebody's own and might panic as well.
            std::mem::forget(panic);
            ASP_PANIC
        }
    }
}

/// The place where a result goes.
pub(crate) fn out<'a, T>(place: *mut T, name: &str) -> Result<&'a mut T, Failure> {
    aligned(place, name)?;
    // SAFETY: not null and aligned; that it points to a T is the caller's promise.
    Ok(unsafe { &mut *place })
}

/// An array that is given with its count.
pub(crate) fn array<'a, T>(
    first: *const T,
    count: usize,
    most: usize,
    name: &str,
) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    if count > most {
        return Err(Failure::new(
            ASP_BAD_ARGUMENT,
            format!("{name}: {count} of them are refused; must be at most {most}"),
        ));
    }
    aligned(first, name)?;
    // SAFETY: not null and aligned, and not longer than memory can be; that so many are there is
    // the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}

/// Array that is written to, checked alike.
pub(crate) fn array_mut<'a, T>(
    first: *mut T,
    count: usize,
    most: usize,
    name: &str,
) -> Result<&'a mut [T], Failure> {
    if count == 0 {
        return Ok(&mut []);
    }
    array(first.cast_const(), count, most, name)?;
    // SAFETY: as in `array`, whose checks have passed; that nobody else uses it meanwhile is the
    // caller's promise.
    Ok(unsafe { std::slice::from_raw_parts_mut(first, count) })
}

/// Refuses pointers that cannot be read through.
pub(crate) fn aligned<T>(pointer: *const T, name: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(Failure::new(ASP_BAD_ARGUMENT, format!("{name}: is null; must point to something")));
    }
    if !pointer.is_aligned() {
        let right = format!("must be a multiple of {}", align_of::<T>());
        return Err(Failure::new(ASP_BAD_ARGUMENT, format!("{name}: lies at an odd address; {right}")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn a_panic_becomes_a_status_and_a_sentence() {
        assert_eq!(enter(|| panic!("four")), ASP_PANIC);
        // SAFETY: the text of this thread, not called since.
        let text = unsafe { CStr::from_ptr(status::asp_last_error()) }.to_str().unwrap();
        assert!(text.contains("four"), "{text}");
        assert_eq!(enter(|| Ok(())), ASP_OK);
        // SAFETY: as above.
        assert_eq!(unsafe { CStr::from_ptr(status::asp_last_error()) }, c"");
    }
}
