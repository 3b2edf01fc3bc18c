//! The compiled part of the Python package `slump`: the class of a simulation, functions that solve single contact
//! problems, and lists of the available scenes, solvers and options. `slump/_slump.pyi` describes its interface.

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
