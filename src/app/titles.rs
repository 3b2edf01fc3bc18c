//! Titles of worlds (simulations side by side). Each title names the settings in which its world differs from the
//! others.

use super::budget::BUDGETS;
use super::number_text::{clock_text, written};
use super::setting_control::called;
use crate::number::millis_text;
use crate::setting::Value;
use crate::sim::Settings;

/// Names of settings that usually change together with other settings. A title omits them unless nothing else differs.
const FOLLOWING: [&str; 2] = ["stop", "tolerance"];
/// Names of settings that change together with the solver; a title that names the solver omits them.
const FOLLOWING_METHOD: [&str; 2] = ["friction-model", "model-solves"];

/// Returns the title of a simulation: all settings in which any two simulations differ, with the values of this
/// simulation. If the simulations do not differ, the title is Bond and Δt.
pub(super) fn title_among(worlds: &[Settings], index: usize) -> String {
    let Some(settings) = worlds.get(index) else { return String::new() };
    let any_differs = |name: &&str| worlds.iter().any(|one| one.get(name) != settings.get(name));
    let names = || Settings::about().map(|about| about.name).filter(any_differs);
    let differs_in_method = any_differs(&"solver");
    let follows = |name: &str| {
        FOLLOWING.contains(&name) || (differs_in_method && FOLLOWING_METHOD.contains(&name))
    };
    let mut told: Vec<&str> = names().filter(|name| !follows(name)).collect();
    if told.is_empty() {
        told = names().collect();
    }
    if told.is_empty() {
        told = vec!["bond", "dt"];
    }
    // A solver whose settings are those of a preset has the name of the preset.
    let named =
        BUDGETS.iter().find(|budget| differs_in_method && budget.settings == settings.solver);
    let is_told = |name: &&str| named.is_none() || !["solver", "max-sweeps"].contains(name);
    let said = told.into_iter().filter(is_told).filter_map(|name| said(settings, name));
    let all: Vec<String> =
        named.map(|budget| budget.name.to_owned()).into_iter().chain(said).collect();
    all.join(", ")
}

/// Returns the caption of a simulation in a picture: its number if there are several simulations, its title, Bond, Δt
/// and the simulated time.
pub(super) fn caption(worlds: &[Settings], index: usize, time_secs: f64) -> String {
    let Some(settings) = worlds.get(index) else { return String::new() };
    let mut text = title_among(worlds, index);
    for said in ["bond", "dt"].into_iter().filter_map(|name| said(settings, name)) {
        if !text.contains(&said) {
            text += &format!(", {said}");
        }
    }
    let number = if worlds.len() > 1 { format!("{}: ", index + 1) } else { String::new() };
    format!("{number}{text}, t = {}", clock_text(time_secs))
}

/// Returns the settings in which `one` differs from `other`, with the values in `one`, as a text such as "Bond 20".
pub(super) fn title_against(one: &Settings, other: &Settings) -> String {
    title_among(&[*one, *other], 0)
}

/// Returns the text of a change of settings, such as "Bond 20 → 50".
pub(super) fn change_text(before: &Settings, after: &Settings) -> String {
    let (from, to) = (title_against(before, after), title_against(after, before));
    let symbol = from.split_inclusive(' ').next().unwrap_or_default();
    let is_one = !from.contains(", ") && symbol.ends_with(' ');
    format!("{from} → {}", to.strip_prefix(symbol).filter(|_| is_one).unwrap_or(&to))
}

/// Returns the names and values of the settings `names` as one text.
pub(super) fn settings_text(settings: &Settings, names: &[&str]) -> String {
    let all: Vec<String> = names.iter().filter_map(|name| said(settings, name)).collect();
    all.join(", ")
}

/// Returns the name and value of a setting for a title, such as "Bond 20".
fn said(settings: &Settings, name: &str) -> Option<String> {
    let about = Settings::about().find(|about| about.name == name)?;
    let (symbol, unit) = (called(about), about.control.map_or("", |control| control.unit));
    Some(match (name, settings.get(name)?) {
        ("stepper" | "solver" | "friction-model", Value::Word(word)) => word.to_owned(),
        ("model-solves", Value::Count(count)) => format!("{count} solves"),
        ("max-sweeps", Value::Count(count)) => format!("{count} sweeps"),
        (_, Value::Number(secs)) if unit == "s" => format!("{symbol} {}", millis_text(secs)),
        (_, Value::Number(number)) => {
            format!("{symbol} {} {unit}", written(number)).trim_end().to_owned()
        }
        (_, Value::Count(count)) => format!("{symbol} {count}"),
        (_, Value::Switch(on)) => format!("{} {name}", if on { "with" } else { "without" }),
        (_, Value::Word(word)) => format!("{name} {word}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_say_bond_time_step_and_time() {
        let base = Settings::default().with_bond(20.0).over(1e-3);
        let of = |all: &[Settings]| {
            (0..all.len()).map(|index| caption(all, index, 0.25)).collect::<Vec<_>>()
        };
        assert_eq!(of(&[base]), ["Bond 20, Δt 1 ms, t = 250.0 ms"]);
        assert_eq!(
            of(&[base, base.over(5e-3)]),
            ["1: Δt 1 ms, Bond 20, t = 250.0 ms", "2: Δt 5 ms, Bond 20, t = 250.0 ms"]
        );
    }

    #[test]
    fn a_change_says_what_it_changes_once() {
        let base = Settings::default().with_bond(20.0).over(1e-3);
        assert_eq!(change_text(&base, &base.over(3e-4)), "Δt 1 ms → 0.3 ms");
        assert_eq!(change_text(&base, &base.with_bond(50.0)), "Bond 20 → 50");
        let both = change_text(&base, &base.with_bond(50.0).over(1e-4));
        assert_eq!(both, "Bond 20, Δt 1 ms → Bond 50, Δt 0.1 ms");
        let range = Settings { stepper: crate::sim::Stepper::Range, ..base };
        assert_eq!(change_text(&base, &range), "moreau → range");
    }
}
