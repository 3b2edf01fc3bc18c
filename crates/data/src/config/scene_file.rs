//! Reads and writes scene files in TOML and files of discs in CSV.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec2;

use crate::data::{RecordedGrains, parse_grains, read_grains};
use crate::error::{self, Error, Result};
use crate::input::{MOST_OF_TOML, read_text};
use crate::scene::{GrainSource, NewPile, Scene, settle, start_of};
use crate::world::Grain;

/// Description of a valid scene file, for error messages.
const FORM: &str = "a scene file in TOML, such as `slump scene` prints";

/// Reads a scene from a TOML file. If the scene names a file of grains, reads the grains from that file. If the scene
/// describes a new pile, makes the pile and lets its grains settle.
///
/// # Errors
/// If the file cannot be read, is not TOML or contains something unknown (the message names the line), or contains a
/// value outside its range.
pub fn read_scene(path: &Path) -> Result<Scene> {
    match read_unsettled(path)? {
        (scene, Some(pile)) => Ok(scene.with_settled(settle(&pile, |_| true)?)),
        (scene, None) => Ok(scene),
    }
}

/// Reads a scene from a TOML file. If the scene describes a new pile, its grains do not settle, which would take long:
/// the scene has the grains at their initial positions, and the description of the pile is also returned, so that the
/// grains can settle later.
pub(super) fn read_unsettled(path: &Path) -> Result<(Scene, Option<NewPile>)> {
    let text = read_text(path, FORM, MOST_OF_TOML)?;
    let scene = toml::from_str(&text).map_err(|error| {
        let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
        let place = line.map_or(String::new(), |line| format!("line {line}: "));
        Error::unread(path, format!("{place}{}", error.message()), FORM)
    })?;
    unsettled(scene, path.parent().unwrap_or(Path::new("")))
}

/// Adds the grains to a scene. If the scene names a file of grains, reads the grains from this file. If the scene
/// describes a new pile, adds the grains of the pile at their initial positions. Returns the scene and the description
/// of the new pile; the description is `None` without a new pile. Relative paths in the scene start from `folder`.
pub(super) fn unsettled(mut scene: Scene, folder: &Path) -> Result<(Scene, Option<NewPile>)> {
    let mut new_pile = None;
    if let Some(source) = scene.source.take() {
        let allowed = "left out where grains are listed";
        error::check(scene.grains.is_empty(), "source", "given", allowed)?;
        let grains = match source {
            GrainSource::Csv { path } => discs_of(&mut scene, &folder.join(path), None)?,
            GrainSource::Data { path, step } => discs_of(&mut scene, &folder.join(path), step)?,
            GrainSource::NewPile(pile) => {
                pile.validate()?;
                let start = start_of(&pile);
                new_pile = Some(pile);
                start
            }
        };
        scene = scene.with_settled(grains).without_implied_masses();
    }
    if let Some(data) = scene.data.as_mut().and_then(|data| data.folder.as_mut()) {
        *data = folder.join(&*data);
    }
    scene.validate()?;
    Ok((scene, new_pile))
}

/// Reads the grains for a scene from a file of discs. If the file has several steps, reads the grains at the step
/// number `step`, or at the last step if `step` is `None`. If the scene lists no fixed discs, the fixed discs of the
/// file are added to the scene.
fn discs_of(scene: &mut Scene, path: &Path, step: Option<u64>) -> Result<Vec<Grain>> {
    let mut discs = read_grains(path, step)?;
    let grains = std::mem::take(&mut discs.grains);
    let RecordedGrains { fixed_discs, .. } = &discs;
    if scene.fixed_discs.is_empty() {
        discs.place_fixed_discs(scene, path)?;
    } else if !fixed_discs.is_empty() && *fixed_discs != scene.fixed_discs {
        let reason = format!(
            "has {} fixed discs that are not those of the scene, but must have none or the same: leave fixed_discs \
             out of the scene to take those of the file",
            fixed_discs.len()
        );
        return Err(Error::file(path, reason));
    }
    Ok(grains)
}

/// Returns the text of a TOML file that describes a scene.
///
/// # Errors
/// If the scene contains a value that TOML cannot express.
pub fn scene_to_toml(scene: &Scene) -> Result<String> {
    toml::to_string(scene).map_err(|error| Error::value("scene", &scene.name, error.to_string()))
}

/// Reads discs from the text of a CSV file in SI units, with the header `x,y,radius` and optionally `vx,vy,omega`,
/// `mass` or `density`, and `material`. Lines that start with `#` are comments. `path` is for error messages.
///
/// # Errors
/// If a line is not a disc; the message names the line.
pub fn parse_discs(text: &str, path: &Path) -> Result<Vec<Grain>> {
    Ok(parse_grains(text, path)?.grains)
}

/// Returns the text of a CSV file of discs, without their materials and masses. Reading the numbers back gives exactly
/// the same values. The text begins with the lines of `comment`, each after `# `.
pub fn write_discs(grains: &[Grain], comment: &str) -> String {
    let mut text = String::new();
    for line in comment.lines() {
        let _ = writeln!(text, "# {line}");
    }
    let moving =
        grains.iter().any(|grain| grain.velocity != DVec2::ZERO || grain.angular_velocity != 0.0);
    text.push_str(if moving { "x,y,radius,vx,vy,omega\n" } else { "x,y,radius\n" });
    for grain in grains {
        let DVec2 { x, y } = grain.position;
        let _ = write!(text, "{x:e},{y:e},{:e}", grain.radius);
        if moving {
            let DVec2 { x, y } = grain.velocity;
            let _ = write!(text, ",{x:e},{y:e},{:e}", grain.angular_velocity);
        }
        text.push('\n');
    }
    text
}
