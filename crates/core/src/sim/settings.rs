//! All that a simulation can be told between two steps.

use serde::{Deserialize, Serialize};

use super::remedies::declared::Remedies;
use super::steppers::stepper::Stepper;
use crate::setting::{About, Control, Group, Needs, Settable, Value};
use crate::solver::SolverSettings;
use crate::world::Parameters;

/// How a simulation steps. Whether its parts go together is checked where a simulation takes them on
/// ([`Settings::validate`]).
///
/// ```
/// use slump::sim::{Settings, Stepper};
/// use slump::world::Parameters;
///
/// let parameters = Parameters { bond: 20.0, friction: 0.5, ..Parameters::default() };
/// let mut simulation = slump::scene::built_in("column")?.simulation()?;
/// simulation.change(Settings { stepper: Stepper::Range, parameters, ..Settings::default() })?;
/// simulation.take_steps(3)?;
///
/// let never = Parameters { time_step_secs: -1.0, ..parameters };
/// let refused = simulation.set_parameters(never);
/// assert!(refused.is_err_and(|error| error.to_string().contains("dt")));
/// # Ok::<(), slump::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// The way to step, with its contact law.
    #[serde(default)]
    pub stepper: Stepper,
    /// Numbers of the contact laws, and Δt.
    pub parameters: Parameters,
    /// How well each step is solved.
    #[serde(default)]
    pub solver: SolverSettings,
    /// Remedies for known failures; none in the paper's scheme.
    #[serde(default, skip_serializing_if = "Remedies::is_none")]
    pub remedies: Remedies,
}

impl Settings {
    /// Whether steps may be solved under another model of friction than Coulomb's law.
    pub(crate) fn may_solve_models(&self) -> bool {
        self.stepper.uses_method() && self.solver.may_solve_models()
    }

    /// The setting `stepper` itself.
    pub const STEPPER: About = About {
        name: "stepper",
        value_name: "NAME",
        help: "The way to step, with its contact law: moreau is the paper's; others in `slump list`",
        heading: "Physics",
        kind: Stepper::KIND,
        needs: Needs::Nothing,
        control: Some(Control {
            label: "Stepper",
            symbol: "stepper",
            hint: "The way to step, with its contact law.",
            ..Control::PLAIN
        }),
    };

    /// All settings.
    pub fn about() -> impl Iterator<Item = &'static About> {
        const FIRST: &[About] = &[Settings::STEPPER];
        let groups = [FIRST, Parameters::ABOUT, SolverSettings::ABOUT, Remedies::ABOUT];
        groups.into_iter().flatten()
    }

    /// The value of the setting of that name.
    pub fn get(&self, name: &str) -> Option<Value> {
        let Self { stepper, parameters, solver, remedies } = self;
        if name == Self::STEPPER.name {
            return Some(stepper.value());
        }
        parameters.get(name).or_else(|| solver.get(name)).or_else(|| remedies.get(name))
    }

    /// Gives the setting of that name a value of its kind. Whether there is one of that name and kind.
    pub fn set(&mut self, name: &str, value: Value) -> bool {
        let Self { stepper, parameters, solver, remedies } = self;
        if name == Self::STEPPER.name {
            let wanted = Stepper::of(value);
            *stepper = wanted.unwrap_or(*stepper);
            return wanted.is_some();
        }
        parameters.set(name, value) || solver.set(name, value) || remedies.set(name, value)
    }

    /// The same with another Bond number.
    pub fn with_bond(mut self, bond: f64) -> Self {
        self.parameters.bond = bond;
        self
    }

    /// The same with another Δt, s.
    pub fn over(self, time_step_secs: f64) -> Self {
        Self { parameters: self.parameters.over(time_step_secs), ..self }
    }
}
