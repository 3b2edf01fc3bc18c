//! Preparation of a curve for a plot: it is thinned in time, and split into pieces at values that cannot be drawn.

use egui_plot::{Line, PlotUi};

use crate::live::Curve;
use crate::sim::Observables;

/// Width of the time intervals in which a curve keeps only its smallest and largest value, points. With narrower
/// intervals, dashes have parts shorter than a pixel, which egui does not draw. Wider intervals show fewer details.
const INTERVAL_POINTS: f64 = 3.0;

/// Returns the length of the time intervals in which a curve of the plot keeps only its smallest and largest value, s.
pub(super) fn interval_secs(plot: &PlotUi<'_>) -> f64 {
    INTERVAL_POINTS * plot.transform().dvalue_dpos()[0]
}

/// Returns the first and last of the `points` (time, s, and value), and the smallest and largest value of each time
/// interval.
pub(super) fn thinned(points: &[[f64; 2]], interval_secs: f64) -> Vec<[f64; 2]> {
    let interval = |point: &[f64; 2]| (point[0] / interval_secs).floor();
    // Values that differ less have the same position in egui.
    let by_value =
        |one: &&[f64; 2], other: &&[f64; 2]| (one[1] as f32).total_cmp(&(other[1] as f32));
    let mut kept: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    for near in points.chunk_by(|one, other| interval(one) == interval(other)) {
        // In an interval without changes, both are the first point.
        let extremes = [near.iter().min_by(by_value), near.iter().rev().max_by(by_value)];
        let mut extremes: Vec<_> = extremes.into_iter().flatten().copied().collect();
        extremes.sort_by(|one, other| one[0].total_cmp(&other[0]));
        kept.extend(extremes);
    }
    kept.extend(points.last());
    kept.dedup();
    kept
}

/// Returns a solid line through the `points`. By default, egui_plot merges points that are less than a pixel apart into
/// a band without horizontal width, whose steep parts look dashed.
pub(super) fn solid(name: impl Into<String>, points: Vec<[f64; 2]>) -> Line<'static> {
    Line::new(name, points).allow_band(false)
}

/// Returns the curve of `value` against time up to `until_secs`, in pieces of points (time, s, and value). Values that
/// are not finite, such as the logarithm of 0, leave a gap between two pieces, unless the gap is at most
/// `interval_secs` long. The pieces are [`thinned`].
pub(super) fn pieces(
    curve: &Curve,
    until_secs: f64,
    interval_secs: f64,
    value: impl Fn(&Observables) -> f64,
) -> Vec<Vec<[f64; 2]>> {
    let rows = curve.rows().take_while(|row| row.time_secs <= until_secs);
    let points: Vec<[f64; 2]> = rows.map(|row| [row.time_secs, value(row)]).collect();
    let is_finite = |point: &[f64; 2]| point[1].is_finite();
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    for run in points.chunk_by(|one, other| is_finite(one) == is_finite(other)) {
        if !is_finite(&run[0]) {
            continue;
        }
        let is_seen = |piece: &&mut Vec<[f64; 2]>| {
            piece.last().is_some_and(|end| run[0][0] - end[0] <= interval_secs)
        };
        match pieces.last_mut().filter(is_seen) {
            Some(piece) => piece.extend(thinned(run, interval_secs)),
            None => pieces.push(thinned(run, interval_secs)),
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_keeps_its_beginning_and_extremes_where_later_steps_are_far_shorter() {
        let mut curve = Curve::default();
        let mut push = |step: u64, time_secs: f64, slump: f64| {
            curve.push(Observables { step, time_secs, slump, ..Observables::default() });
        };
        (0..=200).for_each(|step| push(step, 5e-3 * step as f64, step as f64));
        let peak = |step: u64| if step == 4321 { 1e3 } else { 0.0 };
        (1..=10_000).for_each(|step| push(200 + step, 1.0 + 1e-4 * step as f64, peak(step)));
        let pieces = pieces(&curve, f64::INFINITY, 5e-3, |row| row.slump);
        let early = pieces[0].iter().filter(|point| point[0] <= 1.0).count();
        assert!(early > 150, "{early} points of the first second");
        assert!(pieces.len() == 1 && pieces[0].len() <= 2 * 401);
        assert!(pieces[0].iter().any(|point| point[1] == 1e3), "the peak");
        let ends = [pieces[0][0][0], pieces[0][pieces[0].len() - 1][0]];
        assert_eq!(ends, [0.0, 2.0]);
    }

    #[test]
    fn a_zero_leaves_a_gap_on_a_logarithmic_axis() {
        let mut curve = Curve::default();
        for (step, slump) in [0.0, 1.0, 10.0, 0.0, 0.0, 100.0].into_iter().enumerate() {
            let time_secs = step as f64;
            curve.push(Observables {
                step: step as u64,
                time_secs,
                slump,
                ..Observables::default()
            });
        }
        let pieces = pieces(&curve, f64::INFINITY, 1.0, |row| row.slump.log10());
        assert_eq!(pieces, [vec![[1.0, 0.0], [2.0, 1.0]], vec![[5.0, 2.0]]]);
    }

    #[test]
    fn a_steep_solid_line_is_as_wide_as_a_flat_one() {
        let context = egui::Context::default();
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(
                egui::Pos2::ZERO,
                egui::vec2(200.0, 100.0),
            )),
            ..egui::RawInput::default()
        };
        let points: Vec<[f64; 2]> = (0..=4_000).map(|at| [f64::from(at), 0.5]).collect();
        let mut output = context.run_ui(input, |ui| {
            egui_plot::Plot::new("plot").show(ui, |plot| plot.line(solid("", points.clone())));
        });
        output.textures_delta.clear();
        let mut shapes = output.shapes.iter();
        let all = points.len();
        let has_all = shapes.any(|clipped| match &clipped.shape {
            egui::Shape::Path(path) => path.points.len() == all,
            _ => false,
        });
        assert!(has_all, "a band has a width only along y");
    }

    #[test]
    fn a_curve_without_changes_has_one_point_in_each_interval() {
        let points: Vec<[f64; 2]> = (0..=100).map(|at| [0.25 * f64::from(at), 7.0]).collect();
        let expected: Vec<[f64; 2]> = (0..=25).map(|at| [f64::from(at), 7.0]).collect();
        assert_eq!(thinned(&points, 1.0), expected);
        assert!(thinned(&[], 1.0).is_empty());
    }
}
