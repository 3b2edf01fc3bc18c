//! The linear system of a Newton step, with the matrix M + Hᵀ m S⁻¹ H. The matrix is symmetric except for Coulomb's
//! law.
//!
//! M are the inertias of the bodies, H maps velocities of bodies to velocities of contacts, m are the effective masses,
//! and −S⁻¹ of a contact maps the change of its velocity to the change of its impulses (`contact`). A wall that a force
//! drives is one more body, numbered after the grains. The first of its coordinates is its speed. The inertia of this
//! coordinate is the wall's mass plus cΔt, with the wall's damping coefficient c and the time step Δt
//! (`problem::walls`). The other coordinates of the wall are not coupled to anything.

use super::contact::Shape;
use crate::solver::kinematics::Model;
use crate::solver::linear::{
    Block, BlockMatrix, ContactGraph, Elimination, SymmetricBlockMatrix, diagonal, inertias,
};
use crate::solver::problem::{DrivenBy, Row, StepProblem};

/// The matrix of the linear system of a Newton step; after the factorisation, its factors.
#[derive(Clone, Debug, Default)]
pub(super) struct StepMatrix<const D: usize> {
    symmetric: SymmetricBlockMatrix<D>,
    /// The matrix of the linear system if the step is solved under Coulomb's law, which makes this matrix unsymmetric.
    unsymmetric: BlockMatrix<D>,
}

impl<const D: usize> StepMatrix<D> {
    /// Assembles the matrix and factorises it. `answers` has one 2×2 matrix per contact: with a minus sign it maps the
    /// change of the contact's velocity to the change of its impulses divided by the effective mass.
    pub(super) fn assemble<M: Model, S: Shape>(
        &mut self,
        problem: &StepProblem<M>,
        graph: &ContactGraph,
        answers: impl Iterator<Item = Block<2>>,
    ) {
        let elimination = &graph.elimination;
        if S::LEANS {
            self.unsymmetric.clear(elimination);
        } else {
            self.symmetric.clear(elimination);
        }
        for (place, inertias) in (0..).zip(all_inertias::<M, D>(problem, elimination)) {
            self.add_to_diagonal::<S>(place, &diagonal(inertias));
        }
        let mut blocks = graph.pair_blocks.iter();
        for ((number, row), answer) in problem.rows().zip(answers) {
            let (on_i, second) = bodies_of::<M, D>(problem, number, row);
            let answer = heavy(row.effective_mass, answer);
            let i = elimination.place_of[row.i as usize];
            self.add_to_diagonal::<S>(i, &stiffness(&answer, &on_i, &on_i));
            let Some((j, on_j)) = second else { continue };
            let Some(&number) = blocks.next() else { break };
            let j = elimination.place_of[j];
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

    /// Solves the linear system with the factors. `vector`, in elimination order (the order of the bodies in the
    /// factorised matrix), is the right-hand side on entry and the solution on return.
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

/// Gradients of a contact's normal and tangential velocity (v_n, v_t) with respect to a body's velocity.
type Gradients<const D: usize> = [[f64; D]; 2];

/// Returns the gradients of a contact's normal and tangential velocity with respect to the velocity of grain i. If the
/// other body of the contact can move (grain or wall driven by a force), also returns that body's number and gradients.
#[inline(always)]
fn bodies_of<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    number: usize,
    row: &Row<M>,
) -> (Gradients<D>, Option<(usize, Gradients<D>)>) {
    let part = |vector: [f64; 3]| std::array::from_fn(|axis| vector[axis]);
    let [on_i, on_j] = M::gradients(row.normal).map(|of_body| of_body.map(part));
    if problem.rows.is_pair(number) {
        return (on_i, Some((row.j as usize, on_j)));
    }
    let of_wall = |DrivenBy { wall, along }| {
        let on_wall = along.map(|along: f64| part([-along, 0.0, 0.0]));
        (problem.bodies.now.len() + wall as usize, on_wall)
    };
    (on_i, problem.walls.driven_row(number).map(|known| of_wall(known.by)))
}

/// Adds to `momenta` the momentum changes of the bodies that follow from contact impulses, kg m/s, in elimination order
/// (the order of the bodies in the factorised matrix). `impulses` are the impulses (normal, tangential) of each contact
/// divided by its effective mass, m/s.
#[inline(always)]
pub(super) fn push_all<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    elimination: &Elimination,
    impulses: impl Iterator<Item = [f64; 2]>,
    momenta: &mut [[f64; D]],
) {
    for ((number, row), impulse) in problem.rows().zip(impulses) {
        let impulse = impulse.map(|part| row.effective_mass * part);
        let (on_i, second) = bodies_of::<M, D>(problem, number, row);
        add_push(&mut momenta[elimination.place_of[row.i as usize] as usize], &on_i, impulse);
        if let Some((j, on_j)) = second {
            add_push(&mut momenta[elimination.place_of[j] as usize], &on_j, impulse);
        }
    }
}

/// Calls `visit` for each contact with the number of its row (the data of the contact) and the change of its normal and
/// tangential velocity, m/s, that follows from `changes`, the changes of the bodies' velocities in elimination order
/// (the order of the bodies in the factorised matrix).
#[inline(always)]
pub(super) fn for_each_change<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    elimination: &Elimination,
    changes: &[[f64; D]],
    mut visit: impl FnMut(usize, [f64; 2]),
) {
    for (number, row) in problem.rows() {
        let (on_i, second) = bodies_of::<M, D>(problem, number, row);
        let mut change = relative(&changes[elimination.place_of[row.i as usize] as usize], &on_i);
        if let Some((j, on_j)) = second {
            let of_j = relative(&changes[elimination.place_of[j] as usize], &on_j);
            change = [change[0] + of_j[0], change[1] + of_j[1]];
        }
        visit(number, change);
    }
}

