//! How the code is built, held by what its files say: which packages and files know which, and how long they are.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// Packages with their folder and the packages of the workspace that they may name.
const PACKAGES: [(&str, &str, &[&str]); 13] = [
    ("frazil_record", "src/record", &[]),
    ("frazil_core", "src/core", &["frazil_record"]),
    ("frazil_scene", "src/scene", &["frazil_record", "frazil_core"]),
    ("frazil_simulation", "src/simulation", &["frazil_record", "frazil_core", "frazil_scene"]),
    ("frazil_local", "methods/local", METHODS_MAY),
    ("frazil_pd", "methods/pd", METHODS_MAY),
    ("frazil_sph", "methods/sph", METHODS_MAY),
    ("frazil_edpd", "methods/edpd", METHODS_MAY),
    ("frazil_cases", "cases", &["frazil_record", "frazil_core", "frazil_scene", "frazil_simulation"]),
    ("frazil_plots", "plots", &["frazil_record"]),
    (
        "frazil_studies",
        "src/studies",
        &["frazil_record", "frazil_core", "frazil_scene", "frazil_simulation", "frazil_plots"],
    ),
    (
        "frazil_layouts",
        "src/layout",
        &[
            "frazil_record",
            "frazil_core",
            "frazil_scene",
            "frazil_simulation",
            "frazil_cases",
            "frazil_plots",
            "frazil_studies",
        ],
    ),
    (
        "frazil_python",
        "python",
        &[
            "frazil",
            "frazil_record",
            "frazil_scene",
            "frazil_simulation",
            "frazil_cases",
            "frazil_plots",
            "frazil_studies",
            "frazil_layouts",
        ],
    ),
];
const METHODS_MAY: &[&str] = &["frazil_record", "frazil_core", "frazil_scene", "frazil_simulation"];

/// Files of one package that may import each other in a circle.
const LARGEST_CIRCLE: usize = 5;
/// Lines of a file.
const LONGEST_FILE: usize = 500;
/// Lines of a function outside tests.
const LONGEST_FUNCTION: usize = 80;

/// A file of a package.
struct Source {
    path: PathBuf,
    /// Its module, from the root of its package on.
    module: Vec<String>,
    lines: usize,
    syntax: syn::File,
}

impl Source {
    fn new(path: PathBuf, module: Vec<String>, text: &str) -> Self {
        let syntax = syn::parse_file(text).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
        Source { path, module, lines: text.lines().count(), syntax }
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files of a package but those of its tests.
fn sources(folder: &Path) -> Vec<Source> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            let name = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if entry.is_dir() {
                // The application keeps other packages in its folder.
                if name != "tests" && !entry.join("Cargo.toml").exists() {
                    folders.push(entry);
                }
            } else if name.ends_with(".rs") && name != "tests.rs" {
                let inner = entry.strip_prefix(folder).expect("inside").with_extension("");
                let mut module: Vec<String> = inner.iter().map(|part| part.to_string_lossy().into_owned()).collect();
                module.retain(|part| part != "lib" && part != "main");
                let text = fs::read_to_string(&entry).expect("readable");
                found.push(Source::new(entry, module, &text));
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

/// Paths that a file names outside tests, and how long its functions are.
#[derive(Default)]
struct Names {
    paths: BTreeSet<Vec<String>>,
    /// What `use` makes of a name.
    imported: BTreeMap<String, Vec<String>>,
    functions: Vec<(String, usize)>,
}

impl Names {
    fn of(syntax: &syn::File) -> Self {
        let mut names = Names::default();
        names.visit_file(syntax);
        names
    }

    fn tree(&mut self, tree: &syn::UseTree, before: &mut Vec<String>) {
        match tree {
            syn::UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.tree(&path.tree, before);
                before.pop();
            }
            syn::UseTree::Name(name) => self.leaf(&name.ident, &name.ident, before),
            syn::UseTree::Rename(name) => self.leaf(&name.ident, &name.rename, before),
            syn::UseTree::Glob(_) => {
                self.paths.insert(before.clone());
            }
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| self.tree(tree, before)),
        }
    }

    fn leaf(&mut self, name: &syn::Ident, here: &syn::Ident, before: &[String]) {
        let mut path = before.to_vec();
        path.extend(Some(name.to_string()).filter(|name| name != "self"));
        self.imported.insert(
            if name == "self" { before.last().cloned().unwrap_or_default() } else { here.to_string() },
            path.clone(),
        );
        self.paths.insert(path);
    }

    fn function(&mut self, signature: &syn::Signature, block: &syn::Block) {
        let lines = block.span().end().line + 1 - signature.span().start().line;
        self.functions.push((signature.ident.to_string(), lines));
    }
}

/// Whether something is there in tests alone.
fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        syn::Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string() == "test",
        syn::Meta::Path(path) => path.is_ident("test"),
        syn::Meta::NameValue(_) => false,
    })
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.tree(&item.tree, &mut Vec::new());
    }

    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.paths.insert(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_test(&item.attrs) {
            self.function(&item.sig, &item.block);
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.sig, &item.block);
        visit::visit_impl_item_fn(self, item);
    }
}

