//! The part of the Python package `slump` that is compiled: a simulation as a class, problems solved alone,
//! and what there is to choose from. What a user sees of it is told in `slump/_slump.pyi`.

#![warn(unreachable_pub)]

mod arrays;
mod beginning;
mod errors;
mod forks;
mod initial;
mod json;
mod lists;
mod options;
mod problems;
mod run;
mod simulation;
mod stepping;
mod views;

use pyo3::prelude::*;

#[pymodule]
mod _slump {
    #[pymodule_export]
    use super::beginning::scene_as_data;
    #[pymodule_export]
    use super::lists::{_kinds, methods, options, scenes, steppers};
    #[pymodule_export]
    use super::problems::solve;
    #[pymodule_export]
    use super::simulation::Simulation;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::forks::remember_this_process();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
