//! Assembles the error budget of one quantity: one row per possible cause of an error (such as the time step or the
//! contact law), the limit of the quantity for small time steps, and a verdict.

use super::causes::{Cause, Variant};
use super::collect::{BudgetEnd, Ran, Runs};
use super::quantity::BudgetQuantity;
use super::rows::{CauseRow, Design, QuantityBudget, Trust};
use super::words::paragraph;
use crate::statistics::Mean;

/// Tolerance of the test whether a quantity converges as the time step Δt goes to 0, as a fraction of the requested
/// half-width of the confidence intervals. If a quantity converges, its changes in successive halvings of Δt decrease
/// by a constant factor. The test subtracts from each change the value that the previous change and this factor
/// predict. The difference counts as zero if its confidence interval reaches to within the tolerance of 0. With a
/// quarter, differences that are small compared with the requested accuracy do not hide the convergence.
const SLACK: f64 = 0.25;
pub(super) fn budget_of(
    runs: &Runs,
    ended: BudgetEnd,
    design: &Design<'_>,
    (number, quantity): (usize, &BudgetQuantity),
    itself: Option<f64>,
) -> QuantityBudget {
    let within = runs.within[number];
    let rows: Vec<CauseRow> = design
        .variants
        .iter()
        .zip(1..)
        .map(|(variant, series)| row((runs, ended), variant, series, number))
        .collect();
    let value = runs.interval(0, number);
    let failure = runs.failure(0, number);
    let mut budget = QuantityBudget {
        quantity: quantity.name.clone(),
        unit: quantity.unit,
        within,
        starts: value.count,
        value: failure.is_none().then_some(ends(&value)),
        spread: failure.is_none().then(|| value.spread()),
        itself,
        limit_adds: None,
        left_by_time_step: Vec::new(),
        trust: Trust::NotKnownYet,
        answer: String::new(),
        unsolved: unsolved(&runs.all[0]),
        causes: if failure.is_none() { rows } else { Vec::new() },
    };
    if let Some(failure) = failure {
        budget.answer =
            format!("The {} has no value: of the scene as it is, {failure}.", quantity.name);
        return budget;
    }
    budget.limit_adds = limit(runs, design, number).map(|limit| ends(&limit));
    let halved = halvings(runs, design, number);
    if let Some([half, quarter, eighth]) = halved {
        let left = |series: usize| {
            let rest = runs.over_starts(&[series, eighth], number, |values| values[0] - values[1]);
            (runs.cost_ratio(series), ends(&rest))
        };
        budget.left_by_time_step = [0, half, quarter].map(left).to_vec();
    }
    budget.trust = budget.judged();
    budget.answer = paragraph(&budget, (runs, ended), design, halved.is_some());
    budget
}

fn ends(mean: &Mean) -> [f64; 3] {
    [mean.mean, mean.low, mean.high]
}

/// Returns the fraction of the steps of these runs that were not solved to their tolerance.
fn unsolved(ran: &[Ran]) -> f64 {
    ran.iter().map(|ran| ran.values.unsolved).sum::<f64>() / ran.len().max(1) as f64
}

fn row(
    (runs, ended): (&Runs, BudgetEnd),
    variant: &Variant,
    series: usize,
    quantity: usize,
) -> CauseRow {
    let ran = &runs.all[series];
    let failure = if runs.is_begun(series) {
        runs.failure(series, quantity)
    } else if ended == BudgetEnd::Stopped {
        Some("that was not run often enough yet".to_owned())
    } else {
        // NaN, if no run was timed, compares false.
        let times = runs.cost_ratio(series).round();
        let cost = if times > 1.0 {
            format!(" (a run takes {times} times as long)")
        } else {
            String::new()
        };
        Some(format!("that does not fit into the time{cost}"))
    };
    let adds = runs.interval(series, quantity);
    CauseRow {
        share: variant.cause.share(),
        cause: variant.cause.words(),
        changed: variant.label.clone(),
        starts: if failure.is_none() { adds.count } else { 0 },
        adds: failure.is_none().then_some(ends(&adds)),
        unsolved: unsolved(ran),
        cost: runs.is_begun(series).then(|| runs.cost_ratio(series)),
        failure,
        kind: variant.cause,
    }
}

/// Returns the indices of the three series with the time steps Δt/2, Δt/4 and Δt/8 (a series: all runs with the same
/// change of the scene). Returns `None` if one of these series has too few runs, or a run without a value of the
/// quantity.
fn halvings(runs: &Runs, design: &Design<'_>, quantity: usize) -> Option<[usize; 3]> {
    let all = design.variants.iter().zip(1..);
    let of_steps = all.filter(|(variant, series)| {
        variant.cause == Cause::TimeStep
            && runs.is_begun(*series)
            && runs.failure(*series, quantity).is_none()
    });
    of_steps.map(|(_, series)| series).collect::<Vec<_>>().try_into().ok()
}

