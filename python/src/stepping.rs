//! Takes many steps without Python's lock, so that other Python threads run meanwhile, and checks for Ctrl-C. Also
//! handles forked processes: `multiprocessing` may fork this process, but the child process lacks the threads of
//! rayon's global pool, and work given to that pool would wait for ever. So a child process gets a thread pool of its
//! own.

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

/// Id of the process that loaded this module.
static LOADED_IN: OnceLock<u32> = OnceLock::new();
/// Thread pool of a forked process, with the id of that process.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Stores the id of this process, which owns rayon's global pool.
pub(crate) fn remember_this_process() {
    LOADED_IN.get_or_init(process::id);
}

/// Does work that may use several threads, in the global pool or, in a forked process, in that process's own pool.
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
            // A pool of the parent process has no threads in this process. It is leaked, because dropping it would wait
            // for them.
            std::mem::forget(forked.replace((this, Arc::clone(&pool))));
            pool
        }
    };
    drop(forked);
    Ok(pool.install(work))
}

/// Returns the schedule of a callback: the steps at which a recording with the same `every` (s) takes frames. Returns
/// `None`, which stands for every step, without `every`.
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
    // A recording also takes a frame of the present state, but a callback is called only after steps: skip this frame.
    schedule.is_due(&simulation.get().run(simulation.py()).simulation);
    Ok(Some(schedule))
}

/// Takes `steps` steps. Calls `callback` with the simulation after each step at which `schedule` is due, or after every
/// step without a schedule.
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

/// Takes steps without Python's lock for the time of one slice, at most `most` steps.
fn take(
    simulation: &Bound<'_, Simulation>,
    most: u64,
    schedule: Option<&mut FrameSchedule>,
) -> PyResult<Taken> {
    let this = simulation.get();
    let done = simulation.py().detach(|| shared_out(|| this.locked().take(most, schedule)));
    done.map_err(|error| PyOSError::new_err(error.to_string()))
}

/// Raises a Python warning for each new alarm, except the alarm that the state is no longer finite, which becomes an
/// exception elsewhere.
fn warn_of_alarms(simulation: &Bound<'_, Simulation>) -> PyResult<()> {
    let py = simulation.py();
    for (kind, message) in simulation.get().new_alarms(py) {
        if kind != AlarmKind::NotFinite {
            // Messages of the program contain no zero byte, so this conversion does not fail.
            let message = CString::new(message).unwrap_or_default();
            PyErr::warn(py, &py.get_type::<SlumpWarning>(), &message, 1)?;
        }
    }
    Ok(())
}
