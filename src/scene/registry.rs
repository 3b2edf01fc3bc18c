//! The built-in scenes by name.

use super::{Scene, collision, cradle, paper_pile};
use crate::error::{Error, Result};

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct SceneInfo {
    /// Its name on the command line.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Makes it.
    pub make: fn() -> Result<Scene>,
}

/// All built-in scenes.
pub const SCENES: [SceneInfo; 3] = [
    SceneInfo {
        name: "pile",
        summary: "138 cohesive grains on a rough base; at t = 0 the walls go (paper section 3)",
        make: paper_pile,
    },
    SceneInfo {
        name: "cradle",
        summary: "three grains on a line, one falls on a bonded pair (paper section 4)",
        make: || Ok(cradle()),
    },
    SceneInfo {
        name: "collision",
        summary: "one grain dropped on a fixed one (paper section 2.2)",
        make: || Ok(collision()),
    },
];

/// The names of all built-in scenes, for messages.
pub fn scene_names() -> String {
    SCENES.map(|scene| scene.name).join(", ")
}

/// A built-in scene by name.
///
/// # Errors
/// Where there is none of that name.
pub fn built_in(name: &str) -> Result<Scene> {
    let info = SCENES.iter().find(|scene| scene.name == name).ok_or_else(|| {
        Error::value("scene", name, format!("one of {} or a file.toml", scene_names()))
    })?;
    (info.make)()
}
