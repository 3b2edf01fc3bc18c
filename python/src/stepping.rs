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
use crate::run::Taken;
use crate::simulation::Simulation;
use slump_core::sim::AlarmKind;
use slump_data::data::{DataSettings, FrameSchedule, Times};

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

/// The schedule of a callback: after the steps at which a recording with the same `every` (s) has frames, or, without
/// it, after each step.
pub(crate) fn schedule_of(
    simulation: &Bound<'_, Simulation>,
    callback: Option<&Bound<'_, PyAny>>,
    every: Option<f64>,
) -> PyResult<Option<FrameSchedule>> {
    let Some(secs) = every else { return Ok(None) };
    if callback.is_none() {
        return Err(refused("every", secs, "left out where no callback is given"));
    }
    let settings = DataSettings { every_secs: every, ..DataSettings::default() };
    settings.validate("every").map_err(exception)?;
    let mut schedule = FrameSchedule::new(Times::of(&settings));
    // A recording has a frame of the present state, but a callback is called after steps only.
    schedule.is_due(&simulation.get().run(simulation.py()).simulation);
    Ok(Some(schedule))
}

/// Takes `steps` steps, and calls `callback` with the simulation after those that `schedule` names, or after each.
pub(crate) fn take_steps(
    simulation: &Bound<'_, Simulation>,
    steps: u64,
    callback: Option<&Bound<'_, PyAny>>,
    mut schedule: Option<FrameSchedule>,
) -> PyResult<()> {
    let py = simulation.py();
    let calls_each = callback.is_some() && schedule.is_none();
    let mut left = steps;
    while left > 0 {
        let most = if calls_each { 1 } else { left };
        let taken = take(simulation, most, schedule.as_mut())?;
        left -= taken.steps;
        warn_of_alarms(simulation)?;
        taken.ended.map_err(exception)?;
        py.check_signals()?;
        if let Some(callback) = callback
            && (calls_each || taken.is_due)
        {
            callback.call1((simulation,))?;
        }
    }
    Ok(())
}

/// Takes steps for a while.
fn take(
    simulation: &Bound<'_, Simulation>,
    most: u64,
    schedule: Option<&mut FrameSchedule>,
) -> PyResult<Taken> {
    let this = simulation.get();
    let done = simulation.py().detach(|| shared_out(|| this.locked().take(most, schedule)));
    done.map_err(|error| PyOSError::new_err(error.to_string()))
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
