//! Panel: histograms of forces, contact directions, contacts per grain and overlaps at the displayed simulated time. A
//! separate thread counts the values.

use std::time::Duration;

use egui::{RichText, Ui};
use egui_plot::{Bar, BarChart};

use crate::Instant;
use crate::app::axes::bare_plot;
use crate::app::theme;
use crate::app::watched_run::{TakenRun, WatchedRun};
use crate::app::work::{Work, outcome_of_ended};
use crate::granular::{Histogram, histograms};

/// Least time between two computations of the histograms. With a shorter time, the histograms of a running simulation
/// change more smoothly, but take more computing time.
const INTERVAL: Duration = Duration::from_millis(200);

/// Histograms of one simulation at the displayed simulated time, or slightly before.
#[derive(Default)]
pub(super) struct Distributions {
    /// Index of the displayed histogram in [`ALL`].
    shown: usize,
    /// The newest histograms.
    histograms: Vec<Histogram>,
    /// Index of the simulation and number of the step for which histograms were last requested.
    of: Option<(usize, u64)>,
    asked: Option<Instant>,
    coming: Option<Work<Vec<Histogram>>>,
}

/// Height of the histogram, points.
const HEIGHT: f32 = 150.0;
/// The histograms that the panel offers: name in files, text of the button, text of the axis.
const ALL: [(&str, &str, &str); 4] = [
    ("normal_force", "forces", "N divided by the mean |N| of contacts with a force"),
    ("contact_orientation", "directions", "direction of normals, degrees from the x axis"),
    ("coordination", "contacts", "contacts of a grain"),
    ("overlap", "overlaps", "log₁₀ of the overlap in mean diameters"),
];

impl Distributions {
    pub(super) fn show(&mut self, ui: &mut Ui, run: &mut WatchedRun) {
        self.count(ui, run);
        ui.horizontal_wrapped(|ui| {
            for (index, (_, button, _)) in ALL.into_iter().enumerate() {
                ui.selectable_value(&mut self.shown, index, button);
            }
        });
        let (name, _, about) = ALL[self.shown];
        let Some(histogram) = self.histograms.iter().find(|found| found.quantity == name) else {
            ui.weak("Nothing is counted yet.");
            return;
        };
        let colour = theme::world_colour(run.selected, ui.visuals().dark_mode);
        let bars = bars(histogram);
        bare_plot(ui, ("histogram", name), HEIGHT)
            .allow_drag(false)
            .allow_zoom(false)
            .include_y(1.0)
            .show(ui, |plot| {
                plot.bar_chart(BarChart::new(name, bars).color(colour));
            });
        let total: u64 = histogram.counts.iter().sum();
        let text =
            format!("{about}: {total} in all. The outer bars include all values beyond them.");
        ui.label(RichText::new(text).small().weak());
    }

    /// Starts to compute the histograms of the displayed state if this state is new, no other computation is running,
    /// and the last one began long enough ago.
    fn count(&mut self, ui: &Ui, run: &mut WatchedRun) {
        let Some(world) = run.world() else { return };
        let of = Some((run.selected, world.snapshot.observables.step));
        if let Some(outcome) = outcome_of_ended(&mut self.coming) {
            self.histograms = outcome.unwrap_or_default();
        }
        let has_rested = self.asked.is_none_or(|at| at.elapsed() >= INTERVAL);
        let is_due = self.coming.is_none() && has_rested && self.of != of;
        if is_due && !run.frame.seeking {
            let taken = run.take(run.selected);
            let of_run = |run: TakenRun| histograms(&run.world.simulation.moment());
            let count =
                move |mut runs: Vec<_>, _: &_| Ok(runs.pop().map(of_run).unwrap_or_default());
            self.coming = Some(Work::start(ui.ctx(), vec![taken], count));
            (self.of, self.asked) = (of, Some(Instant::now()));
        } else if run.frame.playing || self.coming.is_some() {
            ui.ctx().request_repaint_after_secs(0.1);
        }
    }
}

/// Returns one bar per bin of a histogram. The axis of overlaps is logarithmic. A bin without a lower or an upper end
/// is drawn as wide as the first bin that has both ends.
fn bars(histogram: &Histogram) -> Vec<Bar> {
    let Histogram { edges, counts, quantity, .. } = histogram;
    let is_log = *quantity == "overlap";
    let ends: Vec<f64> =
        edges.iter().map(|&edge| if is_log { edge.log10() } else { edge }).collect();
    let mut finite = ends.windows(2).filter(|pair| pair.iter().all(|end| end.is_finite()));
    let usual = finite.next().map_or(1.0, |pair| pair[1] - pair[0]);
    let bar = |(pair, &count): (&[f64], &u64)| {
        let (low, high) = match [pair[0], pair[1]] {
            [low, high] if low.is_finite() && high.is_finite() => (low, high),
            [low, _] if low.is_finite() => (low, low + usual),
            [_, high] if high.is_finite() => (high - usual, high),
            // The histogram has only one bin.
            _ => (0.0, usual),
        };
        Bar::new(0.5 * (low + high), count as f64).width(0.92 * (high - low))
    };
    ends.windows(2).zip(counts).map(bar).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

    #[test]
    fn each_bin_has_a_bar_of_its_count_and_of_finite_width() {
        let mut simulation = built_in("pile").unwrap().simulation().unwrap();
        simulation.take_steps(5).unwrap();
        let all = histograms(&simulation.moment());
        for (name, ..) in ALL {
            let histogram = all.iter().find(|found| found.quantity == name).expect(name);
            let bars = bars(histogram);
            assert_eq!(bars.len(), histogram.counts.len(), "{name}");
            let counted: f64 = bars.iter().map(|bar| bar.value).sum();
            assert_eq!(counted, histogram.counts.iter().sum::<u64>() as f64, "{name}");
            assert!(counted > 0.0, "{name}");
            assert!(
                bars.iter().all(|bar| bar.bar_width > 0.0 && bar.argument.is_finite()),
                "{name}"
            );
        }
        assert_eq!(all.len(), ALL.len(), "a histogram has no button");
    }
}
