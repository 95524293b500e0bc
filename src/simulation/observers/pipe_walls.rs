//! Temperatures of the outer walls of pipes, where brine or a given heat makes them: by them a pipe's power is held against what brine
//! can bring.

use frazil_core::boundary::pipe::{PipeCondition, Sink};
use frazil_core::particles::Particles;
use frazil_record::{Role, Table, Unit};

use super::observer::{Instants, Made, Setup};
use super::series::series;

/// Its table.
pub const TABLE: &str = "pipes.csv";

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let follows = |sink: &&Sink| !matches!(sink.condition, PipeCondition::Temperature(_));
    let count = setup.scene.rings.len();
    let of_ring = |ring: usize| setup.pipes.iter().filter(|sink| sink.ring == ring).filter(follows).cloned().collect();
    let rings: Vec<(usize, Vec<Sink>)> =
        (0..count).map(|ring| (ring, of_ring(ring))).filter(|(_, sinks): &(_, Vec<Sink>)| !sinks.is_empty()).collect();
    if rings.is_empty() {
        return None;
    }
    let columns = [
        ("ring", "ring", Unit::One, Role::Key),
        ("wall_c", "mean of the walls", Unit::Celsius, Role::Value),
        ("coldest_c", "coldest wall", Unit::Celsius, Role::Value),
        ("warmest_c", "warmest wall", Unit::Celsius, Role::Value),
    ];
    let table = Table::over_time(TABLE, "Walls of pipes", &columns, 0);
    let by_row = table.columns.len() * size_of::<Option<f64>>();
    let beside = rings.iter().map(|(_, sinks)| sinks.capacity() * size_of::<Sink>()).sum();
    series(
        Instants::Outputs,
        Vec::with_capacity(rings.len() * setup.outputs()),
        (by_row, beside),
        move |view, rows| {
            for (ring, sinks) in &rings {
                let walls = || sinks.iter().map(|sink| wall_temperature(sink, view.particles, view.time));
                rows.push(vec![
                    Some(view.time),
                    Some((ring + 1) as f64),
                    Some(mean_wall_temperature(sinks, view.particles, view.time)),
                    Some(walls().fold(f64::INFINITY, f64::min)),
                    Some(walls().fold(f64::NEG_INFINITY, f64::max)),
                ]);
            }
        },
        |rows, result| result.tables.push(Table { rows, ..table }),
    )
}

/// Temperature of the outer wall of a pipe at a time (s).
fn wall_temperature(sink: &Sink, particles: &Particles, time: f64) -> f64 {
    let potential = |index: usize| particles.materials.of(index).law.potential(particles.enthalpy[index]);
    let thermal = particles.materials.of(sink.sample.first().map_or(0, |entry| entry.0 as usize));
    sink.wall_temperature(sink.sampled(potential), time, thermal)
}

/// Temperature of the outer walls of some pipes at a time (s), in the mean over them.
pub(super) fn mean_wall_temperature(sinks: &[Sink], particles: &Particles, time: f64) -> f64 {
    let share: f64 = sinks.iter().map(|sink| sink.share).sum();
    sinks.iter().map(|sink| sink.share * wall_temperature(sink, particles, time)).sum::<f64>() / share
}
