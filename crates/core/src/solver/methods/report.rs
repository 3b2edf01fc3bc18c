//! How a solve ended.

/// How a solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Sweeps done; iterations where the method has no sweeps. Of islands, those of the one that took most, as with
    /// factorisations.
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

    /// Counts the solve of another island of the same step, which went beside this one.
    pub(crate) fn add_beside(&mut self, other: Self) {
        let is_left = |one: &Self| !(one.converged || one.fell_back);
        let is_any_left = is_left(self) || is_left(&other);
        self.sweeps = self.sweeps.max(other.sweeps);
        self.factorisations = self.factorisations.max(other.factorisations);
        self.converged &= other.converged;
        self.stalled |= other.stalled;
        self.fell_back = (self.fell_back || other.fell_back) && !is_any_left;
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
    fn islands_take_as_long_as_the_slowest_and_fall_back_where_all_that_are_unsolved_do() {
        let solved = SolveReport { sweeps: 9, converged: true, ..SolveReport::default() };
        let fallen = SolveReport { sweeps: 3, factorisations: 2, fell_back: true, ..solved };
        let fallen = SolveReport { converged: false, ..fallen };
        let left = SolveReport { stalled: true, ..SolveReport::default() };
        let all = |reports: &[SolveReport]| {
            let mut all = SolveReport::nothing_yet();
            reports.iter().for_each(|&report| all.add_beside(report));
            all
        };
        let both = SolveReport { sweeps: 9, ..fallen };
        assert_eq!(all(&[solved, fallen, solved]), both);
        assert_eq!(all(&[solved, solved]), solved);
        let unsolved = SolveReport { fell_back: false, stalled: true, ..both };
        assert_eq!(all(&[fallen, left, solved]), unsolved);
        assert_eq!(all(&[left, solved, fallen]), unsolved);
    }

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
