//! Compares simulations with published experiments. For each chosen solver method, time step and effort (number of
//! sweeps or tolerance), it measures published quantities with confidence intervals, judges whether they agree with the
//! publications, and reports the computing time.
//!
//! Each experiment has one file and one row in [`EXPERIMENTS`]. A verdict compares the whole measured interval with a
//! band around the published value. The quantity agrees if the interval lies inside the band, differs if the interval
//! lies outside the band, and is not decided otherwise. Published numbers that were written down from memory and not
//! looked up are marked as such and have wide bands.
//!
//! The folder of results contains `report.md`, `quantities.csv`, a figure (`errors.png`, `.svg`, `.csv`), and the
//! folder `measured/`. In `measured/`, each build of the program and each processor has its own journals of finished
//! runs. If a command is stopped, the same command resumes its work from these journals.

mod cliff;
mod cohesive_cooling;
mod cohesive_shear;
mod collapse;
mod cooling;
mod elasticity;
mod experiment;
mod fit;
mod janssen;
mod packing;
mod report;
mod repose;
mod runs;
mod shear;
mod silo;
mod surface;
mod three_cohesions;
mod variants;
mod watched;
mod weak_cohesion;

use std::path::PathBuf;
use std::time::Instant;

use clap::builder::PossibleValuesParser;

use self::experiment::{Experiment, ExperimentCases};
use self::runs::run_all;
use self::variants::step_variants;
use crate::config::parser_of;
use crate::error::Result;
use crate::harness::{Bench, Effort};
use crate::output::print_text;
use crate::sim::Stepper;
use crate::solver::Method;

/// All experiments (comparisons with publications), in the order of the report.
static EXPERIMENTS: [Experiment; 13] = [
    elasticity::EXPERIMENT,
    cooling::EXPERIMENT,
    cohesive_cooling::EXPERIMENT,
    packing::EXPERIMENT,
    collapse::EXPERIMENT,
    cliff::EXPERIMENT,
    silo::EXPERIMENT,
    repose::EXPERIMENT,
    shear::EXPERIMENT,
    cohesive_shear::EXPERIMENT,
    weak_cohesion::EXPERIMENT,
    three_cohesions::EXPERIMENT,
    janssen::EXPERIMENT,
];

/// Options of a comparison with published experiments.
#[derive(clap::Args, Clone, Debug)]
pub struct ValidateOptions {
    /// Experiments [default: all]
    #[arg(value_name = "EXPERIMENT", value_parser = PossibleValuesParser::new(experiment_names()))]
    pub experiments: Vec<String>,
    /// Folder for report, tables and figure; the same command continues where it stopped
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Fewer and smaller systems, in a few minutes
    #[arg(long)]
    pub quick: bool,
    /// Stepper of all experiments; experiments about methods run only with moreau
    #[arg(long, value_name = "NAME", default_value = "moreau", value_parser = parser_of::<Stepper>())]
    pub stepper: Stepper,
    /// Methods, each with every time step and effort [default: auto, to a velocity error of 1e-4; nsgs if an effort is given]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = parser_of::<Method>())]
    pub methods: Vec<Method>,
    /// Time steps, seconds [default: 1e-3]
    #[arg(long = "time-steps", value_name = "SECONDS", value_delimiter = ',')]
    pub time_steps_secs: Vec<f64>,
    /// Efforts: fixed numbers of sweeps per step [default: 20 and 100 if no tolerance is given; none for auto]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub sweeps: Vec<u32>,
    /// Efforts: residuals to which each step is solved, within 1,000 sweeps
    #[arg(long, value_name = "X", value_delimiter = ',')]
    pub tolerances: Vec<f64>,
}

fn experiment_names() -> Vec<&'static str> {
    EXPERIMENTS.iter().map(|experiment| experiment.name).collect()
}

/// Runs the chosen experiments and writes the results to a folder. `version` is the version of the program that the
/// report names.
///
/// # Errors
/// If a value is outside its range, the folder cannot be written, or a scene is invalid.
pub fn validate(options: &ValidateOptions, version: &str) -> Result<()> {
    let started = Instant::now();
    let ValidateOptions { experiments, out, quick, stepper, .. } = options;
    let ValidateOptions { methods, time_steps_secs, sweeps, tolerances, .. } = options;
    let effort = Effort::new(*quick);
    let variants = step_variants(*stepper, methods, time_steps_secs, sweeps, tolerances)?;
    let wanted: Vec<&'static Experiment> = EXPERIMENTS
        .iter()
        .filter(|one| experiments.is_empty() || experiments.iter().any(|name| name == one.name))
        .filter(|one| {
            *stepper == Stepper::Moreau || matches!(one.cases, ExperimentCases::Chosen(_))
        })
        .collect();
    let bench = Bench::new(out, effort, version)?;
    let ran = run_all(&wanted, &variants, effort, &bench.runner("validation")?)?;
    let machine = bench.machine.words();
    let sheet = report::sheet(&ran, &machine);
    bench.write(("errors", &sheet), [&report::table(&ran)], &bench.machine.command)?;
    let text = report::markdown(&ran, effort, &machine, started.elapsed().as_secs_f64());
    print_text(&text);
    bench.finish("report.md", &text)
}
