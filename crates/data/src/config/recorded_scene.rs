//! Checks whether the grains of a recording can become the initial state of the scene `pile`. That scene has its own
//! walls, gravity and mean diameter, which may differ from those of the recorded scene.

use std::path::Path;

use super::facts::scene_facts;
use crate::data::facts_of_recording;
use crate::error::{Error, Result};
use crate::scene::Scene;

/// Properties of the scene `pile` that do not change if the pile starts from the grains of a recorded scene. Each word
/// is the beginning of a property's name in the recording's metadata. Settings are not in the list, because every run
/// has its own settings.
const OF_THE_PILE: &str = "areal_density boundaries gap_tolerance gravity materials mean_diameter motions pairs \
    periodic. physics.";

/// Checks that the scene `pile` can start from the grains in the file or folder `path`. Fails if the grains are from a
/// recording of a scene with periodic borders. Also fails if the recorded scene differs from the pile in a property of
/// [`OF_THE_PILE`], unless the user has named the pile as scene (`is_asked_for`).
pub(super) fn check_starts_pile(path: &Path, pile: &Scene, is_asked_for: bool) -> Result<()> {
    let Some(recorded) = facts_of_recording(path) else { return Ok(()) };
    if recorded.keys().any(|name| name.starts_with("periodic.")) {
        let reason = "is of a scene with periodic borders, but must be of one without, as the pile \
                      that it starts has none: go on with such a run by --restart";
        return Err(Error::file(path, reason));
    }
    if is_asked_for {
        return Ok(());
    }
    let of_pile = scene_facts(pile)?.facts;
    let said_of_pile = |name: &str| of_pile.iter().find(|(known, _)| known == name);
    let lacks = |(name, said): &(&String, &serde_json::Value)| {
        let is_of_scene = OF_THE_PILE.split(' ').any(|beginning| name.starts_with(beginning));
        is_of_scene && said_of_pile(name).is_none_or(|(_, of_pile)| said.as_str() != Some(of_pile))
    };
    let names: Vec<&str> = recorded.iter().filter(lacks).map(|(name, _)| name.as_str()).collect();
    if names.is_empty() {
        return Ok(());
    }
    let reason = format!(
        "is of the scene {}, but must be of a pile, which would not have its {}: start from a saved run (--save) to keep \
         them, or give --scene pile to take the grains alone",
        recorded.get("name").and_then(|name| name.as_str()).unwrap_or("it was recorded in"),
        names.join(", ")
    );
    Err(Error::file(path, reason))
}
