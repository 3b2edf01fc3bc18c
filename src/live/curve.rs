//! The observables of a run in a form that can be shared with a window at any length.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::sim::Observables;

/// Rows of a chunk, which is shared and never changes.
const CHUNK: usize = 256;
/// Largest number of rows. A longer curve drops every second row. 32,768 rows are 6 MB.
const MOST_ROWS: usize = 32_768;

/// Observables in order of time: of every step, or of every n-th step in a long run.
///
/// A clone shares all full chunks and copies fewer than 256 rows.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    chunks: Vec<Arc<Vec<Observables>>>,
    tail: Vec<Observables>,
    stride: u64,
}

impl Default for Curve {
    fn default() -> Self {
        Self { chunks: Vec::new(), tail: Vec::new(), stride: 1 }
    }
}

impl Curve {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.chunks.len() * CHUNK + self.tail.len()
    }

    /// True if there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Only steps whose number is a multiple of the stride are kept.
    pub fn stride(&self) -> u64 {
        self.stride
    }

    /// The rows, first to last.
    pub fn rows(&self) -> impl Iterator<Item = &Observables> {
        self.chunks.iter().flat_map(|chunk| chunk.iter()).chain(&self.tail)
    }

    pub(crate) fn last(&self) -> Option<&Observables> {
        self.tail.last().or_else(|| self.chunks.last().and_then(|chunk| chunk.last()))
    }

    pub(crate) fn push(&mut self, row: Observables) {
        if !row.step.is_multiple_of(self.stride) {
            return;
        }
        self.tail.push(row);
        if self.tail.len() == CHUNK {
            self.chunks.push(Arc::new(std::mem::take(&mut self.tail)));
        }
        self.thin_to(MOST_ROWS);
    }

    /// Drops every second row until at most `most_rows` remain.
    pub(super) fn thin_to(&mut self, most_rows: usize) {
        while self.len() > most_rows.max(1) {
            self.stride *= 2;
            let stride = self.stride;
            self.keep(|row| row.step.is_multiple_of(stride));
        }
    }

    /// Removes all steps after `step`.
    pub(crate) fn truncate(&mut self, step: u64) {
        if self.last().is_some_and(|row| row.step > step) {
            self.keep(|row| row.step <= step);
        }
    }

    fn keep(&mut self, kept: impl Fn(&Observables) -> bool) {
        self.set(self.rows().filter(|row| kept(row)).copied().collect());
    }

    fn set(&mut self, rows: Vec<Observables>) {
        let full = rows.len() / CHUNK * CHUNK;
        self.chunks = rows[..full].chunks(CHUNK).map(|rows| Arc::new(rows.to_vec())).collect();
        self.tail = rows[full..].to_vec();
    }
}

/// The difference between two curves, for sending.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct CurveChange {
    /// Number of first rows that both curves share.
    kept: usize,
    rows: Vec<Observables>,
    stride: u64,
}

impl CurveChange {
    pub(super) fn between(before: &Curve, curve: &Curve) -> Self {
        let shared = before.chunks.iter().zip(&curve.chunks);
        let chunks = shared.take_while(|(old, new)| Arc::ptr_eq(old, new)).count();
        let rest = before.rows().skip(chunks * CHUNK).zip(curve.rows().skip(chunks * CHUNK));
        let kept = chunks * CHUNK + rest.take_while(|(old, new)| old == new).count();
        let rows = curve.rows().skip(kept).copied().collect();
        Self { kept, rows, stride: curve.stride }
    }

    pub(super) fn after(self, mut before: Curve) -> Curve {
        let Self { kept, rows, stride } = self;
        if before.len() == kept && before.tail.len() + rows.len() < CHUNK {
            before.tail.extend(rows);
        } else {
            before.set(before.rows().take(kept).copied().chain(rows).collect());
        }
        Curve { stride, ..before }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(steps: u64) -> Curve {
        let mut curve = Curve::default();
        for step in 0..=steps {
            curve.push(Observables { step, ..Observables::default() });
        }
        curve
    }

    #[test]
    fn a_long_curve_keeps_its_ends_and_its_order() {
        let curve = curve(3 * MOST_ROWS as u64);
        assert!(curve.len() <= MOST_ROWS && curve.len() > MOST_ROWS / 2);
        assert_eq!(curve.stride(), 4);
        let steps: Vec<u64> = curve.rows().map(|row| row.step).collect();
        assert!(steps.windows(2).all(|pair| pair[1] == pair[0] + 4));
        assert_eq!(steps[0], 0);
    }

    #[test]
    fn a_truncated_curve_goes_on_where_it_was_cut() {
        let mut curve = curve(1000);
        let shared = curve.clone();
        curve.truncate(300);
        curve.push(Observables { step: 301, ..Observables::default() });
        let steps: Vec<u64> = curve.rows().map(|row| row.step).collect();
        assert_eq!(steps, (0..=301).collect::<Vec<_>>());
        assert_eq!(shared.len(), 1001, "a copy that was handed out is left alone");
    }
}