/// The files that each file imports, by their numbers. What a file has from another one is that one's.
fn imports(sources: &[Source]) -> Vec<BTreeSet<usize>> {
    let numbers: BTreeMap<&[String], usize> =
        sources.iter().enumerate().map(|(number, source)| (source.module.as_slice(), number)).collect();
    let names: Vec<Names> = sources.iter().map(|source| Names::of(&source.syntax)).collect();
    // A path from the root of the package on.
    let absolute = |own: usize, path: &[String]| -> Vec<String> {
        let module = &sources[own].module;
        match path[0].as_str() {
            "crate" => path[1..].to_vec(),
            "self" => [module, &path[1..]].concat(),
            "super" => {
                let ups = path.iter().take_while(|part| *part == "super").count();
                [&module[..module.len().saturating_sub(ups)], &path[ups..]].concat()
            }
            _ => [module, path].concat(),
        }
    };
    let file = |mut path: Vec<String>| {
        // As many names in a row as there may be.
        for _ in 0..8 {
            let (length, found) =
                (0..=path.len()).rev().find_map(|length| Some((length, *numbers.get(&path[..length])?)))?;
            let next = path.get(length).and_then(|name| names[found].imported.get(name));
            match next {
                Some(from) if absolute(found, from) != path => {
                    path = [absolute(found, from), path[length + 1..].to_vec()].concat();
                }
                _ => return Some(found).filter(|_| length > 0),
            }
        }
        None
    };
    let of = |own: usize| {
        let targets = names[own].paths.iter().filter_map(|path| file(absolute(own, path)));
        targets.filter(|target| *target != own).collect()
    };
    (0..sources.len()).map(of).collect()
}

/// Files that import each other in circles: each circle once, the files in order.
fn circles(imports: &[BTreeSet<usize>]) -> Vec<Vec<usize>> {
    let reached = |from: usize| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(at) = next.pop() {
            next.extend(imports[at].iter().copied().filter(|to| seen.insert(*to)));
        }
        seen
    };
    let reached: Vec<BTreeSet<usize>> = (0..imports.len()).map(reached).collect();
    let circle = |own: usize| -> Vec<usize> {
        reached[own].iter().copied().filter(|other| reached[*other].contains(&own)).collect()
    };
    let mut found: Vec<Vec<usize>> = (0..imports.len()).map(circle).filter(|circle| circle.len() > 1).collect();
    found.sort();
    found.dedup();
    found
}

/// What is too large about the files of a package: where, and in words how.
fn too_large(sources: &[Source]) -> Vec<(String, String)> {
    let mut wrong = Vec::new();
    let place = |source: &Source| source.path.strip_prefix(root()).unwrap_or(&source.path).display().to_string();
    for circle in circles(&imports(sources)) {
        if circle.len() > LARGEST_CIRCLE {
            let names: Vec<String> = circle.iter().map(|k| sources[*k].module.join("::")).collect();
            let first = place(&sources[circle[0]]);
            wrong.push((format!("a circle with {first}"), format!("{} files: {}", names.len(), names.join(", "))));
        }
    }
    for source in sources {
        let place = place(source);
        if source.lines > LONGEST_FILE {
            wrong.push((place.clone(), format!("{} lines", source.lines)));
        }
        for (name, lines) in Names::of(&source.syntax).functions {
            if lines > LONGEST_FUNCTION {
                wrong.push((format!("{place}: {name}"), format!("{lines} lines")));
            }
        }
    }
    wrong
}

/// Packages of the workspace that files name and may not.
fn forbidden(sources: &[Source], may: &[&str]) -> Vec<String> {
    let mut wrong = Vec::new();
    for source in sources {
        for path in Names::of(&source.syntax).paths {
            let first = path.first().map_or("", String::as_str);
            if first.starts_with("frazil") && !may.contains(&first) {
                wrong.push(format!("{} names {}", source.path.display(), path.join("::")));
            }
        }
    }
    wrong
}

