//! The observables (measured quantities) of a run after each of its steps, as a list whose clones share memory. However
//! long the run is, a copy for the window is cheap.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::sim::Observables;

/// Number of rows (observables after one step) in a chunk. A full chunk is shared between clones and never changes. A
/// clone copies the rows that do not fill a chunk, so with larger chunks a clone takes more time.
const CHUNK: usize = 256;
/// Largest number of rows (observables after one step). A longer curve drops rows, so that the remaining rows have a
/// least spacing in simulated time. 32,768 rows take 6 MB.
const MOST_ROWS: usize = 32_768;

/// Observables of a run in the order of time. A row contains the observables after one step. A short run has a row for
/// every step. In a long run only some steps have a row, with a least spacing in simulated time. The first and the
/// newest row are always present.
///
/// A clone shares all full chunks and copies at most 256 rows.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    chunks: Vec<Arc<Vec<Observables>>>,
    tail: Vec<Observables>,
    least_spacing_secs: f64,
}

/// Relative tolerance of the least spacing of rows (observables after one step) in simulated time: two rows may be
/// closer by this fraction, because times have rounding errors.
const ROUNDING: f64 = 1e-6;

impl Curve {
    /// Number of rows (observables after one step).
    pub fn len(&self) -> usize {
        self.chunks.len() * CHUNK + self.tail.len()
    }

    /// True if the curve has no row (observables after one step).
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Least spacing of rows (observables after one step) in simulated time, s; 0 if every step has a row.
    pub fn least_spacing_secs(&self) -> f64 {
        self.least_spacing_secs
    }

    /// The rows (observables after one step) in order of time.
    pub fn rows(&self) -> impl Iterator<Item = &Observables> {
        self.chunks.iter().flat_map(|chunk| chunk.iter()).chain(&self.tail)
    }

    pub(crate) fn last(&self) -> Option<&Observables> {
        self.tail.last().or_else(|| self.chunks.last().and_then(|chunk| chunk.last()))
    }

    pub(crate) fn push(&mut self, row: Observables) {
        // The newest row is never in a shared chunk. A new row replaces it if it is too close to the row before it.
        let of_chunk = self.chunks.last().and_then(|chunk| chunk.last()).map(|row| row.time_secs);
        let of_tail = self.tail.iter().rev().nth(1).map(|row| row.time_secs);
        let least_secs = (1.0 - ROUNDING) * self.least_spacing_secs;
        match (of_tail.or(of_chunk), self.tail.last_mut()) {
            (Some(before), Some(last)) if last.time_secs - before < least_secs => *last = row,
            _ => self.tail.push(row),
        }
        if self.tail.len() > CHUNK {
            self.chunks.push(Arc::new(self.tail.drain(..CHUNK).collect()));
        }
        self.thin_to(MOST_ROWS);
    }

    /// Drops rows (observables after one step) until at most `most_rows` rows remain, but keeps at least two. To this
    /// end it increases the least spacing of the rows in simulated time, each time at least to twice its value.
    pub(crate) fn thin_to(&mut self, most_rows: usize) {
        while self.len() > most_rows.max(2) {
            let rows: Vec<_> = self.rows().copied().collect();
            let (first, last) = (rows[0].time_secs, rows[rows.len() - 1].time_secs);
            let mean_spacing = (last - first) / (rows.len() - 1) as f64;
            let spacing = (2.0 * self.least_spacing_secs).max(2.0 * mean_spacing);
            let mut thinned = vec![rows[0]];
            for (index, row) in rows.iter().enumerate().skip(1) {
                let kept = thinned[thinned.len() - 1].time_secs;
                let is_apart =
                    row.time_secs > kept && row.time_secs - kept >= (1.0 - ROUNDING) * spacing;
                if is_apart || index == rows.len() - 1 {
                    thinned.push(*row);
                }
            }
            self.least_spacing_secs = spacing;
            self.set(thinned);
        }
    }

    /// Removes the rows (observables after one step) of all steps after step number `step`.
    pub(crate) fn truncate(&mut self, step: u64) {
        if self.last().is_some_and(|row| row.step > step) {
            self.set(self.rows().filter(|row| row.step <= step).copied().collect());
        }
    }

    fn set(&mut self, rows: Vec<Observables>) {
        let full = rows.len().saturating_sub(1) / CHUNK * CHUNK;
        self.chunks = rows[..full].chunks(CHUNK).map(|rows| Arc::new(rows.to_vec())).collect();
        self.tail = rows[full..].to_vec();
    }
}

/// The difference between two versions of a curve (observables after each step), to be sent to another process.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct CurveChange {
    /// Number of rows (observables after one step) at the beginning of the curve that both versions have in common.
    kept: usize,
    rows: Vec<Observables>,
    least_spacing_secs: f64,
}

