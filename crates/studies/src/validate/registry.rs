//! The list of all experiments.

use super::experiment::Experiment;
use super::{
    chain, cliff, cohesive_shear, flow, gas, packing, plane_shear, repose, spread, wall_load,
};

/// All experiments, in the order of the report.
pub(super) static EXPERIMENTS: [Experiment; 10] = [
    chain::EXPERIMENT,
    gas::EXPERIMENT,
    packing::EXPERIMENT,
    spread::EXPERIMENT,
    cliff::EXPERIMENT,
    flow::EXPERIMENT,
    repose::EXPERIMENT,
    plane_shear::EXPERIMENT,
    cohesive_shear::EXPERIMENT,
    wall_load::EXPERIMENT,
];
