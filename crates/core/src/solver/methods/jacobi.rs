//! Jacobi with mass splitting (R. Tonge, F. Benevolenski, A. Voroshilov, *Mass splitting for jitter-free parallel rigid
//! body simulation*, 2012): all contacts are solved at the same time, each with its own part of the mass of its grains.
//!
//! A grain with k contacts is cut into k parts of 1/k of its mass and inertia, one per contact. Each contact is solved
//! exactly with its two parts; then the velocities of a grain's parts are replaced by their mean. The mean moves like
//! the whole grain under all impulses, so parts are never stored. Let s be the scaled impulses and w(s) the scaled
//! velocities, √J (`contact_system`), m_n and m_t the effective masses of a contact along normal and tangent, and 1/(d
//! m_n) the inverse mass of the split contact, which defines the weight d. The diagonal matrix D has the entries d
//! (normal) and d m_t/m_n (tangential) (`ContactSystem::splitting`). One iteration is
//!
//! > s ← projection of s − D w(s),
//!
//! a projected gradient step whose D is small enough for any pile. In one iteration an impulse spreads only to
//! neighbouring contacts, and is divided by k, so many iterations are needed. In return the result does not depend on
//! an order of contacts.

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
