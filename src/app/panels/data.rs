//! Panel: runs that are saved and opened, and the recording as files for other programs.

use egui::{Button, RichText, TextEdit, Ui};

use crate::app::IN_BROWSER;
use crate::app::context::{PanelContext, Request};
use crate::app::data_export::{DataChoices, DataOrder};
use crate::app::time_text::{clock_text, time_field};
use crate::app::work::{Reporter, Work};
use crate::data::{DataSettings, FormatName, check_format};

/// Shortest and longest simulated time between two frames, s.
const EVERY: [f64; 2] = [1e-9, 1e9];

pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let is_ready = context.run.is_ready();
    ui.add_enabled_ui(is_ready, |ui| saved_runs(ui, context));
    if IN_BROWSER {
        let text = "Files are downloads. A saved run, a session or a scene opens where it is dropped on the page.";
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
            "The moment that is shown as a .slump file in the folder: the run goes on from it bit for bit, here or \
                with --restart.",
        );
        context.note_control("Save state", save.rect);
        if save.clicked() {
            context.ask(Request::SaveState);
        }
        let save = ui.button("Save session").on_hover_text(
            "All worlds with their record and the runs before, and the window as it is arranged, as a .session file in \
             the folder (Ctrl S). Opened, it shows this moment; others are computed again when the timeline asks for them.",
        );
        context.note_control("Save session", save.rect);
        if save.clicked() {
            context.ask(Request::SaveSession);
        }
    });
}

/// The field for a file that is opened.
fn open(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let hint = "A file that Save state, Save session, --save or --checkpoint-every wrote. It can be dropped on \
            the window, too.";
        let label = ui.label("Saved").on_hover_text(hint);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let is_named = !context.exports.data.saved_run.trim().is_empty();
            let open = ui.add_enabled(is_named, Button::new("Open"));
            let open = open.on_hover_text("Go on with that run or session, in place of the present one.");
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

/// What is to be exported.
fn order(ui: &mut Ui, context: &mut PanelContext<'_>) {
    stretch(ui, context);
    let choices = &mut context.preferences.data;
    ui.horizontal(|ui| {
        let hint = "Simulated time from one frame of grains and contacts to the next. What is measured of whole \
            piles has a row each step in any case.";
        let label = ui.label("A frame each").on_hover_text(hint);
        let every = time_field(&mut choices.every_secs).range(EVERY[0]..=EVERY[1]).speed(1e-3);
        ui.add_enabled(!choices.each_step, every).labelled_by(label.id);
        ui.toggle_value(&mut choices.each_step, "step").on_hover_text("A frame after each step.");
    });
    egui::Grid::new("formats").num_columns(2).spacing([14.0, 3.0]).show(ui, |ui| {
        for (index, &format) in FormatName::ALL.iter().enumerate() {
            let (name, hint) = words(format);
            let was_wanted = choices.formats.contains(&format);
            let mut is_wanted = was_wanted;
            let is_built = check_format(format);
            let check = egui::Checkbox::new(&mut is_wanted, name);
            // What this build has not may still be taken away.
            let is_enabled = is_built.is_ok() || was_wanted;
            let mut shown = ui.add_enabled(is_enabled, check).on_hover_text(hint);
            if let Err(refusal) = is_built {
                shown = shown.on_disabled_hover_text(refusal.to_string());
            }
            if shown.changed() {
                choices.formats.retain(|other| *other != format);
                choices.formats.extend(is_wanted.then_some(format));
            }
            if index % 2 == 1 {
                ui.end_row();
            }
        }
    });
    ui.horizontal(|ui| {
        let hint = "The recording's own folder, below Folder unless it begins with /.";
        let label = ui.label("Into").on_hover_text(hint);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.checkbox(&mut context.exports.data.overwrite, "Overwrite")
                .on_hover_text("Remove an earlier recording that is there, as --overwrite does.");
            super::see::path_field(ui, &mut choices.folder, label.id);
        });
    });
}

/// What a format is for.
fn words(format: FormatName) -> (&'static str, &'static str) {
    match format {
        FormatName::Parquet => ("Parquet", "For pandas, polars and their like."),
        FormatName::Csv => ("Text (CSV)", "The same tables as text."),
        FormatName::Vtk => ("ParaView", "Files of VTK: open vtk/grains.pvd."),
        FormatName::Ovito => ("OVITO", "Dumps as LAMMPS writes them: open ovito/grains.dump."),
        FormatName::Fields => ("Fields", "Smoothed fields for ParaView: open fields/fields.pvd."),
    }
}

/// Which part of the recording.
fn stretch(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let Some(world) = context.run.world() else { return };
    let (first, last) = (world.recorded_from_secs, world.recorded_secs);
    let now = world.snapshot.observables.time_secs;
    let mut is_all = context.exports.data.stretch.is_none();
    ui.horizontal(|ui| {
        let hint = "From the start of the run to the last step that was taken.";
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
            if here.on_hover_text("The moment that is shown.").clicked() {
                *secs = now;
            }
            ui.end_row();
        }
    });
}

/// The button that starts an export, or how far it is.
fn export(ui: &mut Ui, context: &mut PanelContext<'_>, is_ready: bool) {
    if let Some(export) = &context.exports.data.export {
        return export.show(ui, "Exporting data", "Stop export", "Frames that are written stay.");
    }
    let has_format = !context.preferences.data.formats.is_empty();
    let button = ui.add_enabled(is_ready && has_format, Button::new("Export data"));
    context.note_control("Export data", button.rect);
    let button = button
        .on_hover_text("Computes what was recorded once more, bit for bit, and writes it down; the run may go on \
            meanwhile.")
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
