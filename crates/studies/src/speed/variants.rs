//! The solver variants that are charted: every method of the registry with its settings.

use crate::chart::{Layer, Look, PALETTE, Rgb, points};
use crate::sim::Stepper;
use crate::solver::{FrictionModel, METHODS, Method, Ordering, SolverSettings, StopTest};

/// After those of the palette.
const OTHERS: [Rgb; 3] = [(136, 34, 85), (153, 153, 51), (130, 130, 130)];

/// A method with its settings, or a stepper that has none, as it is charted.
#[derive(Clone, Debug)]
pub(super) struct ChartedVariant {
    pub name: String,
    /// Its number on its chart: a colour, and dashes after the colours run out.
    look: usize,
    pub stepper: Stepper,
    pub solver: SolverSettings,
}

/// Steppers that solve no problem by a method: variants by themselves.
fn without_method() -> impl Iterator<Item = Stepper> {
    Stepper::ALL.iter().copied().filter(|stepper| !stepper.uses_method())
}

/// The variants of one chart, so that no two look alike.
pub(super) fn told_apart(mut variants: Vec<ChartedVariant>) -> Vec<ChartedVariant> {
    for (look, variant) in variants.iter_mut().enumerate() {
        variant.look = look;
    }
    variants
}

/// Every method of the registry, in its order, and every stepper without one; `auto` is one of the others.
pub(super) fn all() -> Vec<ChartedVariant> {
    let mut variants = of_problems(false);
    variants.extend(without_method().map(|stepper| {
        let (name, solver) = (stepper.name().to_owned(), SolverSettings::SWEEPS);
        ChartedVariant { name, look: 0, stepper, solver }
    }));
    variants
}

pub(super) fn of_method(method: Method) -> ChartedVariant {
    of_model(method, FrictionModel::Coulomb)
}

/// Those that solve the problem of a step, and Gauss–Seidel in its other orders where `orders` are asked for.
pub(super) fn of_problems(orders: bool) -> Vec<ChartedVariant> {
    let own = METHODS.iter().map(|info| info.method).filter(|method| *method != Method::Auto);
    let mut variants: Vec<ChartedVariant> = own.map(of_method).collect();
    if orders {
        for ordering in [Ordering::BottomUp, Ordering::Detected, Ordering::Symmetric] {
            let mut variant = of_method(Method::Nsgs);
            variant.name = format!("nsgs {ordering}");
            variant.solver.ordering = ordering;
            variants.push(variant);
        }
    }
    variants
}

/// Models of friction in the place of Coulomb's law, by sweeps, and the one that piles do not tell from it by the
/// method that certifies it. They solve another problem, so that whole simulations alone can tell what they are worth.
pub(super) fn models() -> Vec<ChartedVariant> {
    let models = FrictionModel::SOLVED.iter().filter(|model| **model != FrictionModel::Coulomb);
    models.map(|&model| of_model(Method::Nsgs, model)).chain([certified()]).collect()
}

/// The convex model that piles do not tell from Coulomb's law, by the method that certifies it.
pub(super) fn certified() -> ChartedVariant {
    of_model(Method::InteriorPoint, FrictionModel::Tresca)
}

fn of_model(method: Method, friction_model: FrictionModel) -> ChartedVariant {
    let solver = SolverSettings { method, friction_model, ..SolverSettings::SWEEPS };
    let name = match friction_model {
        FrictionModel::Coulomb => method.to_string(),
        _ => format!("{method} {friction_model}"),
    };
    ChartedVariant { name, look: 0, stepper: Stepper::Moreau, solver }
}

impl ChartedVariant {
    pub(super) fn method(&self) -> Option<Method> {
        self.stepper.uses_method().then_some(self.solver.method)
    }

    pub(super) fn to_residual(&self, tolerance: f64, max_sweeps: u32) -> SolverSettings {
        let stop = StopTest::Residual;
        SolverSettings { stop, tolerance, max_sweeps, warm_start: true, ..self.solver }
    }

    /// Warm-started, with so many sweeps, whatever they come to.
    pub(super) fn sweeps(&self, count: u32) -> SolverSettings {
        self.to_residual(f64::MIN_POSITIVE, count)
    }

    pub(super) fn colour(&self) -> Rgb {
        let colours = || PALETTE.into_iter().chain(OTHERS);
        colours().nth(self.look % colours().count()).unwrap_or(PALETTE[0])
    }

    fn is_dashed(&self) -> bool {
        self.look >= PALETTE.len() + OTHERS.len()
    }

    pub(super) fn dots(&self, radius: u32) -> Look {
        if self.is_dashed() { Look::Rings(radius) } else { Look::Dots(radius) }
    }

    pub(super) fn marked_curve(&self, name: String, places: Vec<(f64, f64)>) -> Vec<Layer> {
        let (colour, points) = (self.colour(), points(places));
        if self.is_dashed() {
            let marks = Layer::quiet(format!("{name} "), points.clone(), colour, Look::Rings(5));
            return vec![Layer::curve(name, points, colour, Look::Dashes(3)), marks];
        }
        vec![Layer::curve(name, points, colour, Look::LineAndDots)]
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn no_two_of_a_chart_look_alike() {
        let with_models = all().into_iter().chain(models()).collect();
        for variants in [of_problems(true), with_models].map(told_apart) {
            let looks = variants.iter().map(|variant| (variant.colour(), variant.is_dashed()));
            let names: Vec<_> = variants.iter().map(|variant| &variant.name).collect();
            assert_eq!(looks.collect::<HashSet<_>>().len(), variants.len(), "{names:?}");
        }
    }
}
