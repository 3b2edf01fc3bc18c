//! What one run of a study comes to.

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use super::SeriesSettings;
use super::alarms::Alarms;
use crate::data::Recording;
use crate::error::{Error, Result};
use crate::number;
use crate::scene::Scene;
use crate::sim::{RunEnding, Simulation, Tally};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// At its full duration.
    Done,
    /// Its state was no longer finite.
    NotFinite,
}

/// What a run comes to. A row of the study's table. Numbers of a run whose state was no longer finite
/// are those that it ended with, finite or not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Steps taken.
    pub steps: u64,
    /// Δy_G at the end (paper eq. 11).
    #[serde(with = "number")]
    pub slump: f64,
    /// Mean over the steps of the mean overlap, in diameters.
    #[serde(with = "number")]
    pub mean_overlap: f64,
    /// Largest overlap of any contact in any step, in diameters.
    #[serde(with = "number")]
    pub max_overlap: f64,
    /// Mean over the steps of the number of contacts.
    #[serde(with = "number", default)]
    pub mean_contacts: f64,
    /// Gap between the first two grains at the end, in diameters; 0 where there is one grain.
    #[serde(with = "number")]
    pub first_gap: f64,
    /// Steps whose stopping test was not met.
    pub unconverged_steps: u64,
    /// Those of them that had stalled.
    #[serde(default)]
    pub stalled_steps: u64,
    /// Those of them that were solved under bounds of friction instead.
    #[serde(default)]
    pub fallback_steps: u64,
    /// Sweeps of all steps.
    pub sweeps: u64,
    /// Largest common residual of any step.
    #[serde(with = "number")]
    pub largest_residual: f64,
    /// Grains that went through a wall or left the world.
    pub lost_grains: u32,
    /// The kinds of alarms that it raised.
    pub alarms: Alarms,
}

#[cfg(test)]
impl Outcome {
    /// Of a run of which all is well, for tests.
    pub(crate) fn of_slump(slump: f64) -> Self {
        Self {
            status: Status::Done,
            steps: 1,
            slump,
            mean_overlap: 0.0,
            max_overlap: 0.0,
            mean_contacts: 0.0,
            first_gap: 0.0,
            unconverged_steps: 0,
            stalled_steps: 0,
            fallback_steps: 0,
            sweeps: 1,
            largest_residual: 0.0,
            lost_grains: 0,
            alarms: Default::default(),
        }
    }
}

/// Takes a scene to its end. With `series`, `row` is called at the start and then at every interval.
///
/// # Errors
/// Where the scene is not sound, the recording cannot be written, or `row` says so. A state that is no longer finite is an outcome.
pub(crate) fn run_to_end(
    scene: &Scene,
    series: Option<&SeriesSettings>,
    mut row: impl FnMut(&Simulation) -> Result<()>,
    mut recording: Option<&mut Recording>,
) -> Result<Outcome> {
    let mut simulation = scene.simulation()?;
    let time_step_secs = scene.parameters.time_step_secs;
    let steps = scene.parameters.steps_in(scene.duration_secs);
    let mut tally = Tally::default();
    let mut rows = 0;
    // The row of a moment is that of the first step that reaches it, but for rounding.
    let mut tell = |simulation: &Simulation| {
        let Some(series) = series else { return Ok(()) };
        let reached = simulation.time_secs() + 1e-6 * time_step_secs;
        if reached < f64::from(rows) * series.interval {
            return Ok(());
        }
        rows = 1 + (reached / series.interval) as u32;
        row(simulation)
    };
    tell(&simulation)?;
    if let Some(recording) = &mut recording {
        recording.add_if_due(&simulation)?;
    }
    let ended = simulation.run(steps, |simulation| {
        tally.add(simulation.observables());
        tell(simulation)?;
        if let Some(recording) = &mut recording {
            recording.add_step(simulation.observables())?;
            recording.add_if_due(simulation)?;
        }
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
    Ok(outcome_of(status, &tally, &simulation))
}

/// What a run that has ended so comes to.
fn outcome_of(status: Status, tally: &Tally, simulation: &Simulation) -> Outcome {
    Outcome {
        status,
        steps: tally.steps,
        slump: simulation.observables().slump,
        mean_overlap: tally.mean_overlap,
        max_overlap: tally.max_overlap,
        mean_contacts: tally.mean_contacts,
        first_gap: first_gap(simulation),
        unconverged_steps: tally.unconverged_steps,
        stalled_steps: tally.stalled_steps,
        fallback_steps: tally.fallback_steps,
        sweeps: tally.sweeps,
        largest_residual: tally.largest_residual,
        lost_grains: simulation.observables().lost_grains,
        alarms: simulation.alarms().iter().map(|alarm| alarm.kind).collect(),
    }
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

/// One row of a run's series as CSV cells: the observables and the chosen grains' places.
pub(super) fn series_cells(simulation: &Simulation, grains: &[usize]) -> Result<Vec<String>> {
    let mut cells = cells_of(simulation.observables())?;
    let positions = &simulation.world().grains.positions;
    cells.extend(
        grains
            .iter()
            .flat_map(|&grain| [positions[grain].x.to_string(), positions[grain].y.to_string()]),
    );
    Ok(cells)
}

/// The names of [`series_cells`].
pub(super) fn series_names(simulation: &Simulation, grains: &[usize]) -> Result<Vec<String>> {
    let mut names = names_of(simulation.observables())?;
    names.extend(grains.iter().flat_map(|grain| [format!("x{grain}"), format!("y{grain}")]));
    Ok(names)
}

/// The fields of a flat structure, as the cells of a CSV row.
pub(super) fn cells_of(row: &impl Serialize) -> Result<Vec<String>> {
    csv_lines(row, false)
}

/// The names of the fields of a flat structure.
pub(super) fn names_of(row: &impl Serialize) -> Result<Vec<String>> {
    csv_lines(row, true)
}

fn csv_lines(row: &impl Serialize, header: bool) -> Result<Vec<String>> {
    let refuse = |reason: String| Error::value("row", reason, "a flat structure");
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(row).map_err(|error| refuse(error.to_string()))?;
    let bytes = writer.into_inner().map_err(|error| refuse(error.error().to_string()))?;
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(&bytes[..]);
    let line = reader.records().nth(usize::from(!header));
    let record = line.transpose().map_err(|error| refuse(error.to_string()))?;
    Ok(record.iter().flatten().map(str::to_owned).collect())
}