#[inline(always)]
fn add_push<const D: usize>(to: &mut [f64; D], on: &Gradients<D>, impulse: [f64; 2]) {
    for axis in 0..D {
        to[axis] += on[0][axis] * impulse[0] + on[1][axis] * impulse[1];
    }
}

#[inline(always)]
fn relative<const D: usize>(velocity: &[f64; D], on: &Gradients<D>) -> [f64; 2] {
    on.map(|gradient| (0..D).map(|axis| gradient[axis] * velocity[axis]).sum())
}

/// Iterates over the inertias of grains and of walls driven by a force, in elimination order (the order of the bodies
/// in the factorised matrix), kg, one per degree of freedom. The coordinate of a rotation is radius times angle, so its
/// inertia is a mass, too.
pub(super) fn all_inertias<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    elimination: &Elimination,
) -> impl Iterator<Item = [f64; D]> {
    let StepProblem { bodies, walls, .. } = problem;
    elimination.body_at.iter().map(|&body| match bodies.masses.get(body as usize) {
        Some(&mass) => inertias::<M, D>(mass),
        None => {
            let wall = &walls.driven[body as usize - bodies.masses.len()];
            std::array::from_fn(|axis| if axis == 0 { 1.0 / wall.response } else { 1.0 })
        }
    })
}

/// Returns the stiffness of a contact, kg: its effective mass, kg, times the dimensionless 2×2 matrix `answer`, which
/// with a minus sign maps the change of the contact's velocity to the change of its impulses divided by the effective
/// mass.
#[inline(always)]
fn heavy(mass: f64, answer: Block<2>) -> Block<2> {
    answer.map(|row| row.map(|entry| mass * entry))
}

/// Returns the block, kg, that a contact adds to the matrix for two bodies. The first argument is the contact's
/// stiffness, a 2×2 matrix, kg, which with a minus sign maps the change of the contact's velocity to the change of its
/// impulses. `one` and `other` are the gradients of the contact's velocity with respect to the velocities of the two
/// bodies. The block is the product of `one` transposed, the stiffness and `other`.
#[inline(always)]
fn stiffness<const D: usize>(
    [[nn, nt], [tn, tt]]: &Block<2>,
    one: &Gradients<D>,
    other: &Gradients<D>,
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
