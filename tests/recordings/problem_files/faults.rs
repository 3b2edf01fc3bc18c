//! Tests of the command `slump problem`, and of its error messages about faulty files.

use serde_json::json;
use slump::interchange::{Friction, ProblemFile, Solution};

use super::{SICONOS, problems};
use crate::program::*;

/// Returns a correct problem of two contacts as JSON. The tests change it into faulty problems.
fn sound() -> Value {
    json!({
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

fn spoilt(mut problem: Value, change: fn(&mut Value)) -> String {
    change(&mut problem);
    problem.to_string()
}

/// Checks that each text is refused with an error message of one sentence that contains the expected words.
fn assert_refused(cases: &[(String, &str)]) {
    let folder = folder();
    let path = folder.path().join("problem.json");
    for (text, expected) in cases {
        write(&path, text);
        let said = sentence(slump("problem solve").arg(&path));
        assert!(said.contains(expected), "\"{expected}\" is not in: {said}");
        assert!(said.contains("problem.json"), "{said}");
    }
}

#[test]
fn a_faulty_problem_is_refused_in_one_sentence() {
    let folder = folder();
    write(folder.path().join("sound.json"), sound().to_string());
    succeed(slump("problem solve").arg(folder.path().join("sound.json")));
    let json = |change| spoilt(sound(), change);
    assert_refused(&[
        (json(|p| p["nc"] = 0.into()), "nc is 0"),
        (json(|p| p["nc"] = 3.into()), "the length of q is 4, but must be 6"),
        (json(|p| p["q"] = json!([1.0])), "the length of q is 1"),
        (json(|p| p["q"][1] = Value::Null), "null"),
        (sound().to_string().replace("0.1", "NaN"), "line 1"),
        (sound().to_string().replace("0.1", "1e999"), "out of range"),
        (json(|p| p["mu"] = (-0.5).into()), "mu[0] is -0.5, but must be a finite number ≥ 0"),
        (json(|p| p["mu"] = json!([0.5])), "the length of mu is 1"),
        (json(|p| p["mu"] = "much".into()), "mu must be a number or a list of numbers"),
        (json(|p| p["c0"] = json!([0.1, -0.1])), "c0[1] is -0.1"),
        (json(|p| p["c0"] = json!([0.1])), "the length of c0 is 1"),
        (json(|p| p["cone"] = "round".into()), "unknown variant `round`"),
        (json(|p| p["start"] = json!([1.0])), "the length of start is 1"),
        (json(|p| p["colour"] = "red".into()), "unknown field `colour`"),
        (json(|p| p["W"]["row"][0] = 4.into()), "W.row[0] is 4, but must be below 4"),
        (json(|p| p["W"]["col"][5] = 9.into()), "W.col[5] is 9"),
        (json(|p| p["W"]["row"][0] = (-1).into()), "-1"),
        (json(|p| p["W"]["val"][4] = 0.5.into()), "W is symmetric"),
        (json(|p| p["W"]["val"][0] = 0.0.into()), "W[0, 0] is 0, but must be > 0"),
        (json(|p| p["W"]["val"] = json!([])), "W is empty"),
        (json(|p| p["W"]["row"] = json!([0])), "the length of W.row is 1"),
        (
            json(|p| {
                p["W"]["col"] = json!([0, 1, 2, 3, 1, 0]);
                p["W"]["row"] = json!([0, 1, 2, 3, 0, 1]);
                p["W"]["val"][4] = 4.into();
                p["W"]["val"][5] = 4.into();
            }),
            "the determinant of contact 0's block of W is -4",
        ),
        (json(|p| drop(p.as_object_mut().map(|p| p.remove("q")))), "missing field `q`"),
        (sound().to_string()[..60].to_owned(), "EOF"),
        (String::new(), "the dimension is missing"),
        ("[1, 2]".into(), "the dimension is \"[1, 2]\""),
    ]);
}

#[test]
fn a_faulty_file_of_siconos_is_refused_in_one_sentence() {
    let siconos = read(problems().join(SICONOS));
    let siconos_with = |from: &str, to: &str| siconos.replacen(from, to, 1);
    assert_refused(&[
        (siconos_with("2\n667", "3\n667"), "the dimension is 3, but must be 2"),
        (siconos_with("667\n2\n", "667\n0\n"), "the kind of storage is 0"),
        (siconos_with("\n1334\n", "\n1333\n"), "the number of rows is 1333"),
        (siconos_with("0 : 856.713", "0 : nan"), "W.val[0] is NaN"),
        (siconos_with("0 : 856.713", "2000 : 856.713"), "W.row[0] is 2000"),
        (siconos_with("649 : -454.43", "648 : -454.43"), "W is symmetric"),
        (siconos[..20_000].to_owned(), "of W"),
        (siconos[..siconos.len() - 100].to_owned(), "mu["),
    ]);
}

#[test]
fn bodies_that_are_not_those_of_the_problem_are_refused_in_one_sentence() {
    let whole = json(problems().join("bond_0_smooth.json"));
    let bodies = |change| spoilt(whole.clone(), change);
    assert_refused(&[
        (bodies(|p| p["bodies"]["mass"][0] = 1.0.into()), "bodies.inertia[0]"),
        (bodies(|p| p["bodies"]["pair"][0][0] = 900.into()), "bodies.pair[0]"),
        (bodies(|p| p["bodies"]["normal"][0] = json!([0.6, 0.8])), "the bodies make it"),
        (bodies(|p| p["bodies"]["radius"] = json!([])), "bodies.radius"),
        (bodies(|p| p["q"][2] = 1.0.into()), "the bodies'"),
        (bodies(|p| p["c0"] = json!(vec![1.0; 77])), "the bodies'"),
        (bodies(|p| p["bodies"]["axes"] = 3.into()), "bodies.axes is 3"),
    ]);
}

#[test]
fn the_command_writes_a_problem_and_a_solution() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (problem, solution) = (at("problem.json"), at("solution.json"));
    let dump = "problem dump --bond 20 --restitution-threshold 2 --at 0.01 --out";
    succeed(slump(dump).arg(&problem));
    let file = ProblemFile::read(&problem).expect("a problem");
    assert!(file.nc > 100 && file.start.is_some() && file.c0.is_some());
    assert_eq!(file.mu, Friction::Same(0.5));

    let solve = "problem solve --method newton --tolerance 1e-8 --out";
    let output = run(slump(solve).arg(&solution).arg(&problem));
    let said = String::from_utf8(output.stdout).expect("UTF-8");
    for word in ["contacts", "newton", "sweeps", "seconds", "residual", "converged"] {
        assert!(said.contains(word), "{said}");
    }
    let text = read(&solution);
    let solution: Solution = serde_json::from_str(&text).expect("a proper solution");
    assert!(solution.converged && solution.residual <= 1e-8);
    // The reported residual must be the residual of the written impulses, not the value that the method used in its
    // stop test.
    let mut judge = file.delassus().expect("a proper problem");
    judge.set_impulses(solution.r.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
    assert_eq!(judge.residual(), solution.residual);
    let velocities: Vec<f64> = judge.velocities().flatten().collect();
    assert_eq!(velocities, solution.u);

    for (at, expected) in [("-1", "at is -1"), ("nan", "at is NaN"), ("1e-9", "scene is none")] {
        let scene = if at == "1e-9" { "none" } else { "pile" };
        let options = ["--scene", scene, "--at", at, "--out"];
        let said = failure(slump("problem dump --overwrite").args(options).arg(&problem));
        assert!(said.contains(expected), "{said}");
    }
}
