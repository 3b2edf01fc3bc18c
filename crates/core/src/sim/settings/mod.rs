//! All settings of a simulation that can change between two steps, and their checks. Every simulation runs these
//! checks, so they cannot be bypassed.

mod fracture_work;
mod remedy;
mod spring_dashpot;
mod stepper;

pub use fracture_work::FractureWork;
pub use remedy::{REMEDIES, Remedies, Remedy, RemedyChanges};
pub use spring_dashpot::SpringDashpot;
pub(super) use spring_dashpot::stable_substeps;
pub use stepper::{Stepper, StepperInfo};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, check};
use crate::setting::{About, Control, Group, Needs, Settable, Value};
use crate::solver::{FrictionModel, METHODS, MethodInfo, SolverSettings};
use crate::world::{
    FrictionCone, Gravity, MaterialPair, Motion, Parameters, Periodic, Physics, World,
};

/// Settings of a simulation: the stepper, the parameters of the contact laws, the solver and the remedies (optional
/// corrections of a step, such as pushing overlapping grains apart). A simulation checks them with
/// [`Settings::validate`] before it uses them.
///
/// ```
/// use slump_core::sim::{Settings, Stepper};
/// use slump_core::world::Parameters;
///
/// let parameters = Parameters { bond: 20.0, friction: 0.5, ..Parameters::default() };
/// let mut simulation = slump_core::scene::built_in("column")?.simulation()?;
/// simulation.change(Settings { stepper: Stepper::Range, parameters, ..Settings::default() })?;
/// simulation.take_steps(3)?;
///
/// let never = Parameters { time_step_secs: -1.0, ..parameters };
/// let refused = simulation.set_parameters(never);
/// assert!(refused.is_err_and(|error| error.to_string().contains("dt")));
/// # Ok::<(), slump_core::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Stepper: the rule that advances the grains by the time step Δt, with its contact law.
    #[serde(default)]
    pub stepper: Stepper,
    /// Parameters of the contact laws, and the time step Δt (s).
    pub parameters: Parameters,
    /// Settings of the solver, which computes the contact impulses of each step.
    #[serde(default)]
    pub solver: SolverSettings,
    /// Remedies: optional corrections for known failures of a stepper. The scheme of Abramian & Staron (2020) has no
    /// remedies.
    #[serde(default, skip_serializing_if = "Remedies::is_none")]
    pub remedies: Remedies,
}

impl Settings {
    /// True if the solver uses a friction model other than Coulomb friction.
    pub(crate) fn solves_models(&self) -> bool {
        self.stepper.uses_method() && self.solver.solves_models()
    }

    /// Description of the setting `stepper`.
    pub const STEPPER: About = About {
        name: "stepper",
        value_name: "NAME",
        help: "Stepper: the rule that advances the grains by Δt, with its contact law; moreau is the paper's (`slump list \
            steppers`)",
        heading: "Physics",
        kind: Stepper::KIND,
        needs: Needs::Nothing,
        control: Some(Control {
            label: "Stepper",
            symbol: "stepper",
            hint: "The rule that advances the grains by Δt, with its contact law.",
            ..Control::PLAIN
        }),
    };

    /// Returns the descriptions of all settings.
    pub fn about() -> impl Iterator<Item = &'static About> {
        const FIRST: &[About] = &[Settings::STEPPER];
        let groups = [FIRST, Parameters::ABOUT, SolverSettings::ABOUT, Remedies::ABOUT];
        groups.into_iter().flatten()
    }

    /// Returns the value of the setting `name`, or `None` if no setting has this name.
    pub fn get(&self, name: &str) -> Option<Value> {
        let Self { stepper, parameters, solver, remedies } = self;
        if name == Self::STEPPER.name {
            return Some(stepper.value());
        }
        parameters.get(name).or_else(|| solver.get(name)).or_else(|| remedies.get(name))
    }

    /// Sets the setting `name` to a value. Returns false, and changes nothing, if no setting has this name or if
    /// `value` has the wrong type, such as a word instead of a number.
    pub fn set(&mut self, name: &str, value: Value) -> bool {
        let Self { stepper, parameters, solver, remedies } = self;
        if name == Self::STEPPER.name {
            let wanted = Stepper::of(value);
            *stepper = wanted.unwrap_or(*stepper);
            return wanted.is_some();
        }
        parameters.set(name, value) || solver.set(name, value) || remedies.set(name, value)
    }

    /// Returns these settings with the Bond number `bond`.
    pub fn with_bond(mut self, bond: f64) -> Self {
        self.parameters.bond = bond;
        self
    }

    /// Returns these settings with the time step `time_step_secs`, s.
    pub fn over(self, time_step_secs: f64) -> Self {
        Self { parameters: self.parameters.over(time_step_secs), ..self }
    }
}

