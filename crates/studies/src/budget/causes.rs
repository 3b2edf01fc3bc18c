//! Lists the possible causes of an error of a result, such as the time step, the solver or the contact law, as far as
//! they can matter in a scene. An error budget tests each cause by one change of the scene.

use crate::chart::{PALETTE, Rgb};
use crate::fracture_work::{fracture_work, with_fracture_work};
use crate::scene::{Deposition, NewPile, Scene};
use crate::sim::{Settings, Stepper};
use crate::solver::{FrictionModel, Method, SolverSettings};
use crate::world::{FrictionCone, MaterialPair, RESTITUTION_THRESHOLD};

/// Group of causes in an error budget: grains, contact law, or numerical method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Share {
    /// Causes in the grains: their number, and their packing in the initial state.
    Grains,
    /// Causes in the laws that contacts obey, such as the contact law and the friction model.
    Law,
    /// Causes in the numerical method: the time step, unsolved steps, and the initial guesses of the solver.
    Method,
}

impl Share {
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Grains => "grains",
            Self::Law => "law",
            Self::Method => "method",
        }
    }

    /// Returns the colour of this group of causes in pictures.
    pub(crate) fn colour(self) -> Rgb {
        PALETTE[match self {
            Self::Grains => 3,
            Self::Law => 2,
            Self::Method => 1,
        }]
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    TimeStep,
    Unsolved,
    Start,
    ContactLaw,
    Cone,
    TouchTolerance,
    FrictionModel,
    RestitutionThreshold,
    Packing,
    NumberOfGrains,
}

impl Cause {
    /// Returns three properties of the cause: its group, its name, and the phrase with which reports name the change
    /// that tests the cause. In the phrase, as in "the {} in place of this one", `{}` stands for the new
    /// value.
    const fn row(self) -> (Share, &'static str, &'static str) {
        match self {
            Self::TimeStep => (Share::Method, "time step", "the {}"),
            Self::Unsolved => (Share::Method, "unsolved steps", "not solving every step"),
            Self::Start => (Share::Method, "initial guess", "the change to {}"),
            Self::ContactLaw => (Share::Law, "contact law", "the {} in place of this one"),
            Self::Cone => (Share::Law, "cone of friction", "the {}"),
            Self::TouchTolerance => (Share::Law, "touch tolerance", "the {}"),
            Self::FrictionModel => (Share::Law, "friction model", "{}"),
            Self::RestitutionThreshold => (Share::Law, "restitution threshold", "{}"),
            Self::Packing => (Share::Grains, "packing", "a pile {}"),
            Self::NumberOfGrains => (Share::Grains, "number of grains", "a pile of {}"),
        }
    }

    pub(crate) const fn share(self) -> Share {
        self.row().0
    }

    pub(crate) const fn words(self) -> &'static str {
        self.row().1
    }

    pub(crate) const fn subject(self) -> &'static str {
        self.row().2
    }
}

/// A variant of a scene: the scene with one change, which tests one possible cause of an error.
#[derive(Clone, Debug)]
pub(crate) struct Variant {
    pub cause: Cause,
    /// Description of the change, for example the new time step.
    pub label: String,
    pub settings: Settings,
    /// Pile that replaces the grains of the scene; `None` if the grains are not changed.
    pub pile: Option<NewPile>,
    /// Expected computing time of a run of this variant, divided by the time of a run of the unchanged scene. The
    /// expectation is used until a run of the variant has been timed.
    pub cost: f64,
}

/// Divisors of the scene's time step Δt: an error budget also runs the scene with Δt/2, Δt/4 and Δt/8.
pub(crate) const DIVISORS: [u32; 3] = [2, 4, 8];
/// Factor by which an error budget multiplies the solver's default tolerance of the velocity error, 1e-4 √(g d), with
/// gravity g and mean diameter d. The effect of this change on a result is the effect of inaccurate solutions of steps.
/// A factor of 1e-3 would be too small, because rounding errors prevent the solution of some steps to 1e-7 √(g d).
const TIGHTER: f64 = 1e-2;
/// Touch tolerance (the gap up to which contacts pull) that an error budget tries instead of the scene's own, in mean
/// diameters. It is larger than the gaps that remain in closed contacts after a step, and smaller than the roughness of
/// grains.
const TOUCH_TOLERANCE: f64 = 1e-3;