/// Files that no module declares, so that no compiler ever sees them.
fn orphans(sources: &[Source]) -> Vec<String> {
    let declared: BTreeSet<Vec<String>> = sources
        .iter()
        .flat_map(|source| {
            let child = |item: &syn::Item| match item {
                syn::Item::Mod(item) if item.content.is_none() => Some(item.ident.to_string()),
                _ => None,
            };
            let names: Vec<String> = source.syntax.items.iter().filter_map(child).collect();
            names.into_iter().map(|name| source.module.iter().cloned().chain([name]).collect())
        })
        .collect();
    let root = |source: &Source| source.module.is_empty() || source.module == ["build"];
    let orphan = |source: &&Source| !root(source) && !declared.contains(&source.module);
    sources.iter().filter(orphan).map(|source| source.path.display().to_string()).collect()
}

#[test]
fn packages_know_only_those_below() {
    for (name, folder, may) in PACKAGES {
        let wrong = forbidden(&sources(&root().join(folder)), may);
        assert!(wrong.is_empty(), "{name}:\n{}", wrong.join("\n"));
        let manifest = fs::read_to_string(root().join(folder).join("Cargo.toml")).expect("readable");
        let manifest: toml::Table = manifest.parse().expect("a manifest");
        let dependencies = manifest["dependencies"].as_table().expect("a table");
        let own = dependencies.keys().filter(|key| key.starts_with("frazil")).map(|key| key.replace('-', "_"));
        let wrong: Vec<String> = own.filter(|key| !may.contains(&key.as_str())).collect();
        assert!(wrong.is_empty(), "{name} depends on {}", wrong.join(", "));
    }
}

#[test]
fn the_page_on_the_architecture_and_its_drawing_name_all_packages() {
    for path in ["docs/architecture.md", "docs/images/architecture.svg"] {
        let text = fs::read_to_string(root().join(path)).expect("readable");
        for (name, _, _) in PACKAGES {
            assert!(text.contains(&name.replace('_', "-")), "{path}: {name}");
        }
    }
}

#[test]
fn circles_files_and_functions_stay_small() {
    let folders = PACKAGES.iter().map(|package| package.1).chain(["src"]);
    let wrong = folders.flat_map(|folder| too_large(&sources(&root().join(folder))));
    let wrong: Vec<String> = wrong.map(|(place, how)| format!("{place}: {how}")).collect();
    assert!(wrong.is_empty(), "too large:\n{}", wrong.join("\n"));
}

#[test]
fn every_file_is_a_module() {
    let folders = PACKAGES.iter().map(|package| package.1).chain(["src"]);
    let found: Vec<String> = folders.flat_map(|folder| orphans(&sources(&root().join(folder)))).collect();
    assert!(found.is_empty(), "no module declares:\n{}", found.join("\n"));
}

#[test]
fn what_is_planted_is_found() {
    let source = |name: &str, text: &str| Source::new(PathBuf::from(name), vec![name.to_owned()], text);
    let ring = |count: usize| -> Vec<Source> {
        let text = |next: usize| format!("use crate::m{next}::T{next};");
        (0..count).map(|k| source(&format!("m{k}"), &text((k + 1) % count))).collect()
    };
    assert!(too_large(&ring(LARGEST_CIRCLE)).is_empty());
    assert_eq!(too_large(&ring(LARGEST_CIRCLE + 1)).len(), 1);
    // Through names that another file hands on, and by paths without `use`.
    let handed = [
        source("a", "pub use crate::b::Thing;"),
        source("b", "pub struct Thing; fn f() { crate::c::g() }"),
        source("c", "pub fn g() { let _ = crate::a::Thing; }"),
    ];
    assert_eq!(circles(&imports(&handed)), [vec![1, 2]]);
    let test = [source("a", "#[cfg(test)] mod tests { use crate::b::X; }"), source("b", "use crate::a::Y;")];
    assert!(circles(&imports(&test)).is_empty());
    let long = |lines: usize| format!("fn f() {{\n{}}}\n", "    g();\n".repeat(lines - 2));
    assert!(too_large(&[source("a", &long(LONGEST_FUNCTION))]).is_empty());
    assert_eq!(too_large(&[source("a", &long(LONGEST_FUNCTION + 1))])[0].0, "a: f");
    assert_eq!(too_large(&[source("a", &"const A: u8 = 1;\n".repeat(LONGEST_FILE + 1))])[0].0, "a");
    let upwards = [source("a", "fn f() -> frazil_scene::Scene { todo() }")];
    assert_eq!(forbidden(&upwards, &["frazil_core"]).len(), 1);
    assert!(forbidden(&upwards, &["frazil_scene"]).is_empty());
    let root = |text: &str| Source::new(PathBuf::from("lib"), Vec::new(), text);
    assert!(orphans(&[root("mod a;"), source("a", "")]).is_empty());
    assert_eq!(orphans(&[root("mod a;"), source("a", ""), source("b", "")]), ["b"]);
}
