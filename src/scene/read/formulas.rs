//! Formulas of scenes, and where and when they are evaluated.

use frazil_core::formula::{Coordinates, Extremes, Formula, MOST_TURNS, OverTime, Sample, TIME, X, Y};
use frazil_core::series::Series;
use frazil_core::space::domain::Domain;
use frazil_record::quoted;

use super::range::{Range, plain, unfit};

/// The body and the time over which formulas are evaluated, as far as they are known.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Run {
    /// The body.
    pub(super) domain: Option<Domain>,
    /// End of the run (s).
    pub(super) duration: Option<f64>,
}

/// What a formula may depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    /// The time.
    Time,
    /// The place.
    Place,
    /// Both.
    PlaceAndTime,
}

/// A formula with its least and greatest value over the body and the run, where these are known.
pub(super) type Checked = (Formula, Option<Extremes>);

impl Run {
    /// Names in a formula, with the index of each coordinate.
    fn names(&self, of: Of) -> Vec<(&'static str, usize)> {
        let places = match self.domain {
            Some(domain) => {
                let (x, y) = domain.axes();
                vec![(x, X), (y, Y)].into_iter().take(domain.dimension()).collect()
            }
            None => vec![("x", X), ("y", Y), ("r", X), ("z", Y)],
        };
        match of {
            Of::Time => vec![("t", TIME)],
            Of::Place => places,
            Of::PlaceAndTime => [places, vec![("t", TIME)]].concat(),
        }
    }

    /// Least and greatest value over the body and the run; none where these are not known.
    fn extremes(&self, formula: &Formula) -> Option<Result<Extremes, Sample>> {
        let (domain, duration) = (self.domain?, self.duration?);
        let (first, last) = domain.corners();
        let inside = |at: &Coordinates| match domain {
            Domain::Ring { outer_radius, .. } => at[X].hypot(at[Y]) <= outer_radius,
            _ => true,
        };
        let of_used = |axis: usize, end: f64| if formula.uses(axis) { end } else { 0.0 };
        let low = [of_used(X, first.x), of_used(Y, first.y), 0.0];
        let high = [of_used(X, last.x), of_used(Y, last.y), of_used(TIME, duration)];
        Some(formula.extremes((low, high), inside))
    }

    /// That a value is not allowed, with where it was found.
    fn wrong(&self, formula: &Formula, sample: &Sample, allowed: &str) -> String {
        let used = self.names(Of::PlaceAndTime).into_iter().filter(|(_, index)| formula.uses(*index));
        let used: Vec<String> = used.map(|(name, index)| format!("{name} = {}", plain(sample.at[index]))).collect();
        let place = if used.is_empty() { String::new() } else { format!(" at {}", used.join(", ")) };
        format!("found {}{place}, must be {allowed}", plain(sample.value))
    }

    /// Reads a formula, all of whose values must be in a range.
    ///
    /// # Errors
    /// With what was found and what is allowed.
    pub(super) fn read(&self, text: &str, of: Of, range: Range) -> Result<Checked, String> {
        let formula = Formula::read(text, &self.names(of)).map_err(|mistake| format!("{}: {mistake}", quoted(text)))?;
        let extremes = match self.extremes(&formula) {
            Some(Ok(extremes)) => extremes,
            Some(Err(sample)) => return Err(self.wrong(&formula, &sample, "a finite number")),
            None => return Ok((formula, None)),
        };
        for sample in [extremes.least, extremes.greatest] {
            // Near its zeros a formula may have values of any size.
            let unfit = unfit(sample.value).filter(|_| sample.value.abs() > 1.0);
            if unfit.is_some() || !range.contains(sample.value) {
                let allowed = unfit.map_or_else(|| range.to_string(), str::to_owned);
                return Err(self.wrong(&formula, &sample, &allowed));
            }
        }
        Ok((formula, Some(extremes)))
    }

    /// A formula of the time alone as a series; its value at the start where the length of the run is not known.
    ///
    /// # Errors
    /// With what is wrong where it turns too often.
    pub(super) fn over_time(&self, (formula, extremes): Checked) -> Result<Series, String> {
        let Some((extremes, duration)) = extremes.zip(self.duration) else {
            return Ok(Series::Constant(formula.at(&[0.0; 3])));
        };
        let over_time = OverTime::new(formula, &extremes, duration).map(|formula| Series::Formula(formula.into()));
        over_time.ok_or_else(|| {
            format!(
                "found more than {MOST_TURNS} turns from rising to falling over the run, must be at most as many: \
                 write one period as a table with a period"
            )
        })
    }
}
