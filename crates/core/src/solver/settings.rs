//! Settings of the solver: method, stopping test, tolerance, limits and friction model.

use super::method::{METHODS, Method, Ordering};
use crate::error::{Error, Result};
use crate::setting::{Group, settings, words};

words! {
    /// The stopping test: the quantity that the solver's tolerance limits. P is the vector of the normal and tangential
    /// impulses of all contacts (N·s), and ΔP its change in a sweep, or in an iteration of a method without sweeps. The
    /// test `impulse-per-mass` is made after every sweep. The other tests are made after each of the first 16 sweeps of
    /// a solve and then only after every eighth sweep, because they take time.
    #[derive(Default)]
    pub enum StopTest {
        RelativeChange = "relative-change", "‖ΔP‖ of a sweep over ‖P‖";
        ImpulsePerMass = "impulse-per-mass", "sum of |ΔP| of a sweep over the mean mass, m/s";
        Residual = "residual", "residual of the contact laws, the same for all solvers";
        #[default]
        VelocityError = "velocity-error",
            "estimated root mean square error of the velocities, divided by √(g d) and the speeds that contacts cancel";
    }
}

words! {
    /// The friction law that a step is solved under. Coulomb's law is not convex. Each other model replaces friction
    /// bounds or sliding speeds by numbers that stay fixed while a step is solved (`problem::friction`), so that the
    /// problem is convex and the velocities of a solve are unique.
    #[derive(Default)]
    pub enum FrictionModel {
        #[default]
        Coulomb = "coulomb",
            "Coulomb's law (M. Jean, 1999); it is not convex, so some steps of large piles are not solved";
        Tresca = "tresca",
            "bounded friction: μN of fifty Coulomb sweeps is the bound (P. D. Panagiotopoulos, 1975); on large \
                piles friction lags behind the pressure";
        Associated = "associated",
            "cone complementarity (M. Anitescu, 2006); a sliding contact opens by Δt·μ·v_t per step, and bonds break";
        Desaxce = "desaxce",
            "associated, minus the last μ|v_t| (G. de Saxcé, Z.-Q. Feng, 1998); contacts that accelerate still open";
    }
}

impl StopTest {
    /// Returns true if the stopping test measures the error of the present impulses, and false if it measures their
    /// change in a sweep.
    pub(crate) fn judges_solutions(self) -> bool {
        matches!(self, Self::Residual | Self::VelocityError)
    }
}

impl FrictionModel {
    /// Returns true if the friction model uses a number per contact that is estimated before a solve, and that can be
    /// estimated again for a further solve of the same step. The number is a friction bound, or an opening speed
    /// (estimated speed at which the model would otherwise let a sliding contact open), m/s.
    pub fn is_taken_anew(self) -> bool {
        matches!(self, Self::Tresca | Self::Desaxce)
    }

    /// Returns true if the friction model allows each contact all impulses inside a cone. The cone is always the
    /// shifted friction cone, in which μ (N + C₀) bounds friction (μ: friction coefficient, N: normal force, C₀:
    /// cohesion force). The other cone, with the bound μ max(N, 0), is not convex if there is cohesion, and its convex
    /// hull is the shifted cone.
    pub(crate) fn is_on_cone(self) -> bool {
        matches!(self, Self::Associated | Self::Desaxce)
    }
}

