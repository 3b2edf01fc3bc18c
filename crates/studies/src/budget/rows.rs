//! Defines the rows and the verdict of an error budget.

use serde::Serialize;

use super::causes::{Cause, Share, Variant, short};
use crate::chart::Rgb;

/// A row of an error budget: the effect of one change of the scene on a quantity.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CauseRow {
    /// Group of the cause of this effect: grains, contact law or numerical method.
    pub share: Share,
    pub cause: &'static str,
    /// Description of the change, for example the new time step.
    pub changed: String,
    /// Number of initial states for which both the changed and the unchanged scene gave a value.
    pub starts: usize,
    /// Mean effect of the change on the quantity, and both ends of its confidence interval, in the unit of the
    /// quantity; `None` if there are not enough runs of the changed scene, or if a run failed.
    pub adds: Option<[f64; 3]>,
    /// Fraction of the steps of the changed scene that were not solved to their tolerance.
    pub unsolved: f64,
    /// Computing time of the changed scene divided by the computing time of the unchanged scene; `None` if there are
    /// not enough runs. The ratio differs between machines and repetitions.
    pub cost: Option<f64>,
    /// Reason why the effect is not known, in words; `None` if it is known.
    pub failure: Option<String>,
    #[serde(skip)]
    pub(super) kind: Cause,
}

/// Largest fraction of the steps that may be unsolved (miss their tolerance) in a run that can be trusted. With a
/// larger value, the verdict would trust runs whose result may be changed by unsolved steps.
pub const FEW_UNSOLVED: f64 = 0.01;
/// Fraction of the unsolved steps that a better solver must solve, so that its effect counts as that of unsolved steps.
const SOLVED_BETTER: f64 = 0.5;

/// Verdict on a simulated result: says whether the result comes from the grains and their contact law, or from the
/// numerical method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trust {
    /// Neither the numerical method nor the choice of a contact law changes the result by more than the user's limit.
    Yes,
    /// The numerical method does not change the result by more than the user's limit. The choice of a contact law does,
    /// or its effect is not yet known.
    Mostly,
    /// The numerical method changes the result by more than the user's limit.
    No,
    /// The confidence intervals are too wide to decide, or too many steps are unsolved ([`FEW_UNSOLVED`]).
    NotKnownYet,
}

impl Trust {
    /// Returns the verdict in words, as an answer to the question whether the result can be trusted.
    pub fn words(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::Mostly => "mostly",
            Self::No => "no",
            Self::NotKnownYet => "not known yet",
        }
    }
}

/// The error budget of one quantity: its value, the effect of each possible cause, and a verdict.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct QuantityBudget {
    pub quantity: String,
    pub unit: &'static str,
    /// Requested half-width of the confidence intervals, in the unit of the quantity. It is also the largest acceptable
    /// effect of the numerical method.
    pub within: f64,
    /// Number of initial states from which the unchanged scene was run.
    pub starts: usize,
    /// Mean of the quantity over the initial states, and both ends of its confidence interval, in the unit of the
    /// quantity; `None` if a run failed.
    pub value: Option<[f64; 3]>,
    /// Standard deviation of the quantity between initial states, in the unit of the quantity; `None` if a run failed.
    pub spread: Option<f64>,
    /// Value of the quantity in the user's scene with its own initial state; `None` if this initial state is already
    /// one of those that are averaged, or if the run failed.
    pub itself: Option<f64>,
    /// Estimated change of the quantity in the limit of a time step of 0, and both ends of its confidence interval, in
    /// the unit of the quantity; `None` if the runs do not show such a limit.
    pub limit_adds: Option<[f64; 3]>,
    /// One entry for each of the time steps Δt, Δt/2 and Δt/4. An entry contains the computing time with this time
    /// step, divided by the computing time with Δt, and the quantity at this time step minus the quantity at Δt/8, with
    /// both ends of the confidence interval.
    pub left_by_time_step: Vec<(f64, [f64; 3])>,
    pub trust: Trust,
    pub answer: String,
    /// Fraction of the steps of the unchanged scene that were not solved to their tolerance.
    pub unsolved: f64,
    pub causes: Vec<CauseRow>,
}

