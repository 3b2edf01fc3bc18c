//! The state of the window and of the run as JSON, for tests that control the program from outside.

use std::collections::BTreeMap;

use super::state::AppState;

/// Returns the state of the window and of the run as JSON. `size` is in pixels, `scale` in pixels per point.
pub(super) fn told(
    state: &AppState,
    size: [u32; 2],
    scale: f32,
    devices: u32,
) -> serde_json::Value {
    let world = state.run.world();
    let last = world.map(|world| world.snapshot.observables).unwrap_or_default();
    let edges = |rect: &egui::Rect| {
        [rect.left(), rect.top(), rect.right(), rect.bottom()].map(|at| at * scale)
    };
    let controls = state.controls.iter().map(|(name, rect)| (name, edges(rect)));
    serde_json::json!({
        "scene": state.run.frame.start.as_ref().map(|start| start.scene.name.as_str()),
        "playing": state.run.frame.playing,
        "loading": state.run.frame.loading.is_some(),
        "step": last.step,
        "time_secs": last.time_secs,
        "slump": last.slump,
        "state_hash": world.map(|world| world.snapshot.state_hash()),
        // Parameters of the next step, as the solver's thread has received them.
        "parameters": world.map(|world| world.controls.settings.parameters),
        "worlds": state.run.frame.worlds.len(),
        // The next values belong to the selected world (simulation).
        "grains": world.map_or(0, |world| world.snapshot.grains.len()),
        // Number of finished runs from other initial states with the settings of the selected world, and number of
        // threads that compute such runs.
        "other_piles": state.ensemble.summary(state.run.selected).map_or(0, |it| it.band.count),
        "other_threads": state.ensemble.threads(),
        // Number of the lesson, counted from 1; 0 outside the lessons.
        "lesson": if state.touring { state.preferences.lesson.at + 1 } else { 0 },
        "steps_per_sec": state.run.frame.steps_per_sec,
        // Number of graphics devices opened so far.
        "devices": devices,
        // Number of frames that the solver's thread has published.
        "frames": state.run.frame.number,
        "window": size,
        // Left, top, right and bottom of each control, pixels of the window.
        "controls": controls.collect::<BTreeMap<_, _>>(),
    })
}
