//! The class of a simulation: how it is made, stepped, changed and looked at.

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

/// A scene in motion.
///
/// Parameters
/// ----------
/// scene
///     Name of a built-in scene (`slump.scenes()`; the pile where none is given), path of a scene file (TOML), or
///     a dictionary as of `slump.scene()`.
/// initial
///     What a pile starts from instead: path of a file of discs, or a dictionary or data frame with columns `x`,
///     `y`, `radius` (m) and, where the grains move, `vx`, `vy` (m/s), `omega` (rad/s), such as `grains` of another
///     simulation; or a recording, of whose moments `initial_step` chooses one (else the last); or a saved run,
///     which begins anew with its grains and its scene.
/// restart
///     Path of a saved run to go on with, bit for bit, where no other scene or start is given. Options change it
///     from there on.
/// **options
///     Those of the command line, with underscores: `bond`, `dt`, `stepper`, `solver`, `grains`, `seed`, …
///     `slump.options()` lists them.
///
/// Every setting (`bond`, `dt`, …) is an attribute, to be read and, from the next step on, changed. The same
/// options give bit for bit the trajectory of the command line. Arrays are copies that cannot be written to:
/// they stay as they are while the simulation goes on. Several threads may use one simulation, and many simulations run in parallel on
/// threads: steps are taken without Python's lock.
///
/// Raises
/// ------
/// slump.InputError
///     Names the first value that is not allowed, and what is.
/// slump.FileError
///     Names the file that cannot be read.
#[pyclass(module = "slump", subclass, frozen)]
pub(crate) struct Simulation {
    run: Mutex<Run>,
}

impl Simulation {
    fn of(run: Run) -> Self {
        Self { run: Mutex::new(run) }
    }

    /// The run, for a thread that has no lock of Python's.
    pub(crate) fn locked(&self) -> MutexGuard<'_, Run> {
        // A step that panicked has been told of; what it left can still be looked at.
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn run(&self, py: Python<'_>) -> MutexGuard<'_, Run> {
        self.run.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of grains.
    fn count(&self, py: Python<'_>) -> usize {
        self.run(py).simulation.world().grains.len()
    }

    /// What went wrong since the last call: its kind, and a sentence.
    pub(crate) fn new_alarms(&self, py: Python<'_>) -> Vec<(AlarmKind, String)> {
        self.run(py).new_alarms()
    }
}

/// The simulation that a pickle holds.
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

    /// Takes `steps` steps. After each of them `callback` is called with the simulation.
    ///
    /// Other threads run meanwhile. Ctrl-C ends it after the step that it is in, as an exception of the
    /// callback does; all steps until then are taken, and the simulation can go on. What goes wrong without
    /// ending it is told of in a `SlumpWarning`.
    ///
    /// Raises
    /// ------
    /// slump.NotFiniteError
    ///     Where a position or velocity is no longer a number.
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

    /// Takes the steps that are left until a simulated time, `run(until=0.2)` (s), or without one until the scene's
    /// `duration`. To run for 0.2 s, write `run(until=sim.time + 0.2)`.
    ///
    /// `callback` is called with the simulation each `every` seconds of simulated time, after the steps at which
    /// `record` with the same `every` takes frames; without `every` it is called after each step. All else is as in
    /// `step`.
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
        // A bare number could be the time at which the run ends or the time that it takes.
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

    /// Changes settings from the next step on: all that are given, or none.
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

    /// All settings, as the next step will be taken.
    #[getter]
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let settings = *self.run(py).simulation.settings();
        options::settings(py, &settings)
    }

    /// A second simulation, which goes on as this one would.
    fn copy(&self, py: Python<'_>) -> Self {
        Self::of(self.run(py).copy())
    }

    fn __copy__(&self, py: Python<'_>) -> Self {
        self.copy(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy(py)
    }

    /// Saves the run to a file, which is there as a whole or not at all: `Simulation(restart=path)` goes on with
    /// it bit for bit, as `--restart` of the command line does, and `Simulation(initial=path)` begins with its
    /// grains. Files are read by the version that wrote them, and by no other.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.locked().saved()?.save(&path)).map_err(exception)
    }

