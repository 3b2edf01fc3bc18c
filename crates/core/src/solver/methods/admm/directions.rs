//! The two directions of an iteration: impulses and z from V by the law, and V from them.

use crate::contact::law;
use crate::solver::linear::{BlockMatrix, Elimination};
use crate::solver::methods::shared::contact_system::Pairs;
use crate::solver::problem::{Kinematics, Model, Row, StepProblem};

/// The directions for each number of degrees of freedom; those that are not used hold no memory.
#[derive(Debug, Default)]
pub(crate) struct AdmmMemory {
    pub(super) one: Directions<1>,
    pub(super) two: Directions<2>,
    pub(super) three: Directions<3>,
    /// The best impulses of a solve.
    pub(super) best: Pairs,
    /// Of the system whose residual is looked at.
    pub(super) root_masses: Vec<f64>,
}

impl Clone for AdmmMemory {
    /// Nothing in them outlives a solve, so a copy of a simulation need not carry them.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// V and z of one solve, and the matrix that ties them.
#[derive(Debug, Default)]
pub(super) struct Directions<const D: usize> {
    pub elimination: Elimination,
    pub matrix: BlockMatrix<D>,
    /// V, or the right-hand side that it is solved from, by place in the elimination.
    pub vector: Vec<[f64; D]>,
    /// z of each contact without restitution's term, m/s.
    targets: Pairs,
    pub impulses: Pairs,
    pub before: Pairs,
}

impl<const D: usize> Directions<D> {
    /// Factorises the matrix of a compliance ε.
    pub(super) fn factorise<M: Model>(
        &mut self,
        problem: &StepProblem<M::Kinematics>,
        compliance: f64,
    ) {
        let Self { elimination, matrix, .. } = self;
        matrix.clear(elimination);
        for (body, &mass) in problem.masses.iter().enumerate() {
            let block = matrix.diagonal_mut(elimination.place_of[body]);
            for (axis, entries) in block.iter_mut().enumerate() {
                entries[axis] = mass * M::Kinematics::INERTIA_OVER_MASS[axis];
            }
        }
        let tangential = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
        let add = |block: &mut [[f64; D]; D], stiffness: f64, a: &Gradients, b: &Gradients| {
            for (row, entries) in block.iter_mut().enumerate() {
                for (column, entry) in entries.iter_mut().enumerate() {
                    *entry += stiffness * a[0][row] * b[0][column];
                    if M::FRICTION {
                        *entry += stiffness * tangential * a[1][row] * b[1][column];
                    }
                }
            }
        };
        for row in &problem.fixed_rows {
            let [on_i, _] = M::Kinematics::gradients(row.normal);
            let i = elimination.place_of[row.i as usize];
            add(matrix.diagonal_mut(i), row.effective_mass / compliance, &on_i, &on_i);
        }
        for row in &problem.pair_rows {
            let [on_i, on_j] = M::Kinematics::gradients(row.normal);
            let i = elimination.place_of[row.i as usize];
            let j = elimination.place_of[row.j as usize];
            let stiffness = row.effective_mass / compliance;
            add(matrix.diagonal_mut(i), stiffness, &on_i, &on_i);
            add(matrix.diagonal_mut(j), stiffness, &on_j, &on_j);
            let number = elimination.block(i.min(j), i.max(j)) as u32;
            let (i_to_j, j_to_i) = matrix.off_diagonal_mut(number, i < j);
            add(i_to_j, stiffness, &on_i, &on_j);
            add(j_to_i, stiffness, &on_j, &on_i);
        }
        matrix.factorise(elimination);
    }

    /// V and z of the present impulses.
    pub(super) fn start<M: Model>(&mut self, problem: &StepProblem<M::Kinematics>) {
        let bodies = self.elimination.body_at.iter().map(|&body| &problem.bodies[body as usize]);
        self.vector.clear();
        self.vector.extend(bodies.map(|body| {
            let coordinates = M::Kinematics::coordinates(body);
            std::array::from_fn::<f64, D, _>(|axis| coordinates[axis])
        }));
        let mut targets = std::mem::take(&mut self.targets);
        targets.clear();
        targets.extend(rows(problem).map(|(row, is_pair)| self.velocity::<M>(row, is_pair)));
        self.targets = targets;
    }

    /// (v_n, v_t) of V at a contact, m/s.
    #[inline(always)]
    fn velocity<M: Model>(&self, row: &Row<M::Kinematics>, is_pair: bool) -> [f64; 2] {
        let [on_i, on_j] = M::Kinematics::gradients(row.normal);
        let along = |gradient: &[f64; 3], body: u32| -> f64 {
            let velocity = &self.vector[self.elimination.place_of[body as usize] as usize];
            (0..D).map(|axis| gradient[axis] * velocity[axis]).sum()
        };
        let mut velocity = [along(&on_i[0], row.i), along(&on_i[1], row.i)];
        if is_pair {
            velocity[0] += along(&on_j[0], row.j);
            velocity[1] += along(&on_j[1], row.j);
        }
        velocity
    }

