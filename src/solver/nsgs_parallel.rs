//! Gauss–Seidel by colours, on several threads.
//!
//! Contacts of one colour share no grain (`solver::order`), so none of them sees what another does:
//! a colour's contacts can be solved in any order, at the same time, to bitwise the same result. The
//! colours follow each other. Few contacts are not worth waking threads for, and are solved by the
//! one at hand, in the same portions: what is summed over a sweep is summed in one order whatever
//! the number of threads.

use rayon::prelude::*;

use super::iterate::{is_tested, sweep_until_settled};
use super::measure::residual;
use super::nsgs::{self, Change, Law, is_settled};
use super::{Kinematics, Model, Row, SolveReport, SolverSettings, StepProblem, StopTest};

/// Contacts that a thread takes at a time.
const PORTION: usize = 512;
/// Contacts of a colour from which on threads are woken: some 10 µs of work, about what waking costs.
const WORTH_THREADS: usize = 4 * PORTION;

/// The colours of a problem's rows. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Colouring {
    /// Ends of the colours in the rows against fixed bodies and in those between grains; empty where
    /// rows are not coloured.
    pub ends: [Vec<usize>; 2],
    /// The last colour that each grain was seen in.
    seen: Vec<usize>,
    /// What the portions of a colour changed.
    changes: Vec<Change>,
}

/// Solves a prepared problem by sweeps.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    let mut colouring = std::mem::take(&mut problem.colouring);
    let report = match Coloured::<M>::new(problem, &mut colouring) {
        Some(mut coloured) => coloured.run(settings),
        None => nsgs::solve::<M>(problem, settings),
    };
    problem.colouring = colouring;
    report
}

/// A problem whose rows' grains all exist and whose colours are none that share a grain.
struct Coloured<'a, M: Model> {
    problem: &'a mut StepProblem<M::Kinematics>,
    ends: &'a [Vec<usize>; 2],
    changes: &'a mut Vec<Change>,
}

impl<'a, M: Model> Coloured<'a, M> {
    /// Nothing where the problem is not such a one.
    fn new(
        problem: &'a mut StepProblem<M::Kinematics>,
        colouring: &'a mut Colouring,
    ) -> Option<Self> {
        let Colouring { ends, seen, changes } = colouring;
        seen.clear();
        seen.resize(problem.bodies.len(), 0);
        let mut colour = 0;
        let mut is_first_in_colour = |grain: u32, colour: usize| {
            seen.get_mut(grain as usize)
                .is_some_and(|seen| std::mem::replace(seen, colour) != colour)
        };
        for (rows, ends, is_pair) in
            [(&problem.fixed_rows, &ends[0], false), (&problem.pair_rows, &ends[1], true)]
        {
            let mut start = 0;
            for &end in ends {
                colour += 1;
                for row in rows.get(start..end)? {
                    let is_free = is_first_in_colour(row.i, colour)
                        && (!is_pair || is_first_in_colour(row.j, colour));
                    if !is_free {
                        return None;
                    }
                }
                start = end;
            }
            if start != rows.len() {
                return None;
            }
        }
        Some(Self { problem, ends, changes })
    }

    fn run(&mut self, settings: &SolverSettings) -> SolveReport {
        let sweep = |coloured: &mut Self, sweeps| {
            if !is_tested(sweeps, settings) {
                coloured.sweep::<false>();
                return false;
            }
            let change = match settings.stop {
                StopTest::Residual => coloured.sweep::<false>(),
                _ => coloured.sweep::<true>(),
            };
            is_settled::<M>(coloured.problem, change, settings)
        };
        sweep_until_settled(self, settings, sweep, |coloured| residual::<M>(coloured.problem))
    }

