//! Layouts of freeze pipes side by side: when they close, where they are weakest, what they draw.

mod critical;
mod curves;
mod days;
mod depth;
mod methods;
mod plan;
mod polar;
mod report;
mod summary;
mod view;

pub use critical::{CriticalView, critical_map};
pub use curves::{axis, load, mean_temperature, planes, thickness};
pub use days::{Days, days};
pub use depth::{LayerView, ShaftView, over_depth};
pub use methods::{Answer, MethodView, MethodsView, methods};
pub use plan::{maps, sketches};
pub use polar::gaps_polar;
pub use report::{Drawing, drawings};
pub use summary::summary;
pub use view::{LayoutView, PipeView, between};

#[cfg(test)]
mod tests {
    use super::view::*;
    use crate::canvas::text_width;

    #[test]
    fn thirty_layouts_look_different() {
        for k in 0..30 {
            for other in 0..k {
                assert!(look(k) != look(other), "{other} and {k}");
            }
        }
        // Neighbours in a legend differ in a grey print: by dashes and marker at the least.
        for k in 1..30 {
            assert!(look(k).dash != look(k - 1).dash && look(k).marker != look(k - 1).marker);
        }
    }

    #[test]
    fn long_names_keep_both_ends() {
        let name = "horizon 212 m, twenty-four pipes of 108 mm, pipe 1.7 failed";
        let short = fitted(name, 16.0, false, 200.0);
        assert!(text_width(&short, 16.0, false) <= 200.0);
        assert!(short.starts_with("horizon") && short.ends_with("failed") && short.contains('…'), "{short}");
        let lines = wrapped(name, 16.0, true, 240.0);
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().all(|line| text_width(line, 16.0, true) <= 240.0), "{lines:?}");
        assert_eq!(wrapped("26 pipes", 16.0, true, 240.0), ["26 pipes"]);
        // One word as long as that has no place to break.
        assert_eq!(wrapped(&"x".repeat(400), 16.0, true, 240.0).len(), 1);
        assert_eq!(fitted("", 16.0, false, 10.0), "");
    }

    #[test]
    fn a_series_is_read_between_its_points_and_not_beyond() {
        let series = [(0.0, 1.0), (2.0, 5.0), (2.0, 7.0), (4.0, 7.0)];
        assert_eq!(between(&series, 0.5), Some(2.0));
        assert_eq!(between(&series, 2.0), Some(5.0));
        assert_eq!(between(&series, 4.0), Some(7.0));
        assert_eq!(between(&series, 4.1), None);
        assert_eq!(between(&series[..1], 0.0), Some(1.0));
        assert_eq!(between(&[], 0.0), None);
    }
}
