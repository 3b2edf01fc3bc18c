//! Accelerated projected gradients with adaptive restart (H. Mazhar, T. Heyn, D. Negrut, A. Tasora, *Using Nesterov's
//! method to accelerate multibody dynamics with friction and contact*, 2015).
//!
//! The unknowns are the scaled impulses s of a step: impulses divided by the root of the contact's effective mass, √J.
//! The scaled velocities (velocities times this root) are w(s) = A s + b, √J, with a symmetric matrix A and the scaled
//! velocities b without impulses (`contact_system`). With friction bounds that stay fixed during the solve (Tresca) the
//! solution minimises the convex function f(s) = ½ s·As + b·s over a box, and Nesterov's method applies. It computes
//! iterates x_k and extrapolated impulses y_k:
//!
//! > x_{k+1} = projection of y_k − D w(y_k)/L,  y_{k+1} = x_{k+1} + β_k (x_{k+1} − x_k),
//!
//! with the bound L of the curvature of f (below), the factor β_k of Nesterov's recursion, and the diagonal matrix D
//! with the entries 1 for normal and m_t/m_n for tangential impulses (m_n and m_t: effective masses along normal and
//! tangent). The friction bound of *Coulomb's law* depends on the solution. The method recomputes it from the normal
//! impulses of every iterate (an outer fixed-point iteration on the bound, with one inner step each). So a fixed point
//! of the iteration is a zero of the natural map that is common to all methods: it solves Coulomb's law, not a convex
//! relaxation of it. In return no theorem guarantees convergence; in practice restarts make the method converge.
//! Solving for each bound before computing the next bound is worse: the outer iteration may oscillate with growing
//! amplitude.
//!
//! * **L** is the largest curvature found during the solve. A change Δ of the impulses is accepted if Δ·AΔ ≤ L Δ·D⁻¹Δ;
//!   otherwise the step is repeated with a larger L, up to the bound of `ContactSystem::splitting`. A variant in which
//!   L falls between iterations, which is common, takes more iterations.
//! * **Restart** (B. O'Donoghue, E. Candès 2015): the factor β_k is reset to 0 if the extrapolation would point away
//!   from the direction of the projected step, (y_k − x_{k+1})·D⁻¹(x_{k+1} − x_k) > 0. The test with the gradient
//!   instead of the projected step takes two to three times as many iterations.
//! * w is affine in the impulses, so w(y) is computed from the known w(x): one product with A per iteration.

use super::contact_system::{BestIterate, ContactSystem, ScaledVector, WorkVectors, projected};
use super::stopping::{SolveReport, is_tested};
use crate::solver::settings::SolverSettings;

/// Factor by which a new bound L of the curvature of the minimised function exceeds the curvature that was found in a
/// step that was too long for the previous bound. The factor is slightly above 1, because the next step has about the
/// same curvature.
const MARGIN: f64 = 1.05;

/// Solves a contact system by accelerated projected gradients, from its present impulses. Every product of the system's
/// matrix A with a vector of impulses, which gives their velocities, counts as an iteration.
pub(super) fn solve<S: ContactSystem>(
    system: &mut S,
    settings: &SolverSettings,
    vectors: &mut WorkVectors,
) -> SolveReport {
    let WorkVectors { pairs: [x, w_x, y, w_y, next, w_next, best, ..], weights } = vectors;
    system.splitting(weights);
    let largest_curvature = 1.0 / weights.iter().copied().fold(1.0, f64::min);
    system.read(x);
    system.velocities(w_x);
    y.clone_from(x);
    w_y.clone_from(w_x);
    let mut best = BestIterate::new(system, best);
    let mut lipschitz = 1.0;
    let mut theta = 1.0;
    for sweeps in 1..=settings.max_sweeps {
        next.clear();
        next.extend(y.iter().zip(&*w_y).enumerate().map(|(contact, (y, w))| {
            let tangential = w[1] / system.tangential_diagonal(contact);
            projected(system, contact, [y[0] - w[0] / lipschitz, y[1] - tangential / lipschitz])
        }));
        system.write(next);
        system.velocities(w_next);
        let curvature = curvature(system, [y, w_y], [next, w_next]);
        let is_last = sweeps == settings.max_sweeps;
        if curvature > lipschitz && lipschitz < largest_curvature && !is_last {
            lipschitz = (MARGIN * curvature).min(largest_curvature);
            continue;
        }
        if is_tested(sweeps, settings) && system.is_settled(x, settings) {
            return SolveReport { sweeps, converged: true, ..SolveReport::default() };
        }
        if best.look(system, next, sweeps, settings) {
            return best.restore(system, sweeps);
        }
        // (y − next)·D⁻¹(next − now): if positive, the extrapolation points away from the projected step.
        let mut product = 0.0;
        for (contact, ((y, next), now)) in y.iter().zip(&*next).zip(&*x).enumerate() {
            product += (y[0] - next[0]) * (next[0] - now[0])
                + system.tangential_diagonal(contact) * (y[1] - next[1]) * (next[1] - now[1]);
        }
        let momentum = if product > 0.0 {
            theta = 1.0;
            0.0
        } else {
            let squared: f64 = theta * theta;
            let theta_next = 0.5 * (theta * (squared + 4.0).sqrt() - squared);
            let momentum = theta * (1.0 - theta) / (squared + theta_next);
            theta = theta_next;
            momentum
        };
        extrapolate(next, x, momentum, y);
        extrapolate(w_next, w_x, momentum, w_y);
        std::mem::swap(x, next);
        std::mem::swap(w_x, w_next);
    }
    best.restore(system, settings.max_sweeps)
}

/// Returns the curvature of the minimised function, dimensionless, along the difference Δ of two vectors of scaled
/// impulses x and y (impulses divided by the root of the effective mass): Δ·AΔ / Δ·D⁻¹Δ. AΔ is the difference of the
/// scaled velocities w_x and w_y that belong to x and y, and D⁻¹ is the diagonal matrix with the entries 1 (normal) and
/// [`ContactSystem::tangential_diagonal`] (tangential). Returns 0 if x and y are equal.
fn curvature<S: ContactSystem>(
    system: &S,
    [y, w_y]: [&ScaledVector; 2],
    [x, w_x]: [&ScaledVector; 2],
) -> f64 {
    let (mut energy, mut squared) = (0.0, 0.0);
    for (contact, (((y, w_y), x), w_x)) in y.iter().zip(w_y).zip(x).zip(w_x).enumerate() {
        let change = [x[0] - y[0], x[1] - y[1]];
        energy += change[0] * (w_x[0] - w_y[0]) + change[1] * (w_x[1] - w_y[1]);
        squared +=
            change[0] * change[0] + system.tangential_diagonal(contact) * change[1] * change[1];
    }
    if squared > 0.0 { energy / squared } else { 0.0 }
}

/// Extrapolates a vector of impulses or velocities: writes next + momentum · (next − now) to `result`. `momentum` is a
/// dimensionless factor.
fn extrapolate(next: &ScaledVector, now: &ScaledVector, momentum: f64, result: &mut ScaledVector) {
    result.clear();
    let ahead = |next: f64, now: f64| next + momentum * (next - now);
    let ends = next.iter().zip(now);
    result.extend(ends.map(|(next, now)| [ahead(next[0], now[0]), ahead(next[1], now[1])]));
}
