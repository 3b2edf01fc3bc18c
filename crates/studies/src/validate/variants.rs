//! Lists the solver variants with which experiments are run: every chosen solver method, with every time step and every
//! effort (number of sweeps or tolerance).

use std::fmt::{Debug, Display};

use crate::error::{self, Error, Result};
use crate::scene::Scene;
use crate::sim::Stepper;
use crate::solver::{Method, SolverSettings};

/// Largest number of sweeps per step if the steps are solved to a tolerance of the residual.
const MOST_SWEEPS: u32 = 1_000;

/// Default efforts (numbers of sweeps per step) of solver methods other than `auto`, if the user gives no efforts.
const UNASKED: [SolveBudget; 2] = [SolveBudget::Sweeps(20), SolveBudget::Sweeps(100)];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SolveBudget {
    /// Makes this number of sweeps in each step, whatever the residual is.
    Sweeps(u32),
    /// Makes sweeps until the residual is at most this value, but at most [`MOST_SWEEPS`] sweeps per step.
    Residual(f64),
    /// Solves each step to the default tolerance of the estimated velocity error.
    Default,
}

impl SolveBudget {
    pub(super) fn words(self) -> String {
        match self {
            Self::Sweeps(1) => "1 sweep".to_owned(),
            Self::Sweeps(count) => format!("{count} sweeps"),
            Self::Residual(residual) => format!("residual {residual:e}"),
            Self::Default => "velocity error 1e-4".to_owned(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepVariant {
    pub stepper: Stepper,
    pub method: Method,
    /// Time step Δt, s.
    pub time_step_secs: f64,
    pub budget: SolveBudget,
}

impl StepVariant {
    pub(super) fn words(&self) -> String {
        let Self { stepper, method, time_step_secs, budget } = self;
        let of_step = format!("Δt {time_step_secs:e} s");
        match stepper {
            Stepper::Moreau => format!("{method}, {of_step}, {}", budget.words()),
            stepper if stepper.reads("solver") => {
                format!("{stepper}, {method}, {of_step}, {}", budget.words())
            }
            // This stepper uses no solver method, and determines its effort itself.
            stepper => format!("{stepper}, {of_step}"),
        }
    }

    pub(super) fn apply(&self, scene: &mut Scene) {
        scene.parameters.time_step_secs = self.time_step_secs;
        let to_residual =
            |tolerance, max_sweeps| SolverSettings::to_residual(self.method, tolerance, max_sweeps);
        scene.stepper = self.stepper;
        scene.solver = match self.budget {
            SolveBudget::Sweeps(count) => to_residual(f64::MIN_POSITIVE, count),
            SolveBudget::Residual(residual) => to_residual(residual, MOST_SWEEPS),
            SolveBudget::Default => SolverSettings::default().by(self.method),
        };
        scene.set_settings(scene.settings().with_only_what_is_taken());
    }
}

/// Returns one variant for each combination of a solver method, a time step and an effort (number of sweeps or
/// tolerance) that the user chooses. An empty list stands for the defaults.
///
/// # Errors
/// If a value is outside its range, is given twice, or is not used by the stepper. The error names the first such
/// value.
pub(super) fn step_variants(
    stepper: Stepper,
    methods: &[Method],
    time_steps_secs: &[f64],
    sweeps: &[u32],
    tolerances: &[f64],
) -> Result<Vec<StepVariant>> {
    check_positive("time-steps", time_steps_secs, "a finite number of seconds > 0")?;
    check_positive("tolerances", tolerances, "a finite number > 0")?;
    error::check(!sweeps.contains(&0), "sweeps", 0, "at least 1")?;
    check_different("methods", methods)?;
    check_different("time-steps", time_steps_secs)?;
    check_different("sweeps", sweeps)?;
    check_different("tolerances", tolerances)?;
    if !stepper.reads("solver") {
        let given = [!methods.is_empty(), !sweeps.is_empty(), !tolerances.is_empty()];
        let names = ["methods", "sweeps", "tolerances"];
        if let Some((name, _)) = names.iter().zip(given).find(|(_, given)| *given) {
            let allowed = format!("left out under {stepper}, which solves no problem by a method");
            return Err(Error::value(*name, "given", allowed));
        }
    }
    let sweeps = sweeps.iter().map(|&count| SolveBudget::Sweeps(count));
    let tolerances = tolerances.iter().map(|&residual| SolveBudget::Residual(residual));
    let budgets: Vec<SolveBudget> = sweeps.chain(tolerances).collect();
    let methods: &[Method] = match (methods.is_empty(), budgets.is_empty()) {
        (false, _) => methods,
        (true, true) => &[Method::Auto],
        (true, false) => &[Method::Nsgs],
    };
    let time_steps_secs = if time_steps_secs.is_empty() { &[1e-3] } else { time_steps_secs };
    let mut variants = Vec::new();
    for &method in methods {
        for &time_step_secs in time_steps_secs {
            let of = |&budget| StepVariant { stepper, method, time_step_secs, budget };
            let budgets = match (budgets.is_empty(), method) {
                (false, _) => &budgets,
                (true, Method::Auto) => &[SolveBudget::Default][..],
                (true, _) => &UNASKED,
            };
            variants.extend(budgets.iter().map(of));
        }
    }
    Ok(variants)
}

fn check_positive(field: &str, values: &[f64], allowed: &str) -> Result<()> {
    let wrong = values.iter().find(|value| !(**value > 0.0 && value.is_finite()));
    wrong.map_or(Ok(()), |value| Err(Error::value(field, value, allowed)))
}

fn check_different<T: PartialEq + Display + Debug>(field: &str, values: &[T]) -> Result<()> {
    let twice = values.iter().enumerate().find(|(index, value)| values[..*index].contains(value));
    let refuse = |value: &T| Error::value(field, format!("{value} twice"), "different values");
    twice.map_or(Ok(()), |(_, value)| Err(refuse(value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::stability::dry;
    use crate::validate::watched::loose;

    #[test]
    fn what_is_asked_is_crossed_and_the_rest_is_chosen() {
        let nsgs = [Method::Nsgs];
        let nsgs = step_variants(Stepper::Moreau, &nsgs, &[], &[], &[]).expect("a choice");
        assert_eq!(nsgs.len(), 2);
        let methods = [Method::Nsgs, Method::Newton];
        let variants = step_variants(Stepper::Moreau, &methods, &[1e-3, 1e-4], &[5], &[1e-6])
            .expect("a choice");
        assert_eq!(variants.len(), 8);
        assert_eq!(variants[0].words(), "nsgs, Δt 1e-3 s, 5 sweeps");
        assert_eq!(variants[7].words(), "newton, Δt 1e-4 s, residual 1e-6");
        let one = step_variants(Stepper::Moreau, &[], &[], &[7], &[]).expect("a choice");
        assert!(one.len() == 1 && one[0].budget == SolveBudget::Sweeps(7));
        let auto = step_variants(Stepper::Moreau, &[], &[], &[], &[]).expect("a choice");
        assert_eq!(
            (auto.len(), auto[0].words()),
            (1, "auto, Δt 1e-3 s, velocity error 1e-4".to_owned())
        );
        let mut scene = dry("packing", loose(10, 5.0, 1));
        scene.solver = SolverSettings::PAPER;
        auto[0].apply(&mut scene);
        assert_eq!(scene.solver, SolverSettings::default());
        let words = |stepper| -> Vec<String> {
            let chosen = step_variants(stepper, &[], &[], &[], &[]).expect("a choice");
            chosen.iter().map(StepVariant::words).collect()
        };
        assert_eq!(words(Stepper::Range), ["range, auto, Δt 1e-3 s, velocity error 1e-4"]);
        assert_eq!(words(Stepper::Dem), ["dem, Δt 1e-3 s"]);
    }

    #[test]
    fn what_is_no_number_or_comes_twice_is_refused_by_name() {
        let refused = |steps: &[f64], sweeps: &[u32], tolerances: &[f64]| {
            let choice = step_variants(Stepper::Moreau, &[], steps, sweeps, tolerances);
            choice.expect_err("a refusal").to_string()
        };
        assert!(refused(&[1e-3, -1.0], &[], &[]).starts_with("time-steps is -1"));
        assert!(refused(&[f64::INFINITY], &[], &[]).starts_with("time-steps is inf"));
        assert!(refused(&[1e-3, 1e-3], &[], &[]).starts_with("time-steps is 0.001 twice"));
        assert!(refused(&[], &[0], &[]).starts_with("sweeps is 0"));
        assert!(refused(&[], &[3, 3], &[]).starts_with("sweeps is 3 twice"));
        assert!(refused(&[], &[], &[f64::NAN]).starts_with("tolerances is NaN"));
        let said = step_variants(Stepper::Dem, &[Method::Newton], &[], &[], &[]);
        let said = said.expect_err("a refusal").to_string();
        assert!(said.starts_with("methods is given, but must be left out under dem"), "{said}");
    }
}
