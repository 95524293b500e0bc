//! A layout and what is known of it.

use frazil_cases::layouts::LayoutTable;
use frazil_studies::cheapest::estimate::of_two;

use super::answers::Answers;
use super::execute::Pair;
use super::goals::Promise;
use super::variants::Layout;

/// A layout and what is known of it.
pub struct Found<'a> {
    /// The layout.
    pub layout: &'a Layout,
    /// Its runs.
    pub pair: Pair,
    /// What they say.
    pub fine: Answers,
    /// The same at twice the spacing.
    pub coarse: Option<Answers>,
    /// What it is compared with.
    pub reference: Option<Compared>,
}

/// How wrong a layout is at most: relative errors, where its wall has closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attained {
    /// Of the day of closure.
    pub closure: Option<f64>,
    /// Of the thickness at the end.
    pub thickness: Option<f64>,
}

impl Found<'_> {
    /// What it has reached of an error: what coarse and fine runs promised of it or, where that bounds it closer, the error that is
    /// left if what it differs by from itself at twice the spacing falls at the least order that they showed.
    pub fn attained(&self, promise: &Promise) -> Attained {
        let promised = promise.promised.get(&self.layout.name).copied().unwrap_or(1.0);
        let relative = |fine: f64, coarse: Option<f64>| {
            let apart = coarse.map(|coarse| of_two((fine - coarse).abs() / fine, 2.0, promise.order));
            apart.map_or(promised, |apart| apart.min(promised))
        };
        let thickness =
            |answers: &Answers| answers.days.last().map(|day| day.thickness_weakest_m).filter(|own| *own > 0.0);
        let coarse = self.coarse.as_ref();
        Attained {
            closure: self.fine.closure.map(|day| relative(day, coarse.and_then(|coarse| coarse.closure))),
            thickness: thickness(&self.fine).map(|own| relative(own, coarse.and_then(thickness))),
        }
    }
}

/// What a layout is compared with.
#[derive(Debug, Clone)]
pub enum Compared {
    /// A table.
    With(LayoutTable),
    /// None, since what was set with the command made another problem of it: the first difference.
    Set(String),
}
