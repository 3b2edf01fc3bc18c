//! What the methods came to in one state of the piles, size by size.

use std::collections::HashMap;

use super::plan::Plan;
use super::race::Race;
use crate::performance::{Timing, median_with_failures, share_solved};

/// All races in one state of the piles.
pub(super) struct Raced {
    /// In the names of files.
    pub state: &'static str,
    /// Grains, and the races of each entrant.
    pub sizes: Vec<(usize, Vec<Vec<Race>>)>,
    entrants: Vec<String>,
}

/// What an entrant comes to at one size and goal.
pub(super) struct Summary {
    /// Steps.
    pub steps: usize,
    /// Share of them that reach the goal.
    pub share: f64,
    /// Median time of a whole step over that of the unit; none where half of the steps do not reach it.
    pub median: Option<f64>,
    /// The same time, s.
    pub median_secs: Option<f64>,
}

impl Raced {
    pub(super) fn new(state: &'static str, plan: &Plan) -> Self {
        let entrants = plan.entrants.iter().map(|entrant| entrant.name.clone()).collect();
        Self { state, sizes: Vec::new(), entrants }
    }

    /// Takes up what is there of the steps of one size.
    pub(super) fn take(
        &mut self,
        grains: usize,
        problems: &[String],
        done: &HashMap<(String, String), Race>,
    ) {
        let of = |entrant: &String| {
            let race = |problem: &String| done.get(&(problem.clone(), entrant.clone())).cloned();
            problems.iter().filter_map(race).collect()
        };
        self.sizes.push((grains, self.entrants.iter().map(of).collect()));
    }

    /// One entrant at one size.
    pub(super) fn summary(&self, size: usize, entrant: usize, goal: f64) -> Summary {
        let races = &self.sizes[size].1[entrant];
        let timings = |unit: fn(&Race) -> f64| -> Vec<Timing> {
            let timing = |race: &Race| {
                let secs = race.step_secs(goal) / unit(race);
                Timing { secs, solved: secs.is_finite() }
            };
            races.iter().map(timing).collect()
        };
        let by_unit = timings(|race| race.unit_secs);
        Summary {
            steps: races.len(),
            share: share_solved(&by_unit),
            median: median_with_failures(&by_unit),
            median_secs: median_with_failures(&timings(|_| 1.0)),
        }
    }

    /// The largest duality gap of what reached a goal; not a number where nothing did.
    pub(super) fn largest_gap(&self, goal: f64) -> f64 {
        let races = self.sizes.iter().flat_map(|(_, races)| races.iter().flatten());
        let gaps = races.filter_map(|race| race.reached(goal)?.duality_gap);
        gaps.fold(f64::NAN, f64::max)
    }

    /// Time of a step of the unit at one size, median of all, s.
    pub(super) fn unit_secs(&self, size: usize) -> f64 {
        let races = self.sizes[size].1.iter().flatten();
        let units: Vec<_> =
            races.map(|race| Timing { secs: race.unit_secs, solved: true }).collect();
        median_with_failures(&units).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::plan::RESIDUALS;
    use super::super::race::{Course, Reached};
    use super::*;

    /// A race in which each goal takes a third of a unit more than the one before.
    fn race(problem: &str, method: &str, goals: &[f64]) -> Race {
        let reached = goals.iter().zip(1..).map(|(&goal, number)| Reached {
            goal,
            solve_secs: f64::from(number),
            left: goal,
            duality_gap: None,
        });
        let course = Course {
            contacts: 9,
            start: 1.0,
            smallest: 1e-4,
            reached: reached.collect(),
            gave_up_secs: Some(30.0),
        };
        let (problem, method) = (problem.to_owned(), method.to_owned());
        Race { problem, method, unit_secs: 3.0, besides_secs: 0.5, course }
    }

    /// Two sizes of four steps each. The first entrant reaches all goals at the smaller, and at the larger the
    /// first goal in half of the steps; the others reach nothing.
    pub(in super::super) fn made_up(plan: &Plan) -> Raced {
        let mut raced = Raced::new("moving", plan);
        for (grains, goals) in [(500, [3; 4]), (2_000, [1, 1, 0, 0])] {
            let problems = [0, 1, 2, 3].map(|number| format!("{grains}, {number}"));
            let mut done = HashMap::new();
            for (number, entrant) in plan.entrants.iter().enumerate() {
                for (problem, goals) in problems.iter().zip(goals) {
                    let goals = if number == 0 { &RESIDUALS[..goals] } else { &[] };
                    let race = race(problem, &entrant.name, goals);
                    done.insert(race.key(), race);
                }
            }
            raced.take(grains, &problems, &done);
        }
        raced
    }

    #[test]
    fn a_summary_is_of_whole_steps_and_has_no_median_where_half_of_them_fail() {
        let raced = made_up(&Plan::new(true));
        let [first, second, _] = RESIDUALS;
        let all = raced.summary(0, 0, second);
        assert_eq!((all.steps, all.share), (4, 1.0));
        assert_eq!((all.median_secs, all.median), (Some(2.5), Some(2.5 / 3.0)));
        let half = raced.summary(1, 0, first);
        assert_eq!((half.share, half.median), (0.5, None));
        assert_eq!(raced.summary(1, 0, second).share, 0.0);
        assert_eq!(raced.unit_secs(1), 3.0);
    }
}
