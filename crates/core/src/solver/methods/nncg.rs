//! Non-smooth non-linear conjugate gradients (M. Silcowitz, S. Niebe, K. Erleben, *A nonsmooth nonlinear conjugate
//! gradient method for interactive contact force problems*, 2010).
//!
//! A Gauss–Seidel sweep G maps the impulses s of all contacts to G(s), and its fixed points are solutions. If the sweep
//! is regarded as a descent step, its change of the impulses, r = G(s) − s, is a preconditioned negative gradient. Then
//! sweep number k and the sweep before it can be combined as the Fletcher–Reeves method combines gradients, with a
//! factor β and a search direction p:
//!
//! > r_k = G(s_k) − s_k,  β = ‖r_k‖²/‖r_{k−1}‖²,  s_{k+1} = G(s_k) + β p_{k−1},  p_k = r_k + β p_{k−1}.
//!
//! If the gradient has grown (β > 1), the direction p is reset and the result of the sweep is kept without
//! extrapolation. The sweep solves Coulomb's law, and so does the method. If extrapolation moves impulses out of the
//! friction cone, the next sweep projects them, and the final result is always the result of a sweep.

use super::contact_system::{BestIterate, ContactSystem, WorkVectors, dot};
use super::stopping::{SolveReport, is_tested};
use crate::solver::settings::SolverSettings;

pub(super) fn solve<S: ContactSystem>(
    system: &mut S,
    settings: &SolverSettings,
    vectors: &mut WorkVectors,
) -> SolveReport {
    let WorkVectors { pairs: [impulses, swept, step, direction, best, ..], .. } = vectors;
    system.read(impulses);
    let mut best = BestIterate::new(system, best);
    direction.clear();
    direction.resize(impulses.len(), [0.0; 2]);
    let mut squared_before = f64::INFINITY;
    for sweeps in 1..=settings.max_sweeps {
        if is_tested(sweeps, settings) {
            if system.tested_sweep(settings) {
                return SolveReport { sweeps, converged: true, ..SolveReport::default() };
            }
        } else {
            system.sweep();
        }
        system.read(swept);
        if best.look(system, swept, sweeps, settings) {
            return best.restore(system, sweeps);
        }
        step.clear();
        step.extend(
            swept.iter().zip(&*impulses).map(|(now, old)| [now[0] - old[0], now[1] - old[1]]),
        );
        let squared = dot(step, step);
        // NaN compares false, so a factor of NaN does not extrapolate.
        let factor = squared / squared_before;
        let extrapolates = factor <= 1.0 && sweeps < settings.max_sweeps;
        squared_before = squared;
        if !extrapolates {
            direction.iter_mut().for_each(|entry| *entry = [0.0; 2]);
            std::mem::swap(impulses, swept);
            continue;
        }
        for ((entry, now), step) in direction.iter_mut().zip(swept.iter_mut()).zip(&*step) {
            let along = [factor * entry[0], factor * entry[1]];
            *now = [now[0] + along[0], now[1] + along[1]];
            *entry = [step[0] + along[0], step[1] + along[1]];
        }
        system.write(swept);
        std::mem::swap(impulses, swept);
    }
    best.restore(system, settings.max_sweeps)
}
