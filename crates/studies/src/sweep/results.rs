//! Computes the result of one run of a study, and writes `runs.csv`: one row per run, in the order of the study, with
//! the complete settings and the result of the run.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::plan::Study;
use super::series::Series;
use crate::config::Config;
use crate::data::Recording;
use crate::error::{Error, Result};
use crate::harness::FinishedCase;
use crate::number;
use crate::output::write_file;
use crate::scene::Scene;
use crate::sim::{AlarmKind, RunEnding, Simulation, Tally};

/// Status of a run at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The run reached its full duration.
    Done,
    /// Positions or velocities of grains became NaN or infinite, which ended the run.
    NotFinite,
}

/// The result of a run: a row of the study's table. If NaN or infinite positions ended the run early, the numbers are
/// those at its end, and can be NaN or infinite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunResult {
    /// Status of the run at its end.
    pub status: Status,
    /// Statistics of all steps of the run, such as the number of sweeps and the mean overlap.
    #[serde(flatten)]
    pub tally: Tally,
    /// Slump Δy_G at the end: the drop of the mean height, divided by the first mean height (Abramian & Staron 2020,
    /// eq. 11).
    #[serde(with = "number")]
    pub slump: f64,
    /// Gap between the first two grains at the end of the run, in mean diameters; 0 for a single grain.
    #[serde(with = "number")]
    pub first_gap: f64,
    /// Number of grains that went through a wall or left the scene.
    pub lost_grains: u32,
    /// Names of the warnings that the run raised, such as `overlap`, separated by spaces.
    pub alarms: String,
}

impl RunResult {
    /// Names of the columns of `runs.csv` that contain the result of a run.
    const COLUMNS: &str = "status,steps,slump,mean_overlap,max_overlap,mean_contacts,first_gap,\
        unconverged_steps,stalled_steps,sweeps,largest_residual,\
        largest_velocity_error,lost_grains,alarms";

    fn cells(&self) -> impl Serialize + '_ {
        let Self { status, tally, slump, first_gap, lost_grains, alarms } = self;
        (
            status,
            tally.steps,
            slump,
            tally.mean_overlap,
            tally.max_overlap,
            tally.mean_contacts,
            first_gap,
            tally.unconverged_steps,
            tally.stalled_steps,
            tally.sweeps,
            tally.largest_residual,
            tally.largest_velocity_error,
            lost_grains,
            alarms,
        )
    }
}

/// A finished run of a sweep, as one line of the journal (file of results) stores it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SweptRun {
    pub outcome: RunResult,
    /// Checksum of the file with the run's time series, if the run has such a file.
    #[serde(rename = "course", default, skip_serializing_if = "Option::is_none")]
    pub series: Option<String>,
}

#[cfg(test)]
impl RunResult {
    /// Returns the made-up result of a run that ended without failure and has this slump, for tests.
    pub(crate) fn of_slump(slump: f64) -> Self {
        let tally = Tally { steps: 1, sweeps: 1, ..Tally::default() };
        let (status, alarms) = (Status::Done, String::new());
        Self { status, tally, slump, first_gap: 0.0, lost_grains: 0, alarms }
    }
}

pub(super) fn run_to_end(
    scene: &Scene,
    mut series: Option<&mut Series<'_>>,
    mut recording: Option<&mut Recording>,
) -> Result<RunResult> {
    let mut simulation = scene.simulation()?;
    let steps = scene.parameters.steps_in(scene.duration_secs);
    let mut tally = Tally::default();
    let mut record = |simulation: &Simulation, is_step: bool| -> Result<()> {
        if let Some(series) = &mut series {
            series.add_if_due(simulation)?;
        }
        let Some(recording) = &mut recording else { return Ok(()) };
        if is_step {
            recording.add_step(simulation.observables())?;
        }
        recording.add_if_due(simulation)
    };
    record(&simulation, false)?;
    let ended = simulation.run(steps, |simulation| {
        tally.add(simulation.observables());
        record(simulation, true)?;
        Ok(ControlFlow::Continue(()))
    })?;
    let status = match ended {
        RunEnding::NotFinite(_) => {
            tally.add(simulation.observables());
            if let Some(recording) = recording {
                recording.add_step(simulation.observables())?;
            }
            Status::NotFinite
        }
        RunEnding::Done | RunEnding::Stopped => Status::Done,
    };
    let observables = simulation.observables();
    let raised: Vec<AlarmKind> = simulation.alarms().iter().map(|alarm| alarm.kind).collect();
    let kinds = AlarmKind::ALL.iter().filter(|kind| raised.contains(kind));
    Ok(RunResult {
        status,
        tally,
        slump: observables.slump,
        first_gap: first_gap(&simulation),
        lost_grains: observables.lost_grains,
        alarms: kinds.map(|kind| kind.name()).collect::<Vec<_>>().join(" "),
    })
}

