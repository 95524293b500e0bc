//! What happens where the system has no more memory, in spite of what was counted before: an end with a word, and no abort.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;

/// The system's allocator; where that has nothing left, the program ends as on bad input.
pub struct OrEnd;

fn or_end(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() {
        // Nothing here takes memory itself.
        let _ = writeln!(
            std::io::stderr(),
            "the system has no {bytes} bytes of memory left: use a larger spacing, or a smaller --memory"
        );
        std::process::exit(2);
    }
    pointer
}

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for OrEnd {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        or_end(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        or_end(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as the caller promises.
        or_end(unsafe { System.realloc(pointer, layout, size) }, size)
    }
}
