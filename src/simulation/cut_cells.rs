//! Laws of particles whose cells interfaces cut.

use std::collections::BTreeMap;
use std::sync::Arc;

use frazil_core::physics::blend::Blend;
use frazil_core::physics::latent_heat::Materials;
use frazil_core::physics::thermal::Thermal;
use frazil_scene::Scene;
use frazil_scene::region::Cell;
use glam::DVec2;

/// Shares are whole multiples of this: cells that are cut alike are alike to the last bit.
const SHARE: f64 = 1.0 / (1u64 << 30) as f64;

/// Gives particles whose cells interfaces cut laws of their own.
pub fn blend(scene: &Scene, materials: &mut Materials, places: &[DVec2], spacing: f64) {
    let mut found: BTreeMap<(u8, Vec<(usize, u64)>), u32> = BTreeMap::new();
    let mut blends: Vec<Thermal> = Vec::new();
    let mut law_of: Vec<u32> = Vec::new();
    for (i, place) in places.iter().enumerate() {
        let shares = shares(scene, &Cell::around(*place, spacing));
        let curve = |material: usize| &materials.thermals[material].curve;
        let alike = shares.iter().all(|(material, _)| curve(*material).stores_like(curve(shares[0].0)));
        if shares.len() < 2 || alike {
            continue;
        }
        if law_of.is_empty() {
            law_of = materials.of_particle.iter().map(|material| u32::from(*material)).collect();
        }
        let own = materials.of_particle[i];
        let law = *found.entry((own, shares.clone())).or_insert_with(|| {
            let whole: u64 = shares.iter().map(|share| share.1).sum();
            let part = |(material, share): &(usize, u64)| {
                (*share as f64 / whole as f64, materials.thermals[*material].curve.clone())
            };
            let blend = Blend::new(shares.iter().map(part).collect());
            blends.push(Thermal::blended(&materials.thermals[own as usize], Arc::new(blend)));
            (materials.thermals.len() + blends.len() - 1) as u32
        });
        law_of[i] = law;
    }
    (materials.blends, materials.law_of) = (blends.into(), law_of);
}

/// Materials in a cell with their shares in units of [`SHARE`], in order.
fn shares(scene: &Scene, cell: &Cell) -> Vec<(usize, u64)> {
    let mut shares: BTreeMap<usize, f64> = BTreeMap::new();
    for part in scene.parts_of(cell) {
        *shares.entry(part.material).or_default() += part.share;
    }
    let whole = shares.into_iter().map(|(material, share)| (material, (share / SHARE).round() as u64));
    whole.filter(|(_, share)| *share > 0).collect()
}
