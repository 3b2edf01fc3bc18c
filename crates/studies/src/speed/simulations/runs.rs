//! The runs: references, and every method against them.

use std::collections::HashMap;

use rayon::prelude::*;

use super::super::runs::{Ending, TimedRun, timed_run};
use super::plan::Plan;
use crate::error::{Error, Result};
use crate::journal::Journal;
use crate::output::Progress;
use crate::sim::Stepper;
use crate::states::States;
use crate::statistics::mean;

/// A pile that slumps less than this holds.
const HOLDS: f64 = 0.1;

/// The law under which the floor is measured.
const FLOOR_LAW: Stepper = Stepper::Moreau;

/// What one method at one Δt and one effort comes to.
pub(super) struct Charted {
    /// Number in `Plan::efforts`.
    pub effort: usize,
    pub law: Stepper,
    pub time_step_secs: f64,
    /// The runs that reached their end, pile by pile; `None` where one did not.
    pub runs: Vec<Option<TimedRun>>,
    /// Why there is no point, where there is none.
    pub failed: Option<&'static str>,
    /// Simulated seconds per second.
    pub speed: f64,
    /// Mean |slump − reference| at the same Δt, and at the finest.
    pub errors: [f64; 2],
    /// Share of piles about which it says what the reference at the same Δt says: holds or not.
    pub verdicts: f64,
}

/// References by law, Δt, number of the pile and number of the tolerance.
pub(super) struct References(HashMap<(Stepper, u64, usize, usize), TimedRun>);

impl References {
    /// Slump of that pile. There is one for every law, Δt and pile of the plan, and at the finest Δt.
    pub(super) fn slump(&self, law: Stepper, time_step_secs: f64, pile: usize) -> f64 {
        self.to_tolerance(law, time_step_secs, pile, 0)
    }

    fn to_tolerance(&self, law: Stepper, time_step_secs: f64, pile: usize, number: usize) -> f64 {
        let key = (law, time_step_secs.to_bits(), pile, number);
        self.0.get(&key).map_or(f64::NAN, |run| run.slump)
    }

    /// Mean difference between two references of some piles, over the charted Δt.
    pub(super) fn floor(&self, plan: &Plan, piles: std::ops::Range<usize>) -> f64 {
        let mut differences = Vec::new();
        for &time_step_secs in &plan.time_steps_secs {
            for pile in piles.clone() {
                let slump = |number| self.to_tolerance(FLOOR_LAW, time_step_secs, pile, number);
                differences.push((slump(0) - slump(1)).abs());
            }
        }
        mean(&differences).mean
    }

    /// Steps that were not solved as asked, and all steps.
    pub(super) fn unsolved(&self) -> [u64; 2] {
        let sum = |number: fn(&TimedRun) -> u64| self.0.values().map(number).sum();
        [sum(|run| run.unconverged_steps), sum(|run| run.steps)]
    }
}

/// The references, and those that show the floor.
pub(super) fn references(
    plan: &Plan,
    states: &States,
    journal: &Journal,
    done: &mut HashMap<String, TimedRun>,
) -> Result<References> {
    let wanted = wanted(plan);
    let progress = Progress::new("references", wanted.len() as u64);
    let known = &*done;
    let runs: Result<Vec<_>> = wanted
        .into_par_iter()
        .with_max_len(1)
        .map(|Wanted { law, time_step_secs, pile, number }| {
            let (numbers, tolerance) = (plan.piles[pile], plan.tolerances[number]);
            let (bond, seed) = numbers;
            let key = format!(
                "reference {tolerance:e}, law {law}, Bond {bond}, seed {seed}, dt {time_step_secs:e}"
            );
            let run = match known.get(&key) {
                Some(run) => run.clone(),
                None => {
                    let mut scene = states.scene(&plan.config(numbers, time_step_secs, law))?;
                    scene.solver = plan.reference_to(tolerance);
                    let run = timed_run(key, &scene, 1, f64::INFINITY)?;
                    journal.add(&run)?;
                    run
                }
            };
            if run.ending != Ending::Done {
                return Err(Error::value(&run.key, "not finite", "finite to compare with it"));
            }
            progress.advance(1);
            Ok(((law, time_step_secs.to_bits(), pile, number), run))
        })
        .collect();
    progress.finish();
    Ok(References(runs?.into_iter().collect()))
}

/// One reference.
struct Wanted {
    law: Stepper,
    time_step_secs: f64,
    /// Number in `Plan::piles`.
    pile: usize,
    /// Number in `Plan::tolerances`.
    number: usize,
}

/// All references of a plan. The floor is that of the charted Δt alone.
fn wanted(plan: &Plan) -> Vec<Wanted> {
    let mut wanted = Vec::new();
    let is_charted = plan.time_steps_secs.contains(&plan.finest_secs);
    let finest = std::iter::once(plan.finest_secs).filter(|_| !is_charted);
    let steps: Vec<f64> = finest.chain(plan.time_steps_secs.iter().copied()).collect();
    for &law in &plan.laws {
        for &time_step_secs in &steps {
            let has_floor = law == FLOOR_LAW && plan.time_steps_secs.contains(&time_step_secs);
            for pile in 0..plan.piles.len() {
                let numbers = 0..if has_floor { 2 } else { 1 };
                wanted.extend(numbers.map(|number| Wanted { law, time_step_secs, pile, number }));
            }
        }
    }
    wanted
}

