//! What a scene asks of the figures of its runs, as plain data: figures know no scenes.

use frazil_core::breakage::crack::Crack;
use frazil_core::space::domain::Domain;
use frazil_core::space::random_field::RandomField;
use frazil_plots::FigureOptions;
use frazil_plots::ground_plan::{GroundPlan, ShaftMark, WaterMark};
use frazil_plots::moisture_map::{CrackMark, Outlines};
use frazil_record::Field;
use frazil_scene::region::Cell;
use frazil_scene::{Scene, Shape};
use glam::DVec2;

/// What a scene asks of its figures, maps of these fields among them.
pub fn of(scene: &Scene, maps: &[Field]) -> FigureOptions {
    FigureOptions {
        name: None,
        time_unit: scene.time_unit,
        freezing_point: scene
            .materials
            .iter()
            .find(|material| material.freezes())
            .map(|material| material.freezing_point),
        axes: scene.domain.axes(),
        pressures: scene.flow.as_ref().map_or((0.0, 0.0), |flow| flow.pressures()),
        cut: scene.flow.as_ref().and_then(|flow| flow.cut).unwrap_or(0.0),
        plan: plan(scene, maps),
        unsaturated: scene.of_water.then(|| outlines(scene, maps)),
        ground: Vec::new(),
    }
}

/// The same for all figures of a run, of its ground where that varies at random among them.
pub fn of_run(scene: &Scene, maps: &[Field]) -> FigureOptions {
    FigureOptions { ground: ground(scene, maps), ..of(scene, maps) }
}

/// Logarithms of what varies at random, where the first map has values.
fn ground(scene: &Scene, maps: &[Field]) -> Vec<(&'static str, Field)> {
    let Some(map) = maps.first() else { return Vec::new() };
    let of = |(name, variation)| {
        let field = RandomField::new(variation);
        let place = |k: usize| {
            let (column, row) = (k % map.nx, k / map.nx);
            DVec2::new(map.x0_m + column as f64 * map.spacing_m, map.y0_m + row as f64 * map.spacing_m)
        };
        let value = |(k, seen): (usize, &f64)| if seen.is_finite() { field.at(place(k)).ln() } else { f64::NAN };
        let temperature_c = map.temperature_c.iter().enumerate().map(value).collect();
        let (frozen_fraction, concentration, temperature_ref_c) = Default::default();
        (name, Field { temperature_c, frozen_fraction, concentration, temperature_ref_c, ..map.clone() })
    };
    scene.random.variations().map(of).collect()
}

/// Cracks at the instants of maps, parts of other soils and those that nothing enters.
fn outlines(scene: &Scene, maps: &[Field]) -> Outlines {
    const PIECES: usize = 120;
    let regions = scene.regions.iter().filter(|region| region.material.is_some());
    let closed = |corners: &[DVec2]| corners.iter().chain(corners.first()).copied().collect();
    let rim = |shape: &Shape| -> Vec<DVec2> {
        match shape {
            Shape::Box(Cell { low, high }) => {
                vec![*low, DVec2::new(high.x, low.y), *high, DVec2::new(low.x, high.y), *low]
            }
            Shape::Circle { centre, radius } => {
                let angle = |k: usize| std::f64::consts::TAU * k as f64 / PIECES as f64;
                (0..=PIECES).map(|k| *centre + *radius * DVec2::from_angle(angle(k))).collect()
            }
            Shape::Ellipse(ellipse) => closed(&ellipse.as_large(PIECES)),
            Shape::Polygon(corners) => closed(corners),
        }
    };
    let shapes = regions.map(|region| &region.shape).chain(&scene.impermeable);
    let regions = shapes.map(|shape| rim(shape).into_iter().map(DVec2::into).collect());
    let crack = |crack: &Crack| {
        let tip = |field: &Field| Some((field.time_s, tip(crack, field.time_s)?.into()));
        CrackMark { from: crack.from.into(), tips: maps.iter().filter_map(tip).collect() }
    };
    Outlines { regions: regions.collect(), cracks: scene.cracks.iter().map(crack).collect() }
}

/// How far a crack has come at a time (s); nowhere before it opens.
fn tip(crack: &Crack, time: f64) -> Option<DVec2> {
    if crack.time_at(0.0) > time {
        return None;
    }
    let (mut open, mut closed) = (0.0, crack.length());
    if crack.time_at(closed) <= time {
        return Some(crack.to);
    }
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (open + closed);
        if crack.time_at(middle) <= time { open = middle } else { closed = middle }
    }
    Some(crack.from + open / crack.length() * (crack.to - crack.from))
}

/// Pipes, shaft and water; nothing where the body has no pipes.
fn plan(scene: &Scene, maps: &[Field]) -> GroundPlan {
    if !matches!(scene.domain, Domain::Ring { .. }) && scene.rings.is_empty() {
        return GroundPlan::default();
    }
    GroundPlan {
        pipes: scene.pipes().iter().map(|pipe| (pipe.x, pipe.y, pipe.radius)).collect(),
        shaft: scene.excavation.as_ref().map(|shaft| ShaftMark { radius: shaft.radius, dug: Some(shaft.start) }),
        water: water(scene, maps),
    }
}

/// The water that crosses the ring of a scene, at the start and at the instants of maps.
pub fn water(scene: &Scene, maps: &[Field]) -> Option<WaterMark> {
    let flow = scene.flow.as_ref()?;
    let across = flow.across?;
    let pressure = &flow.walls.first()?.pressure;
    let permeability = scene.materials.first()?.pores?.permeability?;
    // The outer wall holds the pressure that drives undisturbed water over a radius.
    let by_pressure = permeability / (flow.viscosity * across.radius);
    let mut times: Vec<f64> = [0.0].into_iter().chain(maps.iter().map(|field| field.time_s)).collect();
    times.sort_by(f64::total_cmp);
    let speeds = times.into_iter().map(|time| (time, pressure.at(time) * by_pressure)).collect();
    Some(WaterMark { speeds, direction: (across.direction.x, across.direction.y) })
}
