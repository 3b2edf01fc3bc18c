//! Gauss–Seidel by colours, on vector registers and several threads.
//!
//! Contacts of one colour share no grain (`problem::order`), so none of them sees what another does:
//! a colour's contacts can be solved in any order, at the same time, to bitwise the same result: four
//! side by side (`lane_blocks`), and portions of them on several threads. The colours follow
//! each other. Few contacts are not worth waking threads for, and are solved by the one at hand, in
//! the same portions: what is summed over a sweep is summed in one order whatever the number of
//! threads.

mod lane_blocks;
#[cfg(test)]
mod tests;

use fearless_simd::Level;
use rayon::prelude::*;

use self::lane_blocks::{Block, Bodies, LANES, solve_apart, sum};
use super::info::{COULOMB, MethodInfo, MethodOrder};
use super::method::Method;
use super::nsgs::{self, is_settled};
use super::report::SolveReport;
use super::shared::iterate::{is_tested, sweep_until_settled};
use super::shared::update::{Change, Law, squared_impulse};
use crate::solver::ordering::Ordering;
use crate::solver::problem::{Model, StepProblem, residual};
use crate::solver::settings::{SolverSettings, StopTest};

/// What there is to know of it.
pub(super) const INFO: MethodInfo = MethodInfo {
    method: Method::NsgsParallel,
    name: "nsgs-parallel",
    summary: "Gauss-Seidel by colours: four contacts at a time, large piles on several threads",
    solves: COULOMB,
    source: "M. Jean (1999); colours as in M. Renouf, F. Dubois, P. Alart (2004)",
    order: MethodOrder::Always(Ordering::Coloured),
    takes_models: false,
};

/// Blocks that a thread takes at a time.
const PORTION: usize = 256;
/// Blocks of a colour from which on threads are woken: some 10 µs of work, about what waking costs.
const WORTH_THREADS: usize = 4 * PORTION;

/// The rows of a problem in blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockMemory {
    /// The last colour that each grain was seen in.
    seen: Vec<usize>,
    /// Colour by colour the blocks of its rows; the last rows of a colour may fill none.
    blocks: Vec<Block>,
    /// What the portions of a colour changed.
    changes: Vec<Change>,
}

/// Solves a prepared problem by sweeps.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut BlockMemory,
    settings: &SolverSettings,
) -> SolveReport {
    solve_at::<M>(Level::new(), problem, memory, settings)
}

/// Solves with the vector instructions of a level.
fn solve_at<M: Model>(
    level: Level,
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut BlockMemory,
    settings: &SolverSettings,
) -> SolveReport {
    match Coloured::<M>::new(level, problem, memory) {
        // Inside the pool a colour is handed out without a call from outside it each time.
        Some(mut coloured) if coloured.threads => rayon::scope(|_| coloured.run(settings)),
        Some(mut coloured) => coloured.run(settings),
        None => nsgs::solve::<M>(problem, &mut (), settings),
    }
}

/// A problem whose rows' grains all exist and whose colours are none that share a grain.
///
/// While it lives, impulses of rows in blocks are the blocks'.
struct Coloured<'a, M: Model> {
    level: Level,
    /// Whether there are several threads, and a colour that is worth waking them.
    threads: bool,
    problem: &'a mut StepProblem<M::Kinematics>,
    blocks: &'a mut [Block],
    changes: &'a mut Vec<Change>,
}

