//! Speed against accuracy of single steps: residual against time, and performance profiles.

mod drawing;
mod raced;
mod telling;

use std::collections::HashMap;

use self::drawing::{profiles, residuals};
use self::raced::Raced;
use super::race::{Course, Race, Runner};
use super::{Bench, Part, entrants};
use crate::collection::{CollectedStep, CollectionPlan, collect};
use crate::error::Result;
use crate::output::Progress;

/// Threshold of restitution with which nearly every step has a solution.
const THRESHOLD: f64 = 2.0;

/// Races all methods over all collections and writes what came of it.
pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let course = course(bench.quick);
    let pick = if bench.quick { CollectionPlan::fewer_piles } else { CollectionPlan::piles };
    let mut parts = Vec::new();
    let mut raced = Vec::new();
    for (label, plan, title) in [
        ("", pick(THRESHOLD), "restitution from 2 g·Δt up"),
        ("-paper", pick(0.0), "restitution as in the paper"),
    ] {
        raced.push(race_all(bench, &plan, &course, label, title)?);
    }
    parts.push(residuals(bench, &raced, &course));
    for raced in &raced {
        parts.push(profiles(bench, raced));
    }
    Ok(parts)
}

/// Residuals by half decades, or, in the quick pass, decades.
fn course(quick: bool) -> Course {
    let per_decade = if quick { 1 } else { 2 };
    // Written out in decimals, so that 1e-3 is 1e-3.
    let tolerance = |index: i32| {
        let exact = 10f64.powf(-1.0 - f64::from(index) / f64::from(per_decade));
        format!("{exact:.2e}").parse().unwrap_or(exact)
    };
    Course {
        tolerances: (0..=9 * per_decade).map(tolerance).collect(),
        max_sweeps: 200_000,
        limit_secs: if quick { 0.25 } else { 3.0 },
    }
}

fn race_all(
    bench: &Bench,
    plan: &CollectionPlan,
    course: &Course,
    label: &'static str,
    title: &str,
) -> Result<Raced> {
    let (journal, done) = bench.journal::<Race>(&format!("steps{label}"))?;
    let mut done: HashMap<(String, String), Race> =
        done.into_iter().map(|race| ((race.problem.clone(), race.method.clone()), race)).collect();
    let collected = collect(plan, &bench.states_folder())?;
    let entrants = entrants::of_problems(!bench.quick);
    let total = (entrants.len() * collected.len()) as u64;
    let progress = Progress::new(&format!("steps{label}"), total);
    let mut races: Vec<Vec<Race>> = entrants.iter().map(|_| Vec::new()).collect();
    for CollectedStep { name, simulation, .. } in &collected {
        for (entrant, races) in entrants.iter().zip(&mut races) {
            let race = match done.remove(&(name.clone(), entrant.name.clone())) {
                Some(race) => race,
                None => {
                    // The method decides on the order of the problem's rows.
                    let mut simulation = simulation.clone();
                    simulation.set_solver(entrant.sweeps(1).solver)?;
                    let race = simulation.next_problem(Runner { problem: name, entrant, course });
                    journal.add(&race)?;
                    race
                }
            };
            races.push(race);
            progress.advance(1);
        }
    }
    progress.finish();
    let title = format!("{} steps, {title}", collected.len());
    Ok(Raced { label, title, entrants, races })
}
