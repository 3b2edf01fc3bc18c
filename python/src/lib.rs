//! The part of the Python package `slump` that is compiled: a simulation as a class, problems solved alone,
//! and what there is to choose from. What a user sees of it is told in `slump/_slump.pyi`.

#![warn(unreachable_pub)]

mod budgets;
mod conversion;
mod options;
mod problems;
mod run;
mod simulation;
mod start;
mod stepping;
mod views;

use pyo3::prelude::*;

#[pymodule]
mod _slump {
    #[pymodule_export]
    use super::budgets::_budget;
    #[pymodule_export]
    use super::options::{_kinds, methods, options, scenes, steppers};
    #[pymodule_export]
    use super::problems::{solutions, solve};
    #[pymodule_export]
    use super::simulation::{_restored, Simulation};
    #[pymodule_export]
    use super::start::scene_as_data;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::stepping::remember_this_process();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
