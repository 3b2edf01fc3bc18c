//! The contact system in which impulses move bodies.

use super::contact_system::{ContactSystem, Pairs, Vectors};
use crate::solver::methods::nsgs::{sweep, tested_sweep};
use crate::solver::problem::{Kinematics, Model, Row, StepProblem, residual};
use crate::solver::settings::{SolverSettings, StopTest};

/// What is kept by a method that works on a system of bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct SystemMemory {
    vectors: Vectors,
    root_masses: Vec<f64>,
}

impl SystemMemory {
    /// A problem as a system, and vectors to work with.
    pub(crate) fn system<'a, M: Model>(
        &'a mut self,
        problem: &'a mut StepProblem<M::Kinematics>,
    ) -> (BodySystem<'a, M>, &'a mut Vectors) {
        (BodySystem::new(problem, &mut self.root_masses), &mut self.vectors)
    }
}

/// The problem of a step: impulses move bodies, and A is never formed.
#[derive(Debug)]
pub struct BodySystem<'a, M: Model> {
    problem: &'a mut StepProblem<M::Kinematics>,
    /// √m_n of the rows, kg^½.
    root_masses: &'a [f64],
}

impl<'a, M: Model> BodySystem<'a, M> {
    /// Contacts are numbered as the rows: those with fixed bodies first. `root_masses` is cleared
    /// first.
    pub fn new(problem: &'a mut StepProblem<M::Kinematics>, root_masses: &'a mut Vec<f64>) -> Self {
        root_masses.clear();
        root_masses.extend(problem.rows().map(|(_, row)| row.effective_mass.sqrt()));
        Self { problem, root_masses }
    }

    /// √m_n of a contact, kg^½: P = √m_n s.
    pub fn root_mass(&self, contact: usize) -> f64 {
        self.root_masses[contact]
    }

    /// Rows with √m_n, kg^½.
    fn rows(&self) -> impl Iterator<Item = (&Row<M::Kinematics>, &f64)> {
        self.problem.rows().map(|(_, row)| row).zip(self.root_masses)
    }
}

