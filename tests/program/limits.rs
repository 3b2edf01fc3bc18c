//! Tests that Slump refuses at once, in one sentence that names the cause, any input that needs more resources than any
//! machine has. Also tests that the time for refusing a file grows only in proportion to its size, and the time for
//! making the list of runs of a study only in proportion to the number of runs.

use std::fmt::Write as _;

use slump::config::{Config, SceneSource, read_scene, scene_to_toml};
use slump::study::Study;

use crate::common::*;
use crate::program::*;

/// Time limit for the error message, s: far more than the program needs to refuse an input, and far less than the
/// computation would take.
const AT_ONCE: &str = "30";

/// Runs the program and checks that it ends with an error message within [`AT_ONCE`] seconds. Returns the message.
#[track_caller]
fn refusal(arguments: &[&str]) -> String {
    let program = slump("").get_program().to_owned();
    sentence(Command::new("timeout").arg(AT_ONCE).arg(program).args(arguments))
}

/// Runs a pile whose initial discs are given as CSV rows and checks that Slump refuses it. Returns the error message.
#[track_caller]
fn refusal_of_discs(lines: &str) -> String {
    let folder = folder();
    let (csv, out) = (folder.path().join("discs.csv"), folder.path().join("out"));
    write(&csv, format!("x,y,radius\n{lines}"));
    let run = ["--headless", "--renderer", "cpu", "--times", "0.01", "--initial", text(&csv)];
    let said = refusal(&[&run[..], &["--frames", text(&out)]].concat());
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
    let csv = folder.path().join("discs.csv");
    write(&csv, "x,y,radius\n0,0.01,0.0025\n0,4.9,0.0025\n");
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
    // If the sizes are very different, Slump uses another algorithm to find pairs.
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
    let said = refused(&spoilt);
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
    let (discs, out) = (folder.path().join("discs.csv"), folder.path().join("problem.json"));
    write(&discs, &lines);
    let dump = ["problem", "dump", "--initial", text(&discs), "--at", "0", "--out"];
    let said = refusal(&[&dump[..], &[text(&out)]].concat());
    assert!(said.contains("the number of contacts of grains[0] is 3000, but must be so"), "{said}");
    assert!(!out.exists());
}

#[test]
fn a_tolerance_in_which_small_discs_lose_themselves_is_refused() {
    let mut grains = collision().grains;
    let least = 1e-4 * grains[0].radius;
    grains.push(Grain {
        position: grains[0].position + DVec2::X,
        radius: least,
        ..grains[0].clone()
    });
    let spoilt = Scene { grains, gap_tolerance: least, ..collision() };
    let said = refused(&spoilt);
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
        let siconos = format!("2\n{count}\n2\n0\n0\n2\n");
        for (text, expected) in [(json, "the length of q is 1"), (siconos, "number of contacts is")]
        {
            let path = folder.path().join("problem");
            write(&path, &text);
            let said = refusal(&["problem", "solve", path.to_str().expect("UTF-8")]);
            assert!(said.contains(expected), "{said}");
        }
    }
}

#[test]
fn steps_that_nobody_can_wait_for_are_refused_with_their_number() {
    let folder = folder();
    let out = folder.path().join("out");
    let out = text(&out);
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
    let mut command = assert_cmd::Command::from_std(slump(
        "problem dump --scene collision --dt 1e-3 --at 1e9 --out",
    ));
    let out = folder.path().join("problem.json");
    let output = command.timeout(Duration::from_secs(2)).arg(out).output();
    let output = output.expect("the program starts");
    assert_eq!(output.status.code(), None, "it was still running");
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(said.contains("this asks for 1000000000000 steps"), "{said}");
}

