//! The program's errors as exceptions of the same sentence.

use pyo3::PyErr;
use slump_core::error::Error;

/// Classes of the package, which are made in Python.
mod classes {
    pyo3::import_exception!(slump._errors, Error);
    pyo3::import_exception!(slump._errors, FileError);
    pyo3::import_exception!(slump._errors, InputError);
    pyo3::import_exception!(slump._errors, NotFiniteError);
    pyo3::import_exception!(slump._errors, SlumpWarning);
}
pub(crate) use classes::{InputError, SlumpWarning};

/// The exception for an error.
pub(crate) fn exception(error: Error) -> PyErr {
    let sentence = error.to_string();
    match error {
        Error::Value { .. } | Error::Options(_) => InputError::new_err(sentence),
        Error::File { .. } => classes::FileError::new_err(sentence),
        Error::NonFinite { .. } => classes::NotFiniteError::new_err(sentence),
        Error::Renderer(_) | Error::Interrupted { .. } => classes::Error::new_err(sentence),
    }
}

/// The exception for a value that is none of those allowed.
pub(crate) fn refused(
    field: impl Into<String>,
    value: impl std::fmt::Display,
    allowed: impl Into<String>,
) -> PyErr {
    exception(Error::value(field, value, allowed))
}
