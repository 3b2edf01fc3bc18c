//! A [`Config`] as studies and journals write it: one flat table by the names of the command line.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{Config, Origin};
use crate::setting::Changes;
use crate::sim::Settings;

impl Serialize for Config {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(serde::Serialize)]
        struct Flat<'a> {
            #[serde(flatten)]
            origin: &'a Origin,
            #[serde(flatten)]
            settings: Given<'a>,
        }
        Flat { origin: &self.origin, settings: Given(self) }.serialize(serializer)
    }
}

/// The settings that are given.
struct Given<'a>(&'a Config);

impl Serialize for Given<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Config { stepper, parameters, solver, remedies, .. } = self.0;
        let mut map = serializer.serialize_map(None)?;
        if let Some(stepper) = stepper {
            map.serialize_entry(Settings::STEPPER.name, stepper)?;
        }
        parameters.write(&mut map)?;
        solver.write(&mut map)?;
        remedies.write(&mut map)?;
        map.end()
    }
}

impl<'de> Deserialize<'de> for Config {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Fields)
    }
}

struct Fields;

impl<'de> Visitor<'de> for Fields {
    type Value = Config;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a table of a scene and changes to it")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Config, A::Error> {
        let mut config = Config::default();
        let Config { origin, stepper, parameters, solver, remedies } = &mut config;
        while let Some(name) = map.next_key::<String>()? {
            if name == Settings::STEPPER.name {
                *stepper = Some(map.next_value()?);
                continue;
            }
            let known = origin.read(&name, &mut map)?
                || parameters.read(&name, &mut map)?
                || solver.read(&name, &mut map)?
                || remedies.read(&name, &mut map)?;
            if !known {
                let names = Config::names().join("`, `");
                let unknown = format!("unknown field `{name}`, expected one of `{names}`");
                return Err(A::Error::custom(unknown));
            }
        }
        Ok(config)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Args, FromArgMatches};

    #[test]
    fn every_option_is_read_from_files_as_it_is_written() {
        let command = Config::augment_args(clap::Command::new("slump").no_binary_name(true));
        for argument in command.clone().get_arguments() {
            let Some(name) = argument.get_long() else { continue };
            let values = argument.get_possible_values();
            let value = values.first().map_or("1", |value| value.get_name());
            let matches = command.clone().try_get_matches_from([&format!("--{name}"), value]);
            let config = Config::from_arg_matches(&matches.expect("an option")).expect("a config");
            assert!(!config.is_empty(), "{name} changes nothing");
            let written = serde_json::to_string(&config).expect("JSON");
            assert!(written.starts_with(&format!("{{\"{name}\":")), "{name}: {written}");
            let read: Config = serde_json::from_str(&written).expect("a config");
            assert_eq!(read, config, "{name}");
        }
    }
}
