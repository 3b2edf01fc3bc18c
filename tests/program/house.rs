//! Checks rules for the source files that the compiler cannot check.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::import_arrows::{arrows, circles};

/// Largest number of lines in a source file. A longer file usually contains several concepts.
const LONGEST_FILE: usize = 500;

/// Returns all Rust files of the package and its crates except tests: path and content.
fn sources() -> BTreeMap<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    files_below(&[root.join("src"), root.join("crates")])
}

/// Returns all Rust files below some folders of the package: path and content.
fn files_below(folders: &[PathBuf]) -> BTreeMap<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = BTreeMap::new();
    let mut folders = folders.to_vec();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
                found.insert(name, std::fs::read_to_string(&path).unwrap());
            }
        }
    }
    assert!(found.len() > 100, "{found:?}");
    found
}

/// Returns the names of the items of one kind in a source text. `keyword` is the keyword of this kind, such as `mod` or
/// `fn`.
fn named<'a>(text: &'a str, keyword: &str) -> impl Iterator<Item = &'a str> {
    let keyword = format!("{keyword} ");
    text.lines().filter_map(move |line| {
        let line = line.trim_start();
        let item = line.strip_prefix("pub").map_or(line, |rest| {
            rest.split_once(") ").filter(|_| rest.starts_with('(')).map_or(rest, |(_, it)| it)
        });
        let name = item.trim_start().strip_prefix(&*keyword)?;
        Some(
            &name[..name.find(|it: char| !it.is_alphanumeric() && it != '_').unwrap_or(name.len())],
        )
    })
}

#[test]
fn every_file_is_compiled() {
    let sources = sources();
    let is_named = |path: &str| {
        let (folder, file) = path.rsplit_once('/').unwrap();
        let (folder, name) = match file {
            "lib.rs" | "main.rs" => return true,
            "mod.rs" => folder.rsplit_once('/').unwrap(),
            _ => (folder, file.trim_end_matches(".rs")),
        };
        let owners = ["mod.rs", "lib.rs"].map(|owner| format!("{folder}/{owner}"));
        let owners = owners.into_iter().chain([format!("{folder}.rs")]);
        owners
            .filter_map(|owner| sources.get(&owner))
            .any(|it| named(it, "mod").any(|it| it == name))
    };
    let orphans: Vec<_> = sources.keys().filter(|path| !is_named(path)).collect();
    assert!(orphans.is_empty(), "no `mod` names {orphans:?}");
}

#[test]
fn every_scene_made_to_break_methods_is_listed() {
    let sources = sources();
    let registry = &sources["crates/core/src/scene/registry.rs"];
    let rooms = sources.iter().filter(|(path, _)| {
        path.starts_with("crates/core/src/scene/stability/") && !path.ends_with("mod.rs")
    });
    let unlisted: Vec<_> =
        rooms.filter(|(_, text)| !named(text, "fn").any(|it| registry.contains(it))).collect();
    assert!(unlisted.is_empty(), "no row of the registry makes {unlisted:?}");
}

#[test]
fn a_file_can_be_held_in_the_head() {
    let long: Vec<_> = sources()
        .into_iter()
        .map(|(path, text)| (path, text.lines().count()))
        .filter(|(_, lines)| *lines > LONGEST_FILE)
        .collect();
    assert!(long.is_empty(), "longer than {LONGEST_FILE} lines: {long:?}");
}

#[test]
fn imports_point_one_way() {
    let sources = sources();
    let mut back = Vec::new();
    for (root, own_name) in [
        ("crates/core/src/", "slump_core"),
        ("crates/data/src/", "slump_data"),
        ("crates/studies/src/", "slump_studies"),
        ("src/", "slump"),
    ] {
        let of_crate = sources
            .iter()
            .filter_map(|(path, text)| Some((path.strip_prefix(root)?.to_owned(), text.clone())));
        let arrows = arrows(&of_crate.collect(), &[own_name]);
        assert!(arrows.len() > 100, "{root}: {} arrows", arrows.len());
        back.extend(circles(&arrows).into_iter().map(|it| format!("{root}{it}")));
    }
    assert!(back.is_empty(), "imports in a circle: {back:#?}");
}

#[test]
fn a_circle_of_imports_is_found() {
    let file = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    let one_way = [
        file("lib.rs", "mod a; mod b; pub use b::inner::Item;"),
        file("a.rs", "use crate::Item; fn f() {}"),
        file("b/mod.rs", "pub mod inner;"),
        file("b/inner.rs", "pub struct Item; #[cfg(test)] mod tests { use crate::a::f; }"),
    ];
    let mut sources = BTreeMap::from(one_way);
    assert_eq!(circles(&arrows(&sources, &[])), Vec::<String>::new());
    sources.extend([file("b/inner.rs", "use super::super::a; pub struct Item;")]);
    assert_eq!(circles(&arrows(&sources, &[])).len(), 2, "a → b and b → a");
    sources.extend([file("b/inner.rs", "pub struct Item; fn g() { crate::a::f(); }")]);
    assert_eq!(circles(&arrows(&sources, &[])).len(), 2, "a path without `use`");
}

