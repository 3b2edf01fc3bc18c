//! Which program is tested.

use std::path::PathBuf;

/// The one that was built with these tests, or that which `SLUMP_PROGRAM` names: one with fewer features is tested
/// without another build of all tests.
pub fn program() -> PathBuf {
    let built = || assert_cmd::cargo::cargo_bin!("slump").to_path_buf();
    std::env::var_os("SLUMP_PROGRAM").map_or_else(built, PathBuf::from)
}
