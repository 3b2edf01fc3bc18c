//! Files that are dropped on the window.

use std::path::Path;

use egui::Context;

use super::export::STATE_ENDING;
use super::session::SESSION_ENDING;
use super::state::AppState;
use crate::config::{Config, SceneSource};

/// Opens the last file that was dropped in this frame.
pub(super) fn take_files(context: &Context, state: &mut AppState) {
    let dropped = context.input(|input| input.raw.dropped_files.last().cloned());
    let Some(file) = dropped else { return };
    let path = file.path();
    match asked(path) {
        Some(Asked::Scene(config)) => state.load(*config),
        Some(Asked::SavedRun) => state.load_saved(path),
        None => {
            let name = path.display();
            state.warn(format!(
                "{name} is neither a scene (.toml) nor a list of discs (.csv) nor a saved run (.{STATE_ENDING}) nor a session (.{SESSION_ENDING})"
            ));
        }
    }
}

/// What a dropped file asks for.
#[derive(Debug, PartialEq)]
enum Asked {
    /// A start.
    Scene(Box<Config>),
    /// To go on with what is in the file, a saved run or a session.
    SavedRun,
}

/// What a dropped file asks for, by its ending.
fn asked(path: &Path) -> Option<Asked> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "toml" => path.to_str().map(|path| Asked::Scene(Box::new(Config::of_scene(path)))),
        "csv" => {
            let source = SceneSource { initial: Some(path.to_owned()), ..SceneSource::default() };
            Some(Asked::Scene(Box::new(Config { source, ..Config::default() })))
        }
        STATE_ENDING | SESSION_ENDING => Some(Asked::SavedRun),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_scenes_from_discs_and_saved_runs() {
        let config = |path: &str| match asked(path.as_ref()) {
            Some(Asked::Scene(config)) => config.source,
            other => panic!("{path} is {other:?}"),
        };
        assert_eq!(config("a/Box.TOML").scene.as_deref(), Some("a/Box.TOML"));
        assert_eq!(config("a/pile.csv").initial.as_deref(), Some("a/pile.csv".as_ref()));
        assert_eq!(asked("a/checkpoint.slump".as_ref()), Some(Asked::SavedRun));
        assert_eq!(asked("a/pile.png".as_ref()), None);
    }
}
