//! The rows and the verdict of a budget.

use serde::Serialize;

use super::causes::{Cause, Share, Variant};

/// What changing one thing adds to the value.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CauseRow {
    /// Whose share it is.
    pub share: Share,
    pub cause: &'static str,
    /// The change.
    pub changed: String,
    /// Starts that both came to a number from.
    pub starts: usize,
    /// The effect on the value, and its interval; none if it was not run, or if a run failed.
    pub adds: Option<[f64; 3]>,
    /// Part of its steps that were not solved as asked.
    pub unsolved: f64,
    /// Its time by that of the scene as it is. Another one on every machine, and every time.
    pub cost: Option<f64>,
    /// Why there is no number.
    pub failure: Option<String>,
    #[serde(skip)]
    pub(super) kind: Cause,
}

/// Whether a number is one of the grains and their law, rather than of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trust {
    /// Neither the method nor the choice of a law moves it by more than the user allows.
    Yes,
    /// The method does not; the choice of a law does, or that is not known yet.
    Mostly,
    /// The method moves it by more.
    No,
    /// Intervals are too wide to say.
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
    /// Half the width that intervals were to have, and the largest share of a method that does not count.
    pub within: f64,
    /// Starts of the scene as it is.
    pub starts: usize,
    /// Mean over initial states, and its interval; none if a run failed.
    pub value: Option<[f64; 3]>,
    /// Standard deviation between starts.
    pub spread: Option<f64>,
    /// The value of the scene that the user asked for, if it is not one of the initial states.
    pub itself: Option<f64>,
    /// The effect of Δt → 0, if it is known.
    pub limit_adds: Option<[f64; 3]>,
    /// Time of Δt, Δt/2 and Δt/4 over that of Δt, and the effect of each against Δt/8.
    pub left_by_time_step: Vec<(f64, [f64; 3])>,
    pub trust: Trust,
    pub answer: String,
    pub causes: Vec<CauseRow>,
}

/// All that a budget is made of, but its runs.
pub(super) struct Design<'a> {
    pub variants: &'a [Variant],
    /// True if initial states are piles of other seeds; else grains are moved by 1e-9 d.
    pub has_seeds: bool,
    pub time_step_secs: f64,
}

/// Spread between starts that are moved by next to nothing, as a part of the width, that is no chaos.
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
    /// The smallest time step that came to a number, else the smallest.
    pub(super) fn smallest_step(&self) -> Option<&CauseRow> {
        let of_steps = || self.causes.iter().filter(|row| row.kind == Cause::TimeStep);
        of_steps().rfind(|row| row.adds.is_some()).or_else(|| of_steps().next_back())
    }

    /// True where a cause of that share moves the value by more than is allowed.
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
        // Of the time step the smallest shows most of the whole effect. What a scene does not survive under another law is
        // no doubt about its own.
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
