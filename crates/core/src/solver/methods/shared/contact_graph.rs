//! Which grains touch, as the sparse factorisations need it.

use crate::solver::linear::Elimination;
use crate::solver::problem::{Kinematics, StepProblem};

/// An order of elimination for the contacts between grains, kept while these stay the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactGraph {
    /// In which order bodies are eliminated.
    pub elimination: Elimination,
    /// The block of each row between grains, by the number that it has in [`Elimination::later`].
    pub pair_blocks: Vec<u32>,
    /// What `elimination` was made for.
    bodies: usize,
    pairs: Vec<(u32, u32)>,
}

impl ContactGraph {
    /// Orders the elimination, unless the contacts between grains are those of the last time.
    pub(crate) fn analyse<K: Kinematics>(&mut self, problem: &StepProblem<K>) {
        let pairs = || problem.pair_rows.iter().map(|row| (row.i, row.j));
        let bodies = problem.bodies.len();
        if self.bodies == bodies && pairs().eq(self.pairs.iter().copied()) {
            return;
        }
        self.bodies = bodies;
        self.pairs.clear();
        self.pairs.extend(pairs());
        self.elimination.analyse(bodies, self.pairs.iter().copied());
        let Self { elimination, pair_blocks, pairs, .. } = self;
        let places = pairs
            .iter()
            .map(|&(i, j)| (elimination.place_of[i as usize], elimination.place_of[j as usize]));
        pair_blocks.clear();
        pair_blocks.extend(places.map(|(i, j)| elimination.block(i.min(j), i.max(j)) as u32));
    }
}
