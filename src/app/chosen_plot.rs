//! Any quantity that steps measure against any other.

use egui::{ComboBox, Ui};
use egui_plot::{AxisHints, GridInput, GridMark, Line, MarkerShape, Plot, PlotPoints, Points};
use serde::{Deserialize, Serialize};

use super::world_curve::WorldCurve;
use crate::data::Observed;
use crate::render::numbers::{decimal, ticks};
use crate::sim::Observables;

/// Points of a curve at the most.
const MOST_POINTS: usize = 2_000;

/// What is plotted against what.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChosenPlot {
    /// Whether it shows.
    pub on: bool,
    /// Names of the quantities along the axes, as tables call them: x and y.
    pub axes: [String; 2],
    /// Whether equal distances along an axis are equal factors.
    pub logarithmic: [bool; 2],
}

impl Default for ChosenPlot {
    fn default() -> Self {
        let axes = ["slump", "kinetic_energy"].map(str::to_owned);
        Self { on: false, axes, logarithmic: [false; 2] }
    }
}

impl ChosenPlot {
    /// The two boxes and switches that choose.
    pub(super) fn choose(&mut self, ui: &mut Ui) {
        for (axis, name) in [(1, "y"), (0, "x")] {
            let shown = ComboBox::from_id_salt(("axis", axis)).width(118.0);
            let chosen = &mut self.axes[axis];
            let list = shown.selected_text(chosen.replace('_', " ")).show_ui(ui, |ui| {
                for observed in Observed::all() {
                    let title = observed.title();
                    let entry = ui.selectable_label(*chosen == observed.name(), title);
                    if entry.on_hover_text(observed.about()).clicked() {
                        *chosen = observed.name().to_owned();
                    }
                }
            });
            let label = format!("Quantity along {name}");
            list.response
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
            ui.toggle_value(&mut self.logarithmic[axis], format!("log {name}"))
                .on_hover_text("Equal distances are equal factors; values up to 0 do not show.");
        }
    }

    /// Its title; nothing where it is of what there is not.
    pub(super) fn title(&self) -> Option<String> {
        let [x, y] = self.axes.each_ref().map(|name| Observed::named(name));
        Some(format!("{} against {}", y?.title(), x?.title()))
    }

    /// The places of rows, as the plot has them.
    fn points<'a>(&self, rows: impl Iterator<Item = &'a Observables>) -> Vec<[f64; 2]> {
        let [Some(x), Some(y)] = self.axes.each_ref().map(|name| Observed::named(name)) else {
            return Vec::new();
        };
        let place = |row: &Observables| {
            let place = [self.scaled(0, x.of(row)?), self.scaled(1, y.of(row)?)];
            place.iter().all(|at| at.is_finite()).then_some(place)
        };
        rows.filter_map(place).collect()
    }

    fn scaled(&self, axis: usize, value: f64) -> f64 {
        if self.logarithmic[axis] { value.log10() } else { value }
    }

    /// Draws it; the moment that is shown has a dot.
    pub(super) fn draw(&self, ui: &mut Ui, worlds: &[WorldCurve], now_secs: f64) {
        let [log_x, log_y] = self.logarithmic;
        Plot::new(("chosen", &self.axes, self.logarithmic))
            .height((ui.available_height() - 2.0).max(40.0))
            .width(ui.available_width() - 10.0)
            .allow_scroll(false)
            .show_background(false)
            .grid_color(ui.visuals().widgets.noninteractive.bg_stroke.color)
            .x_grid_spacer(move |grid| marks(grid, log_x))
            .y_grid_spacer(move |grid| marks(grid, log_y))
            .custom_x_axes(vec![labelled(AxisHints::new_x(), log_x)])
            .custom_y_axes(vec![labelled(AxisHints::new_y().min_thickness(34.0), log_y)])
            .show(ui, |plot| {
                for WorldCurve { name, colour, curve, .. } in worlds {
                    let stride = curve.len().div_ceil(MOST_POINTS).max(1);
                    let points = self.points(curve.rows().step_by(stride));
                    plot.line(Line::new(name.clone(), points).color(*colour).width(1.4));
                    let until_now = |row: &&Observables| row.time_secs <= now_secs;
                    let now = curve.rows().take_while(until_now).last();
                    let place = self.points(now.into_iter());
                    let dot = Points::new(name.clone(), PlotPoints::from(place));
                    plot.points(dot.shape(MarkerShape::Circle).radius(4.0).color(*colour));
                }
            });
    }
}

fn marks(grid: GridInput, log: bool) -> Vec<GridMark> {
    let (values, step) = ticks(grid.bounds.0, grid.bounds.1, 4);
    let step_size = if log { step.max(1.0) } else { step };
    let is_mark = |value: &f64| !log || value.fract() == 0.0;
    values.into_iter().filter(is_mark).map(|value| GridMark { value, step_size }).collect()
}

fn labelled(hints: AxisHints<'static>, log: bool) -> AxisHints<'static> {
    hints.label_spacing(10.0..=18.0).formatter(move |mark, _| {
        if log { format!("1e{}", mark.value) } else { decimal(mark.value, mark.step_size) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn a_curve_goes_through_the_rows_and_leaves_out_what_has_no_logarithm() {
        let row = |(slump, kinetic_energy)| Observables {
            slump,
            kinetic_energy,
            ..Observables::default()
        };
        let rows = [(0.0, 1.0), (0.1, 10.0), (0.2, 0.0)].map(row);
        let mut plot = ChosenPlot::default();
        assert_eq!(plot.points(rows.iter()), [[0.0, 1.0], [0.1, 10.0], [0.2, 0.0]]);
        plot.logarithmic = [false, true];
        assert_eq!(plot.points(rows.iter()), [[0.0, 0.0], [0.1, 1.0]]);
        assert_eq!(plot.title().unwrap(), "kinetic energy (J) against slump");
        // What only some laws have is not there under others.
        plot.axes[1] = "bond_energy".into();
        assert!(plot.points(rows.iter()).is_empty());
        plot.axes[1] = "of another version".into();
        assert!(plot.points(rows.iter()).is_empty() && plot.title().is_none());
    }

    #[test]
    fn every_quantity_that_steps_measure_can_be_chosen() {
        let row = Observables::default().with_further_columns();
        assert!(Observed::all().all(|observed| observed.of(&row).is_some()));
    }
}
