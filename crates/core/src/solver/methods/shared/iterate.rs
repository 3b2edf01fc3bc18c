//! What iterations that are no sweeps share: dot products, the test at the end of an iteration, and
//! the best impulses so far.

use super::contact_system::{ContactSystem, Pairs};
use super::stall::StallWatch;
use crate::contact::law;
use crate::solver::methods::report::SolveReport;
use crate::solver::settings::{SolverSettings, StopTest};

/// After this many sweeps the stopping test is made only after every [`TEST_INTERVAL`]th: a sweep
/// that also measures itself costs more. A smaller number makes well-started steps dearer.
const SWEEPS_TESTED_EACH: u32 = 16;
/// Sweeps between two tests of a long solve; the most that are done in vain.
const TEST_INTERVAL: u32 = 8;
/// Iterations between two looks at the residual, where the stopping test does not ask for it. More
/// often costs more; less often, and a better iterate may be missed when a solve fails.
const LOOK_INTERVAL: u32 = 16;

/// Whether the stopping test is made after sweep (or iteration) number `sweeps`, counted from 1.
pub(crate) fn is_tested(sweeps: u32, settings: &SolverSettings) -> bool {
    sweeps <= SWEEPS_TESTED_EACH
        || sweeps.is_multiple_of(TEST_INTERVAL)
        || sweeps == settings.max_sweeps
        || settings.stop == StopTest::ImpulsePerMass
}

/// Sweeps over `problem` until `sweep`, which is given the number of the sweep from 1, says that the
/// stopping test is met, until nothing is gained any more, or up to the limit.
pub(crate) fn sweep_until_settled<P>(
    problem: &mut P,
    settings: &SolverSettings,
    mut sweep: impl FnMut(&mut P, u32) -> bool,
    residual: impl Fn(&mut P) -> f64,
) -> SolveReport {
    let mut watch = StallWatch::default();
    let mut sweeps = 0;
    while sweeps < settings.max_sweeps {
        sweeps += 1;
        if sweep(problem, sweeps) {
            return SolveReport { sweeps, converged: true, ..SolveReport::default() };
        }
        if watch.look(sweeps, settings, || residual(problem)) {
            break;
        }
    }
    let stalled = watch.has_stalled(sweeps, residual(problem));
    SolveReport { sweeps, stalled, ..SolveReport::default() }
}

/// What the contact laws make of impulses that a step has led to: the nearest normal impulse that
/// is allowed, then the nearest tangential one that this allows.
#[inline(always)]
pub(crate) fn projected<S: ContactSystem>(
    system: &S,
    contact: usize,
    [normal, tangential]: [f64; 2],
) -> [f64; 2] {
    let normal = law::signorini(normal);
    if !S::FRICTION {
        return [normal, 0.0];
    }
    [normal, law::coulomb(tangential, system.friction_bound(contact, normal))]
}

/// Σ a·b, in four sums that do not wait for each other.
pub(crate) fn dot(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let mut sums = [0.0; 4];
    let (mut pairs_of_a, mut pairs_of_b) = (a.chunks_exact(2), b.chunks_exact(2));
    for (a, b) in (&mut pairs_of_a).zip(&mut pairs_of_b) {
        sums[0] += a[0][0] * b[0][0];
        sums[1] += a[0][1] * b[0][1];
        sums[2] += a[1][0] * b[1][0];
        sums[3] += a[1][1] * b[1][1];
    }
    for (a, b) in pairs_of_a.remainder().iter().zip(pairs_of_b.remainder()) {
        sums[0] += a[0] * b[0];
        sums[1] += a[1] * b[1];
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// The impulses of the smallest residual seen so far.
pub(crate) struct Best<'a> {
    impulses: &'a mut Pairs,
    residual: f64,
    watch: StallWatch,
}

impl<'a> Best<'a> {
    /// Starts with the present impulses of a system.
    pub(crate) fn new<S: ContactSystem>(system: &S, impulses: &'a mut Pairs) -> Self {
        system.read(impulses);
        Self { impulses, residual: system.residual(), watch: StallWatch::default() }
    }

    /// Looks at `impulses`, which are the system's present ones, after iteration `sweeps`; now and
    /// then only. Tells whether to stop, since nothing better is to be had.
    pub(crate) fn look<S: ContactSystem>(
        &mut self,
        system: &S,
        impulses: &[[f64; 2]],
        sweeps: u32,
        settings: &SolverSettings,
    ) -> bool {
        if !sweeps.is_multiple_of(LOOK_INTERVAL) {
            return false;
        }
        let residual = system.residual();
        if residual < self.residual {
            self.residual = residual;
            self.impulses.clear();
            self.impulses.extend_from_slice(impulses);
        }
        self.watch.look(sweeps, settings, || self.residual)
    }

    /// The end of a solve that failed: the system has the best impulses of all, its present ones
    /// included.
    pub(crate) fn restore<S: ContactSystem>(self, system: &mut S, sweeps: u32) -> SolveReport {
        let residual = system.residual();
        // Not a number is not better than anything.
        let present_is_best = residual <= self.residual;
        if !present_is_best {
            system.write(self.impulses);
        }
        let best = if present_is_best { residual } else { self.residual };
        let stalled = self.watch.has_stalled(sweeps, best);
        SolveReport { sweeps, stalled, ..SolveReport::default() }
    }
}
