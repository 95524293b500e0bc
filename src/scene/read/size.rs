//! How much a file may hold: what is larger is not meant, and would take what reading and planning have no time for.

use super::problem::{Place, Problem};
use super::tree::{Entry, Node};

/// Bytes of a file.
pub const MOST_BYTES: usize = 4_000_000;
/// Numbers, texts or points of a list.
const MOST_ITEMS: usize = 100_000;
/// Tables of a list, and keys of a table.
const MOST_TABLES: usize = 1000;

/// What is too large of a text before it is parsed.
pub(super) fn of_text(text: &str) -> Option<Problem> {
    let message = || format!("found {} bytes, must have at most {MOST_BYTES}", text.len());
    (text.len() > MOST_BYTES).then(|| Problem::new(&Place::File, "", message()))
}

/// What is too large of the tables and lists of a file.
pub(super) fn of_entries(entries: &[Entry]) -> Vec<Problem> {
    let mut problems = Vec::new();
    table("", &Place::File, entries, &mut problems);
    problems
}

fn table(path: &str, place: &Place, entries: &[Entry], problems: &mut Vec<Problem>) {
    if entries.len() > MOST_TABLES {
        let message = format!("found {} keys, must have at most {MOST_TABLES}", entries.len());
        problems.push(Problem::new(place, path, message));
        return;
    }
    for entry in entries {
        let path = if path.is_empty() { entry.key.clone() } else { format!("{path}.{}", entry.key) };
        node(&path, &entry.place, &entry.node, problems);
    }
}

fn node(path: &str, place: &Place, node: &Node, problems: &mut Vec<Problem>) {
    match node {
        Node::Table(entries) => table(path, place, entries, problems),
        Node::List(items) => {
            let tables = items.iter().filter(|item| matches!(item.node, Node::Table(_))).count();
            let found = [(tables, "tables", MOST_TABLES), (items.len(), "items", MOST_ITEMS)];
            match found.into_iter().find(|(count, _, most)| count > most) {
                Some((count, what, most)) => {
                    let message = format!("found a list of {count} {what}, must have at most {most}");
                    problems.push(Problem::new(place, path, message));
                }
                None => (1..).zip(items).for_each(|(number, item)| {
                    if matches!(item.node, Node::Table(_) | Node::List(_)) {
                        self::node(&format!("{path}.{number}"), &item.place, &item.node, problems);
                    }
                }),
            }
        }
        Node::Text(_) | Node::Number(..) | Node::Flag(_) | Node::Date(_) => {}
    }
}