    /// Records from now on into a folder, as `--data` of the command line does: what each step measures, and all
    /// grains and contacts each `every` seconds of simulated time. A recording that it had before ends.
    ///
    /// `formats` are some of parquet (where nothing is said), csv, vtk, ovito and fields. An earlier recording in the
    /// folder is refused unless `overwrite` removes it. Files are written on a thread of their own; where that
    /// fails, the recording ends, and a later step, or `end_recording`, says why. Copies, pickles and forked processes
    /// are not recorded.
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

    /// Ends the recording, if there is one, and waits until all of it is written. So does whatever ends the
    /// simulation, but does not say what went wrong.
    fn end_recording(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.locked().end_recording()).map_err(exception)
    }

    /// The contact problem of the next step, as data that `solve` takes.
    fn next_problem<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let problem = problem_file_of(&self.run(py).simulation).map_err(exception)?;
        parsed(py, &problem.text())
    }

    /// Forgets the rows of the steps so far.
    fn forget_history(&self, py: Python<'_>) {
        self.run(py).rows = Vec::new();
    }

    /// What `save` writes goes into a pickle, so that a run goes on bit for bit in another process.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let bytes = py.detach(|| self.locked().saved()?.to_bytes()).map_err(exception)?;
        let restored = py.import("slump._slump")?.getattr("_restored")?;
        Ok((restored, (PyBytes::new(py, &bytes),)))
    }

    /// Sets the centres of all grains, m: a row a grain. Velocities stay, and so does what the last step measured.
    fn set_positions(&self, py: Python<'_>, positions: &Bound<'_, PyAny>) -> PyResult<()> {
        let positions: Vec<_> = vectors("positions", positions, self.count(py))?;
        self.run(py).simulation.set_positions(&positions).map_err(exception)
    }

    /// Sets the velocities of all grains, m/s: a row a grain. What the last step measured stays.
    fn set_velocities(&self, py: Python<'_>, velocities: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocities: Vec<_> = vectors("velocities", velocities, self.count(py))?;
        self.run(py).simulation.set_velocities(&velocities).map_err(exception)
    }

    /// Puts a grain in at x, y (m) with that radius (m) and velocity (m/s). It is the last one, has the density of the
    /// others, and an `id` that no other body has had. There must be room for it.
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

    /// Takes grain i out. The arrays of all grains lose its row; the `id` of every other grain in tables and recordings
    /// stays.
    fn remove_grain(&self, py: Python<'_>, i: i64) -> PyResult<()> {
        let mut run = self.run(py);
        let count = run.simulation.world().grains.len();
        let grain = usize::try_from(i)
            .map_err(|_| refused("grain", i, format!("from 0 to {}, its number", count - 1)))?;
        run.simulation.remove_grain(grain).map_err(exception)?;
        run.edited();
        Ok(())
    }

    /// The force on each grain beside gravity, N, a row a grain: set as a whole, it acts from the next step on until it is set
    /// anew. Its work is part of `gravity_work`. A run that is saved, copied or pickled keeps it; recordings do not have it.
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

    /// Begins to sum up what pairs transmit: from now on `pairs` has the means over all steps since. Steps then take longer.
    fn begin_pairs(&self, py: Python<'_>) {
        self.run(py).begin_pairs();
    }

    /// Fields of density, velocity and stress on a grid, smoothed by `width` (m, the mean diameter where none is given), which
    /// is the standard deviation along each axis (I. Goldhirsch, Granular Matter 12:239, 2010).
    ///
    /// Arrays have a row for each of the heights `y`, a column for each `x` (centres of cells, m), then vectors and tensors:
    /// `density` (kg/m²), `momentum` (kg/(m s)), `velocity` (m/s, NaN where nothing is), `kinetic_stress` and `contact_stress`
    /// (N/m, compression positive). They are means over cells of half a width, so that sums over all cells are exact.
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
