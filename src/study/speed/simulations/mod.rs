//! Speed against accuracy of whole simulations: what a pile's slump is off by, and how many seconds
//! are simulated in one.
//!
//! Steps are posed with the restitution threshold with which nearly all of them have a solution: an
//! error of the solver means something only where there is something to be solved. Two errors are
//! told apart. Against the reference *at the same Δt* a slump is off by what the solver left undone;
//! against the reference at [`plan::FINEST_SECS`] also by the time step. Piles are chaotic: two references,
//! one solved ten times tighter than the other, differ by the *floor*, and no error below it means
//! anything. The law `range` is another model of the same pile, and is held against references of its
//! own.

mod drawing;
mod plan;
mod runs;
mod telling;

use std::collections::HashMap;

use self::plan::{Plan, config};
use super::runs::TimedRun;
use super::{Bench, Part, peers};
use crate::error::Result;
use crate::sim::Stepper;
use crate::study::states::States;

pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let plan = Plan::new(bench.quick);
    let states = States::of(
        bench.states_folder(),
        plan.piles
            .iter()
            .map(|&pile| config(pile, 1e-3, Stepper::Moreau))
            .collect::<Vec<_>>()
            .iter(),
    )?;
    let (journal, done) = bench.journal::<TimedRun>("simulations")?;
    let mut done: HashMap<String, TimedRun> =
        done.into_iter().map(|run| (run.key.clone(), run)).collect();
    let [references, others] = runs::references(&plan, &states, &journal, &mut done)?;
    let charted = runs::run_all(&plan, &states, &journal, &mut done, &references)?;
    let floor = runs::floor(&plan, &references, &others);
    let peers = peers::read(&bench.peers)?;
    Ok(vec![Part {
        name: "chart-simulation".into(),
        sheet: drawing::draw(bench, &plan, &charted, floor, &references, &peers),
        report: telling::told(&plan, &charted, floor),
        tables: vec![("chart-simulation-points".into(), telling::table(&plan, &charted))],
    }])
}
