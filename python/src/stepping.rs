//! Many steps in a row, without Python's lock: other threads run meanwhile, and Ctrl-C is heeded.

use std::ffi::CString;

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::errors::{SlumpWarning, exception, refused};
use crate::forks::shared_out;
use crate::simulation::Simulation;
use slump_core::sim::AlarmKind;

/// Takes so many steps, and calls `callback` with the simulation after each `every` of them.
///
/// # Errors
/// What a step or the callback fails with, or that Ctrl-C was pressed. All steps until then were taken.
pub(crate) fn take_steps(
    simulation: &Bound<'_, Simulation>,
    steps: u64,
    callback: Option<&Bound<'_, PyAny>>,
    every: i64,
) -> PyResult<()> {
    let py = simulation.py();
    let every = u64::try_from(every)
        .ok()
        .filter(|&every| every > 0)
        .ok_or_else(|| refused("every", every, "a whole number of steps ≥ 1"))?;
    let mut left = steps;
    let mut until_call = every;
    while left > 0 {
        let most = if callback.is_some() { left.min(until_call) } else { left };
        let (taken, ended) = take(simulation, most)?;
        left -= taken;
        until_call -= taken.min(until_call);
        warn_of_alarms(simulation)?;
        ended?;
        py.check_signals()?;
        if let Some(callback) = callback
            && until_call == 0
        {
            callback.call1((simulation,))?;
            until_call = every;
        }
    }
    Ok(())
}

/// Takes steps for a while. How many that were, and what ended them early.
fn take(simulation: &Bound<'_, Simulation>, most: u64) -> PyResult<(u64, PyResult<()>)> {
    let this = simulation.get();
    let done = simulation.py().detach(|| shared_out(|| this.locked().take(most)));
    let (taken, ended) = done.map_err(|error| PyOSError::new_err(error.to_string()))?;
    Ok((taken, ended.map_err(exception)))
}

/// Warns of what went wrong since the last look. A state that is no longer finite is an exception of its own.
fn warn_of_alarms(simulation: &Bound<'_, Simulation>) -> PyResult<()> {
    let py = simulation.py();
    for (kind, message) in simulation.get().new_alarms(py) {
        if kind != AlarmKind::NotFinite {
            // A sentence of the program has no zero in it.
            let message = CString::new(message).unwrap_or_default();
            PyErr::warn(py, &py.get_type::<SlumpWarning>(), &message, 1)?;
        }
    }
    Ok(())
}
