//! Reads the varied values of a study file, which are written as a list or as a range.

use std::collections::HashSet;
use std::fmt::Display;

use toml::{Table, Value};

use crate::error::{self, Error, Result};

/// Number of significant digits to which the values of a range are rounded, so that they are short and the same on
/// every machine.
const DIGITS: usize = 9;
/// Largest number of values in one range. A larger number is probably a mistake.
const MOST_VALUES: i64 = 1_000_000;

/// Returns the values of a list or a range in a study file. `field` is the name of the setting for error messages.
///
/// A list is `[0, 20, 50]`. A range is `{ from = 1, to = 16 }`, which means all whole numbers, or `{ from = 1e-4, to =
/// 1e-2, count = 20 }`, which means evenly spaced values. With `scale = "log"` the ratio of neighbouring values is
/// constant.
pub(super) fn values(field: &str, said: &Value) -> Result<Vec<Value>> {
    let values = match said {
        Value::Array(list) => list.clone(),
        Value::Table(range) => of_range(field, range)?,
        other => {
            let allowed = "a list [a, b] or a range { from = a, to = b }";
            return Err(Error::value(field, other, allowed));
        }
    };
    error::check(!values.is_empty(), field, "empty", "at least one value")?;
    let mut earlier = HashSet::with_capacity(values.len());
    if let Some(value) = values.iter().find(|value| !earlier.insert(meaning(value))) {
        return Err(Error::value(field, format!("{value} twice"), "a list of different values"));
    }
    Ok(values)
}

/// Returns a key with which equal values are found: equal numbers have the same key, for example 1 and 1.0, or 0 and
/// -0.0.
fn meaning(value: &Value) -> (Option<u64>, String) {
    match number(value) {
        Some(number) => (Some((number + 0.0).to_bits()), String::new()),
        None => (None, value.to_string()),
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(integer) => Some(*integer as f64),
        Value::Float(float) => Some(*float),
        _ => None,
    }
}

fn of_range(field: &str, range: &Table) -> Result<Vec<Value>> {
    let known = ["from", "to", "count", "scale"];
    if let Some(key) = range.keys().find(|key| !known.contains(&key.as_str())) {
        return Err(Error::value(
            format!("{field}.{key}"),
            "given",
            "one of from, to, count, scale",
        ));
    }
    let bound = |key: &str| {
        let value = range.get(key);
        value.and_then(number).filter(|bound| bound.is_finite()).ok_or_else(|| {
            let found = value.map_or("missing".to_owned(), Value::to_string);
            Error::value(format!("{field}.{key}"), found, "a finite number")
        })
    };
    let (from, to) = (bound("from")?, bound("to")?);
    if !range.contains_key("count") {
        return whole_numbers(field, range);
    }
    let count = match &range["count"] {
        Value::Integer(count @ 2..=MOST_VALUES) => *count,
        other => {
            let allowed = format!("a whole number between 2 and {MOST_VALUES}");
            return Err(Error::value(format!("{field}.count"), other, allowed));
        }
    };
    if to <= from {
        return Err(not_above(field, "above", from, to));
    }
    let logarithmic = is_logarithmic(field, range, from)?;
    let value = |index: i64| {
        let share = index as f64 / (count - 1) as f64;
        let exact = match (index, logarithmic) {
            (0, _) => from,
            (index, _) if index == count - 1 => to,
            (_, true) => from * (to / from).powf(share),
            (_, false) => from + (to - from) * share,
        };
        Value::Float(rounded(exact))
    };
    Ok((0..count).map(value).collect())
}

/// Returns the values of a range without `count`: all whole numbers from `from` to `to`.
fn whole_numbers(field: &str, range: &Table) -> Result<Vec<Value>> {
    let (Value::Integer(from), Value::Integer(to)) = (&range["from"], &range["to"]) else {
        let allowed = "a number of values, as the bounds are not both whole numbers";
        return Err(Error::value(format!("{field}.count"), "missing", allowed));
    };
    if to < from {
        return Err(not_above(field, "at least", from, to));
    }
    let allowed = format!("no more than {MOST_VALUES} above from");
    error::check(to.saturating_sub(*from) < MOST_VALUES, format!("{field}.to"), to, allowed)?;
    Ok((*from..=*to).map(Value::Integer).collect())
}

fn not_above(field: &str, least: &str, from: impl Display, to: impl Display) -> Error {
    Error::value(format!("{field}.to"), to, format!("{least} from, which is {from}"))
}

/// True if `range` asks for logarithmic spacing, with a constant ratio of neighbouring values. `from` is the first
/// value, which must then be above 0.
fn is_logarithmic(field: &str, range: &Table, from: f64) -> Result<bool> {
    let Some(scale) = range.get("scale") else { return Ok(false) };
    match scale.as_str() {
        Some("linear") => Ok(false),
        Some("log") if from > 0.0 => Ok(true),
        Some("log") => Err(Error::value(format!("{field}.from"), from, "> 0 where scale is log")),
        _ => Err(Error::value(format!("{field}.scale"), scale, "\"linear\" or \"log\"")),
    }
}

fn rounded(exact: f64) -> f64 {
    format!("{exact:.*e}", DIGITS - 1).parse().unwrap_or(exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Vec<Value>> {
        let table: Table = toml::from_str(&format!("x = {text}")).expect("TOML");
        values("x", &table["x"])
    }

    fn numbers(text: &str) -> Vec<f64> {
        of(text).expect("values").iter().filter_map(number).collect()
    }

    #[test]
    fn lists_and_ranges() {
        assert_eq!(numbers("[0, 20, 50.5]"), [0.0, 20.0, 50.5]);
        assert_eq!(numbers("{ from = 3, to = 6 }"), [3.0, 4.0, 5.0, 6.0]);
        assert_eq!(numbers("{ from = 0, to = 1, count = 5 }"), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(
            numbers("{ from = 1e-4, to = 1e-1, count = 4, scale = 'log' }"),
            [1e-4, 1e-3, 1e-2, 1e-1]
        );
    }

    #[test]
    fn what_is_neither_is_refused_by_name() {
        let cases = [
            ("3", "x is 3"),
            ("[]", "x is empty"),
            ("[1, 2, 1.0]", "x is 1.0 twice"),
            ("{ from = 4, to = 3 }", "x.to is 3"),
            ("{ from = 1.0, to = 3 }", "x.count is missing"),
            ("{ from = 1, to = 3, count = 1 }", "x.count is 1"),
            ("{ from = 0, to = 3, count = 3, scale = 'log' }", "x.from is 0"),
            ("{ from = 1, to = 3, count = 3, scale = 'cubic' }", "x.scale is"),
            ("{ from = 1, to = 3, by = 3 }", "x.by is given"),
            ("{ from = 1, to = nan, count = 3 }", "x.to is nan"),
        ];
        for (text, said) in cases {
            let error = of(text).expect_err(text).to_string();
            assert!(error.starts_with(said), "{text}: {error}");
        }
    }
}
