//! The plot of mean slump against the time step Δt, as in Fig. 5a of Abramian & Staron (2020). For each run that the
//! user has started it has one point: the mean over runs with the same settings from other initial states or, if such
//! runs cannot be computed, the slump of the run itself.

use egui::{Color32, RichText, Ui, WidgetText};
use egui_plot::{HoverPosition, Line, Points};

use super::axes::{plot_with_axes, with_room};
use super::ensemble::Released;
use super::glossary::explained;
use super::plots::LEAST_SLUMP;
use super::theme;
use super::titles::title_among;
use crate::number::millis_text;
use crate::sim::Settings;

/// Title of the plot.
const TITLE: &str = "slump against Δt";
/// Hover text of the title, which explains a point of the plot.
const HINT: &str = "One point per released pile: the mean slump of its other piles at the end of the scene, with \
                    its 95 % interval.";
/// Hover text of the title if no other piles are computed.
const HINT_OF_ONE: &str = "One point per released pile: its slump at the end of the scene. No other piles are computed \
                           here, so the points have no interval.";
/// The Δt axis extends at least from the first to the second of these values of the time step Δt, ms.
const LEAST_MILLIS: [f64; 2] = [0.1, 10.0];
/// Half of the width of the horizontal caps of an error bar, in decades of the logarithmic Δt axis.
const CAP: f64 = 0.03;

/// A point of the plot: the slump at the end of the scene, as a mean over other initial states or of a single pile.
#[derive(Clone, Debug, PartialEq)]
struct FigurePoint {
    time_step_secs: f64,
    mean: f64,
    /// Half-width of the 95 % confidence interval of the mean slump; `None` for one or two piles.
    half: Option<f64>,
    /// Number of initial states over which the mean is taken.
    count: usize,
}

impl FigurePoint {
    /// Returns the coordinate of the point along the Δt axis: the decimal logarithm of the time step Δt in
    /// milliseconds.
    fn decades(&self) -> f64 {
        (1e3 * self.time_step_secs).log10()
    }

    /// Returns the text that is shown when the mouse is at the point. `series` is the name of its curve.
    fn text(&self, series: &str) -> String {
        let Self { time_step_secs, mean, half, count } = self;
        let head = format!("{series}, Δt {}\nslump {mean:.3}", millis_text(*time_step_secs));
        match half {
            Some(half) => format!("{head} ± {half:.3}\n{count} piles"),
            None if *count > 1 => format!("{head}\n{count} piles"),
            None => format!("{head}\none pile"),
        }
    }
}

/// A curve of the plot: points whose settings differ only in Δt.
#[derive(Clone, Debug)]
struct FigureSeries {
    name: String,
    bond: f64,
    colour: Color32,
    points: Vec<FigurePoint>,
}

/// The plot of mean slump against Δt.
#[derive(Clone, Debug)]
pub(super) struct TimeStepFigure(Vec<FigureSeries>);

