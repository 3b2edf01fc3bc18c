//! Panel: the drawing style of the scene, and the saving of pictures and films.

use std::path::PathBuf;

use clap::ValueEnum;
use egui::{ComboBox, RichText, ThemePreference, Ui};
use glam::DVec2;

use super::scene_style::{columns, own_style, shared_style};
use crate::app::IN_BROWSER;
use crate::app::context::{PanelContext, Request};
use crate::app::film::{FilmFormat, FilmOrder};
use crate::app::preferences::Preferences;
use crate::app::scene_picture::{PicturedWorld, ScenePicture};
use crate::app::work::Work;
use crate::film::{Animation, VIDEO_RATES_HZ, check_ffmpeg};
use crate::render::{ColourBy, Style, panel_size};
use crate::study::png::write_png;

/// Duration of the GIF that the button "GIF of 5 s" saves, s.
const SHORT_GIF_SECS: f64 = 5.0;
/// Simulated time that a film shows, for hover texts. The browser version has no control for the interval.
const RECORD: &str = if IN_BROWSER {
    "the record of all worlds"
} else {
    "the record of all worlds, or the interval that is chosen below,"
};
/// Zoom factor of the user interface for a presentation.
const PRESENTATION_ZOOM: f32 = 2.0;
/// Zoom factor of the user interface above which the window counts as presenting. It is between the usual zoom factor,
/// 1, and [`PRESENTATION_ZOOM`].
const LEAST_PRESENTATION_ZOOM: f32 = 1.5;

/// Makes text and controls twice as large for a projector, or restores their usual size. In the large size, pages and
/// plots are hidden, because they have no space beside the scene.
pub(crate) fn present(context: &egui::Context, preferences: &mut Preferences) {
    let begins = !presents(context);
    context.set_zoom_factor(if begins { PRESENTATION_ZOOM } else { 1.0 });
    preferences.plots = !begins;
    preferences.page = preferences.page.filter(|_| !begins);
}

fn presents(context: &egui::Context) -> bool {
    context.zoom_factor() > LEAST_PRESENTATION_ZOOM
}

pub(super) fn look(ui: &mut Ui, preferences: &mut Preferences) {
    let style = &mut preferences.style;
    ui.horizontal(|ui| {
        let label = ui.label("Colour by");
        let name = |by: ColourBy| by.to_possible_value().map(|value| value.get_name().to_owned());
        let present = name(style.colour_by).unwrap_or_default();
        let list = ComboBox::from_id_salt("colour by").width(130.0).selected_text(present);
        let shown = list.show_ui(ui, |ui| {
            for &by in ColourBy::value_variants() {
                ui.selectable_value(&mut style.colour_by, by, name(by).unwrap_or_default());
            }
        });
        shown.response.labelled_by(label.id);
    });
    egui::Grid::new("see").num_columns(2).spacing([14.0, 3.0]).show(ui, |ui| {
        ui.checkbox(&mut style.show_forces, "Force chains")
            .on_hover_text("A link a contact, as wide as |N|; blue pushes, orange pulls.");
        ui.checkbox(&mut style.show_velocities, "Velocities").on_hover_text("An arrow per grain.");
        ui.end_row();
        ui.checkbox(&mut style.outlines, "Outlines").on_hover_text("A dark rim around each grain.");
        ui.checkbox(&mut style.angles, "Angles").on_hover_text("A mark that turns with its grain.");
        ui.end_row();
        ui.checkbox(&mut style.scale_bar, "Scale bar").on_hover_text("A bar of round length.");
        ui.checkbox(&mut style.legend, "Legend").on_hover_text("What colours and links mean.");
        ui.end_row();
        ui.checkbox(&mut style.show_motions, "Motions").on_hover_text(
            "Arrows on walls and fixed discs that move. An arrow with two heads is a force that drives them.",
        );
        ui.checkbox(&mut preferences.gravity, "Gravity").on_hover_text(
            "An arrow in the direction of gravity. It is always shown if gravity does not point straight down.",
        );
        ui.end_row();
    });
    ui.horizontal(|ui| {
        for (preference, name) in [
            (ThemePreference::Light, "Light"),
            (ThemePreference::Dark, "Dark"),
            (ThemePreference::System, "System"),
        ] {
            ui.selectable_value(&mut preferences.theme, preference, name);
        }
        ui.separator();
        let present_label = ui.selectable_label(presents(ui.ctx()), "Present");
        if present_label
            .on_hover_text("Text and controls twice as large, for a projector (P)")
            .clicked()
        {
            present(ui.ctx(), preferences);
        }
    });
}

