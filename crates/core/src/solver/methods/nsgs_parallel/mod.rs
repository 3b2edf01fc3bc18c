//! Gauss–Seidel by tiles and colours, on several threads and with vector registers.
//!
//! A *tile* is a group of contacts near each other, and a *colour* a group of contacts that share no grain
//! (`problem::order`). Contacts of different tiles share no grain, either. So tiles can be solved at the same time, and
//! the contacts of a colour four at a time (`block`), with bitwise the same result as one after the other. Contacts
//! between tiles are solved after all tiles, by one thread: about a twentieth of the contacts of a dense pile. Sums
//! over a sweep are computed tile by tile in a fixed order, so they do not depend on the number of threads.

mod block;
#[cfg(test)]
mod tests;

use std::ops::Range;

use fearless_simd::{Level, dispatch};

use self::block::{Blocks, BodySlot, ContactBlock, LANES, solve_blocks, squared_error};
use super::nsgs;
use super::stopping::{SolveReport, is_settled, is_tested, sweep_until_settled};
use super::sweep::ImpulseChange;
use crate::contact::ContactLaw;
use crate::solver::kinematics::Model;
use crate::solver::problem::{
    ContactRows, Row, StepProblem, residual_of, squared_residual_scale, velocity_error,
};
use crate::solver::settings::SolverSettings;
use crate::threads;

/// Minimum number of blocks of four contacts for which several threads are used. A sweep over this number of blocks
/// takes 60 µs. With half as many blocks two threads were slower than one thread.
const WORTH_THREADS: usize = 4096;

/// Work memory of the method, which is reused for the next step.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockMemory {
    layout: TileLayout,
    /// For each tile (a group of contacts that shares no grain with another tile), the change of the impulses of its
    /// contacts in a sweep.
    changes: Vec<ImpulseChange>,
    /// For each tile (a group of contacts that shares no grain with another tile), a sum over its contacts, (N·s)²: of
    /// the squared errors of their impulses for the residual, or of their squared impulses.
    sums: Vec<f64>,
}

impl BlockMemory {
    /// Calls `add_up` for the blocks of contacts of each tile (a group of contacts that shares no grain with another
    /// tile), and for the blocks of the contacts between tiles. Returns the sum of the results, added in the order of
    /// the tiles, with the contacts between tiles last.
    fn sum(
        &mut self,
        threads: bool,
        add_up: impl Fn(Blocks<'_>, &mut [BodySlot]) -> f64 + Sync,
    ) -> f64 {
        let Self { layout, sums, .. } = self;
        let between = layout.visit(threads, sums, add_up);
        sums.iter().sum::<f64>() + between
    }
}

/// Solves a prepared problem by Gauss–Seidel sweeps over tiles (groups of contacts near each other) and colours (groups
/// of contacts that share no grain).
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut BlockMemory,
    settings: &SolverSettings,
) -> SolveReport {
    solve_at::<M>(Level::new(), problem, memory, settings)
}

/// Solves a prepared problem by Gauss–Seidel sweeps over tiles (groups of contacts near each other) and colours (groups
/// of contacts that share no grain), with the vector instructions that `level` names. If these groups of the problem
/// are not valid, solves one contact after the other.
fn solve_at<M: Model>(
    level: Level,
    problem: &mut StepProblem<M>,
    memory: &mut BlockMemory,
    settings: &SolverSettings,
) -> SolveReport {
    match Tiled::<M>::new(level, problem, memory) {
        Some(mut tiled) => tiled.run(settings),
        None => nsgs::solve(problem, settings),
    }
}

