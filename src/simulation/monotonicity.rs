//! What the data of a scene allow in one direction only: a body that is cooled from all sides freezes and does not
//! thaw, and the coldest pipes take heat and give none. An unstable step breaks such rules where temperatures tell
//! nothing, as inside the smeared delta of a pipe.

use frazil_core::boundary::condition::Condition;
use frazil_core::saved::{Pass, Saved};
use frazil_core::series::Series;
use frazil_record::RunResult;
use frazil_scene::Scene;

use crate::observers::observer::{End, Made, Moment, Observer, Schedule, Setup, View};

/// What is watched, and how far it went the wrong way.
#[derive(Debug, Clone)]
pub struct MonotonicityCheck {
    /// +1 where the frozen volume can only grow, -1 where it can only shrink.
    frozen: Option<f64>,
    /// Volume of a particle: the front is not known any better.
    grain: f64,
    /// Rings of pipes that can only take heat (-1) or only give it (+1), in the order of the scene.
    rings: Vec<Option<f64>>,
    watches: bool,
    /// Extreme of the frozen volume so far, in its one direction, and its greatest value.
    furthest: Option<(f64, f64)>,
    /// Strongest flow through any patch so far (W).
    strongest: f64,
    setback: f64,
}

pub(crate) fn of(setup: &Setup<'_>) -> Made {
    let check = MonotonicityCheck::new(setup.scene, setup.particles.volumes.largest());
    check.watches.then(|| Box::new(check) as _)
}

impl Saved for MonotonicityCheck {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.furthest, &mut self.strongest, &mut self.setback]);
    }
}

impl Observer for MonotonicityCheck {
    fn schedule(&self) -> Schedule {
        Schedule::OUTPUTS
    }

    fn observe(&mut self, view: &View<'_>) {
        // The curve between two states may swing where steps do not.
        if view.moment == (Moment::Output { landed: true }) {
            self.look(view.frozen(), view.ledger.rate(), view.ledger.rings());
        }
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.record.setback_rel = self.setback();
    }

    fn held_at_the_end(&self) -> usize {
        0
    }
}

impl MonotonicityCheck {
    /// The rules that the data of a scene make, for particles of this volume.
    pub fn new(scene: &Scene, grain: f64) -> Self {
        let (low, high) = scene.temperature_range();
        let side = |series: &Series| match series.range() {
            (a, b) if low == high || a != b => None,
            (value, _) if value == low => Some(-1.0),
            (value, _) if value == high => Some(1.0),
            _ => None,
        };
        let open = scene.has_flux();
        let rings: Vec<_> =
            scene.rings.iter().map(|ring| ring.condition.temperature().filter(|_| !open).and_then(side)).collect();
        let frozen =
            if low == high || scene.flow.is_some() || scene.gravity.is_some() { None } else { direction(scene) };
        let watches = frozen.is_some() || rings.iter().any(Option::is_some);
        MonotonicityCheck { frozen, grain, rings, watches, furthest: None, strongest: 0.0, setback: 0.0 }
    }

    /// Takes note of the frozen volume and of the flow into the body (W) through each patch, and through each ring of pipes.
    pub fn look(&mut self, frozen: f64, flows: &[f64], pipes: impl Iterator<Item = f64>) {
        if let Some(sign) = self.frozen {
            let (furthest, greatest) = self.furthest.unwrap_or((frozen, 0.0));
            let greatest = f64::max(greatest, frozen);
            if greatest > 0.0 {
                self.setback = self.setback.max((sign * (furthest - frozen) - self.grain) / greatest);
            }
            let further = if sign > 0.0 { furthest.max(frozen) } else { furthest.min(frozen) };
            self.furthest = Some((further, greatest));
        }
        self.strongest = flows.iter().fold(self.strongest, |strongest, flow| strongest.max(flow.abs()));
        for (sign, flow) in self.rings.iter().zip(pipes).filter_map(|(sign, flow)| Some(((*sign)?, flow))) {
            if self.strongest > 0.0 {
                self.setback = self.setback.max(-sign * flow / self.strongest);
            }
        }
    }

