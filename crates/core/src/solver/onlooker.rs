//! An onlooker at long solves: it sees how far a solve is, and may end it. A process has one, which its command line
//! sets for a single solve. A solve that the onlooker ends has not converged; no other result depends on it.

use std::ops::ControlFlow;
use std::sync::OnceLock;

/// How far a solve is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveProgress {
    /// Sweeps so far, or iterations of a method without sweeps.
    pub sweeps: u32,
    /// The residual, dimensionless, after each doubling of the sweeps; none between.
    pub residual: Option<f64>,
}

type Onlooker = Box<dyn Fn(SolveProgress) -> ControlFlow<()> + Send + Sync>;

static ONLOOKER: OnceLock<Onlooker> = OnceLock::new();

/// Shows every further solve of this process to an onlooker after each sweep, and ends those of which it says so. The
/// first onlooker stays.
pub fn look_on(onlooker: impl Fn(SolveProgress) -> ControlFlow<()> + Send + Sync + 'static) {
    ONLOOKER.get_or_init(|| Box::new(onlooker));
}

/// True if the onlooker ends the solve that is so far.
pub fn is_ended(progress: SolveProgress) -> bool {
    ONLOOKER.get().is_some_and(|onlooker| onlooker(progress).is_break())
}
