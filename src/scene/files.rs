//! Files that a scene names, and where their texts come from.

use std::path::{Component, Path};
use std::rc::Rc;

/// Gives the text of a file by the name that a scene calls it, or says why it cannot be had.
type Open = dyn Fn(&str) -> Result<String, String>;

/// Where the files are that a scene may name: beside its own file, beside a bundled scene, or nowhere.
#[derive(Clone, Default)]
pub struct Files(Option<Rc<Open>>);

impl Files {
    /// Files that are opened by their names.
    pub fn opened(open: impl Fn(&str) -> Result<String, String> + 'static) -> Self {
        Files(Some(Rc::new(open)))
    }

    /// Files whose texts are at hand, as name and text.
    pub fn held(files: impl IntoIterator<Item = (String, String)>) -> Self {
        let files: Vec<(String, String)> = files.into_iter().collect();
        Files::opened(move |name| {
            let known = files.iter().find(|(own, _)| own == name);
            known.map(|(_, text)| text.clone()).ok_or_else(|| "there is none of this name".to_owned())
        })
    }

    /// The text of a file.
    pub(crate) fn text(&self, name: &str) -> Result<String, String> {
        if !is_beside(name) {
            return Err("a path must lead from the scene's folder down, as \"data/front.csv\"".into());
        }
        match &self.0 {
            Some(open) => open(name),
            None => Err("the scene is a text without a folder".into()),
        }
    }
}

/// Whether a name leads to a file in the folder of the scene or in one below it, and nowhere else.
pub fn is_beside(name: &str) -> bool {
    let down = |part: Component<'_>| matches!(part, Component::Normal(_));
    !name.is_empty() && !name.contains('\\') && Path::new(name).components().all(down)
}

/// The text of a scene, and the files that it may name.
#[derive(Clone)]
pub struct Source<'a> {
    /// The text.
    pub text: &'a str,
    /// The files.
    pub files: Files,
}

impl<'a> From<&'a str> for Source<'a> {
    fn from(text: &'a str) -> Self {
        Source { text, files: Files::default() }
    }
}

impl<'a> From<&'a String> for Source<'a> {
    fn from(text: &'a String) -> Self {
        Source::from(text.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_down_from_the_folder_of_the_scene_alone() {
        for name in ["front.csv", "data/front.csv", "./front.csv"] {
            assert_eq!(is_beside(name), !name.starts_with('.'), "{name}");
        }
        for name in ["", "/etc/passwd", "../front.csv", "data/../../front.csv", "data\\front.csv"] {
            assert!(!is_beside(name), "{name}");
        }
    }
}