/// Estimates the change of a quantity Q in the limit Δt → 0, by Richardson's extrapolation.
///
/// If the error of Q is proportional to Δt^p, the changes q₁ = Q(Δt/2) − Q(Δt), q₂ and q₃ in three successive halvings
/// of Δt decrease by a factor 2^p each, and the remaining change after the third halving is q₃/(2^p − 1). The function
/// tests for p = 1, then for p = 2, whether q₂ − q₁/2^p and q₃ − q₂/2^p are compatible with 0. If neither p passes, Q
/// does not converge in this way, and the function returns `None`.
fn limit(runs: &Runs, design: &Design<'_>, quantity: usize) -> Option<Mean> {
    let [half, quarter, eighth] = halvings(runs, design, quantity)?;
    let slack = SLACK * runs.within[quantity];
    let of = |of: &dyn Fn([f64; 4]) -> f64| {
        let series = [0, half, quarter, eighth];
        runs.over_starts(&series, quantity, |q| of([q[0], q[1], q[2], q[3]]))
    };
    let may_be_none = |mean: &Mean| mean.low <= slack && mean.high >= -slack;
    [2.0, 4.0].into_iter().find_map(|factor| {
        let first = of(&|[q, q2, q4, _]| (q4 - q2) - (q2 - q) / factor);
        let second = of(&|[_, q2, q4, q8]| (q8 - q4) - (q4 - q2) / factor);
        let to_come = of(&|[q, _, q4, q8]| q8 - q + (q8 - q4) / (factor - 1.0));
        (may_be_none(&first) && may_be_none(&second)).then_some(to_come)
    })
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::super::causes::variants;
    use super::super::collect::{Limits, SeriesRun, collect};
    use super::super::rows::is_seen;
    use super::super::starts::RunValues;
    use super::*;
    use crate::scene::{NewPile, built_in};

    /// Returns the error budget of made-up runs of a cohesive pile, for tests. The argument of `of` is the change that
    /// a run makes to the scene (`None` for the unchanged scene). The value of a run is the sum of four numbers: 0.3;
    /// the effect of this change, which `of` returns; a random number that all runs from the same initial state share;
    /// and a random number of this run alone, with the standard deviation `scatter`.
    fn made_up(
        seed: u64,
        scatter: f64,
        limits: Limits,
        of: &(impl Fn(Option<&Variant>) -> f64 + Sync),
    ) -> QuantityBudget {
        let as_expected = |variant: Option<&Variant>| variant.map_or(1.0, |one| one.cost);
        made_up_at(seed, scatter, limits, of, &as_expected)
    }

    /// Returns the error budget of made-up runs of a cohesive pile, for tests. `of` returns the effect of the change
    /// that a run makes to the scene, and `cost_of` the computing time of the run, s; their argument is this change
    /// (`None` for the unchanged scene). `scatter` is the standard deviation of a random number that is added to the
    /// value of each run.
    fn made_up_at(
        seed: u64,
        scatter: f64,
        limits: Limits,
        of: &(impl Fn(Option<&Variant>) -> f64 + Sync),
        cost_of: &(impl Fn(Option<&Variant>) -> f64 + Sync),
    ) -> QuantityBudget {
        let mut scene = built_in("pile").unwrap();
        scene.parameters.bond = 20.0;
        let variants = variants(&scene, Some(&NewPile::default()), true);
        let run = |SeriesRun { series, start }: SeriesRun| {
            // The sum of twelve uniform random numbers is sufficiently close to a normal distribution here.
            let normal = |number: u64| {
                let mut random = Pcg64::seed_from_u64(number);
                (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>()
            };
            let own = normal(seed * 1_000_003 + 1000 * series as u64 + start as u64);
            let shared = normal(seed * 1_000_003 + 999_000 + start as u64);
            let added = of(series.checked_sub(1).map(|one| &variants[one]));
            let values = vec![Some(0.3 + added + 0.1 * shared + scatter * own)];
            let cost = cost_of(series.checked_sub(1).map(|one| &variants[one]));
            Ok(Ran {
                values: RunValues { values, failure: None, unsolved: 0.0, run_secs: cost },
                secs: cost,
                is_free: false,
            })
        };
        let costs = [1.0].into_iter().chain(variants.iter().map(|variant| variant.cost)).collect();
        let design = Design { variants: &variants, has_seeds: true, time_step_secs: 1e-3 };
        let (runs, ended) =
            collect(costs, 1, limits, (&run, &|_| Ok(false)), &mut |_| ControlFlow::Continue(()))
                .unwrap();
        let quantity = "slump".parse().unwrap();
        budget_of(&runs, ended, &design, (0, &quantity), None)
    }

    const FREE: Limits =
        Limits { cost_secs: f64::INFINITY, within: Some(0.05), parts: 1, shows_progress: false };
    const BUDGETS: u64 = 1_000;

    fn share(holds: impl Fn(u64) -> bool) -> f64 {
        (0..BUDGETS).filter(|seed| holds(*seed)).count() as f64 / BUDGETS as f64
    }

    #[test]
    fn where_nothing_has_an_effect_at_most_five_of_a_hundred_budgets_see_one() {
        let sees_any = |seed| {
            let budget = made_up(seed, 0.03, FREE, &|_| 0.0);
            assert!(budget.causes.iter().all(|row| row.starts >= 4), "{}", budget.answer);
            budget.causes.iter().filter_map(|row| row.adds).any(is_seen)
                || budget.limit_adds.is_some_and(is_seen)
        };
        let share = share(sees_any);
        // If the rate is 5 %, 50 ± 7 of 1,000 budgets see an effect (± is the standard deviation).
        assert!(share <= 0.07, "{share} of budgets see an effect where there is none");
    }

    #[test]
    fn known_effects_come_out_as_they_are_in_95_of_100_budgets() {
        let step = |variant: Option<&Variant>| {
            variant.map_or(1e-3, |one| one.settings.parameters.time_step_secs)
        };
        let effect = |variant: Option<&Variant>| {
            let of_step = -100.0 * step(variant);
            of_step
                + match variant.map(|variant| variant.cause) {
                    Some(Cause::Cone) => 0.2,
                    Some(Cause::Unsolved) => -0.08,
                    _ => 0.0,
                }
        };
        let holds =
            |[_, low, high]: [f64; 3], true_value: f64| low <= true_value && true_value <= high;
        let all_hold = |seed| {
            let budget = made_up(seed, 0.03, FREE, &effect);
            let expected = |row: &CauseRow| match row.kind {
                Cause::TimeStep => {
                    0.1 - 100.0
                        * 1e-3
                        * row.changed["Δt ".len()..].trim_end_matches(" s").parse::<f64>().unwrap()
                        / 1e-3
                }
                Cause::Cone => 0.2,
                Cause::Unsolved => -0.08,
                _ => 0.0,
            };
            assert_ne!(budget.trust, Trust::Yes, "{}", budget.answer);
            budget.causes.iter().all(|row| holds(row.adds.unwrap(), expected(row)))
                && budget.limit_adds.is_some_and(|limit| holds(limit, 0.1))
        };
        let share = share(all_hold);
        assert!(share >= 0.93, "all intervals hold in {share} of budgets");
    }

    #[test]
    fn answers_say_what_was_found() {
        let limits = Limits { within: Some(0.02), ..FREE };
        let budget = made_up(1, 1e-3, limits, &|variant| match variant.map(|one| one.cause) {
            Some(Cause::ContactLaw) => 0.1,
            _ => 0.0,
        });
        assert_eq!(budget.trust, Trust::Mostly, "{}", budget.answer);
        assert!(
            budget.answer.contains("The law range in place of this one adds 0.1"),
            "{}",
            budget.answer
        );
        assert!(
            budget.answer.contains("No effect is seen of not solving every step (at most 0.0"),
            "{}",
            budget.answer
        );
        let budget = made_up(1, 1e-3, limits, &|_| 0.0);
        assert_eq!(budget.trust, Trust::Yes, "{}", budget.answer);
        let second_order = |variant: Option<&Variant>| {
            let step = variant.map_or(1e-3, |one| one.settings.parameters.time_step_secs);
            0.1 * (step / 1e-3) * (step / 1e-3)
        };
        let budget = made_up(1, 1e-5, limits, &second_order);
        let [limit, ..] = budget.limit_adds.expect("a limit");
        assert!((limit + 0.1).abs() < 1e-4, "{limit}");
        assert!(budget.answer.contains("Δt ≤ 2.5e-4 s, 4.0 times the cost"), "{}", budget.answer);
        // A value that changes by the same amount at each halving of Δt has no limit for Δt → 0.
        let logarithmic = |variant: Option<&Variant>| {
            0.05 * variant.map_or(1e-3, |one| one.settings.parameters.time_step_secs).ln()
        };
        let budget = made_up(1, 1e-5, limits, &logarithmic);
        assert_eq!(budget.limit_adds, None);
        assert!(budget.answer.contains("does not settle as Δt falls"), "{}", budget.answer);
        assert!(
            budget.answer.contains("No time step that was tried is known to be small enough"),
            "{}",
            budget.answer
        );
    }

    #[test]
    fn a_result_is_not_trusted_if_a_better_solver_leaves_as_many_steps_unsolved() {
        let limits = Limits { within: Some(0.02), ..FREE };
        let mut budget = made_up(1, 1e-3, limits, &|_| 0.0);
        assert_eq!(budget.judged(), Trust::Yes);
        let better = |row: &CauseRow| row.kind == Cause::Unsolved;
        let better = budget.causes.iter().position(better).expect("a better solver is tried");
        for (unsolved, by_better, trust) in [
            (0.03, 0.14, Trust::NotKnownYet),
            (0.03, 0.02, Trust::NotKnownYet),
            (0.03, 0.01, Trust::Yes),
            (0.009, 0.14, Trust::Yes),
        ] {
            (budget.unsolved, budget.causes[better].unsolved) = (unsolved, by_better);
            assert_eq!(budget.judged(), trust, "{unsolved} and {by_better}");
        }
        budget.causes.remove(better);
        assert_eq!(budget.judged(), Trust::Yes);
        budget.unsolved = 0.03;
        assert_eq!(budget.judged(), Trust::NotKnownYet, "no better solver was tried");
    }

    #[test]
    fn a_spent_time_is_told_with_the_widest_interval() {
        let limits = Limits { within: Some(1e-3), cost_secs: 60.0, ..FREE };
        let budget = made_up(1, 0.05, limits, &|_| 0.0);
        assert!(
            budget.answer.contains("The time was spent: the widest interval, of"),
            "{}",
            budget.answer
        );
        assert!(budget.causes.iter().any(|row| row.failure.is_some()), "{:?}", budget.causes);
        assert_eq!(budget.trust, Trust::NotKnownYet);
        let steps = budget.causes.iter().filter(|row| row.kind == Cause::TimeStep);
        for row in steps.filter(|row| row.failure.is_some()) {
            let said = budget.answer.matches(&row.changed).count();
            assert_eq!(said, 1, "{}: {}", row.changed, budget.answer);
        }
    }

    #[test]
    fn nothing_is_said_not_to_fit_into_the_time_before_the_end() {
        let variants = variants(&built_in("pile").unwrap(), Some(&NewPile::default()), true);
        let run = |SeriesRun { start, .. }| {
            let values = vec![Some(0.3 + 0.01 * start as f64)];
            let values = RunValues { values, failure: None, unsolved: 0.0, run_secs: 1.0 };
            Ok(Ran { values, secs: 1.0, is_free: false })
        };
        let stop = &mut |_: &Runs| ControlFlow::Break(());
        let costs = vec![1.0; variants.len() + 1];
        let (runs, ended) = collect(costs, 1, FREE, (&run, &|_| Ok(false)), stop).unwrap();
        let design = Design { variants: &variants, has_seeds: true, time_step_secs: 1e-3 };
        let budget = budget_of(&runs, ended, &design, (0, &"slump".parse().unwrap()), None);
        assert!(budget.causes.iter().all(|row| row.adds.is_none()), "{:?}", budget.causes);
        assert!(budget.answer.starts_with("The slump is 0."), "{}", budget.answer);
        assert!(budget.answer.ends_with("Not all runs are finished."), "{}", budget.answer);
        assert!(!budget.answer.contains("fit") && !budget.answer.contains("Nothing is known"));
    }

    /// Checks that one expensive change of the scene does not use up the computing time of the other changes. Here,
    /// runs under another contact law take ten times as long as expected. They must be left out, and every other change
    /// must be run from at least six initial states.
    #[test]
    fn a_law_that_is_dearer_than_expected_does_not_take_the_time_of_all_else() {
        let is_dear = |variant: &Variant| variant.cause == Cause::ContactLaw;
        let spent = std::sync::Mutex::new(0.0);
        let limits = Limits { cost_secs: 300.0, ..FREE };
        let budget = made_up_at(1, 0.0, limits, &|_| 0.0, &|variant| {
            let cost = variant.map_or(1.0, |one| one.cost * if is_dear(one) { 10.0 } else { 1.0 });
            *spent.lock().unwrap() += cost;
            cost
        });
        let laws = budget.causes.iter().filter(|row| row.kind == Cause::ContactLaw);
        let dear: Vec<&CauseRow> = laws.collect();
        assert_eq!(dear.len(), 2);
        for row in dear {
            let note = row.failure.as_deref().unwrap_or("");
            assert_eq!(note, "that does not fit into the time (a run takes 40 times as long)");
        }
        let others = |row: &&CauseRow| row.kind != Cause::ContactLaw;
        let all: Vec<&CauseRow> = budget.causes.iter().filter(others).collect();
        assert!(all.iter().all(|row| row.starts >= 6), "{all:?}");
        assert!(*spent.lock().unwrap() <= 300.0, "{spent:?}");
    }
}