fn first_gap(simulation: &Simulation) -> f64 {
    let grains = &simulation.world().grains;
    match (&grains.positions[..], &grains.radii[..]) {
        ([i, j, ..], [r_i, r_j, ..]) => {
            (i.distance(*j) - (r_i + r_j)) / simulation.world().mean_diameter
        }
        _ => 0.0,
    }
}

/// The table of the results of a study.
#[derive(Clone, Debug)]
pub struct RunsTable {
    /// Key, settings and result of each run, in the order of the study.
    pub rows: Vec<(String, Config, RunResult)>,
    /// Wall-clock time of each run, s. The CSV file does not contain this time, because it differs between repetitions.
    pub wall_secs: Vec<f64>,
}

impl RunsTable {
    pub(super) fn new(
        study: &Study,
        finished: &HashMap<String, FinishedCase<SweptRun>>,
    ) -> Result<Self> {
        let mut rows = Vec::with_capacity(study.runs.len());
        let mut wall_secs = Vec::with_capacity(study.runs.len());
        for run in &study.runs {
            if let Some(case) = finished.get(&run.key) {
                wall_secs.push(case.wall_secs);
                rows.push((run.key.clone(), run.config.clone(), case.result.outcome.clone()));
            }
        }
        let (done, all) = (rows.len(), study.runs.len());
        if done < all {
            let allowed = "complete; run the sweep or its missing parts again";
            return Err(Error::value(&study.name, format!("{done} of {all} runs"), allowed));
        }
        Ok(Self { rows, wall_secs })
    }

    /// Returns the number of runs that ended early because positions or velocities became NaN or infinite.
    pub fn not_finite(&self) -> usize {
        self.rows.iter().filter(|(.., result)| result.status == Status::NotFinite).count()
    }

    /// Returns a phrase with the number of runs that raised warnings, in total and for each kind of warning; `None` if
    /// no run raised a warning.
    pub fn alarms(&self) -> Option<String> {
        alarms_of(self.rows.iter().map(|(.., result)| result))
    }

    /// Writes the table of a study as CSV. Numbers have enough digits that reading them gives the same bits.
    pub(super) fn write(&self, path: &Path) -> Result<()> {
        let refuse = |error: csv::Error| Error::file("runs.csv", error);
        let fields = Config::names();
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        let fixed = ["run", "key"].into_iter().chain(fields.iter().map(String::as_str));
        writer.write_record(fixed.chain(RunResult::COLUMNS.split(','))).map_err(refuse)?;
        for (number, (key, config, result)) in self.rows.iter().enumerate() {
            let settings = serde_json::to_value(config)
                .map_err(|error| Error::value("config", key, error.to_string()))?;
            let cell = |field: &String| match settings.get(field) {
                None | Some(Value::Null) => String::new(),
                Some(Value::String(text)) => text.clone(),
                Some(other) => other.to_string(),
            };
            let settings: Vec<String> = fields.iter().map(cell).collect();
            writer.serialize((number, key, settings, result.cells())).map_err(refuse)?;
        }
        let bytes = writer.into_inner().map_err(|error| Error::file("runs.csv", error.error()))?;
        write_file(path, &bytes)
    }
}

/// Returns a phrase with the number of runs that raised warnings, such as "3 of 40 runs raised alarms (overlap 2,
/// grain-lost 1)". Returns `None` if no run raised a warning.
pub(crate) fn alarms_of<'a>(results: impl Iterator<Item = &'a RunResult>) -> Option<String> {
    let (mut all, mut alarmed, mut by_kind) = (0, 0, [0; AlarmKind::ALL.len()]);
    for result in results {
        all += 1;
        alarmed += u32::from(!result.alarms.is_empty());
        for (count, kind) in by_kind.iter_mut().zip(AlarmKind::ALL) {
            *count += u32::from(result.alarms.split(' ').any(|name| name == kind.name()));
        }
    }
    let counts = AlarmKind::ALL.iter().zip(by_kind).filter(|(_, count)| *count > 0);
    let counts: Vec<_> = counts.map(|(kind, count)| format!("{} {count}", kind.name())).collect();
    let counts = counts.join(", ");
    (alarmed > 0).then(|| format!("{alarmed} of {all} runs raised alarms ({counts})"))
}
