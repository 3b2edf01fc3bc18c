//! Panel: saves and opens runs, and exports recordings for other programs.

use egui::{Button, RichText, TextEdit, Ui};

use crate::app::IN_BROWSER;
use crate::app::context::{PanelContext, Request};
use crate::app::data_export::{DataChoices, DataOrder};
use crate::app::number_text::{clock_text, time_field};
use crate::app::work::{Reporter, Work};
use crate::data::{DataSettings, FormatName};

pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let is_ready = context.run.is_ready();
    ui.add_enabled_ui(is_ready, |ui| saved_runs(ui, context));
    if IN_BROWSER {
        let text = "Files are downloads. To open a scene, discs, a saved run or a session, drop the file on this page. \
                    Videos and recordings for other programs need the program.";
        ui.label(RichText::new(text).weak());
        return;
    }
    ui.add_enabled_ui(is_ready, |ui| open(ui, context));
    ui.separator();
    ui.add_enabled_ui(is_ready && context.exports.data.export.is_none(), |ui| order(ui, context));
    export(ui, context, is_ready);
    if let Some(told) = &context.exports.data.told {
        ui.label(RichText::new(&told.text).small().color(told.colour(ui)));
    }
}

fn saved_runs(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let save = ui.button("Save state").on_hover_text(
            "Saves the visible moment as a .slump file. The run can continue from it, bit for bit, here or with \
             --restart.",
        );
        context.note_control("Save state", save.rect);
        if save.clicked() {
            context.ask(Request::SaveState);
        }
        let save = ui.button("Save session").on_hover_text(
            "Saves all worlds with their record, the earlier runs and the arrangement of the window as a .session \
             file (Ctrl S). A session opens at this moment; other moments are computed again when \
             the timeline asks for them.",
        );
        context.note_control("Save session", save.rect);
        if save.clicked() {
            context.ask(Request::SaveSession);
        }
    });
}

/// Shows the field for the path of a saved run or session to be opened.
fn open(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let hint = "A file from Save state, Save session, --save or --checkpoint-every. You can also drop it on \
                    the window.";
        let label = ui.label("Saved").on_hover_text(hint);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if super::see::choose_button(ui, "Choose a file") {
                context.ask(Request::ChooseFile);
            }
            let is_named = !context.exports.data.saved_run.trim().is_empty();
            let open = ui.add_enabled(is_named, Button::new("Open"));
            let open = open.on_hover_text("Continue that run or session in place of the present one.");
            let edit = TextEdit::singleline(&mut context.exports.data.saved_run)
                .desired_width(f32::INFINITY)
                .hint_text("file.slump, file.session");
            let typed = ui.add(edit).labelled_by(label.id);
            let is_entered =
                typed.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if is_named && (open.clicked() || is_entered) {
                let path = context.exports.data.saved_run.trim().to_owned();
                context.ask(Request::LoadSaved(path.into()));
            }
        });
    });
}

/// Shows the controls for an export of grains and contacts to files: first and last simulated time, simulated time
/// between two exported states (frames), file formats and folder.
fn order(ui: &mut Ui, context: &mut PanelContext<'_>) {
    stretch(ui, context);
    let choices = &mut context.preferences.data;
    ui.horizontal(|ui| {
        let hint = "Simulated time between two frames of grains and contacts. Measures of whole piles always have \
                    one row per step.";
        let label = ui.label("A frame every").on_hover_text(hint);
        // The limits are far outside useful values.
        let every = time_field(&mut choices.every_secs).range(1e-9..=1e9).speed(1e-3);
        ui.add_enabled(!choices.each_step, every).labelled_by(label.id);
        ui.toggle_value(&mut choices.each_step, "step").on_hover_text("A frame after each step.");
    });
    ui.horizontal_wrapped(|ui| {
        for &format in FormatName::ALL {
            let mut is_wanted = choices.formats.contains(&format);
            let check = ui.checkbox(&mut is_wanted, format.name());
            if check.on_hover_text(format.hint()).changed() {
                choices.formats.retain(|other| *other != format);
                choices.formats.extend(is_wanted.then_some(format));
            }
        }
    });
    ui.horizontal(|ui| {
        let hint = "The recording's own folder. It is in Folder unless it begins with /.";
        let label = ui.label("Into").on_hover_text(hint);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.checkbox(&mut context.exports.data.overwrite, "Overwrite")
                .on_hover_text("Remove an earlier recording in this folder, as --overwrite does.");
            super::see::path_field(ui, &mut choices.folder, label.id);
        });
    });
}

/// Shows the controls for the first and last simulated time of the part of the run that is exported.
fn stretch(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let Some(world) = context.run.world() else { return };
    let (first, last) = (world.recorded_from_secs, world.recorded_secs);
    let now = world.snapshot.observables.time_secs;
    let mut is_all = context.exports.data.stretch.is_none();
    ui.horizontal(|ui| {
        let hint = "From the beginning of the run to its last step.";
        if ui.checkbox(&mut is_all, "The whole recording").on_hover_text(hint).changed() {
            context.exports.data.stretch = (!is_all).then_some([first, last]);
        }
        ui.label(
            RichText::new(format!("{} … {}", clock_text(first), clock_text(last))).small().weak(),
        );
    });
    let Some(stretch) = &mut context.exports.data.stretch else { return };
    egui::Grid::new("stretch").num_columns(3).spacing([8.0, 3.0]).show(ui, |ui| {
        for (secs, name) in stretch.iter_mut().zip(["From", "To"]) {
            let label = ui.label(name);
            let value = time_field(secs).range(first..=last);
            let speed = 1e-3 * (last - first).max(1e-6);
            ui.add(value.speed(speed)).labelled_by(label.id);
            let here = ui.button("here");
            let said = format!("{name} here");
            here.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &said));
            if here.on_hover_text("The visible moment.").clicked() {
                *secs = now;
            }
            ui.end_row();
        }
    });
}

/// Shows the button that exports the grains and contacts of the run to files or, during an export, its progress.
fn export(ui: &mut Ui, context: &mut PanelContext<'_>, is_ready: bool) {
    if let Some(export) = &context.exports.data.export {
        return export.show(
            ui,
            "Exporting data",
            "Stop export",
            "Keeps the frames that are already written.",
        );
    }
    let has_format = !context.preferences.data.formats.is_empty();
    let button = ui.add_enabled(is_ready && has_format, Button::new("Export data"));
    context.note_control("Export data", button.rect);
    let button = button
        .on_hover_text(
            "Computes the recorded run again, bit for bit, and writes it. The run can continue \
                        meanwhile.",
        )
        .on_disabled_hover_text("Choose a format first.");
    if !button.clicked() {
        return;
    }
    let DataChoices { folder, every_secs, each_step, formats } = context.preferences.data.clone();
    let every_secs = (!each_step).then_some(every_secs);
    let order = DataOrder {
        folder: context.preferences.folder.join(folder),
        overwrite: std::mem::take(&mut context.exports.data.overwrite),
        settings: DataSettings { folder: None, every_secs, formats },
        stretch: context.exports.data.stretch,
    };
    let run = context.run.take(context.run.selected);
    let write = move |mut runs: Vec<_>, reporter: &Reporter| order.write(runs.pop(), reporter);
    context.exports.data.told = None;
    context.exports.data.export = Some(Work::start(ui.ctx(), vec![run], write));
}
