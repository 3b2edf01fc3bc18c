//! Every parser of a file that a user hands over, and what its file is first used for.

use std::path::Path;

use slump::config::{Config, SceneSource, scene_to_toml};
use slump::error::{Error, Result};
use slump::interchange::{ProblemFile, problem_file_at, solve_file};
use slump::scene::{GrainSource, NewPile, built_in};
use slump::solver::{METHODS, SolverSettings, StopTest};
use slump::study::Study;

use super::Target;
use super::texts::changed;

/// The longest refusal that still is a sentence, bytes.
const LONGEST: usize = 3_200;

/// The longest word that still is one, characters.
const LONGEST_WORD: usize = 150;

/// Whether a line can be shown on any terminal: nothing moves the cursor, turns the direction of writing or
/// goes on and on. Words without a path, that is.
pub fn is_legible(line: &str) -> bool {
    let moves = |c: char| c.is_control() || ('\u{2028}'..='\u{202e}').contains(&c);
    let goes_on = |word: &str| !word.contains('/') && word.chars().count() > LONGEST_WORD;
    !line.contains(moves) && !line.split(' ').any(goes_on)
}

/// A refusal is one sentence that can be shown on any terminal and says what is allowed.
pub fn check(refusal: &Error) {
    let said = refusal.to_string();
    assert!(is_legible(&said), "illegible: {said:?}");
    assert!(said.len() <= LONGEST, "{} bytes: {said:?}", said.len());
    assert!(said.contains("must "), "{said:?} does not say what is allowed");
}

/// Tries the texts given and those that ever failed, and others that are nearly those.
fn fuzz_texts<T>(
    name: &'static str,
    ending: &'static str,
    mut texts: Vec<String>,
    parse: impl Fn(&str, &Path) -> Result<T>,
) {
    let target = Target { name, ending };
    texts.extend(target.corpus());
    let check = |text: &str, path: &Path| parse(text, path).inspect_err(check).is_ok();
    target.fuzz(&texts, changed, check);
}

fn file(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(path).expect("a file of ours")
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
    fuzz_texts("scene-files", "toml", texts, |_, path| {
        // Where grains are rained, many of them may well take their time.
        let scene = Config::of_scene(path.to_str().expect("UTF-8")).without_settling()?;
        scene.simulation()
    });
}

#[test]
fn tables_of_discs() {
    let shipped = file("assets/pile_138.csv");
    let short: Vec<&str> = shipped.lines().take(12).collect();
    let mut texts = vec![short.join("\n"), "x,y,radius,vx,vy,omega\n0,0.01,2e-3,0,0,0\n".into()];
    for count in [2_000, 20_000] {
        texts.push(format!("x,y,radius\n{}", "0,0.01,0.0025\n".repeat(count)));
    }
    fuzz_texts("discs", "csv", texts, |_, path| {
        let source = SceneSource { initial: Some(path.to_owned()), ..SceneSource::default() };
        let scene = Config { source, ..Config::default() }.scene(|_| true)?;
        scene.simulation()
    });
}

#[test]
fn studies() {
    let names = ["pile", "cradle", "cradle-map", "pile-map", "range"];
    let texts = names.map(|name| file(&format!("assets/studies/{name}.toml"))).into();
    fuzz_texts("studies", "toml", texts, |text, path| Study::parse(text, path, true));
}

/// Reads a problem and solves it for a while, by a method that hangs on the text alone.
fn solve_briefly(text: &str, _: &Path) -> Result<()> {
    let problem = ProblemFile::parse(text)?;
    let settings = SolverSettings {
        method: METHODS[text.len() % METHODS.len()].method,
        stop: StopTest::Residual,
        tolerance: 1e-6,
        max_sweeps: 20,
        ..SolverSettings::default()
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
    // A line a number, so that there are lines to change.
    let problem = |name: &str, at_secs: f64| {
        let scene = built_in(name).expect("a scene");
        let problem = problem_file_at(&scene, at_secs, |_| {}).expect("a problem");
        serde_json::to_string_pretty(&problem).expect("JSON")
    };
    let texts = vec![problem("arch", 0.01), problem("squeeze", 0.01), problem("cradle", 0.0)];
    fuzz_texts("problem-files", "json", texts, solve_briefly);
}
