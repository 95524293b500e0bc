//! Where gravity pulls unsaturated water.

use super::body::{wall_named, wall_names};
use super::problem::{Noted, Read};
use super::section::Section;
use crate::scene::{Wall, WallPart};
use frazil_core::boundary::condition::Condition;
use frazil_core::physics::material::Material;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;

/// The wall that gravity pulls towards, where the scene has gravity.
pub(super) fn gravity(
    root: &mut Section<'_>,
    domain: &Read<Domain>,
    (of_water, materials): (bool, &[Material]),
    (walls, parts): (&[Wall], &[WallPart]),
) -> Result<Option<WallId>, Noted> {
    let towards: Option<Read<WallId>> = root.optional_section("gravity").map(|mut section| {
        let name = section.text("towards")?;
        let domain = domain.as_ref().map_err(|noted| *noted)?;
        let message = || format!("found \"{name}\", must be a wall of the body: {}", wall_names(domain));
        wall_named(domain, &name).ok_or_else(|| section.problem("towards", message()))
    });
    if towards.is_some() && !of_water {
        return Err(root.problem("gravity", "the section \"gravity\" needs balance = \"water\""));
    }
    if towards.is_some() && materials.len() > 1 {
        let message = format!("found {} materials, water that falls has one soil", materials.len());
        return Err(root.problem("gravity", message));
    }
    let towards = towards.transpose()?;
    let walls = walls.iter().map(|wall| (wall.wall, &wall.condition));
    let all = walls.chain(parts.iter().map(|part| (part.wall, &part.condition)));
    let mut drains = all.filter(|(_, condition)| **condition == Condition::FreeDrainage);
    if let Some((wall, _)) = drains.find(|(wall, _)| towards != Some(*wall)) {
        let message = format!("the wall \"{wall}\" has free drainage, which only the wall at the lower end can have");
        return Err(root.problem("walls", message));
    }
    Ok(towards)
}
