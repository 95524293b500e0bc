//! What refuses layouts: each cause once, with those that it refuses.

/// Causes and the names of the layouts that each refuses.
pub(super) struct Refusals<T>(Vec<(T, Vec<String>)>);

impl<T: PartialEq> Refusals<T> {
    pub(super) fn new() -> Self {
        Refusals(Vec::new())
    }

    /// Takes note of a layout that is refused.
    pub(super) fn add(&mut self, cause: T, layout: &str) {
        let layout = layout.to_owned();
        match self.0.iter_mut().find(|(other, _)| *other == cause) {
            Some((_, layouts)) => layouts.push(layout),
            None => self.0.push((cause, vec![layout])),
        }
    }

    /// The causes, each with the layouts in words.
    pub(super) fn told(self) -> impl Iterator<Item = (T, String)> {
        self.0.into_iter().map(|(cause, layouts)| match &layouts[..] {
            [only] => (cause, format!("layout \"{only}\"")),
            [first, ..] => (cause, format!("{} layouts, such as \"{first}\"", layouts.len())),
            [] => (cause, String::new()),
        })
    }
}
