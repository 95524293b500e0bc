//! Names as names of folders: of files, layouts and settings, which people write as they like.

/// Longest name that a folder takes over, and what it takes over of a longer one.
const LONGEST: usize = 80;
const KEPT: usize = 60;

/// Names that some systems keep for devices, with any ending.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// A name of a folder on every system, of its own for each name: the name itself where it is one, and otherwise what can be kept of
/// it with a number made of all of it. Never one that leads elsewhere.
pub fn of(name: &str) -> String {
    let whole = kept(name, LONGEST);
    let same = whole == name && !name.ends_with(['.', ' ']) && !name.is_empty();
    if same { whole } else { format!("{}-{:08x}", kept(name, KEPT), number(name)) }
}

/// The same where names may differ in small and capital letters alone, which some systems take for one: always with the number.
pub fn apart(name: &str) -> String {
    format!("{}-{:08x}", kept(&name.replace([' ', '+', ',', '='], "_"), KEPT), number(name))
}

fn number(name: &str) -> u64 {
    xxhash_rust::xxh3::xxh3_64(name.as_bytes()) & 0xffff_ffff
}

fn kept(name: &str, longest: usize) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-._ +,=".contains(letter);
    let mut kept: String = name.chars().take(longest).map(|letter| if plain(letter) { letter } else { '_' }).collect();
    // Neither hidden, nor an option, nor a formula.
    if !kept.starts_with(|first: char| first.is_ascii_alphanumeric() || first == '_') {
        kept = format!("_{}", kept.get(1..).unwrap_or_default());
    }
    let stem = kept.split('.').next().unwrap_or_default().trim_end().to_ascii_lowercase();
    let numbered =
        |kind: &str| stem.strip_prefix(kind).is_some_and(|rest| rest.len() == 1 && rest.as_bytes()[0].is_ascii_digit());
    if DEVICES.contains(&stem.as_str()) || numbered("com") || numbered("lpt") {
        kept.insert(0, '_');
    }
    kept
}

/// Two names of which some systems would make one folder.
pub fn alike<'a>(names: &[&'a str]) -> Option<(&'a str, &'a str)> {
    let small: Vec<String> = names.iter().map(|name| name.to_ascii_lowercase()).collect();
    let mut seen = std::collections::HashMap::new();
    small.iter().enumerate().find_map(|(k, name)| seen.insert(name, k).map(|before: usize| (names[before], names[k])))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn usual_names_stay() {
        for name in ["stefan-water", "my scene 2", "a.b_c", "_x", "2024", "console", "a=3"] {
            assert_eq!(of(name), name);
        }
    }

    #[test]
    fn names_that_lead_elsewhere_or_are_kept_for_devices_do_not() {
        let bad = [
            "",
            ".",
            "..",
            "...",
            ".hidden",
            "-rf",
            "=1+1",
            "a/b",
            "../x",
            "a\\b",
            "C:x",
            "CON",
            "nul.x",
            "Com1",
            "LPT9 .a",
            "a.",
            "a ",
            "a\0b",
            "a\u{202e}b",
            "ä",
        ];
        let long = "x".repeat(400);
        for name in bad.into_iter().chain([long.as_str()]) {
            let folder = of(name);
            assert_ne!(folder, name);
            sound(&folder);
        }
        // One form of a letter and its other one.
        assert_ne!(of("\u{e4}"), of("a\u{308}"));
        assert_ne!(apart("a").to_lowercase(), apart("A").to_lowercase());
        assert_eq!(alike(&["a", "b", "A"]), Some(("a", "A")));
        assert_eq!(alike(&["a", "b"]), None);
    }

    fn sound(folder: &str) {
        let path = std::path::Path::new(folder);
        assert_eq!(path.components().count(), 1, "{folder}");
        assert!(matches!(path.components().next(), Some(std::path::Component::Normal(_))), "{folder}");
        assert!(folder.len() < 100 && folder.is_ascii() && !folder.ends_with(['.', ' ']), "{folder}");
        assert!(folder.starts_with(|first: char| first.is_ascii_alphanumeric() || first == '_'), "{folder}");
        let stem = folder.split('.').next().unwrap_or_default().trim_end().to_lowercase();
        assert!(!["con", "prn", "aux", "nul", "com1", "lpt9"].contains(&stem.as_str()), "{folder}");
    }

    proptest! {
        #[test]
        fn every_text_is_a_folder(text in any::<String>(), other in "[.a/ \\-=CON]{0,6}") {
            for name in [text, other] {
                sound(&of(&name));
                sound(&apart(&name));
                prop_assert_eq!(of(&of(&name)), of(&name));
            }
        }
    }
}
