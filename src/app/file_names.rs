//! Names of the files that the window reads and writes.

use std::path::{Path, PathBuf};

use super::number_text::written;
use crate::sim::Settings;
use crate::world::Parameters;

/// File name ending of saved runs.
pub(crate) const STATE_ENDING: &str = "slump";

/// File name ending of sessions (runs with their history and the arrangement of the window).
pub(crate) const SESSION_ENDING: &str = "session";

/// Returns the first part of the name of a file that shows a scene at one simulated time. It contains the scene's name,
/// Bond and Δt of a single simulation or the number of simulations, and the simulated time.
pub(crate) fn stem(scene: &str, settings: &[Settings], time_secs: f64) -> String {
    let name: String = scene.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let which = match settings {
        [alone] => {
            let Parameters { bond, time_step_secs, .. } = alone.parameters;
            format!("bond{}-dt{}", written(bond), written(time_step_secs))
        }
        all => format!("{}worlds", all.len()),
    };
    format!("slump-{name}-{which}-{time_secs:.4}s")
}

/// Returns the path of the file `stem.ending` in `folder`. If this file exists already, a number is added to its name.
pub(super) fn free_path(folder: &Path, stem: &str, ending: &str) -> PathBuf {
    let numbered = |number: u32| folder.join(format!("{stem}-{number}.{ending}"));
    let plain = folder.join(format!("{stem}.{ending}"));
    if !plain.exists() {
        return plain;
    }
    // The search ends, because no folder has that many files.
    (2..).map(numbered).find(|path| !path.exists()).unwrap_or(plain)
}

/// Returns the message for a file that the window cannot open.
pub(super) fn refused_file(path: &Path) -> String {
    let name = path.display();
    format!(
        "{name} is neither a scene (.toml) nor a list of discs (.csv) nor a saved run (.{STATE_ENDING}) nor a \
            session (.{SESSION_ENDING})"
    )
}

pub(super) fn is_session(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == SESSION_ENDING)
}

/// True if the file name has the ending of a saved run or a session.
pub(super) fn is_saved_run(path: &Path) -> bool {
    is_session(path) || path.extension().is_some_and(|ending| ending == STATE_ENDING)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_scene_numbers_and_time() {
        let settings = Settings::default().with_bond(20.0).over(1e-4);
        assert_eq!(stem("a b.toml", &[settings], 0.25), "slump-a-b-toml-bond20-dt1e-4-0.2500s");
        assert_eq!(stem("pile", &[settings; 3], 1.0), "slump-pile-3worlds-1.0000s");
    }

    #[test]
    fn files_do_not_replace_each_other() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "a-2.png"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        assert_eq!(free_path(folder.path(), "a", "png"), folder.path().join("a-3.png"));
    }
}
