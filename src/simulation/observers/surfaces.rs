//! Heat through surfaces inside the body.

use frazil_record::SurfaceRow;

use super::observer::{Instants, Made, Setup};
use super::series::series;

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let count = setup.scene.watch.surfaces.len();
    if count == 0 {
        return None;
    }
    let rows = Vec::with_capacity(count * setup.outputs());
    series(
        Instants::Outputs,
        rows,
        ("r=0.001".len(), 0),
        |view, rows| {
            let domain = &view.scene.domain;
            for (surface, heat_w) in view.scene.watch.surfaces.iter().zip(view.across) {
                let flux_w_per_m2 = heat_w / surface.area(domain);
                let (time_s, surface) = (view.time, surface.name(domain));
                rows.push(SurfaceRow { time_s, surface, heat_w: *heat_w, flux_w_per_m2 });
            }
        },
        |rows, result| result.surfaces = rows,
    )
}