#[test]
fn every_message_of_the_command_line_says_what_is_allowed() {
    let long = "9".repeat(300);
    let cases: [&[&str]; 19] = [
        &["--bond", "much"],
        &["--bond"],
        &["--bond", "1", "--bond", "2"],
        &["--max-sweeps", "-1"],
        &["--max-sweeps", "99999999999"],
        &["--seed", "x"],
        &["--grains", "1.5"],
        &["--warm-start", "maybe"],
        &["--solver", "magic"],
        &["--colour", "pink"],
        &["--nonsense"],
        &["--headles"],
        &["nonsense"],
        &["problem"],
        &["problem", "dump"],
        &["problem", "solve", "x", "--repeat", "x"],
        &["--initial", "a.csv", "--seed", "3"],
        &["--headless=3"],
        &["sweep", "a.toml", "b.toml"],
    ];
    for case in cases {
        let said = refusal(case);
        assert!(said.contains("but must be "), "{case:?}: {said}");
        assert!(said.len() < 3000, "{case:?}: {said}");
    }
    assert!(refusal(&["--bond", "much"]).contains("--bond is much, but must be a number (Bond"));
    let said = refusal(&["--headless", "--frames", "no-folder", "--bond", &format!("-{long}")]);
    assert!(said.contains("bond is -1e300, but must be a fin"), "{said}");
    assert!(refusal(&["nonsense"]).contains("problem (dump, solve)"));
    assert!(refusal(&["--seed", "\u{1b}[31mred\u{7}"]).contains("\\u{1b}[31mred\\u{7}"));
}

/// Runs the program with a file of this name and content as the last argument. Checks that the error message is short
/// and says which values are allowed.
fn check(arguments: &[&str], name: &str, text: impl AsRef<[u8]>) {
    let folder = folder();
    let path = folder.path().join(name);
    write(&path, &text);
    let said = refusal(&[arguments, &[path.to_str().expect("UTF-8")]].concat());
    let text = String::from_utf8_lossy(text.as_ref());
    assert!(said.contains(" must "), "{text}: {said}");
    assert!(said.len() < 3000, "{text}: {said}");
}

const OF_SCENE: [&str; 4] = ["--headless", "--frames", "no-folder", "--scene"];
const OF_DISCS: [&str; 4] = ["--headless", "--frames", "no-folder", "--initial"];
const OF_STUDY: [&str; 2] = ["sweep", "count"];
const OF_PROBLEM: [&str; 2] = ["problem", "solve"];

#[test]
fn every_message_of_a_scene_file_says_what_is_allowed() {
    let good = scene_to_toml(&collision()).expect("TOML");
    for text in [
        "name",
        "name = \"a\nb\"",
        "name = 3",
        "= 3",
        "[[[",
        "a = 1\na = 2",
        "a = 99999999999999999999",
    ] {
        check(&OF_SCENE, "a.toml", text);
    }
    for (from, to) in [
        ("duration_secs", "#"),
        ("axes = 1", "axes = -1"),
        ("axes = 1", "axes = 1.5"),
        ("friction = false", "friction = 0"),
        ("bond = ", "bondage = "),
        ("bond = ", "\"a\\u0007\\u001b[2J\" = "),
        ("stepper = \"moreau\"", "stepper = \"running\""),
    ] {
        assert!(good.contains(from), "no {from} in {good}");
        check(&OF_SCENE, "a.toml", good.replacen(from, to, 1));
    }
}

#[test]
fn every_message_of_other_files_says_what_is_allowed() {
    for text in
        ["x,y,radius\n0,zero,1\n", "x,y,radius\n0,0\n", "x,y,radius,z\n0,0,1,1\n", "", "x,y"]
    {
        check(&OF_DISCS, "a.csv", text);
    }
    for text in [
        "",
        "name = 3",
        "name = \"a\"\n[vary]\nbond = 3",
        "name = \"a\"\n[vary]\nbund = [3]",
        "name = \"a\"\n[vary]\nbond = [\"x\"]",
        "name = \"a\"\n[base]\nmax-sweeps = -1",
        "colour = 1",
    ] {
        check(&OF_STUDY, "a.toml", text);
    }
    for text in ["{", "{}", "{\"nc\": -1}", "{\"nc\": 1, \"mu\": [[]]}", "[", "2\n1\n"] {
        check(&OF_PROBLEM, "a.json", text);
    }
    let commands: [(&[&str], &str); 4] = [
        (&OF_SCENE, "no/such.toml"),
        (&OF_DISCS, "no/such.csv"),
        (&OF_STUDY, "no/such.toml"),
        (&OF_PROBLEM, "no/such.json"),
    ];
    for (arguments, missing) in commands {
        check(arguments, "a.toml", [0xff, 0xfe, 0x00]);
        let said = refusal(&[arguments, &[missing]].concat());
        assert!(said.contains("No such file") && said.contains(" must be "), "{said}");
    }
}

