//! Presets of the solver that the window offers, and hints on experiments with the Bond number and the time step Δt.

use crate::sim::{Settings, Stepper, Surroundings};
use crate::solver::{Method, SolverSettings};
use crate::world::{Parameters, Periodic};

/// A preset of the solver's settings with its name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    pub name: &'static str,
    /// Description of the preset, with its computing time and its accuracy.
    pub hint: &'static str,
    pub settings: SolverSettings,
}

impl Budget {
    /// Returns the solver settings of the preset for a scene. If the scene has sheared periodic borders, walls driven
    /// by a force, rolling friction or materials that the preset's solver does not support, the solver is `nsgs`
    /// (Gauss-Seidel) instead.
    pub(super) fn among(
        &self,
        surroundings: &Surroundings,
        parameters: &Parameters,
    ) -> SolverSettings {
        let info = self.settings.method.info();
        let shears = surroundings.periodic.is_some_and(Periodic::is_sheared);
        let is_driven = surroundings.moving.iter().any(|motion| motion.is_driven);
        let rolls = parameters.rolling_friction > 0.0;
        let may_have_pairs = !surroundings.materials.is_empty();
        if (shears && !info.takes_shear)
            || (is_driven && !info.takes_drives)
            || (rolls && !info.takes_rolling)
            || (may_have_pairs && !info.takes_pairs)
        {
            return self.settings.by(Method::Nsgs);
        }
        self.settings
    }
}

/// Preset of a fast solver: at most 40 parallel Gauss-Seidel sweeps per step, even if the step is then unsolved.
pub(super) const FAST: Budget = Budget {
    name: "Fast",
    hint: "40 sweeps per step, solved or not; the program uses all cores. Without cohesion, large piles slump \
           nearly as in solved steps. With cohesion, piles can slump although they would not in solved steps, and \
           small piles are off by a tenth.",
    settings: SolverSettings::to_residual(Method::NsgsParallel, 1e-6, 40),
};

/// Preset of the solver that Abramian & Staron (2020) use: Gauss-Seidel until a sweep changes the impulses by less than
/// 1e-7 of their norm.
pub(super) const PAPER: Budget = Budget {
    name: "Paper",
    hint: "The paper's solver: Gauss-Seidel to a relative change of 1e-7. With a touch tolerance of 0 it gives the \
           figures of slump --headless to the last digit. It does not solve some steps.",
    settings: SolverSettings::PAPER,
};

/// Preset of the default solver: Newton's method, which tries to solve each step under Coulomb friction.
pub(super) const SOLVED: Budget = Budget {
    name: "Solved",
    hint: "Newton's method tries to solve each step under Coulomb friction. In a large flowing pile it \
           makes 400 over-relaxed sweeps per step instead, and the window shows the remaining error.",
    settings: SolverSettings::DEFAULT,
};

/// All presets, in the order of their buttons.
pub(super) const BUDGETS: [Budget; 3] = [FAST, SOLVED, PAPER];

/// Largest Bond number at which the window says that a longer time step makes a pile more stable (`docs/paper.md`, Fig.
/// 5a).
const WEAK: f64 = 50.0;

/// Longest fall of a grain from rest in one step that causes no warning, in mean diameters. With a smaller value, the
/// upper end of the Δt slider would cause a warning.
const LONGEST_FALL: f64 = 0.2;

/// Returns a warning if a grain at rest falls by more than [`LONGEST_FALL`] mean diameters in one of the `substeps` of
/// a step.
pub(super) fn too_long(
    settings: &Settings,
    surroundings: &Surroundings,
    substeps: u32,
) -> Option<String> {
    let step_secs = settings.parameters.time_step_secs / f64::from(substeps.max(1));
    let fall = surroundings.gravity_magnitude * step_secs.powi(2) / surroundings.mean_diameter;
    let digits = usize::from(fall < 10.0);
    (fall > LONGEST_FALL).then(|| {
        format!(
            "Δt is too long: in one step a grain at rest falls by {fall:.digits$} diameters, and contacts are found too \
             late. Choose a smaller Δt."
        )
    })
}

/// Time step Δt (s) at and above which the window suggests a shorter time step. Below it, the window suggests a longer
/// time step. It is the longest time step that Abramian & Staron (2020) compare.
const LONG_STEP_SECS: f64 = 5e-3;
/// Touch tolerance (largest gap at which a contact pulls), in mean diameters, above which no hint on Δt is given,
/// because Δt then changes cohesion less (`docs/theory.md`).
const LARGE_TOLERANCE: f64 = 1e-4;

