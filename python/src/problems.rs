//! Functions that solve single contact problems, outside a simulation.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::conversion::{exception, refused, rows, text_of};
use crate::stepping::shared_out;
use slump_core::solver::{METHODS, Method, SolutionSearch, SolverSettings, StopTest};
use slump_data::interchange::{
    FoundSolution, ProblemFile, Solution, solutions_of_file, solve_file,
};

/// Interval between two checks for Ctrl-C. A longer interval makes Ctrl-C react later.
const LOOK: Duration = Duration::from_millis(20);

/// Solves a contact problem. `problem` is a dictionary in the form of `Simulation.next_problem`, the same data as JSON
/// text, or the path of a file in this format or in the format of Siconos. After Ctrl-C the unfinished work continues
/// in the background.
#[pyfunction]
#[pyo3(signature = (problem, method="auto", tolerance=1e-8, max_sweeps=1_000_000, repeat=1, without_bodies=false))]
pub(crate) fn solve<'py>(
    py: Python<'py>,
    problem: &Bound<'py, PyAny>,
    method: &str,
    tolerance: f64,
    max_sweeps: u32,
    repeat: u32,
    without_bodies: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let method = method_of(method)?;
    let stop = StopTest::Residual;
    let settings = SolverSettings { method, stop, tolerance, max_sweeps, ..SolverSettings::SWEEPS };
    let mut problem = problem_of(problem)?;
    if without_bodies {
        problem.bodies = None;
    }
    let work = move || shared_out(|| solve_file(&problem, &settings, repeat));
    let solution = interruptible(py, work)?;
    let solution = solution.map_err(|error| PyOSError::new_err(error.to_string()))?;
    as_python(py, solution.map_err(exception)?)
}

/// Searches for the solutions of a contact problem under Coulomb friction, from several initial guesses. After Ctrl-C
/// the unfinished work continues in the background.
#[pyfunction]
#[pyo3(signature = (problem, starts=8, tolerance=1e-8, max_sweeps=1_000_000))]
pub(crate) fn solutions<'py>(
    py: Python<'py>,
    problem: &Bound<'py, PyAny>,
    starts: u32,
    tolerance: f64,
    max_sweeps: u32,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let search = SolutionSearch { starts, seed: 1, max_sweeps, tolerance };
    let problem = problem_of(problem)?;
    let found = interruptible(py, move || shared_out(|| solutions_of_file(&problem, &search)))?;
    let found = found.map_err(|error| PyOSError::new_err(error.to_string()))?;
    found.map_err(exception)?.into_iter().map(|solution| found_as_python(py, solution)).collect()
}

fn method_of(name: &str) -> PyResult<Method> {
    let found = METHODS.iter().find(|info| info.name == name);
    found.map(|info| info.method).ok_or_else(|| {
        let names: Vec<_> = METHODS.iter().map(|info| info.name).collect();
        refused("method", name, format!("one of {}", names.join(", ")))
    })
}

fn problem_of(problem: &Bound<'_, PyAny>) -> PyResult<ProblemFile> {
    let parsed = if let Ok(text) = problem.cast::<PyString>() {
        let text = text.to_string();
        // JSON text begins with a brace or has several lines; a path does not.
        if text.trim_start().starts_with('{') || text.contains('\n') {
            ProblemFile::parse(&text)
        } else {
            ProblemFile::read(text.as_ref())
        }
    } else if problem.hasattr("__fspath__")? {
        let path: std::path::PathBuf = problem.extract()?;
        ProblemFile::read(&path)
    } else {
        ProblemFile::parse(&text_of("the problem", problem)?)
    };
    parsed.map_err(exception)
}

/// Does the work on a separate thread, while this thread checks for Ctrl-C.
fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    // After Ctrl-C the result has no receiver any more and is dropped.
    let worker = thread::Builder::new().spawn(move || drop(sender.send(work())));
    worker.map_err(|error| PyOSError::new_err(error.to_string()))?;
    loop {
        let received;
        (receiver, received) = py.detach(move || {
            let received = receiver.recv_timeout(LOOK);
            (receiver, received)
        });
        match received {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the method has failed"));
            }
        }
    }
}

fn as_python<'py>(py: Python<'py>, solution: Solution) -> PyResult<Bound<'py, PyAny>> {
    let pairs = |list: &[f64]| rows(py, list.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
    let fields = PyDict::new(py);
    fields.set_item("contacts", solution.contacts)?;
    fields.set_item("method", solution.method)?;
    fields.set_item("on_bodies", solution.on_bodies)?;
    fields.set_item("sweeps", solution.sweeps)?;
    fields.set_item("factorisations", solution.factorisations)?;
    fields.set_item("seconds", solution.seconds)?;
    fields.set_item("converged", solution.converged)?;
    fields.set_item("stalled", solution.stalled)?;
    fields.set_item("residual", solution.residual)?;
    fields.set_item("impulses", pairs(&solution.r)?)?;
    fields.set_item("velocities", pairs(&solution.u)?)?;
    let bodies = solution.velocities.map(|bodies| rows(py, bodies.into_iter())).transpose()?;
    fields.set_item("body_velocities", bodies)?;
    py.import("slump._solution")?.getattr("Solution")?.call((), Some(&fields))
}

fn found_as_python<'py>(py: Python<'py>, solution: FoundSolution) -> PyResult<Bound<'py, PyAny>> {
    let FoundSolution { residual, is_solved, starts, distances, farthest, velocities } = solution;
    let fields = PyDict::new(py);
    fields.set_item("residual", residual)?;
    fields.set_item("is_solved", is_solved)?;
    fields.set_item("starts", starts)?;
    fields.set_item("distances", distances)?;
    fields.set_item("farthest", farthest)?;
    fields.set_item("body_velocities", rows(py, velocities.into_iter())?)?;
    py.import("slump._solution")?.getattr("FoundSolution")?.call((), Some(&fields))
}
