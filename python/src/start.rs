//! Initial state of a simulation from Python: a scene by name, from a file or as a dictionary; grains from arrays; or a
//! saved run. Options change the scene.

use std::path::Path;

use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::conversion::{InputError, data_of, exception, numbers, refused, text_of};
use crate::options::{GivenOptions, all_names};
use crate::run::Run;
use slump_core::error::{Error, with_allowed};
use slump_core::scene::{Scene, Settling};
use slump_data::config::{BaseScene, Config, SavedState};
use slump_data::data::{RecordedGrains, Values, grains_of};

/// The expected form of a scene dictionary, in words for messages.
const FORM: &str = "a scene as slump.scene(name) gives it";
/// Name in messages for data given as a Python dictionary, in place of a name or file.
const A_DICTIONARY: &str = "a dictionary";
const A_TABLE: &str = "a table";

/// Returns a scene as a dictionary, changed by the options. `slump scene` prints the same data.
#[pyfunction(name = "scene")]
#[pyo3(signature = (scene=None, *, initial=None, **options))]
pub(crate) fn scene_as_data<'py>(
    py: Python<'py>,
    scene: Option<&Bound<'py, PyAny>>,
    initial: Option<&Bound<'py, PyAny>>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    data_of(py, &self::scene(py, scene, initial, options)?)
}

/// Returns the requested scene. If grains have to settle, this function computes how they settle; Ctrl-C stops it.
pub(crate) fn scene(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    initial: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Scene> {
    let config = config_of(scene, initial, options)?;
    if let Some(table) = initial.filter(|initial| is_data(initial)) {
        if let Some(step) = config.source.initial_step {
            let allowed = "left out where initial is a table, which is of one moment";
            return Err(refused("initial-step", step, allowed));
        }
        return config.scene_of_discs(discs(table)?).map_err(of_no_file);
    }
    let base = match scene.filter(|scene| is_data(scene)) {
        Some(data) => BaseScene::of(described(data)?, Path::new("")),
        None => config.base_scene(),
    };
    settled(py, &config, base.map_err(exception)?)
}

/// Resumes a run from a file with a saved state, changed by the options.
pub(crate) fn restarted(
    py: Python<'_>,
    file: &Path,
    scene: Option<&Bound<'_, PyAny>>,
    initial: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Run> {
    let config = config_of(scene, initial, options)?;
    let restarted = py.detach(|| {
        let mut state = SavedState::open(file)?;
        config.change_state(&mut state)?;
        Ok(Run::of(state))
    });
    restarted.map_err(exception)
}

/// Returns the arguments as a configuration of the command line.
fn config_of(
    scene: Option<&Bound<'_, PyAny>>,
    initial: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Config> {
    let mut given = GivenOptions::default();
    for (name, value, data) in [("scene", scene, A_DICTIONARY), ("initial", initial, A_TABLE)] {
        match value {
            Some(value) if is_data(value) => given.add_text(name, data),
            Some(value) => given.add(name, value)?,
            None => {}
        }
    }
    given.add_all(options, &all_names())?;
    given.config()
}

/// True if the argument is data (a dictionary or a table), and not a name or a path.
fn is_data(given: &Bound<'_, PyAny>) -> bool {
    !given.is_none()
        && !given.is_instance_of::<PyString>()
        && !given.hasattr("__fspath__").unwrap_or(false)
}

fn described(data: &Bound<'_, PyAny>) -> PyResult<Scene> {
    serde_json::from_str(&text_of("scene", data)?).map_err(|error| {
        // A dictionary has no line numbers, so they are removed from the message.
        let place = format!(" at line {} column {}", error.line(), error.column());
        let said = error.to_string();
        let said = with_allowed(said.strip_suffix(&place).unwrap_or(&said), FORM);
        InputError::new_err(format!("scene: {said}"))
    })
}

fn settled(py: Python<'_>, config: &Config, base: BaseScene) -> PyResult<Scene> {
    let mut interrupted = None;
    let look = |_: Settling| {
        interrupted = Python::attach(|py| py.check_signals()).err();
        interrupted.is_none()
    };
    let scene = py.detach(|| config.scene_on(base, look));
    match interrupted {
        Some(interrupted) => Err(interrupted),
        None => scene.map_err(exception),
    }
}

/// Name of the initial state in messages.
const INITIAL: &str = "initial";

/// Reads discs from a dictionary of arrays or a data frame. Its columns are all columns of a table of grains, or the
/// first few of them.
fn discs(table: &Bound<'_, PyAny>) -> PyResult<RecordedGrains> {
    let named = |name: String| {
        let values = values_of(&name, &table.get_item(&name)?)?;
        Ok((name, values))
    };
    let columns = names_of(table)?.into_iter().map(named).collect::<PyResult<Vec<_>>>()?;
    grains_of(Path::new(INITIAL), &columns).map_err(of_no_file)
}

/// Returns the exception for a refused table. The error was worded for a file.
fn of_no_file(error: Error) -> PyErr {
    InputError::new_err(error.to_string())
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

/// Converts all entries of a list to one type.
fn each_of<T: for<'a, 'py> FromPyObject<'a, 'py>>(list: &Bound<'_, PyAny>) -> PyResult<Vec<T>> {
    list.try_iter()?.map(|entry| entry?.extract().map_err(Into::into)).collect()
}

fn values_of(name: &str, column: &Bound<'_, PyAny>) -> PyResult<Values> {
    let refuse = |allowed: &str| {
        let found = column.get_type();
        refused(format!("{INITIAL}[\"{name}\"]"), found, format!("{allowed}, one a disc"))
    };
    match name {
        "kind" | "material" => {
            let words: Vec<String> =
                each_of(column).map_err(|_: PyErr| refuse("a list of words"))?;
            Ok(Values::Words { codes: (0..words.len() as u32).collect(), words })
        }
        "id" => {
            each_of(column).map(Values::Counts).map_err(|_| refuse("a list of whole numbers ≥ 0"))
        }
        // The values of this column are not used; only its length is checked.
        name if !RecordedGrains::NUMBERS.contains(&name) => {
            let rows = column.len().map_err(|_| refuse("a list"))?;
            Ok(Values::Flags(vec![None; rows]))
        }
        _ => {
            let numbers = numbers(column).ok().filter(|numbers| numbers.ndim() == 1);
            let numbers = numbers.ok_or_else(|| refuse("a list of numbers"))?;
            Ok(Values::Numbers(numbers.as_array().iter().copied().collect()))
        }
    }
}
