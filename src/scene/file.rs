//! Scene files in TOML.

use std::path::Path;

use super::{GrainSource, Scene, pile};
use crate::error::{Error, Result};

/// Reads a scene from a TOML file. Grains that come from a CSV or from rain are read or made.
///
/// # Errors
/// Where the file cannot be read, is no TOML, or says something that no scene says (the message
/// names line and column), or where a value is outside its range.
pub fn read_scene(path: &Path) -> Result<Scene> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::file(path, error))?;
    let mut scene: Scene = toml::from_str(&text).map_err(|error| {
        let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
        let place = line.map_or(String::new(), |line| format!("line {line}: "));
        Error::file(path, format!("{place}{}", error.message()))
    })?;
    if let Some(source) = scene.source.take() {
        if !scene.grains.is_empty() {
            let allowed = "left out where grains are listed";
            return Err(Error::value("source", "given", allowed));
        }
        let source = match source {
            GrainSource::Csv { path: csv } => {
                GrainSource::Csv { path: path.parent().unwrap_or(Path::new("")).join(csv) }
            }
            rain @ GrainSource::Rain(_) => rain,
        };
        scene.grains = source.grains()?;
        pile::tone_in_layers(&mut scene.grains, scene.mean_diameter);
    }
    scene.validate()?;
    Ok(scene)
}

/// The TOML file that says what a scene says.
///
/// # Errors
/// Where the scene holds what TOML cannot say.
pub fn scene_to_toml(scene: &Scene) -> Result<String> {
    toml::to_string(scene).map_err(|error| Error::value("scene", &scene.name, error.to_string()))
}
