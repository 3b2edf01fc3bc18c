//! Checks that the program accepts all commands in the documentation. Blocks that begin with ```sh contain quick
//! commands; they all run in order, in one folder for each page. Commands in blocks that begin with ```sh slow are only
//! parsed.

use std::time::Instant;

use slump::world::{GravityTurn, Material, MaterialPair, Motion, Periodic};

use super::{blocks, book, pages, root};
use crate::program::*;

/// Time limit for all quick commands together.
const MOST_TIME: Duration = Duration::from_secs(60);

/// Returns the arguments in a line that calls `slump`, or `None` if the line calls another program.
fn command_in(line: &str) -> Option<Vec<String>> {
    let words = shlex::split(line).unwrap_or_else(|| panic!("{line}"));
    let end = words.iter().position(|word| matches!(word.as_str(), "|" | ";" | ">" | "&&"));
    let mut words = words[..end.unwrap_or(words.len())].to_vec();
    let program = words.iter().position(|word| word == "slump").filter(|at| *at == 0);
    let by_cargo = words.starts_with(&["cargo".into(), "run".into()]);
    let by_cargo = by_cargo.then(|| words.iter().position(|word| word == "--")).flatten();
    let at = program.or(by_cargo)?;
    Some(words.split_off(at + 1))
}

/// Returns the commands in the lines of a code block. Lines that end in a backslash are joined with the next line.
fn lines_of(lines: &[&str]) -> Vec<String> {
    let text = lines.join("\n").replace("\\\n", " ");
    text.lines().map(str::to_owned).filter(|line| !line.trim().is_empty()).collect()
}

/// Parses the arguments. Returns the error message of the program, or `None` if the arguments are valid.
fn refusal(words: Vec<String>) -> Option<String> {
    let words = std::iter::once("slump".to_owned()).chain(words);
    let error = slump::cli::command().try_get_matches_from(words).err()?;
    error.use_stderr().then(|| error.to_string())
}

#[test]
fn commands_of_documents_are_taken() {
    let mut refused = Vec::new();
    let mut taken = 0;
    for page in pages() {
        let text = read(&page);
        let shell = blocks(&text).into_iter().filter(|(info, _)| info.starts_with("sh"));
        for line in shell.flat_map(|(_, lines)| lines_of(&lines)) {
            let Some(words) = command_in(&line) else { continue };
            taken += 1;
            if let Some(error) = refusal(words) {
                refused.push(format!("{}: {line}: {error}", page.display()));
            }
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
    assert!(taken > 50, "{taken} commands");
}

/// First words of the command that an example program writes into its report.
const EXAMPLE: &str = "cargo run --release --example ";
/// First words of the command that a test of the program writes into its report.
const TEST: &str = "cargo test --release --test program ";

#[test]
fn commands_of_reports_are_taken_and_name_no_folder_of_a_machine() {
    let mut reports = 0;
    for file in std::fs::read_dir(root().join("assets/reports")).expect("reports") {
        let path = file.expect("a report").path();
        let command = match path.extension().is_some_and(|extension| extension == "json") {
            true => json(&path)["command"].as_str().expect("a command").to_owned(),
            false => {
                let text = read(&path);
                let (_, rest) = text.split_once("; slump ").expect("a command after the date");
                let end = rest.find([';', '\n']).expect("an end");
                format!("slump {}", rest[..end].trim_end_matches('.'))
            }
        };
        if let Some(example) = command.strip_prefix(EXAMPLE) {
            let name = example.split(' ').next().unwrap_or_default();
            assert!(root().join(format!("examples/{name}.rs")).is_file(), "{command}");
            continue;
        }
        if command.starts_with(TEST) {
            assert_eq!(command, crate::calibration::TEST);
            continue;
        }
        let words = command_in(&command).unwrap_or_else(|| panic!("{}: {command}", path.display()));
        let is_of_a_machine = words.iter().any(|word| word.starts_with('/'));
        assert!(!is_of_a_machine, "{}: {command}", path.display());
        assert_eq!(refusal(words), None, "{}: {command}", path.display());
        reports += 1;
    }
    assert!(reports > 15, "{reports} reports");
}

/// Part of a scene file that a page shows.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct PartOfScene {
    #[serde(rename = "motions")]
    _motions: Option<Vec<Motion>>,
    #[serde(rename = "gravity_turn")]
    _gravity_turn: Option<GravityTurn>,
    #[serde(rename = "periodic")]
    _periodic: Option<Periodic>,
    #[serde(rename = "materials")]
    _materials: Option<Vec<Material>>,
    #[serde(rename = "pairs")]
    _pairs: Option<Vec<MaterialPair>>,
}

#[test]
fn files_of_the_book_are_studies_scenes_or_parts_of_them() {
    let folder = folder();
    let file = folder.path().join("file.toml");
    let mut seen = 0;
    for page in book() {
        let text = read(&page);
        for (_, lines) in blocks(&text).into_iter().filter(|(info, _)| *info == "toml") {
            let text = lines.join("\n");
            let is = |table: &str| lines.contains(&table);
            write(&file, &text);
            if is("[vary]") {
                succeed(slump("sweep count").arg(&file));
            } else if is("[physics]") {
                succeed(slump("scene --scene").arg(&file));
            } else if !is("[dependencies]") {
                let part = toml::from_str::<PartOfScene>(&text);
                assert!(part.is_ok(), "{}: {:?}: {text}", page.display(), part.err());
            }
            seen += 1;
        }
    }
    assert!(seen > 5, "{seen} files");
}

#[test]
fn quick_commands_of_documents_run() {
    let begun = Instant::now();
    let mut ran = 0;
    for page in book() {
        let text = read(&page);
        let folder = folder();
        std::os::unix::fs::symlink(root().join("assets"), folder.path().join("assets"))
            .expect("a link");
        let quick = blocks(&text).into_iter().filter(|(info, _)| *info == "sh");
        for line in quick.flat_map(|(_, lines)| lines_of(&lines)) {
            let Some(words) = command_in(&line) else {
                panic!(
                    "{}: {line}: no command of the program in a block that is run",
                    page.display()
                )
            };
            let output = run(slump("").args(&words).current_dir(folder.path()));
            assert!(output.status.success(), "{}: {line}: {}", page.display(), said(&output));
            ran += 1;
        }
    }
    assert!(ran > 10, "{ran} commands");
    assert!(begun.elapsed() < MOST_TIME, "{ran} quick commands took {:?}", begun.elapsed());
}
