//! Tells the program its version: with the commit that it is built from, where this is a checkout of git.

use std::process::Command;

/// What the program is made of. A change elsewhere makes nothing anew.
const MADE_OF: [&str; 7] =
    ["Cargo.lock", "Cargo.toml", "assets", "build.rs", "crates", "shaders", "src"];

fn main() {
    MADE_OF.iter().for_each(|path| println!("cargo::rerun-if-changed={path}"));
    let version = env!("CARGO_PKG_VERSION");
    let version = match commit() {
        Some(commit) => format!("{version} ({commit})"),
        None => version.to_owned(),
    };
    println!("cargo::rustc-env=SLUMP_VERSION={version}");
    // The first thread gets 1 MiB on Windows, and a window that opens a session needs more than 2.
    let target = |part: &str| std::env::var(format!("CARGO_CFG_TARGET_{part}"));
    if target("OS").as_deref() == Ok("windows") && target("ENV").as_deref() == Ok("gnu") {
        println!("cargo::rustc-link-arg-bins=-Wl,--stack,8388608");
    }
}

/// What git says; nothing where it says nothing.
fn git(words: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("--no-optional-locks").args(words).output().ok()?;
    let said = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| said.trim_end().to_owned())
}

/// The commit's short hash, and whether what is built differs from it.
fn commit() -> Option<String> {
    // Sources without a history of their own may lie in somebody else's repository.
    if !git(&["rev-parse", "--show-cdup"])?.is_empty() {
        return None;
    }
    // A commit alone makes nothing anew, since that takes minutes: what was built before it goes on to say the one
    // before, changed. `release.sh` has this file run.
    let hash = git(&["rev-parse", "--short", "HEAD"])?;
    let changes = git(&[&["status", "--porcelain", "--"], &MADE_OF[..]].concat())?;
    Some(if changes.is_empty() { hash } else { format!("{hash}, changed") })
}
