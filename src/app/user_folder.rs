//! The folders that belong to the program in the user's own.

use std::path::PathBuf;

/// The program's folder in the user's folder: `%APPDATA%` on Windows, elsewhere the one that a variable of the environment
/// names or else the one that lies in their home.
pub(super) fn user_folder(variable: &str, in_home: &str) -> Option<PathBuf> {
    let variable = if cfg!(windows) { "APPDATA" } else { variable };
    let named = std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || std::env::home_dir().map(|home| home.join(in_home));
    Some(named.or_else(home)?.join("slump"))
}
