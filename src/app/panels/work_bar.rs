//! How far long work is.

use egui::Ui;

use crate::app::work::Work;

/// How far work is, and the button that stops it, with its hint.
pub(super) fn show(ui: &mut Ui, work: &Work, [name, stop, hint]: [&str; 3]) {
    ui.horizontal(|ui| {
        // Not where the button was that started it: a second click there is none on this one.
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button(stop).on_hover_text(hint).clicked() {
                work.cancel();
            }
            let bar = ui.add(egui::ProgressBar::new(work.part()).desired_height(14.0));
            bar.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, name)
            });
        });
    });
}
