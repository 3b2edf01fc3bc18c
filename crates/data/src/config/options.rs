//! Converts the configuration of a run ([`Config`]) to and from options of the command line. Also converts it to and
//! from a table without nested tables, whose entries have the names of the options. The files and journals of studies
//! (lists of runs) contain such tables. Also rewrites errors in a command line as messages of one sentence.

use std::error::Error as _;
use std::fmt;
use std::num::{ParseFloatError, ParseIntError};

use clap::builder::ValueParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::option_words::possible;
use super::{Config, SceneSource};
use crate::error::{Error, Result, legible};
use crate::setting::{About, Changes, Kind, Value};
use crate::sim::Settings;

impl Config {
    /// Returns the names of all options that configure a run, as they appear on the command line and in study files.
    pub fn names() -> Vec<String> {
        Self::options().into_iter().map(|(name, _)| name).collect()
    }

    /// Returns the names of all options that configure a run, each with its text in the help of the command line.
    pub fn options() -> Vec<(String, String)> {
        let command = Self::augment_args(Command::new("config"));
        let help = |option: &Arg| option.get_help().map(ToString::to_string).unwrap_or_default();
        let named = |option: &Arg| Some((option.get_long()?.to_owned(), help(option)));
        command.get_arguments().filter_map(named).collect()
    }

    /// Creates a configuration from options, each given as (name, value). Values are parsed as on the command line.
    ///
    /// ```
    /// use slump_data::config::Config;
    ///
    /// let config = Config::of_options([("scene", "cradle"), ("max-sweeps", "20")])?;
    /// assert_eq!(config.scene(|_| true)?.solver.max_sweeps, 20);
    /// let refused = Config::of_options([("max-sweeps", "many")]);
    /// assert!(refused.is_err_and(|error| error.to_string().starts_with("--max-sweeps is many")));
    /// # Ok::<(), slump_core::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// If an option or its value is not allowed, or if options contradict each other. The message is the same as on the
    /// command line.
    pub fn of_options<'a>(options: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self> {
        let command = Self::augment_args(Command::new("slump").no_binary_name(true));
        let given = options.into_iter().map(|(name, value)| format!("--{name}={value}"));
        let matches = command.clone().try_get_matches_from(given);
        matches
            .and_then(|matches| Self::from_arg_matches(&matches))
            .map_err(|error| Error::Options(refusal_of(&error, command)))
    }
}

impl Args for Config {
    fn augment_args(command: Command) -> Command {
        Settings::about()
            .fold(SceneSource::augment_args(command), |command, about| command.arg(option(about)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

/// Creates the command-line option for a setting from the description of the setting.
fn option(about: &About) -> Arg {
    let parser: ValueParser = match about.kind {
        Kind::Number => clap::value_parser!(f64).into(),
        Kind::Count => clap::value_parser!(u32).into(),
        Kind::Switch => clap::value_parser!(bool),
        Kind::Word(words) => possible(words).into(),
    };
    let option = Arg::new(about.name)
        .long(about.name)
        .value_name(about.value_name)
        .help(about.help)
        .help_heading(about.heading)
        .ignore_case(true)
        .value_parser(parser);
    let option = match about.kind {
        Kind::Switch => option.num_args(0..=1).default_missing_value("true"),
        _ => option,
    };
    match ALIASES.iter().find(|(name, _)| *name == about.name) {
        Some((_, alias)) => option.visible_alias(alias),
        None => option,
    }
}

/// Aliases of settings whose names are very short, as (name, longer alias).
const ALIASES: [(&str, &str); 4] =
    [("dt", "time-step"), ("rho", "restitution"), ("mu", "friction"), ("solver", "method")];

/// Returns the value of a setting on the command line; `None` if the setting is not given.
fn given(about: &About, matches: &ArgMatches) -> Option<Value> {
    let name = about.name;
    match about.kind {
        Kind::Number => matches.get_one(name).copied().map(Value::Number),
        Kind::Count => matches.get_one(name).copied().map(Value::Count),
        Kind::Switch => matches.get_one(name).copied().map(Value::Switch),
        Kind::Word(words) => {
            let said: &String = matches.get_one(name)?;
            words
                .iter()
                .find(|word| word.name.eq_ignore_ascii_case(said))
                .map(|word| Value::Word(word.name))
        }
    }
}

impl FromArgMatches for Config {
    fn from_arg_matches(matches: &ArgMatches) -> std::result::Result<Self, clap::Error> {
        let mut config = Self::default();
        config.update_from_arg_matches(matches)?;
        Ok(config)
    }

    fn update_from_arg_matches(
        &mut self,
        matches: &ArgMatches,
    ) -> std::result::Result<(), clap::Error> {
        self.source = SceneSource::from_arg_matches(matches)?;
        for about in Settings::about() {
            let accepted = given(about, matches).is_none_or(|value| self.set(about.name, value));
            if !accepted {
                let message = format!("{} is not of its kind", about.name);
                return Err(clap::Error::raw(ErrorKind::InvalidValue, message));
            }
        }
        Ok(())
    }
}

impl Serialize for Config {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        #[derive(serde::Serialize)]
        struct Flat<'a> {
            #[serde(flatten)]
            source: &'a SceneSource,
            #[serde(flatten)]
            settings: GivenSettings<'a>,
        }
        Flat { source: &self.source, settings: GivenSettings(self) }.serialize(serializer)
    }
}

/// Wrapper of a configuration that serialises only its settings, not the source of its scene. Settings that the
/// configuration does not give are not written.
struct GivenSettings<'a>(&'a Config);

impl Serialize for GivenSettings<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
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
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_map(ConfigVisitor)
    }
}

