//! The folders of Slump in the user's home folder.

use std::path::PathBuf;

/// Returns Slump's folder for this user. On Windows it is in `%APPDATA%`. On other systems it is in the folder that the
/// environment variable `variable` names, or else in the subfolder `in_home` of the home folder.
pub(super) fn user_folder(variable: &str, in_home: &str) -> Option<PathBuf> {
    let variable = if cfg!(windows) { "APPDATA" } else { variable };
    let named = std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || std::env::home_dir().map(|home| home.join(in_home));
    Some(named.or_else(home)?.join("slump"))
}
