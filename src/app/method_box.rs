//! A list of all methods.

use egui::{ComboBox, Ui};

use crate::solver::{METHODS, Method};

/// Shows the method, and all others to be chosen from.
pub(super) fn method_box(
    ui: &mut Ui,
    salt: impl std::hash::Hash + std::fmt::Debug,
    method: &mut Method,
) {
    let list = ComboBox::from_id_salt(egui::Id::unique(salt)).width(100.0);
    let shown = list.selected_text(method.name()).show_ui(ui, |ui| {
        for info in &METHODS {
            ui.selectable_value(method, info.method, info.name).on_hover_text(format!(
                "{}. Solves {} ({}).",
                info.summary, info.solves, info.source
            ));
        }
    });
    let about = || egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Method");
    shown.response.widget_info(about);
}
