//! Writes `report.json` of a sweep: the mean slumps over initial states, and the effect of each varied setting on the
//! slump as a mean difference between runs from the same initial state, together with the program, the machine, the
//! date and the command.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::drawing::sheet;
use super::plan::{SEED, Study};
use super::results::{RunResult, RunsTable, Status};
use super::run_group::RunGroup;
use crate::error::{Error, Result};
use crate::harness::{Effort, Machine, write_sheet};
use crate::output::write_file;
use crate::solver::worst;
use crate::statistics::mean;

pub(super) const REPORT: &str = "report.json";
const CHART: &str = "chart";

#[derive(Serialize)]
struct SweepReport<'a> {
    program: &'static str,
    #[serde(flatten)]
    machine: &'a Machine,
    study: &'a str,
    runs: usize,
    core_secs: f64,
    groups: Vec<RunGroup>,
}

/// Writes the report of a completed study, and its chart if the study file describes a chart. `version` is the version
/// of the program that both name.
///
/// # Errors
/// If a file cannot be written.
pub fn write_means(study: &Study, table: &RunsTable, folder: &Path, version: &str) -> Result<()> {
    let machine = Machine::this(version)?;
    let groups = groups(study, table)?;
    if let Some(chart) = &study.chart {
        let sheet = sheet(chart, &groups, &machine, Effort::new(study.is_quick_pass));
        write_sheet(folder, CHART, &sheet, &machine.command)?;
    }
    let report = SweepReport {
        program: "slump",
        machine: &machine,
        study: &study.name,
        runs: table.rows.len(),
        core_secs: table.wall_secs.iter().sum(),
        groups,
    };
    let path = folder.join(REPORT);
    let json = serde_json::to_string_pretty(&report).map_err(|error| Error::file(&path, error))?;
    write_file(&path, format!("{json}\n").as_bytes())
}

struct Run<'a> {
    seed: Option<u64>,
    result: &'a RunResult,
    secs: f64,
}

fn groups(study: &Study, table: &RunsTable) -> Result<Vec<RunGroup>> {
    let varied = || study.varied.iter().flatten().filter(|name| *name != SEED);
    let mut order: Vec<Vec<Value>> = Vec::new();
    let mut runs: HashMap<String, Vec<Run<'_>>> = HashMap::new();
    for ((key, config, result), secs) in table.rows.iter().zip(&table.wall_secs) {
        let settings = serde_json::to_value(config)
            .map_err(|error| Error::value("config", key, error.to_string()))?;
        let values: Vec<Value> = varied().map(|name| settings[name.as_str()].clone()).collect();
        let group = runs.entry(words(&values)).or_default();
        if group.is_empty() {
            order.push(values);
        }
        group.push(Run { seed: config.source.seed, result, secs: *secs });
    }
    let is_sound = |result: &RunResult| result.status == Status::Done && result.lost_grains == 0;
    let slumps = |values: &[Value]| -> Vec<(Option<u64>, f64)> {
        let group = runs.get(&words(values)).into_iter().flatten();
        let sound = group.filter(|run| is_sound(run.result));
        sound.map(|run| (run.seed, run.result.slump)).collect()
    };
    let interval = |values: &[f64]| {
        let mean = mean(values);
        [if values.is_empty() { f64::NAN } else { mean.mean }, mean.high - mean.mean]
    };
    let group = |values: &Vec<Value>| {
        let here = slumps(values);
        let mut less_first = BTreeMap::new();
        let mut at = 0;
        for list in &study.varied {
            let names: Vec<&str> =
                list.iter().map(String::as_str).filter(|name| *name != SEED).collect();
            let (begin, end) = (at, at + names.len());
            at = end;
            let mut first = values.clone();
            first[begin..end].clone_from_slice(&order[0][begin..end]);
            if first == *values {
                continue;
            }
            let there: HashMap<_, _> = slumps(&first).into_iter().collect();
            let pairs = here.iter().filter_map(|(seed, slump)| Some(slump - there.get(seed)?));
            let pairs: Vec<f64> = pairs.collect();
            if !pairs.is_empty() {
                less_first.insert(names[0].to_owned(), interval(&pairs));
            }
        }
        let all = &runs[&words(values)];
        let tallies = || all.iter().map(|run| &run.result.tally);
        let steps: u64 = tallies().map(|tally| tally.steps).sum();
        let unsolved: u64 = tallies().map(|tally| tally.unconverged_steps).sum();
        RunGroup {
            settings: varied().cloned().zip(values.iter().cloned()).collect(),
            starts: here.len(),
            spoilt: all.len() - here.len(),
            slump: interval(&here.iter().map(|(_, slump)| *slump).collect::<Vec<_>>()),
            less_first,
            unsolved: unsolved as f64 / steps.max(1) as f64,
            largest_velocity_error: tallies()
                .map(|tally| tally.largest_velocity_error)
                .fold(0.0, worst),
            mean_overlap: tallies().map(|tally| tally.mean_overlap).fold(0.0, worst),
            secs: all.iter().map(|run| run.secs).sum::<f64>() / all.len() as f64,
        }
    };
    Ok(order.iter().map(group).collect())
}