impl<M: Model> ContactSystem for BodySystem<'_, M> {
    const FRICTION: bool = M::FRICTION;

    fn len(&self) -> usize {
        self.root_masses.len()
    }

    fn read(&self, impulses: &mut Pairs) {
        impulses.clear();
        impulses.extend(
            self.rows()
                .map(|(row, root)| [root * row.shifted_impulse, root * row.tangential_impulse]),
        );
    }

    fn write(&mut self, impulses: &[[f64; 2]]) {
        let StepProblem { fixed_rows, pair_rows, .. } = &mut *self.problem;
        let rows = fixed_rows.iter_mut().chain(pair_rows);
        for ((row, root), [normal, tangential]) in rows.zip(self.root_masses).zip(impulses) {
            row.shifted_impulse = normal / root;
            if M::FRICTION {
                row.tangential_impulse = tangential / root;
            }
        }
        self.problem.form_velocities();
    }

    fn velocities(&self, velocities: &mut Pairs) {
        let StepProblem { bodies, fixed_rows, pair_rows, .. } = &*self.problem;
        let (fixed_roots, pair_roots) = self.root_masses.split_at(fixed_rows.len());
        let scaled = |row: &Row<M::Kinematics>, root: f64, [normal, tangential]: [f64; 2]| {
            let tangential = if M::FRICTION { root * tangential } else { 0.0 };
            [root * (normal + row.restitution_velocity), tangential]
        };
        velocities.clear();
        velocities.extend(
            fixed_rows
                .iter()
                .zip(fixed_roots)
                .map(|(row, &root)| scaled(row, root, row.velocity(&bodies[row.i as usize]))),
        );
        velocities.extend(pair_rows.iter().zip(pair_roots).map(|(row, &root)| {
            let (i, j) = (&bodies[row.i as usize], &bodies[row.j as usize]);
            scaled(row, root, M::Kinematics::relative_velocity(row.normal, i, j))
        }));
    }

    #[inline(always)]
    fn tangential_diagonal(&self, _contact: usize) -> f64 {
        M::Kinematics::TANGENTIAL_COMPLIANCE
    }

    #[inline(always)]
    fn friction(&self, _contact: usize) -> f64 {
        self.problem.friction
    }

    #[inline(always)]
    fn friction_bound(&self, contact: usize, normal: f64) -> f64 {
        if M::COMPRESSIVE_CONE {
            let root = self.root_masses[contact];
            root * self.problem.friction_bound::<M>(normal / root)
        } else {
            self.problem.friction_bound::<M>(normal)
        }
    }

    /// Mass splitting (R. Tonge, F. Benevolenski, A. Voroshilov 2012): a body with k contacts is cut
    /// into k parts of 1/k of its mass and inertia, one a contact. By Cauchy–Schwarz the parts,
    /// moved each on its own, answer at least as much as the body does: A ⪯ D⁻¹. For the contact's
    /// own diagonal, 1/m_i becomes k_i/m_i, and with g_i = m_ij/m_i
    ///
    /// > 1/d = k_i g_i + k_j (1 − g_i), against a fixed body k_i,
    ///
    /// and k_i + k κ(b_n² + b_t² m_t/m_n) against a wall with k contacts that is driven (`problem::driven`).
    fn splitting(&self, weights: &mut Vec<f64>) {
        let StepProblem { bodies, fixed_rows, pair_rows, .. } = &*self.problem;
        // Counts come first in the same memory, one a body.
        let count = bodies.len();
        weights.clear();
        weights.resize(count, 0.0);
        for row in fixed_rows {
            weights[row.i as usize] += 1.0;
        }
        for row in pair_rows {
            weights[row.i as usize] += 1.0;
            weights[row.j as usize] += 1.0;
        }
        match self.problem.is_driven() {
            false => {
                for row in fixed_rows {
                    weights.push(1.0 / weights[row.i as usize]);
                }
            }
            true => {
                let walls = self.problem.wall_compliances();
                for (row, of_wall) in fixed_rows.iter().zip(walls) {
                    weights.push(1.0 / (weights[row.i as usize] + of_wall.unwrap_or(0.0)));
                }
            }
        }
        for row in pair_rows {
            let (i, j) = (weights[row.i as usize], weights[row.j as usize]);
            weights.push(1.0 / (row.share() * i + (1.0 - row.share()) * j));
        }
        weights.drain(..count);
    }

    fn sweep(&mut self) {
        sweep::<M, false>(self.problem);
    }

    fn tested_sweep(&mut self, settings: &SolverSettings) -> bool {
        tested_sweep::<M>(self.problem, settings)
    }

    fn residual(&self) -> f64 {
        residual::<M>(self.problem)
    }

    fn is_settled(&self, before: &[[f64; 2]], settings: &SolverSettings) -> bool {
        let tolerance = settings.tolerance;
        if settings.stop == StopTest::Residual {
            return self.residual() <= tolerance;
        }
        // Impulses in N·s, and without the shift.
        let (mut squared, mut absolute, mut whole) = (0.0, 0.0, 0.0);
        for ((number, (row, root)), [normal, tangential]) in self.rows().enumerate().zip(before) {
            let mass = row.effective_mass;
            let mut add = |now: f64, change: f64| {
                squared += change * change;
                absolute += change.abs();
                whole += now * now;
            };
            let [now, now_tangential] = self.problem.reduced_impulse(number, row);
            add(mass * now, mass * row.shifted_impulse - root * normal);
            if M::FRICTION {
                add(mass * now_tangential, mass * row.tangential_impulse - root * tangential);
            }
        }
        match settings.stop {
            StopTest::ImpulsePerMass => absolute <= tolerance * self.problem.mean_mass,
            // An infinite change is no larger than infinite impulses, and settles nothing.
            _ => squared.is_finite() && squared <= tolerance * tolerance * whole,
        }
    }
}
