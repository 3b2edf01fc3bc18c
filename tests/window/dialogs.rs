//! Tests of the dialogs in which the user chooses a file or a folder. On Linux desktops a system service
//! (xdg-desktop-portal) shows these dialogs or, without this service, the program `zenity`. The tests switch the
//! service off and replace `zenity` by a script. Each test runs in its own process, because the script is found through
//! the environment variable `PATH`.

#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::Command;

use crate::robot::{Robot, folder, pile, write};

/// Runs another test of this test program in a child process in which a script replaces `zenity`. Without a script, the
/// child process finds no such program. `answer` is the path that the script returns.
fn with_zenity(test: &str, script: Option<&str>, answer: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let programs = folder();
    if let Some(script) = script {
        let path = programs.path().join("zenity");
        write(&path, script);
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).expect("a script");
    }
    let output = Command::new(std::env::current_exe().expect("a program"))
        .args(["--ignored", "--exact", test, "--nocapture"])
        .env("PATH", programs.path())
        .env("ANSWER", answer)
        .env("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nowhere")
        .output()
        .expect("it starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}

fn answer() -> std::path::PathBuf {
    std::env::var_os("ANSWER").expect("an answer").into()
}

#[test]
fn a_file_from_a_dialog_is_opened() {
    let files = folder();
    let discs = files.path().join("two.csv");
    write(&discs, "x,y,radius\n0,0.0025,0.0025\n0,0.0075,0.0025\n");
    let script = "#!/bin/sh\necho \"$ANSWER\"\n";
    with_zenity("dialogs::opens_what_was_chosen", Some(script), &discs);
}

#[test]
#[ignore = "part of a_file_from_a_dialog_is_opened, which starts it in a process of its own"]
fn opens_what_was_chosen() {
    let mut robot = Robot::open(pile());
    robot.clicks(&["Save", "Choose a file"]);
    robot.until("the two discs", |state| {
        state.run.frame.worlds.first().is_some_and(|world| world.snapshot.grains.len() == 2)
    });
}

#[test]
fn a_folder_from_a_dialog_is_that_of_saved_files() {
    let files = folder();
    let script = "#!/bin/sh\necho \"$ANSWER\"\n";
    with_zenity("dialogs::saves_where_was_chosen", Some(script), files.path());
}

#[test]
#[ignore = "part of a_folder_from_a_dialog_is_that_of_saved_files, which starts it in a process of its own"]
fn saves_where_was_chosen() {
    let mut robot = Robot::open(pile());
    robot.clicks(&["Save", "Choose a folder"]);
    robot.until("the folder", |state| state.preferences.folder == answer());
}

#[test]
fn a_cancelled_dialog_changes_nothing_and_a_missing_one_is_named() {
    let cancels = "#!/bin/sh\n/bin/sleep 0.3\nexit 1\n";
    with_zenity("dialogs::changes_nothing", Some(cancels), Path::new(""));
    with_zenity("dialogs::is_named", None, Path::new(""));
}

#[test]
#[ignore = "part of a_cancelled_dialog_changes_nothing_and_a_missing_one_is_named"]
fn changes_nothing() {
    let mut robot = Robot::open(pile());
    let folder = robot.state().preferences.folder.clone();
    robot.clicks(&["Save", "Choose a folder"]);
    std::thread::sleep(std::time::Duration::from_millis(600));
    robot.frames(5);
    assert_eq!(robot.state().preferences.folder, folder);
    assert!(robot.state().notice().is_none());
}

#[test]
#[ignore = "part of a_cancelled_dialog_changes_nothing_and_a_missing_one_is_named"]
fn is_named() {
    let mut robot = Robot::open(pile());
    robot.clicks(&["Save", "Choose a file"]);
    robot.until("a notice", |state| state.notice().is_some());
    let said = robot.state().notice().expect("a notice").0.text.clone();
    assert!(said.contains("install one of them, or type the path"), "{said}");
}
