//! Progress reports of long solves to an onlooker, which may end them. A process has at most one onlooker; the command
//! line sets it for a single solve. A solve that the onlooker ends has not converged; no other result depends on it.

use std::ops::ControlFlow;
use std::sync::OnceLock;

/// Progress of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveProgress {
    /// Sweeps so far, or iterations if the method has no sweeps.
    pub sweeps: u32,
    /// The residual, dimensionless, after each doubling of the number of sweeps; `None` in between.
    pub residual: Option<f64>,
}

type Onlooker = Box<dyn Fn(SolveProgress) -> ControlFlow<()> + Send + Sync>;

static ONLOOKER: OnceLock<Onlooker> = OnceLock::new();

/// Reports every later solve of this process to `onlooker` after each sweep, and ends a solve if the onlooker breaks.
/// Only the first call sets the onlooker.
pub fn look_on(onlooker: impl Fn(SolveProgress) -> ControlFlow<()> + Send + Sync + 'static) {
    ONLOOKER.get_or_init(|| Box::new(onlooker));
}

/// Returns true if the onlooker ends a solve that has got this far.
pub fn is_ended(progress: SolveProgress) -> bool {
    ONLOOKER.get().is_some_and(|onlooker| onlooker(progress).is_break())
}
