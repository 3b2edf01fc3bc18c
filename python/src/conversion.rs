//! Conversion between Rust and Python: lists and tables become NumPy arrays, nested data are converted through JSON,
//! and errors become exceptions with the same message.

use numpy::ndarray::Dimension;
use numpy::{
    Element, IntoPyArray, PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use slump_core::error::Error;
use slump_data::data::{Table, Values};
use slump_data::granular::Fields;

/// Exception classes that the package defines in Python.
mod classes {
    pyo3::import_exception!(slump._errors, Error);
    pyo3::import_exception!(slump._errors, FileError);
    pyo3::import_exception!(slump._errors, InputError);
    pyo3::import_exception!(slump._errors, NotFiniteError);
    pyo3::import_exception!(slump._errors, SlumpWarning);
}
pub(crate) use classes::{InputError, SlumpWarning};

/// Returns the Python exception for an error.
pub(crate) fn exception(error: Error) -> PyErr {
    let sentence = error.to_string();
    match error {
        Error::Value { .. } | Error::Options(_) => InputError::new_err(sentence),
        Error::File { .. } => classes::FileError::new_err(sentence),
        Error::NonFinite { .. } => classes::NotFiniteError::new_err(sentence),
        Error::Renderer(_) | Error::Interrupted { .. } | Error::SolveInterrupted { .. } => {
            classes::Error::new_err(sentence)
        }
    }
}

/// Returns the Python exception for a value that is not allowed.
pub(crate) fn refused(
    field: impl Into<String>,
    value: impl std::fmt::Display,
    allowed: impl Into<String>,
) -> PyErr {
    exception(Error::value(field, value, allowed))
}

/// Makes an array read-only. The array is a copy, so writing to it would have no effect on the simulation.
fn read_only<T: Element, D: Dimension>(
    array: Bound<'_, PyArray<T, D>>,
) -> Bound<'_, PyArray<T, D>> {
    array.readwrite().make_nonwriteable();
    array
}

/// Returns a two-dimensional, read-only array of rows with `N` numbers each.
pub(crate) fn rows<const N: usize>(
    py: Python<'_>,
    rows: impl ExactSizeIterator<Item = [f64; N]>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let shape = [rows.len(), N];
    rows.flatten().collect::<Vec<_>>().into_pyarray(py).reshape(shape).map(read_only)
}

/// Converts anything that NumPy accepts to an array of numbers. Words, complex numbers and masked arrays are errors,
/// because NumPy would drop a part of them.
pub(crate) fn numbers<'py>(given: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let numpy = given.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (given,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let is_masked = numpy.getattr("ma")?.call_method1("is_masked", (given,))?.is_truthy()?;
    if given.is_none() || is_masked || !"biufO".contains(&kind) {
        return Err(PyTypeError::new_err("not an array of real numbers"));
    }
    array.call_method1("astype", ("float64",))?.extract()
}

/// Converts an array with one row of two numbers per grain to vectors. The error names `name`.
pub(crate) fn vectors<V: From<[f64; 2]>>(
    name: &str,
    given: &Bound<'_, PyAny>,
    grains: usize,
) -> PyResult<Vec<V>> {
    let allowed = format!("({grains}, 2), one row of two numbers per grain");
    let numbers = numbers(given).map_err(|_| {
        refused(name, given.get_type(), format!("an array of numbers of shape {allowed}"))
    })?;
    if numbers.shape() != [grains, 2] {
        let shape = numbers.getattr("shape")?;
        return Err(refused(format!("{name}.shape"), shape, allowed));
    }
    let numbers = numbers.as_array();
    Ok(numbers.rows().into_iter().map(|row| [row[0], row[1]].into()).collect())
}

/// Returns smoothed fields as a dictionary of read-only arrays.
pub(crate) fn fields_of<'py>(py: Python<'py>, fields: &Fields) -> PyResult<Bound<'py, PyDict>> {
    let [columns, lines] = fields.counts;
    let dict = PyDict::new(py);
    dict.set_item("width", fields.width)?;
    let [x, y] = fields.centres();
    dict.set_item("x", list(py, x.into_iter()))?;
    dict.set_item("y", list(py, y.into_iter()))?;
    let density = fields.density.clone().into_pyarray(py).reshape([lines, columns])?;
    dict.set_item("density", read_only(density))?;
    for (name, vectors) in [("momentum", &fields.momentum), ("velocity", &fields.velocity)] {
        let numbers: Vec<f64> = vectors.iter().flat_map(|vector| vector.to_array()).collect();
        let array = numbers.into_pyarray(py).reshape([lines, columns, 2])?;
        dict.set_item(name, read_only(array))?;
    }
    let stresses =
        [("kinetic_stress", &fields.kinetic_stress), ("contact_stress", &fields.contact_stress)];
    for (name, stresses) in stresses {
        // NumPy expects row-major order.
        let numbers: Vec<f64> =
            stresses.iter().flat_map(|stress| stress.transpose().to_cols_array()).collect();
        let array = numbers.into_pyarray(py).reshape([lines, columns, 2, 2])?;
        dict.set_item(name, read_only(array))?;
    }
    Ok(dict)
}

/// Returns a read-only array of numbers or of True and False.
pub(crate) fn list<T: Element>(
    py: Python<'_>,
    list: impl Iterator<Item = T>,
) -> Bound<'_, PyArray1<T>> {
    read_only(list.collect::<Vec<_>>().into_pyarray(py))
}

/// Returns a table as a dictionary of columns.
pub(crate) fn columns<'py>(py: Python<'py>, table: Table) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for column in table.columns {
        dict.set_item(column.name, array(py, column.values)?)?;
    }
    Ok(dict)
}

/// Returns the first row of a table as a dictionary from column names to Python numbers and words.
pub(crate) fn first_row<'py>(py: Python<'py>, table: Table) -> PyResult<Bound<'py, PyDict>> {
    let dict = columns(py, table)?;
    for (name, column) in dict.copy()? {
        dict.set_item(name, column.get_item(0)?.call_method0("item")?)?;
    }
    Ok(dict)
}

/// Returns a column as an array of a single type. A missing number becomes NaN; a missing flag becomes False.
fn array(py: Python<'_>, values: Values) -> PyResult<Bound<'_, PyAny>> {
    Ok(match values {
        Values::Numbers(numbers) => list(py, numbers.into_iter()).into_any(),
        Values::SomeNumbers(numbers) => {
            list(py, numbers.into_iter().map(|number| number.unwrap_or(f64::NAN))).into_any()
        }
        Values::Counts(counts) => list(py, counts.into_iter().map(|count| count as i64)).into_any(),
        Values::Flags(flags) => {
            list(py, flags.into_iter().map(|flag| flag.unwrap_or(false))).into_any()
        }
        Values::Words { words, codes } => {
            let words = py.import("numpy")?.call_method1("array", (words, "U"))?;
            let words = words.get_item(list(py, codes.into_iter().map(i64::from)))?;
            words.call_method1("setflags", (false,))?;
            words
        }
    })
}

/// Returns the JSON text of a dictionary that may contain NumPy arrays and numbers.
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

/// Parses JSON into dictionaries, lists, numbers and words.
pub(crate) fn parsed<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}

/// Converts serialisable data to dictionaries, lists, numbers and words.
pub(crate) fn data_of<'py>(py: Python<'py>, data: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(data).map_err(|error| {
        PyRuntimeError::new_err(format!("the program's own data are no JSON: {error}"))
    })?;
    parsed(py, &text)
}
