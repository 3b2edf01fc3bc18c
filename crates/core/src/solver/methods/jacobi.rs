//! Jacobi with mass splitting (R. Tonge, F. Benevolenski, A. Voroshilov, *Mass splitting for
//! jitter-free parallel rigid body simulation*, 2012): all contacts at once, each as if it had its
//! grains' parts to itself.
//!
//! A grain with k contacts is cut into k parts of 1/k of its mass and inertia, one a contact; each
//! contact is solved exactly with its two parts, and the parts of a grain then share the mean of
//! their velocities. The mean of the parts moves as the whole grain does under all the impulses, so
//! no part is ever stored: one iteration is, with the split contact's inverse mass 1/(d m_n)
//! (`ContactSystem::splitting`),
//!
//! > s ← projection of s − D w(s),
//!
//! a projected gradient step whose D is small enough for any pile. Impulses spread by one contact an
//! iteration and are weakened by k, so it takes many; but no order of contacts enters.

use super::contact_system::{BestIterate, ContactSystem, WorkVectors, projected};
use super::stopping::{SolveReport, is_tested};
use crate::solver::settings::SolverSettings;

pub(super) fn solve<S: ContactSystem>(
    system: &mut S,
    settings: &SolverSettings,
    vectors: &mut WorkVectors,
) -> SolveReport {
    let WorkVectors { pairs: [impulses, before, velocities, best, ..], weights } = vectors;
    system.splitting(weights);
    system.read(impulses);
    let mut best = BestIterate::new(system, best);
    for sweeps in 1..=settings.max_sweeps {
        system.velocities(velocities);
        before.clone_from(impulses);
        for (contact, [normal, tangential]) in impulses.iter_mut().enumerate() {
            let ([w_n, w_t], weight) = (velocities[contact], weights[contact]);
            let tangential_weight = weight / system.tangential_diagonal(contact);
            let moved = [*normal - weight * w_n, *tangential - tangential_weight * w_t];
            [*normal, *tangential] = projected(system, contact, moved);
        }
        system.write(impulses);
        if is_tested(sweeps, settings) && system.is_settled(before, settings) {
            return SolveReport { sweeps, converged: true, ..SolveReport::default() };
        }
        if best.look(system, impulses, sweeps, settings) {
            return best.restore(system, sweeps);
        }
    }
    best.restore(system, settings.max_sweeps)
}