/// A contact problem whose contacts are arranged in tiles (groups of contacts near each other) and colours (groups of
/// contacts that share no grain). When it is created, the arrangement is checked: all grains exist, and no two tiles
/// and no two contacts of a colour share a grain.
///
/// The present impulses and velocities are stored in blocks of four contacts and in memory slots, one for the velocity
/// of each body. Until [`Tiled::store`] copies them back, `problem` has old impulses and velocities.
struct Tiled<'a, M: Model> {
    level: Level,
    /// True if several threads sweep over the contacts at the same time: there are several threads, several tiles
    /// (groups of contacts that share no grain with another tile), and enough contacts.
    threads: bool,
    law: ContactLaw,
    problem: &'a mut StepProblem<M>,
    memory: &'a mut BlockMemory,
    squared_scale: Option<f64>,
}

impl<'a, M: Model> Tiled<'a, M> {
    /// Arranges the contacts of a problem in blocks of four. Returns `None` if the problem's groups of contacts are not
    /// valid: a grain does not exist, or two contacts that would be solved at the same time share a grain.
    fn new(
        level: Level,
        problem: &'a mut StepProblem<M>,
        memory: &'a mut BlockMemory,
    ) -> Option<Self> {
        memory.layout.fill(problem)?;
        let tiles = memory.layout.tiles.len();
        memory.changes.resize(tiles, ImpulseChange::default());
        memory.sums.resize(tiles, 0.0);
        let blocks = blocks_of(&memory.layout.tiles);
        let threads = tiles > 1 && blocks >= WORTH_THREADS && threads::are_there();
        let law = problem.law;
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
                stop if stop.judges_solutions() => tiled.sweep::<false>(),
                _ => tiled.sweep::<true>(),
            };
            let mean_mass = tiled.problem.bodies.mean_mass;
            let squares = Self::squared_impulses;
            is_settled(tiled, change, mean_mass, settings, squares, Self::residual, |tiled| {
                tiled.store();
                velocity_error(tiled.problem)
            })
        };
        let report = sweep_until_settled(self, settings, sweep, Self::residual);
        self.store();
        report
    }

    /// Performs one sweep over all contacts. Returns the change of the impulses, which is measured if `MEASURE` is set
    /// and otherwise 0.
    fn sweep<const MEASURE: bool>(&mut self) -> ImpulseChange {
        let Self { level, threads, law, memory, .. } = self;
        let (level, law) = (*level, &*law);
        let BlockMemory { layout, changes, .. } = &mut **memory;
        let solve = |blocks: Blocks<'_>, slots: &mut [BodySlot]| dispatch!(level, simd => solve_blocks::<_, M, MEASURE>(simd, law, blocks, slots));
        let between = layout.visit(*threads, changes, solve);
        let mut change = ImpulseChange::default();
        changes.iter().chain([&between]).for_each(|&part| change.add_all(part));
        change
    }

    /// Returns the residual of the present impulses under Coulomb's law, dimensionless.
    fn residual(&mut self) -> f64 {
        let squared_scale =
            *self.squared_scale.get_or_insert_with(|| squared_residual_scale(self.problem));
        let squared_error = self.squared_error();
        if squared_scale == 0.0 {
            // `residual_of` reads the impulses from the problem to recognise an error that is only rounding.
            self.store();
        }
        residual_of(self.problem, [squared_error, squared_scale])
    }

    fn squared_error(&mut self) -> f64 {
        let (level, law) = (self.level, &self.law);
        self.memory.sum(
            self.threads,
            |blocks, slots| dispatch!(level, simd => squared_error::<_, M>(simd, law, blocks, slots)),
        )
    }

    /// Returns the sum of the squared impulses of all contacts, (N·s)².
    fn squared_impulses(&mut self) -> f64 {
        let captures = &self.problem.rows.captures;
        let capture_speed = self.law.capture_speed();
        if captures.is_empty() {
            let the_same = [capture_speed; LANES];
            return self.memory.sum(self.threads, |blocks, _| {
                blocks.all.iter().map(|block| block.squared_impulses(the_same)).sum()
            });
        }
        let TileLayout { blocks, places, .. } = &self.memory.layout;
        let of_block = |(block, place): (&ContactBlock, &Range<u32>)| {
            let first = place.start as usize;
            let capture =
                |lane: usize| captures.get(first + lane).copied().unwrap_or(capture_speed);
            block.squared_impulses(std::array::from_fn::<_, LANES, _>(capture))
        };
        blocks.iter().zip(places).map(of_block).sum()
    }

    /// Copies the present impulses from the blocks of four contacts to the rows of the problem (the data of one contact
    /// each), and the velocities from the memory slots to the problem's bodies.
    fn store(&mut self) {
        self.memory.layout.store::<M>(self.problem);
    }
}

