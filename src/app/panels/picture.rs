//! What is seen of the worlds, as a file.

use glam::DVec2;

use super::scene::{columns, shared_style, view};
use crate::app::export::{Export, ScenePicture, stem};
use crate::app::state::AppState;
use crate::render::{Style, panel_size};

/// Saves the worlds as they are seen, in the size of the preferences.
pub(crate) fn save_picture(context: &egui::Context, state: &mut AppState) {
    let style = shared_style(state, context.theme() == egui::Theme::Dark);
    let count = state.frame.worlds.len();
    if count == 0 {
        return;
    }
    let size = state.preferences.picture_size;
    let window = state.controls.get("scene").map_or(DVec2::splat(500.0), |rect| {
        DVec2::new(f64::from(rect.width()), f64::from(rect.height()))
    });
    let (of_one, size_of_one) = if count == 1 {
        (style.clone(), size)
    } else {
        (Style { legend: false, ..style.clone() }, panel_size(&style, size, count, columns(count)))
    };
    let camera = state.camera.for_picture(view(state), &of_one, size_of_one, window);
    let worlds = state.frame.worlds.iter().enumerate().map(|(index, world)| {
        (world.snapshot.clone(), super::compare::numbered(state, index), note(state, index))
    });
    let worlds = worlds.collect();
    let all: Vec<usize> = (0..count).collect();
    let texts = state.texts_of(&all, true);
    let picture = ScenePicture { worlds, columns: columns(count), style, camera, size, texts };
    let (folder, stem) = (state.preferences.folder.clone(), file_stem(state));
    state.exporter.submit(context, Export::Scene(Box::new(picture)), &folder, &stem);
}

/// What came of a world, and below it what came of others: slump, where that tells anything.
fn note(state: &AppState, index: usize) -> String {
    let others = state.others_in_short(index).map_or_else(String::new, |text| format!("\n{text}"));
    super::compare::slump(state, index) + &others
}

/// How the names of saved files begin.
pub(crate) fn file_stem(state: &AppState) -> String {
    let name = state.frame.start.as_ref().map_or("scene", |start| start.name.as_str());
    let settings: Vec<_> = state.frame.worlds.iter().map(|world| world.controls.settings).collect();
    stem(name, &settings, state.frame.time_secs())
}
