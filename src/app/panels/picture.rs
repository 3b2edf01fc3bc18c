//! What is seen of the worlds, as a file.

use glam::DVec2;

use super::scene::{columns, shared_style, view};
use crate::app::export::{Export, ScenePicture, stem};
use crate::app::film_export::FilmOrder;
use crate::app::film_file::FilmFormat;
use crate::app::state::AppState;
use crate::render::{Style, panel_size};

/// Saves the worlds as they are seen, in the size of the preferences.
pub(crate) fn save_picture(context: &egui::Context, state: &mut AppState) {
    if state.frame.worlds.is_empty() {
        return;
    }
    let style = shared_style(state, context.theme() == egui::Theme::Dark);
    let picture = scene_picture(state, style, state.preferences.picture_size, true);
    let (folder, stem) = (state.preferences.folder.clone(), file_stem(state));
    state.exporter.submit(context, Export::Scene(Box::new(picture)), &folder, &stem);
}

/// Saves what was recorded of the worlds as moving pictures, or the stretch of it that data would be exported of.
pub(crate) fn save_film(context: &egui::Context, state: &mut AppState, format: FilmFormat) {
    if state.frame.worlds.is_empty() || state.film.is_some() {
        return;
    }
    // Its scales are those of all its pictures.
    let style = super::scene::own_style(state, context.theme() == egui::Theme::Dark);
    let size = format.size(state.preferences.picture_size);
    let order = FilmOrder {
        format,
        picture: scene_picture(state, style, size, false),
        slumps: state.slumps(),
        rate_hz: format.nearest_rate_hz(state.preferences.video_rate_hz),
        speed: state.preferences.video_speed,
        stretch: state.data.stretch,
        folder: state.preferences.folder.clone(),
        stem: file_stem(state),
    };
    let runs = (0..state.frame.worlds.len()).map(|world| state.take_run_of(world)).collect();
    state.film = Some((format, order.start(context, runs)));
}

/// What is seen of the worlds, of which there is one at least.
fn scene_picture(
    state: &AppState,
    style: Style,
    size: [u32; 2],
    is_of_a_moment: bool,
) -> ScenePicture {
    let count = state.frame.worlds.len();
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
    let texts = state.texts_of(&all, is_of_a_moment);
    ScenePicture { worlds, columns: columns(count), style, camera, size, texts }
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
