//! Writes the findings of an error budget in words. There is a template of a sentence for each possible finding.

use super::causes::{Cause, DIVISORS, Share, short};
use super::collect::{BudgetEnd, OUTSIDE, Runs};
use super::rows::{CauseRow, Design, QuantityBudget, SMOOTH, Trust, is_inside, is_seen};

/// Formats a number with those decimals that are meaningful if its confidence interval has the half-width `half`.
fn rounded(number: f64, half: f64) -> String {
    if !(half > 0.0 && half.is_finite()) {
        return short(number);
    }
    // The half-width has two digits if it begins with 1, otherwise one digit.
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

/// Joins names into a list in words, as in "time step, cone and friction model".
fn listed(names: &[String]) -> String {
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => names.concat(),
    }
}

/// Returns the subject of a sentence about the effect of a cause, such as "the law range in place of this one".
fn subject(row: &CauseRow) -> String {
    row.kind.subject().replace("{}", &row.changed)
}

/// Returns the text with a capital first letter.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_ascii_uppercase()).into_iter().chain(letters).collect()
}

/// Returns the findings of an error budget on one quantity as a paragraph. `is_halved` is true if the quantity has a
/// value at each of the time steps Δt/2, Δt/4 and Δt/8.
pub(super) fn paragraph(
    budget: &QuantityBudget,
    (runs, ended): (&Runs, BudgetEnd),
    design: &Design<'_>,
    is_halved: bool,
) -> String {
    let within = budget.with_unit(&short(budget.within));
    let mut said = vec![budget.of_value(design.has_seeds)];
    said.extend(budget.of_time_step(is_halved));
    said.extend(budget.of_causes(ended));
    said.push(budget.of_trust(&within));
    said.extend(budget.of_cost(&within, design.time_step_secs));
    said.push(of_end(runs, ended, design));
    said.join(" ")
}

/// Functions that describe the error budget of one quantity in sentences.
impl QuantityBudget {
    /// Formats a number whose confidence interval has the half-width `half`. Decimals that are smaller than a
    /// negligible change (the requested half-width times [`SMOOTH`]) are left out.
    fn number(&self, number: f64, half: f64) -> String {
        rounded(number, half.max(SMOOTH * self.within))
    }

    /// Returns the largest magnitude that an effect can have within its confidence interval. The argument contains the
    /// mean effect and both ends of the interval.
    fn most([_, low, high]: [f64; 3]) -> f64 {
        low.abs().max(high.abs())
    }

    /// True if an effect, given by its mean and both ends of its confidence interval, is statistically significant and
    /// may be larger than a negligible change.
    fn is_told(&self, ends: [f64; 3]) -> bool {
        is_seen(ends) && Self::most(ends) > SMOOTH * self.within
    }

    /// Returns a phrase with the largest possible size of an effect that is not significant, such as " (at most 0.02)";
    /// empty if the effect is exactly 0. `ends` is the mean effect and both ends of its confidence interval.
    fn at_most(&self, ends: [f64; 3]) -> String {
        let (most, least) = (Self::most(ends), SMOOTH * self.within);
        match most {
            0.0 => String::new(),
            _ if most <= least => format!(" (below {})", self.with_unit(&short(least))),
            _ => format!(" (at most {})", self.with_unit(&self.number(most, most))),
        }
    }

    fn with_interval(&self, mean: f64, half: f64) -> String {
        let said = self.number(mean, half);
        let is_narrow = half.is_infinite() || half <= SMOOTH * self.within;
        self.with_unit(&if is_narrow { said } else { format!("{said} ± {}", rounded(half, half)) })
    }

    fn of_value(&self, has_seeds: bool) -> String {
        let Self { quantity, starts, itself, .. } = self;
        let [mean, _, high] = self.value.unwrap_or([f64::NAN; 3]);
        let spread = self.spread.unwrap_or(0.0);
        let (value, scatter) = (self.with_interval(mean, high - mean), rounded(spread, spread));
        if has_seeds {
            let itself = itself.map_or(String::new(), |itself| {
                format!(" The pile that was asked for has {}.", rounded(itself, spread))
            });
            return format!(
                "The {quantity} is {value} over {starts} piles that differ in their seed; single piles scatter by \
                 {scatter}.{itself}"
            );
        }
        if spread <= SMOOTH * self.within {
            let value = self.with_unit(&self.number(mean, 0.0));
            return format!(
                "The {quantity} is {value}, and nearly the same if grains start 1e-9 d away."
            );
        }
        format!(
            "The {quantity} is {value} over {starts} starts that differ by 1e-9 d; single starts scatter by \
             {scatter}: the scene is chaotic."
        )
    }

    fn of_time_step(&self, is_halved: bool) -> Option<String> {
        let smallest = self.smallest_step()?;
        let [mean, low, high] = smallest.adds?;
        let [base, ..] = self.value.unwrap_or([f64::NAN; 3]);
        // The decimals follow from the interval of the paired difference between two time steps. The mean value has
        // another scatter.
        let value = self.with_unit(&self.number(base + mean, high - mean));
        let end = match self.limit_adds {
            Some([mean, low, high]) if is_seen([mean, low, high]) => {
                format!(", at Δt → 0 {}.", self.with_interval(base + mean, high - mean))
            }
            None if is_halved => {
                "; it does not settle as Δt falls, and no value at Δt → 0 is given.".into()
            }
            _ => ".".into(),
        };
        let effect = self.effect([-mean, -high, -low]);
        Some(format!("The time step {effect}: at {} the value is {value}{end}", smallest.changed))
    }