/// Every method at every Δt and effort.
pub(super) fn run_all(
    plan: &Plan,
    states: &States,
    journal: &Journal,
    done: &mut HashMap<String, TimedRun>,
    references: &References,
) -> Result<Vec<Charted>> {
    let points = plan.time_steps_secs.len() * plan.efforts.len();
    let progress = Progress::new("simulations", (points * plan.piles.len()) as u64);
    let mut charted = Vec::with_capacity(points);
    for &time_step_secs in &plan.time_steps_secs {
        for (number, effort) in plan.efforts.iter().enumerate() {
            let name = format!("{}, {}", plan.entrants[effort.entrant].name, effort.name);
            let mut runs = Vec::new();
            let mut failed = None;
            for &(bond, seed) in &plan.piles {
                progress.advance(1);
                if failed.is_some() {
                    runs.push(None);
                    continue;
                }
                let key = format!("{name}, Bond {bond}, seed {seed}, dt {time_step_secs:e}");
                let run = match done.remove(&key) {
                    Some(run) => run,
                    None => {
                        let config = plan.config((bond, seed), time_step_secs, effort.law);
                        let mut scene = states.scene(&config)?;
                        effort.way.take(&mut scene);
                        let limit_secs = plan.limit_secs * plan.duration_secs;
                        let run = timed_run(key, &scene, plan.repeats, limit_secs)?;
                        journal.add(&run)?;
                        run
                    }
                };
                failed = match run.ending {
                    Ending::Done => None,
                    Ending::TooSlow => Some("too slow"),
                    Ending::NotFinite => Some("not finite"),
                };
                runs.push(failed.is_none().then_some(run));
            }
            let mut point = Charted {
                effort: number,
                law: effort.law,
                time_step_secs,
                runs,
                failed,
                speed: 0.0,
                errors: [f64::NAN; 2],
                verdicts: 0.0,
            };
            point.sum_up(references, plan.finest_secs);
            charted.push(point);
        }
    }
    progress.finish();
    Ok(charted)
}

impl Charted {
    fn sum_up(&mut self, references: &References, finest_secs: f64) {
        if self.failed.is_some() {
            return;
        }
        let runs: Vec<&TimedRun> = self.runs.iter().flatten().collect();
        let sum = |number: fn(&TimedRun) -> f64| runs.iter().map(|run| number(run)).sum::<f64>();
        self.speed = sum(|run| run.simulated_secs) / sum(|run| run.wall_secs);
        let off = |step_secs: f64| {
            let off = |(pile, run): (usize, &&TimedRun)| {
                (run.slump - references.slump(self.law, step_secs, pile)).abs()
            };
            mean(&runs.iter().enumerate().map(off).collect::<Vec<_>>()).mean
        };
        self.errors = [off(self.time_step_secs), off(finest_secs)];
        let agree = runs.iter().enumerate().filter(|(pile, run)| {
            let reference = references.slump(self.law, self.time_step_secs, *pile);
            (run.slump < HOLDS) == (reference < HOLDS)
        });
        self.verdicts = agree.count() as f64 / runs.len().max(1) as f64;
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// References to each pile and tolerance whose slumps tell them apart.
    pub(in super::super) fn made_up(plan: &Plan) -> References {
        let references = wanted(plan).into_iter().map(|wanted| {
            let Wanted { law, time_step_secs, pile, number } = wanted;
            let run = TimedRun {
                key: String::new(),
                ending: Ending::Done,
                wall_secs: 2.0,
                simulated_secs: 1.0,
                steps: 10,
                unconverged_steps: number as u64,
                slump: pile as f64 + 0.01 * number as f64 + time_step_secs,
                mean_overlap: 1e-4,
            };
            ((law, time_step_secs.to_bits(), pile, number), run)
        });
        References(references.collect())
    }

    #[test]
    fn every_plan_has_its_references_once() {
        for plan in [
            Plan::of_paper(true),
            Plan::of_paper(false),
            Plan::of_large(true),
            Plan::of_large(false),
        ] {
            let references = made_up(&plan);
            assert_eq!(references.0.len(), wanted(&plan).len(), "none is wanted twice");
            let all = 0..plan.piles.len();
            for law in &plan.laws {
                for step_secs in plan.time_steps_secs.iter().chain([&plan.finest_secs]) {
                    let slump = |pile| references.slump(*law, *step_secs, pile);
                    assert!(all.clone().all(|pile| slump(pile) == pile as f64 + step_secs));
                }
            }
            assert!((references.floor(&plan, all) - 0.01).abs() < 1e-12);
            let [unsolved, steps] = references.unsolved();
            assert!(unsolved > 0 && unsolved < steps);
        }
    }
}
