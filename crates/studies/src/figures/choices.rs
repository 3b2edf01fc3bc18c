//! Runs that differ in one free choice from those that come first, and what it is.

use super::workshop::Rows;
use crate::config::Config;
use crate::world::FrictionCone;

/// One way to choose.
pub(super) struct Choice<'a> {
    /// What is other than in the first.
    pub name: String,
    /// Its runs.
    pub rows: Rows<'a>,
}

/// What is chosen, each with its value.
type Chosen = [(&'static str, String); 9];

/// What can be chosen, each written.
fn chosen(config: &Config) -> Chosen {
    let parameters = &config.parameters;
    let number = |value: Option<f64>| match value {
        None => String::new(),
        Some(value) if value != 0.0 && value.abs() < 1e-2 => format!("{value:e}").replace('-', "−"),
        Some(value) => value.to_string(),
    };
    let cone = match parameters.cone {
        Some(FrictionCone::Compressive) => "compressive",
        _ => "shifted",
    };
    [
        ("cone", cone.to_owned()),
        ("stop", number(config.solver.tolerance)),
        ("ρ", number(parameters.restitution)),
        ("no bounce below, in g·Δt,", number(parameters.restitution_threshold)),
        (
            "warm start",
            if config.solver.warm_start == Some(true) { "yes" } else { "no" }.to_owned(),
        ),
        ("start of k", number(config.source.start)),
        ("μ", number(parameters.friction)),
        ("δc", number(parameters.debonding_distance)),
        ("grains", config.source.grains.map_or_else(String::new, |grains| grains.to_string())),
    ]
}

/// The ways to choose that are among runs, in their order.
pub(super) fn choices<'a>(rows: &Rows<'a>) -> Vec<Choice<'a>> {
    let mut all: Vec<Chosen> = Vec::new();
    for (config, _) in &rows.0 {
        let here = chosen(config);
        if !all.contains(&here) {
            all.push(here);
        }
    }
    let Some(first) = all.first().cloned() else { return Vec::new() };
    let name = |here: &Chosen| {
        let others = here.iter().zip(&first).filter(|(one, other)| one != other);
        let told: Vec<String> =
            others.map(|((what, value), _)| format!("{what} {value}")).collect();
        if told.is_empty() { "as it is".to_owned() } else { told.join(", ") }
    };
    let choice = |here: &Chosen| Choice {
        name: name(here),
        rows: rows.such_that(|config| &chosen(config) == here),
    };
    all.iter().map(choice).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Outcome;

    #[test]
    fn a_choice_is_named_for_what_is_changed_and_has_its_runs() {
        let config = |tolerance, cone, step| {
            let mut config = Config::default();
            config.solver.tolerance = Some(tolerance);
            config.parameters.cone = Some(cone);
            config.parameters.time_step_secs = Some(step);
            config
        };
        use FrictionCone::{Compressive, Shifted};
        let configs = [
            config(1e-7, Shifted, 1e-3),
            config(1e-7, Compressive, 1e-3),
            config(1e-7, Shifted, 5e-3),
            config(0.5, Shifted, 1e-3),
        ];
        let outcome = Outcome::of_slump(0.0);
        let rows = Rows(configs.iter().map(|config| (config, &outcome)).collect());
        let found: Vec<_> =
            choices(&rows).into_iter().map(|one| (one.name, one.rows.0.len())).collect();
        let expected = [("as it is", 2), ("cone compressive", 1), ("stop 0.5", 1)];
        assert_eq!(found, expected.map(|(name, count)| (name.to_owned(), count)));
    }
}
