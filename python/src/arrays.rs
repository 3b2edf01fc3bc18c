//! Lists and tables of the program as numpy's arrays. Each is copied once, out of the simulation.

use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use slump_data::data::{Table, Values};

/// Rows of `N` numbers, one below the other.
pub(crate) fn rows<const N: usize>(
    py: Python<'_>,
    rows: impl ExactSizeIterator<Item = [f64; N]>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let shape = [rows.len(), N];
    rows.flatten().collect::<Vec<_>>().into_pyarray(py).reshape(shape)
}

/// A list of numbers or switches.
pub(crate) fn list<T: Element>(
    py: Python<'_>,
    list: impl Iterator<Item = T>,
) -> Bound<'_, PyArray1<T>> {
    list.collect::<Vec<_>>().into_pyarray(py)
}

/// A table as a dictionary of columns.
pub(crate) fn columns<'py>(py: Python<'py>, table: Table) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    for column in table.columns {
        found.set_item(column.name, array(py, column.values)?)?;
    }
    Ok(found)
}

/// The first row of a table by the names of its columns, in numbers and words of Python's own.
pub(crate) fn first_row<'py>(py: Python<'py>, table: Table) -> PyResult<Bound<'py, PyDict>> {
    let found = columns(py, table)?;
    for (name, column) in found.copy()? {
        found.set_item(name, column.get_item(0)?.call_method0("item")?)?;
    }
    Ok(found)
}

/// A column as an array of one type, whatever its values: a number that a row does not have is no number, a switch
/// that it does not have is off.
fn array(py: Python<'_>, values: Values) -> PyResult<Bound<'_, PyAny>> {
    Ok(match values {
        Values::Numbers(numbers) => numbers.into_pyarray(py).into_any(),
        Values::SomeNumbers(numbers) => {
            list(py, numbers.into_iter().map(|number| number.unwrap_or(f64::NAN))).into_any()
        }
        Values::Counts(counts) => list(py, counts.into_iter().map(|count| count as i64)).into_any(),
        Values::Flags(flags) => {
            list(py, flags.into_iter().map(|flag| flag.unwrap_or(false))).into_any()
        }
        Values::Words { words, codes } => {
            let words = py.import("numpy")?.call_method1("array", (words, "U"))?;
            words.get_item(list(py, codes.into_iter().map(i64::from)))?
        }
    })
}
