//! An allocator that counts what a thread does to the heap. A test binary that includes it runs on
//! it.
#![allow(dead_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static WATCHED: Cell<bool> = const { Cell::new(false) };
    static TOUCHED: Cell<u64> = const { Cell::new(0) };
    /// Bytes allocated less bytes freed on this thread.
    static HELD: Cell<i64> = const { Cell::new(0) };
}

fn hold(bytes: i64) {
    HELD.with(|held| held.set(held.get() + bytes));
}

fn note() {
    if WATCHED.with(Cell::get) {
        TOUCHED.with(|touched| touched.set(touched.get() + 1));
    }
}

// SAFETY: every call is passed on to the system allocator unchanged; the counters are plain
// thread-local cells without destructors, so they may be touched inside an allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        hold(layout.size() as i64);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        note();
        hold(-(layout.size() as i64));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        hold(size as i64 - layout.size() as i64);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Heap operations of `work` on this thread.
pub fn heap_operations(work: impl FnOnce()) -> u64 {
    TOUCHED.with(|touched| touched.set(0));
    WATCHED.with(|watched| watched.set(true));
    work();
    WATCHED.with(|watched| watched.set(false));
    TOUCHED.with(Cell::get)
}

/// Bytes that this thread holds.
pub fn held_bytes() -> i64 {
    HELD.with(Cell::get)
}
