//! A budget in words: the paragraph that is read first.

use super::answer::{
    CauseRow, Design, QuantityBudget, SMOOTH, Trust, halvings, is_inside, is_seen,
};
use super::causes::{Cause, DIVISORS, Share, short};
use super::collect::{BudgetEnd, Runs};

/// A number with as many decimals as half an interval has meaning for.
fn rounded(number: f64, half: f64) -> String {
    if !(half > 0.0 && half.is_finite()) {
        return short(number);
    }
    // Two digits of what begins with 1, else one.
    let power = half.log10().floor();
    let digits = if half / 10f64.powf(power) < 1.95 { 1.0 } else { 0.0 };
    let decimals = digits - power;
    if (0.0..=4.0).contains(&decimals) || number.abs() >= 0.1 && (0.0..=8.0).contains(&decimals) {
        let text = format!("{number:.*}", decimals as usize);
        let is_zero = text.chars().all(|sign| matches!(sign, '-' | '0' | '.'));
        return if is_zero { text.trim_start_matches('-').to_owned() } else { text };
    }
    if (-4.0..0.0).contains(&decimals) {
        let unit = 10f64.powf(-decimals);
        return format!("{:.0}", (number / unit).round() * unit);
    }
    if number.abs() < 0.5 * 10f64.powf(-decimals) {
        return "0".into();
    }
    let digits = (number.abs().max(half).log10().floor() + decimals).max(0.0);
    format!("{number:.*e}", digits as usize)
}

/// One, another and a third.
fn listed(names: &[String]) -> String {
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => names.concat(),
    }
}

pub(super) struct Words<'a> {
    pub budget: &'a QuantityBudget,
    pub runs: &'a Runs,
    pub ended: BudgetEnd,
    pub design: &'a Design<'a>,
    pub number: usize,
}

