//! Helpers for tests that run Slump as a separate program: starting it, and reading its messages and files.

#![allow(dead_code, unused_imports, reason = "every test binary uses its own part of this")]

pub use std::path::{Path, PathBuf};
pub use std::process::{Child, Command, Output, Stdio};
pub use std::time::{Duration, Instant};

pub use serde_json::Value;
pub use tempfile::TempDir;

/// Time limit for waiting for the program. It is longer than any wait in a test, even on a busy machine.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Returns a command that starts Slump. `line` has its first arguments, separated by blanks. If the environment
/// variable `SLUMP_PROGRAM` names a program, this program is started, so that a program with fewer features can be
/// tested without rebuilding the tests. By default, the program that was built with the tests is started.
pub fn slump(line: &str) -> Command {
    let built = || assert_cmd::cargo::cargo_bin!("slump").to_path_buf();
    let mut command =
        Command::new(std::env::var_os("SLUMP_PROGRAM").map_or_else(built, PathBuf::from));
    command.args(line.split_whitespace());
    #[cfg(unix)]
    heed_signals(&mut command);
    command
}

/// Gives a child process the signal handling of a process that is started in a terminal, even if the tests were started
/// with ignored signals (by `nohup` or as a background job of a script). Programs inherit ignored signals, and Slump
/// does not change them.
#[cfg(unix)]
fn heed_signals(command: &mut Command) {
    let default = || {
        for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
            // SAFETY: no handler is installed, and `signal` may be called between fork and exec.
            if unsafe { libc::signal(signal, libc::SIG_DFL) } == libc::SIG_ERR {
                return Err(std::io::Error::last_os_error());
            }
        }
        Ok(())
    };
    // SAFETY: the closure allocates nothing and calls only `signal`.
    unsafe { std::os::unix::process::CommandExt::pre_exec(command, default) };
}

pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

pub fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

pub fn bytes(path: impl AsRef<Path>) -> Vec<u8> {
    let path = path.as_ref();
    std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

pub fn read(path: impl AsRef<Path>) -> String {
    String::from_utf8(bytes(path)).expect("UTF-8")
}

pub fn write(path: impl AsRef<Path>, content: impl AsRef<[u8]>) {
    let path = path.as_ref();
    std::fs::write(path, content).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

pub fn json(path: impl AsRef<Path>) -> Value {
    serde_json::from_slice(&bytes(path)).expect("JSON")
}

pub fn manifest(folder: &Path) -> Value {
    json(folder.join("manifest.json"))
}

pub fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name();
    let mut names: Vec<_> = entries.map(|it| name(it).to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

pub fn said(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!said.contains("panicked"), "{said}");
    said
}

pub fn run(command: &mut Command) -> Output {
    command.output().expect("the program starts")
}

#[track_caller]
pub fn succeed(command: &mut Command) -> String {
    let output = run(command);
    let said = said(&output);
    assert!(output.status.success(), "{command:?}: {said}");
    said
}

/// Runs a program and checks that its exit code is 2. Returns the text that it wrote to stderr.
#[track_caller]
pub fn failure(command: &mut Command) -> String {
    let output = run(command);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(2), "{command:?}: {said}");
    said
}

/// Runs a program and checks that it fails with exit code 2 and an error message of one line. Returns the message.
#[track_caller]
pub fn sentence(command: &mut Command) -> String {
    let said = failure(command);
    assert_eq!(said.trim_end().lines().count(), 1, "{command:?}: more than a sentence: {said}");
    said.trim_end().to_owned()
}

pub fn wait_for(what: &str, mut is_there: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_there() {
        assert!(begun.elapsed() < PATIENCE, "{what} did not come");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Sends a signal to a process. `signal` is its name, such as "TERM"; a negative `process` means a process group.
pub fn send(signal: &str, process: i64) {
    let number = match signal {
        "HUP" => libc::SIGHUP,
        "INT" => libc::SIGINT,
        "KILL" => libc::SIGKILL,
        "TERM" => libc::SIGTERM,
        other => panic!("{other} is not among the signals that tests send"),
    };
    let process = process.try_into().expect("the number of a process");
    // SAFETY: `kill` reads only its two numbers.
    let sent = unsafe { libc::kill(process, number) };
    assert_eq!(sent, 0, "{signal} to {process}: {}", std::io::Error::last_os_error());
}

/// Waits until a child process ends. Returns its exit code.
pub fn ended(child: &mut Child) -> Option<i32> {
    let mut status = None;
    wait_for("the end", || {
        status = child.try_wait().expect("a child");
        status.is_some()
    });
    status.and_then(|status| status.code())
}

/// Kills a child process with SIGKILL, so that it ends as abruptly as in a power failure.
pub fn kill(child: &mut Child) {
    child.kill().expect("kill -9");
    child.wait().expect("it ended");
}