#[test]
fn planning_takes_time_in_proportion_to_the_number_of_values() {
    let time = |count: usize| {
        let range = format!("bond = {{ from = 1, to = {count} }}");
        let text = format!("name = \"many\"\n[base]\nscene = \"cradle\"\n[vary]\n{range}\n");
        let start = Instant::now();
        let study = Study::parse(&text, "many.toml".as_ref(), false).expect("a study");
        assert_eq!(study.runs.len(), count);
        start.elapsed().as_secs_f64() / count as f64
    };
    let (few, many) = (time(5_000), time(100_000));
    assert!(many < 3.0 * few, "{few:e} s a value of few, {many:e} s of many");
}

#[test]
fn more_runs_than_anyone_can_wait_for_are_refused_before_they_take_room() {
    let range = "{ from = 1, to = 2, count = 2000 }";
    let text = format!(
        "name = \"many\"\n[base]\nscene = \"cradle\"\n[vary]\nbond = {range}\nduration = {range}\n\
         start = {range}\nmu = {range}\n"
    );
    // The number of runs is too large after two axes, so the other axes are not evaluated.
    let said = Study::parse(&text, "many.toml".as_ref(), false).map(|_| ());
    let said = said.expect_err("too many").to_string();
    assert!(said.contains("vary is 4000000 runs with vary.duration, but must be"), "{said}");
}

/// Returns the text of a scene file whose pile is described by `rain`: all grains fall together onto the base
/// (deposition `rain`).
fn rained(rain: &NewPile, duration_secs: f64) -> String {
    let mut scene = built_in("pile").expect("a scene");
    scene.grains.clear();
    scene.duration_secs = duration_secs;
    scene.source = Some(GrainSource::NewPile(rain.clone()));
    scene_to_toml(&scene).expect("TOML")
}

#[test]
fn a_rained_scene_file_is_settled_once_and_no_run_of_a_plan_settles_it() {
    let folder = folder();
    let rain = NewPile { grains: 30, box_width_in_diameters: 8.0, seed: 3, ..NewPile::default() };
    let path = folder.path().join("rained.toml");
    write(&path, rained(&rain, 1.0));

    let start = Instant::now();
    let settled = settle(&rain, |_| true).expect("a pile");
    let once = start.elapsed();
    let config = Config::of_scene(text(&path));
    let mut told = 0;
    let made = config.scene(|_| {
        told += 1;
        true
    });
    let made = made.expect("a scene");
    assert!(told > 10, "settling is told of: {told} times");
    assert!(made.grains.iter().zip(&settled).all(|(a, b)| a.position == b.position));
    assert_eq!(made, read_scene(&path).expect("the same scene"));
    assert!(config.scene(|_| false).is_err_and(|error| error.to_string().contains("interrupted")));

    let study = format!(
        "name = \"rained\"\n[base]\nscene = {path:?}\n[vary]\nbond = {{ from = 1, to = 1000 }}\n"
    );
    let start = Instant::now();
    let study = Study::parse(&study, "rained.toml".as_ref(), false).expect("a study");
    assert_eq!(study.runs.len(), 1000);
    assert!(
        start.elapsed() < 20 * once,
        "{:?} for 1000 runs, a settling is {once:?}",
        start.elapsed()
    );
}

#[test]
fn a_sweep_of_a_rained_scene_file_keeps_its_state() {
    let folder = folder();
    let rain = NewPile { grains: 12, box_width_in_diameters: 6.0, seed: 3, ..NewPile::default() };
    let at = |name: &str| folder.path().join(name);
    write(at("rained.toml"), rained(&rain, 0.002));
    let scene = at("rained.toml");
    let study = format!("name = \"r\"\n[base]\nscene = {scene:?}\n[vary]\nbond = [1, 2, 3]\n");
    write(at("study.toml"), study);
    let out = at("out");
    succeed(slump("sweep").arg(at("study.toml")).arg("--out").arg(&out));
    let states = std::fs::read_dir(out.join("states")).expect("states").count();
    assert_eq!(states, 1, "settled once for three runs");
}
