//! `auto`: a method by the size of a step's problem and by how it is stopped.
//!
//! The choice is that of the charts of speed against accuracy (`slump chart`). Newton's method wins
//! at every residual up to some hundred discs. On larger problems fewer of its guesses come true while a factorisation
//! costs more, and conjugate gradients take the lead. A stop by the impulses of one sweep belongs to Gauss–Seidel, whose
//! error is what such a study is about.

use crate::solver::method::Method;
use crate::solver::settings::{SolverSettings, StopTest};

/// Up to so many contacts Newton's method is taken. At 270 contacts it wins by far, at 1,000 by a
/// little, at 4,000 it solves few steps (`slump chart --large`).
const CONTACTS_FOR_NEWTON: usize = 1_000;

/// The method that solves a problem of so many contacts, with walls that a force drives or without: that of the
/// settings, unless they leave it to `auto`. Contacts are counted only then, since to find islands takes time.
pub(crate) fn picked(
    settings: &SolverSettings,
    contacts: impl FnOnce() -> usize,
    is_driven: bool,
) -> Method {
    match (settings.method, settings.stop) {
        (Method::Auto, StopTest::ImpulsePerMass) => Method::Nsgs,
        // Newton's method knows of no walls that a force drives.
        (Method::Auto, _) if !is_driven && contacts() <= CONTACTS_FOR_NEWTON => Method::Newton,
        (Method::Auto, _) => Method::Nncg,
        (method, _) => method,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_picks_by_size_and_stop_and_nothing_else_is_changed() {
        let auto = SolverSettings { method: Method::Auto, ..SolverSettings::default() };
        assert_eq!(picked(&auto, || 270, false), Method::Newton);
        assert_eq!(picked(&auto, || 270, true), Method::Nncg);
        assert_eq!(picked(&auto, || 5_000, false), Method::Nncg);
        let of_a_sweep = SolverSettings { stop: StopTest::ImpulsePerMass, ..auto };
        assert_eq!(picked(&of_a_sweep, || 2, false), Method::Nsgs);
        let said = SolverSettings { method: Method::Jacobi, ..auto };
        assert_eq!(picked(&said, || 270, false), Method::Jacobi);
    }
}
