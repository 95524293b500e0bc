//! Terms are used one way: the documents, the help texts, the messages and the scenes have none of the words that the glossary rules out,
//! and none of the phrases that once read as translated.

use std::fs;
use std::path::{Path, PathBuf};

use syn::buffer::{Cursor, TokenBuffer};

/// Phrases that say in a roundabout way what has a plain word.
const ROUNDABOUT: &[&str] = &[
    "makes of its",
    "make of their",
    "by luck",
    "read off",
    "once more",
    "bonds that turn",
    "is told",
    "are told",
    "is said",
    "are said",
    "stands in (but stands in the table)",
    "stand in",
    "goes in",
    "go in",
    "what rounding takes",
    "from afar",
    "knows nothing",
    "know nothing",
    "becomes of",
    "became of",
    "sooner on",
    "says no",
    "told apart",
    "tells apart",
    "ever finer",
    "held against",
    "under local",
    "under sph",
    "under pd",
    "under edpd",
    "in other words",
];

/// A word or phrase that is not to be used, but within these expressions, and what asks for that.
#[derive(Debug)]
struct Unwanted {
    words: String,
    within: Vec<String>,
    of: String,
}

impl Unwanted {
    /// Words, and in brackets after `but` the expressions that may have them.
    fn read(text: &str, of: &str) -> Self {
        let (words, within) = text.split_once(" (but ").unwrap_or((text, ""));
        let within = within.trim_end_matches(')').split(';').map(|one| one.trim().to_lowercase());
        let within = within.filter(|one| !one.is_empty()).collect();
        Unwanted { words: words.to_lowercase(), within, of: of.to_owned() }
    }
}

/// A text for people and where it is.
struct Passage {
    place: String,
    text: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()))
}

/// All files below a folder with an ending.
fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder") {
            let path = entry.expect("an entry").path();
            match path.is_dir() {
                true => folders.push(path),
                false if path.extension().is_some_and(|found| found == ending) => found.push(path),
                false => {}
            }
        }
    }
    found.sort();
    found
}

/// The last column of the glossary: words, separated by semicolons, each with expressions that may have it.
fn of_the_glossary(text: &str) -> Vec<Unwanted> {
    let mut found = Vec::new();
    for row in text.lines().filter(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [term, .., words] = cells[..] else { continue };
        if term == "term" || term.starts_with("---") {
            continue;
        }
        let mut depth = 0;
        let parts = words.split(|c| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            c == ';' && depth == 0
        });
        let parts = parts.map(str::trim).filter(|part| !part.is_empty());
        found.extend(parts.map(|part| Unwanted::read(part, term)));
    }
    found
}

fn all_unwanted() -> Vec<Unwanted> {
    let phrases = ROUNDABOUT.iter().map(|words| Unwanted::read(words, "the phrases of tests/glossary.rs"));
    of_the_glossary(&read(&root().join("docs/glossary.md"))).into_iter().chain(phrases).collect()
}

/// Where whole words stand in a text, both in small letters.
fn places<'a>(text: &'a str, words: &'a str) -> impl Iterator<Item = usize> + 'a {
    let inside = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    text.match_indices(words).map(|(at, _)| at).filter(move |at| {
        let before = text[..*at].chars().next_back();
        let after = text[at + words.len()..].chars().next();
        !before.is_some_and(inside) && !after.is_some_and(inside)
    })
}

/// What a text has that it should not, with what is around it.
fn faults(text: &str, unwanted: &[Unwanted]) -> Vec<String> {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase();
    let mut found = Vec::new();
    for one in unwanted {
        for at in places(&text, &one.words) {
            let end = at + one.words.len();
            let covers = |within: &String| {
                text.match_indices(within.as_str()).any(|(from, _)| from <= at && end <= from + within.len())
            };
            if !one.within.iter().any(covers) {
                let from = (0..=at.saturating_sub(30)).rev().find(|k| text.is_char_boundary(*k)).unwrap_or_default();
                let to = (end + 30..=text.len()).find(|k| text.is_char_boundary(*k)).unwrap_or(text.len());
                found.push(format!("\"{}\" (see \"{}\"): ... {} ...", one.words, one.of, &text[from..to]));
            }
        }
    }
    found
}

/// The prose of a document: no fenced blocks, no words in back-quotes, no addresses of links.
fn prose(text: &str) -> String {
    let unfenced: String = text.split("```").step_by(2).collect();
    let unquoted: String = unfenced.split('`').step_by(2).collect::<Vec<_>>().join(" ` ");
    let mut parts = unquoted.split("](");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |prose, rest| prose + "]" + rest.split_once(')').map_or(rest, |(_, rest)| rest))
}

