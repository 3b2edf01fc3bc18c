//! What a step costs by the number of grains: to a residual of Coulomb's law, and to a certificate.
//!
//! Collections of steps of piles that begin to slump, and of piles at rest in their box, without cohesion and
//! with. They stand in runs whose every step was certified under bounds of friction, so that what a warm start
//! takes over is the error of no method. A step's time is that of the whole step, contacts and motion
//! included, over that of one of forty sweeps of `nsgs`, which is measured beside each.

mod drawing;
mod plan;
mod race;
mod raced;
mod telling;

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use self::plan::{Plan, SIZES};
use self::race::{Race, race};
use self::raced::Raced;
use super::{Bench, Part};
use crate::collection::{CollectionPlan, collect};
use crate::error::Result;
use crate::journal::Journal;
use crate::output::Progress;

/// Races by problem and method.
type Done = HashMap<(String, String), Race>;

/// Races all methods over all sizes, and draws a figure of what moves and one of what rests.
pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let plan = Plan::new(bench.quick);
    let (journal, done) = bench.journal::<Race>("sizes")?;
    let mut done: Done = done.into_iter().map(|race| (race.key(), race)).collect();
    let mut parts = Vec::new();
    for (state, in_a_box) in [("moving", false), ("rest", true)] {
        let mut raced = Raced::new(state, &plan);
        for grains in SIZES {
            let collection = plan::steps(grains, in_a_box, bench.quick);
            let names = collection.names();
            let is_done = |name: &String| {
                let key = |method: &str| (name.clone(), method.to_owned());
                plan.entrants.iter().all(|entrant| done.contains_key(&key(&entrant.name)))
            };
            if !names.iter().all(is_done) {
                race_all(bench, &plan, &collection, &journal, &mut done)?;
            }
            raced.take(grains, &names, &done);
        }
        parts.push(Part {
            name: format!("chart-size-{state}"),
            sheet: drawing::draw(bench, &plan, &raced),
            report: telling::told(&plan, &raced),
            tables: vec![(format!("chart-size-{state}-times"), telling::table(&plan, &raced))],
        });
    }
    Ok(parts)
}

/// Races all methods over a collection, but for what was done before.
fn race_all(
    bench: &Bench,
    plan: &Plan,
    steps: &CollectionPlan,
    journal: &Journal,
    done: &mut Done,
) -> Result<()> {
    let collected = collect(steps, &bench.states_folder())?;
    let total = (plan.entrants.len() * collected.len()) as u64;
    let progress = Progress::new(&format!("{} grains", steps.grains), total);
    for step in &collected {
        for entrant in &plan.entrants {
            let key = (step.name.clone(), entrant.name.clone());
            if let Entry::Vacant(missing) = done.entry(key) {
                let race = race(step, entrant, plan)?;
                journal.add(&race)?;
                missing.insert(race);
            }
            progress.advance(1);
        }
    }
    progress.finish();
    Ok(())
}
