//! What there is to choose from, each with one line.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::options::keyword;
use slump_core::scene::SCENES;
use slump_core::setting::Kind;
use slump_core::sim::{Settings, Stepper};
use slump_core::solver::METHODS;
use slump_data::config::Config;

fn lines<'py>(
    py: Python<'py>,
    lines: impl IntoIterator<Item = (String, impl AsRef<str>)>,
) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    for (name, line) in lines {
        found.set_item(name, line.as_ref())?;
    }
    Ok(found)
}

/// The built-in scenes, each with one line.
#[pyfunction]
pub(crate) fn scenes(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, SCENES.iter().map(|scene| (scene.name.into(), scene.summary)))
}

/// The steppers, each with one line.
#[pyfunction]
pub(crate) fn steppers(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, Stepper::ALL.iter().map(|stepper| (stepper.name().into(), stepper.hint())))
}

/// The methods that solve a step's problem, each with one line.
#[pyfunction]
pub(crate) fn methods(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, METHODS.iter().map(|method| (method.name.into(), method.summary)))
}

/// The options of a simulation, each with the line that the command line's help has for it.
#[pyfunction]
pub(crate) fn options(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, Config::options().into_iter().map(|(name, help)| (keyword(&name), help)))
}

/// What the values of each setting are: float, int, bool, or a tuple of words.
#[pyfunction]
pub(crate) fn _kinds(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let found = PyDict::new(py);
    for about in Settings::about() {
        let name = keyword(about.name);
        match about.kind {
            Kind::Number => found.set_item(name, "float")?,
            Kind::Count => found.set_item(name, "int")?,
            Kind::Switch => found.set_item(name, "bool")?,
            Kind::Word(words) => {
                let words: Vec<_> = words.iter().map(|word| word.name).collect();
                found.set_item(name, words)?;
            }
        }
    }
    Ok(found)
}