fn names_of<'a>(steppers: impl Iterator<Item = &'a Stepper>) -> Vec<&'static str> {
    steppers.map(|stepper| stepper.name()).collect()
}

impl Settings {
    /// Checks that every number is in its range and that the stepper supports all settings.
    ///
    /// # Errors
    /// The error names the first setting that is outside its range or that the stepper does not support.
    pub fn validate(&self) -> Result<()> {
        self.parameters.validate_each()?;
        (self.stepper.info().check)(&self.parameters)?;
        self.solver.validate()?;
        self.check_friction_model()?;
        self.remedies.validate_each()?;
        self.check_rolling(self.parameters.rolling_friction > 0.0)?;
        for remedy in &REMEDIES {
            if remedy.is_on(&self.remedies) && !remedy.taken_by.contains(&self.stepper) {
                let takers = names_of(remedy.taken_by.iter()).join(" and ");
                let stepper = self.stepper;
                let allowed = format!("left out where stepper is {stepper}: it goes with {takers}");
                return Err(Error::value(remedy.name, "given", allowed));
            }
        }
        Ok(())
    }

    /// Checks that the stepper and the friction cone support the friction model of the settings.
    fn check_friction_model(&self) -> Result<()> {
        let (model, cone) = (self.solver.friction_model, self.parameters.cone);
        if model != FrictionModel::Coulomb && !self.stepper.reads("friction-model") {
            let readers = Stepper::ALL.iter().filter(|stepper| stepper.reads("friction-model"));
            let (stepper, readers) = (self.stepper, names_of(readers).join(" and "));
            let allowed =
                format!("coulomb where stepper is {stepper}: other models go with {readers}");
            return Err(Error::value("friction-model", model, allowed));
        }
        if model.is_on_cone() && cone != FrictionCone::Shifted {
            let allowed = format!(
                "shifted where friction-model is {model}: the compressive cone is not convex where contacts \
                 cohere; tresca takes both"
            );
            return Err(Error::value("cone", cone, allowed));
        }
        Ok(())
    }

    /// Checks that the stepper and the solver support a part of a scene. `said` names the part in the error, and the two
    /// functions tell which steppers and solvers support it.
    fn check_support(
        &self,
        said: &str,
        by_stepper: fn(&StepperInfo) -> bool,
        by_method: fn(&MethodInfo) -> bool,
    ) -> Result<()> {
        let (stepper, method) = (self.stepper, self.solver.method);
        let allowed = |takers: Vec<&str>| format!("{} {said}", takers.join(" or "));
        if !by_stepper(stepper.info()) {
            let takers = Stepper::ALL.iter().filter(|stepper| by_stepper(stepper.info()));
            return Err(Error::value("stepper", stepper, allowed(names_of(takers))));
        }
        if stepper.uses_method() && !by_method(method.info()) {
            let takers = METHODS.iter().filter(|info| by_method(info)).map(|info| info.name);
            return Err(Error::value("solver", method, allowed(takers.collect())));
        }
        Ok(())
    }

    /// Checks that neither a convex friction model nor the remedy `sequential-impacts` is chosen, for a part of a scene
    /// that both do not support. `said` names the part in the error.
    fn check_neither_convex_nor_sequential(&self, said: &str) -> Result<()> {
        let (model, is_sequential) = (self.solver.friction_model, self.remedies.sequential_impacts);
        check(!model.is_on_cone(), "friction-model", model, format!("coulomb or tresca {said}"))?;
        check(!is_sequential, "sequential-impacts", "given", format!("left out {said}"))
    }

    /// Checks that the solver and the friction model support rolling friction. Checks nothing if `is_given` is false,
    /// that is if no contact has rolling friction.
    fn check_rolling(&self, is_given: bool) -> Result<()> {
        if !is_given {
            return Ok(());
        }
        let (said, model) = ("where rolling-friction is above 0", self.solver.friction_model);
        self.check_support(said, |_| true, |info| info.takes_rolling)?;
        let is_coulomb = model == FrictionModel::Coulomb;
        check(is_coulomb, "friction-model", model, format!("coulomb {said}"))
    }