/// Returns all variants of a scene (the scene with one change) that can be simulated and whose change can have an
/// effect. `pile` describes the grains of the scene, if they are generated. `resizes` is true if the number of grains
/// can be changed.
pub(crate) fn variants(scene: &Scene, pile: Option<&NewPile>, resizes: bool) -> Vec<Variant> {
    let base = scene.settings();
    let (parameters, solver) = (base.parameters, base.solver);
    let mut all = Vec::new();
    let mut add = |cause, label: &str, cost, settings: Settings| {
        let mut changed = scene.clone();
        changed.set_settings(settings);
        // If the scene does not support a change, there is no variant with this change.
        if settings != base && changed.simulation().is_ok() {
            all.push(Variant { cause, label: label.to_owned(), settings, pile: None, cost });
        }
    };
    let by = |change: &dyn Fn(&mut Settings)| {
        let mut settings = base;
        change(&mut settings);
        settings
    };
    if base.stepper.uses_method() {
        let is_driven = scene.motions.iter().any(|motion| motion.drive.is_some());
        let settings = tighter(base, is_driven);
        let label = format!("steps solved by {}", settings.solver.method);
        add(Cause::Unsolved, &label, 4.0, settings);
        // A step of a flowing pile has several solutions. The initial guess decides which solution the solver finds.
        let label = if solver.warm_start { "cold starts" } else { "warm starts" };
        add(Cause::Start, label, 4.0, by(&|it| it.solver.warm_start ^= true));
    }
    for divisor in DIVISORS {
        let step = parameters.time_step_secs / f64::from(divisor);
        let label = format!("Δt {} s", short(step));
        add(Cause::TimeStep, &label, f64::from(divisor), base.over(step));
    }
    for stepper in [Stepper::Moreau, Stepper::Range, Stepper::Dem] {
        if stepper != base.stepper {
            let label = format!("law {stepper}");
            add(Cause::ContactLaw, &label, 4.0, at_equal_work(scene, stepper));
        }
    }
    let is_any = |scene_wide: f64, of: fn(&MaterialPair) -> Option<f64>| {
        scene_wide > 0.0 || scene.pairs.iter().filter_map(of).any(|value| value > 0.0)
    };
    let rubs = scene.physics.friction && is_any(parameters.friction, |pair| pair.friction);
    let coheres =
        scene.physics.cohesion && is_any(parameters.bond, |pair| pair.cohesion_force.or(pair.bond));
    if rubs && coheres && base.stepper.reads("cone") {
        let cone = match parameters.cone {
            FrictionCone::Shifted => FrictionCone::Compressive,
            FrictionCone::Compressive => FrictionCone::Shifted,
        };
        add(Cause::Cone, &format!("cone {cone}"), 1.0, by(&|it| it.parameters.cone = cone));
    }
    if coheres && base.stepper.reads("touch-tolerance") {
        let is_large = parameters.touch_tolerance >= TOUCH_TOLERANCE;
        let tolerance = if is_large { 0.0 } else { TOUCH_TOLERANCE };
        let label = format!("touch tolerance {} d", short(tolerance));
        let settings = by(&|it| it.parameters.touch_tolerance = tolerance);
        add(Cause::TouchTolerance, &label, 1.0, settings);
    }
    if rubs && base.stepper.reads("friction-model") {
        let (model, label) = match solver.friction_model {
            FrictionModel::Coulomb => (FrictionModel::Tresca, "bounded friction"),
            _ => (FrictionModel::Coulomb, "Coulomb friction"),
        };
        let settings =
            by(&|it| (it.solver.method, it.solver.friction_model) = (Method::Auto, model));
        add(Cause::FrictionModel, label, 2.0, settings);
    }
    let bounces = is_any(parameters.restitution, |pair| pair.restitution);
    if bounces && base.stepper.reads("restitution-threshold") {
        let (threshold, label) = match parameters.restitution_threshold > 0.0 {
            true => (0.0, "restitution at every speed".to_owned()),
            false => (
                RESTITUTION_THRESHOLD,
                format!("no restitution below {RESTITUTION_THRESHOLD} g·Δt"),
            ),
        };
        let settings = by(&|it| it.parameters.restitution_threshold = threshold);
        add(Cause::RestitutionThreshold, &label, 1.0, settings);
    }
    let Some(pile) = pile else { return all };
    let mut of_pile = |cause, label: String, pile: NewPile, cost| {
        all.push(Variant { cause, label, settings: base, pile: Some(pile), cost });
    };
    let other = match pile.deposition {
        Deposition::Rain => Deposition::DropAndRoll,
        Deposition::DropAndRoll => Deposition::Rain,
    };
    let packed = NewPile { deposition: other, ..pile.clone() };
    of_pile(Cause::Packing, format!("put down by {other}"), packed, 1.0);
    if resizes {
        let larger = NewPile {
            grains: 2 * pile.grains,
            // The width grows with the square root of the number of grains, so that the larger pile has the same shape.
            box_width_in_diameters: 2f64.sqrt() * pile.box_width_in_diameters,
            ..pile.clone()
        };
        of_pile(Cause::NumberOfGrains, format!("{} grains", larger.grains), larger, 3.0);
    }
    all
}

