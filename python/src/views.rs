//! Read-only properties of the Python class `Simulation`. Arrays are read-only copies.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::conversion::{columns, data_of, first_row, list, refused, rows};
use crate::simulation::Simulation;
use slump_data::data::Table;

#[pymethods]
impl Simulation {
    /// Measurements after the last step, or of the initial state before the first step, as a dictionary.
    #[getter]
    fn observables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let row = *self.run(py).simulation.observables();
        first_row(py, Table::of_steps(&[row]))
    }

    /// Measurements after each step since the start or since `forget_history()`, one row per step, as a table.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let rows = self.run(py).rows.clone();
        columns(py, Table::of_steps(&rows))
    }

    /// The grains, followed by the fixed discs, as a table with one row per body.
    #[getter]
    fn grains<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let moment = self.run(py).simulation.moment();
        columns(py, py.detach(|| Table::of_grains(&moment)))
    }

    /// The contacts of the last step, as a table with one row per contact.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let moment = self.run(py).simulation.moment();
        columns(py, Table::of_contacts(&moment))
    }

    /// Walls and fixed discs, as a table with one row per rigid body: position, velocity, force, torque and work.
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let moment = self.run(py).simulation.moment();
        columns(py, Table::of_walls(&moment))
    }

    /// All pairs that have transmitted a force since `begin_pairs()`, including pairs that have separated, as a table.
    /// Its forces are means over that time: the normal force N, the tangential force T, and the force vector.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let run = self.run(py);
        let Some(sums) = &run.sums else {
            return Err(refused("pairs", "not begun", "asked for after begin_pairs()"));
        };
        columns(py, Table::of_pairs(sums, &run.simulation.moment()))
    }

    /// Measures of the whole pile, as a dictionary: stress, fabric, coordination, solid fraction, forces, clusters.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let moment = self.run(py).simulation.moment();
        first_row(py, py.detach(|| Table::of_measures(&moment)))
    }

    /// Histograms of forces, directions, contacts and overlaps, as a table with one row per bin.
    #[getter]
    fn histograms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let moment = self.run(py).simulation.moment();
        columns(py, py.detach(|| Table::of_histograms(&moment)))
    }

    /// Force of each contact on its grain i, N, one row per contact.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let moment = self.run(py).simulation.moment();
        rows(py, moment.contacts.iter().map(|contact| contact.force.into()))
    }

    /// Centres of the grains, m, one row per grain.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let run = self.run(py);
        rows(py, run.simulation.world().grains.positions.iter().map(|&place| place.into()))
    }

    /// Velocities of the grains, m/s, one row per grain.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let run = self.run(py);
        rows(py, run.simulation.world().grains.velocities.iter().map(|&speed| speed.into()))
    }

    /// Angles by which the grains have turned since the start, rad.
    #[getter]
    fn angles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.run(py).simulation.world().grains.angles.iter().copied())
    }

    /// Angular velocities of the grains, rad/s, positive anticlockwise.
    #[getter]
    fn angular_velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.run(py).simulation.world().grains.angular_velocities.iter().copied())
    }

    /// Radii of the grains, m.
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.run(py).simulation.world().grains.radii.iter().copied())
    }

    /// Masses of the grains, kg.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.run(py).simulation.world().grains.masses.iter().copied())
    }

    /// The boundaries at their present positions, in the form of scene files.
    #[getter]
    fn boundaries<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let boundaries = self.run(py).simulation.world().boundaries.clone();
        data_of(py, &boundaries)
    }

    /// One sentence for each alarm (warning of a failure) so far.
    #[getter]
    fn alarms(&self, py: Python<'_>) -> Vec<String> {
        self.run(py).alarms()
    }

    /// Folder of the recording; `None` without a recording. A forked process does not record the simulations of its
    /// parent.
    #[getter]
    fn recording(&self, py: Python<'_>) -> Option<PathBuf> {
        self.run(py).recording_folder()
    }

    /// Name of the scene.
    #[getter]
    fn name(&self, py: Python<'_>) -> String {
        self.run(py).scene.name.clone()
    }

    /// Duration of the scene, s.
    #[getter]
    fn duration(&self, py: Python<'_>) -> f64 {
        self.run(py).scene.duration_secs
    }

    /// Mean diameter d of the grains, m, the unit of reported lengths.
    #[getter]
    fn mean_diameter(&self, py: Python<'_>) -> f64 {
        self.run(py).scene.mean_diameter
    }

    /// Gravitational acceleration g of the scene, m/s².
    #[getter]
    fn gravity(&self, py: Python<'_>) -> f64 {
        self.run(py).simulation.world().gravity.magnitude()
    }

    /// Simulated time, s.
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        self.run(py).simulation.time_secs()
    }

    /// Number of steps taken.
    #[getter]
    fn steps(&self, py: Python<'_>) -> u64 {
        self.run(py).simulation.observables().step
    }
}
