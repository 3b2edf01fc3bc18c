//! Islands: grains that contacts join, and the contacts of these. What is fixed joins none, so that no island feels
//! another, and the step of each is a problem of its own: what one of them needs, the others need not wait for, and what
//! one of them leaves unsolved is unsolved in it alone.
//!
//! Walls that a force drives feel all that touch them, and join what they touch; such a problem is not divided.

use super::kinematics::Kinematics;
use super::step_problem::{Row, StepProblem};
use crate::contact::JoinedGrains;
use crate::solver::friction_model::FrictionModel;

/// What has no number yet.
const NONE: u32 = u32::MAX;

/// One island of a problem.
#[derive(Clone, Debug)]
pub(crate) struct Island<K: Kinematics> {
    /// Its contacts in the order of the whole, with grains numbered anew; in the place of the contact behind each row
    /// stands the row of the whole.
    pub problem: StepProblem<K>,
    /// The grains' numbers in the whole.
    grains: Vec<u32>,
}

impl<K: Kinematics> Default for Island<K> {
    fn default() -> Self {
        Self { problem: StepProblem::default(), grains: Vec::new() }
    }
}

/// Which island grains are of, and their numbers there. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    of_grain: Vec<u32>,
    numbers: Vec<u32>,
    count: usize,
}

impl Islands {
    /// Tells how many islands the contacts of a problem make.
    pub(crate) fn find<K: Kinematics>(&mut self, problem: &StepProblem<K>) -> usize {
        let grains = problem.bodies.len();
        let mut sets = JoinedGrains::apart(grains);
        for row in &problem.pair_rows {
            sets.join(row.i, row.j);
        }
        // Islands are numbered as rows first meet them, whichever grain stands for one.
        self.numbers.clear();
        self.numbers.resize(grains, NONE);
        self.of_grain.clear();
        self.of_grain.resize(grains, NONE);
        self.count = 0;
        for (_, row) in problem.rows() {
            let number = &mut self.numbers[sets.of(row.i) as usize];
            if *number == NONE {
                *number = self.count as u32;
                self.count += 1;
            }
        }
        for (grain, island) in (0..).zip(&mut self.of_grain) {
            *island = self.numbers[sets.of(grain) as usize];
        }
        self.count
    }

    /// Puts the islands that were found into the first of `parts`, which are as many.
    pub(crate) fn divide<'a, K: Kinematics>(
        &mut self,
        problem: &StepProblem<K>,
        parts: impl Iterator<Item = &'a mut Island<K>>,
    ) {
        let mut parts: Vec<_> = parts.take(self.count).collect();
        parts.iter_mut().for_each(|part| part.begin(problem));
        self.numbers.fill(NONE);
        for (number, row) in problem.rows() {
            let part = &mut parts[self.of_grain[row.i as usize] as usize];
            let is_pair = number >= problem.fixed_rows.len();
            let i = part.number_of(row.i, &mut self.numbers, problem);
            if is_pair {
                let j = part.number_of(row.j, &mut self.numbers, problem);
                part.problem.pair_rows.push(Row { i, j, ..*row });
            } else {
                part.problem.fixed_rows.push(Row { i, ..*row });
            }
            part.add_numbers_of(number, problem);
        }
    }
}

impl<K: Kinematics> Island<K> {
    /// Nothing of a problem yet but what all of its contacts share.
    fn begin(&mut self, whole: &StepProblem<K>) {
        let Self { problem, grains } = self;
        grains.clear();
        for bodies in [&mut problem.bodies, &mut problem.before, &mut problem.free] {
            bodies.clear();
        }
        problem.fixed_rows.clear();
        problem.pair_rows.clear();
        problem.contact_of_row.clear();
        for numbers in [
            &mut problem.captures,
            &mut problem.wall_speeds,
            &mut problem.held_at_start,
            &mut problem.held,
            &mut problem.masses,
        ] {
            numbers.clear();
        }
        problem.friction = whole.friction;
        problem.capture_speed = whole.capture_speed;
        problem.friction_model = whole.friction_model;
        problem.mean_mass = whole.mean_mass;
    }

    /// The number that a grain has here, and a new one where it has none.
    fn number_of(&mut self, grain: u32, numbers: &mut [u32], whole: &StepProblem<K>) -> u32 {
        let number = &mut numbers[grain as usize];
        if *number == NONE {
            *number = self.grains.len() as u32;
            self.grains.push(grain);
            let (problem, at) = (&mut self.problem, grain as usize);
            problem.bodies.push(whole.bodies[at]);
            problem.before.push(whole.before[at]);
            problem.free.push(whole.free[at]);
            problem.masses.push(whole.masses[at]);
        }
        *number
    }

    /// Adds what there is of a row beside it.
    fn add_numbers_of(&mut self, number: usize, whole: &StepProblem<K>) {
        let problem = &mut self.problem;
        problem.contact_of_row.push(number as u32);
        problem.captures.extend(whole.captures.get(number));
        problem.wall_speeds.extend(whole.wall_speeds.get(number));
        problem.held_at_start.extend(whole.held_at_start.get(number));
        problem.held.extend(whole.held.get(number));
    }

    /// Gives the whole what became of this part of it. Where the whole holds friction, it holds what this part does.
    pub(crate) fn join(&self, whole: &mut StepProblem<K>) {
        let Self { problem, grains } = self;
        for (&grain, body) in grains.iter().zip(&problem.bodies) {
            whole.bodies[grain as usize] = *body;
        }
        let holds = problem.friction_model != FrictionModel::Coulomb;
        for ((at, row), &number) in problem.rows().zip(&problem.contact_of_row) {
            let of_whole = whole.row_at_mut(number as usize);
            of_whole.shifted_impulse = row.shifted_impulse;
            of_whole.tangential_impulse = row.tangential_impulse;
            if let (true, Some(held)) = (holds, whole.held.get_mut(number as usize)) {
                *held = problem.held[at];
            }
        }
    }
}