/// Returns the settings with another solver, which solves steps so accurately that the errors of solved steps are
/// negligible. `is_driven` is true if a force drives a wall, which not every solver supports.
fn tighter(mut settings: Settings, is_driven: bool) -> Settings {
    let solver = settings.solver;
    let method = match solver.friction_model {
        // Newton's method does not support walls that a force drives.
        FrictionModel::Coulomb if is_driven => Method::Nncg,
        FrictionModel::Coulomb => Method::Newton,
        _ => Method::InteriorPoint,
    };
    settings.solver = SolverSettings {
        method,
        friction_model: solver.friction_model,
        model_solves: solver.model_solves,
        tolerance: TIGHTER * SolverSettings::DEFAULT.tolerance,
        ..SolverSettings::DEFAULT
    };
    settings
}

/// Returns settings with the contact law of another `stepper`, chosen so that breaking a bond takes the same work as
/// under the scene's own law. If the scene's own law does not define this work, breaking takes the same work as under
/// `range` with the scene's debonding distance.
fn at_equal_work(scene: &Scene, stepper: Stepper) -> Settings {
    let settings = Settings { stepper, ..scene.settings() }.with_only_what_is_taken();
    if !(scene.physics.cohesion && settings.parameters.bond > 0.0) {
        return settings;
    }
    let of_range = || {
        let range = Settings { stepper: Stepper::Range, ..scene.settings() };
        fracture_work(scene, range.with_only_what_is_taken())
    };
    let joules = fracture_work(scene, scene.settings()).or_else(of_range);
    joules.map_or(settings, |joules| with_fracture_work(scene, settings, joules))
}

