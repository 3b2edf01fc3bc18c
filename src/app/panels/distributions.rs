//! Panel: how forces, directions, contacts and overlaps are distributed at the moment that is shown, counted on a thread
//! of its own.

use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use egui::{RichText, Ui};
use egui_plot::{Bar, BarChart};

use crate::app::opening::TakenRun;
use crate::app::plots::still_plot;
use crate::app::state::AppState;
use crate::app::theme;
use crate::granular::{Histogram, histograms};

/// Least time between two moments that are counted.
const INTERVAL: Duration = Duration::from_millis(200);

/// Histograms of one world, as new as they need be.
#[derive(Default)]
pub(crate) struct Distributions {
    /// Those that were counted last.
    histograms: Vec<Histogram>,
    /// World and step that they are of, or are being counted of.
    of: Option<(usize, u64)>,
    asked: Option<Instant>,
    coming: Option<Receiver<Vec<Histogram>>>,
}

/// Height of the plot, points.
const HEIGHT: f32 = 150.0;
/// Histograms by their names in files, with their buttons and axes.
const ALL: [(&str, &str, &str); 4] = [
    ("normal_force", "forces", "N over the mean |N| of contacts that bear a force"),
    ("contact_orientation", "directions", "direction of normals, degrees from the x axis"),
    ("coordination", "contacts", "contacts of a grain"),
    ("overlap", "overlaps", "log₁₀ of the overlap in mean diameters"),
];

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    count(ui, state);
    ui.horizontal_wrapped(|ui| {
        for (name, button, _) in ALL {
            let chosen = state.preferences.histogram == name;
            if ui.selectable_label(chosen, button).clicked() {
                state.preferences.histogram = name.into();
            }
        }
    });
    let name = state.preferences.histogram.as_str();
    let Some(histogram) =
        state.distributions.histograms.iter().find(|found| found.quantity == name)
    else {
        ui.weak("Nothing is counted yet.");
        return;
    };
    let about = ALL.iter().find(|(known, ..)| *known == name).map_or("", |(.., about)| about);
    let colour = theme::world_colour(state.selected, ui.visuals().dark_mode);
    let bars = bars(histogram);
    still_plot(ui, ("histogram", name), HEIGHT).include_y(1.0).show(ui, |plot| {
        plot.bar_chart(BarChart::new(name, bars).color(colour));
    });
    let total: u64 = histogram.counts.iter().sum();
    let text = format!("{about}: {total} in all. Outer bars hold what lies beyond.");
    ui.label(RichText::new(text).small().weak());
}

/// Has the moment that is shown counted, where it is another one, none is being counted, and the last was a while ago.
fn count(ui: &Ui, state: &mut AppState) {
    let Some(world) = state.world() else { return };
    let of = Some((state.selected, world.snapshot.observables.step));
    let counted = &mut state.distributions;
    if let Some(histograms) = counted.coming.as_ref().and_then(|coming| coming.try_recv().ok()) {
        (counted.histograms, counted.coming) = (histograms, None);
    }
    let has_rested = counted.asked.is_none_or(|at| at.elapsed() >= INTERVAL);
    let is_due = counted.coming.is_none() && has_rested && counted.of != of;
    if is_due && !state.frame.seeking {
        let (run, context) = (state.take_run(), ui.ctx().clone());
        let (sender, coming) = channel();
        std::thread::spawn(move || {
            if let Ok(TakenRun { world, .. }) = run.recv() {
                // The panel may have been closed.
                let _ = sender.send(histograms(&world.simulation.moment()));
                context.request_repaint();
            }
        });
        let counted = &mut state.distributions;
        (counted.of, counted.asked, counted.coming) = (of, Some(Instant::now()), Some(coming));
    } else if state.frame.playing || state.distributions.coming.is_some() {
        ui.ctx().request_repaint_after_secs(0.1);
    }
}

/// A bar a bin. Where the first edge is 0 and the others rise by factors, the axis is logarithmic; what is below
/// its first decade is left out, which is where nothing can be told from rounding.
fn bars(histogram: &Histogram) -> Vec<Bar> {
    let Histogram { edges, counts, quantity, .. } = histogram;
    let is_log = *quantity == "overlap";
    let place = |edge: f64| if is_log { edge.log10() } else { edge };
    let ends: Vec<f64> = edges.iter().map(|&edge| place(edge)).collect();
    let finite: Vec<f64> = ends.iter().copied().filter(|end| end.is_finite()).collect();
    let usual = match finite[..] {
        [first, second, ..] => second - first,
        _ => 1.0,
    };
    let bars = ends.windows(2).zip(counts).map(|(pair, &count)| {
        let (low, high) = match (pair[0].is_finite(), pair[1].is_finite()) {
            (true, true) => (pair[0], pair[1]),
            (true, false) => (pair[0], pair[0] + usual),
            (false, true) => (pair[1] - usual, pair[1]),
            (false, false) => (0.0, usual),
        };
        Bar::new(0.5 * (low + high), count as f64).width(0.92 * (high - low))
    });
    bars.collect()
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
