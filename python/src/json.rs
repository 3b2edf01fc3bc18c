//! Nested data between Python and the program, by way of JSON: numbers are the same on both sides to the last
//! bit.

use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

/// The text of a dictionary. Arrays and numbers of numpy's may be in it.
///
/// # Errors
/// Where something in it is no data.
pub(crate) fn text_of(what: &str, data: &Bound<'_, PyAny>) -> PyResult<String> {
    let py = data.py();
    let options = PyDict::new(py);
    options
        .set_item("default", py.import("operator")?.call_method1("methodcaller", ("tolist",))?)?;
    let text = py.import("json")?.call_method("dumps", (data,), Some(&options));
    let text = text.map_err(|error| {
        let said = error.value(py);
        PyTypeError::new_err(format!("{what} is no data ({said}), but must be as JSON can say it"))
    })?;
    text.extract()
}

/// What a text says, in dictionaries, lists, numbers and words.
///
/// # Errors
/// Where it is no JSON.
pub(crate) fn parsed<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}

/// Data of the program, in dictionaries, lists, numbers and words.
///
/// # Errors
/// Where JSON cannot say it.
pub(crate) fn data_of<'py>(py: Python<'py>, data: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(data).map_err(|error| {
        PyRuntimeError::new_err(format!("the program's own data are no JSON: {error}"))
    })?;
    parsed(py, &text)
}
