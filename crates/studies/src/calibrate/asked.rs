//! Parses the targets and the varied parameters of a calibration from the text that a user writes.

use std::str::FromStr;

use crate::budget::BudgetQuantity;
use crate::config::Config;
use crate::error::{self, Error, Result};
use crate::setting::Value;

/// A measured value that the scene should reproduce.
pub(super) struct Target {
    pub quantity: BudgetQuantity,
    pub value: f64,
    /// Standard error of the measured value, in the unit of the quantity; above 0.
    pub error: f64,
}

impl FromStr for Target {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let refuse = || {
            let allowed = "QUANTITY=VALUE±ERROR with a standard error > 0, as in slump=0.35±0.02";
            Error::value("target", text, allowed)
        };
        let (name, rest) = text.split_once('=').ok_or_else(refuse)?;
        let (value, error) =
            rest.split_once('±').or_else(|| rest.split_once("+-")).ok_or_else(refuse)?;
        let [value, error] = [value, error].map(|text| text.trim().parse().unwrap_or(f64::NAN));
        if value.is_finite() && error > 0.0 && error.is_finite() {
            return Ok(Self { quantity: name.trim().parse()?, value, error });
        }
        Err(refuse())
    }
}

/// A parameter of the scene that a calibration varies, with its range.
pub(super) struct Varied {
    /// Name of the parameter as written in study files, which can differ from the name of the command-line option.
    pub name: String,
    pub range: [f64; 2],
}

impl FromStr for Varied {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let refuse = || {
            let allowed = "SETTING=FROM..TO for a setting that is a number, as in bond=0..50";
            Error::value("vary", text, allowed)
        };
        let (name, range) = text.split_once('=').ok_or_else(refuse)?;
        let (from, to) = range.split_once("..").ok_or_else(refuse)?;
        let range = [from, to].map(|text| text.trim().parse().unwrap_or(f64::NAN));
        let is_range = range[0] < range[1] && (range[1] - range[0]).is_finite();
        // Users can also write the long name of a command-line option. It is replaced by the name in files.
        let config = Config::of_options([(name.trim(), from.trim())])?;
        let known = serde_json::to_value(&config).unwrap_or_default();
        let name = known.as_object().and_then(|known| known.keys().next()).ok_or_else(refuse)?;
        let is_number = Config::default().set(name, Value::Number(range[0]));
        if is_range && is_number { Ok(Self { name: name.clone(), range }) } else { Err(refuse()) }
    }
}

/// Checks that the names of all targets, or of all varied parameters, differ.
pub(super) fn check_distinct(field: &str, names: &[&String]) -> Result<()> {
    let twice = names.iter().enumerate().find(|(number, name)| names[..*number].contains(name));
    let said = twice.map_or_else(String::new, |(_, name)| format!("{name} twice"));
    error::check(twice.is_none(), field, said, "given once for each name")
}