/// Formats a number with at most four significant digits.
pub(crate) fn short(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    if rounded != 0.0 && !(1e-2..1e4).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;
    use crate::world::Material;

    fn causes(scene: &Scene, pile: Option<&NewPile>) -> Vec<Cause> {
        let mut causes: Vec<Cause> =
            variants(scene, pile, true).iter().map(|variant| variant.cause).collect();
        causes.dedup();
        causes
    }

    #[test]
    fn only_what_can_matter_is_tried() {
        let mut pile = built_in("pile").unwrap();
        pile.parameters.bond = 20.0;
        let new_pile = NewPile::default();
        assert_eq!(
            causes(&pile, Some(&new_pile)),
            [
                Cause::Unsolved,
                Cause::Start,
                Cause::TimeStep,
                Cause::ContactLaw,
                Cause::Cone,
                Cause::TouchTolerance,
                Cause::FrictionModel,
                Cause::RestitutionThreshold,
                Cause::Packing,
                Cause::NumberOfGrains
            ]
        );
        pile.parameters.bond = 0.0;
        let of_dry = causes(&pile, None);
        assert!(!of_dry.contains(&Cause::Cone) && !of_dry.contains(&Cause::TouchTolerance));
        pile.parameters.friction = 0.0;
        pile.parameters.restitution = 0.0;
        let left = [Cause::Unsolved, Cause::Start, Cause::TimeStep, Cause::ContactLaw];
        assert_eq!(causes(&pile, None), left);
        // The same coefficients of a pair of materials count as those of the scene. Only `moreau` supports pairs.
        pile.materials = vec![Material { name: "glass".to_owned(), ..Material::default() }];
        pile.pairs = vec![MaterialPair {
            between: ["glass", "glass"].map(str::to_owned),
            friction: Some(0.5),
            restitution: Some(0.1),
            cohesion_force: Some(1e-4),
            ..MaterialPair::default()
        }];
        let of_pairs = causes(&pile, None);
        let counted = [Cause::Cone, Cause::TouchTolerance, Cause::RestitutionThreshold];
        assert!(counted.iter().all(|cause| of_pairs.contains(cause)), "{of_pairs:?}");
        let drum = built_in("drum").unwrap();
        assert!(!causes(&drum, None).contains(&Cause::NumberOfGrains));
        // Few steppers support walls that a force drives, so the stepper `avbd` must not be a variant of this scene.
        let biaxial = variants(&built_in("biaxial").unwrap(), None, false);
        assert!(biaxial.iter().all(|variant| variant.label != "law avbd"));
        for scene in crate::scene::SCENES {
            for variant in variants(&(scene.make)().unwrap(), None, false) {
                let mut changed = (scene.make)().unwrap();
                changed.set_settings(variant.settings);
                assert!(changed.simulation().is_ok(), "{}: {}", scene.name, variant.label);
            }
        }
    }

    #[test]
    fn what_steps_leave_unsolved_is_held_against_better_solved_steps_of_the_same_law() {
        let bounded = SolverSettings::BOUNDED;
        for (solver, label) in [
            (SolverSettings::default(), "steps solved by newton"),
            (SolverSettings::PAPER, "steps solved by newton"),
            (bounded, "steps solved by interior-point"),
        ] {
            let mut pile = built_in("pile").unwrap();
            pile.solver = solver;
            let all = variants(&pile, None, false);
            let better = all.iter().find(|variant| variant.cause == Cause::Unsolved).unwrap();
            assert_eq!(better.label, label);
            let better = better.settings.solver;
            assert_eq!(better.friction_model, solver.friction_model);
            assert!(better.tolerance < SolverSettings::DEFAULT.tolerance);
        }
    }

    #[test]
    fn other_laws_take_as_much_work_to_break_a_bond() {
        let mut scene = built_in("pile").unwrap();
        scene.parameters.bond = 20.0;
        scene.parameters.debonding_distance = 3e-3;
        let work = |settings| fracture_work(&scene, settings).unwrap();
        let [range, dem] = [Stepper::Range, Stepper::Dem].map(|law| at_equal_work(&scene, law));
        assert_eq!(range.parameters.debonding_distance, 3e-3);
        let [of_range, of_dem] = [range, dem].map(work);
        assert!((of_dem / of_range - 1.0).abs() < 1e-9, "{of_dem} {of_range}");
        let mut of_dem = scene.clone();
        of_dem.set_settings(dem);
        of_dem.parameters.debonding_distance = 0.05;
        let back = at_equal_work(&of_dem, Stepper::Range);
        assert!((back.parameters.debonding_distance / 3e-3 - 1.0).abs() < 1e-9);
    }
}