/// Returns a hint that asks the user to move the slider of Δt and states the effect on weakly cohesive grains under the
/// default law; `None` for other grains and laws.
pub(super) fn what_to_try(settings: &Settings) -> Option<&'static str> {
    let Parameters { bond, time_step_secs, touch_tolerance, .. } = settings.parameters;
    let is_weak = bond > 0.0 && bond <= WEAK;
    let is_known =
        settings.stepper == Stepper::Moreau && is_weak && touch_tolerance <= LARGE_TOLERANCE;
    is_known.then_some(if time_step_secs >= LONG_STEP_SECS {
        "A smaller Δt makes these grains stick less: drag it and see."
    } else {
        "A larger Δt makes these grains stick better: drag it and see."
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;
    use crate::world::{Material, MaterialPair};

    fn surroundings(name: &str) -> std::sync::Arc<Surroundings> {
        let scene = built_in(name).expect("a scene").simulation().expect("a sound scene");
        scene.snapshot().surroundings
    }

    #[test]
    fn every_effort_is_taken_by_every_scene() {
        assert_eq!(FAST.among(&surroundings("pile"), &Parameters::DEFAULT), FAST.settings);
        let scenes = crate::scene::SCENES.iter();
        let mut scenes: Vec<_> =
            scenes.map(|scene| built_in(scene.name).expect("a scene")).collect();
        let mut unforced = built_in("shear").expect("a scene");
        let drives = unforced.motions.iter_mut().filter_map(|motion| motion.drive.as_mut());
        let forces = drives.map(|drive| (drive.force, drive.pressure) = (Some(0.0), None));
        assert!(forces.count() > 0, "a wall that nothing but grains pushes is driven, too");
        scenes.push(unforced);
        let mut rolling = built_in("pile").expect("a scene");
        rolling.parameters.rolling_friction = 0.2;
        scenes.push(rolling);
        let mut paired = built_in("pile").expect("a scene");
        let glass = || "glass".to_owned();
        paired.materials.push(Material { name: glass(), ..Material::default() });
        paired.pairs.push(MaterialPair {
            between: [glass(), glass()],
            friction: Some(0.3),
            ..MaterialPair::default()
        });
        scenes.push(paired);
        for scene in scenes {
            let name = &scene.name;
            let mut run = scene.simulation().expect("a sound scene");
            let uses_method = run.settings().stepper.uses_method();
            let surroundings = run.snapshot().surroundings;
            for effort in BUDGETS.iter().filter(|_| uses_method) {
                let solver = effort.among(&surroundings, &scene.parameters);
                run.set_solver(solver).unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(solver.max_sweeps, effort.settings.max_sweeps, "{name}");
            }
        }
    }

    #[test]
    fn no_scene_begins_with_a_time_step_that_is_too_long() {
        for info in crate::scene::SCENES {
            let run = built_in(info.name).expect("a scene").simulation().expect("a sound scene");
            let surroundings = run.snapshot().surroundings;
            let warning = too_long(run.settings(), &surroundings, run.substeps());
            assert_eq!(warning, None, "{}", info.name);
        }
        let longest = |secs| too_long(&Settings::default().over(secs), &surroundings("pile"), 1);
        assert_eq!(longest(1e-2), None, "the slider's end");
        let warning = longest(1.0).expect("a warning");
        assert!(warning.contains("falls by 19"), "{warning}");
    }

    #[test]
    fn the_hint_is_of_weakly_cohesive_grains_under_the_default_law() {
        let weak = Settings::default().with_bond(20.0);
        let said = |settings: Settings| what_to_try(&settings).unwrap_or_default();
        assert!(said(weak).contains("larger Δt makes these grains stick"));
        assert!(said(weak.over(LONG_STEP_SECS)).contains("smaller Δt"));
        let mut tolerant = weak;
        tolerant.parameters.touch_tolerance = 0.01;
        let range = Settings { stepper: Stepper::Range, ..weak };
        for other in [weak.with_bond(0.0), weak.with_bond(100.0), tolerant, range] {
            assert_eq!(what_to_try(&other), None);
        }
    }
}
