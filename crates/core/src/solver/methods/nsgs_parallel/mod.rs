//! Gauss–Seidel by tiles and colours, on several threads and vector registers.
//!
//! Contacts of two tiles share no grain, nor do contacts of one colour (`problem::order`), so none of them sees
//! what another does: tiles can be solved at the same time, and a colour's contacts side by side (`block`), to
//! bitwise the same result. Contacts between tiles follow when all tiles are done: some twentieth of a dense
//! pile, which one thread solves. What is summed over a sweep is summed tile by tile in one order, whatever the
//! number of threads.

mod block;
mod layout;
#[cfg(test)]
mod tests;

use fearless_simd::{Level, dispatch};

use self::block::{Block, LANES, Slot, solve_blocks, squared_error};
use self::layout::{Layout, Tile};
use super::info::{COULOMB, MethodInfo, MethodOrder};
use super::method::Method;
use super::nsgs::{self, is_settled};
use super::report::SolveReport;
use super::shared::iterate::{is_tested, sweep_until_settled};
use super::shared::update::{Change, Law};
use crate::solver::ordering::Ordering;
use crate::solver::problem::{Model, StepProblem, residual_of, squared_residual_scale};
use crate::solver::settings::{SolverSettings, StopTest};
use crate::threads;

/// What there is to know of it.
pub(super) const INFO: MethodInfo = MethodInfo {
    method: Method::NsgsParallel,
    name: "nsgs-parallel",
    summary: "Gauss-Seidel by tiles and colours: four contacts at a time, large piles on several threads",
    solves: COULOMB,
    source: "M. Jean (1999); colours as in M. Renouf, F. Dubois, P. Alart (2004)",
    order: MethodOrder::Always(Ordering::Coloured),
    takes_models: false,
    takes_drives: false,
    takes_shear: false,
};

/// Blocks from which on tiles are shared out: 60 µs of work a sweep. With half of it two threads were slower than one.
const WORTH_THREADS: usize = 4096;

/// What is kept between steps.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockMemory {
    layout: Layout,
    /// What the tiles changed.
    changes: Vec<Change>,
    /// What the tiles come to, of whatever is summed: squared errors or impulses.
    sums: Vec<f64>,
}

impl BlockMemory {
    /// Adds up what blocks come to with their slots, tile by tile, then that of those between tiles.
    fn sum(
        &mut self,
        threads: bool,
        add_up: impl Fn((&mut [Block], usize), &mut [Slot]) -> f64 + Sync,
    ) -> f64 {
        let Self { layout, sums, .. } = self;
        let Layout { tiles, blocks, slots, singles_between, .. } = layout;
        let (in_tiles, between) = blocks.split_at_mut(blocks_of(tiles));
        for_each_tile(threads, tiles, in_tiles, slots, sums, &add_up);
        sums.iter().sum::<f64>() + add_up((between, *singles_between), slots)
    }
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
    match Tiled::<M>::new(level, problem, memory) {
        Some(mut tiled) => tiled.run(settings),
        None => nsgs::solve::<M>(problem, &mut (), settings),
    }
}

/// A problem whose rows' grains all exist and whose tiles and colours are none that share a grain.
///
/// While it lives, impulses of rows are those of the blocks, and velocities those of the slots.
struct Tiled<'a, M: Model> {
    level: Level,
    /// Whether there are several tiles, threads for them, and enough for these to do.
    threads: bool,
    law: Law,
    problem: &'a mut StepProblem<M::Kinematics>,
    memory: &'a mut BlockMemory,
    squared_scale: Option<f64>,
}

impl<'a, M: Model> Tiled<'a, M> {
    /// Nothing where the problem is not such a one.
    fn new(
        level: Level,
        problem: &'a mut StepProblem<M::Kinematics>,
        memory: &'a mut BlockMemory,
    ) -> Option<Self> {
        memory.layout.fill(problem)?;
        let tiles = memory.layout.tiles.len();
        memory.changes.resize(tiles, Change::default());
        memory.sums.resize(tiles, 0.0);
        let blocks = blocks_of(&memory.layout.tiles);
        let threads = tiles > 1 && blocks >= WORTH_THREADS && threads::are_there();
        let law = Law::of(problem);
        Some(Self { level, threads, law, problem, memory, squared_scale: None })
    }

