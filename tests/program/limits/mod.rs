//! Input that asks for more than any machine has is refused at once, in a sentence that names it; what
//! it costs to refuse, and to plan, grows with its size.

mod messages;
mod planning;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use assert_cmd::Command;
use glam::DVec2;
use slump::config::{Config, SceneSource};
use slump::scene::{Scene, collision};
use slump::world::Grain;
use tempfile::TempDir;

/// Far more than what is refused takes, far less than what was not.
const AT_ONCE: Duration = Duration::from_secs(30);

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn write(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("a file");
    path
}

fn run(arguments: &[&str]) -> Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    command.timeout(AT_ONCE).args(arguments).output().expect("the program starts")
}

/// The sentence that the program refuses with.
#[track_caller]
fn refusal(arguments: &[&str]) -> String {
    let output = run(arguments);
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert_eq!(said.trim_end().lines().count(), 1, "more than a sentence: {said}");
    assert!(!said.contains("panicked"), "{said}");
    said
}

/// What is said of a pile that starts from these discs.
#[track_caller]
fn refusal_of_discs(lines: &str) -> String {
    let folder = folder();
    let csv = write(&folder, "discs.csv", &format!("x,y,radius\n{lines}"));
    let out = folder.path().join("out");
    let said = refusal(&[
        "--headless",
        "--renderer",
        "cpu",
        "--times",
        "0.01",
        "--initial",
        csv.to_str().expect("UTF-8"),
        "--frames",
        out.to_str().expect("UTF-8"),
    ]);
    assert!(!out.exists(), "refused, but {} is there", out.display());
    said
}

#[test]
fn a_disc_out_of_reach_of_the_base_is_named_rather_than_reached_by_the_base() {
    for height in ["1e5", "1e9", "1e17", "1e300"] {
        let said = refusal_of_discs(&format!("0,0.01,0.0025\n0,{height},0.0025\n"));
        assert!(said.contains("grains[1] is at y = 1"), "{said}");
        assert!(said.contains("within 5.020 m of the base"), "{said}");
    }
    let said = refusal_of_discs("0,0.01,0.0025\n1e17,0.02,0.0025\n");
    assert!(said.contains("grains[1].position is [1"), "{said}");
}

#[test]
fn a_disc_that_is_merely_dropped_from_high_up_is_taken() {
    let folder = folder();
    let csv = write(&folder, "discs.csv", "x,y,radius\n0,0.01,0.0025\n0,4.9,0.0025\n");
    let config = Config {
        source: SceneSource { initial: Some(csv), ..Default::default() },
        ..Config::default()
    };
    let scene = config.scene(|_| true).expect("a scene");
    assert!(scene.fixed_discs.len() > 9000 && scene.simulation().is_ok());
}

#[test]
fn many_discs_in_one_place_are_refused_with_two_of_them() {
    for count in [2, 2_000, 100_000] {
        let said = refusal_of_discs(&"0,0.01,0.0025\n".repeat(count));
        assert!(said.contains("grains[1].position is [0, 0.01] m, 0 m from that of grains[0]"));
        assert!(said.contains("at least 0.00125 m from it"), "{said}");
    }
    // Of very different sizes, where another search finds the pairs.
    let mut lines = "0.5,0.2,0.1\n".to_owned();
    for index in 0..50_000 {
        let _ = writeln!(lines, "0,0.01,{}", 1e-3 + 1e-9 * f64::from(index));
    }
    let said = refusal_of_discs(&lines);
    assert!(said.contains("0 m from that of grains["), "{said}");
}

#[test]
fn a_scene_whose_diameter_makes_neighbours_of_all_discs_is_refused() {
    let spoilt = Scene { mean_diameter: 1e9, ..collision() };
    let said = spoilt.simulation().map(|_| ()).expect_err("no diameter of these").to_string();
    assert!(said.starts_with("mean_diameter is 1000000000, but must be at most 30 m"), "{said}");
}

