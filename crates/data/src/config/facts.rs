//! Collects the metadata that are written into the files of a recorded run: all values of the scene, and all changes of
//! settings during the run.

use serde::Serialize;
use serde_json::{Map, Value as Json, json};

use crate::data::RunFacts;
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::Settings;

/// Names of the fields of a scene that are not written as metadata of a recording. The grains (`grains`) and fixed
/// discs (`fixed_discs`) are in the tables of the recording. `source` says from which file the grains were read, or how
/// their pile was made. `data` has the options of the recording.
const LEFT_OUT: [&str; 4] = ["grains", "fixed_discs", "source", "data"];

/// Name of the metadata entry that lists the changes of settings during the run.
const CHANGES: &str = "changes";

/// Returns the metadata of a recording: the program's name and version, followed by all values of the scene except its
/// discs.
///
/// # Errors
/// If a value cannot be written as JSON.
pub fn scene_facts(scene: &Scene) -> Result<RunFacts> {
    let program = concat!("slump ", env!("CARGO_PKG_VERSION"));
    let mut facts = vec![("program".to_owned(), program.to_owned())];
    facts.extend(
        values_of(scene, scene)?.iter().map(|(name, value)| (name.clone(), one_line(value))),
    );
    let weightless = scene.grains.iter().filter(|grain| !grain.feels_gravity).count();
    if weightless > 0 {
        let said = format!(
            "{weightless} of {} grains: gravity does not act on them, and is the scale of Bond alone",
            scene.grains.len()
        );
        facts.push(("weightless".to_owned(), said));
    }
    Ok(RunFacts { facts })
}

/// Returns the metadata of a recorded run: the values of its scene, and the changes of its settings during the run.
/// Each element of `changes` has the number of the step after which the settings changed, the simulated time of that
/// step in seconds, and the new settings. Settings that did not change are not written.
///
/// # Errors
/// If a value cannot be written as JSON.
pub fn run_facts(scene: &Scene, changes: &[(u64, f64, Settings)]) -> Result<RunFacts> {
    let mut run = scene_facts(scene)?;
    let mut told = Vec::new();
    let mut before = values_of(scene, &all_settings(&scene.settings()))?;
    for (after_step, time_secs, settings) in changes {
        let after = values_of(scene, &all_settings(settings))?;
        let others = after.iter().filter(|&(name, value)| before.get(name) != Some(value));
        let others: Map<_, _> = others.map(|(name, it)| (name.clone(), it.clone())).collect();
        if !others.is_empty() {
            let mut change = json!({ "after_step": after_step, "time": time_secs });
            change.as_object_mut().into_iter().for_each(|change| change.extend(others.clone()));
            told.push(change);
        }
        before = after;
    }
    if !told.is_empty() {
        run.facts.push((CHANGES.to_owned(), Json::from(told).to_string()));
    }
    Ok(run)
}

/// Converts `something`, serialisable data of a scene, to values with dotted names such as `parameters.bond`. Fields in
/// [`LEFT_OUT`] are omitted. `scene` is used only for its name in error messages.
fn values_of(scene: &Scene, something: &impl Serialize) -> Result<Map<String, Json>> {
    let said = serde_json::to_value(something)
        .map_err(|error| Error::value("scene", &scene.name, error.to_string()))?;
    let mut values = Map::new();
    for (name, value) in said.as_object().into_iter().flatten() {
        if !LEFT_OUT.contains(&name.as_str()) {
            flatten(name, value, &mut values);
        }
    }
    Ok(values)
}

/// Returns all settings as JSON, including settings that are switched off (scene files omit these).
fn all_settings(settings: &Settings) -> Json {
    let Settings { stepper, parameters, solver, remedies } = settings;
    json!({ "stepper": stepper, "parameters": parameters, "solver": solver, "remedies": remedies })
}

/// Adds a JSON value to `values` under its name. If the value is a JSON object, adds each of its members under a dotted
/// name such as `parameters.bond`.
fn flatten(name: &str, value: &Json, values: &mut Map<String, Json>) {
    match value {
        Json::Object(table) => {
            for (key, value) in table {
                flatten(&format!("{name}.{key}"), value, values);
            }
        }
        other => {
            values.insert(name.to_owned(), other.clone());
        }
    }
}

fn one_line(value: &Json) -> String {
    match value {
        // Line breaks become spaces, because a fact must fit on one comment line.
        Json::String(text) => text.replace(char::is_control, " "),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;
    use crate::sim::Stepper;

    #[test]
    fn every_number_of_a_scene_is_told_by_its_name() {
        let mut scene = built_in("moving-walls").expect("a scene");
        scene.name = "two\nlines".into();
        let facts = scene_facts(&scene).expect("facts").facts;
        let said = |name: &str| {
            facts.iter().find(|(there, _)| there == name).map(|(_, said)| said.as_str())
        };
        assert_eq!(said("name"), Some("two lines"));
        assert_eq!(said("parameters.bond"), Some(&*format!("{:?}", scene.parameters.bond)));
        assert_eq!(said("physics.axes"), Some("2"));
        assert!(said("boundaries").is_some_and(|said| said.contains("piston")));
        assert_eq!(said("grains"), None);
        assert!(facts.iter().all(|(_, said)| !said.contains('\n')));
    }

    #[test]
    fn changes_on_the_way_are_told_one_by_one() {
        let scene = built_in("moving-walls").expect("a scene");
        assert_eq!(run_facts(&scene, &[]).expect("facts"), scene_facts(&scene).expect("facts"));
        let mut settings = scene.settings();
        settings.parameters.bond += 1.0;
        settings.remedies.push_out = true;
        let first = (30, 0.5, settings);
        settings.remedies.push_out = false;
        settings.stepper = Stepper::Range;
        let run = run_facts(&scene, &[first, first, (40, 0.75, settings)]).expect("facts");
        let (name, said) = run.facts.last().expect("a fact");
        assert_eq!(name, "changes");
        let bond = settings.parameters.bond;
        let expected = serde_json::json!([
            { "after_step": 30, "time": 0.5, "parameters.bond": bond, "remedies.push_out": true },
            { "after_step": 40, "time": 0.75, "remedies.push_out": false, "stepper": "range" },
        ]);
        let said: serde_json::Value = serde_json::from_str(said).expect("JSON");
        assert_eq!(said, expected);
    }
}
