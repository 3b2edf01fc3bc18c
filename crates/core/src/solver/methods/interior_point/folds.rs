//! The path of Coulomb's law, which may turn back.
//!
//! Where it does, a Newton step is as long as it likes and next to nothing of it can be taken. The contacts that
//! stop it, and those at the same bodies, are then made soft for a while: their impulses move little in a step,
//! which leads round a fold in a part of the pile while the rest goes on. Sweeps between two starts leave a
//! path that leads nowhere.

use super::memory::Workspace;
use super::shape::Shape;
use super::{InteriorPoint, SWEEPS_FIRST};
use crate::solver::methods::report::SolveReport;
use crate::solver::problem::Model;

/// Starts after which the path is left to others.
const STARTS: u32 = 4;
/// Sweeps between two starts.
const SWEEPS_BETWEEN: u32 = 30;
/// Factorisations without half the natural map after which a start is given up.
const PATIENCE: u32 = 8;
/// So many steps in a row that are shorter than the share end a start, too.
const SHORT_STEPS: (u32, f64) = (3, 0.05);
/// Of a step shorter than this, the contacts that stop it are made soft.
const LONG_STEP: f64 = 0.3;
/// Bounds of ε of a contact that is made soft, and the factor by which it grows.
const SOFT: (f64, f64, f64) = (1e-3, 1.0, 30.0);
/// Factor of ε of all others.
const HARDENING: f64 = 0.5;

impl<M: Model, S: Shape, const D: usize> InteriorPoint<'_, M, S, D> {
    /// Follows the path as far as it leads; where that is not to its end, the impulses are the best on the way.
    pub(super) fn follow_path(mut self) -> SolveReport {
        if self.settles_in(SWEEPS_FIRST) {
            return self.report;
        }
        self.workspace.graph.analyse(self.problem);
        self.begin();
        for start in 0..STARTS {
            if start > 0 && self.settles_in(SWEEPS_BETWEEN) {
                return self.report;
            }
            self.start(0);
            if self.leads_to_end() {
                return self.report;
            }
            self.go_back();
        }
        self.report
    }

    fn leads_to_end(&mut self) -> bool {
        let (mut milestone, mut since_milestone) = (f64::INFINITY, 0);
        let mut short_steps = 0;
        while since_milestone < PATIENCE && short_steps < SHORT_STEPS.0 && !self.is_spent() {
            let (share, left) = self.advance();
            if left.is_nan() {
                return false;
            }
            if self.finishes(left) {
                return true;
            }
            self.soften(share);
            short_steps = if share < SHORT_STEPS.1 { short_steps + 1 } else { 0 };
            since_milestone += 1;
            if left < 0.5 * milestone {
                (milestone, since_milestone) = (left, 0);
            }
        }
        false
    }

    /// Softens what stopped a step of which this share was taken, and hardens the rest.
    fn soften(&mut self, share: f64) {
        let Self { problem, workspace, .. } = self;
        let Workspace { contacts, step, stopped, .. } = &mut **workspace;
        let (least, most, growth) = SOFT;
        let fixed_count = problem.fixed_rows.len();
        stopped.clear();
        stopped.resize(problem.bodies.len(), false);
        if share < LONG_STEP {
            for (number, row) in problem.rows() {
                if contacts[number].longest::<S>(&step[number]) < LONG_STEP {
                    stopped[row.i as usize] = true;
                    if number >= fixed_count {
                        stopped[row.j as usize] = true;
                    }
                }
            }
        }
        for (number, row) in problem.rows() {
            let compliance = &mut contacts[number].compliance;
            let is_near =
                stopped[row.i as usize] || number >= fixed_count && stopped[row.j as usize];
            *compliance = if is_near {
                (growth * *compliance).max(least).min(most)
            } else {
                (HARDENING * *compliance).max(S::COMPLIANCE)
            };
        }
    }
}
