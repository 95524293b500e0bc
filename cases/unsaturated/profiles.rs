//! Saturation and concentration along cuts.

use super::slits::{Slit, slits};
use super::{CENTIMETRE, Case, DAY};
use crate::BadTable;
use crate::table::NumberTable;

/// Relative agreement of times, and of places of cuts, for them to be the same.
const SAME: f64 = 1e-9;

/// Distance of neighbouring rows over the least one beyond which something lies between them that the table leaves out.
const GAP: f64 = 1.5;

/// A straight line through the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    /// Along x.
    AlongX {
        /// Where it is (m).
        y: f64,
    },
    /// Along y.
    AlongY {
        /// Where it is (m).
        x: f64,
    },
}

impl Cut {
    fn is_same(self, other: Cut) -> bool {
        match (self, other) {
            (Cut::AlongX { y: own }, Cut::AlongX { y: other }) | (Cut::AlongY { x: own }, Cut::AlongY { x: other }) => {
                is_same(own, other)
            }
            _ => false,
        }
    }
}

/// What a table says of a place at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Effective saturation.
    pub saturation: f64,
    /// Concentration over that at the wall.
    pub concentration: f64,
    /// Estimated error of the saturation: the difference to a grid half as fine.
    pub saturation_error: f64,
    /// Estimated error of the concentration.
    pub concentration_error: f64,
}

/// A cut at a time.
#[derive(Debug, Clone)]
struct Profile {
    /// Time (s).
    time: f64,
    cut: Cut,
    /// Places along the cut (m), which increase.
    along: Vec<f64>,
    samples: Vec<Sample>,
    /// Places along the cut (m) at which cracks cross it.
    parted: Vec<f64>,
}

/// The profiles of a problem.
#[derive(Debug, Clone)]
pub struct Profiles {
    profiles: Vec<Profile>,
}

impl Profiles {
    /// The shipped table of a problem.
    ///
    /// # Errors
    ///
    /// If it cannot be read.
    pub fn of_case(case: Case) -> Result<Self, BadTable> {
        let text = match case {
            Case::OneSided => include_str!("../tables/unsaturated-one-sided.csv"),
            Case::TwoSided => include_str!("../tables/unsaturated-two-sided.csv"),
            Case::ZoneSource => include_str!("../tables/unsaturated-zone-source.csv"),
            Case::ZoneClosed => include_str!("../tables/unsaturated-zone-closed.csv"),
            Case::Cracks => include_str!("../tables/unsaturated-cracks.csv"),
            Case::GrowingCracks => include_str!("../tables/unsaturated-growing-cracks.csv"),
            Case::ImpermeableInclusions => include_str!("../tables/unsaturated-impermeable-inclusions.csv"),
            Case::PermeableInclusions => include_str!("../tables/unsaturated-permeable-inclusions.csv"),
        };
        let mut table = Profiles::read(text)?;
        for profile in &mut table.profiles {
            profile.part(slits(case));
        }
        Ok(table)
    }

    /// Reads rows of cuts, each of which goes on as long as neither the time changes nor both coordinates do.
    fn read(text: &str) -> Result<Self, BadTable> {
        let table = NumberTable::read(text)?;
        let [times, x, y] = [table.column("time_d")?, table.column("x_cm")?, table.column("y_cm")?];
        let [saturation, concentration] = [table.column("saturation")?, table.column("concentration")?];
        let errors = [table.column("saturation_error")?, table.column("concentration_error")?];
        let goes_on = |row: usize| times[row] == times[row - 1] && (x[row] == x[row - 1] || y[row] == y[row - 1]);
        let mut profiles = Vec::new();
        let mut start = 0;
        while start < times.len() {
            let end = (start + 1..times.len()).find(|&row| !goes_on(row)).unwrap_or(times.len());
            let is_along_x = x[start] != x[end - 1] || end - start == 1;
            let (cut, along) = if is_along_x {
                (Cut::AlongX { y: y[start] * CENTIMETRE }, &x[start..end])
            } else {
                (Cut::AlongY { x: x[start] * CENTIMETRE }, &y[start..end])
            };
            let sample = |row: usize| Sample {
                saturation: saturation[row],
                concentration: concentration[row],
                saturation_error: errors[0][row],
                concentration_error: errors[1][row],
            };
            profiles.push(Profile {
                time: times[start] * DAY,
                cut,
                along: along.iter().map(|place| place * CENTIMETRE).collect(),
                samples: (start..end).map(sample).collect(),
                parted: Vec::new(),
            });
            start = end;
        }
        Ok(Profiles { profiles })
    }