    /// One pass over all contacts.
    fn sweep<const MEASURE: bool>(&mut self) -> Change {
        let law = Law::of(self.problem);
        let StepProblem { bodies, fixed_rows, pair_rows, .. } = &mut *self.problem;
        let bodies = Bodies::<M>(bodies.as_mut_ptr());
        let mut change = Change::default();
        let mut start = 0;
        for &end in &self.ends[0] {
            change.add_all(sweep_colour(&mut fixed_rows[start..end], self.changes, |rows| {
                // SAFETY: as `Bodies` says.
                unsafe { solve_apart::<M, MEASURE, false>(&law, rows, bodies) }
            }));
            start = end;
        }
        start = 0;
        for &end in &self.ends[1] {
            change.add_all(sweep_colour(&mut pair_rows[start..end], self.changes, |rows| {
                // SAFETY: as `Bodies` says.
                unsafe { solve_apart::<M, MEASURE, true>(&law, rows, bodies) }
            }));
            start = end;
        }
        change
    }
}

/// Solves a colour's portions, on several threads where it pays.
fn sweep_colour<K: Kinematics>(
    rows: &mut [Row<K>],
    changes: &mut Vec<Change>,
    solve: impl Fn(&mut [Row<K>]) -> Change + Send + Sync,
) -> Change {
    let mut change = Change::default();
    if rows.len() < WORTH_THREADS {
        rows.chunks_mut(PORTION).for_each(|portion| change.add_all(solve(portion)));
    } else {
        rows.par_chunks_mut(PORTION).map(solve).collect_into_vec(changes);
        changes.iter().for_each(|&portion| change.add_all(portion));
    }
    change
}

/// The bodies, to be reached from several threads.
///
/// [`Coloured`] has looked at every row: its grains are among the bodies, and no other row of its
/// colour has one of them. While a colour is solved each body is thus touched from one place only.
struct Bodies<M: Model>(*mut <M::Kinematics as Kinematics>::Body);

impl<M: Model> Clone for Bodies<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Model> Copy for Bodies<M> {}

// SAFETY: bodies are plain numbers (`Kinematics::Body` is `Send`), and no two threads touch the same
// one (see the type).
unsafe impl<M: Model> Send for Bodies<M> {}
// SAFETY: as for `Send`.
unsafe impl<M: Model> Sync for Bodies<M> {}

/// Solves rows that share no grain, in the three-operand encoding where the processor has it.
///
/// # Safety
/// The rows' grains must be among the bodies, and nothing else may touch those meanwhile.
unsafe fn solve_apart<M: Model, const MEASURE: bool, const PAIR: bool>(
    law: &Law,
    rows: &mut [Row<M::Kinematics>],
    bodies: Bodies<M>,
) -> Change {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx") {
        // SAFETY: the processor has just been asked; for the rest as for this function.
        return unsafe { solve_with_avx::<M, MEASURE, PAIR>(law, rows, bodies) };
    }
    // SAFETY: as for this function.
    unsafe { pass::<M, MEASURE, PAIR>(law, rows, bodies) }
}

/// See [`solve_apart`].
///
/// # Safety
/// As for that function.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx")]
unsafe fn solve_with_avx<M: Model, const MEASURE: bool, const PAIR: bool>(
    law: &Law,
    rows: &mut [Row<M::Kinematics>],
    bodies: Bodies<M>,
) -> Change {
    // SAFETY: as for this function.
    unsafe { pass::<M, MEASURE, PAIR>(law, rows, bodies) }
}

/// See [`solve_apart`].
///
/// # Safety
/// As for that function.
#[inline(always)]
unsafe fn pass<M: Model, const MEASURE: bool, const PAIR: bool>(
    law: &Law,
    rows: &mut [Row<M::Kinematics>],
    bodies: Bodies<M>,
) -> Change {
    let mut change = Change::default();
    for row in rows {
        // SAFETY: the grain is among the bodies, and only this row has it.
        let i = unsafe { &mut *bodies.0.add(row.i as usize) };
        if PAIR {
            // SAFETY: as for i, from which it differs.
            let j = unsafe { &mut *bodies.0.add(row.j as usize) };
            law.solve_pair::<M, MEASURE>(row, i, j, &mut change);
        } else {
            law.solve_single::<M, MEASURE>(row, i, &mut change);
        }
    }
    change
}
