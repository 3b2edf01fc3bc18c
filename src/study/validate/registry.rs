//! The list of all experiments.

use super::experiment::Experiment;
use super::{chain, cliff, flow, gas, packing, repose, spread};

/// All experiments, in the order of the report.
pub(super) static EXPERIMENTS: [Experiment; 7] = [
    chain::EXPERIMENT,
    gas::EXPERIMENT,
    packing::EXPERIMENT,
    spread::EXPERIMENT,
    cliff::EXPERIMENT,
    flow::EXPERIMENT,
    repose::EXPERIMENT,
];
