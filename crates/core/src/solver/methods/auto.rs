//! `auto`: a method by what a step is solved under, by how it is stopped, and by the size of its problem.
//!
//! The convex models of friction are solved by the interior point, which solves them at any size. Under Coulomb's law
//! the choice is that of the charts of speed against accuracy (`slump chart`): Newton's method wins at every residual up
//! to some hundred discs, and solves more steps than others up to thousands. A stop by the impulses of one sweep
//! belongs to Gauss–Seidel, whose error is what such a study is about.

use crate::solver::method::Method;
use crate::solver::settings::{FrictionModel, SolverSettings, StopTest};

/// Up to so many contacts Newton's method is taken under Coulomb's law. Neither it nor conjugate gradients solve one of the
/// first 20 steps of dense piles to 1e-6 within 1,000 iterations. Of 2,000 grains it leaves half to two thirds of their residual
/// in five times their time, of 10,000 grains seven to nine tenths in eleven times their time.
const CONTACTS_FOR_NEWTON: usize = 10_000;

/// The method that solves a problem of so many contacts under a model of friction, with walls that a force drives or
/// without: that of the settings, unless they leave it to `auto`.
pub(crate) fn picked(
    settings: &SolverSettings,
    model: FrictionModel,
    contacts: usize,
    is_driven: bool,
) -> Method {
    match (settings.method, settings.stop) {
        (Method::Auto, StopTest::ImpulsePerMass) => Method::Nsgs,
        (Method::Auto, _) if model != FrictionModel::Coulomb => Method::InteriorPoint,
        // Newton's method knows of no walls that a force drives.
        (Method::Auto, _) if !is_driven && contacts <= CONTACTS_FOR_NEWTON => Method::Newton,
        (Method::Auto, _) => Method::Nncg,
        (method, _) => method,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_picks_by_model_stop_and_size_and_nothing_else_is_changed() {
        let auto = SolverSettings::default();
        let coulomb =
            |contacts, is_driven| picked(&auto, FrictionModel::Coulomb, contacts, is_driven);
        assert_eq!(coulomb(270, false), Method::Newton);
        assert_eq!(coulomb(270, true), Method::Nncg);
        assert_eq!(coulomb(20_000, false), Method::Nncg);
        let of = |settings| picked(&settings, FrictionModel::Tresca, 20_000, false);
        assert_eq!(of(auto), Method::InteriorPoint);
        let of_a_sweep = SolverSettings { stop: StopTest::ImpulsePerMass, ..auto };
        assert_eq!(of(of_a_sweep), Method::Nsgs);
        let said = SolverSettings { method: Method::Jacobi, ..auto };
        assert_eq!(of(said), Method::Jacobi);
    }
}
