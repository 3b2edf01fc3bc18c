//! Lists the solver variants whose speed and accuracy the charts compare: every solver method of the program, with its
//! settings.

use crate::chart::{PALETTE, Rgb};
use crate::harness::{Change, distinct};
use crate::sim::Stepper;
use crate::solver::{FrictionModel, METHODS, Method, Ordering, SolverSettings, StopTest};

/// A family of similar methods. Each family shares one curve on a chart, because seven curves are easier to read than
/// eighteen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// The default solver of the program, which chooses among methods itself.
    Default,
    /// Methods that sweep over the contacts and update the impulse of each contact by itself, such as Gauss–Seidel and
    /// Jacobi.
    Sweeps,
    /// First-order methods, which only multiply vectors by the operator of the whole contact problem and factorise no
    /// matrix.
    FirstOrder,
    /// Methods with factorisations of matrices, under Coulomb friction.
    Newton,
    /// Methods that solve a convex friction model instead of Coulomb friction.
    Convex,
    /// The stepper `range`, whose bonds pull up to a debonding distance.
    Range,
    /// Steppers that use springs or penalties between grains and do not solve a contact problem.
    Penalties,
}

impl Family {
    pub(super) const ALL: [Self; 7] = [
        Self::Default,
        Self::Sweeps,
        Self::FirstOrder,
        Self::Newton,
        Self::Convex,
        Self::Range,
        Self::Penalties,
    ];

    /// Returns the name of the family of methods in the legends of charts.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Sweeps => "sweeps",
            Self::FirstOrder => "first order",
            Self::Newton => "Newton",
            Self::Convex => "convex",
            Self::Range => "range",
            Self::Penalties => "penalties",
        }
    }

    pub(super) fn colour(self) -> Rgb {
        let place = Self::ALL.iter().position(|family| *family == self);
        place.map_or(PALETTE[0], |place| PALETTE[place])
    }
}

/// Returns a text for captions, which lists the names of the variants in each family of similar solver methods.
pub(super) fn members<'a>(variants: impl Iterator<Item = &'a Change> + Clone) -> String {
    let of = |family: Family| {
        let its = variants.clone().filter(|variant| variant.family() == family);
        let names = distinct(its.map(|variant| &*variant.name));
        (!names.is_empty()).then(|| format!("{}: {}", family.name(), names.join(", ")))
    };
    let all: Vec<String> = Family::ALL.into_iter().filter_map(of).collect();
    format!("{}.", all.join("; "))
}

/// Returns the steppers that use no solver method, such as `dem`. The charts show each of them like a solver variant.
fn without_method() -> impl Iterator<Item = Stepper> {
    Stepper::ALL.iter().copied().filter(|stepper| !stepper.uses_method())
}

/// Returns the variants for every solver method of the program, in the order of the list of methods, and for every
/// stepper without a solver method.
pub(super) fn all() -> Vec<Change> {
    let mut variants = of_problems(false);
    let of = |stepper: Stepper| Change::of_solver(stepper.name(), stepper, &SolverSettings::SWEEPS);
    variants.extend(without_method().map(of));
    variants
}

pub(super) fn of_method(method: Method) -> Change {
    of_model(method, FrictionModel::Coulomb)
}

/// Returns the default solver: Coulomb friction, solved until the estimated velocity error is below the tolerance.
pub(super) fn default() -> Change {
    Change::of_solver("default", Stepper::Moreau, &SolverSettings::default())
}

/// Returns the variants that solve the contact problem of a step: every solver method, and the default solver. If
/// `orders` is true, Gauss–Seidel with other orders of the contacts is included.
pub(super) fn of_problems(orders: bool) -> Vec<Change> {
    let own = METHODS.iter().map(|info| info.method).filter(|method| *method != Method::Auto);
    let mut variants: Vec<Change> = own.map(of_method).chain([default()]).collect();
    if orders {
        for ordering in [Ordering::BottomUp, Ordering::Detected, Ordering::Symmetric] {
            let mut variant = of_method(Method::Nsgs);
            variant.name = format!("nsgs {ordering}");
            variant.config.solver.ordering = Some(ordering);
            variants.push(variant);
        }
    }
    variants
}

/// Returns the variants with another friction model than Coulomb friction: every such model solved by sweeps, and
/// bounded friction (Tresca) also by the interior-point method.
pub(super) fn models() -> Vec<Change> {
    let models = FrictionModel::ALL.iter().filter(|model| **model != FrictionModel::Coulomb);
    models.map(|&model| of_model(Method::Nsgs, model)).chain([bounded()]).collect()
}

/// Returns the variant that solves bounded friction (Tresca) by the interior-point method, which solves the convex
/// problem of this model for any number of grains.
pub(super) fn bounded() -> Change {
    of_model(Method::InteriorPoint, FrictionModel::Tresca)
}

fn of_model(method: Method, friction_model: FrictionModel) -> Change {
    let solver = SolverSettings { method, friction_model, ..SolverSettings::SWEEPS };
    let name = match friction_model {
        FrictionModel::Coulomb => method.to_string(),
        _ => format!("{method} {friction_model}"),
    };
    Change::of_solver(name, Stepper::Moreau, &solver)
}

/// Properties of a solver variant, for the charts that compare the speed and the accuracy of variants.
impl Change {
    /// True for the [`default`] solver, which determines its number of sweeps itself.
    pub(super) fn is_default(&self) -> bool {
        self.solver().method == Method::Auto
    }

    pub(super) fn method(&self) -> Option<Method> {
        self.stepper().uses_method().then_some(self.solver().method)
    }

    pub(super) fn to_residual(&self, tolerance: f64, max_sweeps: u32) -> SolverSettings {
        let stop = StopTest::Residual;
        SolverSettings { stop, tolerance, max_sweeps, warm_start: true, ..self.solver() }
    }

    /// Returns the solver settings of the variant, with a warm start and exactly `count` sweeps. For the default
    /// solver, returns its own settings without a change.
    pub(super) fn sweeps(&self, count: u32) -> SolverSettings {
        match self.is_default() {
            true => self.solver(),
            false => self.to_residual(f64::MIN_POSITIVE, count),
        }
    }

    pub(super) fn family(&self) -> Family {
        if !self.stepper().uses_method() {
            return Family::Penalties;
        }
        if self.stepper() == Stepper::Range {
            return Family::Range;
        }
        if self.solver().friction_model != FrictionModel::Coulomb {
            return Family::Convex;
        }
        match self.solver().method {
            Method::Auto => Family::Default,
            Method::Newton | Method::InteriorPoint => Family::Newton,
            Method::Nncg | Method::Apgd | Method::Admm => Family::FirstOrder,
            Method::Nsgs | Method::NsgsParallel | Method::Jacobi => Family::Sweeps,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_family_has_members_and_the_names_of_variants_differ() {
        let mut variants: Vec<_> = all().into_iter().chain(models()).collect();
        let mut of_range = of_method(Method::Newton);
        of_range.config.stepper = Some(Stepper::Range);
        variants.push(of_range);
        for family in Family::ALL {
            assert!(variants.iter().any(|variant| variant.family() == family), "{family:?}");
        }
        variants.pop();
        let count = variants.len();
        let mut names: Vec<_> = variants.into_iter().map(|variant| variant.name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