    fn run(&mut self, settings: &SolverSettings) -> SolveReport {
        if self.threads {
            threads::rouse();
        }
        let sweep = |tiled: &mut Self, sweeps| {
            if !is_tested(sweeps, settings) {
                tiled.sweep::<false>();
                return false;
            }
            let change = match settings.stop {
                StopTest::Residual => tiled.sweep::<false>(),
                _ => tiled.sweep::<true>(),
            };
            let change = (change, tiled.problem.mean_mass);
            is_settled(tiled, change, settings, Self::squared_impulses, Self::residual)
        };
        let report = sweep_until_settled(self, settings, sweep, Self::residual);
        self.store();
        report
    }

    /// One pass over all contacts.
    fn sweep<const MEASURE: bool>(&mut self) -> Change {
        let Self { level, threads, law, memory, .. } = self;
        let (level, law) = (*level, &*law);
        let BlockMemory { layout, changes, .. } = &mut **memory;
        let Layout { tiles, blocks, slots, singles_between, .. } = layout;
        let (in_tiles, between) = blocks.split_at_mut(blocks_of(tiles));
        let solve = |blocks: (&mut [Block], usize), slots: &mut [Slot]| dispatch!(level, simd => solve_blocks::<_, M, MEASURE>(simd, law, blocks, slots));
        for_each_tile(*threads, tiles, in_tiles, slots, changes, &solve);
        let mut change = Change::default();
        changes.iter().for_each(|&of_tile| change.add_all(of_tile));
        change.add_all(solve((between, *singles_between), slots));
        change
    }

    /// The common residual.
    fn residual(&mut self) -> f64 {
        let squared_scale =
            *self.squared_scale.get_or_insert_with(|| squared_residual_scale::<M>(self.problem));
        let squared_error = self.squared_error();
        if squared_scale == 0.0 {
            // What is rounding alone is told by the rows.
            self.store();
        }
        residual_of::<M>(self.problem, [squared_error, squared_scale])
    }

    fn squared_error(&mut self) -> f64 {
        let (level, law) = (self.level, [self.problem.friction, self.problem.capture_speed]);
        self.memory.sum(self.threads, |(blocks, singles), slots| {
            let blocks = (&*blocks, singles);
            dispatch!(level, simd => squared_error::<_, M>(simd, law, blocks, slots))
        })
    }

    /// Σ P², (N·s)².
    fn squared_impulses(&mut self) -> f64 {
        let StepProblem { captures, capture_speed, .. } = &*self.problem;
        if captures.is_empty() {
            let the_same = [*capture_speed; LANES];
            return self.memory.sum(self.threads, |(blocks, _), _| {
                blocks.iter().map(|block| block.squared_impulses(the_same)).sum()
            });
        }
        let Layout { blocks, places, .. } = &self.memory.layout;
        let of_block = |(block, place): (&Block, &std::ops::Range<u32>)| {
            let first = place.start as usize;
            let capture = |lane: usize| *captures.get(first + lane).unwrap_or(capture_speed);
            block.squared_impulses(std::array::from_fn::<_, LANES, _>(capture))
        };
        blocks.iter().zip(places).map(of_block).sum()
    }

    /// Gives rows and bodies what became of them.
    fn store(&mut self) {
        self.memory.layout.store::<M>(self.problem);
    }
}

fn blocks_of(tiles: &[Tile]) -> usize {
    tiles.iter().map(|tile| tile.blocks).sum()
}

/// Visits tiles with their blocks, of which so many are of contacts with fixed bodies, and their slots; on several
/// threads where these are wanted.
fn for_each_tile<T: Send>(
    threads: bool,
    tiles: &[Tile],
    mut blocks: &mut [Block],
    mut slots: &mut [Slot],
    results: &mut [T],
    visit: &(impl Fn((&mut [Block], usize), &mut [Slot]) -> T + Sync),
) {
    if threads && tiles.len() > 1 {
        let half = tiles.len() / 2;
        let ((tiles, other_tiles), (results, other_results)) =
            (tiles.split_at(half), results.split_at_mut(half));
        let (blocks, other_blocks) = blocks.split_at_mut(blocks_of(tiles));
        let (slots, other_slots) = slots.split_at_mut(tiles.iter().map(|tile| tile.slots).sum());
        rayon::join(
            || for_each_tile(threads, tiles, blocks, slots, results, visit),
            || for_each_tile(threads, other_tiles, other_blocks, other_slots, other_results, visit),
        );
        return;
    }
    for (tile, result) in tiles.iter().zip(results) {
        let (of_tile, rest) = blocks.split_at_mut(tile.blocks);
        let (slots_of_tile, other_slots) = slots.split_at_mut(tile.slots);
        *result = visit((of_tile, tile.singles), slots_of_tile);
        (blocks, slots) = (rest, other_slots);
    }
}
