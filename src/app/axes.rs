//! Axes of plots: their smallest range and the numbers along them.

use egui::Ui;
use egui_plot::{AxisHints, GridInput, GridMark, Plot};

use crate::render::numbers::{decimal, ticks};

/// Smallest length of a linear axis, as a fraction of the largest absolute value on it. With a shorter axis, rounding
/// errors look like changes, and the labels of a constant quantity have many digits.
const LEAST_SPAN: f64 = 0.02;
/// Smallest length of a logarithmic axis, in decades. An axis of two decades always contains at least two powers of
/// ten, at which it has labels.
const LEAST_DECADES: f64 = 2.0;
/// Returns an empty plot in the common style of all plots in the window, with round numbers along its x axis. The mouse
/// wheel does not zoom the plot.
pub(super) fn bare_plot<'a>(
    ui: &Ui,
    id: impl std::hash::Hash + std::fmt::Debug,
    height: f32,
) -> Plot<'a> {
    Plot::new(id)
        .height(height)
        .allow_scroll(false)
        // egui would fill the background on the processor, pixel by pixel; `fill` uses the GPU.
        .show_background(false)
        .grid_color(ui.visuals().widgets.noninteractive.bg_stroke.color)
        .x_grid_spacer(|grid| round_marks(grid, false))
        .custom_x_axes(vec![axis(AxisHints::new_x(), false, "")])
}

/// Returns an empty plot with numbered axes; the x axis has the unit `x_unit`. `log` states which axes (x, y) are
/// logarithmic. Along a logarithmic axis with a unit, the labels are decimal numbers; without a unit they are powers of
/// ten. If `x_unit` is " ms" and the x axis is linear, the x values are times in seconds, and their labels are in
/// milliseconds. The plot fills the remaining height, and shows at least the ranges `ends`: the lowest and highest x,
/// then the lowest and highest y.
pub(super) fn plot_with_axes<'a>(
    ui: &Ui,
    id: impl std::hash::Hash + std::fmt::Debug,
    log: [bool; 2],
    x_unit: &'static str,
    ends: [[f64; 2]; 2],
) -> Plot<'a> {
    let y_hints = AxisHints::new_y().min_thickness(34.0);
    let [[left, right], [bottom, top]] = ends;
    bare_plot(ui, id, (ui.available_height() - 2.0).max(40.0))
        // Half of the last label is to the right of the plot.
        .width(ui.available_width() - 10.0)
        .x_grid_spacer(move |grid| round_marks(grid, log[0]))
        .y_grid_spacer(move |grid| round_marks(grid, log[1]))
        .custom_x_axes(vec![axis(AxisHints::new_x(), log[0], x_unit)])
        .custom_y_axes(vec![axis(y_hints, log[1], "")])
        .include_x(left)
        .include_x(right)
        .include_y(bottom)
        .include_y(top)
}

/// Returns the lowest and highest value of an axis that contains all finite `values`, which are decimal logarithms if
/// `log` is true. A logarithmic axis is at least [`LEAST_DECADES`] long, a linear axis at least [`LEAST_SPAN`] times
/// the largest absolute value. A shorter range is widened equally at both ends, so that the axis does not show rounding
/// errors.
pub(super) fn with_room(values: impl Iterator<Item = f64>, log: bool) -> [f64; 2] {
    let ends = values.filter(|value| value.is_finite()).map(|value| [value, value]);
    let ends = ends.reduce(|ends, [value, _]| [ends[0].min(value), ends[1].max(value)]);
    let [low, high] = ends.unwrap_or_default();
    let most = low.abs().max(high.abs());
    let least = if log { LEAST_DECADES } else { LEAST_SPAN * most };
    let room = (0.5 * (least - (high - low))).max(0.0);
    [low - room, high + room]
}

/// Returns two to five marks along an axis, at round numbers or, if `log` is true, at whole powers of ten.
fn round_marks(grid: GridInput, log: bool) -> Vec<GridMark> {
    let (low, high) = grid.bounds;
    if log {
        let marks = |step: i64| {
            let ends = [low, high].map(|end| end / step as f64);
            ends[0].ceil() as i64..=ends[1].floor() as i64
        };
        let widest = (((high - low) / 3.0).ceil() as i64).max(1);
        let step = (1..=widest).rev().find(|&step| marks(step).count() > 1).unwrap_or(1);
        let step_size = step as f64;
        let mark = |count: i64| GridMark { value: count as f64 * step_size, step_size };
        return marks(step).map(mark).collect();
    }
    let (values, step_size) = ticks(low, high, 4);
    values.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// Sets the labels of an axis: numbers with the unit `unit`, or powers of ten along a logarithmic axis without a unit.
fn axis(hints: AxisHints<'static>, log: bool, unit: &'static str) -> AxisHints<'static> {
    hints.label_spacing(10.0..=18.0).formatter(move |mark, _| {
        if log && unit.is_empty() {
            return format!("1e{}", mark.value).replace('-', "−");
        }
        if log {
            return format!("{}{unit}", 10f64.powf(mark.value));
        }
        let factor = if unit == " ms" { 1e3 } else { 1.0 };
        format!("{}{unit}", decimal(factor * mark.value, factor * mark.step_size))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_never_has_one_number_alone() {
        let grid = |low, high| GridInput { bounds: (low, high), base_step_size: 1.0 };
        for place in 0..400 {
            let low = -7.3 + 0.037 * f64::from(place);
            for span in [1e-6, 1e-3, 0.4, 1.0, 2.0, 3.2, 5.7, 6.1, 9.0, 1e3] {
                let count = round_marks(grid(low, low + span), false).len();
                assert!((2..=5).contains(&count), "{low} and {span} more: {count}");
                if span >= LEAST_DECADES {
                    let count = round_marks(grid(low, low + span), true).len();
                    assert!((2..=5).contains(&count), "1e{low} and {span} decades more: {count}");
                }
            }
        }
    }
}
