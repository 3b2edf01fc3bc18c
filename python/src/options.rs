//! Conversion of keyword arguments to options of the command line: the same names with underscores, the same parser and
//! the same messages. Also returns the lists of available scenes, steppers, solvers and options.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt, PyString};

use crate::conversion::exception;
use slump_core::scene::SCENES;
use slump_core::setting::{Kind, Value};
use slump_core::sim::{Settings, Stepper};
use slump_core::solver::METHODS;
use slump_data::config::Config;

/// Options given by the caller, as pairs of a command-line name and a value in words.
#[derive(Default)]
pub(crate) struct GivenOptions(Vec<(String, String)>);

impl GivenOptions {
    /// Adds keyword arguments. A name that is not in `allowed` is an error.
    pub(crate) fn add_all(
        &mut self,
        keywords: Option<&Bound<'_, PyDict>>,
        allowed: &[String],
    ) -> PyResult<()> {
        for (name, value) in keywords.into_iter().flatten() {
            let name: String = name.extract()?;
            if !allowed.contains(&name) {
                let allowed = allowed.join(", ");
                let sentence = format!("{name} is given, but must be one of {allowed}");
                return Err(PyTypeError::new_err(sentence));
            }
            self.add(&name, &value)?;
        }
        Ok(())
    }

    /// Adds an option, unless its value is `None`.
    pub(crate) fn add(&mut self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        if !value.is_none() {
            self.0.push((name.replace('_', "-"), text_of(name, value)?));
        }
        Ok(())
    }

    /// Adds an option whose value is already written as on the command line.
    pub(crate) fn add_text(&mut self, name: &str, text: &str) {
        self.0.push((name.into(), text.into()));
    }

    /// Parses the options as the command line does, and returns the configuration.
    pub(crate) fn config(&self) -> PyResult<Config> {
        let pairs = self.0.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        Config::of_options(pairs).map_err(exception)
    }
}

/// Returns a value as it is written on the command line.
fn text_of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.hasattr("dtype")? && value.getattr("size")?.extract::<usize>().ok() == Some(1) {
        // NumPy numbers are arrays with one element; convert this element.
        return text_of(name, &value.call_method0("item")?);
    }
    if let Ok(switch) = value.cast::<PyBool>() {
        return Ok(switch.is_true().to_string());
    }
    if value.is_instance_of::<PyString>() || value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_string());
    }
    if value.hasattr("__fspath__")? {
        return Ok(value.call_method0("__fspath__")?.str()?.to_string());
    }
    let number: PyResult<f64> = value.extract();
    number.map(|number| number.to_string()).map_err(|_| {
        let found = value.repr().map_or_else(|_| "something else".into(), |text| text.to_string());
        let sentence = format!("{name} is {found}, but must be a number, a word, True or False");
        PyTypeError::new_err(sentence)
    })
}

/// Returns the keyword argument for an option: the name with underscores.
pub(crate) fn keyword(name: &str) -> String {
    name.replace('-', "_")
}

/// Returns the names of all options, as keyword arguments.
pub(crate) fn all_names() -> Vec<String> {
    Config::names().iter().map(|name| keyword(name)).collect()
}

/// Returns the names of all options that can be changed while a simulation runs, as keyword arguments.
pub(crate) fn setting_names() -> Vec<String> {
    Settings::about().map(|about| keyword(about.name)).collect()
}

/// Returns all settings as a dictionary by name.
pub(crate) fn settings<'py>(py: Python<'py>, settings: &Settings) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    for about in Settings::about() {
        let name = keyword(about.name);
        match settings.get(about.name) {
            Some(Value::Number(number)) => found.set_item(name, number)?,
            Some(Value::Count(count)) => found.set_item(name, count)?,
            Some(Value::Switch(on)) => found.set_item(name, on)?,
            Some(Value::Word(word)) => found.set_item(name, word)?,
            None => {}
        }
    }
    Ok(found)
}

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

/// Returns the built-in scenes, each with a one-line description.
#[pyfunction]
pub(crate) fn scenes(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, SCENES.iter().map(|scene| (scene.name.into(), scene.summary)))
}

/// Returns the steppers, each with a one-line description.
#[pyfunction]
pub(crate) fn steppers(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, Stepper::ALL.iter().map(|stepper| (stepper.name().into(), stepper.hint())))
}

/// Returns the solvers (values of `solver`), each with a one-line description.
#[pyfunction]
pub(crate) fn methods(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, METHODS.iter().map(|method| (method.name.into(), method.summary)))
}

/// Returns the options of a simulation, each with its line in the help of the command line.
#[pyfunction]
pub(crate) fn options(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    lines(py, Config::options().into_iter().map(|(name, help)| (keyword(&name), help)))
}

/// Returns the type of each setting: "float", "int", "bool", or a list of the allowed words.
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
