//! The solver variants that are charted: every method of the registry with its settings, each with one look on every
//! chart. A look is a colour, and dashes after the colours run out; after the dashes run out too, other colours.

use crate::chart::{Layer, Look, PALETTE, Rgb, points};
use crate::sim::Stepper;
use crate::solver::{FrictionModel, METHODS, Method, Ordering, SolverSettings, StopTest};

/// Looks of models of friction, from the number of looks on: `newton` has the second one there, under the law
/// `range`.
const OTHER_LOOKS: [usize; 3] = [0, 1, 3];
/// In the place of black, which would come dashed a second time.
const WINE: Rgb = (136, 34, 85);
/// In the place of blue, likewise.
const OLIVE: Rgb = (153, 153, 51);

/// A method with its settings, or a stepper that has none, as it is charted.
#[derive(Clone, Debug)]
pub(super) struct ChartedVariant {
    /// Its name on charts.
    pub name: String,
    /// Its number among all looks.
    pub look: usize,
    pub stepper: Stepper,
    pub solver: SolverSettings,
}

/// Steppers that solve no problem by a method: variants by themselves.
fn without_method() -> impl Iterator<Item = Stepper> {
    Stepper::ALL.iter().copied().filter(|stepper| !stepper.uses_method())
}

/// How many looks there are, but for those of variants that come twice.
pub(super) fn looks() -> usize {
    METHODS.len() + without_method().count()
}

/// Every method of the registry, in its order, and every stepper without one; `auto` is one of the others.
pub(super) fn all() -> Vec<ChartedVariant> {
    let mut variants = of_problems(false);
    variants.extend((METHODS.len()..).zip(without_method()).map(|(look, stepper)| {
        let name = stepper.name().to_owned();
        ChartedVariant { name, look, stepper, solver: SolverSettings::default() }
    }));
    variants
}

/// A method that solves the problem of a step.
pub(super) fn of_method(method: Method) -> ChartedVariant {
    let look = METHODS.iter().position(|info| info.method == method).unwrap_or_default();
    of_model(method, FrictionModel::Coulomb, look)
}

/// Those that solve the problem of a step, and Gauss–Seidel in its other orders where `orders` are asked for.
pub(super) fn of_problems(orders: bool) -> Vec<ChartedVariant> {
    let own = METHODS.iter().map(|info| info.method).filter(|method| *method != Method::Auto);
    let mut variants: Vec<ChartedVariant> = own.map(of_method).collect();
    if orders {
        for ordering in [Ordering::BottomUp, Ordering::Detected, Ordering::Symmetric] {
            let look = looks() + variants.len();
            let mut variant = of_model(Method::Nsgs, FrictionModel::Coulomb, look);
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
    let models = FrictionModel::ALL.iter().filter(|model| **model != FrictionModel::Coulomb);
    let by_sweeps = OTHER_LOOKS.into_iter().zip(models);
    let mut variants: Vec<ChartedVariant> =
        by_sweeps.map(|(look, &model)| of_model(Method::Nsgs, model, looks() + look)).collect();
    variants.push(certified());
    variants
}

/// The convex model that piles do not tell from Coulomb's law, by the method that certifies it. `auto`, which is
/// on no chart, leaves it its look.
pub(super) fn certified() -> ChartedVariant {
    of_model(Method::InteriorPoint, FrictionModel::Tresca, of_method(Method::Auto).look)
}

fn of_model(method: Method, friction_model: FrictionModel, look: usize) -> ChartedVariant {
    let solver = SolverSettings { method, friction_model, ..SolverSettings::default() };
    let name = match friction_model {
        FrictionModel::Coulomb => method.to_string(),
        _ => format!("{method} {friction_model}"),
    };
    ChartedVariant { name, look, stepper: Stepper::Moreau, solver }
}

impl ChartedVariant {
    /// Its method, if it has one.
    pub(super) fn method(&self) -> Option<Method> {
        self.stepper.uses_method().then_some(self.solver.method)
    }

    /// Warm-started, down to a residual.
    pub(super) fn to_residual(&self, tolerance: f64, max_sweeps: u32) -> SolverSettings {
        let stop = StopTest::Residual;
        SolverSettings { stop, tolerance, max_sweeps, warm_start: true, ..self.solver }
    }

    /// Warm-started, with so many sweeps, whatever they come to.
    pub(super) fn sweeps(&self, count: u32) -> SolverSettings {
        self.to_residual(f64::MIN_POSITIVE, count)
    }

    pub(super) fn colour(&self) -> Rgb {
        match self.look % PALETTE.len() {
            0 if self.look >= 2 * PALETTE.len() => WINE,
            1 if self.look >= 2 * PALETTE.len() => OLIVE,
            place => PALETTE[place],
        }
    }

    fn is_dashed(&self) -> bool {
        self.look >= PALETTE.len()
    }

    /// Its dots, of that radius.
    pub(super) fn dots(&self, radius: u32) -> Look {
        if self.is_dashed() { Look::Rings(radius) } else { Look::Dots(radius) }
    }

    /// A curve with its points marked.
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
        for variants in [of_problems(true), with_models] {
            let looks = variants.iter().map(|variant| (variant.colour(), variant.is_dashed()));
            let names: Vec<_> = variants.iter().map(|variant| &variant.name).collect();
            assert_eq!(looks.collect::<HashSet<_>>().len(), variants.len(), "{names:?}");
        }
    }
}