    /// Checks that the settings support the features of a world: its walls driven by a force, gravity, periodic
    /// borders, pairs of materials and rolling friction.
    pub(crate) fn check_in(&self, world: &World, physics: Physics) -> Result<()> {
        self.check_drives(&world.motions)?;
        self.check_tilt(&world.gravity, physics)?;
        self.check_shear(world.periodic)?;
        self.check_pairs(&world.pairs)?;
        self.check_rolling(world.pairs.iter().any(|pair| pair.rolling_friction > Some(0.0)))?;
        let rolling = self.parameters.rolling_friction;
        let allowed = "0 where physics.rotation is false";
        check(rolling == 0.0 || physics.rotation, "rolling-friction", rolling, allowed)?;
        (self.stepper.info().check_in)(world, physics, &self.parameters)
    }

    /// Checks that gravity can be tilted if the parameter `tilt` is not 0: gravity must be uniform, and the scene must
    /// have two axes.
    pub(crate) fn check_tilt(&self, gravity: &Gravity, physics: Physics) -> Result<()> {
        let refuse = |of: &str| {
            let allowed = format!("left out or 0 where {of}");
            Err(Error::value("tilt", self.parameters.tilt, allowed))
        };
        match gravity {
            _ if self.parameters.tilt == 0.0 => Ok(()),
            Gravity::Attraction { .. } => refuse("gravity is not uniform"),
            Gravity::Uniform { .. } if physics.axes == 1 => refuse("physics.axes is 1"),
            Gravity::Uniform { .. } => Ok(()),
        }
    }

    /// Checks that the stepper, the solver and the remedies (optional corrections of a step) support walls driven by a
    /// force, if `motions` contain one.
    pub(crate) fn check_drives(&self, motions: &[Motion]) -> Result<()> {
        if motions.iter().all(|motion| motion.drive.is_none()) {
            return Ok(());
        }
        let said = "where a motion has a drive";
        self.check_support(said, |info| info.takes_drives, |info| info.takes_drives)?;
        self.check_neither_convex_nor_sequential(said)
    }

    /// Checks that the solver supports sheared periodic borders, if the borders are sheared.
    pub(crate) fn check_shear(&self, periodic: Option<Periodic>) -> Result<()> {
        if !periodic.is_some_and(Periodic::is_sheared) {
            return Ok(());
        }
        self.check_support("where periodic borders shear", |_| true, |info| info.takes_shear)
    }

    /// Checks that the stepper, the solver and the remedies (optional corrections of a step) support separate contact
    /// laws for pairs of materials, if `pairs` is not empty.
    fn check_pairs(&self, pairs: &[MaterialPair]) -> Result<()> {
        if pairs.is_empty() {
            return Ok(());
        }
        let said = "where the scene has pairs of materials";
        self.check_support(said, |info| info.takes_pairs, |info| info.takes_pairs)?;
        self.check_neither_convex_nor_sequential(said)
    }

    /// Returns a copy of these settings without unsupported parts. Remedies (optional corrections of a step) that the
    /// stepper does not support are switched off. If the stepper or the solver does not support the friction model,
    /// Coulomb friction replaces it.
    pub fn with_only_what_is_taken(mut self) -> Self {
        self.solver = self.solver.by(self.solver.method);
        if !self.stepper.reads("friction-model") {
            self.solver = self.solver.without_model();
        }
        for remedy in REMEDIES.iter().filter(|remedy| !remedy.taken_by.contains(&self.stepper)) {
            remedy.leave_out(&mut self.remedies);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steppers_read_settings_that_exist_and_every_setting_is_read_by_one() {
        let remedies = |name: &str| REMEDIES.iter().any(|row| row.name == name);
        let names: Vec<&str> = Settings::about().map(|about| about.name).collect();
        for stepper in Stepper::ALL {
            for name in stepper.info().settings.split(' ') {
                assert!(names.contains(&name), "{stepper} reads {name}");
            }
        }
        for name in names {
            let read = Stepper::ALL.iter().any(|stepper| stepper.reads(name));
            assert!(read || remedies(name) || name == "stepper", "{name}");
        }
    }
}
