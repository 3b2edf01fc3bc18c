//! Tests of the program `slump` as a user starts it: its output, and its error messages about bad input.

use crate::program::*;

/// Runs the program and checks that it refuses these arguments. Returns the error message.
fn refusal(arguments: &[&str]) -> String {
    sentence(slump("").args(arguments))
}

#[test]
fn a_value_outside_its_range_is_named_with_its_range_and_nothing_is_written() {
    let cases: [(&[&str], &str, &str); 27] = [
        (&["--bond", "-1"], "bond is -1", "≥ 0"),
        (&["--dt", "0"], "dt is 0", "> 0"),
        (&["--dt", "nan"], "dt is NaN", "> 0"),
        (&["--dt", "-0.001"], "dt is -0.001", "> 0"),
        (&["--rho", "1.5"], "rho is 1.5", "between 0 and 1"),
        (&["--rho", "nan"], "rho is NaN", "between 0 and 1"),
        (&["--mu", "-0.1"], "mu is -0.1", "≥ 0"),
        (&["--duration", "0"], "duration is 0", "> 0"),
        (&["--tolerance", "0"], "tolerance is 0", "> 0"),
        (&["--max-sweeps", "0"], "max-sweeps is 0", "at least 1"),
        (&["--scene", "heap"], "scene is heap", "pile, cradle, collision"),
        (&["--max-travel", "-1"], "max-travel is -1", "0 never cuts a step"),
        (&["--stepper", "range", "--push-out", "true"], "push-out is given", "it goes with moreau"),
        (
            &["--stepper", "range", "--sequential-impacts", "true"],
            "sequential-imp",
            "stepper is range",
        ),
        (&["--scene", "none.toml"], "none.toml", "No such file"),
        (&["--initial", "none.csv"], "none.csv", "No such file"),
        (&["--solver", "magic"], "magic", "nsgs"),
        (&["--size", "0x0"], "size is 0x0", "at least 1"),
        (&["--size", "ten"], "size is ten", "WIDTHxHEIGHT"),
        (&["--size", "999999x10"], "size is 999999x10", "between 1x1"),
        (&["--times", "5"], "times is 5", "between 0 and the duration"),
        (&["--fps", "0"], "fps is 0", "> 0"),
        (&["--grains", "0"], "grains is 0", "between 1 and"),
        (&["--box-width", "nan"], "box-width is NaN", "between 1.3"),
        (&["--scene", "cradle", "--seed", "3"], "scene is cradle", "pile"),
        (&["--bond", "much"], "much", "--bond"),
        (&["--renderer", "brush"], "brush", "vulkan, gl, cpu"),
    ];
    let folder = folder();
    let out = folder.path().join("out");
    for (arguments, field, allowed) in cases {
        let said = sentence(slump("--headless --frames").arg(&out).args(arguments));
        assert!(said.contains(field) && said.contains(allowed), "{arguments:?}: {said}");
        assert!(!out.exists(), "{arguments:?} was refused, but {} is there", out.display());
    }
}

#[test]
fn a_negative_number_is_a_value_of_every_option() {
    let folder = folder();
    let headless = "--headless --scene cradle --times 0 --size 64x36 --renderer cpu --frames out";
    for (line, field, value) in [
        ("run pile --frames out --grains", "grains", "-5"),
        ("run pile --frames out --seed", "seed", "-1"),
        ("run pile --frames out --initial-step", "initial-step", "-1"),
        ("run pile --frames out --max-sweeps", "max-sweeps", "-1"),
        ("generate --out a.csv --grains", "grains", "-5"),
        ("problem solve a.json --repeat", "repeat", "-1"),
        ("run pile --frames out --times", "times", "-1,0"),
    ] {
        let said = sentence(slump(line).arg(value).current_dir(folder.path()));
        let named = [format!("{field} is {value}"), format!("{field} is -1, but must be between")];
        assert!(named.iter().any(|it| said.contains(it)), "{line} {value}: {said}");
    }
    let ends = ["--colour", "speed", "--colour-scale", "-1,1"];
    succeed(slump(headless).args(ends).current_dir(folder.path()));
}

#[test]
fn only_settings_that_change_nothing_are_told_of_as_such() {
    let folder = folder();
    let run = "run cradle --times 0 --duration 0.01 --size 8x8 --renderer cpu --frames out --overwrite --stepper";
    for (options, unread) in [
        ("moreau --push-out --max-travel 0.5 --sequential-impacts", None),
        ("range --max-travel 0.5 --debonding-distance 0.02", None),
        ("dem --stiffness 1e6 --max-sweeps 5", Some("the stepper dem does not read max-sweeps")),
        ("moreau --touch-tolerance 1e-3", None),
        ("range --touch-tolerance 1e-3", Some("the stepper range does not read touch-tolerance")),
        ("moreau --push-out --stiffness 1e6", Some("the stepper moreau does not read stiffness")),
    ] {
        let said = succeed(slump(&format!("{run} {options}")).current_dir(folder.path()));
        assert_eq!(said.contains("does not read"), unread.is_some(), "{options}: {said}");
        assert!(said.contains(unread.unwrap_or_default()), "{options}: {said}");
    }
}

