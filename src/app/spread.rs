//! Histograms of the moment that is shown, counted on a thread of its own.

use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use super::taken::TakenRun;
use crate::granular::{Histogram, histograms};

/// Least time between two moments that are counted.
const INTERVAL: Duration = Duration::from_millis(200);

/// Histograms of one world, as new as they need be.
#[derive(Default)]
pub(crate) struct Spread {
    /// Those that were counted last.
    pub histograms: Vec<Histogram>,
    /// World and step that they are of, or are being counted of.
    of: Option<(usize, u64)>,
    asked: Option<Instant>,
    coming: Option<Receiver<Vec<Histogram>>>,
}

impl Spread {
    /// Whether a moment is to be counted: it is another one, none is being counted, and the last was a while ago.
    pub(crate) fn wants(&mut self, world: usize, step: u64) -> bool {
        if let Some(counted) = self.coming.as_ref().and_then(|coming| coming.try_recv().ok()) {
            self.histograms = counted;
            self.coming = None;
        }
        let rested = self.asked.is_none_or(|at| at.elapsed() >= INTERVAL);
        self.coming.is_none() && rested && self.of != Some((world, step))
    }

    /// Whether a moment is being counted.
    pub(crate) fn is_coming(&self) -> bool {
        self.coming.is_some()
    }

    /// Counts the moment of a run that is on its way.
    pub(crate) fn count(
        &mut self,
        run: Receiver<TakenRun>,
        of: (usize, u64),
        context: egui::Context,
    ) {
        let (sender, coming) = channel();
        std::thread::spawn(move || {
            if let Ok(TakenRun { taken, .. }) = run.recv() {
                // The panel may have been closed.
                let _ = sender.send(histograms(&taken.simulation.moment()));
                context.request_repaint();
            }
        });
        (self.of, self.asked, self.coming) = (Some(of), Some(Instant::now()), Some(coming));
    }
}
