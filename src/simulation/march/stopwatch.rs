//! Wall and CPU time of a run.

use std::time::Instant;

use frazil_core::saved::{Pass, Saved};

/// Wall and CPU time together.
pub(super) struct Stopwatch {
    wall: Instant,
    cpu: Cpu,
}

/// CPU time of whom: a run on one thread is that thread's alone, so that runs side by side are not booked to each other.
enum Cpu {
    Thread(cpu_time::ThreadTime),
    Process(cpu_time::ProcessTime),
}

impl Stopwatch {
    pub(super) fn start(threads: usize) -> Self {
        let cpu = match threads {
            0 | 1 => Cpu::Thread(cpu_time::ThreadTime::now()),
            _ => Cpu::Process(cpu_time::ProcessTime::now()),
        };
        Stopwatch { wall: Instant::now(), cpu }
    }

    pub(super) fn stop(&self) -> (f64, f64) {
        let cpu = match &self.cpu {
            Cpu::Thread(time) => time.elapsed(),
            Cpu::Process(time) => time.elapsed(),
        };
        (self.wall.elapsed().as_secs_f64(), cpu.as_secs_f64())
    }
}

/// Wall and CPU time of many stretches (s).
#[derive(Default)]
pub(super) struct Elapsed {
    pub(super) wall: f64,
    pub(super) cpu: f64,
}

impl Saved for Elapsed {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.wall, &mut self.cpu]);
    }
}

impl Elapsed {
    pub(super) fn add(&mut self, stretch: &Stopwatch) {
        let (wall, cpu) = stretch.stop();
        self.wall += wall;
        self.cpu += cpu;
    }
}
