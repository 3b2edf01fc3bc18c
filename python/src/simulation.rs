//! The Python class `Simulation`: construction, steps, changes, recordings and smoothed fields.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::PyArray2;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::conversion::{exception, fields_of, parsed, refused, rows, vectors};
use crate::run::Run;
use crate::{options, start, stepping};
use slump_core::sim::AlarmKind;
use slump_core::world::Disc;
use slump_data::config::SavedState;
use slump_data::data::{DataSettings, FormatName};
use slump_data::granular::Fields;
use slump_data::interchange::problem_file_of;

/// A simulation of a scene, advanced step by step.
///
/// Parameters
/// ----------
/// scene
///     Name of a built-in scene (`slump.scenes()` lists them; default: the pile), path of a scene file (TOML), or a
///     dictionary in the form of `slump.scene()`.
/// initial
///     Initial state of a pile: path of a file of discs; a dictionary or data frame with columns `x`, `y`, `radius`
///     (m) and, if the grains move, `vx`, `vy` (m/s), `omega` (rad/s), such as `grains` of another simulation; a
///     recording, from which `initial_step` chooses a moment (default: the last); or a saved run, whose scene then
///     starts again with the saved grains.
/// restart
///     Path of a saved run to resume, bit for bit. It excludes `scene` and `initial`. Options change the run from
///     there on.
/// **options
///     Options of the command line, with underscores: `bond`, `dt`, `stepper`, `solver`, `grains`, `seed`, …
///     `slump.options()` lists them.
///
/// Every setting (`bond`, `dt`, …) is an attribute that you can read and change. A change takes effect at the next
/// step. The same options give the trajectory of the command line, bit for bit. Arrays are read-only copies: they do
/// not change while the simulation continues. Several threads may use one simulation, and many simulations run in
/// parallel on threads, because Python's lock is released while steps are taken.
///
/// Raises
/// ------
/// slump.InputError
///     If a value is not allowed. The message names the first such value and the allowed values.
/// slump.FileError
///     If a file cannot be read. The message names the file.
#[pyclass(module = "slump", subclass, frozen)]
pub(crate) struct Simulation {
    run: Mutex<Run>,
}

impl Simulation {
    fn of(run: Run) -> Self {
        Self { run: Mutex::new(run) }
    }

    /// Locks the run, for a thread that does not have Python's lock.
    pub(crate) fn locked(&self) -> MutexGuard<'_, Run> {
        // A panic in a step was already reported. The state can still be inspected after it.
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn run(&self, py: Python<'_>) -> MutexGuard<'_, Run> {
        self.run.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the number of grains.
    fn count(&self, py: Python<'_>) -> usize {
        self.run(py).simulation.world().grains.len()
    }

    /// Returns the alarms since the last call, each with its kind and a sentence.
    pub(crate) fn new_alarms(&self, py: Python<'_>) -> Vec<(AlarmKind, String)> {
        self.run(py).new_alarms()
    }
}

/// Restores a simulation from the bytes in a pickle.
#[pyfunction]
pub(crate) fn _restored(py: Python<'_>, saved: Vec<u8>) -> PyResult<Simulation> {
    let state = py.detach(|| SavedState::from_bytes(&saved, "pickle"));
    state.map(|state| Simulation::of(Run::of(state))).map_err(exception)
}

fn format_of(name: &str) -> PyResult<FormatName> {
    FormatName::ALL.iter().copied().find(|format| format.name() == name).ok_or_else(|| {
        let names: Vec<_> = FormatName::ALL.iter().map(|format| format.name()).collect();
        refused("formats", name, format!("some of {}", names.join(", ")))
    })
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (scene=None, *, initial=None, restart=None, **options))]
    fn new(
        py: Python<'_>,
        scene: Option<&Bound<'_, PyAny>>,
        initial: Option<&Bound<'_, PyAny>>,
        restart: Option<PathBuf>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        if let Some(file) = restart {
            return start::restarted(py, &file, scene, initial, options).map(Self::of);
        }
        let scene = start::scene(py, scene, initial, options)?;
        Run::start(scene).map(Self::of).map_err(exception)
    }

    /// Takes `steps` steps and calls `callback` with the simulation after each step.
    ///
    /// Other threads run meanwhile. Ctrl-C, or an exception in the callback, stops the run after the current step. The
    /// steps taken until then are kept, and the simulation can continue. Problems that do not stop the run raise a
    /// `SlumpWarning`.
    ///
    /// Raises
    /// ------
    /// slump.NotFiniteError
    ///     If a position or velocity is no longer finite.
    #[pyo3(signature = (steps=1, callback=None))]
    fn step(
        this: &Bound<'_, Self>,
        steps: i64,
        callback: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let count = u64::try_from(steps);
        let count = count.map_err(|_| refused("steps", steps, "a whole number ≥ 0"))?;
        stepping::take_steps(this, count, callback, None)
    }