settings! {
    /// Settings of the solver: method, stopping test, limits and friction model. The values are checked when they are
    /// passed to a simulation.
    ///
    /// By default each step is solved under Coulomb's law to an estimated velocity error of 1e-4 √(g d) (gravity g,
    /// mean diameter d), which is too small to affect the slump of a pile. A step in which thousands of grains flow can
    /// end with a larger error, which is reported ([`Measures::velocity_error`](super::Measures)).
    #[serde(default)]
    pub struct SolverSettings, changes SolverChanges, heading "Solver" {
        method: Method = Method::Auto, "solver" ("NAME"), "Solver of each step", {
            control: shown("Solver", "The solver that finds the impulses of a step."),
        }
        #[serde(skip_serializing_if = "is_default")]
        ordering: Ordering = Ordering::Interleaved, "ordering" ("ORDER"),
            "Order in which a sweep visits the contacts", {
            control: shown("Order", "Order in which a sweep visits the contacts."),
        }
        stop: StopTest = StopTest::VelocityError, "stop" ("TEST"), "Stopping test: the quantity that the tolerance \
            limits", {
            control: shown("Stops on", "The quantity that the tolerance limits."),
        }
        /// Tolerance to which the contact problem of each step is solved, in the unit of the stopping test `stop`.
        tolerance: f64 = 1e-4, "tolerance" ("X"), "Tolerance of each step, in the unit of the stopping test", {
            allowed: "a finite number > 0",
            holds: |value| value > 0.0 && value.is_finite(),
            control: Some(Control {
                label: "Tolerance",
                hint: "Tolerance of each step; the result depends on it.",
                range: [1e-12, 1e-1],
                logarithmic: true,
                ..Control::PLAIN
            }),
        }
        /// Maximum number of sweeps per step, or of iterations of a method without sweeps. A step that needs more is
        /// reported as unsolved.
        max_sweeps: u32 = 5_000, "max-sweeps", "Most sweeps per step; a step that needs more is reported as unsolved; the solver auto may stop earlier", {
            allowed: "at least 1",
            holds: |value| value > 0,
            control: Some(Control {
                label: "Sweep limit",
                hint: "A step that needs more sweeps (or iterations) is reported as unsolved.",
                range: [1.0, 100_000.0],
                logarithmic: true,
                ..Control::PLAIN
            }),
        }
        warm_start: bool = true, "warm-start", "Start each step from the impulses of the step before", {
            control: shown("Warm start", "Each step starts from the impulses of the step before."),
        }
        friction_model: FrictionModel = FrictionModel::Coulomb, "friction-model" ("MODEL"),
            "Friction model: Coulomb's law, or a convex model instead; `slump list friction-models` says what each \
                model gets wrong", {
            needs: Needs::Friction,
            control: shown(
                "Friction",
                "Coulomb's law, or a convex model of friction instead.",
            ),
        }
        model_solves: u32 = 1, "model-solves",
            "Solves per step under tresca or desaxce, with updated bounds each time; more solves approach Coulomb's \
                law and cost more", {
            allowed: "between 1 and 1000",
            holds: |value| (1..=1000).contains(&value),
            needs: Needs::Friction,
            control: Some(Control {
                label: "Solves a step",
                hint: "Solves per step, with updated friction bounds each time; more solves approach Coulomb's law.",
                range: [1.0, 16.0],
                ..Control::PLAIN
            }),
        }
    }
}

/// Returns true if a setting has its default value. Settings that were added after the first version of scene files are
/// written to a file only if they differ from their defaults.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl SolverSettings {
    /// Settings for Gauss–Seidel sweeps until the impulses change by less than 1e-6 of their norm per sweep, the scheme
    /// of most programs for Contact Dynamics.
    pub const SWEEPS: Self =
        Self { stop: StopTest::RelativeChange, ..Self::to_residual(Method::Nsgs, 1e-6, 5_000) };

    /// The default settings with bounded friction (Tresca). The problem is then convex, and can be solved for any
    /// number of grains.
    pub const BOUNDED: Self = Self { friction_model: FrictionModel::Tresca, ..Self::DEFAULT };

    /// The scheme of a paper (A. Abramian, L. Staron, *Time Steps v.s. Cohesion in Non-Smooth Contact Dynamics
    /// Algorithm*, 2020): [`Self::SWEEPS`] with a tolerance of 1e-7, at which the conclusions of the paper no longer
    /// depend on the solver.
    pub const PAPER: Self = Self { tolerance: 1e-7, ..Self::SWEEPS };

    /// Returns settings for a solve under Coulomb's law to a given residual (`tolerance`), regardless of the settings
    /// of the simulation. The solve starts from the present impulses of the problem.
    pub const fn to_residual(method: Method, tolerance: f64, max_sweeps: u32) -> Self {
        Self {
            method,
            ordering: Ordering::Interleaved,
            stop: StopTest::Residual,
            tolerance,
            max_sweeps,
            warm_start: true,
            friction_model: FrictionModel::Coulomb,
            model_solves: 1,
        }
    }

    /// Checks that each number is within its range, and that the method supports the friction model.
    ///
    /// # Errors
    /// The error names the field, its value and the allowed values.
    pub fn validate(&self) -> Result<()> {
        self.validate_each()?;
        let (method, friction_model) = (self.method, self.friction_model);
        if friction_model != FrictionModel::Coulomb && !method.info().takes_models {
            let takers = METHODS.iter().filter(|info| info.takes_models).map(|info| info.name);
            let takers: Vec<_> = takers.collect();
            let allowed = format!(
                "coulomb where solver is {method}: other models go with {}",
                takers.join(" and ")
            );
            return Err(Error::value("friction-model", friction_model, allowed));
        }
        Ok(())
    }

    /// Returns true if steps are solved under a friction model other than Coulomb's law.
    pub(crate) fn solves_models(&self) -> bool {
        self.friction_model != FrictionModel::Coulomb
    }

    /// Returns these settings with Coulomb's law as the friction model.
    pub(crate) fn without_model(self) -> Self {
        Self { friction_model: FrictionModel::Coulomb, ..self }
    }

    /// Returns these settings with another method. The friction model becomes Coulomb's law if the new method supports
    /// no other model.
    pub fn by(self, method: Method) -> Self {
        let by_it = Self { method, ..self };
        if method.info().takes_models { by_it } else { by_it.without_model() }
    }
}
