//! The one pile without cohesion: all that other engines run, from the same state.

use super::super::peers::PeerRun;
use super::plan::Plan;
use super::runs::{Charted, References};
use crate::sim::Stepper;

/// Its number in `Plan::piles`.
pub(super) const ALONE: usize = 0;

/// What a run of it comes to.
pub(super) struct Alone {
    /// Simulated seconds per second.
    pub speed: f64,
    /// |slump − reference| at the finest Δt.
    pub error: f64,
    /// Mean over the run, in diameters.
    pub mean_overlap: f64,
}

/// One method at one Δt and effort; nothing where its run failed.
pub(super) fn alone(plan: &Plan, point: &Charted, references: &References) -> Option<Alone> {
    let run = point.runs.get(ALONE)?.as_ref()?;
    let reference = references.slump(point.law, plan.finest_secs, ALONE);
    Some(Alone {
        speed: run.simulated_secs / run.wall_secs,
        error: (run.slump - reference).abs(),
        mean_overlap: run.mean_overlap,
    })
}

/// Another engine.
pub(super) fn of_peer(plan: &Plan, run: &PeerRun, references: &References) -> Alone {
    let reference = references.slump(Stepper::Moreau, plan.finest_secs, ALONE);
    Alone {
        speed: run.speed(),
        error: (run.slump - reference).abs(),
        mean_overlap: run.mean_overlap,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::super::peers;
    use super::super::runs::tests::made_up;
    use super::*;

    #[test]
    fn other_engines_are_held_against_the_pile_that_they_ran() {
        for plan in [Plan::of_paper(false), Plan::of_large(false)] {
            assert!(plan.has_peers && plan.piles[ALONE].0 == 0.0);
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers/results");
            let mut runs = peers::read(&folder).expect("tables");
            runs.retain(|run| run.is_collapse_of(plan.made_as.grains));
            assert!(!runs.is_empty(), "{} grains", plan.made_as.grains);
            let references = made_up(&plan);
            for run in &runs {
                let alone = of_peer(&plan, run, &references);
                assert_eq!(alone.error, (run.slump - plan.finest_secs).abs());
                assert_eq!(alone.speed, 1.0 / run.secs_per_simulated_sec);
            }
        }
        assert!(!Plan::of_large(true).has_peers, "which starts from another state");
    }
}
