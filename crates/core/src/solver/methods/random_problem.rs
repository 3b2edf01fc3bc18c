//! Random contact problems for tests.

use std::ops::Range;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::contact::ContactLaw;
use crate::solver::kinematics::Model;
use crate::solver::problem::{FixedRow, PairRow, Row, StepProblem};

/// Returns a problem with random contacts between bodies of different masses. The indices of the two bodies of a
/// contact differ by less than `reach`; every sixth contact is with a fixed body. `added` is the range of the
/// restitution terms that the law adds to the normal velocity of a contact, m/s. If these terms are not negative,
/// bodies at rest satisfy every contact's condition on its normal velocity (normal velocity plus restitution term ≥ 0).
/// So these conditions do not contradict each other, as they can in a problem without a solution.
pub(super) fn random_problem<M: Model>(
    seed: u64,
    law: ContactLaw,
    bodies: usize,
    contacts: u32,
    reach: usize,
    added: Range<f64>,
) -> StepProblem<M> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut problem = StepProblem::<M> { law, ..StepProblem::default() };
    problem.bodies.mean_mass = 1.0;
    problem.rows.contacts.extend(0..contacts);
    for _ in 0..bodies {
        problem.bodies.masses.push(random.random_range(0.2..5.0));
        let speeds = [(); 3].map(|()| random.random_range(-1.0..1.0));
        problem.bodies.free.push(M::from_coordinates(speeds));
    }
    problem.bodies.before = problem.bodies.free.clone();
    for contact in 0..contacts {
        let i = random.random_range(0..bodies);
        let j = (i + random.random_range(1..reach)) % bodies;
        let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let normal = match M::AXES {
            1 => [angle.cos().signum(), 0.0],
            _ => [angle.cos(), angle.sin()],
        };
        let (of_i, of_j) = (problem.bodies.masses[i], problem.bodies.masses[j]);
        let is_fixed = contact % 6 == 0;
        let share = if is_fixed { 1.0 } else { of_j / (of_i + of_j) };
        let surface_speed = random.random_range(-0.1..0.1);
        let row = Row {
            i: i as u32,
            j: j as u32,
            normal: M::normal(normal),
            restitution_velocity: random.random_range(added.clone()),
            shifted_impulse: random.random_range(0.0..1.0),
            tangential_impulse: if M::FRICTION { random.random_range(-0.1..0.1) } else { 0.0 },
            effective_mass: of_i * share,
        };
        match is_fixed {
            true => problem.rows.fixed.push(FixedRow { row, surface_speed }),
            false => problem.rows.pairs.push(PairRow { row, share }),
        }
    }
    problem.form_velocities();
    problem
}
