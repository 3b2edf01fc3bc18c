//! The path of a convex model, which leads to its solution.

use super::shape::Shape;
use super::{InteriorPoint, SWEEPS_FIRST, set_impulses};
use crate::solver::methods::report::SolveReport;
use crate::solver::problem::Model;

/// Factorisations without a smaller natural map after which a start is given up.
const PATIENCE: u32 = 15;
/// Where the natural map is below this and not yet small enough, proximal multipliers are to end the solve. On cones they
/// are not tried: paths there do not slow down.
const POLISH_FROM: f64 = 1e-6;
/// Where they did not, they are tried again below this share of it.
const POLISH_AGAIN: f64 = 0.1;
/// Sweeps that stand for a solution where there is none.
const SWEEPS_INSTEAD: u32 = 100;
/// Starts, each further up the path.
const STARTS: u32 = 4;

impl<M: Model, S: Shape, const D: usize> InteriorPoint<'_, M, S, D> {
    /// Follows the path to its end. Where rounding bars the way, begins again further up.
    pub(super) fn solve_convex(mut self) -> SolveReport {
        if self.settles_in(SWEEPS_FIRST) {
            return self.report;
        }
        self.workspace.graph.analyse(self.problem);
        self.begin();
        for start in 0..STARTS {
            self.start(start);
            let (mut best, mut since_best) = (f64::INFINITY, 0);
            let mut polish_from = if S::CONE { 0.0 } else { POLISH_FROM };
            while since_best < PATIENCE {
                if self.is_spent() {
                    break;
                }
                let (_, left) = self.advance();
                if self.finishes(left) {
                    return self.report;
                }
                if left <= polish_from {
                    if self.is_bounded() && self.polish() {
                        return self.report;
                    }
                    self.take_impulses();
                    polish_from = POLISH_AGAIN * left;
                }
                // Not a number is not below anything.
                since_best = if left < best { 0 } else { since_best + 1 };
                best = best.min(left);
                if left.is_nan() {
                    break;
                }
            }
            self.go_back();
        }
        if self.solve_from_far() {
            return self.report;
        }
        // Where no velocities satisfy all contacts at once, impulses grow without bound along the path.
        set_impulses(self.problem, &self.workspace.first);
        self.settles_in(SWEEPS_INSTEAD);
        self.report.stalled = !self.report.converged && !self.is_spent();
        self.report
    }

    /// Whether as many sweeps and factorisations were made as the settings allow.
    pub(super) fn is_spent(&self) -> bool {
        self.report.sweeps + self.report.factorisations >= self.settings.max_sweeps
    }
}
