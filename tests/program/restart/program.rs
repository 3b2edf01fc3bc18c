//! Tests of runs that the program saves, stops and resumes, or that are killed, and of the files in their output
//! folders.

use std::collections::BTreeMap;

use slump::config::SavedState;

use crate::program::*;

fn drawn(line: &str, out: &Path) -> Command {
    let mut command = slump("--headless --size 64x36 --renderer cpu");
    command.args(line.split_whitespace()).arg("--frames").arg(out);
    command
}

#[track_caller]
fn refusal(command: &mut Command) -> String {
    let said = failure(command);
    assert!(said.lines().last().is_some_and(|last| last.contains("must")), "{said}");
    said
}

/// Returns names and contents of all files of a folder. The entries about the command and the interruptions are removed
/// from the manifest (`manifest.json`, which describes the run).
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let content = |name: String| (name.clone(), bytes(folder.join(name)));
    let mut files: BTreeMap<_, _> = names_in(folder).into_iter().map(content).collect();
    // A killed program may leave its lock file, which no longer locks anything.
    files.remove(".slump.lock");
    let manifest = files.get_mut("manifest.json").expect("a manifest");
    let mut said: Value = serde_json::from_slice(manifest).expect("JSON");
    let said_of = said.as_object_mut().expect("a table");
    said_of.remove("command");
    let run = said_of["runs"][0].as_object_mut().expect("a run");
    run.remove("went_on_at");
    run.remove("restarted_from");
    *manifest = serde_json::to_vec(&said).expect("JSON");
    files
}

/// Checks that two folders have files with the same contents.
#[track_caller]
fn same(one: &Path, other: &Path, what: &str) {
    let (one, other) = (contents(one), contents(other));
    assert!(one.keys().eq(other.keys()), "{what}: {:?} and {:?}", one.keys(), other.keys());
    for (name, content) in one {
        assert!(content == other[&name], "{what}: {name} differs");
    }
}

/// Runs 0.1 s in one run, and again in two runs: the first saves its state at 0.05 s, and the second starts from it.
/// Returns the three output folders.
fn halves(more: &str) -> [TempDir; 3] {
    let folders = [folder(), folder(), folder()];
    let state = folders[1].path().join("half.slump");
    let base = format!("--bond 20 --dt 1e-3 --fps 100 {more}");
    succeed(drawn(&base, folders[0].path()).args(["--duration", "0.1"]));
    succeed(drawn(&base, folders[1].path()).args(["--duration", "0.05", "--save"]).arg(&state));
    let second = "--fps 100 --duration 0.1";
    succeed(drawn(second, folders[2].path()).arg("--restart").arg(&state));
    folders
}