impl TimeStepFigure {
    /// Makes the plot from `released`, the results of all runs that the user has started. `None` if there is no
    /// result yet. `worlds` are the settings of the visible simulations. If several simulations are
    /// visible, their curves are the first ones, in the order of the simulations. If only one of them has the settings
    /// of a curve (apart from Δt), the curve has the colour of this simulation. A single simulation has no effect on
    /// the colours.
    pub(super) fn new<'a>(
        released: impl Iterator<Item = &'a Released>,
        worlds: &[Settings],
        is_dark: bool,
    ) -> Option<Self> {
        let mut all: Vec<(Settings, Vec<FigurePoint>)> = Vec::new();
        for (settings, band) in released {
            let (Some(&mean), Some(&high)) = (band.means.last(), band.highs.last()) else {
                continue;
            };
            let time_step_secs = settings.parameters.time_step_secs;
            let half = Some(high - mean).filter(|half| half.is_finite());
            let point = FigurePoint { time_step_secs, mean, half, count: band.count };
            let shared = without_time_step(settings);
            match all.iter_mut().find(|(own, _)| *own == shared) {
                Some((_, points)) => points.push(point),
                None => all.push((shared, vec![point])),
            }
        }
        let worlds = if worlds.len() > 1 { worlds } else { &[] };
        let place = |shared| worlds.iter().position(|world| without_time_step(world) == shared);
        all.sort_by_key(|(settings, _)| place(*settings).unwrap_or(worlds.len()));
        let settings_of_all: Vec<_> = all.iter().map(|(settings, _)| *settings).collect();
        let mut next = worlds.len();
        let series = all.into_iter().enumerate().map(|(index, (settings, mut points))| {
            points.sort_by(|one, other| one.time_step_secs.total_cmp(&other.time_step_secs));
            let bond = settings.parameters.bond;
            let name = match settings_of_all.len() {
                1 => format!("Bond {bond}"),
                _ => title_among(&settings_of_all, index),
            };
            let is_of_series = |world: &Settings| without_time_step(world) == settings;
            let is_alone = worlds.iter().filter(|world| is_of_series(world)).count() == 1;
            let own = place(settings).filter(|_| is_alone);
            let colour = theme::world_colour(own.unwrap_or(next), is_dark);
            next += usize::from(own.is_none());
            FigureSeries { name, bond, colour, points }
        });
        let series: Vec<_> = series.collect();
        (!series.is_empty()).then_some(Self(series))
    }

    /// Draws the plot into the remaining space. `head` adds controls to the title line of the plot.
    pub(super) fn draw(&self, ui: &mut Ui, head: impl FnOnce(&mut Ui)) {
        let points = || self.0.iter().flat_map(|series| &series.points);
        ui.horizontal(|ui| {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                head(ui);
                let in_rows = egui::Layout::left_to_right(egui::Align::Center).with_main_wrap(true);
                ui.with_layout(in_rows, |ui| {
                    let hint =
                        if points().any(|it| it.half.is_some()) { HINT } else { HINT_OF_ONE };
                    let title = ui.label(RichText::new(TITLE).small()).on_hover_text(hint);
                    explained(title, TITLE);
                    for series in &self.0 {
                        // The no-break space keeps the square next to the name.
                        let square = RichText::new("■\u{a0}").small().color(series.colour);
                        let name = RichText::new(&series.name).small();
                        ui.label(WidgetText::concat(ui, [square, name]));
                    }
                });
            });
        });
        let along = points().map(FigurePoint::decades).chain(LEAST_MILLIS.map(f64::log10));
        let ends = points().flat_map(|point| {
            let half = point.half.unwrap_or(0.0);
            [point.mean - half, point.mean + half]
        });
        let least = [with_room(along, true), with_room(ends.chain([0.0, LEAST_SLUMP]), false)];
        let plot = plot_with_axes(ui, "slump against time step", [true, false], " ms", least);
        plot.label_formatter(hover_text).show(ui, |plot| {
            for FigureSeries { name, colour, points, .. } in &self.0 {
                let line = |ends: Vec<[f64; 2]>| Line::new("", ends).allow_hover(false);
                let means = points.iter().map(|point| [point.decades(), point.mean]).collect();
                plot.line(line(means).color(colour.gamma_multiply(0.4)).width(1.0));
                for point in points {
                    let (x, mean) = (point.decades(), point.mean);
                    if let Some(half) = point.half {
                        let (low, high) = (mean - half, mean + half);
                        let cap = |y: f64| vec![[x - CAP, y], [x + CAP, y]];
                        for ends in [vec![[x, low], [x, high]], cap(low), cap(high)] {
                            plot.line(line(ends).color(*colour).width(1.4));
                        }
                    }
                    let dot = Points::new(point.text(name), vec![[x, mean]]);
                    plot.points(dot.radius(3.5).color(*colour));
                }
            }
        });
    }

    /// Returns the points of the plot of mean slump against Δt as CSV text.
    pub(super) fn table(&self) -> String {
        let mut text = "series,bond,time_step,slump,half_interval,piles\n".to_owned();
        for FigureSeries { name, bond, points, .. } in &self.0 {
            for FigurePoint { time_step_secs, mean, half, count } in points {
                let half = half.map_or(String::new(), |half| half.to_string());
                text += &format!("\"{name}\",{bond},{time_step_secs},{mean},{half},{count}\n");
            }
        }
        text
    }
}

/// Returns the settings with the default Δt, which are equal for all points of a curve.
pub(super) fn without_time_step(settings: &Settings) -> Settings {
    settings.over(Settings::default().parameters.time_step_secs)
}