#[test]
fn documents_name_files_that_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let places = [
        "",
        "crates/core/src/",
        "crates/core/src/solver/",
        "crates/data/src/",
        "crates/studies/src/",
        "crates/",
        "src/",
    ];
    let is_there = |name: &str| {
        let crates = ["core", "data", "studies"];
        let in_crate = crates.iter().find_map(|it| {
            name.strip_prefix(&format!("{it}/")).map(|rest| format!("crates/{it}/src/{rest}"))
        });
        let named = places.iter().map(|place| format!("{place}{name}")).chain(in_crate);
        named.into_iter().any(|path| root.join(path).exists())
    };
    let mut gone = Vec::new();
    let book = std::fs::read_dir(root.join("docs")).unwrap().map(|page| page.unwrap().path());
    let others = ["ARCHITECTURE.md", "CONTRIBUTING.md", "README.md"].map(|name| root.join(name));
    for document in book.chain(others) {
        let text = std::fs::read_to_string(&document).unwrap();
        let document = document.display();
        let names = text.split('`').skip(1).step_by(2);
        let files = names.filter(|name| {
            name.contains('/')
                && [".rs", ".sh", ".py", ".csv"].iter().any(|ending| name.ends_with(ending))
                && !name.contains(char::is_whitespace)
                && !["NAME", "out/", "results/", "KEY", "{"].iter().any(|it| name.contains(it))
        });
        gone.extend(files.filter(|name| !is_there(name)).map(|name| format!("{document}: {name}")));
    }
    assert!(gone.is_empty(), "{gone:#?}");
}

/// Phrases that readers do not understand at once and that comments and documents must not contain. Each has a plain
/// replacement: again, depends on, reports, also, continues, if, is not solved.
const PRIVATE_PHRASES: [&str; 11] = [
    " anew",
    "hangs on",
    "hang on",
    "told of",
    "tells of",
    "besides",
    "goes on with",
    "gone on with",
    "True where",
    "held against",
    "leaves unsolved",
];

#[test]
fn comments_and_documents_use_plain_words() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut texts =
        files_below(&["src", "crates", "python", "tests", "benches"].map(|it| root.join(it)));
    for text in texts.values_mut() {
        let is_comment = |line: &&str| line.trim_start().starts_with("//");
        *text = text
            .lines()
            .map(|line| if is_comment(&line) { line } else { "" })
            .fold(String::new(), |text, line| text + line + "\n");
    }
    let book = std::fs::read_dir(root.join("docs")).unwrap().map(|page| page.unwrap().path());
    let others =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "python/README.md"];
    for page in book.chain(others.map(|name| root.join(name))) {
        texts.insert(page.display().to_string(), std::fs::read_to_string(&page).unwrap());
    }
    let mut found = Vec::new();
    for (path, text) in &texts {
        for (number, line) in text.lines().enumerate() {
            let phrases = PRIVATE_PHRASES.iter().filter(|phrase| line.contains(**phrase));
            found.extend(phrases.map(|phrase| format!("{path}:{}: {phrase}", number + 1)));
        }
    }
    found.retain(|it| !it.starts_with("tests/program/house.rs"));
    assert!(found.is_empty(), "plain words instead of: {found:#?}");
}

/// Checks that the physics does not call `max(0.0)` or `min(0.0)`. For 0.0 and -0.0, `f64::max` and `f64::min` may
/// return either of the two; [`slump_core::number::Parts`] always returns the same.
#[test]
fn no_sign_of_a_zero_depends_on_the_compiler() {
    let sources = sources();
    let of_physics = sources.iter().filter(|(path, _)| {
        path.starts_with("crates/core/src/") || path.starts_with("crates/data/src/")
    });
    let open: Vec<_> = of_physics
        .flat_map(|(path, text)| text.lines().map(move |line| (path, line.trim())))
        .filter(|(_, line)| [".max(0.0)", ".min(0.0)"].iter().any(|call| line.contains(call)))
        .collect();
    assert!(
        open.is_empty(),
        "`positive_part` and `negative_part` are the same everywhere: {open:#?}"
    );
}

/// Checks that the name of a test, or of its module, says that the test needs ffmpeg or a graphics driver. Then `cargo
/// test -- --ignored with_driver with_ffmpeg` selects these tests.
#[test]
fn tests_that_need_a_program_have_it_in_their_name() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut needy = 0;
    for (path, text) in files_below(&[root.join("src"), root.join("crates"), root.join("tests")]) {
        let mut module = path.clone();
        for line in text.lines() {
            if let Some(name) = line.strip_prefix("mod ") {
                module = format!("{path} {name}");
            }
            if let Some(reason) = line.trim_start().strip_prefix("#[ignore = \"needs ") {
                needy += 1;
                let named = reason.contains("ffmpeg") && module.contains("with_ffmpeg")
                    || reason.contains("driver") && module.contains("with_driver");
                assert!(named, "{module}: needs {reason}");
            }
        }
    }
    assert!(needy > 10, "{needy}");
}