    /// Runs until the simulated time `until` (s), as in `run(until=0.2)`. Without `until`, runs up to the `duration` of
    /// the scene. To run for 0.2 s, write `run(until=sim.time + 0.2)`.
    ///
    /// `callback` is called with the simulation every `every` seconds of simulated time, after the steps at which a
    /// recording with the same `every` takes frames. Without `every` it is called after each step. Ctrl-C and warnings
    /// work as in `step`.
    #[pyo3(
        name = "run",
        signature = (*times, until=None, callback=None, every=None),
        text_signature = "($self, *, until=None, callback=None, every=None)"
    )]
    fn run_until(
        this: &Bound<'_, Self>,
        times: &Bound<'_, PyTuple>,
        until: Option<f64>,
        callback: Option<&Bound<'_, PyAny>>,
        every: Option<f64>,
    ) -> PyResult<()> {
        // A bare number is refused, because it could mean the end time or the duration of the run.
        if let Ok(time) = times.get_item(0) {
            let sentence = format!(
                "run is given {time}, but must be given until={time} to end at t = {time} s, or \
                 until=sim.time + {time} to take {time} s"
            );
            return Err(PyTypeError::new_err(sentence));
        }
        let schedule = stepping::schedule_of(this, callback, every)?;
        let steps = {
            let run = this.get().run(this.py());
            let until = until.unwrap_or(run.scene.duration_secs);
            let parameters = run.simulation.parameters();
            if !(until >= 0.0 && until.is_finite()) {
                return Err(refused("until", until, "a finite number of seconds ≥ 0"));
            }
            parameters.check_steps("until", until).map_err(exception)?;
            parameters.steps_in(until - run.simulation.time_secs())
        };
        stepping::take_steps(this, steps, callback, schedule)
    }

    /// Changes settings from the next step on. If a value is not allowed, no setting changes.
    #[pyo3(signature = (**settings))]
    fn change(&self, py: Python<'_>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let mut given = options::GivenOptions::default();
        given.add_all(settings, &options::setting_names())?;
        let config = given.config()?;
        let mut run = self.run(py);
        let mut settings = *run.simulation.settings();
        config.change_settings(&mut settings);
        run.simulation.change(settings).map_err(exception)
    }

    /// All settings of the next step, as a dictionary.
    #[getter]
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let settings = *self.run(py).simulation.settings();
        options::settings(py, &settings)
    }

    /// Returns a second, independent simulation in the same state. Both continue in the same way.
    fn copy(&self, py: Python<'_>) -> Self {
        Self::of(self.run(py).copy())
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        self.copy(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy(py)
    }

    /// Saves the run to a file. The file is written completely or not at all. `Simulation(restart=path)` resumes the
    /// run bit for bit, as `--restart` of the command line does. `Simulation(initial=path)` starts the scene again with
    /// the saved grains. Only the version that wrote a file can read it.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.locked().saved()?.save(&path)).map_err(exception)
    }

    /// Starts recording into a folder, as `--data` of the command line does: the measurements of each step, and all
    /// grains and contacts every `every` seconds of simulated time. An earlier recording of this simulation ends.
    ///
    /// `formats` is a list of parquet (the default), csv, vtk, ovito and fields. If the folder already contains a
    /// recording, the call fails, unless `overwrite` is true: then the old recording is removed. Files are written on a
    /// separate thread. If writing fails, the recording ends, and a later step or `end_recording` raises the error.
    /// Copies, pickles and forked processes of this simulation do not record.
    #[pyo3(signature = (folder, every=0.04, formats=None, overwrite=false))]
    fn record(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        every: f64,
        formats: Option<Vec<String>>,
        overwrite: bool,
    ) -> PyResult<()> {
        let formats = formats.unwrap_or_default();
        let formats = formats.iter().map(|name| format_of(name)).collect::<PyResult<_>>()?;
        let settings = DataSettings { folder: None, every_secs: Some(every), formats };
        let recorded = py.detach(|| {
            let mut run = self.locked();
            run.end_recording()?;
            run.record(&folder, &settings, overwrite)
        });
        recorded.map_err(exception)
    }

    /// Ends the recording, if there is one, and waits until all files are written. A simulation that is deleted also
    /// ends its recording, but does not report errors.
    fn end_recording(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.locked().end_recording()).map_err(exception)
    }

    /// Returns the contact problem of the next step, as data that `solve` accepts.
    fn next_problem<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let problem = problem_file_of(&self.run(py).simulation).map_err(exception)?;
        parsed(py, &problem.text())
    }

    /// Deletes the history of the steps so far.
    fn forget_history(&self, py: Python<'_>) {
        self.run(py).rows = Vec::new();
    }

    /// Pickles the bytes that `save` writes, so that another process resumes the run bit for bit.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let bytes = py.detach(|| self.locked().saved()?.to_bytes()).map_err(exception)?;
        let restored = py.import("slump._slump")?.getattr("_restored")?;
        Ok((restored, (PyBytes::new(py, &bytes),)))
    }

    /// Sets the centres of all grains (m), one row per grain. Velocities and the measurements of the last step do not
    /// change.
    fn set_positions(&self, py: Python<'_>, positions: &Bound<'_, PyAny>) -> PyResult<()> {
        let positions: Vec<_> = vectors("positions", positions, self.count(py))?;
        self.run(py).simulation.set_positions(&positions).map_err(exception)
    }

    /// Sets the velocities of all grains (m/s), one row per grain. The measurements of the last step do not change.
    fn set_velocities(&self, py: Python<'_>, velocities: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocities: Vec<_> = vectors("velocities", velocities, self.count(py))?;
        self.run(py).simulation.set_velocities(&velocities).map_err(exception)
    }

    /// Adds a grain at x, y (m) with this radius (m) and velocity (m/s). The grain becomes the last row of all arrays,
    /// has the density of the other grains, and gets an `id` that no other body has had. Fails if its place is not
    /// free.
    #[pyo3(signature = (x, y, radius, vx=0.0, vy=0.0))]
    fn add_grain(
        &self,
        py: Python<'_>,
        x: f64,
        y: f64,
        radius: f64,
        vx: f64,
        vy: f64,
    ) -> PyResult<()> {
        let disc = Disc { position: [x, y].into(), radius };
        let mut run = self.run(py);
        run.simulation.add_grain(disc, [vx, vy].into()).map_err(exception)?;
        run.edited();
        Ok(())
    }

    /// Removes the grain in row `i`. The arrays of all grains lose this row. Every other grain keeps its `id` in tables
    /// and recordings.
    fn remove_grain(&self, py: Python<'_>, i: i64) -> PyResult<()> {
        let mut run = self.run(py);
        let count = run.simulation.world().grains.len();
        let grain = usize::try_from(i)
            .map_err(|_| refused("grain", i, format!("from 0 to {}, its number", count - 1)))?;
        run.simulation.remove_grain(grain).map_err(exception)?;
        run.edited();
        Ok(())
    }

    /// Force on each grain in addition to gravity (N), one row per grain. Assign a whole array to change the forces.
    /// They act from the next step on until you assign other forces. Their work is part of `gravity_work`. Saved runs,
    /// copies and pickles keep the forces; recordings do not contain them.
    #[getter]
    fn body_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let run = self.run(py);
        let forces = run.simulation.body_forces().iter().map(|&force| force.into());
        let none = run.simulation.world().grains.len() - forces.len();
        let forces: Vec<[f64; 2]> = forces.chain(std::iter::repeat_n([0.0; 2], none)).collect();
        rows(py, forces.into_iter())
    }

    #[setter]
    fn set_body_forces(&self, py: Python<'_>, forces: &Bound<'_, PyAny>) -> PyResult<()> {
        let forces: Vec<_> = vectors("body_forces", forces, self.count(py))?;
        self.run(py).simulation.set_body_forces(&forces).map_err(exception)
    }

    /// Starts to sum the forces of all pairs. From now on `pairs` gives means over all steps since this call, and steps
    /// take longer.
    fn begin_pairs(&self, py: Python<'_>) {
        self.run(py).begin_pairs();
    }

    /// Returns fields of density, velocity and stress on a grid, smoothed with a kernel whose standard deviation along
    /// each axis is `width` (m, default: the mean diameter; I. Goldhirsch, Granular Matter 12:239, 2010).
    ///
    /// The first axis of each array runs over the heights `y`, the second axis over `x` (centres of cells, m), and
    /// further axes over the components of vectors and tensors. The arrays are `density` (kg/m²), `momentum` (kg/(m
    /// s)), `velocity` (m/s, NaN in empty cells), `kinetic_stress` and `contact_stress` (N/m, compression positive).
    /// Values are means over cells of half a width, so that sums over all cells are exact.
    #[pyo3(signature = (width=None))]
    fn fields<'py>(&self, py: Python<'py>, width: Option<f64>) -> PyResult<Bound<'py, PyDict>> {
        let (moment, diameter) = {
            let run = self.run(py);
            (run.simulation.moment(), run.scene.mean_diameter)
        };
        let fields = py.detach(|| Fields::of(&moment, width.unwrap_or(diameter)));
        fields_of(py, &fields.map_err(exception)?)
    }

    fn _repr_html_(&self, py: Python<'_>) -> String {
        let run = self.run(py);
        let now = run.simulation.observables();
        let rows = [
            ("grains", run.simulation.world().grains.len().to_string()),
            ("contacts", now.contacts.to_string()),
            ("steps", now.step.to_string()),
            ("time", format!("{:.6} s", now.time_secs)),
            ("stepper", run.simulation.settings().stepper.to_string()),
            ("slump", format!("{:.6}", now.slump)),
            ("kinetic energy", format!("{:.4e} J", now.kinetic_energy)),
        ];
        let rows = rows.map(|(name, value)| format!("<tr><td>{name}</td><td>{value}</td></tr>"));
        let name = run.scene.name.replace('&', "&amp;").replace('<', "&lt;");
        format!("<table><caption>{name}</caption>{}</table>", rows.concat())
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let run = self.run(py);
        let grains = run.simulation.world().grains.len();
        let of = &run.scene.name;
        let row = run.simulation.observables();
        let (step, time_secs) = (row.step, row.time_secs);
        format!("<slump.Simulation {of}: {grains} grains, step {step}, t = {time_secs:.6} s>")
    }
}
