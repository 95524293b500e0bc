//! What a run holds on the heap, counted part by part.
//!
//! Every part counts what it owns; what several share through an [`Arc`] is counted by `Particles` or by the
//! operator alone, as they say. Small things (names, boxes, causes in words) are no part's: they are one lump.

use std::fmt;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use glam::DVec2;

/// Bytes that a value holds on the heap, beyond itself.
pub trait HeapSize {
    /// The bytes.
    fn heap_size(&self) -> usize;
}

/// Bytes of several values together.
pub fn total(parts: &[&dyn HeapSize]) -> usize {
    parts.iter().map(|part| part.heap_size()).sum()
}

/// Values that hold nothing beyond themselves.
macro_rules! plain {
    ($($kind:ty),* $(,)?) => {
        $(impl HeapSize for $kind {
            fn heap_size(&self) -> usize {
                0
            }
        })*
    };
}

plain!(u8, u32, u64, usize, f32, f64, bool, DVec2);

impl<T: HeapSize> HeapSize for Vec<T> {
    fn heap_size(&self) -> usize {
        self.capacity() * size_of::<T>() + self.iter().map(HeapSize::heap_size).sum::<usize>()
    }
}

impl<T: HeapSize> HeapSize for [T] {
    fn heap_size(&self) -> usize {
        size_of_val(self) + self.iter().map(HeapSize::heap_size).sum::<usize>()
    }
}

impl<T: HeapSize, const N: usize> HeapSize for [T; N] {
    fn heap_size(&self) -> usize {
        self.iter().map(HeapSize::heap_size).sum()
    }
}

impl<T: HeapSize> HeapSize for Option<T> {
    fn heap_size(&self) -> usize {
        self.as_ref().map_or(0, HeapSize::heap_size)
    }
}

impl<A: HeapSize, B: HeapSize> HeapSize for (A, B) {
    fn heap_size(&self) -> usize {
        self.0.heap_size() + self.1.heap_size()
    }
}

impl<A: HeapSize, B: HeapSize, C: HeapSize> HeapSize for (A, B, C) {
    fn heap_size(&self) -> usize {
        self.0.heap_size() + self.1.heap_size() + self.2.heap_size()
    }
}

impl HeapSize for String {
    fn heap_size(&self) -> usize {
        self.capacity()
    }
}

impl<T: HeapSize + ?Sized> HeapSize for Box<T> {
    fn heap_size(&self) -> usize {
        size_of_val(&**self) + (**self).heap_size()
    }
}

/// Names, boxes, causes in words, the record and the reading of the system's own counters (bytes), as a run of 200
/// particles shows them.
const SMALL_THINGS: usize = 12_000;

/// Bytes that may still be taken, as far as the system tells: what it has left, and what is left of this process's share.
fn left() -> Option<f64> {
    let number = |text: &str| text.split_whitespace().find_map(|word| word.parse::<f64>().ok());
    let line = |file: &str, name: &str| {
        let text = std::fs::read_to_string(file).ok()?;
        number(text.lines().find_map(|line| line.strip_prefix(name))?)
    };
    let whole = |file: &str| number(&std::fs::read_to_string(file).ok()?);
    let of_machine = line("/proc/meminfo", "MemAvailable:").map(|kibibytes| kibibytes * 1024.0);
    let taken = line("/proc/self/status", "VmSize:").map_or(0.0, |kibibytes| kibibytes * 1024.0);
    let of_process = line("/proc/self/limits", "Max address space").map(|most| most - taken);
    // Both layouts of groups, seen from within a container, where the own group is the root.
    let groups = [("memory.max", "memory.current"), ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes")];
    let group = |file: &str| whole(&format!("/sys/fs/cgroup/{file}"));
    let of_groups =
        groups.into_iter().filter_map(|(most, now)| group(most).zip(group(now)).map(|(most, now)| most - now));
    of_groups.chain(of_machine).chain(of_process).reduce(f64::min)
}

/// Share of what is free that runs take unless asked otherwise. The rest is for what others on the machine begin meanwhile.
const SHARE: f64 = 0.8;

/// Bytes that were asked for; zero before.
static ASKED: AtomicU64 = AtomicU64::new(0);
/// Runs that hold their particles at once.
static AT_ONCE: AtomicUsize = AtomicUsize::new(1);

/// What one run may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// Bytes of all runs together.
    pub all: f64,
    /// Whether they were asked for.
    pub asked: bool,
    /// Runs at once, which share them.
    pub runs: usize,
}

impl Allowed {
    /// Bytes of each run.
    pub fn each(&self) -> f64 {
        self.all / self.runs as f64
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let source = if self.asked { "--memory" } else { "four fifths of what is free, or --memory" };
        write!(f, "{} ({source}", words(self.each()))?;
        match self.runs {
            1 => write!(f, ")"),
            runs => write!(f, ", shared by {runs} at once: fewer --threads)"),
        }
    }
}

/// Sets what all runs of this process may hold together (bytes).
pub fn ask(bytes: u64) {
    ASKED.store(bytes, Ordering::Relaxed);
}

/// Says how many runs share it from now on.
pub fn share(runs: usize) {
    AT_ONCE.store(runs.max(1), Ordering::Relaxed);
}

/// What a run may hold; nothing where neither the system nor anyone says.
pub fn allowed() -> Option<Allowed> {
    // What is free is looked at once: what runs take themselves does not lessen what they may.
    static FREE: OnceLock<Option<f64>> = OnceLock::new();
    let runs = AT_ONCE.load(Ordering::Relaxed);
    match ASKED.load(Ordering::Relaxed) {
        0 => FREE.get_or_init(left).map(|free| Allowed { all: SHARE * free, asked: false, runs }),
        bytes => Some(Allowed { all: bytes as f64, asked: true, runs }),
    }
}

/// Bytes in words.
pub fn words(bytes: f64) -> String {
    match bytes {
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}

/// What a plan holds while it steps, by part (bytes).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Memory {
    /// Enthalpies, positions, materials with their tables, and the lattice.
    pub particles: usize,
    /// Pairs, ghosts, walls, pipes, buffers of the step and columns of the integrator.
    pub method: usize,
    /// Samples that outputs read, and the series that they fill, to the end of the run.
    pub observers: usize,
}

impl Memory {
    /// All of it, with what is too small to be counted.
    pub fn total(&self) -> usize {
        self.particles + self.method + self.observers + SMALL_THINGS
    }
}

/// A slice that others share.
pub fn shared<T>(slice: &Arc<[T]>) -> usize {
    size_of_val(&**slice)
}
