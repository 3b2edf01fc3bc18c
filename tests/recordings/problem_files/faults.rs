//! The command, and what it says of faulty files.

use std::path::Path;

use assert_cmd::Command;
use slump::interchange::{Friction, ProblemFile, Solution};

use super::folder;

/// A sound problem of two contacts, to be spoilt.
fn sound() -> serde_json::Value {
    serde_json::json!({
        "nc": 2,
        "W": {
            "row": [0, 1, 2, 3, 0, 2],
            "col": [0, 1, 2, 3, 2, 0],
            "val": [2.0, 6.0, 2.0, 6.0, -0.5, -0.5],
        },
        "q": [-1.0, 0.1, -0.5, 0.0],
        "mu": 0.5,
    })
}

fn slump(arguments: &[&str]) -> std::process::Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    command.args(arguments).output().expect("the program starts")
}

/// Has the program solve a file of this text, and gives its exit code and what it said.
fn solved(text: &str) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("problem.json");
    std::fs::write(&path, text).expect("a file");
    let output = slump(&["problem", "solve", path.to_str().expect("UTF-8")]);
    (output.status.code(), String::from_utf8(output.stderr).expect("UTF-8"))
}

/// A problem, spoilt.
fn spoilt(mut problem: serde_json::Value, change: fn(&mut serde_json::Value)) -> String {
    change(&mut problem);
    problem.to_string()
}

/// Fails unless each of the texts is refused in one sentence that holds what is expected.
fn assert_refused(cases: &[(String, &str)]) {
    for (text, expected) in cases {
        let (code, said) = solved(text);
        assert_eq!(code, Some(2), "{expected}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "more than a sentence: {said}");
        assert!(said.contains(expected), "\"{expected}\" is not in: {said}");
        assert!(said.contains("problem.json"), "{said}");
    }
}

#[test]
fn a_faulty_problem_is_refused_in_one_sentence() {
    assert_eq!(solved(&sound().to_string()).0, Some(0), "the sound problem is solved");
    let json = |change| spoilt(sound(), change);
    assert_refused(&[
        (json(|p| p["nc"] = 0.into()), "nc is 0"),
        (json(|p| p["nc"] = 3.into()), "the length of q is 4, but must be 6"),
        (json(|p| p["q"] = serde_json::json!([1.0])), "the length of q is 1"),
        (json(|p| p["q"][1] = serde_json::Value::Null), "null"),
        (sound().to_string().replace("0.1", "NaN"), "line 1"),
        (sound().to_string().replace("0.1", "1e999"), "out of range"),
        (json(|p| p["mu"] = (-0.5).into()), "mu[0] is -0.5, but must be a finite number ≥ 0"),
        (json(|p| p["mu"] = serde_json::json!([0.5])), "the length of mu is 1"),
        (json(|p| p["mu"] = "much".into()), "mu must be a number or a list of numbers"),
        (json(|p| p["c0"] = serde_json::json!([0.1, -0.1])), "c0[1] is -0.1"),
        (json(|p| p["c0"] = serde_json::json!([0.1])), "the length of c0 is 1"),
        (json(|p| p["cone"] = "round".into()), "unknown variant `round`"),
        (json(|p| p["start"] = serde_json::json!([1.0])), "the length of start is 1"),
        (json(|p| p["colour"] = "red".into()), "unknown field `colour`"),
        (json(|p| p["W"]["row"][0] = 4.into()), "W.row[0] is 4, but must be below 4"),
        (json(|p| p["W"]["col"][5] = 9.into()), "W.col[5] is 9"),
        (json(|p| p["W"]["row"][0] = (-1).into()), "-1"),
        (json(|p| p["W"]["val"][4] = 0.5.into()), "W is symmetric"),
        (json(|p| p["W"]["val"][0] = 0.0.into()), "W[0, 0] is 0, but must be > 0"),
        (json(|p| p["W"]["val"] = serde_json::json!([])), "W is empty"),
        (json(|p| p["W"]["row"] = serde_json::json!([0])), "the length of W.row is 1"),
        (
            json(|p| {
                p["W"]["col"] = serde_json::json!([0, 1, 2, 3, 1, 0]);
                p["W"]["row"] = serde_json::json!([0, 1, 2, 3, 0, 1]);
                p["W"]["val"][4] = 4.into();
                p["W"]["val"][5] = 4.into();
            }),
            "the determinant of contact 0's block of W is -4",
        ),
        (json(|p| drop(p.as_object_mut().map(|p| p.remove("q")))), "missing field `q`"),
        (sound().to_string()[..60].to_owned(), "EOF"),
        (String::new(), "EOF"),
        ("[1, 2]".into(), "the problem is not readable"),
    ]);
}

#[test]
fn bodies_that_no_problem_has_are_refused_in_one_sentence() {
    let whole = std::fs::read_to_string(folder().join("bond_0_smooth.json")).expect("a problem");
    let whole: serde_json::Value = serde_json::from_str(&whole).expect("JSON");
    let bodies = |change| spoilt(whole.clone(), change);
    assert_refused(&[
        (bodies(|p| p["bodies"]["mass"][0] = 1.0.into()), "bodies.inertia[0]"),
        (bodies(|p| p["bodies"]["pair"][0][0] = 900.into()), "bodies.pair[0]"),
        (bodies(|p| p["bodies"]["radius"] = serde_json::json!([])), "bodies.radius"),
        (bodies(|p| p["bodies"]["axes"] = 3.into()), "bodies.axes is 3"),
    ]);
}

#[test]
fn the_command_writes_a_problem_and_a_solution() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let (problem, solution) = (file("problem.json"), file("solution.json"));
    let dump = ["problem", "dump", "--bond", "20", "--restitution-threshold", "2", "--at", "0.01"];
    let output = slump(&[&dump[..], &["--out", &problem]].concat());
    assert!(output.status.success(), "{output:?}");
    let read = ProblemFile::read(Path::new(&problem)).expect("a problem");
    assert!(read.nc > 100 && read.start.is_some() && read.c0.is_some());
    assert_eq!(read.mu, Friction::Same(0.5));

    let solve = ["problem", "solve", &problem, "--method", "newton", "--tolerance", "1e-8"];
    let output = slump(&[&solve[..], &["--out", &solution]].concat());
    let said = String::from_utf8(output.stdout).expect("UTF-8");
    for word in ["contacts", "newton", "sweeps", "seconds", "residual", "converged"] {
        assert!(said.contains(word), "{said}");
    }
    let text = std::fs::read_to_string(&solution).expect("a solution");
    let solution: Solution = serde_json::from_str(&text).expect("a proper solution");
    assert!(solution.converged && solution.residual <= 1e-8);

    // The residual is that of the written impulses, whatever the method made of them.
    let mut judge = read.delassus().expect("a proper problem");
    judge.set_impulses(solution.r.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
    assert_eq!(judge.residual(), solution.residual);
    let velocities: Vec<f64> = judge.velocities().flatten().collect();
    assert_eq!(velocities, solution.u);

    for (at, expected) in [("-1", "at is -1"), ("nan", "at is NaN"), ("1e-9", "scene is none")] {
        let scene = if at == "1e-9" { "none" } else { "pile" };
        let output = slump(&["problem", "dump", "--scene", scene, "--at", at, "--out", &problem]);
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(expected), "{said}");
    }
}