fn documents() -> Vec<Passage> {
    let mut paths = files("docs", "md");
    paths.extend(["README.md", "CHANGELOG.md", "python/README.md"].map(|name| root().join(name)));
    let passage = |path: PathBuf| {
        let mut text = read(&path);
        if path.ends_with("glossary.md") {
            // Its last column is the list of what is not to be used.
            let kept = |line: &str| {
                line.trim_end_matches('|').rsplit_once('|').map_or(line.to_owned(), |(row, _)| row.to_owned())
            };
            text = text.lines().map(kept).collect::<Vec<_>>().join("\n");
        }
        Passage { place: path.display().to_string(), text: prose(&text) }
    };
    paths.into_iter().map(passage).collect()
}

/// Help texts: comments of the arguments of commands.
fn help() -> Vec<Passage> {
    let paths = files("src/cli", "rs").into_iter().chain([root().join("src/cli.rs")]);
    let comments = |path: PathBuf| {
        let text = read(&path);
        let lines = text.lines().filter_map(|line| line.trim_start().strip_prefix("///"));
        Passage { place: path.display().to_string(), text: prose(&lines.collect::<Vec<_>>().join("\n")) }
    };
    paths.map(comments).collect()
}

/// Whether an attribute, without its brackets, is `cfg(test)`.
fn is_for_tests(attribute: Cursor<'_>) -> bool {
    let is = |cursor: Cursor<'_>, word: &str| cursor.ident().is_some_and(|(name, _)| name == word);
    let arguments = attribute.ident().and_then(|(_, rest)| rest.any_group());
    is(attribute, "cfg") && arguments.is_some_and(|(inside, ..)| is(inside, "test"))
}

/// The text of a literal, if it is one. Parsing it as code would keep it, and its place among all others, to the end.
fn value(literal: &str) -> Option<String> {
    if let Some(raw) = literal.strip_prefix('r') {
        return Some(raw.trim_matches('#').trim_matches('"').to_owned());
    }
    let mut text = String::new();
    let mut characters = literal.strip_prefix('"')?.strip_suffix('"')?.chars().peekable();
    while let Some(character) = characters.next() {
        match (character, characters.peek()) {
            ('\\', Some('\n')) => while characters.next_if(|c| c.is_whitespace()).is_some() {},
            ('\\', _) => text.extend(characters.next().map(|c| if matches!(c, 'n' | 't' | 'r') { ' ' } else { c })),
            _ => text.push(character),
        }
    }
    Some(text)
}

/// Texts of code, but those of comments and of tests.
fn literals(mut cursor: Cursor<'_>, found: &mut Vec<String>) {
    let mut of_tests = false;
    while !cursor.eof() {
        cursor = if let Some((inside, delimiter, _, rest)) = cursor.any_group() {
            if of_tests {
                of_tests = format!("{delimiter:?}") != "Brace";
            } else if is_for_tests(inside) {
                of_tests = true;
            } else if inside.ident().is_none_or(|(name, _)| name != "doc") {
                literals(inside, found);
            }
            rest
        } else if let Some((literal, rest)) = cursor.literal() {
            found.extend(value(&literal.to_string()).filter(|_| !of_tests));
            rest
        } else if let Some((mark, rest)) = cursor.punct() {
            of_tests &= mark.as_char() != ';';
            rest
        } else if let Some((_, rest)) = cursor.token_tree() {
            rest
        } else {
            return;
        };
    }
}

/// A text of code without what it names in quotes, and without what is filled in.
fn said(text: &str) -> String {
    let unquoted = text.split('"').step_by(2).collect::<Vec<_>>().join(" \" ");
    let unquoted = unquoted.split('`').step_by(2).collect::<Vec<_>>().join(" ` ");
    let mut parts = unquoted.split('{');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |said, rest| said + " {} " + rest.split_once('}').map_or(rest, |(_, rest)| rest))
}

/// Messages: texts of several words in the code of the program, its tests apart.
fn messages() -> Vec<Passage> {
    let mut found = Vec::new();
    for path in ["src", "plots", "methods", "cases"].into_iter().flat_map(|folder| files(folder, "rs")) {
        let place = path.display().to_string();
        if place.contains("tests") {
            continue;
        }
        let tokens = read(&path).parse().unwrap_or_else(|error| unreachable!("{place}: {error}"));
        let mut texts = Vec::new();
        literals(TokenBuffer::new2(tokens).begin(), &mut texts);
        let texts = texts.into_iter().map(|text| said(&text)).filter(|text| text.trim().contains(' '));
        found.extend(texts.map(|text| Passage { place: place.clone(), text }));
    }
    found
}

