//! Scales that are given beforehand: frames need not wait for the end of the run to share one.

use super::{brief_run, folder, pictures_in, start, wait_for};

#[test]
fn pictures_whose_scale_is_given_are_there_when_a_run_is_killed() {
    let scaled =
        ["--show", "forces", "--force-scale", "10", "--colour", "speed", "--colour-scale", "0,2.5"];
    let folder = folder();
    let mut child = start(folder.path(), &scaled);
    wait_for("the fourth picture", || folder.path().join("frame_00003.png").exists());
    child.kill().expect("a child");
    child.wait().expect("an end");
    assert!(pictures_in(folder.path()) > 3);
}

#[test]
fn a_scale_that_is_none_or_of_nothing_is_refused() {
    let folder = folder();
    for (more, expected) in [
        (&["--colour", "speed", "--colour-scale", "1"][..], "colour-scale is 1, but must be LOW,"),
        (&["--colour", "speed", "--colour-scale", "2,1"], "colour-scale is 2,1, but must be LOW,"),
        (&["--colour", "speed", "--colour-scale", "0,inf"], "colour-scale is 0,inf, but must be"),
        (&["--colour-scale", "0,1"], "left out where --colour is not speed"),
        (&["--force-scale", "1"], "left out where --show forces is not given"),
        (&["--show", "forces", "--force-scale", "0"], "force-scale is 0, but must be a finite"),
    ] {
        let output = brief_run(&folder.path().join("out"), more);
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(2), "{more:?}: {said}");
        assert!(said.contains(expected), "{more:?}: {said}");
    }
    assert!(!folder.path().join("out").exists());
}
