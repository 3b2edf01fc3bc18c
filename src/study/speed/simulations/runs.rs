//! The runs: references, and every method against them.

use std::collections::HashMap;

use rayon::prelude::*;

use super::super::runs::{Ending, TimedRun, timed_run};
use super::plan::{FINEST_SECS, Plan, REFERENCE, config};
use crate::error::{Error, Result};
use crate::output::Progress;
use crate::sim::Stepper;
use crate::solver::{Method, SolverSettings, StopTest};
use crate::study::journal::Journal;
use crate::study::states::States;
use crate::study::statistics::mean;

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

/// Slumps of references by law, Δt and number of the pile.
pub(super) struct References(HashMap<(Stepper, u64, usize), f64>);

impl References {
    /// Slump of that pile. There is one for every law, Δt and pile of the plan, and at the finest Δt.
    pub(super) fn slump(&self, law: Stepper, time_step_secs: f64, pile: usize) -> f64 {
        self.0.get(&(law, time_step_secs.to_bits(), pile)).copied().unwrap_or(f64::NAN)
    }
}

/// The slumps of the references, and of those that show the floor.
pub(super) fn references(
    plan: &Plan,
    states: &States,
    journal: &Journal,
    done: &mut HashMap<String, TimedRun>,
) -> Result<[References; 2]> {
    let mut wanted = Vec::new();
    let steps = || std::iter::once(&FINEST_SECS).chain(&plan.time_steps_secs);
    for &law in &plan.laws {
        for &time_step_secs in steps() {
            for (pile, &numbers) in plan.piles.iter().enumerate() {
                for (number, tolerance) in REFERENCE.into_iter().enumerate() {
                    if law == FLOOR_LAW || number == 0 {
                        wanted.push((law, time_step_secs, pile, numbers, number, tolerance));
                    }
                }
            }
        }
    }
    let progress = Progress::new("references", wanted.len() as u64);
    let known = &*done;
    let runs: Result<Vec<_>> = wanted
        .into_par_iter()
        .with_max_len(1)
        .map(|(law, time_step_secs, pile, numbers, number, tolerance)| {
            let (bond, seed) = numbers;
            let key = format!(
                "reference {tolerance:e}, law {law}, Bond {bond}, seed {seed}, dt {time_step_secs:e}"
            );
            let run = match known.get(&key) {
                Some(run) => run.clone(),
                None => {
                    let mut scene = states.scene(&config(numbers, time_step_secs, law))?;
                    scene.solver = SolverSettings {
                        method: Method::Newton,
                        stop: StopTest::Residual,
                        tolerance,
                        ..SolverSettings::default()
                    };
                    let run = timed_run(key, &scene, 1, f64::INFINITY)?;
                    journal.add(&run)?;
                    run
                }
            };
            if run.ending != Ending::Done {
                return Err(Error::value(&run.key, "not finite", "finite to compare with it"));
            }
            progress.advance(1);
            Ok((number, (law, time_step_secs.to_bits(), pile), run.slump))
        })
        .collect();
    progress.finish();
    let mut references = [(); 2].map(|()| References(HashMap::new()));
    for (number, key, slump) in runs? {
        references[number].0.insert(key, slump);
    }
    Ok(references)
}

/// Mean difference between two references, over all piles and the charted Δt.
pub(super) fn floor(plan: &Plan, references: &References, others: &References) -> f64 {
    let mut differences = Vec::new();
    for time_step_secs in &plan.time_steps_secs {
        for pile in 0..plan.piles.len() {
            let slump = |of: &References| of.slump(FLOOR_LAW, *time_step_secs, pile);
            differences.push((slump(references) - slump(others)).abs());
        }
    }
    mean(&differences).mean
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
                        let config = config((bond, seed), time_step_secs, effort.law);
                        let mut scene = states.scene(&config)?;
                        effort.way.take(&mut scene);
                        let run = timed_run(key, &scene, plan.repeats, plan.limit_secs)?;
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
            point.sum_up(references);
            charted.push(point);
        }
    }
    progress.finish();
    Ok(charted)
}

impl Charted {
    fn sum_up(&mut self, references: &References) {
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
        self.errors = [off(self.time_step_secs), off(FINEST_SECS)];
        let agree = runs.iter().enumerate().filter(|(pile, run)| {
            let reference = references.slump(self.law, self.time_step_secs, *pile);
            (run.slump < HOLDS) == (reference < HOLDS)
        });
        self.verdicts = agree.count() as f64 / runs.len().max(1) as f64;
    }
}