impl Words<'_> {
    pub(super) fn paragraph(&self) -> String {
        let mut said = vec![self.of_value()];
        said.extend(self.of_time_step());
        let smallest = self.budget.smallest_step().map(|row| &row.changed);
        let is_said = |row: &&CauseRow| {
            row.kind == Cause::TimeStep && (row.adds.is_some() || Some(&row.changed) != smallest)
        };
        let others = self.budget.causes.iter().filter(|row| !is_said(row));
        let (mut seen, mut unseen, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for row in others {
            match row.adds {
                Some(ends) if self.is_told(ends) => {
                    seen.push((ends[0].abs(), self.of_effect(row, ends)));
                }
                Some(ends) => unseen.push(self.of_unseen(row) + &self.at_most(ends)),
                None => missing.push(row),
            }
        }
        // The largest first.
        seen.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        said.extend(seen.into_iter().map(|(_, words)| words));
        if !unseen.is_empty() {
            said.push(format!("No effect is seen of {}.", listed(&unseen)));
        }
        said.extend(self.of_missing(missing));
        said.push(self.of_trust());
        said.extend(self.of_cost());
        said.push(self.of_end());
        said.join(" ")
    }

    /// A number whose interval has this half width, which is no better known than what counts as none.
    fn number(&self, number: f64, half: f64) -> String {
        rounded(number, half.max(SMOOTH * self.budget.within))
    }

    /// True where an effect is seen and is more than what counts as none.
    fn is_told(&self, [mean, low, high]: [f64; 3]) -> bool {
        is_seen([mean, low, high]) && low.abs().max(high.abs()) > SMOOTH * self.budget.within
    }

    /// How large an effect may be that is not told; nothing where it is none at all.
    fn at_most(&self, [_, low, high]: [f64; 3]) -> String {
        let (most, least) = (low.abs().max(high.abs()), SMOOTH * self.budget.within);
        let said =
            |words: &str, number: String| format!(" ({words} {})", self.budget.with_unit(&number));
        if most == 0.0 {
            String::new()
        } else if most <= least {
            said("below", short(least))
        } else {
            said("at most", self.number(most, most))
        }
    }

    fn with_interval(&self, mean: f64, half: f64) -> String {
        let mean = self.number(mean, half);
        if half.is_infinite() || half <= SMOOTH * self.budget.within {
            return mean;
        }
        format!("{mean} ± {}", rounded(half, half))
    }

    fn of_value(&self) -> String {
        let QuantityBudget { quantity, starts, spread, itself, .. } = self.budget;
        let [mean, _, high] = self.budget.value.unwrap_or([f64::NAN; 3]);
        let spread = spread.unwrap_or(0.0);
        let value = self.budget.with_unit(&self.with_interval(mean, high - mean));
        if self.design.has_seeds {
            let itself = itself.map_or(String::new(), |itself| {
                format!(" The pile that was asked for has {}.", rounded(itself, spread))
            });
            return format!(
                "{quantity} is {value} over {starts} piles that differ in their seed; single ones scatter by {}.{itself}",
                rounded(spread, spread)
            );
        }
        if spread <= SMOOTH * self.budget.within {
            return format!(
                "{quantity} is {}, and all but the same where grains start 1e-9 d elsewhere.",
                self.budget.with_unit(&self.number(mean, 0.0))
            );
        }
        format!(
            "{quantity} is {value} over {starts} starts that differ by 1e-9 d; single ones scatter by {}: the scene is \
             chaotic.",
            rounded(spread, spread)
        )
    }

    fn of_time_step(&self) -> Option<String> {
        let smallest = self.budget.smallest_step()?;
        let [mean, low, high] = smallest.adds?;
        let value = self.budget.with_unit(&self.value_of(mean, high - mean));
        let effect = self.effect([-mean, -high, -low]);
        let mut said =
            format!("The time step {effect}: at {} the value is {value}", smallest.changed);
        said += &match self.budget.limit_adds {
            Some([mean, low, high]) if is_seen([mean, low, high]) => {
                let [base, ..] = self.budget.value.unwrap_or([f64::NAN; 3]);
                let value = self.with_interval(base + mean, high - mean);
                format!(", at Δt → 0 {}.", self.budget.with_unit(&value))
            }
            Some(_) => ".".into(),
            None if halvings(self.runs, self.design, self.number).is_some() => {
                "; it does not settle as Δt falls, and no value at Δt → 0 is given.".into()
            }
            None => ".".into(),
        };
        Some(said)
    }

    /// What the value is with something added to it. The mean value's own scatter is not that of a paired difference, which
    /// is given.
    fn value_of(&self, adds: f64, half: f64) -> String {
        let [mean, ..] = self.budget.value.unwrap_or([f64::NAN; 3]);
        self.number(mean + adds, half)
    }

    /// What is said of an effect, by what it adds.
    fn effect(&self, [mean, low, high]: [f64; 3]) -> String {
        let told = |number: f64| {
            let number = self.with_interval(number, high - mean);
            self.budget.with_unit(&number)
        };
        if !self.is_told([mean, low, high]) {
            format!("has no effect that is seen{}", self.at_most([mean, low, high]))
        } else if mean > 0.0 {
            format!("adds {}", told(mean))
        } else {
            format!("takes {} away", told(-mean))
        }
    }

    fn of_effect(&self, row: &CauseRow, [mean, low, high]: [f64; 3]) -> String {
        let effect = match row.kind {
            // Left undone, it adds what doing it takes away.
            Cause::Unsolved => self.effect([-mean, -high, -low]),
            _ => self.effect([mean, low, high]),
        };
        match row.kind {
            Cause::Unsolved => format!("What steps leave unsolved {effect}."),
            Cause::Start => {
                format!("Solves with {} in place of the scene's {effect}.", row.changed)
            }
            Cause::ContactLaw => {
                format!("The contact law {} in place of this one {effect}.", row.changed)
            }
            Cause::FrictionModel => format!("Friction by {} {effect}.", row.changed),
            Cause::NumberOfGrains => format!("A pile of {} {effect}.", row.changed),
            Cause::Packing => format!("A pile {} {effect}.", row.changed),
            Cause::RestitutionThreshold => format!("{} {effect}.", row.changed),
            Cause::Cone | Cause::TouchTolerance | Cause::TimeStep => {
                format!("The {} {effect}.", row.changed)
            }
        }
    }

    fn of_unseen(&self, row: &CauseRow) -> String {
        match row.kind {
            Cause::Unsolved => row.cause.to_owned(),
            Cause::Start => row.changed.clone(),
            Cause::ContactLaw => format!("the contact law {}", row.changed),
            Cause::FrictionModel => format!("friction by {}", row.changed),
            Cause::NumberOfGrains => format!("a pile of {}", row.changed),
            Cause::Packing => format!("a pile {}", row.changed),
            Cause::RestitutionThreshold => {
                let mut letters = row.changed.chars();
                let first = letters.next().map(|letter| letter.to_ascii_lowercase());
                first.into_iter().chain(letters).collect()
            }
            Cause::Cone | Cause::TouchTolerance | Cause::TimeStep => {
                format!("the {}", row.changed)
            }
        }
    }

    /// What is not known, by its reason.
    fn of_missing(&self, rows: Vec<&CauseRow>) -> Vec<String> {
        let mut by_reason: Vec<(&str, Vec<String>)> = Vec::new();
        for row in rows {
            let reason = row.failure.as_deref().unwrap_or_default();
            let name = if row.kind == Cause::TimeStep {
                row.cause.to_owned()
            } else {
                self.of_unseen(row)
            };
            match by_reason.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, names)) => names.push(name),
                None => by_reason.push((reason, vec![name])),
            }
        }
        let said = |(reason, names): (&str, Vec<String>)| {
            format!("Nothing is known of {}: {reason}.", listed(&names))
        };
        by_reason.into_iter().map(said).collect()
    }

    fn of_trust(&self) -> String {
        let within = self.budget.with_unit(&short(self.budget.within));
        match self.budget.trust {
            Trust::Yes => format!(
                "So neither the method nor the choice of a law moves it by more than {within}."
            ),
            Trust::Mostly => {
                let law = if self.budget.is_any_outside(Share::Law) {
                    "the choice of a law does"
                } else {
                    "whether the choice of a law does is not known yet"
                };
                format!("So the method moves it by no more than {within}; {law}.")
            }
            Trust::No => format!("So the method moves it by more than {within}."),
            Trust::NotKnownYet => {
                format!("Whether the method moves it by more than {within} is not known yet.")
            }
        }
    }

    /// The cheapest of the settings that were tried whose part of the value is small enough.
    fn of_cost(&self) -> Option<String> {
        if self.budget.trust != Trust::No {
            return None;
        }
        let within = self.budget.within;
        let tried = self.budget.left_by_time_step.iter().zip([1].into_iter().chain(DIVISORS));
        let mut enough = tried.filter(|((_, left), _)| is_inside(*left, within));
        let said = self.budget.with_unit(&short(within));
        Some(match enough.next() {
            _ if self.budget.left_by_time_step.is_empty() => return None,
            Some((_, 1)) => return None,
            Some(((cost, _), divisor)) => format!(
                "For the time step's part to stay below {said}: Δt ≤ {} s, {} times the cost.",
                short(self.design.time_step_secs / f64::from(divisor)),
                rounded(*cost, 0.3)
            ),
            None => format!(
                "No time step that was tried is known to be small enough for its part to stay below {said}."
            ),
        })
    }

    fn of_end(&self) -> String {
        let percent = 100.0 * (1.0 - super::collect::OUTSIDE);
        let all = format!("All intervals hold together in {percent:.0} % of budgets.");
        match self.ended {
            BudgetEnd::Within => all,
            BudgetEnd::Stopped => format!("{all} More is on its way."),
            BudgetEnd::Cost | BudgetEnd::Failed => {
                let widest = (0..self.runs.all.len()).filter(|&series| self.runs.is_begun(series));
                let widest = widest.max_by(|one, other| {
                    self.runs.excess(*one).total_cmp(&self.runs.excess(*other))
                });
                let what = match widest {
                    Some(series) if self.runs.excess(series) > 1.0 => {
                        let name = series.checked_sub(1).map_or("the value itself".into(), |one| {
                            let variant = &self.design.variants[one];
                            format!("{} ({})", variant.cause.words(), variant.label)
                        });
                        format!(
                            " the widest interval, of {name}, is {} times as wide as asked for",
                            rounded(self.runs.excess(series), 0.3)
                        )
                    }
                    _ => " not all could be run".into(),
                };
                format!("{all} The time was spent:{what}.")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_their_intervals_leave() {
        let all = [
            (0.234_56, 0.0212, "0.23"),
            (0.234_56, 0.0123, "0.235"),
            (4.717e-5, 2.29e-5, "5e-5"),
            (1234.5, 21.0, "1230"),
            (-0.001, 0.05, "0.00"),
            (1e-12, 5e-7, "0"),
        ];
        for (mean, half, said) in all {
            assert_eq!(rounded(mean, half), said);
        }
    }
}
