//! What a run holds on the heap, counted part by part.
//!
//! Every part counts what it owns; what several share through an [`Arc`] is counted by `Particles` or by the
//! operator alone, as they say. Small things (names, boxes, causes in words) are no part's: they are one lump.

use std::sync::Arc;

use glam::DVec2;

/// Bytes that a value holds on the heap, beyond itself.
pub trait Held {
    /// The bytes.
    fn held(&self) -> usize;
}

/// Values that hold nothing beyond themselves.
macro_rules! plain {
    ($($kind:ty),* $(,)?) => {
        $(impl Held for $kind {
            fn held(&self) -> usize {
                0
            }
        })*
    };
}

plain!(u8, u32, u64, usize, f64, bool, DVec2);

impl<T: Held> Held for Vec<T> {
    fn held(&self) -> usize {
        self.capacity() * size_of::<T>() + self.iter().map(Held::held).sum::<usize>()
    }
}

impl<T: Held> Held for [T] {
    fn held(&self) -> usize {
        size_of_val(self) + self.iter().map(Held::held).sum::<usize>()
    }
}

impl<T: Held, const N: usize> Held for [T; N] {
    fn held(&self) -> usize {
        self.iter().map(Held::held).sum()
    }
}

impl<T: Held> Held for Option<T> {
    fn held(&self) -> usize {
        self.as_ref().map_or(0, Held::held)
    }
}

impl<A: Held, B: Held> Held for (A, B) {
    fn held(&self) -> usize {
        self.0.held() + self.1.held()
    }
}

impl<A: Held, B: Held, C: Held> Held for (A, B, C) {
    fn held(&self) -> usize {
        self.0.held() + self.1.held() + self.2.held()
    }
}

impl Held for String {
    fn held(&self) -> usize {
        self.capacity()
    }
}

impl<T: Held + ?Sized> Held for Box<T> {
    fn held(&self) -> usize {
        size_of_val(&**self) + (**self).held()
    }
}

/// Names, boxes, causes in words, the record and the reading of the system's own counters (bytes), as a run of 200
/// particles shows them.
const SMALL_THINGS: usize = 12_000;

/// Bytes that may still be taken, as far as the system tells: what it has left, and what is left of this process's share.
pub fn left() -> Option<f64> {
    let number = |text: &str| text.split_whitespace().find_map(|word| word.parse::<f64>().ok());
    let line = |file: &str, name: &str| {
        let text = std::fs::read_to_string(file).ok()?;
        number(text.lines().find_map(|line| line.strip_prefix(name))?)
    };
    let whole = |file: &str| number(&std::fs::read_to_string(file).ok()?);
    let of_machine = line("/proc/meminfo", "MemAvailable:").map(|kibibytes| kibibytes * 1024.0);
    let taken = line("/proc/self/status", "VmSize:").map_or(0.0, |kibibytes| kibibytes * 1024.0);
    let of_process = line("/proc/self/limits", "Max address space").map(|most| most - taken);
    let group = "/sys/fs/cgroup/memory";
    let of_group = whole(&format!("{group}.max")).zip(whole(&format!("{group}.current"))).map(|(most, now)| most - now);
    [of_machine, of_process, of_group].into_iter().flatten().reduce(f64::min)
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
    pub watches: usize,
}

impl Memory {
    /// All of it, with what is too small to be counted.
    pub fn total(&self) -> usize {
        self.particles + self.method + self.watches + SMALL_THINGS
    }
}

/// A slice that others share.
pub fn shared<T>(slice: &Arc<[T]>) -> usize {
    size_of_val(&**slice)
}
