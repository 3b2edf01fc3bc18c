//! Runs that are stopped and gone on with by the same command leave what they would have left.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use super::program::{folder, manifest, refusal, same, slump, succeed, wait_for};

const PILE: [&str; 10] = [
    "--bond",
    "20",
    "--dt",
    "1e-3",
    "--duration",
    "0.3",
    "--fps",
    "50",
    "--checkpoint-every",
    "0.03",
];

#[test]
fn a_run_that_is_killed_at_any_moment_goes_on_and_leaves_what_it_would_have_left() {
    let first = folder();
    let saved = first.path().join("saved.slump");
    let saved = saved.to_str().expect("UTF-8");
    let dense = ["--scene", "moving-walls", "--duration", "0.1", "--save", saved];
    succeed(&mut slump(&dense, first.path()));
    for (more, name) in [
        (&[][..], "greys"),
        (&["--show", "forces"], "forces"),
        (&["--show", "forces", "--restart", saved, "--stepper", "range"], "restarted, with walls"),
    ] {
        let whole = folder();
        let gif = |folder: &Path| folder.join("a.gif").to_string_lossy().into_owned();
        let arguments = |out: &Path| {
            let mut command = slump(&PILE, out);
            command.args(more).args(["--gif", &gif(out)]);
            command
        };
        // The animation lies in the folder, so that it is compared, too. Its path is part of the command.
        let begun = Instant::now();
        succeed(&mut arguments(whole.path()));
        let lasted = begun.elapsed();
        assert!(!whole.path().join("checkpoint.slump").exists(), "it is complete");

        let stopped = folder();
        let (mut kills, mut went_on) = (0, 0);
        loop {
            let mut child = arguments(stopped.path())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .expect("the program starts");
            // At first as soon as there is anything, then each time later, so that it gets to its end.
            if kills == 0 {
                wait_for(&stopped.path().join("checkpoint.slump"));
            } else {
                std::thread::sleep(lasted.mul_f64(0.1 + 0.1 * f64::from(kills)));
            }
            let is_over = child.try_wait().expect("a child").is_some();
            child.kill().expect("a child");
            let status = child.wait().expect("an end");
            assert!(!is_over || status.success(), "{name}: {status}");
            if !stopped.path().join("checkpoint.slump").exists() {
                // It was complete, and may have been about to remove the rest when it was killed.
                let rest = std::fs::remove_file(stopped.path().join("checkpoint.states"));
                assert!(rest.is_err() || !status.success(), "{name}: a rest is left");
                break;
            }
            went_on += 1;
            kills += 1;
            assert!(kills < 40, "{name}: it does not come to its end");
        }
        assert!(went_on > 1, "{name}: it was killed {kills} times, {went_on} with a checkpoint");
        assert!(manifest(stopped.path())["runs"][0]["went_on_at"].is_array());
        same(whole.path(), stopped.path(), name);
    }
}

#[cfg(unix)]
#[test]
fn a_run_that_a_signal_ends_goes_on_from_its_last_step_and_says_so() {
    let (whole, stopped) = (folder(), folder());
    let mut arguments = PILE;
    arguments[9] = "100";
    succeed(&mut slump(&arguments, whole.path()));
    let mut child = slump(&arguments, stopped.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    wait_for(&stopped.path().join("frame_00002.png"));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "TERM", &id]).status().expect("kill").success());
    assert_eq!(child.wait().expect("an end").code(), Some(143));
    let step = manifest(stopped.path())["runs"][0]["step"].as_u64().expect("a step");
    assert!(step < 300, "it was stopped on the way");

    // Without checkpoints, and with another number, the command is another one.
    let other = refusal(slump(&arguments, stopped.path()).args(["--mu", "0.4"]));
    assert!(
        other.contains("checkpoint.slump is there") && other.contains("another command"),
        "{other}"
    );
    let without = refusal(&mut slump(&arguments[..8], stopped.path()));
    assert!(without.contains("unless --overwrite"), "{without}");

    // What the checkpoint tells of must be there.
    let (table, picture) =
        (stopped.path().join("observables.csv"), stopped.path().join("frame_00001.png"));
    let [rows, pixels] = [&table, &picture].map(|path| std::fs::read(path).expect("a file"));
    std::fs::write(&table, &rows[..rows.len() / 2]).expect("a file");
    assert!(refusal(&mut slump(&arguments, stopped.path())).contains("observables.csv: has "));
    std::fs::write(&table, &rows).expect("a file");
    std::fs::remove_file(&picture).expect("a file");
    assert!(
        refusal(&mut slump(&arguments, stopped.path())).contains("frame_00001.png: is missing")
    );
    std::fs::write(&picture, &pixels).expect("a file");
    // What came after it, as where the run was killed later, goes.
    std::fs::write(&table, [&rows[..], b"9,9,9\n9,"].concat()).expect("a file");
    for left in ["frame_00099.png", ".checkpoint.slump.17-3.part"] {
        std::fs::write(stopped.path().join(left), &pixels).expect("a file");
    }

    let said = succeed(&mut slump(&arguments, stopped.path()));
    assert!(said.contains(&format!("the run goes on at step {step}, t = 0.")), "{said}");
    same(whole.path(), stopped.path(), "after a signal");
    let went_on = &manifest(stopped.path())["runs"][0]["went_on_at"];
    assert_eq!(went_on[0]["step"].as_u64(), Some(step));
    // What is complete does not go on.
    assert!(refusal(&mut slump(&arguments, stopped.path())).contains("frame_00000.png is there"));
}

#[test]
fn a_checkpoint_that_cannot_be_gone_on_with_is_refused_and_overwritten_when_asked() {
    let out = folder();
    let checkpoint = out.path().join("checkpoint.slump");
    std::fs::write(&checkpoint, "slump-state 2 0.0.0 1 x\ny").expect("a file");
    let said = refusal(&mut slump(&PILE, out.path()));
    assert!(said.contains("is of version 0.0.0") && said.contains("unless --overwrite"), "{said}");
    let mut brief = PILE;
    brief[5] = "0.01";
    succeed(slump(&brief, out.path()).arg("--overwrite"));
    assert!(!checkpoint.exists());
    assert_eq!(manifest(out.path())["runs"][0]["ended"], "complete");
}