#[test]
fn a_saved_run_goes_on_as_if_it_had_never_ended() {
    for more in ["", "--stepper range", "--stepper dem", "--solver newton"] {
        let [whole, first, second] = halves(more);
        let rows = |folder: &TempDir| {
            let text = read(folder.path().join("observables.csv"));
            text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!([rows(&first), rows(&second)].concat(), rows(&whole), "{more:?}");
        let [whole, first, second] = [whole, first, second].map(|folder| contents(folder.path()));
        let frames = whole.keys().filter(|name| name.starts_with("frame_"));
        // Only the pixels are compared, because the files also contain the command.
        let pixels =
            |bytes: &Vec<u8>| image::load_from_memory(bytes).expect("a picture").to_rgba8();
        for name in frames.clone() {
            let half = first.get(name).or(second.get(name)).expect("a frame of one half");
            assert!(pixels(half) == pixels(&whole[name]), "{more:?}: {name}");
        }
        assert_eq!(frames.count(), 11);
        // Both halves have a picture of the time at which the state was saved.
        let shared = [&first, &second].map(|half| pixels(&half["frame_00005.png"]));
        assert!(shared[0] == shared[1]);
        let tally = |files: &BTreeMap<String, Vec<u8>>| {
            let manifest: Value = serde_json::from_slice(&files["manifest.json"]).expect("JSON");
            manifest["runs"][0].clone()
        };
        assert_eq!(tally(&whole), tally(&second), "{more:?}");
    }
}

#[test]
fn a_saved_run_goes_on_otherwise_where_it_is_asked_to() {
    let [_, first, _] = halves("");
    let state = first.path().join("half.slump");
    let restart = |more: &[&str]| {
        let out = folder();
        let mut command = drawn("", out.path());
        command.arg("--restart").arg(&state).args(more);
        (out, command)
    };
    let (out, mut command) = restart(&["--bond", "80", "--stepper", "range", "--dt", "5e-4"]);
    let saved = out.path().join("end.slump");
    succeed(command.args(["--duration", "0.1", "--save"]).arg(&saved));
    let state_at_end = SavedState::open(&saved).expect("a state");
    let parameters = state_at_end.simulation.parameters();
    assert_eq!((parameters.bond, parameters.friction), (80.0, 0.5), "what is not changed stays");
    assert_eq!(state_at_end.simulation.observables().step, 50 + 100);
    assert_eq!(state_at_end.tally.steps, 150);
    assert!(state_at_end.simulation.observables().slump > 0.0, "against the first start");
    let run = &manifest(out.path())["runs"][0];
    assert_eq!(run["restarted_from"]["step"], 50);
    assert_eq!(run["scene"]["parameters"]["bond"], 80.0);

    for (more, field) in [
        (&["--duration", "0.05"][..], "duration is 0.05"),
        (&["--times", "0.01", "--duration", "0.2"], "times is 0.01"),
        (&["--scene", "cradle", "--duration", "0.2"], "restart is given"),
        (&["--preset", "robust", "--duration", "0.2"], "restart is given"),
        (
            &["--base-width", "20"],
            "grains, box-width, base-width, seed, deposition, sizes, start or preset",
        ),
        (&["--initial-step", "1"], "left out where scene, initial, initial-step, grains"),
        (&["--bond", "-1", "--duration", "0.2"], "bond is -1"),
        (&["--checkpoint-every", "0", "--duration", "0.2"], "checkpoint-every is 0"),
        (
            &["--stepper", "range", "--cone", "compressive", "--duration", "0.2"],
            "cone is compressive",
        ),
    ] {
        let (out, mut command) = restart(more);
        let said = refusal(&mut command);
        assert!(said.contains(field), "{said}");
        assert!(!out.path().join("manifest.json").exists(), "{more:?}");
    }
}

#[test]
fn a_saved_run_is_an_initial_state_in_its_own_scene() {
    let folder = folder();
    let (state, next) = (folder.path().join("walls.slump"), folder.path().join("next.slump"));
    let saved = |path: &Path, more: &[&str]| {
        let mut command = slump("--headless --save");
        command.arg(path).args(more);
        command
    };
    succeed(&mut saved(&state, &["--scene", "moving-walls", "--duration", "0.1"]));
    let before = SavedState::open(&state).expect("a state");
    let initial = ["--initial", text(&state), "--duration"];
    succeed(saved(&next, &initial).args(["0.01", "--dt", "2e-4", "--bond", "5"]));
    let after = SavedState::open(&next).expect("a state");
    assert_eq!(after.scene.name, "moving-walls");
    assert_eq!(after.simulation.observables().step, 50, "it begins at t = 0");
    assert_eq!(
        after.scene.boundaries,
        before.simulation.world().boundaries,
        "walls are where they were"
    );
    assert_ne!(after.scene.boundaries, before.scene.boundaries, "which is not where they began");
    let positions = &before.simulation.world().grains.positions;
    assert!(
        after.scene.grains.iter().zip(positions).all(|(grain, &place)| grain.position == place)
    );
    assert_eq!(after.simulation.parameters().bond, 5.0);

    let said = refusal(saved(&next, &initial).args(["0.1", "--initial-step", "1"]));
    assert!(said.contains("initial-step is 1, but must be left out"), "{said}");
    let said = refusal(saved(&next, &initial).args(["0.1", "--scene", "cradle"]));
    assert!(said.contains("scene is cradle") && said.contains("moving-walls"), "{said}");
    let mut bytes = bytes(&state);
    bytes.pop();
    write(&state, bytes);
    assert!(refusal(saved(&next, &initial).arg("0.1")).contains("has been cut"));
}

const PILE: &str = "--bond 20 --dt 1e-3 --duration 0.3 --fps 50 --checkpoint-every 0.03";

#[test]
fn a_run_that_is_killed_at_any_moment_goes_on_and_leaves_what_it_would_have_left() {
    let first = folder();
    let saved = first.path().join("saved.slump");
    let saved = text(&saved);
    let dense = "--scene moving-walls --duration 0.1";
    succeed(drawn(dense, first.path()).args(["--save", saved]));
    for (more, name) in [
        (&[][..], "greys"),
        (&["--show", "forces"], "forces"),
        (&["--show", "forces", "--restart", saved, "--stepper", "range"], "restarted, with walls"),
    ] {
        let whole = folder();
        let gif = |folder: &Path| folder.join("a.gif").to_string_lossy().into_owned();
        let arguments = |out: &Path| {
            let mut command = drawn(PILE, out);
            command.args(more).args(["--gif", &gif(out)]);
            command.stdout(Stdio::null()).stderr(Stdio::null());
            command
        };
        // The animation is in the output folder, so it is compared, too. Its path is a part of the command.
        let begun = Instant::now();
        succeed(&mut arguments(whole.path()));
        let lasted = begun.elapsed();
        assert!(!whole.path().join("checkpoint.slump").exists(), "it is complete");

        let stopped = folder();
        let (mut kills, mut went_on) = (0, 0);
        loop {
            let mut child = arguments(stopped.path()).spawn().expect("the program starts");
            // The first kill comes as soon as there is a checkpoint. Each further kill comes later after the start, so
            // that the run ends eventually.
            if kills == 0 {
                wait_for("a checkpoint", || stopped.path().join("checkpoint.slump").exists());
            } else {
                std::thread::sleep(lasted.mul_f64(0.05 * f64::from(kills)));
            }
            let is_over = child.try_wait().expect("a child").is_some();
            child.kill().expect("a child");
            let status = child.wait().expect("an end");
            assert!(!is_over || status.success(), "{name}: {status}");
            if !stopped.path().join("checkpoint.slump").exists() {
                // The run was complete, and was possibly killed while it removed its temporary files.
                let rest = std::fs::remove_file(stopped.path().join("checkpoint.states"));
                assert!(rest.is_err() || !status.success(), "{name}: a rest is left");
                break;
            }
            // A temporary file as it remains after a kill while the animation gets its final name.
            write(stopped.path().join(".a.gif.Ab12Cd.part"), "half");
            went_on += 1;
            kills += 1;
            assert!(kills < 40, "{name}: it does not come to its end");
        }
        assert!(went_on > 1, "{name}: it was killed {kills} times, {went_on} with a checkpoint");
        assert!(manifest(stopped.path())["runs"][0]["went_on_at"].is_array());
        same(whole.path(), stopped.path(), name);
    }
}

#[test]
fn means_of_a_recording_go_on_where_a_run_was_killed_between_two_frames() {
    let (whole, stopped) = (folder(), folder());
    let recorded = |out: &Path| {
        let mut command = drawn(PILE, out);
        command.args(["--data-every", "0.2", "--data-format", "csv", "--data"]);
        command.arg(out.join("data")).stdout(Stdio::null()).stderr(Stdio::null());
        command
    };
    succeed(&mut recorded(whole.path()));
    let mut child = recorded(stopped.path()).spawn().expect("it starts");
    wait_for("pictures", || stopped.path().join("frame_00003.png").exists());
    child.kill().expect("a child");
    child.wait().expect("an end");
    // Missing rows cannot be written again, so Slump must not resume this run.
    let steps = stopped.path().join("data/csv/steps.csv");
    let rows = bytes(&steps);
    write(&steps, &rows[..rows.len() / 8]);
    let left = || {
        let names =
            ["observables.csv", "data/frames.csv", "data/csv/grains.csv", "data/csv/steps.csv"];
        let mut there = names_in(stopped.path());
        // The killed program left its lock file.
        there.retain(|name| name != ".slump.lock");
        (there, names.map(|name| bytes(stopped.path().join(name))))
    };
    let before = left();
    let said = refusal(recorded(stopped.path()).stderr(Stdio::piped()));
    assert!(said.contains("steps.csv: has ") && said.contains("rows of the saved run"), "{said}");
    assert!(left() == before, "nothing is changed");
    write(&steps, rows);
    succeed(&mut recorded(stopped.path()));
    let went_on = &manifest(stopped.path())["runs"][0]["went_on_at"][0]["step"];
    assert!((1..200).contains(&went_on.as_u64().expect("a step")), "{went_on}");
    for table in ["pairs", "grains", "measures"] {
        let [whole, stopped] = [&whole, &stopped].map(|folder| {
            let text = read(folder.path().join(format!("data/csv/{table}.csv")));
            text.lines()
                .filter(|line| !line.starts_with('#'))
                .map(str::to_owned)
                .collect::<Vec<_>>()
        });
        assert!(whole.len() > 2 && whole == stopped, "{table}");
    }
}

#[cfg(unix)]
#[test]
fn a_run_that_a_signal_ends_goes_on_from_its_last_step_and_says_so() {
    let (whole, stopped) = (folder(), folder());
    let line = PILE.replace("0.03", "100");
    succeed(&mut drawn(&line, whole.path()));
    // A resumed run may replace the state that it has saved before.
    let of_state = folder();
    let saved = of_state.path().join("saved.slump");
    let mut run = drawn(&line, stopped.path());
    run.arg("--save").arg(&saved);
    let mut child = run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
    wait_for("pictures", || stopped.path().join("frame_00002.png").exists());
    send("TERM", child.id().into());
    assert_eq!(ended(&mut child), Some(143));
    let step = manifest(stopped.path())["runs"][0]["step"].as_u64().expect("a step");
    assert!(step < 300, "it was stopped on the way");
    // With another value of μ or without checkpoints, the command is a different one.
    let other = refusal(drawn(&line, stopped.path()).args(["--mu", "0.4"]));
    assert!(
        other.contains("checkpoint.slump is there") && other.contains("another command"),
        "{other}"
    );
    let without =
        refusal(&mut drawn(PILE.split(" --checkpoint").next().expect("options"), stopped.path()));
    assert!(without.contains("unless --overwrite"), "{without}");
    // All files that the checkpoint lists must exist.
    let (table, picture) =
        (stopped.path().join("observables.csv"), stopped.path().join("frame_00001.png"));
    let [rows, pixels] = [&table, &picture].map(bytes);
    write(&table, &rows[..rows.len() / 2]);
    assert!(refusal(&mut drawn(&line, stopped.path())).contains("observables.csv: has "));
    write(&table, &rows);
    std::fs::remove_file(&picture).expect("a file");
    assert!(refusal(&mut drawn(&line, stopped.path())).contains("frame_00001.png: is missing"));
    write(&picture, &pixels);
    // Files and rows that are later than the checkpoint, as after a later kill, are removed.
    write(&table, [&rows[..], b"9,9,9\n9,"].concat());
    for left in ["frame_00099.png", ".checkpoint.slump.17-3.part"] {
        write(stopped.path().join(left), &pixels);
    }

    let of_stop = bytes(&saved);
    let said = succeed(drawn(&line, stopped.path()).arg("--save").arg(&saved));
    assert!(bytes(&saved) != of_stop, "the state of the end");
    assert!(said.contains(&format!("the run goes on at step {step}, t = 0.")), "{said}");
    same(whole.path(), stopped.path(), "after a signal");
    let went_on = &manifest(stopped.path())["runs"][0]["went_on_at"];
    assert_eq!(went_on[0]["step"].as_u64(), Some(step));
    // A complete run is not resumed.
    assert!(refusal(&mut drawn(&line, stopped.path())).contains("frame_00000.png is there"));
}

#[test]
fn a_checkpoint_that_cannot_be_gone_on_with_is_refused_and_overwritten_when_asked() {
    let out = folder();
    let checkpoint = out.path().join("checkpoint.slump");
    write(&checkpoint, "slump-state 3 0.0.0 1 x\ny");
    let said = refusal(&mut drawn(PILE, out.path()));
    assert!(said.contains("is of version 0.0.0") && said.contains("unless --overwrite"), "{said}");
    let brief = PILE.replace("0.3 ", "0.01 ");
    succeed(drawn(&brief, out.path()).arg("--overwrite"));
    assert!(!checkpoint.exists());
    assert_eq!(manifest(out.path())["runs"][0]["ended"], "complete");
}
