//! How well steps are solved: what the window begins with, and what else is one click away.

use crate::scene::{Config, Scene};
use crate::sim::Surroundings;
use crate::solver::{Fallback, Method, SolverChanges, SolverSettings};
use crate::study::PILE_SOLVER;
use crate::world::Periodic;

/// Piles of more grains begin with sweeps that are counted, so that they move before one's eyes.
const MOST_SOLVED_GRAINS: usize = 2_000;

/// A way to solve steps that has a name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// On its button.
    pub name: &'static str,
    /// What it costs, in time and in accuracy.
    pub hint: &'static str,
    /// What it is.
    pub settings: SolverSettings,
}

impl Effort {
    /// What it is where borders shear or a force drives a wall: by the method next to its own that knows of them.
    pub(super) fn among(&self, surroundings: &Surroundings) -> SolverSettings {
        let info = self.settings.method.info();
        let shears = surroundings.periodic.is_some_and(Periodic::is_sheared);
        let is_driven = surroundings.moving.iter().any(|motion| motion.is_driven);
        if (shears && !info.takes_shear) || (is_driven && !info.takes_drives) {
            return self.settings.by(Method::Nsgs);
        }
        self.settings
    }
}

/// So well that tighter solutions tell no other mean (`RESULTS.md`, speed against accuracy).
pub(super) const TRUSTED: Effort = Effort {
    name: "Trusted",
    hint: "Each step to a residual of 1e-6: what is tighter has changed no mean of piles so far. At 138 grains \
           faster than Figures.",
    settings: SolverSettings {
        fallback: Fallback::OfMethod,
        ..SolverSettings::to_residual(Method::Auto, 1e-6, 500)
    },
};

/// Forty sweeps, by all cores.
pub(super) const FAST: Effort = Effort {
    name: "Fast",
    hint: "40 sweeps a step, solved or not, for large piles: slump is off by about 0.11 in the mean, as much as \
           by Δt itself. A step of 10,000 grains takes some 10 ms.",
    settings: SolverSettings {
        fallback: Fallback::None,
        ..SolverSettings::to_residual(Method::NsgsParallel, 1e-6, 40)
    },
};

/// As the paper's figures are drawn.
pub(super) const FIGURES: Effort = Effort {
    name: "Figures",
    hint: "Gauss-Seidel to a relative change of 1e-7, as the figures of slump --headless are computed: the same \
           to the last digit. Two to five times as slow as Trusted.",
    settings: PILE_SOLVER,
};

/// All of them.
pub(super) const EFFORTS: [Effort; 3] = [FAST, TRUSTED, FIGURES];

/// What a pile of that many grains begins with.
pub(super) fn for_grains(grains: usize) -> Effort {
    if grains <= MOST_SOLVED_GRAINS { TRUSTED } else { FAST }
}

/// What a scene begins with whose user says nothing of how well its steps are to be solved: a pile what suits its
/// size, every other what it says itself. Whoever watches must not take the impulses of an unsolved
/// step for those of a law, so such a step is then solved under bounds of friction, but where a force drives a wall,
/// of which that solution knows nothing.
pub(super) fn complete(scene: &mut Scene, asked: &SolverChanges) {
    let is_driven = scene.motions.iter().any(|motion| motion.drive.is_some());
    let is_pile = scene.name == Config::DEFAULT_SCENE;
    if is_pile && scene.solver == SolverSettings::default() {
        scene.solver = for_grains(scene.grains.len()).settings;
    } else if !is_driven && asked.fallback.is_none() && scene.solver.fallback == Fallback::OfMethod
    {
        scene.solver.fallback = Fallback::Tresca;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

    #[test]
    fn steps_fall_back_in_the_window_but_where_a_force_drives_a_wall() {
        for (name, fallback) in [("cradle", Fallback::Tresca), ("shear", Fallback::OfMethod)] {
            let mut scene = built_in(name).expect("a scene");
            complete(&mut scene, &SolverChanges::default());
            assert_eq!(scene.solver.fallback, fallback, "{name}");
            scene.simulation().expect("a sound scene");
        }
        assert!(TRUSTED.settings.falls_back(), "by its method");
    }

    #[test]
    fn every_effort_is_taken_by_every_scene() {
        let plain = built_in("pile").expect("a scene").simulation().expect("a sound scene");
        assert_eq!(FAST.among(&plain.snapshot().surroundings), FAST.settings);
        let mut scenes: Vec<_> = crate::scene::SCENES
            .iter()
            .map(|scene| built_in(scene.name).expect("a scene"))
            .collect();
        let mut unforced = built_in("shear").expect("a scene");
        let drives = unforced.motions.iter_mut().filter_map(|motion| motion.drive.as_mut());
        let forces = drives.map(|drive| (drive.force, drive.pressure) = (Some(0.0), None));
        assert!(forces.count() > 0, "a wall that nothing but grains pushes is driven, too");
        scenes.push(unforced);
        for scene in scenes {
            let name = &scene.name;
            let mut run = scene.simulation().expect("a sound scene");
            let uses_method = run.settings().stepper.uses_method();
            for effort in EFFORTS.iter().filter(|_| uses_method) {
                let solver = effort.among(&run.snapshot().surroundings);
                run.set_solver(solver).unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(solver.max_sweeps, effort.settings.max_sweeps, "{name}");
            }
        }
    }
}
