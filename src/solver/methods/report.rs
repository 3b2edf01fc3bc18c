//! How a solve ended.

/// How a solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Sweeps done; iterations where the method has no sweeps.
    pub sweeps: u32,
    /// Matrices factorised.
    pub factorisations: u32,
    /// Whether the stopping test was met.
    pub converged: bool,
    /// Whether a solve that did not converge had stalled, rather than being stopped too early.
    pub stalled: bool,
    /// Whether a solve that did not converge was ended under bounds of friction instead.
    pub fell_back: bool,
}

impl SolveReport {
    /// Of solves that are still to come.
    pub(crate) fn nothing_yet() -> Self {
        Self { converged: true, ..Self::default() }
    }

    /// Counts another solve of the same step. The step has stalled where one of them has.
    pub fn add(&mut self, other: Self) {
        let Self { sweeps, factorisations, converged, stalled, fell_back } = other;
        self.sweeps += sweeps;
        self.factorisations += factorisations;
        self.converged &= converged;
        self.stalled |= stalled;
        self.fell_back |= fell_back;
    }

    /// The same with the work of solves that came before, and of whose outcome nothing is left.
    pub(crate) fn after(self, earlier: Self) -> Self {
        Self {
            sweeps: self.sweeps + earlier.sweeps,
            factorisations: self.factorisations + earlier.factorisations,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_one_of_whose_solves_stalled_has_stalled() {
        let solved = SolveReport { sweeps: 3, converged: true, ..SolveReport::default() };
        let stalled = SolveReport { sweeps: 5, stalled: true, ..SolveReport::default() };
        let mut step = solved;
        step.add(stalled);
        step.add(solved);
        assert_eq!(step, SolveReport { sweeps: 11, ..stalled });
    }
}
