//! Panel: what the mouse changes with Shift held.

use egui::{DragValue, RichText, Ui};

use crate::app::state::AppState;
use crate::sim::NEW_GRAIN_DIAMETERS;

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    ui.label(
        RichText::new(
            "With Shift held, a click on the ground puts a grain there, a click on a grain takes it out, and a drag draws \
             a wall along while time passes. All of it is in the record and in sessions, and in no command line or link.",
        )
        .small()
        .weak(),
    );
    ui.horizontal(|ui| {
        let hint = "Diameter of a grain that Shift click puts in, in mean diameters.";
        let label = ui.label("New grain").on_hover_text(hint);
        let value = DragValue::new(&mut state.preferences.new_grain_diameters);
        let value = value
            .range(NEW_GRAIN_DIAMETERS[0]..=NEW_GRAIN_DIAMETERS[1])
            .speed(0.01)
            .max_decimals(3);
        ui.add(value.suffix(" d")).labelled_by(label.id);
    });
}