    /// Takes the rows' impulses and z from V. Gives the factor by which ε would have to change for
    /// the two residuals to be alike.
    pub(super) fn apply_law<M: Model>(
        &mut self,
        problem: &mut StepProblem<M::Kinematics>,
        compliance: f64,
    ) -> f64 {
        let (mut of_velocities, mut of_impulses) = (0.0, 0.0);
        let mut targets = std::mem::take(&mut self.targets);
        let (friction, capture_speed) = (problem.friction, problem.capture_speed);
        let fixed = problem.fixed_rows.iter_mut().map(|row| (row, false));
        let rows = fixed.chain(problem.pair_rows.iter_mut().map(|row| (row, true)));
        for ((row, is_pair), target) in rows.zip(&mut targets) {
            let [normal, tangential] = self.velocity::<M>(row, is_pair);
            // V knows no images, and no surfaces.
            let [away, along] = match is_pair {
                true => M::Kinematics::slide_along(row.normal),
                false => [0.0, row.surface_speed()],
            };
            let opening = normal - away + row.restitution_velocity;
            let shifted = law::signorini(row.shifted_impulse - opening / compliance);
            let change = compliance * (shifted - row.shifted_impulse);
            row.shifted_impulse = shifted;
            let before = std::mem::replace(&mut target[0], normal + change);
            let mut note = |change: f64, of_target: f64| {
                of_velocities += row.effective_mass * change * change;
                of_impulses += row.effective_mass * of_target * of_target;
            };
            note(change, (target[0] - before) / compliance);
            if M::FRICTION {
                let softness = compliance * M::Kinematics::TANGENTIAL_COMPLIANCE;
                let bound = M::friction_bound(friction, shifted, capture_speed);
                let slip = tangential - along;
                let moved = law::coulomb(row.tangential_impulse - slip / softness, bound);
                let change = softness * (moved - row.tangential_impulse);
                row.tangential_impulse = moved;
                let before = std::mem::replace(&mut target[1], tangential + change);
                note(change, (target[1] - before) / softness);
            }
        }
        self.targets = targets;
        let balance: f64 = of_impulses / of_velocities;
        // Nothing is out of balance where nothing changes.
        if balance.is_finite() && balance > 0.0 { balance.sqrt().sqrt() } else { 1.0 }
    }

    /// The right-hand side from impulses and z.
    pub(super) fn take_loads<M: Model>(
        &mut self,
        problem: &StepProblem<M::Kinematics>,
        compliance: f64,
    ) {
        let Self { elimination, vector, targets, .. } = self;
        for (place, &body) in elimination.body_at.iter().enumerate() {
            let free = M::Kinematics::coordinates(&problem.free[body as usize]);
            let mass = problem.masses[body as usize];
            for axis in 0..D {
                let inertia = mass * M::Kinematics::INERTIA_OVER_MASS[axis];
                vector[place][axis] = inertia * free[axis];
            }
        }
        let softness = compliance * M::Kinematics::TANGENTIAL_COMPLIANCE;
        for (number, ((row, is_pair), target)) in rows(problem).zip(targets).enumerate() {
            let [normal, tangential] = problem.reduced_impulse(number, row);
            let mass = row.effective_mass;
            let normal = mass * (normal + target[0] / compliance);
            let tangential =
                if M::FRICTION { mass * (tangential + target[1] / softness) } else { 0.0 };
            let [on_i, on_j] = M::Kinematics::gradients(row.normal);
            let mut push = |gradients: &Gradients, body: u32| {
                let load = &mut vector[elimination.place_of[body as usize] as usize];
                for (axis, load) in load.iter_mut().enumerate() {
                    *load += normal * gradients[0][axis] + tangential * gradients[1][axis];
                }
            };
            push(&on_i, row.i);
            if is_pair {
                push(&on_j, row.j);
            }
        }
    }
}

/// How a body's coordinates enter v_n and v_t.
type Gradients = [[f64; 3]; 2];

/// All rows, and whether each is one between grains.
fn rows<K: Kinematics>(problem: &StepProblem<K>) -> impl Iterator<Item = (&Row<K>, bool)> {
    let fixed = problem.fixed_rows.iter().map(|row| (row, false));
    fixed.chain(problem.pair_rows.iter().map(|row| (row, true)))
}
