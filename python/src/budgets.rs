//! Error budgets for Python: estimates of how much of a result is due to the initial state, the contact law, the time
//! step and the solver.

use std::ops::ControlFlow;
use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::conversion::exception;
use crate::options::{GivenOptions, all_names};
use slump_studies::{BudgetOptions, made_budget};

/// Computes an error budget and returns it as JSON. The options are the options of a simulation. A later call with the
/// same `folder` resumes from the files in this folder.
#[pyfunction]
#[pyo3(signature = (quantities, folder, cost_secs, *, begin=None, end=None, within=None, **options))]
#[expect(clippy::too_many_arguments, reason = "as Python's class gives them")]
pub(crate) fn _budget(
    py: Python<'_>,
    quantities: Vec<String>,
    folder: PathBuf,
    cost_secs: f64,
    begin: Option<f64>,
    end: Option<f64>,
    within: Option<f64>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<String> {
    let mut given = GivenOptions::default();
    given.add_all(options, &all_names())?;
    let options = BudgetOptions {
        config: given.config()?,
        quantities,
        from_secs: begin,
        to_secs: end,
        within,
        cost_secs,
        shard: None,
    };
    let mut interrupted = None;
    let made = py.detach(|| {
        made_budget(&options, &folder, &folder.join("states"), |_| {
            // Checks for Ctrl-C between two stages of the budget.
            match Python::attach(|py| py.check_signals()) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    interrupted = Some(error);
                    ControlFlow::Break(())
                }
            }
        })
    });
    match interrupted {
        Some(error) => Err(error),
        None => made.and_then(|budget| budget.to_json()).map_err(exception),
    }
}