impl<'a, M: Model> Coloured<'a, M> {
    /// Nothing where the problem is not such a one.
    fn new(
        level: Level,
        problem: &'a mut StepProblem<M::Kinematics>,
        memory: &'a mut BlockMemory,
    ) -> Option<Self> {
        let BlockMemory { seen, blocks, changes } = memory;
        let [fixed_ends, pair_ends] = &problem.colour_ends;
        seen.clear();
        seen.resize(problem.bodies.len(), 0);
        blocks.clear();
        let (mut colour, mut threads) = (0, false);
        let mut is_first_in_colour = |grain: u32, colour: usize| {
            seen.get_mut(grain as usize)
                .is_some_and(|seen| std::mem::replace(seen, colour) != colour)
        };
        for (rows, ends, is_pair) in
            [(&problem.fixed_rows, fixed_ends, false), (&problem.pair_rows, pair_ends, true)]
        {
            let mut start = 0;
            for &end in ends {
                colour += 1;
                let rows = rows.get(start..end)?;
                for row in rows {
                    let is_free = is_first_in_colour(row.i, colour)
                        && (!is_pair || is_first_in_colour(row.j, colour));
                    if !is_free {
                        return None;
                    }
                }
                blocks.extend(rows.as_chunks::<LANES>().0.iter().map(Block::of));
                threads |= rows.len() / LANES >= WORTH_THREADS;
                start = end;
            }
            if start != rows.len() {
                return None;
            }
        }
        threads &= rayon::current_num_threads() > 1;
        Some(Self { level, threads, problem, blocks, changes })
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
            let change = (change, coloured.problem.mean_mass);
            is_settled(coloured, change, settings, Self::squared_impulses, Self::residual)
        };
        let report = sweep_until_settled(self, settings, sweep, Self::residual);
        self.store();
        report
    }

    fn residual(&mut self) -> f64 {
        self.store();
        residual::<M>(self.problem)
    }

    /// Σ P², (N·s)².
    fn squared_impulses(&mut self) -> f64 {
        let StepProblem { fixed_rows, pair_rows, colour_ends, captures, capture_speed, .. } =
            &mut *self.problem;
        let capture = |number: usize| *captures.get(number).unwrap_or(capture_speed);
        let (mut in_lanes, mut left_over, mut number) = ([0.0; LANES], 0.0, 0);
        let mut blocks = &mut *self.blocks;
        for (rows, ends) in [fixed_rows, pair_rows].into_iter().zip(colour_ends) {
            for_each_colour(&mut blocks, rows, ends, |blocks, rows| {
                let first = number;
                number += rows.len();
                for (at, block) in blocks.iter().enumerate() {
                    let captures = std::array::from_fn(|lane| capture(first + LANES * at + lane));
                    let squares = block.squared_impulses(captures);
                    in_lanes.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
                }
                for (at, row) in rows.iter().enumerate().skip(LANES * blocks.len()) {
                    let impulse =
                        [row.shifted_impulse - capture(first + at), row.tangential_impulse];
                    left_over += squared_impulse(row.effective_mass, impulse);
                }
            });
        }
        sum(in_lanes) + left_over
    }

    /// One pass over all contacts.
    fn sweep<const MEASURE: bool>(&mut self) -> Change {
        let law = Law::of(self.problem);
        let StepProblem { bodies, fixed_rows, pair_rows, colour_ends, .. } = &mut *self.problem;
        let (level, bodies) = (self.level, Bodies::<M>::new(bodies));
        let mut change = Change::default();
        let mut changes = self.threads.then_some(&mut *self.changes);
        // SAFETY: `Coloured::new` has looked at every row. Its grains are among the bodies, and no
        // other row of its colour has one of them: while a colour is solved, each body is touched
        // from one place only.
        let single = |blocks: &mut [_], rows: &mut [_]| unsafe {
            solve_apart::<M, MEASURE, false>(level, &law, (blocks, rows), bodies)
        };
        // SAFETY: as above.
        let pair = |blocks: &mut [_], rows: &mut [_]| unsafe {
            solve_apart::<M, MEASURE, true>(level, &law, (blocks, rows), bodies)
        };
        let [fixed_ends, pair_ends] = &*colour_ends;
        let mut blocks = &mut *self.blocks;
        for_each_colour(&mut blocks, fixed_rows, fixed_ends, |blocks, rows| {
            change.add_all(solve_colour(blocks, rows, changes.as_deref_mut(), single));
        });
        for_each_colour(&mut blocks, pair_rows, pair_ends, |blocks, rows| {
            change.add_all(solve_colour(blocks, rows, changes.as_deref_mut(), pair));
        });
        change
    }

    /// Gives the rows the impulses of their blocks.
    fn store(&mut self) {
        let StepProblem { fixed_rows, pair_rows, colour_ends, .. } = &mut *self.problem;
        let mut blocks = &mut *self.blocks;
        for (rows, ends) in [fixed_rows, pair_rows].into_iter().zip(colour_ends) {
            for_each_colour(&mut blocks, rows, ends, |blocks, rows| {
                for (block, rows) in blocks.iter().zip(rows.as_chunks_mut().0) {
                    block.store::<M>(rows);
                }
            });
        }
    }
}

/// Takes from `blocks` those of each colour, and hands them on with all the colour's rows.
fn for_each_colour<R>(
    blocks: &mut &mut [Block],
    rows: &mut [R],
    ends: &[usize],
    mut visit: impl FnMut(&mut [Block], &mut [R]),
) {
    let mut start = 0;
    for &end in ends {
        let (of_colour, rest) = std::mem::take(blocks).split_at_mut((end - start) / LANES);
        visit(of_colour, &mut rows[start..end]);
        *blocks = rest;
        start = end;
    }
}

/// Solves a colour's contacts in portions. With a place for what they change, they are solved on several threads
/// where it pays.
fn solve_colour<R: Send>(
    blocks: &mut [Block],
    rows: &mut [R],
    changes: Option<&mut Vec<Change>>,
    solve: impl Fn(&mut [Block], &mut [R]) -> Change + Send + Sync,
) -> Change {
    let mut change = Change::default();
    let left_over = blocks.len() * LANES;
    match changes.filter(|_| blocks.len() >= WORTH_THREADS) {
        Some(changes) => {
            let portions = blocks.par_chunks_mut(PORTION);
            portions.map(|portion| solve(portion, &mut [])).collect_into_vec(changes);
            changes.iter().for_each(|&portion| change.add_all(portion));
        }
        None => {
            for portion in blocks.chunks_mut(PORTION) {
                change.add_all(solve(portion, &mut []));
            }
        }
    }
    change.add_all(solve(&mut [], &mut rows[left_over..]));
    change
}
