//! W as methods see it that treat all impulses as one vector: s = P/√m_n with m_n = 1/W_nn, so that
//! A is W between √m_n and √m_n. Where W_nt ≠ 0 a contact's own block of A has entries off its
//! diagonal; no method on this trait asks for them to be zero.

use super::problem::{ContactRow, DelassusProblem, Neighbour};
use crate::solver::methods::{ContactSystem, Pairs};
use crate::solver::settings::{SolverSettings, StopTest};

impl ContactRow {
    /// √W_nn: s = √W_nn P, w = u/√W_nn.
    #[inline(always)]
    fn root(&self) -> f64 {
        self.local.normal.sqrt()
    }
}

impl ContactSystem for DelassusProblem {
    const FRICTION: bool = true;

    fn len(&self) -> usize {
        DelassusProblem::len(self)
    }

    fn read(&self, impulses: &mut Pairs) {
        impulses.clear();
        impulses.extend(self.rows.iter().zip(&self.impulses).map(|(row, impulse)| {
            let root = row.root();
            impulse.map(|impulse| root * impulse)
        }));
    }

    fn write(&mut self, impulses: &[[f64; 2]]) {
        for ((row, place), impulse) in self.rows.iter().zip(&mut self.impulses).zip(impulses) {
            let root = row.root();
            *place = impulse.map(|impulse| impulse / root);
        }
    }

    fn velocities(&self, velocities: &mut Pairs) {
        velocities.clear();
        velocities.extend((0..self.rows.len()).map(|contact| {
            let root = self.rows[contact].root();
            self.velocity(contact).map(|velocity| velocity / root)
        }));
    }

    #[inline(always)]
    fn tangential_diagonal(&self, contact: usize) -> f64 {
        let local = &self.rows[contact].local;
        local.tangential / local.normal
    }

    #[inline(always)]
    fn friction(&self, contact: usize) -> f64 {
        self.rows[contact].local.friction
    }

    #[inline(always)]
    fn friction_bound(&self, contact: usize, normal: f64) -> f64 {
        let row = &self.rows[contact];
        let shift =
            if self.compressive_cone { row.root() * row.local.cohesion_impulse } else { 0.0 };
        row.local.friction * (normal - shift).max(0.0)
    }

    /// With E the diagonal of A, a row of E^−½ A E^−½ has absolute entries whose sum dominates its
    /// diagonal (Gershgorin), so A ⪯ E/d where 1/d is the larger of a contact's two sums.
    fn splitting(&self, weights: &mut Vec<f64>) {
        weights.clear();
        let diagonal = |contact: usize| {
            let local = &self.rows[contact].local;
            [local.normal, local.tangential]
        };
        for contact in 0..self.rows.len() {
            let own = diagonal(contact);
            let off = self.rows[contact].local.mixed.abs() / (own[0] * own[1]).sqrt();
            let mut sums = [1.0 + off; 2];
            for Neighbour { block, contact: other } in self.neighbours_of(contact) {
                let others = diagonal(*other as usize);
                for (sum, (entries, own)) in sums.iter_mut().zip(block.iter().zip(own)) {
                    for (entry, other) in entries.iter().zip(others) {
                        *sum += entry.abs() / (own * other).sqrt();
                    }
                }
            }
            weights.push(1.0 / sums[0].max(sums[1]));
        }
    }

    fn sweep(&mut self) {
        DelassusProblem::sweep(self);
    }

    fn tested_sweep(&mut self, settings: &SolverSettings) -> bool {
        DelassusProblem::sweep(self);
        self.is_solved(settings)
    }

    fn residual(&self) -> f64 {
        DelassusProblem::residual(self)
    }

    fn is_settled(&self, _before: &[[f64; 2]], settings: &SolverSettings) -> bool {
        self.is_solved(settings)
    }
}

impl DelassusProblem {
    /// The stopping test, which without bodies is always the residual's.
    pub(super) fn is_solved(&self, settings: &SolverSettings) -> bool {
        debug_assert_eq!(settings.stop, StopTest::Residual);
        DelassusProblem::residual(self) <= settings.tolerance
    }
}
