//! Fuzzing of every parser of users' files: it gets nearly correct texts. A text that it accepts is also used, for
//! example by making its scene or by solving its contact problem.

use arbitrary::Unstructured;
use slump::config::{Config, SceneSource, scene_to_toml};
use slump::error::{Error, Result};
use slump::interchange::{ProblemFile, problem_file_at, solve_file};
use slump::scene::{GrainSource, NewPile, built_in};
use slump::solver::{METHODS, SolverSettings, StopTest};
use slump::study::Study;

use super::Target;
use crate::program::*;

/// Longest allowed error message, bytes: forty lines of 80 characters. A longer message is hard to read.
const LONGEST: usize = 3_200;

/// Longest allowed word in an error message, characters: nearly two lines of a terminal. A longer word is hard to read.
/// Paths may be longer.
const LONGEST_WORD: usize = 150;

/// Returns true if a line can be displayed on any terminal: no character moves the cursor or changes the direction of
/// writing, and words that are not paths are not too long.
pub fn is_legible(line: &str) -> bool {
    let moves = |c: char| c.is_control() || ('\u{2028}'..='\u{202e}').contains(&c);
    let goes_on = |word: &str| !word.contains('/') && word.chars().count() > LONGEST_WORD;
    !line.contains(moves) && !line.split(' ').any(goes_on)
}

/// Checks that an error message can be displayed on any terminal, is not too long, and says which values are allowed.
pub fn check(refusal: &Error) {
    let said = refusal.to_string();
    assert!(is_legible(&said), "illegible: {said:?}");
    assert!(said.len() <= LONGEST, "{} bytes: {said:?}", said.len());
    assert!(said.contains("must "), "{said:?} does not say what is allowed");
}

/// Tries the given texts, all texts that have ever failed, and slightly changed versions of the given texts.
fn fuzz_texts<T>(target: Target, texts: Vec<String>, parse: impl Fn(&str, &Path) -> Result<T>) {
    let kept = [texts.clone(), target.corpus()].concat();
    let check = |text: &str, path: &Path| parse(text, path).inspect_err(check).is_ok();
    target.fuzz(&kept, |u| changed(u, &texts), check);
}

fn file(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    read(path)
}

#[test]
fn scene_files() {
    let mut texts = vec![file("assets/scenes/hourglass.toml")];
    for name in ["cradle", "arch", "moving-walls", "squeeze", "thin-wall"] {
        texts.push(scene_to_toml(&built_in(name).expect("a scene")).expect("TOML"));
    }
    let mut rained = built_in("pile").expect("a scene");
    rained.grains.clear();
    rained.source = Some(GrainSource::NewPile(NewPile::default()));
    texts.push(scene_to_toml(&rained).expect("TOML"));
    let target = Target { name: "scene-files", ending: "toml", inputs: 300 };
    fuzz_texts(target, texts, |_, path| {
        // The deposition of many grains may take a long time, so it is omitted.
        let scene = Config::of_scene(text(path)).without_settling()?;
        scene.simulation()
    });
}

#[test]
fn tables_of_discs() {
    let shipped = file("crates/core/assets/pile_138.csv");
    let short: Vec<&str> = shipped.lines().take(12).collect();
    let mut texts = vec![short.join("\n"), "x,y,radius,vx,vy,omega\n0,0.01,2e-3,0,0,0\n".into()];
    for count in [2_000, 20_000] {
        texts.push(format!("x,y,radius\n{}", "0,0.01,0.0025\n".repeat(count)));
    }
    let target = Target { name: "discs", ending: "csv", inputs: 200 };
    fuzz_texts(target, texts, |_, path| {
        let source = SceneSource { initial: Some(path.to_owned()), ..SceneSource::default() };
        let scene = Config { source, ..Config::default() }.scene(|_| true)?;
        scene.simulation()
    });
}

#[test]
fn studies() {
    let names = ["pile", "cradle", "cradle-map", "pile-map", "default"];
    let texts = names.map(|name| file(&format!("assets/studies/{name}.toml"))).into();
    let target = Target { name: "studies", ending: "toml", inputs: 100 };
    fuzz_texts(target, texts, |text, path| Study::parse(text, path, true));
}

/// Reads a contact problem and solves it by a few sweeps. The length of the text selects the solver method, so that
/// random texts try all methods.
fn solve_briefly(text: &str, _: &Path) -> Result<()> {
    let problem = ProblemFile::parse(text)?;
    let settings = SolverSettings {
        method: METHODS[text.len() % METHODS.len()].method,
        stop: StopTest::Residual,
        tolerance: 1e-6,
        max_sweeps: 20,
        ..SolverSettings::SWEEPS
    };
    let solution = solve_file(&problem, &settings, 1)?;
    let enough = 2.001 * settings.tolerance;
    let said = format!("{} by {}", solution.residual, solution.method);
    assert!(!solution.converged || solution.residual <= enough, "solved to {said}");
    assert!(!(solution.converged && solution.stalled), "solved and stalled: {said}");
    Ok(())
}

#[test]
fn problem_files() {
    // One number per line, because changes are made line by line.
    let problem = |name: &str, at_secs: f64| {
        let scene = built_in(name).expect("a scene");
        let problem = problem_file_at(&scene, at_secs, |_| {}).expect("a problem");
        serde_json::to_string_pretty(&problem).expect("JSON")
    };
    let texts = vec![problem("arch", 0.01), problem("squeeze", 0.01), problem("cradle", 0.0)];
    let target = Target { name: "problem-files", ending: "json", inputs: 1000 };
    fuzz_texts(target, texts, solve_briefly);
}