struct ConfigVisitor;

impl<'de> Visitor<'de> for ConfigVisitor {
    type Value = Config;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a table of a scene and changes to it")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Config, A::Error> {
        let mut config = Config::default();
        let Config { source, stepper, parameters, solver, remedies, .. } = &mut config;
        while let Some(name) = map.next_key::<String>()? {
            if name == Settings::STEPPER.name {
                *stepper = Some(map.next_value()?);
                continue;
            }
            let known = source.read(&name, &mut map)?
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

/// Describes an error in a command line in one sentence that says which values are allowed. The command line is parsed
/// by the library clap. Its own message is not used, because it adds usage and hints and leaves out the allowed values.
pub fn refusal_of(error: &clap::Error, mut command: Command) -> String {
    // The parser clap can display arguments only after this call.
    command.build();
    let said = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(list)) => list.join(", "),
        Some(ContextValue::StyledStr(text)) => text.to_string(),
        _ => String::new(),
    };
    let argument = said(ContextKind::InvalidArg);
    let field = without_value_name(&argument);
    let value = match said(ContextKind::InvalidValue) {
        empty if empty.is_empty() => "missing".to_owned(),
        value => value,
    };
    let sentence = match error.kind() {
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            let allowed = match said(ContextKind::ValidValue) {
                none if none.is_empty() => kind_of_value(error, &command, &argument),
                list => format!("one of {list}"),
            };
            format!("{field} is {value}, but must be {allowed}")
        }
        ErrorKind::UnknownArgument => {
            let near = match said(ContextKind::SuggestedArg) {
                none if none.is_empty() => String::new(),
                near => format!(", such as {near}"),
            };
            // Links and studies have only a part of the options of the command line.
            let allowed = match command.is_no_binary_name_set() {
                true => "a setting, or say where a scene comes from",
                false => "an option or a command that --help lists",
            };
            format!("{field} is given, but must be {allowed}{near}")
        }
        ErrorKind::InvalidSubcommand => {
            let found = said(ContextKind::InvalidSubcommand);
            format!("the command is {found}, but must be one of {}", commands(&command))
        }
        ErrorKind::MissingRequiredArgument => format!("{argument} is missing, but must be given"),
        ErrorKind::ArgumentConflict => {
            let found = match said(ContextKind::InvalidSubcommand) {
                none if none.is_empty() => field.to_owned(),
                command => command,
            };
            match said(ContextKind::PriorArg) {
                prior if prior == argument => {
                    format!("{found} is given twice, but must be given once")
                }
                prior => format!(
                    "{found} is given, but must be left out where {} is",
                    without_value_name(&prior)
                ),
            }
        }
        ErrorKind::TooManyValues => format!("{field} is {value}, but must be given without that"),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => {
            "the command is incomplete, but must be whole: see its --help".to_owned()
        }
        ErrorKind::InvalidUtf8 => "an argument is no text, but must be UTF-8".to_owned(),
        _ => format!("{}, but must be as --help says", first_sentence(&error.to_string())),
    };
    legible(&sentence)
}