/// The error budget of one quantity (how much of it is due to the grains, the law and the method), in the form that the
/// program's graphical window displays.
#[derive(Clone, Debug)]
pub struct BudgetAnswer {
    /// Verdict on the quantity: says whether its value can be trusted.
    pub trust: Trust,
    /// Name of the quantity.
    pub quantity: String,
    /// Largest acceptable effect of the numerical method, in the unit of the quantity.
    pub within: f64,
    /// Largest acceptable effect of the numerical method as text, with its unit.
    pub within_text: String,
    /// All findings of the error budget on this quantity, as a paragraph of text.
    pub text: String,
    /// Known effects of changes of the scene on the quantity, the largest effect first.
    pub effects: Vec<BudgetEffect>,
}

/// The effect of one change of the scene on a quantity.
#[derive(Clone, Debug)]
pub struct BudgetEffect {
    /// Group of the cause of this effect: "grains", "law" or "method".
    pub share: &'static str,
    /// Colour of the group of causes in pictures.
    pub colour: Rgb,
    /// Description of the change, for example the new time step.
    pub changed: String,
    /// Mean effect of the change on the quantity, and both ends of its confidence interval, in the unit of the
    /// quantity.
    pub adds: [f64; 3],
}

/// The setup of an error budget: the changes of the scene, how the initial states are made (from seeds or by small
/// displacements), and the time step, s.
pub(super) struct Design<'a> {
    pub variants: &'a [Variant],
    /// True if the initial states are piles made from different seeds. False if they are copies of one scene whose
    /// grains are displaced by at most 1e-9 mean diameters d.
    pub has_seeds: bool,
    pub time_step_secs: f64,
}

/// Largest standard deviation of a quantity at which a scene does not count as chaotic, as a fraction of the requested
/// half-width of the confidence intervals. The standard deviation is taken between runs whose grains are initially
/// displaced by at most 1e-9 diameters.
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
    /// Returns the rows of the causes whose effect on the quantity is known, each with the mean effect and both ends of
    /// its confidence interval, the largest effect first.
    pub(super) fn effects(&self) -> Vec<(&CauseRow, [f64; 3])> {
        let mut rows: Vec<(&CauseRow, [f64; 3])> =
            self.causes.iter().filter_map(|row| Some((row, row.adds?))).collect();
        rows.sort_by(|(_, one), (_, other)| other[0].abs().total_cmp(&one[0].abs()));
        rows
    }

    /// Returns the error budget of this quantity in the form that the program's graphical window displays.
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

    /// Returns the row of the smallest tested time step whose effect is known; if no effect is known, the row of the
    /// smallest tested time step. Returns `None` if no smaller time step than that of the scene was tested.
    pub(super) fn smallest_step(&self) -> Option<&CauseRow> {
        let of_steps = || self.causes.iter().filter(|row| row.kind == Cause::TimeStep);
        of_steps().rfind(|row| row.adds.is_some()).or_else(|| of_steps().next_back())
    }

    /// True if a cause of this group certainly changes the quantity by more than the user's limit: the whole confidence
    /// interval of its effect is beyond the limit.
    pub(super) fn is_any_outside(&self, share: Share) -> bool {
        let of_share = self.causes.iter().filter(|row| row.share == share);
        of_share.filter_map(|row| row.adds).any(|ends| is_outside(ends, self.within))
    }

    /// Appends the unit of the quantity to a number, which is given as text.
    pub(super) fn with_unit(&self, number: &str) -> String {
        if self.unit.is_empty() { number.to_owned() } else { format!("{number} {}", self.unit) }
    }

    /// Returns the fraction of steps that are unsolved with the better solver; `None` if no better solver was tried.
    pub(super) fn unsolved_by_better(&self) -> Option<f64> {
        self.causes.iter().find(|row| row.kind == Cause::Unsolved).map(|row| row.unsolved)
    }

    /// True if many steps are unsolved, and no solver that solves most of them shows what they do to the result.
    pub(super) fn is_solver_in_doubt(&self) -> bool {
        let most = (1.0 - SOLVED_BETTER) * self.unsolved;
        self.unsolved > FEW_UNSOLVED && self.unsolved_by_better().is_none_or(|left| left > most)
    }

    pub(super) fn judged(&self) -> Trust {
        let of = |share: Share| self.causes.iter().filter(move |row| row.share == share);
        // Of all time steps only the smallest counts, because it shows most of the effect of Δt. If the scene fails
        // under another contact law, this does not put the scene's own law in doubt, so the row of the other law does
        // not count.
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
            _ if self.is_solver_in_doubt() => Trust::NotKnownYet,
            (true, true) => Trust::Yes,
            (true, false) => Trust::Mostly,
            _ => Trust::NotKnownYet,
        }
    }
}