/// Shows the controls that save pictures and films.
pub(super) fn pictures(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let label = ui.label("Picture").on_hover_text("Size of saved pictures, pixels.");
        for side in 0..2 {
            if side == 1 {
                ui.label("×");
            }
            let size = &mut context.preferences.picture_size[side];
            let value = egui::DragValue::new(size).range(16..=16_384).speed(8.0);
            ui.add(value).labelled_by(label.id);
        }
        ui.label(RichText::new("px").weak());
        let save = ui.button("Save PNG").on_hover_text(
            "Saves the scene with all worlds as it is visible (S). The file contains the command that makes it.",
        );
        if save.clicked() {
            save_picture(ui.ctx(), context);
        }
    });
    films(ui, context);
}

/// Shows the buttons that save the recorded run as a video or an animation.
fn films(ui: &mut Ui, context: &mut PanelContext<'_>) {
    if let Some((format, work)) = &context.exports.film {
        let name = format.name();
        let hint = format!("No {name} is saved; the computed run stays in the window.");
        return work.show(ui, &format!("Making a {name}"), &format!("Stop {name}"), &hint);
    }
    ui.horizontal(|ui| {
        let hint = "Pictures per second of a video or a GIF. A GIF has at most 50.";
        let label = ui.label("Film").on_hover_text(hint);
        let [least, most] = VIDEO_RATES_HZ;
        let rate = egui::DragValue::new(&mut context.preferences.video_rate_hz).range(least..=most);
        ui.add(rate.max_decimals(3).suffix(" /s")).labelled_by(label.id);
        let of = if context.preferences.full_speed { "before max" } else { "of the window" };
        let pace = format!("at the pace {of}, {}×", context.preferences.speed);
        ui.label(RichText::new(pace).weak());
    });
    ui.horizontal(|ui| {
        let video_hint = format!("Saves {RECORD} as MP4. The run can continue meanwhile.");
        let gif_hint = format!(
            "Saves {RECORD} as a GIF, which all slides and web pages can show: 256 colours per picture, and larger \
             files."
        );
        let short_hint = format!("Saves {RECORD} as a GIF that lasts 5 s.");
        let recorded_from = context.run.world().map_or(0.0, |world| world.recorded_from_secs);
        let whole = [recorded_from, context.run.frame.recorded_secs()];
        let [from, until] = context.exports.data.stretch.unwrap_or(whole);
        let speed = context.preferences.speed;
        let short_speed = (until - from) / SHORT_GIF_SECS;
        let missing = check_ffmpeg("given").err();
        let films = [
            (FilmFormat::Video, "Save video", missing, speed, video_hint),
            (FilmFormat::Gif, "Save GIF", None, speed, gif_hint),
            (FilmFormat::Gif, "GIF of 5 s", None, short_speed, short_hint),
        ];
        // The browser version has no ffmpeg, so it offers no video.
        for (format, name, missing, speed, hint) in films.into_iter().skip(usize::from(IN_BROWSER)) {
            let is_possible = context.run.is_ready() && missing.is_none() && speed > 0.0;
            let save = ui.add_enabled(is_possible, egui::Button::new(name)).on_hover_text(hint);
            context.note_control(name, save.rect);
            if save.clicked() {
                save_film(ui.ctx(), context, format, speed);
            }
            if let Some(missing) = missing {
                save.on_disabled_hover_text(missing.to_string());
            }
        }
    });
}

