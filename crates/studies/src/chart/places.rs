//! An axis as plotters wants it: places along it, marks, and the words at them.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use super::Axis;

/// A mark this near, in units of the axis, is the one that is meant.
const NEAR: f64 = 1e-6;

/// Places along an axis (`Scale::place`).
pub(super) struct Places {
    range: Range<f64>,
    marks: Vec<(f64, String)>,
}

impl Places {
    /// Those of an axis.
    pub(super) fn of(axis: &Axis) -> Self {
        let place = |number| axis.scale.place(number);
        let marks = if axis.ticks.is_empty() {
            axis.scale.marks(axis.from, axis.to)
        } else {
            axis.ticks.clone()
        };
        Self {
            range: place(axis.from)..place(axis.to),
            marks: marks.into_iter().map(|(number, words)| (place(number), words)).collect(),
        }
    }
}

impl Ranged for Places {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        // What lies off the axis is drawn at its end.
        from + (f64::from(to - from) * share.clamp(0.0, 1.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.marks.iter().map(|(place, _)| *place).collect()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Places {
    fn format_ext(&self, place: &f64) -> String {
        let span = self.range.end - self.range.start;
        let mark = self.marks.iter().find(|(mark, _)| (mark - place).abs() < NEAR * span);
        mark.map_or(String::new(), |(_, words)| words.clone())
    }
}
