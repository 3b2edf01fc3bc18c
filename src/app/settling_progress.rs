//! Progress of the deposition of a pile, in which the grains fall into a box and come to rest.

use std::sync::Arc;
use std::time::Duration;

use glam::DVec2;

use crate::Instant;
use crate::live::LoadingProgress;
use crate::scene::Settling;
use crate::sim::{GrainView, Snapshot};

/// Number of powers of ten by which the speed of the grains is assumed to decrease while a pile comes to rest. The
/// progress is estimated from the powers of ten that still remain. With a larger value these are a smaller part of the
/// whole, so the estimated finished fraction of the deposition is larger.
const ORDERS_OF_SETTLING: f64 = 3.5;
/// Least time between two displayed pictures of the pile. Users would not notice more frequent pictures.
const INTERVAL: Duration = Duration::from_millis(30);
/// Finished fraction of a deposition at which the window begins to estimate the remaining computing time. At a smaller
/// fraction the estimate would be too inaccurate, because the elapsed time is divided by the fraction.
const PART_THAT_TELLS: f64 = 0.05;

/// Progress of one deposition.
pub(super) struct SettlingProgress {
    begun: Instant,
    /// The newest picture of the pile, and the time at which it was made.
    preview: Option<(Instant, Arc<Snapshot>)>,
    part: f64,
}

impl SettlingProgress {
    /// Returns the progress of a deposition that begins now.
    pub(super) fn new() -> Self {
        Self { begun: Instant::now(), preview: None, part: 0.0 }
    }

    /// Returns the present progress of the deposition, with a text and a picture of the grains.
    pub(super) fn look(&mut self, settling: &Settling<'_>) -> LoadingProgress {
        if self.preview.as_ref().is_none_or(|(at, _)| at.elapsed() >= INTERVAL) {
            self.preview = Some((Instant::now(), Arc::new(settling.simulation.snapshot())));
        }
        self.part = self.part.max(settled_part(settling));
        let grains = settling.simulation.world().grains.len();
        let text = if settling.rains {
            format!("Raining a new pile of {grains}")
        } else {
            let fastest = settling.speed_over_rest;
            format!(
                "A new pile of {grains} comes to rest: fastest grain {fastest:.0} times too fast"
            )
        };
        let text = text + &self.left(self.begun.elapsed().as_secs_f64());
        let preview = self.preview.as_ref().map(|(_, snapshot)| snapshot.clone());
        LoadingProgress { part: self.part as f32, text, preview }
    }

    /// Returns a text with the estimated remaining computing time; empty if it is too early for an estimate.
    fn left(&self, elapsed_secs: f64) -> String {
        if self.part < PART_THAT_TELLS {
            return String::new();
        }
        let left_secs = elapsed_secs * (1.0 - self.part) / self.part;
        if left_secs < 90.0 {
            format!(", about {:.0} s left", left_secs.ceil())
        } else {
            format!(", about {:.0} min left", (left_secs / 60.0).ceil())
        }
    }
}

/// Estimates the finished fraction of a deposition, 0 to 1. If the grains fall together like rain, the estimate assumes
/// that they fall for a quarter of the largest simulated time that the deposition may take, and then come to rest.
/// While they come to rest, their speed is assumed to decrease by [`ORDERS_OF_SETTLING`] powers of ten.
fn settled_part(settling: &Settling) -> f64 {
    let rained = match settling.rains {
        true => (4.0 * settling.time_secs / settling.limit_secs).min(1.0),
        false => 1.0,
    };
    let slowed = 1.0 - settling.speed_over_rest.log10() / ORDERS_OF_SETTLING;
    0.5 * rained * (1.0 + slowed.clamp(0.0, 1.0))
}

/// Returns the lower left and upper right corner of the area with all grains and the base at y = 0, m. The area becomes
/// smaller as the grains fall.
pub(super) fn view_of(snapshot: &Snapshot) -> [DVec2; 2] {
    let diameter = snapshot.surroundings.mean_diameter;
    let (mut lower, mut upper) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for GrainView { position, radius, .. } in &snapshot.grains {
        (lower, upper) = (lower.min(position - radius), upper.max(position + radius));
    }
    [DVec2::new(lower.x, lower.y.min(0.0)) - diameter, upper + diameter]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{NewPile, settle};

    #[test]
    fn a_pile_in_the_making_is_seen_and_its_part_never_falls() {
        let pile = NewPile { grains: 40, box_width_in_diameters: 8.0, ..NewPile::default() };
        let mut making = SettlingProgress::new();
        let (mut parts, mut tops) = (Vec::new(), Vec::new());
        let mut diameter = 0.0;
        settle(&pile, |settling| {
            // The last picture is deleted, so that each call makes a new picture.
            making.preview = None;
            let told = making.look(&settling);
            let preview = told.preview.expect("something to see");
            assert_eq!(preview.grains.len(), 40);
            parts.push(told.part);
            tops.push(view_of(&preview)[1].y);
            diameter = preview.surroundings.mean_diameter;
            let said = if settling.rains { "Raining a new pile of 40" } else { "A new pile of 40" };
            assert!(told.text.starts_with(said), "{}", told.text);
            true
        })
        .expect("a pile");
        assert!(parts.is_sorted() && parts[0] < 0.1 && parts[parts.len() - 1] > 0.9, "{parts:?}");
        // Five rows of eight grains fit into the box, with an error of about one row. The view ends one diameter above
        // the highest grain.
        let rows = 40.0 / 8.0;
        let top = tops[tops.len() - 1] / diameter;
        assert!((rows..rows + 3.0).contains(&top), "the view ends above the pile: {top} d");
        assert!(tops[0] > (top + 3.0) * diameter, "the view shrinks: {tops:?}");
    }

    #[test]
    fn time_is_told_once_something_is_known_of_it() {
        let mut making = SettlingProgress::new();
        making.part = 0.01;
        assert_eq!(making.left(1.0), "");
        making.part = 0.25;
        assert_eq!(making.left(4.0), ", about 12 s left");
        assert_eq!(making.left(100.0), ", about 5 min left");
    }
}
