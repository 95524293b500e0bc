//! Fronts that come to curved walls and leave them.

use frazil_core::space::domain::{Domain, Sector};

use crate::sketch::{SHARP, Sketch, even, sand};

/// A curved wall is seen through neighbours, which pull on a particle with less than their whole weight while a front stands in them, and
/// not at all once it stands between: the range of the data is kept as fronts come to the wall and leave it.
#[test]
fn fronts_at_curved_walls_keep_the_range() {
    let layer = "material = \"layer\"\nx_min_m = -4\nx_max_m = 4\ny_min_m = 0.33\ny_max_m = 2.21";
    let clay = sand(SHARP).replace("2.56", "3.56").replace("temperature_c = 0", "temperature_c = -0.5");
    let shaft = "radius_m = 1.6\nstart_s = 1500000\ntemperature_c = 25";
    let pipes = "count = 16\nring_radius_m = 2.4\npipe_radius_m = 0.05\ntemperature_c = -20";
    for kind in even() {
        for (wall, start, pipes, shaft) in
            [(-9.0, 2.0, "", ""), (10.0, -5.0, "", ""), (10.0, 10.0, pipes, shaft), (4.0, 4.0, pipes, "")]
        {
            for anisotropy in ["", "conductivity_y_over_x = 3"] {
                let mut sketch = Sketch::new(Domain::Ring { outer_radius: 4.0, sector: Sector::Half }, 0.1)
                    .wall("outer", format!("temperature_c = {wall}"));
                sketch.materials = vec![("sand", sand(SHARP)), ("layer", clay.clone())];
                (sketch.regions, sketch.anisotropy) = (vec![layer.to_owned()], anisotropy.to_owned());
                sketch.pipes.extend((!pipes.is_empty()).then(|| pipes.to_owned()));
                (sketch.excavation, sketch.initial_c, sketch.duration_s) = (shaft.to_owned(), start, 4e6);
                sketch.sound(kind, 1e-10);
            }
        }
    }
}