impl CurveChange {
    pub(super) fn between(before: &Curve, curve: &Curve) -> Self {
        let shared = before.chunks.iter().zip(&curve.chunks);
        let chunks = shared.take_while(|(old, new)| Arc::ptr_eq(old, new)).count();
        let rest = before.rows().skip(chunks * CHUNK).zip(curve.rows().skip(chunks * CHUNK));
        let kept = chunks * CHUNK + rest.take_while(|(old, new)| old == new).count();
        let rows = curve.rows().skip(kept).copied().collect();
        Self { kept, rows, least_spacing_secs: curve.least_spacing_secs }
    }

    pub(super) fn after(self, mut before: Curve) -> Curve {
        let Self { kept, rows, least_spacing_secs } = self;
        let of_tail = kept.checked_sub(before.chunks.len() * CHUNK);
        if let Some(of_tail) = of_tail.filter(|of_tail| of_tail + rows.len() <= CHUNK) {
            before.tail.truncate(of_tail);
            before.tail.extend(rows);
        } else {
            before.set(before.rows().take(kept).copied().chain(rows).collect());
        }
        Curve { least_spacing_secs, ..before }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(steps: u64) -> Curve {
        let mut curve = Curve::default();
        (0..=steps).for_each(|step| curve.push(row(step, 1e-3 * step as f64)));
        curve
    }

    fn row(step: u64, time_secs: f64) -> Observables {
        Observables { step, time_secs, ..Observables::default() }
    }

    #[test]
    fn a_curve_keeps_its_beginning_though_later_steps_are_far_shorter() {
        let mut curve = Curve::default();
        (0..=200).for_each(|step| curve.push(row(step, 5e-3 * step as f64)));
        let short = 2 * MOST_ROWS as u64;
        (1..=short).for_each(|step| curve.push(row(200 + step, 1.0 + 1e-4 * step as f64)));
        let mut handed_out = curve.clone();
        handed_out.thin_to(512);
        for (curve, least) in [(curve, 201), (handed_out, 50)] {
            let early = curve.rows().filter(|row| row.step <= 200).count();
            assert!(early >= least, "{early} of {} rows", curve.len());
            let ends = [curve.rows().next(), curve.last()].map(|row| row.map(|row| row.step));
            assert_eq!(ends, [Some(0), Some(200 + short)]);
        }
    }

    #[test]
    fn steps_that_are_too_short_to_advance_the_time_are_thinned_to_the_ends() {
        let mut curve = Curve::default();
        let time_secs = 1.0;
        assert_eq!(time_secs + 1e-20, time_secs, "the situation");
        (0..1000).for_each(|step| curve.push(row(step, time_secs)));
        curve.thin_to(512);
        assert_eq!(curve.rows().map(|row| row.step).collect::<Vec<_>>(), [0, 999]);
    }

    #[test]
    fn what_is_sent_of_a_thinned_curve_makes_the_same_curve() {
        let mut curve = curve(MOST_ROWS as u64 + 100);
        let mut remote = curve.clone();
        for step in 1..=700 {
            let before = curve.clone();
            curve.push(row(
                MOST_ROWS as u64 + 100 + step,
                1e-3 * (MOST_ROWS as u64 + 100 + step) as f64,
            ));
            remote = CurveChange::between(&before, &curve).after(remote);
        }
        assert!(
            curve.rows().eq(remote.rows()) && curve.least_spacing_secs == remote.least_spacing_secs
        );
    }

    #[test]
    fn a_long_curve_keeps_its_ends_and_its_order() {
        let curve = curve(3 * MOST_ROWS as u64);
        assert!(curve.len() <= MOST_ROWS && curve.len() > MOST_ROWS / 2);
        let steps: Vec<u64> = curve.rows().map(|row| row.step).collect();
        let even = &steps[..steps.len() - 1];
        assert!(even.windows(2).all(|pair| (pair[1] - pair[0]).abs_diff(4) <= 1));
        assert_eq!((steps[0], steps[steps.len() - 1]), (0, 3 * MOST_ROWS as u64));
    }

    #[test]
    fn a_truncated_curve_goes_on_where_it_was_cut() {
        let mut curve = curve(1000);
        let shared = curve.clone();
        curve.truncate(300);
        curve.push(row(301, 0.301));
        let steps: Vec<u64> = curve.rows().map(|row| row.step).collect();
        assert_eq!(steps, (0..=301).collect::<Vec<_>>());
        assert_eq!(shared.len(), 1001, "a copy that was handed out is left alone");
    }
}
