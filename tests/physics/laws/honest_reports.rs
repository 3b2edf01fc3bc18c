//! A step that is said to be solved has a residual that says so.

use crate::common::*;

#[test]
fn converged_never_stands_beside_a_residual_that_is_not_finite() {
    for (stepper, method) in every_way() {
        let mut cradle = built_in("cradle").expect("the cradle");
        cradle.stepper = stepper;
        cradle.solver.method = method;
        let mut run = start(&cradle);
        for _ in 0..20 {
            let seen = *run.step().expect("a finite state");
            let is_finite = seen.residual.is_finite();
            assert!(is_finite || !seen.converged, "{stepper} {method}: {seen:?}");
            // Nothing moves at first: what rounding leaves over is no residual.
            assert!(is_finite || !stepper.uses_method(), "{stepper} {method}: {seen:?}");
        }
    }
}