#[test]
fn a_problem_whose_matrix_would_not_fit_is_refused_with_the_disc_that_all_others_touch() {
    let folder = folder();
    let (count, radius) = (3_000u32, 1e-3);
    let mut lines = "x,y,radius\n0,2,1\n".to_owned();
    for k in 0..count {
        let (sine, cosine) = (f64::from(k) * std::f64::consts::TAU / f64::from(count)).sin_cos();
        let distance = 1.0 + 0.999_999 * radius;
        let _ = writeln!(lines, "{},{},{radius}", distance * sine, 2.0 + distance * cosine);
    }
    let discs = write(&folder, "discs.csv", &lines);
    let out = folder.path().join("problem.json");
    let discs = discs.to_str().expect("UTF-8");
    let dump = ["problem", "dump", "--initial", discs, "--at", "0", "--out"];
    let said = refusal(&[&dump[..], &[out.to_str().expect("UTF-8")]].concat());
    assert!(said.contains("the number of contacts of grains[0] is 3000, but must be so"), "{said}");
    assert!(!out.exists());
}

#[test]
fn a_tolerance_in_which_small_discs_lose_themselves_is_refused() {
    let mut grains = collision().grains;
    let least = 1e-4 * grains[0].radius;
    grains.push(Grain { position: grains[0].position + DVec2::X, radius: least, ..grains[0] });
    let spoilt = Scene { grains, gap_tolerance: least, ..collision() };
    let said = spoilt.simulation().map(|_| ()).expect_err("too wide").to_string();
    assert!(said.starts_with("gap_tolerance is ") && said.contains(" below "), "{said}");
    assert!(Scene { gap_tolerance: 0.5 * least, ..spoilt }.simulation().is_ok());
}

#[test]
fn a_problem_of_more_contacts_than_its_file_has_room_for_is_refused() {
    let folder = folder();
    for count in ["1000000000000000000", "18446744073709551615", "9223372036854775808"] {
        let json = format!(
            r#"{{"nc": {count}, "mu": 0.5, "q": [0.0], "W": {{"row": [0], "col": [0], "val": [1.0]}}}}"#
        );
        let path = write(&folder, "problem", &json);
        let said = refusal(&["problem", "solve", path.to_str().expect("UTF-8")]);
        assert!(said.contains("the length of q is 1"), "{said}");
    }
}

#[test]
fn steps_that_nobody_can_wait_for_are_refused_with_their_number() {
    let folder = folder();
    let out = folder.path().join("out");
    let out = out.to_str().expect("UTF-8");
    let headless = ["--headless", "--frames", out, "--scene", "cradle"];
    let said = refusal(&[&headless[..], &["--dt", "1e-300"]].concat());
    assert!(said.contains("dt is 1e-300 s where duration is"), "{said}");
    assert!(said.contains("e300 steps, but must be at least"), "{said}");
    let said = refusal(&[&headless[..], &["--duration", "1e300"]].concat());
    assert!(said.contains("duration is 1e300 s where dt is"), "{said}");
    let dump = ["problem", "dump", "--scene", "cradle", "--out", out, "--at"];
    let said = refusal(&[&dump[..], &["1e99"]].concat());
    assert!(said.contains("at is 1e99 s where dt is"), "{said}");
    assert!(!Path::new(out).exists());
}

#[test]
fn very_many_steps_are_told_of_before_they_begin() {
    let folder = folder();
    let out = folder.path().join("problem.json");
    let out = out.to_str().expect("UTF-8");
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("slump"));
    let dump = ["problem", "dump", "--scene", "collision", "--dt", "1e-3", "--at", "1e9"];
    let output = command.timeout(Duration::from_secs(2)).args(dump).args(["--out", out]).output();
    let output = output.expect("the program starts");
    assert_eq!(output.status.code(), None, "it was still running");
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(said.contains("this asks for 1000000000000 steps"), "{said}");
}
