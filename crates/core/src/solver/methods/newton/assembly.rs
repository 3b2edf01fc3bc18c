//! The linear system of one Newton step: guesses, stiffnesses and loads.

use super::memory::{Guess, Workspace};
use crate::solver::problem::{Kinematics, Model, Row, StepProblem};

/// Guesses what every contact does, and sets up the equations of the velocities that follow.
pub(super) fn assemble<M: Model, const D: usize>(
    problem: &StepProblem<M::Kinematics>,
    workspace: &mut Workspace<D>,
    compliance: f64,
) {
    let Workspace { graph, matrix, vector, guesses, .. } = workspace;
    let (elimination, pair_blocks) = (&graph.elimination, &graph.pair_blocks);
    matrix.clear(elimination);
    vector.clear();
    vector.resize(problem.bodies.len(), [0.0; D]);
    for (body, &mass) in problem.masses.iter().enumerate() {
        let place = elimination.place_of[body];
        let block = matrix.diagonal_mut(place);
        for (axis, row) in block.iter_mut().enumerate() {
            row[axis] = mass * M::Kinematics::INERTIA_OVER_MASS[axis];
        }
    }
    guesses.clear();
    for row in &problem.fixed_rows {
        let velocity = row.velocity(&problem.bodies[row.i as usize]);
        let guess = guess::<M>(problem, row, velocity);
        guesses.push(guess);
        let gradients = M::Kinematics::gradients(row.normal);
        let terms = Terms::<D>::new::<M>(problem, row, velocity, guess, compliance, &gradients[0]);
        let place = elimination.place_of[row.i as usize];
        terms.add(matrix.diagonal_mut(place), &terms);
        terms.add_load(&mut vector[place as usize]);
    }
    for (row, &block) in problem.pair_rows.iter().zip(pair_blocks) {
        let (body_i, body_j) = (&problem.bodies[row.i as usize], &problem.bodies[row.j as usize]);
        let velocity = M::Kinematics::relative_velocity(row.normal, body_i, body_j);
        let guess = guess::<M>(problem, row, velocity);
        guesses.push(guess);
        let gradients = M::Kinematics::gradients(row.normal);
        let on_i = Terms::<D>::new::<M>(problem, row, velocity, guess, compliance, &gradients[0]);
        let on_j = Terms::<D>::new::<M>(problem, row, velocity, guess, compliance, &gradients[1]);
        let i = elimination.place_of[row.i as usize];
        let j = elimination.place_of[row.j as usize];
        on_i.add_load(&mut vector[i as usize]);
        on_j.add_load(&mut vector[j as usize]);
        if guess != Guess::Open {
            on_i.add(matrix.diagonal_mut(i), &on_i);
            on_j.add(matrix.diagonal_mut(j), &on_j);
            let (i_to_j, j_to_i) = matrix.off_diagonal_mut(block, i < j);
            on_i.add(i_to_j, &on_j);
            on_j.add(j_to_i, &on_i);
        }
    }
}

/// What a contact would do next, by its law.
fn guess<M: Model>(
    problem: &StepProblem<M::Kinematics>,
    row: &Row<M::Kinematics>,
    [normal_velocity, tangential_velocity]: [f64; 2],
) -> Guess {
    let shifted = row.shifted_impulse - normal_velocity - row.restitution_velocity;
    if shifted <= 0.0 {
        return Guess::Open;
    }
    let bound = if M::FRICTION { problem.friction_bound::<M>(shifted) } else { 0.0 };
    if bound == 0.0 {
        return Guess::Slip(0.0);
    }
    let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
    let tangential = row.tangential_impulse - compliance * tangential_velocity;
    if tangential.abs() <= bound { Guess::Stick } else { Guess::Slip(tangential.signum()) }
}

/// A contact's part in the equations of one of its bodies.
struct Terms<const D: usize> {
    /// How the body's velocity enters v_n and v_t.
    normal: [f64; D],
    tangent: [f64; D],
    /// Where the law's answer to v_n acts: n, or n ± μt in slip.
    answer: [f64; D],
    /// Stiffnesses against v_n and v_t, kg.
    normal_stiffness: f64,
    tangential_stiffness: f64,
    /// What the impulse changes by at the present velocities, kg·m/s.
    load: [f64; D],
}

impl<const D: usize> Terms<D> {
    #[inline(always)]
    fn new<M: Model>(
        problem: &StepProblem<M::Kinematics>,
        row: &Row<M::Kinematics>,
        [normal_velocity, tangential_velocity]: [f64; 2],
        guess: Guess,
        compliance: f64,
        gradients: &[[f64; 3]; 2],
    ) -> Self {
        let part = |vector: &[f64; 3]| std::array::from_fn::<f64, D, _>(|axis| vector[axis]);
        let (normal, tangent) = (part(&gradients[0]), part(&gradients[1]));
        let mass = row.effective_mass;
        let stiffness = mass / compliance;
        let (shifted, tangential) = (row.shifted_impulse, row.tangential_impulse);
        let normal_change = -(normal_velocity + row.restitution_velocity) / compliance;
        let (slope, normal_stiffness, tangential_stiffness, changes) = match guess {
            Guess::Open => (0.0, 0.0, 0.0, [-shifted, -tangential]),
            Guess::Stick => {
                let softness = M::Kinematics::TANGENTIAL_COMPLIANCE;
                let tangential_change = -tangential_velocity / (softness * compliance);
                (0.0, stiffness, stiffness / softness, [normal_change, tangential_change])
            }
            Guess::Slip(sign) => {
                let slope = sign * problem.friction;
                let all = shifted + normal_change;
                let rubbing = if M::COMPRESSIVE_CONE { all - problem.capture_speed } else { all };
                (slope, stiffness, 0.0, [normal_change, slope * rubbing - tangential])
            }
        };
        let [normal_load, tangential_load] = changes.map(|change| mass * change);
        Self {
            normal,
            tangent,
            answer: std::array::from_fn(|axis| normal[axis] + slope * tangent[axis]),
            normal_stiffness,
            tangential_stiffness,
            load: std::array::from_fn(|axis| {
                normal_load * normal[axis] + tangential_load * tangent[axis]
            }),
        }
    }

    /// Adds the answer of this body's equations to the velocity of `other` to their block.
    #[inline(always)]
    fn add(&self, block: &mut [[f64; D]; D], other: &Self) {
        for (row, entries) in block.iter_mut().enumerate() {
            let normal = self.normal_stiffness * self.answer[row];
            let tangential = self.tangential_stiffness * self.tangent[row];
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry += normal * other.normal[column] + tangential * other.tangent[column];
            }
        }
    }

    #[inline(always)]
    fn add_load(&self, vector: &mut [f64; D]) {
        for (entry, load) in vector.iter_mut().zip(self.load) {
            *entry += load;
        }
    }
}