/// Checks that `slump problem solve --starts` finds both solutions of a contact problem that has two, and names the
/// grain (number 82) at which they differ most. The problem is a step of the built-in pile; all earlier steps are
/// solved with bounded friction.
#[test]
fn a_step_with_two_solutions_is_told_to_have_them() {
    let folder = folder();
    let problem = |line: &str| {
        let output = run(slump(line).current_dir(folder.path()));
        assert!(output.status.success(), "{line}: {}", said(&output));
        String::from_utf8(output.stdout).expect("text")
    };
    problem(
        "problem dump --bond 0 --dt 1e-3 --at 0.15 --restitution-threshold 2 --friction-model tresca --touch-tolerance 0 --out step.json",
    );
    let said = problem("problem solve step.json --method nncg --starts 8");
    for part in ["starts          8,", "solutions       2\n", "most from 1: grain 82, by 7.0"] {
        assert!(said.contains(part), "{said}");
    }
    problem(
        "problem dump --bond 100 --dt 1e-3 --at 0.15 --restitution-threshold 2 --out standing.json",
    );
    let said = problem("problem solve standing.json --method nncg --starts 8");
    assert!(said.contains("solutions       1\n") && !said.contains("most from"), "{said}");
    let said = refusal(&["problem", "solve", "unread.json", "--starts", "2", "--without-bodies"]);
    assert!(
        said.contains("--starts is given, but must be left out where --without-bodies is"),
        "{said}"
    );
}

#[test]
fn an_unknown_challenge_is_told_of_with_those_there_are() {
    let said = refusal(&["stability", "heap"]);
    assert!(said.contains("scene is heap, but must be one of column, sag, mass-ratio"), "{said}");
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = folder();
    let file = folder.path().join("file");
    write(&file, "kept");
    let said = sentence(slump("--headless --scene cradle --frames").arg(&file));
    let expected = format!("slump: frames is {}, but must be a folder that can", file.display());
    assert!(said.starts_with(&expected), "{said}");
    assert_eq!(read(&file), "kept");
    assert!(refusal(&["--headless"]).contains("frames is missing"));
}

#[test]
fn broken_files_are_refused_with_their_line() {
    let folder = folder();
    let csv = folder.path().join("discs.csv");
    write(&csv, "x,y,radius\n0,0.01,0.0025\n0,much,0.0025\n");
    let said = sentence(slump("--headless --frames unused --initial").arg(&csv));
    assert!(said.contains("line 3") && said.contains('y'), "{said}");
    let toml = folder.path().join("scene.toml");
    write(&toml, "name = \"a\"\nmean_diameter = \n");
    let said = sentence(slump("--headless --frames unused --scene").arg(&toml));
    assert!(said.contains("line 2"), "{said}");
}

/// Arguments of a run of the cradle whose pictures show forces and speeds.
const DRAWN: &str = "--headless --scene cradle --dt 1e-3 --duration 0.2 --fps 20 --size 320x90 \
    --show forces --colour speed";

#[test]
fn frames_observables_manifest_and_animation_of_a_scene() {
    let folder = folder();
    let out = folder.path().join("deep/out");
    let gif = folder.path().join("cradle.gif");
    succeed(slump(DRAWN).arg("--frames").arg(&out).arg("--gif").arg(&gif));
    let mut expected: Vec<_> = (0..=4).map(|number| format!("frame_{number:05}.png")).collect();
    expected.extend(["manifest.json".to_owned(), "observables.csv".to_owned()]);
    assert_eq!(names_in(&out), expected);
    let frame = image::open(out.join("frame_00004.png")).expect("a PNG");
    assert_eq!((frame.width(), frame.height()), (320, 90));

    let rows = read(out.join("observables.csv"));
    assert_eq!(rows.lines().count(), 1 + 200, "a header and a row a step");
    let manifest = json(out.join("manifest.json"));
    assert_eq!(manifest["runs"][0]["scene"]["parameters"]["time_step_secs"], 1e-3);
    assert_eq!(manifest["runs"][0]["tally"]["steps"], 200);
    assert_eq!(manifest["pictures"].as_array().map(Vec::len), Some(5));
    let bytes = bytes(&gif);
    assert_eq!(&bytes[..6], b"GIF89a");
    assert_eq!(bytes.last(), Some(&0x3b), "the animation has its end");
    let has = |text: &[u8]| bytes.windows(text.len()).any(|part| part == text);
    assert!(has(b"Software: slump "), "the animation says what it is");
}

