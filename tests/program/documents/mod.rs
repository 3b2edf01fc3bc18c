//! Checks the documentation: links lead to existing targets, numbers equal those of their reports, the program accepts
//! all commands and runs the quick ones, generated parts are up to date, and pages are short.

mod commands;
mod links;
mod made;

use std::path::{Path, PathBuf};

use crate::program::read;

/// Largest number of words on one page, and on all pages together. The limits keep the documentation short enough to be
/// read. Words in generated parts do not count.
const MOST_WORDS: [usize; 2] = [2_000, 20_000];
/// Largest number of pages that are written by hand; the limit keeps the documentation easy to survey. Two further
/// pages are generated, and the summary is an index.
const MOST_PAGES: usize = 16;
const NOT_WRITTEN: [&str; 3] = ["SUMMARY.md", "commands.md", "columns.md"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the paths of all pages in the folder `docs`.
fn book() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join("docs")).expect("the book");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut pages: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|it| it == "md")).collect();
    pages.sort();
    pages
}

/// Returns the paths of all pages for readers: those in `docs` and others, such as the README.
fn pages() -> Vec<PathBuf> {
    let others = [
        "README.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "python/README.md",
        "tests/problems/README.md",
        "benches/factorisations/README.md",
        "benches/peers/README.md",
    ];
    others.iter().map(|name| root().join(name)).chain(book()).collect()
}

/// Returns the code blocks of a page. Each has the text after its opening three backticks, and its lines.
fn blocks(text: &str) -> Vec<(&str, Vec<&str>)> {
    let mut blocks = Vec::new();
    let mut open: Option<(&str, Vec<&str>)> = None;
    for line in text.lines() {
        match (line.strip_prefix("```"), open.take()) {
            (Some(info), None) => open = Some((info.trim(), Vec::new())),
            (Some(_), Some(block)) => blocks.push(block),
            (None, Some((info, mut lines))) => {
                lines.push(line);
                open = Some((info, lines));
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block without an end");
    blocks
}

#[test]
fn pages_are_short_and_in_the_summary() {
    let summary = read(root().join("docs/SUMMARY.md"));
    assert!(read(root().join("README.md")).lines().count() <= 100, "README.md");
    let (mut pages, mut all_words) = (0, 0);
    for page in book() {
        let name = page.file_name().expect("a name").to_string_lossy().into_owned();
        if name == "SUMMARY.md" {
            continue;
        }
        assert!(summary.contains(&format!("({name})")), "{name} is not in the summary");
        if NOT_WRITTEN.contains(&name.as_str()) {
            continue;
        }
        let text = links::without_comments(&made::without_tables_of_declarations(&read(&page)));
        let is_word = |it: &&str| it.contains(char::is_alphanumeric);
        let words = text.split_whitespace().filter(is_word).count();
        assert!(words <= MOST_WORDS[0], "{name} has {words} words");
        (pages, all_words) = (pages + 1, all_words + words);
    }
    assert!(pages <= MOST_PAGES, "{pages} written pages");
    assert!(all_words <= MOST_WORDS[1], "{all_words} written words");
    for (name, most) in [("ARCHITECTURE.md", 1_500), ("CONTRIBUTING.md", 2_000)] {
        let words = read(root().join(name)).split_whitespace().count();
        assert!(words <= most, "{name} has {words} words");
    }
}

#[test]
fn what_is_tried_of_a_commit_are_the_commands_of_the_readme() {
    let tried = read(root().join(".ci/run"));
    let text = read(root().join("README.md"));
    let shell = blocks(&text).into_iter().filter(|(info, _)| info.starts_with("sh"));
    let commands: Vec<&str> = shell
        .flat_map(|(_, lines)| lines)
        .map(|it| it.split(" #").next().unwrap_or(it).trim())
        .collect();
    for command in ["cargo run --release -- --headless --frames out/", "cargo test --release"] {
        assert!(commands.contains(&command), "the README has {commands:?}");
        let command = command.trim_end_matches(" out/");
        assert!(tried.lines().any(|line| line.contains(command)), "{command} is not tried");
    }
}