/// Returns the text that is shown when the mouse is at a point: the name of the point, which contains all its values.
fn hover_text(position: &HoverPosition<'_>) -> Option<String> {
    match position {
        HoverPosition::NearDataPoint { plot_name, .. } => Some((*plot_name).to_owned()),
        HoverPosition::Elsewhere { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::app::ensemble::Band;

    fn released(settings: Settings, mean: f64, half: f64) -> Released {
        let band = Band {
            means: vec![0.0, mean],
            highs: vec![0.0, mean + half],
            count: 8,
            ..Band::default()
        };
        (settings, Arc::new(band))
    }

    #[test]
    fn a_bond_is_a_series_in_the_order_of_time_steps() {
        let base = Settings::default();
        let all = [
            released(base.with_bond(20.0).over(5e-3), 0.25, 0.0625),
            released(base.with_bond(100.0).over(5e-3), 0.125, 0.03125),
            released(base.with_bond(20.0).over(1e-4), 0.5, 0.125),
        ];
        let figure = TimeStepFigure::new(all.iter(), &[], false).unwrap();
        let names: Vec<_> = figure.0.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["Bond 20", "Bond 100"]);
        assert_ne!(figure.0[0].colour, figure.0[1].colour);
        let expected = "series,bond,time_step,slump,half_interval,piles\n\
                        \"Bond 20\",20,0.0001,0.5,0.125,8\n\
                        \"Bond 20\",20,0.005,0.25,0.0625,8\n\
                        \"Bond 100\",100,0.005,0.125,0.03125,8\n";
        assert_eq!(figure.table(), expected);
        let alone = TimeStepFigure::new(all[..1].iter(), &[], false).unwrap();
        assert_eq!(alone.0[0].name, "Bond 20");
        assert!(TimeStepFigure::new(std::iter::empty(), &[], false).is_none());
    }

    #[test]
    fn names_of_curves_are_complete_next_to_buttons_in_a_narrow_window() {
        let base = Settings::default().over(5e-3);
        let all = [20.0, 50.0, 100.0].map(|bond| released(base.with_bond(bond), 0.25, 0.0625));
        let figure = TimeStepFigure::new(all.iter(), &[], false).unwrap();
        let context = egui::Context::default();
        let (mut buttons_left, mut painted) = (0.0, Vec::new());
        for _ in 0..3 {
            let size = egui::vec2(270.0, 150.0);
            let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size));
            let input = egui::RawInput { screen_rect, ..egui::RawInput::default() };
            let mut output = context.run_ui(input, |ui| {
                figure.draw(ui, |ui| buttons_left = ui.small_button("PNG CSV Clear").rect.left());
            });
            output.textures_delta.clear();
            painted = output.shapes;
        }
        for bond in ["Bond 20", "Bond 50", "Bond 100"] {
            let text = painted.iter().find_map(|clipped| match &clipped.shape {
                egui::Shape::Text(text) if text.galley.text().ends_with(bond) => Some(text),
                _ => None,
            });
            let text = text.expect(bond);
            assert!(!text.galley.elided && text.visual_bounding_rect().right() <= buttons_left);
        }
    }

    #[test]
    fn a_single_pile_has_a_point_without_interval() {
        let settings = Settings::default().with_bond(20.0).over(5e-3);
        let band = Band::of(&[(0, &vec![[0.5, 0.25]])]);
        let figure = TimeStepFigure::new([(settings, Arc::new(band))].iter(), &[], false).unwrap();
        assert!(figure.table().ends_with("\"Bond 20\",20,0.005,0.25,,1\n"), "{}", figure.table());
        let text = figure.0[0].points[0].text("Bond 20");
        assert_eq!(text, "Bond 20, Δt 5 ms\nslump 0.250\none pile");
    }

    #[test]
    fn a_series_has_the_colour_of_the_world_that_it_shows_if_worlds_are_compared() {
        let base = Settings::default().over(5e-3);
        let [weak, strong] = [20.0, 100.0].map(|bond| base.with_bond(bond));
        let all = [strong, weak].map(|settings| released(settings, 0.25, 0.0625));
        let colours = |worlds: &[Settings]| {
            let figure = TimeStepFigure::new(all.iter(), worlds, false).unwrap();
            figure.0.iter().map(|series| series.colour).collect::<Vec<_>>()
        };
        let of = |index| theme::world_colour(index, false);
        assert_eq!(colours(&[weak, strong]), [of(0), of(1)], "in the order of the worlds");
        assert_eq!(colours(&[strong, weak]), [of(0), of(1)], "in the order of the worlds");
        assert_eq!(colours(&[weak, weak.over(1e-4)]), [of(2), of(3)], "two worlds in one series");
        assert_eq!(colours(&[weak]), [of(0), of(1)], "one world");
    }
}