/// Shows the field for the folder of all saved files.
pub(super) fn folder(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let folder = &mut context.preferences.folder;
    let row = ui.horizontal(|ui| {
        let whole = std::path::absolute(&*folder).unwrap_or_else(|_| folder.clone());
        let hint = format!("Folder of saved files: {}", whole.display());
        let label = ui.label("Folder").on_hover_text(hint);
        let right = ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let is_asked = choose_button(ui, "Choose a folder");
            path_field(ui, folder, label.id);
            is_asked
        });
        right.inner
    });
    if row.inner {
        context.ask(Request::ChooseFolder);
    }
}

/// Shows a button that opens a dialog for a file or folder. Returns true if the user clicked it.
pub(super) fn choose_button(ui: &mut Ui, name: &str) -> bool {
    let button = ui.button("…").on_hover_text(name);
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    button.clicked()
}

/// Shows a field for the path of a folder.
pub(super) fn path_field(ui: &mut Ui, folder: &mut PathBuf, label: egui::Id) {
    let mut typed = folder.display().to_string();
    let edit = egui::TextEdit::singleline(&mut typed).desired_width(f32::INFINITY);
    if ui.add(edit).labelled_by(label).changed() {
        *folder = typed.into();
    }
}

/// Saves a picture of the displayed simulations, in the size that the preferences state.
pub(crate) fn save_picture(gui: &egui::Context, context: &mut PanelContext<'_>) {
    if context.run.frame.worlds.is_empty() {
        return;
    }
    let style = shared_style(context.run, context.preferences, gui.theme() == egui::Theme::Dark);
    let picture = scene_picture(context, style, context.preferences.picture_size, true);
    context.write(gui, context.run.file_stem(), "png", move |path, printers| {
        write_png(path, &picture.draw(printers.renderer()?)?, &picture.texts)
    });
}

/// Saves the recorded run of all simulations as a film, within the time interval that the user chose for exports.
fn save_film(gui: &egui::Context, context: &mut PanelContext<'_>, format: FilmFormat, speed: f64) {
    // The scale of the colours is not fixed here, because it must fit all pictures of the film.
    let style = own_style(context.preferences, gui.theme() == egui::Theme::Dark);
    let (size, rate_hz) = (context.preferences.picture_size, context.preferences.video_rate_hz);
    let (size, rate_hz) = match format {
        FilmFormat::Video => (size.map(|side| side.next_multiple_of(2)), rate_hz),
        FilmFormat::Gif => (size, Animation::nearest_rate_hz(rate_hz)),
    };
    let order = FilmOrder {
        format,
        picture: scene_picture(context, style, size, false),
        slumps: context.run.slumps(),
        rate_hz,
        speed,
        stretch: context.exports.data.stretch,
        folder: context.preferences.folder.clone(),
        stem: context.run.file_stem(),
    };
    let runs = context.run.take_all();
    let work = Work::start(gui, runs, move |runs, reporter| order.make(&runs, reporter));
    context.exports.film = Some((format, work));
}

/// Returns the description of a picture of the displayed simulations. There must be at least one simulation.
fn scene_picture(
    context: &PanelContext<'_>,
    style: Style,
    size: [u32; 2],
    is_of_a_moment: bool,
) -> ScenePicture {
    let count = context.run.frame.worlds.len();
    let window = context.controls.get("scene").map_or(DVec2::splat(500.0), |rect| {
        DVec2::new(f64::from(rect.width()), f64::from(rect.height()))
    });
    let (of_one, size_of_one) = if count == 1 {
        (style.clone(), size)
    } else {
        (Style { legend: false, ..style.clone() }, panel_size(&style, size, count, columns(count)))
    };
    let camera = context.camera.for_picture(context.run.view(), &of_one, size_of_one, window);
    let worlds = context.run.frame.worlds.iter().enumerate().map(|(index, world)| {
        // The text below a simulation: its slump, and in the next line the mean slump of other initial states.
        let others = context.ensemble.said(&context.run.frame, index);
        let others = others.map_or(String::new(), |text| format!("\n{text}"));
        PicturedWorld {
            snapshot: world.snapshot.clone(),
            settings: world.controls.settings,
            note: context.run.slump_text(index) + &others,
        }
    });
    let (worlds, texts) = (worlds.collect(), context.run.texts(is_of_a_moment));
    ScenePicture { worlds, columns: columns(count), style, camera, size, texts }
}
