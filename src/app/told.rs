//! The state of window and run as JSON, for tests that drive it from outside.

use std::collections::BTreeMap;

use super::state::AppState;

/// State of the window as JSON. `size` is in pixels, `scale` in pixels per point.
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
        // Parameters of the next step, as the solver thread has them.
        "parameters": world.map(|world| world.controls.settings.parameters),
        "worlds": state.run.frame.worlds.len(),
        // Values of the selected world.
        "grains": world.map_or(0, |world| world.snapshot.grains.len()),
        // Other piles of the selected world that have finished, and the threads that compute them.
        "other_piles": state.ensemble.summary(state.run.selected).map_or(0, |it| it.band.count),
        "other_threads": state.ensemble.threads(),
        // Number of the lesson, from 1; 0 outside the lessons.
        "lesson": if state.touring { state.preferences.lesson.at + 1 } else { 0 },
        "steps_per_sec": state.run.frame.steps_per_sec,
        // Number of graphics devices opened so far.
        "devices": devices,
        // Number of frames that the solver thread has published.
        "frames": state.run.frame.number,
        "window": size,
        // Left, top, right and bottom, pixels of the window.
        "controls": controls.collect::<BTreeMap<_, _>>(),
    })
}
