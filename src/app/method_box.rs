//! A list of all methods.

use egui::{ComboBox, Ui};

use crate::solver::{METHODS, SolverSettings};

/// Shows the method, and all others to be chosen from; a model of friction that the chosen one does not take
/// is left out.
pub(super) fn method_box(
    ui: &mut Ui,
    salt: impl std::hash::Hash + std::fmt::Debug,
    solver: &mut SolverSettings,
) {
    let mut method = solver.method;
    let list = ComboBox::from_id_salt(egui::Id::unique(salt)).width(100.0);
    let shown = list.selected_text(method.name()).show_ui(ui, |ui| {
        for info in &METHODS {
            ui.selectable_value(&mut method, info.method, info.name).on_hover_text(format!(
                "{}. Solves {} ({}).",
                info.summary, info.solves, info.source
            ));
        }
    });
    if method != solver.method {
        *solver = solver.by(method);
    }
    let about = || egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Method");
    shown.response.widget_info(about);
}
