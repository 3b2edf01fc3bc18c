//! Which steps are raced on, by whom, how far, and for how long.

use super::super::entrants::{self, Entrant};
use crate::collection::{ADVANCE, CollectionPlan};
use crate::scene::Deposition;
use crate::solver::{FrictionModel, Method, SolverSettings};

/// Grains of the piles.
pub(super) const SIZES: [usize; 3] = [500, 2_000, 10_000];
/// Residuals of Coulomb's law, falling.
pub(super) const RESIDUALS: [f64; 3] = [1e-3, 1e-6, 1e-8];
/// The natural map of a model of friction that is certified.
pub(super) const CERTIFIED: f64 = 1e-8;
/// Bond numbers: the second one is felt, and yet lets a pile of any size slump.
pub(super) const BONDS: [f64; 2] = [0.0, 10.0];
/// Sweeps of the step in whose time others are told.
pub(super) const UNIT_SWEEPS: u32 = 40;
/// Width of a box over the root of the number of its grains, in diameters: 16 for 138.
const WIDTH_BY_ROOT: f64 = 1.35;

/// Coulomb's law is not solved in large piles, and a run that is certified leaves the warm start of no method
/// better off.
const ADVANCE_CERTIFIED: SolverSettings = SolverSettings {
    method: Method::InteriorPoint,
    friction_model: FrictionModel::Tresca,
    ..ADVANCE
};

/// Who races, and for how long.
pub(super) struct Plan {
    /// Under Coulomb's law, then under a convex model.
    pub entrants: Vec<Entrant>,
    /// Whose sweeps are the unit of time.
    pub unit: Entrant,
    /// A step gets no more time than so many of [`UNIT_SWEEPS`] sweeps.
    pub limit: f64,
}

impl Plan {
    pub(super) fn new(quick: bool) -> Self {
        let of_model = |entrant: &Entrant| entrant.solver.friction_model == FrictionModel::Tresca;
        let mut entrants = entrants::of_problems(false);
        entrants.extend(entrants::models().into_iter().filter(of_model));
        Self {
            entrants,
            unit: entrants::of_method(Method::Nsgs),
            limit: if quick { 100.0 } else { 1_000.0 },
        }
    }
}

/// What an entrant is to reach, falling.
pub(super) fn goals(entrant: &Entrant) -> &'static [f64] {
    if entrant.is_of_model() { &[CERTIFIED] } else { &RESIDUALS }
}

/// Steps at Δt = 1e-3 s of piles without cohesion and with, made quickly, as steep as that of 138 grains: beginning
/// to slump or, in their box, at rest.
pub(super) fn steps(grains: usize, in_a_box: bool, quick: bool) -> CollectionPlan {
    let times_secs = match (in_a_box, quick) {
        (true, true) => vec![5e-3],
        (true, false) => vec![1e-2, 2e-2],
        (false, true) => vec![2e-2],
        (false, false) => vec![3e-2, 0.1],
    };
    CollectionPlan {
        bonds: BONDS.to_vec(),
        time_steps_secs: vec![1e-3],
        times_secs,
        seeds: vec![1],
        grains,
        box_width_in_diameters: (WIDTH_BY_ROOT * (grains as f64).sqrt()).round(),
        deposition: Deposition::DropAndRoll,
        in_a_box,
        advance: ADVANCE_CERTIFIED,
        ..CollectionPlan::piles(2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collection::collect;
    use crate::scene::NewPile;

    #[test]
    fn a_pile_in_a_box_is_at_rest_and_one_without_slumps_each_step_certified() {
        let folder = tempfile::tempdir().expect("a folder");
        let speeds = [true, false].map(|in_a_box| {
            let collected =
                collect(&steps(SIZES[0], in_a_box, true), folder.path()).expect("a collection");
            assert_eq!(collected.len(), BONDS.len());
            collected.into_iter().map(|step| {
                let told = step.simulation.observables();
                assert!(
                    told.converged && told.model_residual.is_some_and(|left| left <= CERTIFIED)
                );
                let velocities = step.simulation.world().grains.velocities.iter();
                velocities.map(|velocity| velocity.length()).fold(0.0, f64::max)
            })
        });
        let [at_rest, moving] = speeds.map(Vec::from_iter);
        assert!(at_rest.iter().all(|speed| *speed < 0.01), "{at_rest:?} m/s");
        assert!(moving.iter().all(|speed| *speed > 0.1), "{moving:?} m/s");
    }

    #[test]
    fn boxes_are_as_steep_as_the_papers() {
        let paper = NewPile::default();
        let width = steps(paper.grains, false, false).box_width_in_diameters;
        assert_eq!(width, paper.box_width_in_diameters);
    }

    #[test]
    fn models_come_after_all_methods_and_have_a_goal_of_their_own() {
        let plan = Plan::new(true);
        let certified: Vec<_> =
            plan.entrants.iter().skip_while(|entrant| goals(entrant) == RESIDUALS).collect();
        let names: Vec<_> = certified.iter().map(|entrant| entrant.name.as_str()).collect();
        assert_eq!(names, ["nsgs tresca", "interior-point tresca"]);
    }
}