fn words(values: &[Value]) -> String {
    Value::from(values.to_vec()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the groups of runs of a study of the pile with made-up results, for tests. The study varies the settings
    /// in `vary`. `slump` returns the slump of the run with a given number. In run number `spoil`, a grain has left the
    /// scene.
    fn reported(vary: &str, slump: impl Fn(usize) -> f64, spoil: Option<usize>) -> Vec<RunGroup> {
        let text = format!("name = \"made\"\n[base]\nscene = \"pile\"\n[vary]\n{vary}");
        let study = Study::parse(&text, "made.toml".as_ref(), false).expect("a study");
        let rows = study.runs.iter().enumerate().map(|(number, run)| {
            let mut result = RunResult::of_slump(slump(number));
            if spoil == Some(number) {
                result.lost_grains = 1;
                result.tally.largest_velocity_error = f64::NAN;
            }
            (run.key.clone(), run.config.clone(), result)
        });
        let table = RunsTable { rows: rows.collect(), wall_secs: vec![2.0; study.runs.len()] };
        groups(&study, &table).expect("groups")
    }

    #[test]
    fn means_are_over_seeds_and_differences_are_taken_seed_by_seed_from_the_first_value() {
        // In the made-up results, the slump differs by 0.1 from seed to seed. The larger Δt adds 0.02 to 0.022, which
        // is only visible in paired differences.
        let vary = "bond = [0, 20]\ndt = [1e-3, 5e-3]\nseed = [4, 5, 6]\n";
        let slump = |run: usize| {
            let (seed, dt, bond) = (run % 3, run / 3 % 2, run / 6);
            0.1 * seed as f64 + 0.02 * dt as f64 + 0.3 * bond as f64 + 0.001 * (dt * seed) as f64
        };
        let groups = reported(vary, slump, None);
        assert_eq!(groups.len(), 4);
        let [mean, half] = groups[0].slump;
        // From tables of Student's distribution: t(0.975; 2) = 4.302653. The standard error is 0.1/√3.
        let expected = 4.302_653 * 0.1 / 3f64.sqrt();
        assert!((mean - 0.1).abs() < 1e-12 && (half - expected).abs() < 1e-6);
        assert!(groups[0].less_first.is_empty());
        let [mean, half] = groups[3].less_first["dt"];
        assert!((mean - 0.021).abs() < 1e-12 && half < 0.003, "{mean} {half}");
        let [mean, ..] = groups[3].less_first["bond"];
        assert!((mean - 0.3).abs() < 1e-12);
        assert_eq!(groups[3].settings["dt"], 5e-3);
        assert_eq!((groups[3].starts, groups[3].secs), (3, 2.0));
    }

    #[test]
    fn a_run_that_lost_a_grain_has_no_part_in_means_and_pairs() {
        let vary = "dt = [1e-3, 5e-3]\nseed = [4, 5, 6]\n";
        let slump = |run: usize| if run == 1 { 1e3 } else { run as f64 };
        let groups = reported(vary, slump, Some(1));
        assert_eq!((groups[0].starts, groups[0].spoilt, groups[0].slump[0]), (2, 1, 1.0));
        assert_eq!(groups[1].starts, 3);
        assert_eq!(groups[1].less_first["dt"][0], 3.0);
    }

    #[test]
    fn where_no_run_has_a_slump_or_a_finite_state_none_is_told() {
        let groups = reported("bond = [0, 20]\n", |run| run as f64, Some(0));
        let json = serde_json::to_value(&groups[0]).expect("JSON");
        assert!(groups[0].starts == 0 && json["slump"][0].is_null(), "{json}");
        assert!(json["largest_velocity_error"].is_null(), "{json}");
        assert_eq!((groups[1].slump[0], groups[1].largest_velocity_error), (1.0, 0.0));
    }

    #[test]
    fn choices_that_go_with_a_seed_are_told_apart_and_one_start_has_no_interval() {
        let vary = "\"grains box-width seed\" = [[138, 16, 4], [138, 16, 5], [500, 30, 6]]\n";
        let groups = reported(vary, |run| run as f64, None);
        assert_eq!(groups.iter().map(|group| group.starts).collect::<Vec<_>>(), [2, 1]);
        assert!(groups[1].slump[1].is_infinite() && groups[1].less_first.is_empty());
        let json = serde_json::to_value(&groups[1]).expect("JSON");
        assert!(json["slump"][1].is_null(), "{json}");
    }
}