    /// Times (s) of the table.
    pub fn times(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self.profiles.iter().map(|profile| profile.time).collect();
        times.dedup();
        times
    }

    /// Cuts of the table.
    pub fn cuts(&self) -> Vec<Cut> {
        let mut cuts: Vec<Cut> = Vec::new();
        for profile in &self.profiles {
            if !cuts.iter().any(|cut| cut.is_same(profile.cut)) {
                cuts.push(profile.cut);
            }
        }
        cuts
    }

    /// Places (m) along a cut with rows of their own at a time (s).
    pub fn places(&self, cut: Cut, t: f64) -> Option<&[f64]> {
        self.profile(cut, t).map(|profile| profile.along.as_slice())
    }

    /// What lies at a place (m) along a cut at a time (s), between two rows by their straight line. None at times and cuts that the
    /// table has not, beyond its outermost rows and where it leaves rows out. Beside a crack across the cut by the line of the next two
    /// rows on the same side.
    pub fn at(&self, cut: Cut, along: f64, t: f64) -> Option<Sample> {
        let Profile { along: places, samples, parted, .. } = self.profile(cut, t)?;
        let after = places.partition_point(|&place| place <= along);
        let before = samples.get(after.checked_sub(1)?)?;
        if after == samples.len() {
            return (places[after - 1] == along).then_some(*before);
        }
        let crack = parted.iter().find(|crack| (places[after - 1]..places[after]).contains(*crack));
        let first = match crack {
            Some(crack) if along < *crack => after.checked_sub(2)?,
            Some(_) => after,
            None => after - 1,
        };
        let (before, next) = (&samples[first], samples.get(first + 1)?);
        let width = places[first + 1] - places[first];
        let least = places.windows(2).map(|pair| pair[1] - pair[0]).fold(width, f64::min);
        let share = (along - places[first]) / width;
        if width > GAP * least && share > 0.0 {
            return None;
        }
        let mix = |read: fn(&Sample) -> f64| read(before) + share * (read(next) - read(before));
        Some(Sample {
            saturation: mix(|sample| sample.saturation),
            concentration: mix(|sample| sample.concentration),
            saturation_error: mix(|sample| sample.saturation_error),
            concentration_error: mix(|sample| sample.concentration_error),
        })
    }

    /// Effective saturation at a place (m) along a cut at a time (s), where [`Profiles::at`] knows it.
    pub fn saturation(&self, cut: Cut, along: f64, t: f64) -> Option<f64> {
        self.at(cut, along, t).map(|sample| sample.saturation)
    }

    /// Concentration over that at the wall at a place (m) along a cut at a time (s), where [`Profiles::at`] knows it.
    pub fn concentration(&self, cut: Cut, along: f64, t: f64) -> Option<f64> {
        self.at(cut, along, t).map(|sample| sample.concentration)
    }

    fn profile(&self, cut: Cut, t: f64) -> Option<&Profile> {
        self.profiles.iter().find(|profile| is_same(profile.time, t) && profile.cut.is_same(cut))
    }
}

impl Profile {
    /// Takes note of cracks that cross the cut.
    fn part(&mut self, slits: &[Slit]) {
        let crosses = |slit: &&Slit| match self.cut {
            Cut::AlongX { y } => (slit.ends(self.time).0..=slit.ends(self.time).1).contains(&y),
            Cut::AlongY { .. } => false,
        };
        self.parted = slits.iter().filter(crosses).map(|slit| slit.x).collect();
    }
}

/// Whether two numbers are the same to rounding; those near zero by a scale of one centimetre or second.
fn is_same(own: f64, other: f64) -> bool {
    (own - other).abs() <= SAME * own.abs().max(CENTIMETRE)
}

#[cfg(test)]
mod tests;
