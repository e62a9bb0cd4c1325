//! An allocator that counts, for tests of how much a slave takes.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The system's allocator, with the bytes that are taken now and the most that were; what is as large as a slave's
/// whole room is asked for and given back, and does not count.
#[derive(Debug)]
pub struct Counting {
    room: usize,
    now: AtomicUsize,
    most: AtomicUsize,
}

impl Counting {
    /// Nothing taken; blocks of `room` bytes and more do not count.
    pub const fn of_slave(room: usize) -> Counting {
        Counting { room, now: AtomicUsize::new(0), most: AtomicUsize::new(0) }
    }

    fn counted(&self, layout: Layout) -> usize {
        if layout.size() < self.room { layout.size() } else { 0 }
    }

    /// The most bytes that were taken beyond what was before, while `action` ran.
    pub fn most<T>(&self, action: impl FnOnce() -> T) -> (T, usize) {
        let before = self.now.load(Relaxed);
        self.most.store(before, Relaxed);
        let result = action();
        (result, self.most.load(Relaxed) - before)
    }
}

// SAFETY: every call goes to the system's allocator as it came; the counters touch no memory of it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let size = self.counted(layout);
        let now = self.now.fetch_add(size, Relaxed) + size;
        self.most.fetch_max(now, Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        self.now.fetch_sub(self.counted(layout), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}