/// Shortens an argument such as `--bond <BOND>` to `--bond`, as a user writes it.
fn without_value_name(argument: &str) -> &str {
    argument.split_once(" <").map_or(argument, |(name, _)| name)
}

/// Describes the allowed values of an option that does not take a word from a list, such as `a number (…)`. The type of
/// the value comes from the parser's error, and the range comes from the parentheses in the option's help text.
fn kind_of_value(error: &clap::Error, command: &Command, argument: &str) -> String {
    let source = error.source();
    let kind = if source.is_some_and(|source| source.is::<ParseFloatError>()) {
        "a number".to_owned()
    } else if source.is_some_and(|source| source.is::<ParseIntError>()) {
        "a whole number ≥ 0".to_owned()
    } else if let Some((_, range)) =
        source.map(ToString::to_string).unwrap_or_default().split_once(" is not in ")
    {
        format!("a whole number in {range}")
    } else {
        // The error is from one of Slump's own parsers, whose message says what is allowed.
        source.map_or_else(|| "given".to_owned(), ToString::to_string)
    };
    match find(command, argument).and_then(Arg::get_help) {
        Some(help) => format!("{kind} ({help})"),
        None => kind,
    }
}

fn find<'a>(command: &'a Command, argument: &str) -> Option<&'a Arg> {
    let own = command.get_arguments().find(|known| known.to_string() == argument);
    own.or_else(|| command.get_subcommands().find_map(|below| find(below, argument)))
}

/// Returns the names of all subcommands of `command`. Each name is followed by its own subcommands in parentheses, if
/// any.
fn commands(command: &Command) -> String {
    let name = |command: &Command| match commands(command) {
        none if none.is_empty() => command.get_name().to_owned(),
        within => format!("{} ({within})", command.get_name()),
    };
    let own = command.get_subcommands().filter(|command| command.get_name() != "help");
    own.map(name).collect::<Vec<_>>().join(", ")
}

/// Shortens an error message of the command-line parser to one line without usage and hints.
fn first_sentence(message: &str) -> String {
    let message = message.trim_start_matches("error: ");
    let lines = message.lines().take_while(|line| !line.is_empty() && !line.starts_with("Usage"));
    lines.map(str::trim).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_is_read_from_files_as_it_is_written() {
        let command = Config::augment_args(clap::Command::new("slump").no_binary_name(true));
        for argument in command.clone().get_arguments() {
            let Some(name) = argument.get_long() else { continue };
            let values = argument.get_possible_values();
            let of_text = if name == "sizes" { "lognormal:0.2" } else { "1" };
            let value = values.first().map_or(of_text, |value| value.get_name());
            let matches = command.clone().try_get_matches_from([&format!("--{name}"), value]);
            let config = Config::from_arg_matches(&matches.expect("an option")).expect("a config");
            assert!(!config.is_empty(), "{name} changes nothing");
            let written = serde_json::to_string(&config).expect("JSON");
            assert!(written.starts_with(&format!("{{\"{name}\":")), "{name}: {written}");
            let read: Config = serde_json::from_str(&written).expect("a config");
            assert_eq!(read, config, "{name}");
        }
    }

    #[test]
    fn scenes_are_known_in_upper_case_and_by_their_challenges() {
        for (asked, meant) in [("PILE", "pile"), ("Cradle", "cradle"), ("Sag", "column")] {
            let config = Config::of_scene(asked);
            let base = config.base_scene().expect("a built-in scene");
            let scene = config.change(&base).expect("a sound config");
            assert_eq!((config.named(), scene.name.as_str()), (meant, meant));
        }
        let mut pile = Config::of_scene("Pile");
        pile.source.grains = Some(20);
        assert!(pile.base_scene().is_ok(), "a pile can have any number of grains");
        assert!(Config::of_scene("plie").base_scene().is_err());
    }
}
