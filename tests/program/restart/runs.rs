//! Runs that are stopped leave a checkpoint, from which others go on.

use std::path::Path;
use std::process::{Command, Stdio};

use super::program::{folder, manifest, refusal, slump, succeed, wait_for};

const PILE: [&str; 8] = ["--bond", "20", "--dt", "1e-3", "--duration", "0.3", "--fps", "50"];

#[cfg(unix)]
#[test]
fn a_run_that_is_stopped_leaves_a_checkpoint_from_which_another_goes_on() {
    let rows = |folder: &Path| -> Vec<String> {
        let text = std::fs::read_to_string(folder.join("observables.csv")).expect("a table");
        text.lines().map(str::to_owned).collect()
    };
    let saved = |out: &Path| {
        let mut command = slump(&PILE, out);
        command.args(["--checkpoint-every", "0.03"]);
        command
    };
    let whole = folder();
    succeed(&mut saved(whole.path()));
    let checkpoint = |folder: &Path| folder.join("checkpoint.slump");
    assert!(!checkpoint(whole.path()).exists(), "it is complete");
    for signal in ["TERM", "KILL"] {
        let (stopped, later) = (folder(), folder());
        let mut command = saved(stopped.path());
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        let mut child = child.expect("the program starts");
        let checkpoint = checkpoint(stopped.path());
        wait_for(&checkpoint);
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().expect("kill").success());
        assert!(!child.wait().expect("an end").success(), "it was stopped on the way");

        let said = refusal(&mut saved(stopped.path()));
        assert!(said.contains("checkpoint.slump is there") && said.contains("--overwrite"));
        let restart = ["--restart", checkpoint.to_str().expect("UTF-8")];
        succeed(slump(&PILE, later.path()).args(restart));
        let (found, expected) = (rows(later.path()), rows(whole.path()));
        assert!(found.len() > 2 && expected.ends_with(&found[1..]), "{signal}");
        let from = manifest(later.path())["runs"][0]["restarted_from"]["step"].as_u64();
        assert_eq!(from, Some((expected.len() - found.len()) as u64));
        succeed(saved(stopped.path()).arg("--overwrite"));
        assert!(!checkpoint.exists());
        assert_eq!(rows(stopped.path()), expected);
    }
}
