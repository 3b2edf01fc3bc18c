//! Tests the choice of whole simulations whose speed is measured, and of their reference simulations.

use super::*;

/// Returns made-up results of all reference simulations, with a different slump for each pile, time step and tolerance.
fn made_up(plan: &SimulationPlan) -> References {
    let reference = |case: ReferenceCase| {
        let ReferenceCase { time_step_secs, pile, tolerance, .. } = case;
        let run = TimedRun {
            failed: None,
            least_secs: 2.0,
            simulated_secs: 1.0,
            steps: 10,
            unconverged_steps: tolerance as u64,
            slump: pile as f64 + 0.01 * tolerance as f64 + time_step_secs,
            mean_overlap: 1e-4,
        };
        (case, run)
    };
    References(References::cases(plan).into_iter().map(reference).collect())
}

#[test]
fn every_plan_has_its_references_once() {
    for plan in [Effort::Quick, Effort::Full].map(SimulationPlan::new) {
        let references = made_up(&plan);
        for (number, (case, _)) in references.0.iter().enumerate() {
            let before = &references.0[..number];
            assert!(before.iter().all(|(other, _)| other != case), "none is wanted twice");
        }
        for &law in &plan.laws {
            for &time_step_secs in plan.time_steps_secs.iter().chain([&FINEST_SECS]) {
                for pile in 0..plan.piles.len() {
                    let case = ReferenceCase { law, time_step_secs, pile, tolerance: 0 };
                    assert_eq!(references.slump(case), pile as f64 + time_step_secs);
                }
            }
        }
        assert!((references.floor(&plan) - 0.01).abs() < 1e-12);
        let [unsolved, steps] = references.unsolved();
        assert!(unsolved > 0 && unsolved < steps);
    }
}
