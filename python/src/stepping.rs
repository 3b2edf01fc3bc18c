//! Many steps in a row, without Python's lock: other threads run meanwhile, and Ctrl-C is heeded. And work after a fork:
//! `multiprocessing` may fork this process, and the threads of a pool stay behind: whoever gives work to rayon's global
//! pool in a child waits for ever. So a child has a pool of its own.

use std::ffi::CString;
use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::conversion::{SlumpWarning, exception, refused};
use crate::simulation::Simulation;
use slump_core::sim::AlarmKind;

/// The process that loaded this module.
static LOADED_IN: OnceLock<u32> = OnceLock::new();
/// The pool of a forked process.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Remembers which process has the global pool.
pub(crate) fn remember_this_process() {
    LOADED_IN.get_or_init(process::id);
}

/// Does work that may be shared out to threads.
pub(crate) fn shared_out<T: Send>(
    work: impl FnOnce() -> T + Send,
) -> Result<T, ThreadPoolBuildError> {
    let this = process::id();
    if LOADED_IN.get() == Some(&this) {
        return Ok(work());
    }
    let mut forked = FORKED.lock().unwrap_or_else(PoisonError::into_inner);
    let pool = match &*forked {
        Some((owner, pool)) if *owner == this => Arc::clone(pool),
        _ => {
            let pool = Arc::new(ThreadPoolBuilder::new().build()?);
            // That of the parent has no threads here; ending it would wait for them.
            std::mem::forget(forked.replace((this, Arc::clone(&pool))));
            pool
        }
    };
    drop(forked);
    Ok(pool.install(work))
}

/// Takes so many steps, and calls `callback` with the simulation after each `every` of them.
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
