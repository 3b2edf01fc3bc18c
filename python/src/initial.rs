//! Initial states from arrays.

use std::path::Path;

use numpy::{AllowTypeChange, PyArrayLike1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::errors::{InputError, refused};
use slump_core::error::Error;
use slump_data::data::{RecordedGrains, Values, grains_of};

/// What a start is called in messages.
const INITIAL: &str = "initial";

/// The discs of a table: a dictionary of arrays, or a data frame, with the columns of the table of grains or the
/// first of them.
///
/// # Errors
/// Names the column that is missing, unknown, or no list as long as the others, or the row that is no disc.
pub(crate) fn discs(table: &Bound<'_, PyAny>) -> PyResult<RecordedGrains> {
    let named = |name: String| {
        let values = values_of(&name, &table.get_item(&name)?)?;
        Ok((name, values))
    };
    let columns = names_of(table)?.into_iter().map(named).collect::<PyResult<Vec<_>>>()?;
    // What is told of as of a file is of no file.
    let refuse = |error: Error| InputError::new_err(error.to_string());
    grains_of(Path::new(INITIAL), &columns).map_err(refuse)
}

fn names_of(table: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let listed = if table.hasattr("columns")? {
        table.getattr("columns")
    } else {
        table.call_method0("keys")
    };
    let names = listed.and_then(|listed| listed.try_iter()?.map(|name| name?.extract()).collect());
    names.map_err(|_| {
        let found = table.get_type();
        let allowed = "a file of discs, or a dictionary or data frame with x, y and radius";
        PyTypeError::new_err(format!("{INITIAL} is {found}, but must be {allowed}"))
    })
}

fn values_of(name: &str, column: &Bound<'_, PyAny>) -> PyResult<Values> {
    let refuse = |allowed: &str| {
        let found = column.get_type();
        refused(format!("{INITIAL}[\"{name}\"]"), found, format!("{allowed}, one a disc"))
    };
    match name {
        "kind" => {
            let words: PyResult<Vec<String>> =
                column.try_iter()?.map(|word| word?.extract()).collect();
            let words = words.map_err(|_| refuse("a list of words"))?;
            Ok(Values::Words { codes: (0..words.len() as u32).collect(), words })
        }
        "id" => {
            let counts: PyResult<Vec<u64>> =
                column.try_iter()?.map(|count| count?.extract()).collect();
            counts.map(Values::Counts).map_err(|_| refuse("a list of whole numbers ≥ 0"))
        }
        // As long as it is, but not read, whatever it holds.
        name if !RecordedGrains::NUMBERS.contains(&name) => {
            Ok(Values::Flags(vec![None; column.len()?]))
        }
        _ => {
            let numbers: PyResult<PyArrayLike1<'_, f64, AllowTypeChange>> = column.extract();
            let numbers = numbers.map_err(|_| refuse("a list of numbers"))?;
            Ok(Values::Numbers(numbers.as_array().iter().copied().collect()))
        }
    }
}
