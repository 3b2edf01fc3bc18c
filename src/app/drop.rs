//! Files that are dropped on the window.

use std::path::Path;

use egui::Context;

use super::state::AppState;
use crate::scene::{Config, Origin};

/// Opens the last file that was dropped in this frame.
pub(super) fn take_files(context: &Context, state: &mut AppState) {
    let dropped = context.input(|input| input.raw.dropped_files.last().cloned());
    let Some(file) = dropped else { return };
    match config_of(file.path()) {
        Some(config) => state.load(config),
        None => {
            let name = file.path().display();
            state.warn(format!("{name} is neither a scene (.toml) nor a list of discs (.csv)"));
        }
    }
}

/// What a dropped file asks for, by its ending.
fn config_of(path: &Path) -> Option<Config> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "toml" => path.to_str().map(Config::of_scene),
        "csv" => {
            let origin = Origin { initial: Some(path.to_owned()), ..Origin::default() };
            Some(Config { origin, ..Config::default() })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_scenes_from_discs() {
        let scene = config_of("a/Box.TOML".as_ref()).unwrap();
        assert_eq!(scene.origin.scene.as_deref(), Some("a/Box.TOML"));
        let discs = config_of("a/pile.csv".as_ref()).unwrap();
        assert_eq!(discs.origin.initial.as_deref(), Some("a/pile.csv".as_ref()));
        assert_eq!(config_of("a/pile.png".as_ref()), None);
    }
}