    /// The furthest way back: of the frozen volume, but for one particle, over its greatest; of the flow through pipes
    /// over the strongest through any patch. Absent where the data make no rule.
    pub fn setback(&self) -> Option<f64> {
        self.watches.then_some(self.setback)
    }
}

/// Which way the frozen volume goes, if all data pull one way from the uniform start and never let go.
fn direction(scene: &Scene) -> Option<f64> {
    // What a barrier parts goes its own way, what is dug out is frozen no more, and sources pull beside walls.
    let has_own = scene.has_uneven_start() || scene.has_heat_sources();
    if has_own || scene.has_barriers() || scene.excavation.is_some() {
        return None;
    }
    let start = scene.initial_temperature;
    let pulls = |series: &Series, sign: f64| {
        let away = |value: f64| sign * (start - value) >= 0.0;
        match series {
            Series::Constant(value) => away(*value),
            Series::Repeated { rows, .. } if !series.changes() => rows.iter().all(|row| away(row.1)),
            // What comes back has let go before.
            Series::Repeated { .. } => false,
            Series::Table(rows) => {
                rows.first().is_some_and(|row| away(row.1))
                    && rows.windows(2).all(|pair| sign * (pair[0].1 - pair[1].1) >= 0.0)
            }
            Series::Formula(formula) => {
                let (first, last) = (formula.at(0.0), formula.at(scene.duration));
                away(first) && formula.next_turn(0.0).is_none() && sign * (first - last) >= 0.0
            }
        }
    };
    [1.0, -1.0].into_iter().find(|sign| {
        let wall = |condition: &Condition| match condition {
            Condition::Symmetry | Condition::Periodic => true,
            Condition::Temperature(series) => pulls(series, *sign),
            Condition::Film { strength, ambient, .. } => !strength.changes() && pulls(ambient, *sign),
            Condition::Flux(_) | Condition::Runoff { .. } | Condition::FreeDrainage | Condition::Exact => false,
        };
        scene.conditions().all(wall)
            // A pipe that rests does not pull.
            && scene.rings.iter().all(|ring| ring.schedule.is_none() && ring.condition.temperature().is_some_and(|series| pulls(series, *sign)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::boundary::pipe::PipeCondition;
    use frazil_core::physics::film::FilmKind;
    use frazil_core::physics::material::{FreezingLaw, Material, Mixing, Phase};
    use frazil_core::space::domain::Domain;
    use frazil_core::space::wall::WallId;
    use frazil_scene::{PipeRing, Wall};

    fn scene(walls: Vec<(WallId, Condition)>) -> Scene {
        let phase = Phase { conductivity: 1.0, heat_capacity: 1.0 };
        Scene {
            initial_temperature: 5.0,
            walls: walls.into_iter().map(|(wall, condition)| Wall { wall, condition }).collect(),
            ..Scene::bare(
                Domain::Line { length: 1.0 },
                1.0,
                vec![Material {
                    name: "soil".into(),
                    density: 1.0,
                    frozen: phase,
                    unfrozen: phase,
                    freezing_point: 0.0,
                    latent_heat: 1.0,
                    law: FreezingLaw::Isothermal,
                    mixing: Mixing::Arithmetic,
                    pores: None,
                    soil: None,
                }],
            )
        }
    }

    fn held(temperature: f64) -> Condition {
        Condition::Temperature(Series::Constant(temperature))
    }

    fn after(scene: &Scene, looks: &[(f64, &[f64])]) -> Option<f64> {
        let mut watch = MonotonicityCheck::new(scene, 0.0);
        for (frozen, flows) in looks {
            watch.look(*frozen, flows, flows[flows.len() - scene.rings.len()..].iter().copied());
        }
        watch.setback()
    }

    #[test]
    fn a_cooled_body_only_freezes() {
        let cooled = scene(vec![(WallId::Left, held(-20.0)), (WallId::Right, held(5.0))]);
        assert_eq!(after(&cooled, &[(0.0, &[-8.0, 0.0]), (2.0, &[-4.0, 1.0]), (2.0, &[-3.0, 0.0])]), Some(0.0));
        // A quarter of the frozen volume thaws again.
        assert_eq!(after(&cooled, &[(1.0, &[-8.0, 0.0]), (4.0, &[-4.0, 0.0]), (3.0, &[-3.0, 0.0])]), Some(0.25));
    }

    #[test]
    fn a_front_may_go_back_within_a_particle() {
        let cooled = scene(vec![(WallId::Left, held(-20.0))]);
        let mut watch = MonotonicityCheck::new(&cooled, 0.5);
        for (frozen, setback) in [(4.0, 0.0), (3.5, 0.0), (4.0, 0.0), (3.25, 0.0625)] {
            watch.look(frozen, &[-1.0], std::iter::empty());
            assert_eq!(watch.setback(), Some(setback));
        }
    }

    #[test]
    fn a_heated_body_thaws_only() {
        let mut heated = scene(vec![(WallId::Left, held(10.0)), (WallId::Right, Condition::Symmetry)]);
        heated.initial_temperature = -5.0;
        assert_eq!(after(&heated, &[(4.0, &[8.0, 0.0]), (3.0, &[6.0, 0.0]), (1.0, &[5.0, 0.0])]), Some(0.0));
        assert_eq!(after(&heated, &[(4.0, &[8.0, 0.0]), (2.0, &[6.0, 0.0]), (3.0, &[5.0, 0.0])]), Some(0.25));
    }

    #[test]
    fn the_coldest_pipes_only_take_heat() {
        let pipes = |temperature: f64| PipeRing {
            count: 4,
            ring_radius: 1.0,
            first_angle: 0.0,
            moved: Vec::new(),
            one_particle: false,
            missing: Vec::new(),
            pipe_radius: 0.1,
            condition: PipeCondition::Temperature(Series::Constant(temperature)),
            schedule: None,
        };
        let mut ring = scene(vec![(WallId::Outer, held(5.0))]);
        ring.rings = vec![pipes(-20.0), pipes(-10.0)];
        // Walls come before pipes, and pipes that are not the coldest may do either.
        assert_eq!(after(&ring, &[(1.0, &[0.0, -8.0, -2.0]), (2.0, &[-1.0, -4.0, 2.0])]), Some(0.0));
        assert_eq!(after(&ring, &[(1.0, &[0.0, -8.0, -2.0]), (2.0, &[0.0, 4.0, 2.0])]), Some(0.5));
    }

    #[test]
    fn no_rule_is_made_where_data_allow_either_way() {
        let ambient = Series::Constant(-20.0);
        let film = |strength: Series| Condition::Film { kind: FilmKind::Convection, strength, ambient };
        let swinging = Series::Repeated { rows: vec![(0.0, 5.0), (1.0, -2.0)], period: 2.0 };
        let swinging = Condition::Temperature(swinging);
        let growing = Series::Table(vec![(0.0, 1.0), (1.0, 2.0)]);
        let rising = Condition::Temperature(Series::Table(vec![(0.0, -5.0), (1.0, 2.0)]));
        let falling = Condition::Temperature(Series::Table(vec![(0.0, 5.0), (1.0, -2.0)]));
        let flux = Condition::Flux(Series::Constant(-1.0));
        // Thawing under each: allowed but where the wall only ever gets colder.
        let cases = [(rising, None), (swinging, None), (flux, None), (falling, Some(0.75)), (held(5.0), None)];
        for (condition, rule) in cases {
            assert_eq!(after(&scene(vec![(WallId::Left, condition)]), &[(4.0, &[-1.0]), (1.0, &[-1.0])]), rule);
        }
        // A film that changes may let the front go back.
        let changing = scene(vec![(WallId::Left, film(growing))]);
        assert_eq!(after(&changing, &[(4.0, &[-2.0]), (1.0, &[-1.0])]), None);
        // A warmer wall beside a colder one pulls the other way.
        let both = scene(vec![(WallId::Left, held(-20.0)), (WallId::Right, held(9.0))]);
        assert_eq!(after(&both, &[(4.0, &[-2.0, 0.0]), (1.0, &[-1.0, 0.0])]), None);
    }
}