    fn effect(&self, [mean, low, high]: [f64; 3]) -> String {
        if !self.is_told([mean, low, high]) {
            return format!("has no effect that is seen{}", self.at_most([mean, low, high]));
        }
        let size = self.with_interval(mean.abs(), high - mean);
        if mean > 0.0 { format!("adds {size}") } else { format!("takes {size} away") }
    }

    /// Returns one sentence for each significant effect, the largest effect first; one sentence for all other effects;
    /// and one sentence for each reason why effects are not known. Before the end of the computation, effects that
    /// still need runs are left out.
    fn of_causes(&self, ended: BudgetEnd) -> Vec<String> {
        let (mut seen, mut unseen) = (Vec::new(), Vec::new());
        let mut missing: Vec<(&str, Vec<String>)> = Vec::new();
        for row in &self.causes {
            match row.adds {
                // The sentence about the time step covers these rows.
                Some(_) if row.kind == Cause::TimeStep => {}
                None if ended == BudgetEnd::Stopped && row.cost.is_none() => {}
                Some([mean, low, high]) if self.is_told([mean, low, high]) => {
                    // The variant solves its steps more accurately, so the effect of unsolved steps is the opposite of
                    // the effect of this variant.
                    let is_undone = row.kind == Cause::Unsolved;
                    let ends = if is_undone { [-mean, -high, -low] } else { [mean, low, high] };
                    let subject = capitalised(&subject(row));
                    seen.push((mean.abs(), format!("{subject} {}.", self.effect(ends))));
                }
                Some(ends) => unseen.push(subject(row) + &self.at_most(ends)),
                None => {
                    let reason = row.failure.as_deref().unwrap_or_default();
                    let name = subject(row);
                    match missing.iter_mut().find(|(known, _)| *known == reason) {
                        Some((_, names)) => names.push(name),
                        None => missing.push((reason, vec![name])),
                    }
                }
            }
        }
        seen.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        let mut said: Vec<String> = seen.into_iter().map(|(_, sentence)| sentence).collect();
        if !unseen.is_empty() {
            said.push(format!("No effect is seen of {}.", listed(&unseen)));
        }
        let of_reason = |(reason, names): (&str, Vec<String>)| {
            format!("Nothing is known of {}: {reason}.", listed(&names))
        };
        said.extend(missing.into_iter().map(of_reason));
        said
    }

    fn of_trust(&self, within: &str) -> String {
        let law = match self.is_any_outside(Share::Law) {
            true => "the choice of a law moves it by more",
            false => "whether the choice of a law does is not known yet",
        };
        match self.trust {
            Trust::Yes => {
                format!(
                    "So neither the method nor the choice of a law moves it by more than {within}."
                )
            }
            Trust::Mostly => format!("So the method moves it by no more than {within}; {law}."),
            Trust::No => format!("So the method moves it by more than {within}."),
            Trust::NotKnownYet if self.is_solver_in_doubt() => {
                let better = |left: f64| format!(" ({:.1} % with a better solver)", 100.0 * left);
                format!(
                    "In the runs of this budget {:.1} % of the steps are unsolved{}: the effect of these steps is not \
                     known.",
                    100.0 * self.unsolved,
                    self.unsolved_by_better().map(better).unwrap_or_default()
                )
            }
            Trust::NotKnownYet => {
                format!("Whether the method moves it by more than {within} is not known yet.")
            }
        }
    }

    /// Returns a sentence that recommends the largest tested time step whose error of the quantity is within the user's
    /// limit, and gives its relative computing time. Returns `None` if no smaller time step is needed.
    fn of_cost(&self, within: &str, time_step_secs: f64) -> Option<String> {
        if self.trust != Trust::No || self.left_by_time_step.is_empty() {
            return None;
        }
        let mut tried = self.left_by_time_step.iter().zip([1].into_iter().chain(DIVISORS));
        match tried.find(|((_, left), _)| is_inside(*left, self.within)) {
            Some((_, 1)) => None,
            Some(((cost, _), divisor)) => Some(format!(
                "For the time step's part to stay below {within}: Δt ≤ {} s, {} times the cost.",
                short(time_step_secs / f64::from(divisor)),
                rounded(*cost, 0.3)
            )),
            None => Some(format!(
                "No time step that was tried is known to be small enough for its part to stay below {within}."
            )),
        }
    }
}

fn of_end(runs: &Runs, ended: BudgetEnd, design: &Design<'_>) -> String {
    let percent = 100.0 * (1.0 - OUTSIDE);
    let all = format!("In {percent:.0} % of budgets all intervals contain the true values.");
    match ended {
        BudgetEnd::Within => return all,
        BudgetEnd::Stopped => return format!("{all} Not all runs are finished."),
        BudgetEnd::Cost | BudgetEnd::Failed => {}
    }
    let begun = (0..runs.all.len()).filter(|&series| runs.is_begun(series));
    let widest = begun.map(|series| (runs.excess(series), series));
    match widest.max_by(|(one, _), (other, _)| one.total_cmp(other)) {
        Some((excess, series)) if excess > 1.0 => {
            let name = series.checked_sub(1).map_or("the value itself".into(), |one| {
                let variant = &design.variants[one];
                format!("{} ({})", variant.cause.words(), variant.label)
            });
            let times = rounded(excess, 0.3);
            format!(
                "{all} The time was spent: the widest interval, of {name}, is {times} times as wide as asked for."
            )
        }
        _ => format!("{all} The time was spent: not all could be run."),
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
