//! Progress reports of long solves to an onlooker: a callback that receives the progress and may end the solve. A
//! process has at most one onlooker; the command line program sets it if it solves a single contact problem. A solve
//! that the onlooker ends has not converged. The onlooker has no other effect on results.

use std::ops::ControlFlow;
use std::sync::OnceLock;

/// Progress of a solve that is not finished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveProgress {
    /// Number of sweeps so far, or of iterations if the method has no sweeps.
    pub sweeps: u32,
    /// The residual of the contact laws, dimensionless, after each doubling of the number of sweeps; `None` in between.
    pub residual: Option<f64>,
}

type Onlooker = Box<dyn Fn(SolveProgress) -> ControlFlow<()> + Send + Sync>;

static ONLOOKER: OnceLock<Onlooker> = OnceLock::new();

/// Sets the onlooker of this process. Every later solve reports its progress to `onlooker` after each sweep, and ends
/// if `onlooker` returns `Break`. Only the first call has an effect.
pub fn look_on(onlooker: impl Fn(SolveProgress) -> ControlFlow<()> + Send + Sync + 'static) {
    ONLOOKER.get_or_init(|| Box::new(onlooker));
}

/// Reports `progress` to the onlooker, if there is one, and returns true if the onlooker ends the solve.
pub fn is_ended(progress: SolveProgress) -> bool {
    ONLOOKER.get().is_some_and(|onlooker| onlooker(progress).is_break())
}
