//! The linear system of a Newton step: M + Hᵀ m S⁻¹ H, symmetric but for Coulomb's law.

use super::contact::Shape;
use crate::solver::kinematics::Model;
use crate::solver::linear::{
    Block, BlockMatrix, ContactGraph, Elimination, SymmetricBlockMatrix, inertia,
};
use crate::solver::problem::{Row, StepProblem};

/// The matrix, then its factors.
#[derive(Clone, Debug, Default)]
pub(super) struct StepMatrix<const D: usize> {
    symmetric: SymmetricBlockMatrix<D>,
    /// In use where the shape leans.
    unsymmetric: BlockMatrix<D>,
}

impl<const D: usize> StepMatrix<D> {
    /// Sets the matrix up for the S⁻¹ of each contact, and factorises it.
    pub(super) fn assemble<M: Model, S: Shape>(
        &mut self,
        problem: &StepProblem<M>,
        graph: &ContactGraph,
        mut answers: impl Iterator<Item = Block<2>>,
    ) {
        let elimination = &graph.elimination;
        let masses = &problem.bodies.masses;
        if S::LEANS {
            self.unsymmetric.start::<M>(elimination, masses);
        } else {
            self.symmetric.clear(elimination);
            for (&place, &mass) in elimination.place_of.iter().zip(masses) {
                self.symmetric.add_to_diagonal(place, &inertia::<M, D>(mass));
            }
        }
        for (row, answer) in problem.rows.fixed.iter().zip(&mut answers) {
            let [on_i, _] = gradients::<M, D>(row);
            let answer = heavy(row.effective_mass, answer);
            let block = stiffness(&answer, &on_i, &on_i);
            self.add_to_diagonal::<S>(elimination.place_of[row.i as usize], &block);
        }
        for ((row, &number), answer) in
            problem.rows.pairs.iter().zip(&graph.pair_blocks).zip(answers)
        {
            let [on_i, on_j] = gradients::<M, D>(row);
            let (i, j) =
                (elimination.place_of[row.i as usize], elimination.place_of[row.j as usize]);
            let answer = heavy(row.effective_mass, answer);
            self.add_to_diagonal::<S>(i, &stiffness(&answer, &on_i, &on_i));
            self.add_to_diagonal::<S>(j, &stiffness(&answer, &on_j, &on_j));
            if S::LEANS {
                let (i_to_j, j_to_i) = self.unsymmetric.off_diagonal_mut(number, i < j);
                add(i_to_j, &stiffness(&answer, &on_i, &on_j));
                add(j_to_i, &stiffness(&answer, &on_j, &on_i));
            } else {
                let [first, second] = if i < j { [&on_i, &on_j] } else { [&on_j, &on_i] };
                self.symmetric.add_to_upper(number, &stiffness(&answer, first, second));
            }
        }
        if S::LEANS {
            self.unsymmetric.factorise(elimination);
        } else {
            self.symmetric.factorise(elimination);
        }
    }

    /// Solves with the factors: `vector` (by place) is the right-hand side and becomes the solution.
    pub(super) fn solve<S: Shape>(&self, elimination: &Elimination, vector: &mut [[f64; D]]) {
        if S::LEANS {
            self.unsymmetric.solve(elimination, vector);
        } else {
            self.symmetric.solve(elimination, vector);
        }
    }

    #[inline(always)]
    fn add_to_diagonal<S: Shape>(&mut self, place: u32, block: &Block<D>) {
        if S::LEANS {
            add(self.unsymmetric.diagonal_mut(place), block);
        } else {
            self.symmetric.add_to_diagonal(place, block);
        }
    }
}

/// How the velocities of i, then of j, enter v_n and v_t of a row.
#[inline(always)]
pub(super) fn gradients<M: Model, const D: usize>(row: &Row<M>) -> [[[f64; D]; 2]; 2] {
    let part = |vector: [f64; 3]| std::array::from_fn(|axis| vector[axis]);
    M::gradients(row.normal).map(|of_body| of_body.map(part))
}

/// Adds Hᵀ m p to `momenta` (by place), of (σ, λ) in m/s by row; kg m/s.
#[inline(always)]
pub(super) fn push_all<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    elimination: &Elimination,
    impulses: impl Iterator<Item = [f64; 2]>,
    momenta: &mut [[f64; D]],
) {
    let fixed_count = problem.rows.fixed.len();
    for ((number, row), impulse) in problem.rows().zip(impulses) {
        let impulse = impulse.map(|part| row.effective_mass * part);
        let [on_i, on_j] = gradients::<M, D>(row);
        add_push(&mut momenta[elimination.place_of[row.i as usize] as usize], &on_i, impulse);
        if number >= fixed_count {
            let place = elimination.place_of[row.j as usize] as usize;
            add_push(&mut momenta[place], &on_j, impulse);
        }
    }
}

/// Visits the rows, by their numbers, with the change of (v_n, v_t) that goes with a change of velocities (by place).
#[inline(always)]
pub(super) fn for_each_change<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    elimination: &Elimination,
    changes: &[[f64; D]],
    mut visit: impl FnMut(usize, [f64; 2]),
) {
    let fixed_count = problem.rows.fixed.len();
    for (number, row) in problem.rows() {
        let [on_i, on_j] = gradients::<M, D>(row);
        let mut change = relative(&changes[elimination.place_of[row.i as usize] as usize], &on_i);
        if number >= fixed_count {
            let place = elimination.place_of[row.j as usize] as usize;
            let of_j = relative(&changes[place], &on_j);
            change = [change[0] + of_j[0], change[1] + of_j[1]];
        }
        visit(number, change);
    }
}

#[inline(always)]
fn add_push<const D: usize>(to: &mut [f64; D], on: &[[f64; D]; 2], impulse: [f64; 2]) {
    for axis in 0..D {
        to[axis] += on[0][axis] * impulse[0] + on[1][axis] * impulse[1];
    }
}

#[inline(always)]
fn relative<const D: usize>(velocity: &[f64; D], on: &[[f64; D]; 2]) -> [f64; 2] {
    on.map(|gradient| (0..D).map(|axis| gradient[axis] * velocity[axis]).sum())
}

/// By place: the inertias of the bodies, kg.
pub(super) fn inertias<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    elimination: &Elimination,
) -> impl Iterator<Item = [f64; D]> {
    let masses = elimination.body_at.iter().map(|&body| problem.bodies.masses[body as usize]);
    masses.map(|mass| std::array::from_fn(|axis| mass * M::INERTIA_OVER_MASS[axis]))
}

/// m S⁻¹, kg.
#[inline(always)]
fn heavy(mass: f64, answer: Block<2>) -> Block<2> {
    answer.map(|row| row.map(|entry| mass * entry))
}

/// m Hᵀ S⁻¹ H of two bodies, kg.
#[inline(always)]
fn stiffness<const D: usize>(
    [[nn, nt], [tn, tt]]: &Block<2>,
    one: &[[f64; D]; 2],
    other: &[[f64; D]; 2],
) -> Block<D> {
    let mut block = [[0.0; D]; D];
    for column in 0..D {
        let along_normal = nn * other[0][column] + nt * other[1][column];
        let along_tangent = tn * other[0][column] + tt * other[1][column];
        for row in 0..D {
            block[row][column] = one[0][row] * along_normal + one[1][row] * along_tangent;
        }
    }
    block
}

#[inline(always)]
fn add<const D: usize>(to: &mut Block<D>, block: &Block<D>) {
    for (entries, numbers) in to.iter_mut().zip(block) {
        for (entry, number) in entries.iter_mut().zip(numbers) {
            *entry += number;
        }
    }
}