fn blocks_of(tiles: &[ContactTile]) -> usize {
    tiles.iter().map(|tile| tile.blocks).sum()
}

/// Calls `visit` for each tile (a group of contacts that shares no grain with another tile) with its blocks of contacts
/// and the memory slots of its bodies' velocities. Uses several threads if `threads` is set.
fn for_each_tile<T: Send>(
    threads: bool,
    tiles: &[ContactTile],
    mut blocks: &mut [ContactBlock],
    mut slots: &mut [BodySlot],
    results: &mut [T],
    visit: &(impl Fn(Blocks<'_>, &mut [BodySlot]) -> T + Sync),
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
        *result = visit(Blocks { all: of_tile, fixed: tile.fixed }, slots_of_tile);
        (blocks, slots) = (rest, other_slots);
    }
}

/// Number that marks a memory slot without a grain, or a grain whose velocity has no memory slot.
const NOBODY: u32 = u32::MAX;

/// A tile: contacts whose grains are in no other tile, so that one thread can solve them.
#[derive(Clone, Copy, Debug, Default)]
struct ContactTile {
    /// Number of blocks (of four contacts each) in the tile (a group of contacts that one thread solves).
    blocks: usize,
    /// Number of blocks in the tile (a group of contacts that one thread solves) that contain contacts with fixed
    /// bodies. These blocks, of four contacts each, come first in the tile.
    fixed: usize,
    /// Number of memory slots for velocities: one per grain of the tile (a group of contacts that one thread solves),
    /// and one for idle SIMD lanes.
    slots: usize,
}

/// Data of a grain that are needed only while contacts are arranged in blocks: the memory slot of its velocity, the
/// tile (a group of contacts that shares no grain with another tile) that uses this slot, and the last colour (a group
/// of contacts that share no grain) with a contact of the grain.
#[derive(Clone, Copy, Debug)]
struct GrainMark {
    slot: u32,
    /// Number of the tile (a group of contacts that shares no grain with another tile) that contains the grain's
    /// contacts, from 1; 0 if only contacts between tiles contain the grain.
    tile: u32,
    /// Number of the last colour (group of contacts that share no grain) in which a contact of the grain was found.
    colour: u32,
}

const UNSEEN: GrainMark = GrainMark { slot: NOBODY, tile: 0, colour: 0 };

/// The tile (a group of contacts that shares no grain with another tile) that is being filled with blocks of contacts:
/// its number and the first memory slot of its velocities.
#[derive(Clone, Copy)]
struct BlockPlace {
    /// Number of the tile (a group of contacts that shares no grain with another tile), from 1; 0 for the contacts
    /// between tiles.
    tile: u32,
    /// Index of the first memory slot for a velocity that the tile (a group of contacts that shares no grain with
    /// another tile) uses. The slot indices in the blocks of the tile are counted from this slot.
    first_slot: u32,
}

/// The contacts of a problem arranged in blocks of four, and the velocities of its bodies arranged in memory slots. The
/// memory is reused for the next step.
#[derive(Clone, Debug, Default)]
struct TileLayout {
    /// Tiles (groups of contacts that share no grain with another tile), in the order in which their blocks of contacts
    /// and memory slots of velocities are stored.
    tiles: Vec<ContactTile>,
    /// Blocks of four contacts, sorted by tile (a group of contacts that shares no grain with another tile), and within
    /// a tile by colour (a group of contacts that share no grain). The indices of velocity slots in a block are counted
    /// from the first slot of its tile. The blocks of the contacts between tiles come last; their slot indices are
    /// counted from the first of all slots.
    blocks: Vec<ContactBlock>,
    /// Number of blocks of contacts with fixed bodies among the blocks that belong to no tile. A tile is a group of
    /// contacts that one thread solves.
    fixed_between: usize,
    /// Velocities of the bodies, sorted by tile (a group of contacts that shares no grain with another tile), and
    /// within a tile in the order in which its blocks of contacts first use them. The first memory slot of a tile is a
    /// placeholder for idle SIMD lanes.
    slots: Vec<BodySlot>,
    /// For each block of contacts, the range of the numbers of its contacts in the problem.
    places: Vec<Range<u32>>,
    /// For each memory slot of a velocity, the index of its grain, or [`NOBODY`] for a placeholder.
    grains: Vec<u32>,
    marks: Vec<GrainMark>,
    colours: u32,
}

impl TileLayout {
    /// Calls `visit` for each tile (a group of contacts that shares no grain with another tile), with its blocks (four
    /// contacts each) and slots (velocities of bodies), on several threads if `threads` is set. Then calls `visit` for
    /// the blocks of the contacts between tiles. Stores the results of the tiles in `results` and returns the result
    /// for the contacts between tiles.
    fn visit<T: Send>(
        &mut self,
        threads: bool,
        results: &mut [T],
        visit: impl Fn(Blocks<'_>, &mut [BodySlot]) -> T + Sync,
    ) -> T {
        let Self { tiles, blocks, slots, fixed_between, .. } = self;
        let (in_tiles, between) = blocks.split_at_mut(blocks_of(tiles));
        for_each_tile(threads, tiles, in_tiles, slots, results, &visit);
        visit(Blocks { all: between, fixed: *fixed_between }, slots)
    }

    /// Arranges the contacts of a problem in blocks of four. Returns `None` if a grain does not exist, or if a grain is
    /// in two tiles (groups of contacts that different threads solve) or in two contacts of a colour (a group of
    /// contacts that are solved at once).
    fn fill<M: Model>(&mut self, problem: &StepProblem<M>) -> Option<()> {
        self.tiles.clear();
        self.blocks.clear();
        self.places.clear();
        self.grains.clear();
        self.marks.clear();
        self.marks.resize(problem.bodies.now.len(), UNSEEN);
        self.colours = 0;
        let kinds = &problem.order.groups;
        let rows = [problem.rows.fixed.len(), problem.rows.pairs.len()];
        if kinds.each_ref().map(|groups| groups.colour_ends.last().copied().unwrap_or(0)) != rows {
            return None;
        }
        let tiles = kinds.each_ref().map(|groups| groups.tile_ends.len());
        let tiles = tiles[0].max(tiles[1]);
        for tile in 0..tiles {
            let (first_block, first_slot) = (self.blocks.len(), self.grains.len());
            let place = BlockPlace { tile: tile as u32 + 1, first_slot: first_slot as u32 };
            self.grains.push(NOBODY);
            let fixed = self.add_all(problem, place, tile)?;
            let blocks = self.blocks.len() - first_block;
            let slots = self.grains.len() - first_slot;
            self.tiles.push(ContactTile { blocks, fixed, slots });
        }
        self.fixed_between = self.add_all(problem, BlockPlace { tile: 0, first_slot: 0 }, tiles)?;
        self.slots.clear();
        self.slots.extend(self.grains.iter().map(|&grain| {
            problem.bodies.now.get(grain as usize).map_or_else(BodySlot::default, BodySlot::of::<M>)
        }));
        Some(())
    }

    /// Arranges the contacts of a tile (a group of contacts that shares no grain with another tile) in blocks of four,
    /// and appends the blocks to `self.blocks`. `tile` is the index of the tile, from 0; the index after the last tile
    /// selects the contacts between tiles. `place` has the number of the tile, from 1 (0 for the contacts between
    /// tiles), and the index of its first velocity slot. Returns the number of blocks of contacts with fixed bodies.
    /// Returns `None` if a contact or a grain does not exist, or if two tiles or two contacts of a colour (a group of
    /// contacts that share no grain) share a grain.
    fn add_all<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        place: BlockPlace,
        tile: usize,
    ) -> Option<usize> {
        let first_block = self.blocks.len();
        let ContactRows { fixed, pairs, .. } = &problem.rows;
        let [of_fixed, of_pairs] = &problem.order.groups;
        for rows in of_fixed.colours_of(tile) {
            let of_colour = fixed.get(rows.clone())?;
            let rows_of_it = of_colour.iter().map(|row| (&row.row, row.surface_speed));
            self.add(rows_of_it, rows.start, place, false)?;
        }
        let fixed_blocks = self.blocks.len() - first_block;
        for rows in of_pairs.colours_of(tile) {
            let of_colour = pairs.get(rows.clone())?;
            let rows_of_it = of_colour.iter().map(|row| (&row.row, row.share));
            self.add(rows_of_it, fixed.len() + rows.start, place, true)?;
        }
        Some(fixed_blocks)
    }

    /// Adds the blocks of the contacts of a colour (a group of contacts that share no grain). `rows` are the rows of
    /// the colour (the data of one contact each), numbered from `first`. Each row is given with its mass ratio
    /// (effective mass divided by the mass of the first grain) or, if `are_pairs` is false, with the speed of the fixed
    /// body's surface, m/s. Returns `None` if a grain does not exist, or belongs to another contact of the colour or to
    /// another tile (a group of contacts that one thread solves).
    fn add<'a, M: Model>(
        &mut self,
        rows: impl ExactSizeIterator<Item = (&'a Row<M>, f64)> + Clone,
        first: usize,
        BlockPlace { tile, first_slot }: BlockPlace,
        are_pairs: bool,
    ) -> Option<()> {
        self.colours += 1;
        for (row, _) in rows.clone() {
            for grain in [row.i, row.j].into_iter().take(if are_pairs { 2 } else { 1 }) {
                let mark = self.marks.get_mut(grain as usize)?;
                if std::mem::replace(&mut mark.colour, self.colours) == self.colours {
                    return None;
                }
                if mark.slot == NOBODY {
                    (mark.slot, mark.tile) = (self.grains.len() as u32, tile);
                    self.grains.push(grain);
                }
                if tile > 0 && mark.tile != tile {
                    return None;
                }
            }
        }
        let marks = &self.marks;
        let slot = |grain: u32| marks[grain as usize].slot - first_slot;
        let end = first + rows.len();
        let mut rows = rows.map(|(row, share_or_speed)| {
            let slots = [slot(row.i), slot(if are_pairs { row.j } else { row.i })];
            (row, slots, share_or_speed)
        });
        for start in (first..end).step_by(LANES) {
            self.blocks.push(ContactBlock::of(rows.by_ref().take(LANES)));
            self.places.push(start as u32..(start + LANES).min(end) as u32);
        }
        Some(())
    }

    /// Copies the impulses from the blocks of four contacts to the rows of the problem (the data of one contact each),
    /// and the velocities from the memory slots to the problem's bodies.
    fn store<M: Model>(&self, problem: &mut StepProblem<M>) {
        let ContactRows { fixed, pairs, .. } = &mut problem.rows;
        for (block, place) in self.blocks.iter().zip(&self.places) {
            let [start, end] = [place.start as usize, place.end as usize];
            match start.checked_sub(fixed.len()) {
                None => block.store::<M>(fixed[start..end].iter_mut().map(|row| &mut row.row)),
                Some(first) => {
                    let rows = &mut pairs[first..first + end - start];
                    block.store::<M>(rows.iter_mut().map(|row| &mut row.row));
                }
            }
        }
        for (slot, &grain) in self.slots.iter().zip(&self.grains) {
            if let Some(body) = problem.bodies.now.get_mut(grain as usize) {
                slot.store::<M>(body);
            }
        }
    }
}