#[test]
fn a_frame_carries_the_command_that_draws_it_bit_for_bit() {
    let folder = folder();
    let out = folder.path().join("out");
    succeed(slump(DRAWN).args(["--renderer", "cpu", "--frames"]).arg(&out));
    let frame = out.join("frame_00003.png");
    let file = std::io::BufReader::new(std::fs::File::open(&frame).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    reader.finish().expect("a whole picture");
    let texts = &reader.info().uncompressed_latin1_text;
    let told = texts.iter().find(|text| text.keyword == "Command line").expect("a command");
    let words = shlex::split(&told.text).expect("words");
    assert!(words.contains(&"0.15".to_owned()), "{words:?}");
    succeed(slump("").current_dir(folder.path()).args(&words[1..]).args(["--renderer", "cpu"]));
    assert!(bytes(folder.path().join("frames/frame_00000.png")) == bytes(&frame));
}

#[test]
fn pictures_are_drawn_without_any_gpu() {
    let folder = folder();
    let line = "--headless --scene collision --times 0.5,0.1 --renderer cpu --frames";
    succeed(slump(line).arg(folder.path()));
    let manifest = read(folder.path().join("manifest.json"));
    assert!(manifest.contains("\"renderer\": \"cpu\""), "{manifest}");
}

#[test]
#[ignore = "SLUMP_PROGRAM is to name a program built with --no-default-features"]
fn a_build_without_window_or_gpu_says_which_feature_brings_it() {
    assert!(refusal(&[]).contains("no window: build it with the feature window"));
    let folder = folder();
    let line = "--headless --scene collision --renderer";
    for kind in ["vulkan", "gl"] {
        let said = sentence(slump(line).args([kind, "--frames"]).arg(folder.path()));
        assert!(said.contains(&format!("nothing by {kind}: build it with the feature gpu")));
    }
    succeed(slump(line).args(["auto", "--frames"]).arg(folder.path()));
}

#[test]
fn a_printed_scene_is_a_scene_file_that_gives_the_same_run() {
    let folder = folder();
    let printed = run(&mut slump("scene --scene cradle --dt 1e-3"));
    let file = folder.path().join("mine.toml");
    write(&file, printed.stdout);
    let observables = |scene: &str, extra: &[&str]| {
        let out = folder.path().join(Path::new(scene).file_name().expect("a name"));
        let out = out.with_extension("out");
        let mut command = slump("--headless --times 1.6 --scene");
        succeed(command.args([scene, "--frames"]).arg(&out).args(extra));
        read(out.join("observables.csv"))
    };
    let from_file = observables(text(&file), &[]);
    assert!(from_file.lines().count() > 1600);
    assert_eq!(from_file, observables("cradle", &["--dt", "1e-3"]));
}

#[test]
fn the_shipped_initial_state_is_reproduced_bit_for_bit() {
    let folder = folder();
    let out = folder.path().join("pile.csv");
    succeed(slump("generate --out").arg(&out));
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/core/assets/pile_138.csv");
    assert_eq!(read(&out), read(shipped));
}

#[test]
fn a_run_that_blows_up_leaves_its_frames_and_says_so_in_its_manifest() {
    let folder = folder();
    // The substep of the springs is far above the critical time step.
    let line = "--headless --scene squeeze --stepper dem --substeps 1 --dt 0.02 --duration 20 \
                --times 0,0.02,0.04,20 --size 100x100 --renderer cpu --frames";
    let said = failure(slump(line).arg(folder.path()));
    assert!(said.contains("the state is no longer finite at step "), "{said}");
    let mut expected: Vec<_> = (0..3).map(|number| format!("frame_{number:05}.png")).collect();
    expected.extend(["manifest.json".to_owned(), "observables.csv".to_owned()]);
    assert_eq!(names_in(folder.path()), expected);
    let manifest = manifest(folder.path());
    assert_eq!(manifest["pictures"].as_array().map(Vec::len), Some(3));
    let run = &manifest["runs"][0];
    let alarms = run["alarms"].as_array().expect("a list");
    let alarm = alarms.iter().find(|alarm| alarm["kind"] == "not-finite").expect("the alarm");
    let message = alarm["message"].as_str().expect("words");
    assert!(message.contains("try 0 substeps"), "{message}");
    // The step that became unstable is the last row of the table, and counts like all other steps.
    let steps = run["tally"]["steps"].as_u64().expect("a number");
    assert!((3..1000).contains(&steps), "it blows up on the way: {steps} steps");
    assert_eq!(alarm["step"].as_u64(), Some(steps));
    assert_eq!(read(folder.path().join("observables.csv")).lines().count() as u64, 1 + steps);
}

#[test]
fn waiting_for_a_common_scale_changes_no_picture() {
    // One run draws all states with a common scale. The other draws a single state with its own scale, which must be
    // the scale of the last frame.
    let (all, last) = (folder(), folder());
    let draw = |out: &Path, times: &str| {
        let line = "--headless --size 160x120 --renderer cpu --dt 1e-3 --show forces,angles --colour overlap";
        succeed(slump(line).args(["--times", times, "--frames"]).arg(out));
    };
    draw(all.path(), "0.02,0.02");
    draw(last.path(), "0.02");
    let one = bytes(last.path().join("frame_00000.png"));
    for name in ["frame_00000.png", "frame_00001.png"] {
        assert_eq!(bytes(all.path().join(name)), one);
    }
}

#[test]
fn commands_are_taken_as_people_guess_them_and_the_short_help_is_short() {
    let scene = |line: &str| {
        let output = run(slump("scene --scene thin-wall").args(line.split_whitespace()));
        assert!(output.status.success(), "{line}: {}", said(&output));
        String::from_utf8(output.stdout).expect("text")
    };
    let guessed = "--time-step 2e-3 --friction 0.2 --restitution 0.3 --method Newton --speculative --cone COMPRESSIVE";
    let exact =
        "--dt 2e-3 --mu 0.2 --rho 0.3 --solver newton --speculative true --cone compressive";
    assert_eq!(scene(guessed), scene(exact));
    assert_ne!(scene(exact), scene(""));

    let help = |option: &str| String::from_utf8(run(&mut slump(option)).stdout).expect("text");
    let (short, long) = (help("-h"), help("--help"));
    let options =
        |text: &str| text.lines().filter(|line| line.trim_start().starts_with("--")).count();
    assert!((10..=20).contains(&options(&short)), "{short}");
    assert!(options(&long) > 50 && long.contains("[pile: 0.001]"), "{long}");
    assert!(short.contains("Examples:"), "{short}");

    let listed = |what: &str| String::from_utf8(run(&mut slump(what)).stdout).expect("text");
    let parts = ["scenes", "steppers", "methods", "friction-models"];
    let all: String = parts.iter().map(|part| listed(&format!("list {part}"))).collect();
    assert_eq!(all, listed("list"));
}

#[test]
fn run_is_headless_with_the_scene_as_a_word() {
    let folder = folder();
    let write_to = |name: &str, line: &str| {
        let out = folder.path().join(name);
        succeed(slump(line).arg("--times").arg("0.02").arg("--frames").arg(&out));
        bytes(out.join("observables.csv"))
    };
    let old = write_to("old", "--headless --scene cradle --bond 7 --renderer cpu");
    let verb = write_to("verb", "run cradle --bond 7 --renderer cpu");
    let other = write_to("other", "run cradle --dt 1e-3 --renderer cpu");
    assert!(old == verb && old != other, "run and --headless differ, or --dt makes no difference");
    for (line, named) in
        [("run --frames out", "SCENE"), ("run pile collision", "collision"), ("run heap", "heap")]
    {
        let said = sentence(slump(line).current_dir(folder.path()));
        assert!(said.contains(named), "{line}: {said}");
    }
    // These options are refused without `--headless`.
    for line in [
        "--data out",
        "--gif a.gif",
        "--video a.mp4",
        "--video-speed 2",
        "--times 0",
        "--fps 5",
        "--overwrite",
        "--colour-scale 0,1",
        "--force-scale 1",
    ] {
        let said = sentence(slump("--scene pile").args(line.split(' ')).env_remove("DISPLAY"));
        assert!(said.contains("--headless is missing"), "{line}: {said}");
    }
}

#[test]
fn the_version_says_the_commit() {
    let output = run(&mut slump("--version"));
    let version = String::from_utf8(output.stdout).expect("text");
    let plain = format!("slump {}", env!("CARGO_PKG_VERSION"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    // An archive of the sources has no commit. If the archive is inside another repository, the commit would be a wrong
    // one.
    if !root.join(".git").exists() {
        assert_eq!(version.trim(), plain);
        return;
    }
    let start = format!("{plain} (");
    let commit = version.trim().strip_prefix(&start).and_then(|it| it.strip_suffix(')'));
    let commit = commit.unwrap_or_else(|| panic!("{version} without a commit"));
    let commit = commit.trim_end_matches(", changed");
    let mut git = Command::new("git");
    let known = git.args(["cat-file", "-e", commit]).current_dir(root).status();
    assert!(known.is_ok_and(|it| it.success()), "{commit} is no commit");
}