/// Titles and comments of bundled scenes, studies and fluids.
fn scenes() -> Vec<Passage> {
    let folders = ["scenes", "extreme", "studies", "paper", "fluids"];
    let paths = folders.iter().flat_map(|folder| files(&format!("cases/{folder}"), "toml"));
    let words = |path: PathBuf| {
        let text = read(&path);
        let comments = text.lines().filter_map(|line| line.split_once('#')).map(|(_, comment)| comment);
        let titles = text.lines().filter_map(|line| line.strip_prefix("title = "));
        Passage { place: path.display().to_string(), text: comments.chain(titles).collect::<Vec<_>>().join("\n") }
    };
    paths.map(words).collect()
}

fn hold(passages: Vec<Passage>, least: usize) {
    assert!(passages.len() >= least, "{}", passages.len());
    let unwanted = all_unwanted();
    assert!(unwanted.len() > 100, "{}", unwanted.len());
    let found: Vec<String> = passages
        .iter()
        .flat_map(|one| faults(&one.text, &unwanted).into_iter().map(|fault| format!("{}: {fault}", one.place)))
        .collect();
    assert!(found.is_empty(), "{}\n{}", found.len(), found.join("\n"));
}

#[test]
fn documents_use_the_terms_of_the_glossary() {
    hold(documents(), 20);
}

#[test]
fn help_uses_the_terms_of_the_glossary() {
    hold(help(), 15);
}

#[test]
fn messages_use_the_terms_of_the_glossary() {
    hold(messages(), 1000);
}

#[test]
fn scenes_use_the_terms_of_the_glossary() {
    hold(scenes(), 80);
}

/// The check finds whole words, in any case and over line breaks, and lets what is allowed pass.
#[test]
fn unwanted_words_are_found() {
    let rows = "| term | meaning | symbol | not |\n| --- | --- | --- | --- |\n\
                | frozen wall | a ring | | ice wall; walls of ice |\n| pair | two | | bond (but bond rule; covalent bond) |\n";
    let unwanted = of_the_glossary(rows);
    assert_eq!(unwanted.iter().map(|one| one.words.as_str()).collect::<Vec<_>>(), ["ice wall", "walls of ice", "bond"]);
    let count = |text: &str| faults(text, &unwanted).len();
    assert_eq!(count("An ice\nwall grows. Walls of ice, and a bond."), 3);
    assert_eq!(count("A bond rule, the bond rules, bond-based, bonds, a covalent bond, police wall, bond_rules"), 0);
    let own = all_unwanted();
    assert_eq!(faults("What a particle makes of its enthalpy is told once more.", &own).len(), 3);
    assert_eq!(prose("a `bond`\n```sh\nbond\n```\nand [a link](bond.md)").matches("bond").count(), 0);
    assert_eq!(said("found \"bond\", {bond} and `bond`").matches("bond").count(), 0);
    let mut texts = Vec::new();
    let code = "/// bond\n#[error(\"a bond {0}\")] fn f() { let g = format!(\"two {}\", [\"bond\"]); } #[cfg(test)] mod t { const A: &str = \"b\"; }";
    literals(TokenBuffer::new2(code.parse().expect("code")).begin(), &mut texts);
    assert_eq!(texts, ["a bond {0}", "two {}", "bond"]);
    assert_eq!(value("\"a \\\"b\\\"\\n c \\\n   d\"").as_deref(), Some("a \"b\"  c d"));
    assert_eq!((value("1.5"), value("r#\"a\"#").as_deref()), (None, Some("a")));
}

/// Numbers in documents and messages are written as people do: 1.155 and not 1.155e0.
#[test]
fn numbers_are_as_people_write_them() {
    let odd = |word: &str| {
        let (mantissa, power) = word.split_once('e')?;
        let is_number = mantissa.contains('.') && mantissa.parse::<f64>().is_ok();
        (is_number && matches!(power, "0" | "1" | "2" | "-1")).then(|| word.to_owned())
    };
    let words = |text: &str| {
        let parts = text.split(|c: char| !(c.is_alphanumeric() || c == '.' || c == '-'));
        parts.filter_map(odd).collect::<Vec<_>>()
    };
    assert_eq!(words("step 1.1551e0 s, 3.3e-2, 0.5e5"), ["1.1551e0"]);
    for path in files("docs", "md").into_iter().chain([root().join("README.md")]) {
        let found = words(&read(&path));
        assert!(found.is_empty(), "{}: {found:?}", path.display());
    }
}
