//! The rows and the verdict of a budget.

use serde::Serialize;

use super::causes::{Cause, Share, Variant, short};
use crate::chart::Rgb;

/// The effect of one change on the value.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CauseRow {
    /// The part of the budget that the cause belongs to.
    pub share: Share,
    pub cause: &'static str,
    /// The change.
    pub changed: String,
    /// Number of initial states for which both runs gave a value.
    pub starts: usize,
    /// The effect on the value, and its interval; `None` if it was not run, or if a run failed.
    pub adds: Option<[f64; 3]>,
    /// Fraction of the variant's steps that were unsolved.
    pub unsolved: f64,
    /// Time relative to the unchanged scene. It differs between machines and repetitions.
    pub cost: Option<f64>,
    /// The reason if there is no value.
    pub failure: Option<String>,
    #[serde(skip)]
    pub(super) kind: Cause,
}

/// Verdict on a result: whether it is due to the grains and their law and not to the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trust {
    /// Neither the method nor the choice of a law changes it by more than the user allows.
    Yes,
    /// The method does not change it by more. The choice of a law does, or its effect is not yet known.
    Mostly,
    /// The method changes it by more.
    No,
    /// The intervals are too wide to decide.
    NotKnownYet,
}

impl Trust {
    /// The words of the verdict.
    pub fn words(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::Mostly => "mostly",
            Self::No => "no",
            Self::NotKnownYet => "not known yet",
        }
    }
}

/// The budget of one quantity.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct QuantityBudget {
    pub quantity: String,
    pub unit: &'static str,
    /// Requested half-width of the intervals, which is also the largest acceptable effect of the method.
    pub within: f64,
    /// Number of initial states of the unchanged scene.
    pub starts: usize,
    /// Mean over initial states, and its interval; `None` if a run failed.
    pub value: Option<[f64; 3]>,
    /// Standard deviation between initial states.
    pub spread: Option<f64>,
    /// The value of the scene that the user requested, if it is not one of the initial states.
    pub itself: Option<f64>,
    /// The effect of Δt → 0, if it is known.
    pub limit_adds: Option<[f64; 3]>,
    /// For Δt, Δt/2 and Δt/4: time relative to Δt, and difference to Δt/8.
    pub left_by_time_step: Vec<(f64, [f64; 3])>,
    pub trust: Trust,
    pub answer: String,
    pub causes: Vec<CauseRow>,
}

/// The answer of a budget on one quantity, for a window.
#[derive(Clone, Debug)]
pub struct BudgetAnswer {
    /// Verdict.
    pub trust: Trust,
    /// Name of the quantity.
    pub quantity: String,
    /// Largest acceptable effect of the method, in the unit of the quantity.
    pub within: f64,
    /// Largest acceptable effect of the method in words, with its unit.
    pub within_text: String,
    /// Everything that was found, in words.
    pub text: String,
    /// The known effects, the largest first.
    pub effects: Vec<BudgetEffect>,
}

/// The effect of one change on a quantity.
#[derive(Clone, Debug)]
pub struct BudgetEffect {
    /// The part of the budget that it belongs to: grains, law or method.
    pub share: &'static str,
    /// Colour of this part in pictures.
    pub colour: Rgb,
    /// The change.
    pub changed: String,
    /// Effect and both ends of its interval, in the unit of the quantity.
    pub adds: [f64; 3],
}

/// Everything in a budget except its runs.
pub(super) struct Design<'a> {
    pub variants: &'a [Variant],
    /// True if initial states are piles with different seeds; false if grains are displaced by 1e-9 d.
    pub has_seeds: bool,
    pub time_step_secs: f64,
}

/// Largest spread between minimally displaced initial states that does not count as chaos, as a fraction of the
/// requested width.
pub(super) const SMOOTH: f64 = 0.01;

pub(super) fn is_inside([_, low, high]: [f64; 3], within: f64) -> bool {
    low >= -within && high <= within
}

fn is_outside([_, low, high]: [f64; 3], within: f64) -> bool {
    low > within || high < -within
}

pub(super) fn is_seen([_, low, high]: [f64; 3]) -> bool {
    low > 0.0 || high < 0.0
}

impl QuantityBudget {
    /// The causes with a known effect, the largest first.
    pub(super) fn effects(&self) -> Vec<(&CauseRow, [f64; 3])> {
        let mut rows: Vec<(&CauseRow, [f64; 3])> =
            self.causes.iter().filter_map(|row| Some((row, row.adds?))).collect();
        rows.sort_by(|(_, one), (_, other)| other[0].abs().total_cmp(&one[0].abs()));
        rows
    }

    /// The answer, for a window.
    pub(super) fn for_window(&self) -> BudgetAnswer {
        let effect = |(row, adds): (&CauseRow, [f64; 3])| BudgetEffect {
            share: row.share.word(),
            colour: row.share.colour(),
            changed: row.changed.clone(),
            adds,
        };
        BudgetAnswer {
            trust: self.trust,
            quantity: self.quantity.clone(),
            within: self.within,
            within_text: self.with_unit(&short(self.within)),
            text: self.answer.clone(),
            effects: self.effects().into_iter().map(effect).collect(),
        }
    }

    /// The smallest time step with a value, or else the smallest time step.
    pub(super) fn smallest_step(&self) -> Option<&CauseRow> {
        let of_steps = || self.causes.iter().filter(|row| row.kind == Cause::TimeStep);
        of_steps().rfind(|row| row.adds.is_some()).or_else(|| of_steps().next_back())
    }

    /// True if a cause in this part of the budget changes the value by more than allowed.
    pub(super) fn is_any_outside(&self, share: Share) -> bool {
        let of_share = self.causes.iter().filter(|row| row.share == share);
        of_share.filter_map(|row| row.adds).any(|ends| is_outside(ends, self.within))
    }

    /// A number in words, with the quantity's unit.
    pub(super) fn with_unit(&self, number: &str) -> String {
        if self.unit.is_empty() { number.to_owned() } else { format!("{number} {}", self.unit) }
    }

    pub(super) fn judged(&self) -> Trust {
        let of = |share: Share| self.causes.iter().filter(move |row| row.share == share);
        // The smallest time step shows most of the whole effect. A scene that fails under another law gives no doubt
        // about its own law.
        let smallest = self.smallest_step().map(|row| &row.changed);
        let counts = |row: &&CauseRow| match row.kind {
            Cause::TimeStep => Some(&row.changed) == smallest,
            kind => kind.share() == Share::Method || row.adds.is_some() || row.cost.is_none(),
        };
        let is_all_inside = |share| {
            of(share)
                .filter(counts)
                .all(|row| row.adds.is_some_and(|ends| is_inside(ends, self.within)))
        };
        match (is_all_inside(Share::Method), is_all_inside(Share::Law)) {
            _ if self.is_any_outside(Share::Method) => Trust::No,
            (true, true) => Trust::Yes,
            (true, false) => Trust::Mostly,
            _ => Trust::NotKnownYet,
        }
    }
}