#[test]
fn texts_of_siconos() {
    let head = "CSparse Version 3.1.9";
    let one = format!(
        "2\n1\n2\n2\n2\n2\n{head}\n2-by-2\n    col 0 : locations 0 to 0\n      0 : 2.5\n    \
         col 1 : locations 1 to 1\n      1 : 7\n-1 0.5\n0.3\n"
    );
    let two = format!(
        "2\n2\n2\n4\n4\n2\n{head}\n4-by-4\n    col 0 : locations 0 to 1\n      0 : 2\n      2 : -1\n    \
         col 1 : locations 2 to 2\n      1 : 6\n    col 2 : locations 3 to 4\n      0 : -1\n      \
         2 : 2\n    col 3 : locations 5 to 5\n      3 : 6\n-1 0\n-0.1 0.5\n0.5 0\n"
    );
    let target = Target { name: "siconos", ending: "dat", inputs: 400 };
    fuzz_texts(target, vec![one, two], solve_briefly);
}

/// Numbers that often cause errors in programs.
pub const NUMBERS: &str = "0 -0 1 -1 2 1e-300 -1e-300 1e300 1e308 1e309 nan inf -inf 1e17 1e9 4294967296 \
    18446744073709551616 -9223372036854775809 0.1 1e-17 1000000 NaN 0x10 1e18";
/// Words that occur in files of Slump, and words that do not.
pub const WORDS: &str = "true false null \"\" \"nsgs\" \"range\" \"moreau\" \"dem\" [] {} [[]] \"piston\" \
    \"segment\" \"half-space\" \u{1b}[31m \u{0} \u{202e} ö , =";

/// Returns a randomly chosen word of a line.
pub fn one_of<'a>(u: &mut Unstructured<'_>, line: &'a str) -> arbitrary::Result<&'a str> {
    Ok(*u.choose(&line.split(' ').collect::<Vec<_>>())?)
}

/// Returns one of the texts with one or, more rarely, several random changes.
pub fn changed(u: &mut Unstructured<'_>, texts: &[String]) -> arbitrary::Result<String> {
    let mut text = u.choose(texts)?.clone();
    for _ in 0..*u.choose(&[1, 1, 1, 1, 2, 3, 6])? {
        text = change(u, &text)?;
    }
    Ok(text)
}

fn change(u: &mut Unstructured<'_>, text: &str) -> arbitrary::Result<String> {
    let mut lines: Vec<&str> = text.lines().collect();
    if lines.is_empty() {
        return Ok(one_of(u, WORDS)?.to_owned());
    }
    let at = u.choose_index(lines.len())?;
    let line = lines[at].to_owned();
    let changed = match u.int_in_range(0..=15)? {
        0 => {
            lines.remove(at);
            return Ok(lines.join("\n"));
        }
        1 => {
            let again = lines[u.choose_index(lines.len())?];
            lines.insert(at, again);
            return Ok(lines.join("\n"));
        }
        2 => {
            let mut end = u.choose_index(text.len() + 1)?;
            while !text.is_char_boundary(end) {
                end -= 1;
            }
            return Ok(text[..end].to_owned());
        }
        3 => with_bit_flipped(u, line)?,
        4 | 5 => {
            let word = one_of(u, WORDS)?;
            with_token(u, &line, word)?
        }
        6 => {
            let digits = "7".repeat(u.int_in_range(1..=400)?);
            with_token(u, &line, &digits)?
        }
        7..=10 => {
            let number = one_of(u, NUMBERS)?;
            with_token(u, &line, number)?
        }
        // Inserts a word or number from another line.
        _ => {
            let other = lines[u.choose_index(lines.len())?];
            let tokens = tokens(other);
            if tokens.is_empty() {
                return Ok(text.to_owned());
            }
            let (from, to) = *u.choose(&tokens)?;
            with_token(u, &line, &other[from..to])?
        }
    };
    lines[at] = &changed;
    Ok(lines.join("\n"))
}

fn with_bit_flipped(u: &mut Unstructured<'_>, line: String) -> arbitrary::Result<String> {
    let mut bytes = line.into_bytes();
    if !bytes.is_empty() {
        let place = u.choose_index(bytes.len())?;
        bytes[place] ^= 1 << u.int_in_range(0..=6)?;
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Returns the positions at which each word or number in a line starts and ends.
fn tokens(line: &str) -> Vec<(usize, usize)> {
    let is_part = |c: char| c.is_alphanumeric() || "._-+\"".contains(c);
    let mut ends = Vec::new();
    let mut begin = None;
    for (place, c) in line.char_indices().chain([(line.len(), ' ')]) {
        match (begin, is_part(c)) {
            (None, true) => begin = Some(place),
            (Some(from), false) => {
                ends.push((from, place));
                begin = None;
            }
            _ => {}
        }
    }
    ends
}

/// Returns the line with one of its words or numbers, chosen at random, replaced by `token`.
fn with_token(u: &mut Unstructured<'_>, line: &str, token: &str) -> arbitrary::Result<String> {
    let tokens = tokens(line);
    if tokens.is_empty() {
        return Ok(format!("{line}{token}"));
    }
    let (from, to) = *u.choose(&tokens)?;
    Ok(format!("{}{token}{}", &line[..from], &line[to..]))
}
