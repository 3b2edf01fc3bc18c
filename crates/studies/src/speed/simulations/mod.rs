//! Speed against accuracy of whole simulations: what a pile's slump is off by, and how many seconds
//! are simulated in one.
//!
//! Steps are posed with the restitution threshold with which nearly all of them have a solution: an
//! error of the solver means something only where there is something to be solved. Two errors are
//! told apart. Against the reference *at the same Δt* a slump is off by what the solver left undone;
//! against the reference at the finest Δt also by the time step. Piles are chaotic: two references,
//! one solved ten times tighter than the other, differ by the *floor*, and no error below it means
//! anything. Other engines have no cohesion, and stand beside the one run from the state that they ran from. The law `range` is another model of the same pile, and is held against references of its
//! own.

mod alone;
mod drawing;
mod plan;
mod runs;
mod telling;

use std::collections::HashMap;

use self::plan::Plan;
use super::runs::TimedRun;
use super::{Bench, Part, peers};
use crate::error::Result;
use crate::sim::Stepper;
use crate::states::States;

pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let mut parts = vec![of_plan(bench, &Plan::of_paper(bench.quick))?];
    if bench.large {
        parts.push(of_plan(bench, &Plan::of_large(bench.quick))?);
    }
    Ok(parts)
}

fn of_plan(bench: &Bench, plan: &Plan) -> Result<Part> {
    let of_pile = |&pile| plan.config(pile, plan.finest_secs, Stepper::Moreau);
    let configs: Vec<_> = plan.piles.iter().map(of_pile).collect();
    let states = States::of(bench.states_folder(), configs.iter())?;
    let label = plan.label;
    let (journal, done) = bench.journal::<TimedRun>(&format!("simulations{label}"))?;
    let mut done: HashMap<String, TimedRun> =
        done.into_iter().map(|run| (run.key.clone(), run)).collect();
    let references = runs::references(plan, &states, &journal, &mut done)?;
    let charted = runs::run_all(plan, &states, &journal, &mut done, &references)?;
    let mut peers = peers::read(&bench.peers)?;
    peers.retain(|run| plan.has_peers && run.is_collapse_of(plan.made_as.grains));
    Ok(Part {
        name: format!("chart-simulation{label}"),
        sheet: drawing::draw(bench, plan, &charted, &references, &peers),
        report: telling::told(plan, &charted, &references, &peers),
        tables: vec![(format!("chart-simulation{label}-points"), telling::table(plan, &charted))],
    })
}
